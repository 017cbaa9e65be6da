/* SPDX-License-Identifier: MIT */
#include "program/program.h"

#include <stdio.h>
#include <string.h>

#include "base/file.h"
#include "base/mem.h"
#include "base/scan.h"

/* ---- options ---- */

enum err option_read_flag(const struct option *option, const char *text, void *out,
                          struct fault *fault)
{
    (void)text;
    (void)fault;
    *(bool *)((char *)out + option->at) = true;
    return OK;
}

enum err option_read_text(const struct option *option, const char *text, void *out,
                          struct fault *fault)
{
    (void)fault;
    *(const char **)((char *)out + option->at) = text;
    return OK;
}

enum err option_read_next(const struct option *option, const char *text, void *out,
                          struct fault *fault)
{
    const char **at = (const char **)((char *)out + option->at);
    for (int64_t i = 0; i < option->most; i++, at++)
        if (!*at) {
            *at = text;
            return OK;
        }
    return fault_set(fault, ERR_USAGE, "%s: expected at most %d", option->name, (int)option->most);
}

enum err option_read_number(const struct option *option, const char *text, void *out,
                            struct fault *fault)
{
    const char *at = text;
    int64_t number;
    if (!scan_integer(&at, option->least, option->most, &number) || *at)
        return fault_set(fault, ERR_USAGE, "%s: expected a number %lld..%lld, not %s", option->name,
                         (long long)option->least, (long long)option->most, text);
    *(size_t *)((char *)out + option->at) = (size_t)number;
    return OK;
}

enum err option_read_list(const struct option *option, const char *text, void *out,
                          struct fault *fault)
{
    if (!scan_is_list(text, option->least, option->most))
        return fault_set(fault, ERR_USAGE,
                         "%s: expected numbers %lld..%lld, as in 1-90,105, not %s", option->name,
                         (long long)option->least, (long long)option->most, text);
    return option_read_text(option, text, out, fault);
}

uint8_t option_find(const struct option_table *table, const uint8_t *taken, const char *name)
{
    while (*taken && strcmp(table->row[*taken].name, name) != 0)
        taken++;
    return *taken;
}

/* Iterates over a command line, word by word. Initialise `table`, `word` and `count`; a copy
 * iterates again. */
struct option_words {
    const struct option_table *table;
    char **word;
    int count;
    int at;    /* index of the next word */
    bool over; /* "--" was found */
    /* found by option_next: an operand, or an option with its name */
    char *text;
    bool is_option;
    char name[64];
    const char *value; /* and its value; NULL without one, or if none is left */
};

/* Find the next operand or option; false at the end. */
static bool option_next(struct option_words *w)
{
    while (w->at < w->count) {
        w->text = w->word[w->at++];
        w->value = NULL;
        w->is_option = !w->over && w->text[0] == '-' && w->text[1];
        if (!w->is_option)
            return true;
        w->over = strcmp(w->text, "--") == 0;
        if (w->over)
            continue;
        /* Split "--name=value". A name that is too long is cut, and matches no option. */
        const size_t whole = strlen(w->text);
        const size_t length = strncmp(w->text, "--", 2) == 0 ? strcspn(w->text, "=") : whole;
        const bool is_short = strcmp(w->text, "-V") == 0;
        snprintf(w->name, sizeof w->name, "%.*s", is_short ? 9 : (int)length,
                 is_short ? "--version" : w->text);
        w->value = length < whole ? w->text + length + 1 : NULL;
        unsigned row = w->table->rows - 1;
        while (row && strcmp(w->table->row[row].name, w->name) != 0)
            row--;
        if (row && w->table->row[row].value && !w->value && w->at < w->count)
            w->value = w->word[w->at++];
        return true;
    }
    return false;
}

/* ---- which program ---- */

static bool is_named(const struct program *program, const char *name)
{
    return name && program->name ? strcmp(program->name, name) == 0 : name == program->name;
}

/* True if the command line has the option that selects a form. */
static bool gives_form(struct option_words w, const char *form)
{
    while (option_next(&w))
        if (w.is_option && strcmp(w.name, form) == 0)
            return true;
    return false;
}

static bool takes_all(const struct program *program, struct option_words w)
{
    while (option_next(&w))
        if (w.is_option && !option_find(w.table, program->option, w.name))
            return false;
    return true;
}

/* The selected form, of several the one that accepts all options; otherwise the row without a form,
 * or NULL. */
