/* What the table of programs says of them, as text; and the program `help`. */
#include <stdio.h>
#include <string.h>

#include "command/command.h"
#include "program/programs.h"
#include "tui/prompt/line_keys.h"

/* Columns. Summaries are a line each: at most LINE_MOST - SUMMARY_COLUMN. */
enum { INDENT = 4, SUMMARY_COLUMN = 35, OPTION_COLUMN = 25, LINE_MOST = 80 };

void program_add_name(struct buf *out, const struct program_table *table,
                      const struct program *program)
{
    buf_add_text(out, table->called);
    if (program->name)
        buf_printf(out, " %s", program->name);
    if (program->form)
        buf_printf(out, " %s", program->form);
}

void program_add_usage(struct buf *out, const struct program_table *table,
                       const struct program *program)
{
    program_add_name(out, table, program);
    const char *value = NULL;
    if (program->form && *program->form == '-')
        value =
            table->option.row[option_find(&table->option, program->option, program->form)].value;
    if (value)
        buf_printf(out, " %s", value);
    if (*program->words)
        buf_printf(out, " %s", program->words);
}

/* Words in lines of at most LINE_MOST columns, each from `column` on. The cursor is at `at`, which
 * stays a line of its own where two blanks would not fit. */
static void add_wrapped(struct buf *out, const char *text, size_t at, size_t column)
{
    if (at + 1 >= column) {
        buf_add_char(out, '\n');
        at = 0;
    }
    while (*text) {
        size_t n = strlen(text);
        const size_t most = LINE_MOST - column;
        for (n = n > most ? most : n; text[n] && text[n] != ' ' && n > 0; n--)
            ;
        n = n ? n : strcspn(text, " ");
        buf_printf(out, "%*s%.*s\n", (int)(column - at), "", (int)n, text);
        text += n;
        text += strspn(text, " ");
        at = 0;
    }
}

static void list_program(struct buf *out, const struct program_table *table,
                         const struct program *program)
{
    const size_t before = out->length;
    buf_printf(out, "%*s", INDENT, "");
    program_add_usage(out, table, program);
    add_wrapped(out, program->summary, out->length - before, SUMMARY_COLUMN);
}

static void add_option(struct buf *out, const struct option *option)
{
    const size_t before = out->length;
    buf_printf(out, "%*s%s", INDENT, "", option->name);
    if (option->value)
        buf_add_char(out, ' ');
    if (option->add_choices)
        option->add_choices(out, "|", "|");
    else if (option->value)
        buf_add_text(out, option->value);
    add_wrapped(out, option->help, out->length - before, OPTION_COLUMN);
}

/* But the option that a form is called by: its usage has it. */
static void add_options(struct buf *out, const struct program_table *table,
                        const struct program *program)
{
    for (const uint8_t *o = program->option; *o; o++)
        if (*table->option.row[*o].help)
            add_option(out, &table->option.row[*o]);
}

static void add_paragraphs(struct buf *out, const char *text)
{
    struct buf line = {0};
    for (; text && *text; text += strcspn(text, "\n"), text += *text == '\n') {
        buf_clear(&line);
        buf_add(&line, text, strcspn(text, "\n"));
        add_wrapped(out, buf_text(&line), 0, INDENT);
    }
    out->failed |= line.failed;
    buf_release(&line);
}

static void add_program(struct buf *out, const struct program_table *table,
                        const struct program *program)
{
    program_add_usage(out, table, program);
    buf_add_char(out, '\n');
    add_wrapped(out, program->summary, 0, INDENT);
    add_paragraphs(out, program->detail);
    add_options(out, table, program);
}

bool program_add_help(struct buf *out, const struct program_table *table, const char *name)
{
    bool known = false;
    for (unsigned i = 0; i < table->rows; i++) {
        const struct program *p = table->row + i;
        if (!p->name || strcmp(p->name, name) != 0)
            continue;
        buf_add_text(out, known ? "\n" : "");
        add_program(out, table, p);
        known = true;
    }
    return known;
}

void program_add_overview(struct buf *out, const struct program_table *table)
{
    buf_printf(out, "%s\n\n", table->about);
    for (unsigned i = 0; i < table->rows; i++)
        list_program(out, table, table->row + i);
    for (unsigned i = 0; i < table->rows; i++) {
        const struct program *p = table->row + i;
        if (p->name || p->form)
            continue;
        buf_add_text(out, "\nOptions of `");
        program_add_usage(out, table, p);
        buf_add_text(out, "`\n");
        add_options(out, table, p);
    }
    buf_printf(out, "\n%s", table->closing);
}

/* ---- iftty help ---- */

static enum err refuse_name(const char *name, struct fault *fault)
{
    struct near near = near_to(name);
    command_try_names(&near);
    program_try_names(&program_table, &near);
    fault_set(fault, ERR_USAGE, "there is no command or program %s%s", name,
              near.count ? "" : "; see `iftty help` and `iftty --help`");
    return near_append(&near, "", fault);
}

enum err run_help(const struct options *o, struct fault *fault)
{
    const char *name = o->words ? o->word[0] : NULL;
    const struct command *command = name ? command_find(name) : NULL;
    struct buf of_command = {0}, of_program = {0};
    if (!name || command)
        command_help(&of_command, command);
    else if (strcmp(name, "keys") == 0)
        line_keys_page(&of_command);
    if (name && !program_add_help(&of_program, &program_table, name) && !of_command.length)
        return refuse_name(name, fault);
    printf("%s%s%s", buf_text(&of_command), of_command.length && of_program.length ? "\n" : "",
           buf_text(&of_program));
    buf_release(&of_command);
    buf_release(&of_program);
    return OK;
}
