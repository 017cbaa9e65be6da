/* SPDX-License-Identifier: MIT */
/* Commands without the words that may name a person: every parameter of the table. */
#include "base/choice.h"
#include "command/anonymise.h"
#include "command/command.h"
#include "tests/check_main.h"

#define SECRET "miller1950"

static void write(struct buf *out, const char *command)
{
    OWNED(buf_release) struct buf names = {0};
    buf_clear(out);
    anonymise_command(&names, out, command);
}

/* Words that stay though they may be any text. A parameter that joins them needs its reason. */
static bool stays(const struct command *command, const struct parameter *p)
{
    static const char *const kept[] = {
        "open spacing",     "open weight",    "orient HOW",     "landmark NAME",
        "origin PROCEDURE", "origin digest",  "origin pull",    "origin scene",
        "origin from",      "origin volumes", "origin dropped", "label NAME",
        "labels copy",      "branch NAME",    "plane normal",   "spin axis"};
    char name[80];
    snprintf(name, sizeof name, "%s %s", command->name, p->name);
    for (size_t i = 0; i < sizeof kept / sizeof *kept; i++)
        if (strcmp(kept[i], name) == 0)
            return true;
    return false;
}

/* Adds what fills the parameters before one that is given by its place. */
static void fill_before(struct buf *line, const struct command *command, int end)
{
    for (int i = 0; i < end; i++) {
        const struct parameter *p = &command->parameter[i];
        if (p->keyed)
            continue;
        if (p->choices)
            buf_printf(line, " %.*s", (int)choice_at(p->choices, 0).length,
                       choice_at(p->choices, 0).word);
        else
            buf_add_text(line, " 1");
    }
}

static void write_line(struct buf *line, const struct command *command, int i, const char *value)
{
    const struct parameter *p = &command->parameter[i];
    buf_clear(line);
    buf_add_text(line, command->name);
    if (!p->keyed)
        fill_before(line, command, i);
    buf_printf(line, p->keyed ? " %s=\"%s\"" : "%.0s \"%s\"", p->name, value);
}

STORY(no_file_and_no_free_text_of_any_command_is_told)
{
    static const char *const secret[] = {SECRET, SECRET ".nii", "../" SECRET "/a.nii",
                                         "raw:" SECRET ".img", "Dr. " SECRET ", " SECRET};
    OWNED(buf_release) struct buf line = {0}, out = {0};
    unsigned tried = 0;
    for (unsigned n = 0; n < command_count(); n++) {
        const struct command *command = command_at(n);
        for (int i = 0; command->parameter[i].type; i++) {
            const struct parameter *p = &command->parameter[i];
            if ((p->type != VALUE_FILE && p->type != VALUE_WORD) || stays(command, p) ||
                p->is_code) /* SCHEME:VALUE of a terminology is no free text */
                continue;
            for (size_t s = 0; s < sizeof secret / sizeof *secret; s++, tried++) {
                write_line(&line, command, i, secret[s]);
                write(&out, buf_text(&line));
                if (!CHECK(!strstr(buf_text(&out), SECRET)))
                    printf("#   %s\n#   becomes %s\n", buf_text(&line), buf_text(&out));
            }
        }
    }
    CHECK(tried > 100);
}

STORY(words_that_stay_are_those_of_this_test)
{
    OWNED(buf_release) struct buf line = {0}, out = {0};
    for (unsigned n = 0; n < command_count(); n++) {
        const struct command *command = command_at(n);
        for (int i = 0; command->parameter[i].type; i++) {
            const struct parameter *p = &command->parameter[i];
            CHECK_WITH(p->is_kept == stays(command, p), "%s %s", command->name, p->name);
            if (!p->is_kept)
                continue;
            write_line(&line, command, i, "1.5,2/3");
            write(&out, buf_text(&line));
            CHECK_TEXT(buf_text(&out), buf_text(&line));
        }
    }
}

STORY(what_no_parameter_takes_is_a_number_or_a_file)
{
    OWNED(buf_release) struct buf out = {0};
    write(&out, "later 3 miller report=" SECRET ".json 1.5");
    CHECK_TEXT(buf_text(&out), "later 3 file-1 file-2.json 1.5");
    write(&out, "stats " SECRET " report=" SECRET ".json");
    CHECK_TEXT(buf_text(&out), "stats file-1 report=file-2.json");
    write(&out, "label 2 brain code=SCT:12738006:" SECRET);
    CHECK_TEXT(buf_text(&out), "label 2 brain code=SCT:12738006");
    write(&out, "label 2 brain \"code=SCT:12738006:of " SECRET "\" #010203");
    CHECK_TEXT(buf_text(&out), "label 2 brain code=SCT:12738006 #010203");
    write(&out, "label 2 brain code=" SECRET);
    CHECK_TEXT(buf_text(&out), "label 2 brain");
    write(&out, "label 2 brain code=none");
    CHECK_TEXT(buf_text(&out), "label 2 brain code=none");
    write(&out, "open raw:" SECRET ".img size=2,2,2 series=\"T1 " SECRET "\" skip=a," SECRET);
    CHECK_TEXT(buf_text(&out), "open raw:scene.img size=2,2,2");
    write(&out, "mask x.nii \"T1 " SECRET);
    CHECK_TEXT(buf_text(&out), "mask file-1.nii ...");
}
