/* SPDX-License-Identifier: MIT */
#include "manual/manual.h"

#include <ctype.h>
#include <string.h>

#include "base/version.h"
#include "command/command.h"
#include "manual/markdown.h"
#include "manual/roff.h"
#include "program/program.h"

/* A line in bold, as what is typed. */
static void add_typed(struct buf *out, const char *text)
{
    buf_add_text(out, "\\fB");
    roff_add_escaped(out, text, strlen(text));
    buf_add_text(out, "\\fP\n");
}

/* Of the page of a name such as "iftty-verify". */
static void add_title(struct buf *out, const char *name, int section)
{
    buf_add_text(out, ".TH ");
    roff_add_capitals(out, name, strlen(name));
    buf_printf(out, " %d %s \"iftty %s\"\n.ad l\n.SH NAME\n", section, PROGRAM_DATE,
               PROGRAM_VERSION);
    roff_add_escaped(out, name, strlen(name));
    buf_add_text(out, " \\- ");
}

/* ---- programs ---- */

bool manual_has_name(unsigned row, const char *name)
{
    const char *own = program_table.row[row].name;
    return name && own ? strcmp(own, name) == 0 : name == own;
}

static unsigned first_row(const char *name)
{
    unsigned row = 0;
    while (!manual_has_name(row, name))
        row++;
    return row;
}

const char *manual_new_name(unsigned row)
{
    const char *name = program_table.row[row].name;
    return first_row(name) == row ? name : NULL;
}

const char *manual_summary(const char *name)
{
    return program_table.row[first_row(name)].summary;
}

static void add_options(struct buf *out, const struct program *program)
{
    for (const uint8_t *o = program->option; *o; o++) {
        const struct option *option = program_table.option.row + *o;
        if (!*option->help)
            continue;
        struct buf value = {0};
        if (option->add_choices)
            option->add_choices(&value, "|", "|");
        else if (option->value)
            buf_add_text(&value, option->value);
        buf_add_text(out, ".TP\n\\fB");
        roff_add_escaped(out, option->name, strlen(option->name));
        buf_add_text(out, value.length ? "\\fP " : "\\fP");
        roff_add_escaped(out, buf_text(&value), value.length);
        buf_add_char(out, '\n');
        roff_add_text(out, option->help, ".IP");
        out->failed |= value.failed;
        buf_release(&value);
    }
}

static void add_usage(struct buf *out, const struct program *program)
{
    struct buf usage = {0};
    program_add_usage(&usage, &program_table, program);
    add_typed(out, buf_text(&usage));
    out->failed |= usage.failed;
    buf_release(&usage);
}

/* The usage of every form, one a line; `name` NULL for those of all programs. */
static void add_synopsis(struct buf *out, const char *name)
{
    const char *between = ".SH SYNOPSIS\n.nf\n";
    for (unsigned i = 0; i < program_table.rows; i++) {
        if (name && !manual_has_name(i, name))
            continue;
        buf_add_text(out, between);
        add_usage(out, program_table.row + i);
        between = "";
    }
    buf_add_text(out, ".fi\n");
}

/* Each form with all that is known of it. */
static void add_forms(struct buf *out, const char *name)
{
    for (unsigned i = 0; i < program_table.rows; i++) {
        const struct program *p = program_table.row + i;
        if (!manual_has_name(i, name))
            continue;
        buf_add_text(out, ".SS ");
        add_usage(out, p);
        buf_add_char(out, (char)toupper((unsigned char)*p->summary));
        roff_add_text(out, p->summary + 1, ".PP");
        if (p->detail) {
            buf_add_text(out, ".PP\n");
            roff_add_text(out, p->detail, ".PP");
        }
        add_options(out, p);
    }
}