static const struct program *choose(const struct program_table *table, const char *name,
                                    const struct option_words *words)
{
    const struct program *plain = NULL, *form = NULL;
    for (unsigned i = 0; i < table->rows; i++) {
        const struct program *p = table->row + i;
        if (!is_named(p, name))
            continue;
        if (!p->form)
            plain = p;
        else if (gives_form(*words, p->form) && (!form || takes_all(p, *words)))
            form = p;
    }
    return form ? form : plain;
}

/* ---- help ---- */

/* Columns. A summary is one line: at most LINE_MOST - SUMMARY_COLUMN. */
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
    if (program->form)
        value =
            table->option.row[option_find(&table->option, program->option, program->form)].value;
    if (value)
        buf_printf(out, " %s", value);
    if (*program->words)
        buf_printf(out, " %s", program->words);
}

/* Wrap text to LINE_MOST columns, each line from `column` on. The cursor is at `at`; the text
 * begins on a new line unless two blanks fit between. */
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

/* All options but the one that selects the form, which is in its usage. */
static void add_options(struct buf *out, const struct program_table *table,
                        const struct program *program)
{
    for (const uint8_t *o = program->option; *o; o++) {
        const struct option *option = table->option.row + *o;
        const size_t before = out->length;
        if (!*option->help)
            continue;
        OWNED(buf_release) struct buf help = {0};
        buf_printf(out, "%*s%s%s%s", INDENT, "", option->name, option->value ? " " : "",
                   option->value ? option->value : "");
        buf_add_text(&help, option->help);
        if (option->add_choices) {
            buf_add_text(&help, ": ");
            option->add_choices(&help, ", ", " or ");
        }
        out->failed |= help.failed;
        add_wrapped(out, buf_text(&help), out->length - before, OPTION_COLUMN);
    }
}

static void add_paragraphs(struct buf *out, const char *text)
{
    OWNED(buf_release) struct buf line = {0};
    for (; text && *text; text += strcspn(text, "\n"), text += *text == '\n') {
        buf_clear(&line);
        buf_add(&line, text, strcspn(text, "\n"));
        add_wrapped(out, buf_text(&line), 0, INDENT);
    }
    out->failed |= line.failed;
}

bool program_add_help(struct buf *out, const struct program_table *table, const char *name)
{
    bool known = false;
    for (unsigned i = 0; i < table->rows; i++) {
        const struct program *p = table->row + i;
        if (!p->name || strcmp(p->name, name) != 0)
            continue;
        buf_add_text(out, known ? "\n" : "");
        program_add_usage(out, table, p);
        buf_add_char(out, '\n');
        add_wrapped(out, p->summary, 0, INDENT);
        add_paragraphs(out, p->detail);
        add_options(out, table, p);
        known = true;
    }
    return known;
}

