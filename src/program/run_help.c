/* SPDX-License-Identifier: MIT */
/* `iftty help` and `iftty --version`: what commands and programs say of themselves. */
#include <libdeflate.h>
#include <nettle/version.h>
#include <openexr_base.h>
#include <stdio.h>
#include <string.h>
#include <zlib.h>

#include "command/command.h"
#include "base/version.h"
#include "image/coprocess.h"
#include "program/programs.h"
#include "session/semantics.h"
#include "tui/prompt/line_keys.h"

enum err run_help(const struct options *o, struct fault *fault)
{
    const char *name = o->words ? o->word[0] : NULL;
    const struct command *command = name ? command_find(name) : NULL;
    struct buf of_command = {0}, of_program = {0};
    if (!name || command)
        command_help(&of_command, command);
    else if (strcmp(name, "keys") == 0)
        line_keys_page(&of_command);
    if (name && !program_add_help(&of_program, &program_table, name) && !of_command.length) {
        struct near near = near_to(name);
        command_try_names(&near);
        program_try_names(&program_table, &near);
        fault_set(fault, ERR_USAGE, "there is no command or program %s%s", name,
                  near.count ? "" : "; see `iftty help` and `iftty --help`");
        return near_append(&near, "", fault);
    }
    printf("%s%s%s", buf_text(&of_command), of_command.length && of_program.length ? "\n" : "",
           buf_text(&of_program));
    buf_release(&of_command);
    buf_release(&of_program);
    return OK;
}

enum err run_version(const struct options *o, struct fault *fault)
{
    static const char *const helpers[][2] = {{"iftty-image", "iftty-image"},
                                             {"iftty-volume", "iftty-volume"},
                                             {"iftty-register", "iftty-volume"}}; /* packages */
    int exr[3];
    const char *extra;
    (void)o;
    exr_get_library_version(&exr[0], &exr[1], &exr[2], &extra);
    /* A version next to "deflate" in the binary is a copy of zlib to lintian. */
    printf("iftty " PROGRAM_VERSION "\n"
           "semantics %d of journals\n"
           "OpenEXR %d.%d.%d, zlib %s, libdeflate %s, nettle %d.%d\n",
           SEMANTICS, exr[0], exr[1], exr[2], zlibVersion(), LIBDEFLATE_VERSION_STRING,
           nettle_version_major(), nettle_version_minor());
    struct buf text = {0};
    for (size_t i = 0; i < sizeof helpers / sizeof *helpers; i++) {
        buf_printf(&text, "%s: ", helpers[i][0]);
        coprocess_add_versions(&text, helpers[i][0], helpers[i][1]);
        buf_add_char(&text, '\n');
    }
    fputs(buf_text(&text), stdout);
    const enum err err = text.failed ? fault_memory(fault, "versions") : OK;
    buf_release(&text);
    return err;
}
