/* SPDX-License-Identifier: MIT */
#include "command/command.h"

#include <string.h>

/* Columns; summaries have the 50 that are left. */
enum { INDENT = 4, SUMMARY_COLUMN = 30, USAGE_MOST = 76, LINE_MOST = 80 };

/* ---- usage and help ---- */

/* Whether its choices are all that it may be. */
static bool is_choice(const struct parameter *p)
{
    return p->type == VALUE_CHOICE || p->type == VALUE_PARTS;
}

static void add_form(struct buf *out, const struct parameter *p)
{
    const double unit = p->type == VALUE_DECIMAL ? 1000 : 1;
    const bool is_number = p->type == VALUE_DECIMAL || p->type == VALUE_NUMBER;
    if (p->form)
        buf_add_text(out, p->form);
    else if (p->type == VALUE_POSITION || p->type == VALUE_LINE)
        buf_add_text(out, "X,Y,Z");
    else if (p->type == VALUE_RANGE)
        buf_add_text(out, "A-B");
    else if (p->type == VALUE_LIST)
        buf_add_text(out, "A-B,C");
    else if (p->type == VALUE_INTERVAL)
        buf_add_text(out, "LOW..HIGH");
    else if (p->type == VALUE_RADIUS)
        buf_printf(out, "%lld..%lld|Rmm", (long long)p->least, (long long)p->most);
    else if (p->type == VALUE_LABEL)
        buf_add_text(out, "LABEL");
    else if (p->type == VALUE_COLOUR)
        buf_add_text(out, "#rrggbb");
    else if (p->type == VALUE_FILE && p->keyed)
        buf_add_text(out, "FILE");
    else if (is_number && p->keyed)
        buf_printf(out, "%.10g..%.10g", (double)p->least / unit, (double)p->most / unit);
    else if (!is_choice(p))
        buf_add_text(out, p->name);
}

void usage_form(struct buf *out, const struct parameter *p)
{
    if (p->choices && !(p->type == VALUE_CHOICE && p->form))
        buf_printf(out, "%s%s", p->choices, is_choice(p) ? "" : "|");
    add_form(out, p);
}

/* "LABEL", "[radius=0..32]"; "LOW HIGH|none" where the next one is paired with it. */
static void add_parameter(struct buf *out, const struct parameter *p)
{
    const bool brackets = p->optional && !p->paired;
    buf_add_text(out, brackets ? " [" : " ");
    if (p->keyed)
        buf_printf(out, "%s=", p->name);
    if (p[1].paired) {
        add_form(out, p);
        add_parameter(out, p + 1);
        buf_printf(out, "|%s", p->choices);
    } else {
        usage_form(out, p);
    }
    buf_add_text(out, p->type == VALUE_LINE || p->type == VALUE_PARTS ? " ..." : "");
    buf_add_text(out, brackets ? "]" : "");
}

void usage_rest(struct buf *out, const struct parameter *p, const struct value *value)
{
    for (int keyed = 0; keyed < 2; keyed++)
        for (int i = 0; p[i].type; i++) {
            const bool given = value && value[i].given && p[i].type != VALUE_LINE;
            const bool has_shown = p[i].paired && !(value && value[i - 1].given);
            if (p[i].keyed == keyed && !given && !has_shown)
                add_parameter(out, &p[i]);
        }
}

void command_usage(struct buf *out, const struct command *command)
{
    buf_add_text(out, command->name);
    usage_rest(out, command->parameter, NULL);
}

/* Text in lines, each indented and at most `most` columns wide, that end where a gap does. */
static void add_lines(struct buf *out, const char *text, size_t length, const char *gap,
                      size_t indent, size_t most)
{
    const size_t gap_length = strlen(gap);
    while (indent + length > most) {
        size_t n = most - indent;
        while (n > 0 && strncmp(text + n, gap, gap_length) != 0)
            n--;
        if (n == 0)
            break;
        buf_printf(out, "%*s%.*s\n", (int)indent, "", (int)n, text);
        text += n + 1;
        length -= n + 1;
        indent = INDENT;
    }
    buf_printf(out, "%*s%.*s\n", (int)indent, "", (int)length, text);
}

static void add_usage(struct buf *out, const struct command *command)
{
    struct buf usage = {0};
    command_usage(&usage, command);
    add_lines(out, buf_text(&usage), usage.length, " [", 0, USAGE_MOST);
    out->failed |= usage.failed;
    buf_release(&usage);
}

const char *command_note(const struct command *command, const char *word, size_t word_length,
                         size_t *length)
{
    for (const char *at = command->detail; at && *at; at += *at == '\n') {
        const size_t line = strcspn(at, "\n");
        const char *colon = memmem(at, line, ": ", 2);
        const char *end = at + word_length;
        const bool begins = colon && strncmp(at, word, word_length) == 0;
        if (begins && (end == colon || (end < colon && *end == ','))) {
            *length = (size_t)(at + line - (colon + 2));
            return colon + 2;
        }
        at += line;
    }
    *length = 0;
    return "";
}

/* The usage, and the summary beside it, or below one that is too long. */
static void list_command(struct buf *out, const struct command *command)
{
    const size_t before = out->length;
    add_usage(out, command);
    size_t length = out->length - before;
    if (length > 0 && length <= SUMMARY_COLUMN)
        out->length = before + --length;
    else
        length = 0;
    buf_printf(out, "%*s%s\n", (int)(SUMMARY_COLUMN - length), "", command->summary);
}

void command_help(struct buf *out, const struct command *command)
{
    if (command) {
        add_usage(out, command);
        buf_printf(out, "%*s%s\n", INDENT, "", command->summary);
        for (const char *at = command->detail; at && *at; at += *at == '\n') {
            const size_t length = strcspn(at, "\n");
            add_lines(out, at, length, " ", INDENT, LINE_MOST);
            at += length;
        }
        buf_printf(out, "%*sExample: %s\n", INDENT, "", command->example);
        return;
    }
    for (enum command_group group = 0; group < GROUPS; group++) {
        buf_printf(out, "%s%s\n", group ? "\n" : "", command_group_name[group]);
        for (unsigned i = 0; i < command_count(); i++)
            if (command_at(i)->group == group)
                list_command(out, command_at(i));
    }
}