void program_add_overview(struct buf *out, const struct program_table *table)
{
    buf_printf(out, "%s\n\n", table->about);
    for (unsigned i = 0; i < table->rows; i++) {
        const size_t before = out->length;
        buf_printf(out, "%*s", INDENT, "");
        program_add_usage(out, table, table->row + i);
        add_wrapped(out, table->row[i].summary, out->length - before, SUMMARY_COLUMN);
    }
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

/* ---- errors ---- */

void program_try_names(const struct program_table *table, struct near *near)
{
    for (unsigned i = 0; i < table->rows; i++)
        if (table->row[i].name)
            near_try(near, table->row[i].name, strlen(table->row[i].name));
}

/* The programs that have an option of that name: "`iftty verify` and `iftty diff`"; "" for none. */
static void add_takers(struct buf *out, const struct program_table *table, const char *option)
{
    const struct program *taker = NULL;
    for (unsigned i = 0; i <= table->rows; i++) {
        const struct program *next = i < table->rows ? table->row + i : NULL;
        if (next && !option_find(&table->option, next->option, option))
            continue;
        if (taker) {
            buf_add_text(out, out->length == 0 ? "`" : next ? ", `" : " and `");
            program_add_name(out, table, taker);
            buf_add_char(out, '`');
        }
        taker = next;
    }
}

static enum err refuse_option(const struct program_table *table, const struct program *program,
                              const char *option, struct fault *fault)
{
    OWNED(buf_release) struct buf takers = {0}, name = {0};
    program_add_name(&name, table, program);
    add_takers(&takers, table, option);
    if (takers.length) {
        fault_set(fault, ERR_USAGE, "`%s` has no option %s; it belongs to %s", buf_text(&name),
                  option, buf_text(&takers));
    } else {
        /* it may be a misspelt option of any form of this program */
        struct near near = near_to(option);
        for (unsigned i = 0; i < table->rows; i++) {
            const struct program *p = table->row + i;
            for (const uint8_t *o = p->option; *o && is_named(p, program->name); o++)
                near_try(&near, table->option.row[*o].name, strlen(table->option.row[*o].name));
        }
        fault_set(fault, ERR_USAGE, "`%s` has no option %s; see `%s --help`", buf_text(&name),
                  option, buf_text(&name));
        near_append(&near, "", fault);
    }
    return ERR_USAGE;
}

static enum err check_operands(const struct program_table *table, const struct options *o,
                               struct fault *fault)
{
    const struct program *p = o->program;
    OWNED(buf_release) struct buf usage = {0};
    const bool names_file =
        p->name || o->words < 2 || strpbrk(o->word[0], "./:") || file_exists(o->word[0]);
    if (o->words >= p->least && o->words <= p->most && names_file)
        return OK;
    program_add_usage(&usage, table, p);
    if (names_file)
        fault_set(fault, ERR_USAGE, "expected `%s`, and there %s %d operand%s", buf_text(&usage),
                  o->words == 1 ? "is" : "are", o->words, plural((uint64_t)o->words));
    else
        fault_set(fault, ERR_USAGE, "%s is no program, and no file or folder here", o->word[0]);
    if (p->name || o->words == 0)
        return ERR_USAGE;
    struct near near = near_to(o->word[0]); /* it may be a misspelt program */
    program_try_names(table, &near);
    return near_append(&near, "", fault);
}

/* ---- reading ---- */

/* Read operands and options, without the first `skip` operands, which selected the program. */
static enum err read_words(const struct program_table *table, struct option_words w, int skip,
                           struct options *o, struct fault *fault)
{
    enum err err = OK;
    bool is_given[UINT8_MAX + 1] = {false};
    o->word = w.word;
    o->words = 0;
    while (!err && option_next(&w)) {
        const uint8_t number =
            w.is_option ? option_find(&table->option, o->program->option, w.name) : 0;
        const struct option *row = table->option.row + number;
        if (!w.is_option && skip > 0)
            skip--;
        else if (!w.is_option)
            o->word[o->words++] = w.text;
        else if (!row->name)
            err = refuse_option(table, o->program, w.name, fault);
        else if (row->value && !w.value)
            err = fault_set(fault, ERR_USAGE, "%s needs a value, %s", w.name, row->value);
        else if (!row->value && w.value)
            err = fault_set(fault, ERR_USAGE, "%s has no value, and %s was given", w.name, w.value);
        else if (is_given[number] && row->read != option_read_next)
            err = fault_set(fault, ERR_USAGE, "%s is given twice; expected one", w.name);
        else
            err = row->read(row, w.value, o, fault);
        is_given[number] = true;
    }
    return err;
}

enum err program_read(const struct program_table *table, int count, char **word,
                      struct options *options, struct fault *fault)
{
    const struct option_words words = {.table = &table->option, .word = word, .count = count};
    const char *name = NULL, *operand = NULL;
    for (struct option_words w = words; !operand && option_next(&w);)
        if (!w.is_option)
            operand = w.text;
    options->help = false;
    for (int i = 0; i < count && strcmp(word[i], "--") != 0; i++)
        options->help |= strcmp(word[i], "--help") == 0 || strcmp(word[i], "-h") == 0;
    for (unsigned i = 0; i < table->rows && !name; i++)
        name = is_named(table->row + i, operand) ? operand : NULL;
    const struct program *program = choose(table, name, &words);
    options->program = program;
    if (options->help)
        return OK;
    if (!program && operand)
        return fault_set(fault, ERR_USAGE, "there is no program %s; see `%s --help`", operand,
                         table->called);
    if (!program)
        return fault_set(fault, ERR_USAGE, "name a program; see `%s --help`", table->called);
    TRY(read_words(table, words, name != NULL, options, fault));
    return check_operands(table, options, fault);
}

int program_main(const struct program_table *table, int count, char **word, struct options *options)
{
    struct fault fault = {0};
    OWNED(buf_release) struct buf help = {0};
    mem_begin();
    console_init(table->called);
    enum err err = program_read(table, count - 1, word + 1, options, &fault);
    const struct program *program = options->program;
    if (!err && !options->help)
        err = program->run(options, &fault);
    else if (!err && program && program->name)
        program_add_help(&help, table, program->name);
    else if (!err)
        program_add_overview(&help, table);
    fputs(buf_text(&help), stdout);
    return console_finish(err, &fault);
}
