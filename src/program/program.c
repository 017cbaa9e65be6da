#include "program/program.h"

#include <stdio.h>
#include <string.h>

#include "program/console.h"

/* ---- which program ---- */

static bool is_named(const struct program *program, const char *name)
{
    return name && program->name ? strcmp(program->name, name) == 0 : name == program->name;
}

static bool knows_name(const struct program_table *table, const char *name)
{
    for (unsigned i = 0; i < table->rows; i++)
        if (is_named(table->row + i, name))
            return true;
    return false;
}

/* What of a command line says which program is meant: its first two operands, and its options. */
struct hints {
    const char *operand[2];
    struct option_words words; /* at its beginning */
    bool wants_help;
};

static struct hints take_hints(const struct program_table *table, int count, char **word)
{
    struct hints hints = {.words = {.table = &table->option, .word = word, .count = count}};
    int operands = 0;
    for (struct option_words w = hints.words; operands < 2 && option_next(&w);)
        if (!w.is_option)
            hints.operand[operands++] = w.text;
    for (int i = 0; i < count && strcmp(word[i], "--") != 0; i++)
        hints.wants_help |= strcmp(word[i], "--help") == 0 || strcmp(word[i], "-h") == 0;
    return hints;
}

/* Whether the command line holds the option, or the second operand, that a form is called by. */
static bool gives_form(const struct hints *hints, const char *form)
{
    if (*form != '-')
        return hints->operand[1] && strcmp(hints->operand[1], form) == 0;
    for (struct option_words w = hints->words; option_next(&w);)
        if (w.is_option && strcmp(w.text, form) == 0)
            return true;
    return false;
}

static bool takes_all(const struct program *program, const struct hints *hints)
{
    for (struct option_words w = hints->words; option_next(&w);)
        if (w.is_option && !option_find(w.table, program->option, w.text))
            return false;
    return true;
}

/* The form that is given, of several that which takes all options; else the row without a form, or
 * NULL. */
static const struct program *choose(const struct program_table *table, const char *name,
                                    const struct hints *hints)
{
    const struct program *plain = NULL, *form = NULL;
    for (unsigned i = 0; i < table->rows; i++) {
        const struct program *p = table->row + i;
        if (!is_named(p, name))
            continue;
        if (!p->form)
            plain = p;
        else if (gives_form(hints, p->form) && (!form || takes_all(p, hints)))
            form = p;
    }
    return form ? form : plain;
}

/* ---- what is refused ---- */

void program_try_names(const struct program_table *table, struct near *near)
{
    for (unsigned i = 0; i < table->rows; i++)
        if (table->row[i].name)
            near_try(near, table->row[i].name, strlen(table->row[i].name));
}

/* Which programs take an option of that name: "`iftty verify` and `iftty diff`"; "" for none. */
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

/* An option that no program has may be a misspelt one of this program, in any of its forms. */
static struct near options_near(const struct program_table *table, const struct program *program,
                                const char *option)
{
    struct near near = near_to(option);
    for (unsigned i = 0; i < table->rows; i++) {
        const struct program *p = table->row + i;
        for (const uint8_t *o = p->option; *o && is_named(p, program->name); o++)
            near_try(&near, table->option.row[*o].name, strlen(table->option.row[*o].name));
    }
    return near;
}

static enum err refuse_option(const struct program_table *table, const struct program *program,
                              const char *option, struct fault *fault)
{
    struct buf takers = {0}, name = {0};
    program_add_name(&name, table, program);
    add_takers(&takers, table, option);
    if (takers.length) {
        fault_set(fault, ERR_USAGE, "`%s` has no option %s; it belongs to %s", buf_text(&name),
                  option, buf_text(&takers));
    } else {
        const struct near near = options_near(table, program, option);
        fault_set(fault, ERR_USAGE, "`%s` has no option %s; see `%s --help`", buf_text(&name),
                  option, buf_text(&name));
        near_append(&near, "", fault);
    }
    buf_release(&takers);
    buf_release(&name);
    return ERR_USAGE;
}

static enum err check_operands(const struct program_table *table, const struct options *o,
                               struct fault *fault)
{
    const struct program *p = o->program;
    struct buf usage = {0};
    if (o->words >= p->least && o->words <= p->most)
        return OK;
    program_add_usage(&usage, table, p);
    fault_set(fault, ERR_USAGE, "expected `%s`, and there %s %d operand%s", buf_text(&usage),
              o->words == 1 ? "is" : "are", o->words, plural((uint64_t)o->words));
    buf_release(&usage);
    if (p->name || o->words == 0)
        return ERR_USAGE;
    struct near near = near_to(o->word[0]); /* perhaps a program was meant */
    program_try_names(table, &near);
    return near_append(&near, "", fault);
}

/* ---- reading ---- */

/* An option that the program takes or does not. */
static enum err read_option(const struct program_table *table, const struct option_words *w,
                            struct options *o, struct fault *fault)
{
    const struct option *row =
        table->option.row + option_find(&table->option, o->program->option, w->text);
    if (!row->name)
        return refuse_option(table, o->program, w->text, fault);
    if (row->value && !w->value)
        return fault_set(fault, ERR_USAGE, "%s needs a value, %s", w->text, row->value);
    return row->read(row, w->value, o, fault);
}

/* Operands and options, without the first `skip` operands, which said which program is meant. */
static enum err read_words(const struct program_table *table, struct option_words w, int skip,
                           struct options *o, struct fault *fault)
{
    enum err err = OK;
    o->word = w.word;
    o->words = 0;
    while (!err && option_next(&w)) {
        if (w.is_option)
            err = read_option(table, &w, o, fault);
        else if (skip > 0)
            skip--;
        else
            o->word[o->words++] = w.text;
    }
    return err;
}

enum err program_read(const struct program_table *table, int count, char **word,
                      struct options *options, struct fault *fault)
{
    const struct hints hints = take_hints(table, count, word);
    const char *name = knows_name(table, hints.operand[0]) ? hints.operand[0] : NULL;
    const struct program *program = choose(table, name, &hints);
    options->program = program;
    options->help = hints.wants_help;
    if (options->help)
        return OK;
    if (!program && hints.operand[0])
        return fault_set(fault, ERR_USAGE, "there is no program %s; see `%s --help`",
                         hints.operand[0], table->called);
    if (!program)
        return fault_set(fault, ERR_USAGE, "name a program; see `%s --help`", table->called);
    const bool is_operand = program->form && *program->form != '-';
    enum err err = read_words(table, hints.words, (name != NULL) + is_operand, options, fault);
    return err ? err : check_operands(table, options, fault);
}

static void print_help(const struct program_table *table, const struct program *program)
{
    struct buf text = {0};
    if (program && program->name)
        program_add_help(&text, table, program->name);
    else
        program_add_overview(&text, table);
    fputs(buf_text(&text), stdout);
    buf_release(&text);
}

int program_main(const struct program_table *table, int count, char **word, struct options *options)
{
    struct fault fault = {0};
    console_init(table->called);
    enum err err = program_read(table, count - 1, word + 1, options, &fault);
    if (!err && options->help)
        print_help(table, options->program);
    else if (!err)
        err = options->program->run(options, &fault);
    return console_finish(err, &fault);
}
