/* SPDX-License-Identifier: MIT */
/* The names that 1.0 promises (.package/PROMISES.md) equal tests/promises.txt: commands, their
 * parameters and choices, programs and their options, exit statuses. A new name needs a new line
 * there. A line that is removed or changed breaks a promise, which tests/test_promises.sh detects.
 */
#include "base/file.h"
#include "command/command.h"
#include "program/program.h"
#include "tests/interpreting.h"

static struct buf frozen; /* tests/promises.txt */

static bool has_line(const struct buf *text, const char *line)
{
    const size_t length = strlen(line);
    for (const char *at = buf_text(text); (at = strstr(at, line)) != NULL; at++)
        if ((at == text->data || at[-1] == '\n') && at[length] == '\n')
            return true;
    return false;
}

/* Lines whose first word is `kind` are the same in `now` and in the file. */
static void check_kind(const struct buf *now, const char *kind)
{
    const struct buf *const side[2] = {now, &frozen};
    const size_t length = strlen(kind);
    OWNED(buf_release) struct buf line = {0};
    unsigned count = 0;
    for (int i = 0; i < 2; i++)
        for (const char *at = buf_text(side[i]); *at; at += *at == '\n') {
            buf_clear(&line);
            buf_add(&line, at, strcspn(at, "\n"));
            at += line.length;
            if (strncmp(buf_text(&line), kind, length) != 0 || buf_text(&line)[length] != ' ')
                continue;
            count++;
            CHECK_WITH(has_line(side[!i], buf_text(&line)), "%s: %s",
                       i ? "promised, and gone" : "new, and no line in the file", buf_text(&line));
        }
    CHECK(count >= 10 && !line.failed);
}

/* Add a line of `before` with each of "a|b|c" after it. */
static void add_choices(struct buf *out, const char *before, const char *choices)
{
    for (const char *at = choices; at && *at; at += *at == '|') {
        const size_t length = strcspn(at, "|");
        buf_printf(out, "%s%.*s\n", before, (int)length, at);
        at += length;
    }
}

/* A command or program that the file does not promise. */
static bool is_for_people(const char *name)
{
    OWNED(buf_release) struct buf line = {0};
    buf_printf(&line, "people %s", name);
    return has_line(&frozen, buf_text(&line));
}

static void add_command(struct buf *out, const struct command *c)
{
    OWNED(buf_release) struct buf of = {0};
    int place = 0;
    if (is_for_people(c->name))
        return;
    buf_printf(out, "command %s\n", c->name);
    for (const struct parameter *p = c->parameter; p->type; p++) {
        buf_clear(&of);
        buf_printf(&of, "command %s ", c->name);
        if (p->keyed)
            buf_printf(&of, "%s=", p->name);
        else
            buf_printf(&of, "%d", ++place);
        buf_printf(out, "%s\n", buf_text(&of));
        if (p->optional)
            buf_printf(out, "%s optional\n", buf_text(&of));
        buf_add_text(&of, " may be ");
        add_choices(out, buf_text(&of), p->choices);
    }
    out->failed |= of.failed;
}

STORY(commands_and_their_parameters_have_the_names_that_they_had)
{
    OWNED(buf_release) struct buf now = {0};
    for (unsigned i = 0; i < command_count(); i++)
        add_command(&now, command_at(i));
    CHECK(!now.failed);
    check_kind(&now, "command");
}

/* With their forms and options. */
STORY(programs_and_their_options_have_the_names_that_they_had)
{
    OWNED(buf_release) struct buf now = {0}, name = {0};
    for (unsigned i = 0; i < program_table.rows; i++) {
        const struct program *p = program_table.row + i;
        buf_clear(&name);
        program_add_name(&name, &program_table, p);
        if (is_for_people(buf_text(&name)))
            continue;
        buf_printf(&now, "program %s\n", buf_text(&name));
        for (const uint8_t *o = p->option; *o; o++)
            buf_printf(&now, "program %s takes %s\n", buf_text(&name),
                       program_table.option.row[*o].name);
    }
    CHECK(!now.failed && !name.failed);
    check_kind(&now, "program");
}

STORY(an_error_ends_a_program_with_the_status_that_it_had)
{
    OWNED(buf_release) struct buf now = {0};
#define ADD_STATUS(code, status, name) buf_printf(&now, "status %d %s\n", status, name);
    ERR_LIST(ADD_STATUS)
    check_kind(&now, "status");
}

int main(void)
{
    if (file_read(&frozen, "tests/promises.txt", 1 << 20, &fault) != OK) {
        puts(fault.text);
        return 1;
    }
    const int status = check_run();
    buf_release(&frozen);
    reply_release(&reply);
    return status;
}
