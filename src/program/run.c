/* `iftty run` and `iftty -c`: commands without a prompt. */
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "command/script.h"
#include "program/begin.h"
#include "program/console.h"
#include "program/programs.h"
#include "program/shown.h"
#include "tui/prompt/repl.h"

static void show_picture(void *context, struct interpreter *interp)
{
    const struct options *o = context;
    struct image_view view = shown_picture(interp, o->smooth);
    fflush(stdout);
    if (isatty(STDOUT_FILENO))
        show_picture_once(o->graphics, &view);
}

static enum err run_lines(const struct options *o, FILE *input, const char *name,
                          struct fault *fault)
{
    struct interpreter interp;
    const struct printer printer = {.context = (void *)(uintptr_t)o,
                                    .print = console_print,
                                    .warn = console_warn,
                                    .show = show_picture,
                                    .waits = console_wait};
    console_handle_interrupts();
    enum err err = begin_interpreter(&interp, o, fault);
    if (!err) {
        err = script_run(&interp, input, name, o->keep_going, &printer, fault);
        fault->text[0] = '\0'; /* printed with its line */
    }
    err = end_journal(&interp, err, fault);
    interpreter_release(&interp);
    return err;
}

enum err run_script(const struct options *o, struct fault *fault)
{
    if (strcmp(o->word[0], "-") == 0)
        return run_lines(o, stdin, "standard input", fault);
    FILE *input = fopen(o->word[0], "re");
    if (!input)
        return fault_errno(fault, "open", o->word[0]);
    const enum err err = run_lines(o, input, o->word[0], fault);
    fclose(input);
    return err;
}

/* A line for each command: semicolons part them, but not in quotes, nor in a comment, which goes on
 * to the end of its line. */
static void split_commands(struct buf *lines, const char *at)
{
    bool quoted = false, blank = true, comment = false;
    for (; *at; at++) {
        comment = *at != '\n' && (comment || (blank && *at == '#'));
        if (!comment && *at == '"')
            quoted = !quoted;
        if (quoted && *at == '\\' && at[1])
            buf_add_char(lines, *at++);
        bool parts = *at == '\n' || (*at == ';' && !quoted && !comment);
        buf_add_char(lines, parts ? '\n' : *at);
        quoted = quoted && !parts;
        blank = parts || (blank && *at == ' ');
    }
    buf_add_char(lines, '\n');
}

enum err run_commands(const struct options *o, struct fault *fault)
{
    struct buf lines = {0};
    split_commands(&lines, o->commands);
    FILE *input = lines.failed ? NULL : fmemopen(lines.data, lines.length, "r");
    enum err err = input ? run_lines(o, input, "-c", fault) : fault_memory(fault, "commands");
    if (input)
        fclose(input);
    buf_release(&lines);
    return err;
}