/* The other pages; `own` is "" for iftty(1), NULL for iftty-journal(5). */
static void add_see_also(struct buf *out, const char *own)
{
    const char *after = ".SH SEE ALSO\n";
    if (!own || *own) {
        buf_printf(out, "%s.BR iftty (1)", after);
        after = ",\n";
    }
    for (unsigned i = 0; i < program_table.rows; i++) {
        const char *name = manual_new_name(i);
        if (!name || (own && strcmp(own, name) == 0))
            continue;
        buf_printf(out, "%s.BR iftty\\-%s (1)", after, name);
        after = ",\n";
    }
    buf_add_text(out, own ? ",\n.BR iftty\\-journal (5)\n" : "\n");
}

static const char *after_colon(const char *text)
{
    const char *colon = strstr(text, ": ");
    return colon ? colon + 2 : text;
}

void manual_page(struct buf *out)
{
    add_title(out, program_table.called, 1);
    roff_add_text(out, after_colon(program_table.about), "");
    add_synopsis(out, NULL);
    buf_add_text(out, ".SH DESCRIPTION\nEach program has a page of its own, such as\n"
                      ".BR iftty\\-verify (1).\nThe commands of prompt, script and journal are in\n"
                      ".BR iftty\\-journal (5).\n");
    for (unsigned i = 0; i < program_table.rows; i++) {
        const struct program *p = program_table.row + i;
        buf_add_text(out, ".TP\n");
        add_usage(out, p);
        roff_add_text(out, p->summary, ".IP");
    }
    buf_add_text(out, ".SH OPTIONS\n");
    add_forms(out, NULL);
    buf_add_text(out, ".SH EXIT STATUS\n.nf\n");
    for (const char *at = program_table.closing; *at; at += strspn(at, "\n")) {
        const size_t length = strcspn(at, "\n");
        roff_add_escaped(out, at, length);
        buf_add_char(out, '\n');
        at += length;
    }
    buf_add_text(
        out, ".fi\n.SH NOTES\nThis is software for research, and no medical device: nothing that\n"
             "it computes or shows is meant for diagnosis or treatment.\n");
    add_see_also(out, "");
}

void manual_program_page(struct buf *out, const char *name)
{
    struct buf title = {0};
    buf_printf(&title, "%s-%s", program_table.called, name);
    add_title(out, buf_text(&title), 1);
    roff_add_text(out, manual_summary(name), "");
    add_synopsis(out, name);
    buf_add_text(out, ".SH DESCRIPTION\n");
    add_forms(out, name);
    add_see_also(out, name);
    out->failed |= title.failed;
    buf_release(&title);
}

/* ---- commands ---- */

static void add_command(struct buf *out, const struct command *command)
{
    struct buf usage = {0};
    command_usage(&usage, command);
    buf_add_text(out, ".TP\n");
    add_typed(out, buf_text(&usage));
    roff_add_text(out, command->summary, ".IP");
    if (command->detail) {
        buf_add_text(out, ".IP\n");
        roff_add_text(out, command->detail, ".IP");
    }
    buf_add_text(out, ".IP\nExample:\n");
    add_typed(out, command->example);
    out->failed |= usage.failed;
    buf_release(&usage);
}

unsigned manual_journal_page(struct buf *out, const char *format)
{
    add_title(out, "iftty-journal", 5);
    roff_add_text(out, "the commands of a session, in order, with what each gave", "");
    buf_add_text(out, ".SH DESCRIPTION\n");
    roff_add_text(
        out,
        "A journal is a text file. Its first line says which format it has, and which meaning "
        "of commands. Each record is a command as it would be typed at the prompt, and a line "
        "with the digests of what came of it and a chain of digests over all that stands "
        "before. A script is a file of commands without that first line.\n"
        "These are the commands; after them is what a journal is byte for byte.",
        ".PP");
    for (enum command_group group = 0; group < GROUPS; group++) {
        buf_add_text(out, ".SH ");
        roff_add_capitals(out, command_group_name[group], strlen(command_group_name[group]));
        buf_add_char(out, '\n');
        for (unsigned i = 0; i < command_count(); i++)
            if (command_at(i)->group == group)
                add_command(out, command_at(i));
    }
    const unsigned wrong = markdown_add(out, format);
    add_see_also(out, NULL);
    return wrong;
}
