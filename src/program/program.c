#include "program/program.h"

#include <stdio.h>
#include <string.h>

#include "command/near.h"
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
    struct option_words words = hints.words;
    enum option_kind kind;
    int operands = 0;
    const char *value;
    char *at;
    while ((kind = option_next(&words, &at, &value)) != OPTION_END)
        if (kind == OPTION_OPERAND && operands < 2)
            hints.operand[operands++] = at;
    for (int i = 0; i < count && strcmp(word[i], "--") != 0; i++)
        hints.wants_help |= strcmp(word[i], "--help") == 0 || strcmp(word[i], "-h") == 0;
    return hints;
}

/* Whether the command line holds the option, or the second operand, that a form is called by. */
static bool gives_form(const struct hints *hints, const char *form)
{
    struct option_words words = hints->words;
    enum option_kind kind;
    const char *value;
    char *at;
    if (*form != '-')
        return hints->operand[1] && strcmp(hints->operand[1], form) == 0;
    while ((kind = option_next(&words, &at, &value)) != OPTION_END)
        if (kind == OPTION_OPTION && strcmp(at, form) == 0)
            return true;
    return false;
}

static bool takes_all(const struct program *program, const struct hints *hints)
{
    struct option_words words = hints->words;
    enum option_kind kind;
    const char *value;
    char *at;
    while ((kind = option_next(&words, &at, &value)) != OPTION_END)
        if (kind == OPTION_OPTION && !option_find(words.table, program->option, at))
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

static enum err refuse(const struct program_table *table, const struct program *program,
                       struct fault *fault, const char *what, const char *word, const char *end)
{
    struct buf name = {0};
    program_add_name(&name, table, program);
    fault_set(fault, ERR_USAGE, "%s%s; see `%s --help`%s", what, word, buf_text(&name), end);
    buf_release(&name);
    return ERR_USAGE;
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

static enum err refuse_option(const struct program_table *table, const struct program *program,
                              const char *option, struct fault *fault)
{
    struct buf takers = {0}, name = {0};
    struct near near = near_to(option);
    program_add_name(&name, table, program);
    add_takers(&takers, table, option);
    for (const uint8_t *o = program->option; *o; o++)
        near_try(&near, table->option.row[*o].name, strlen(table->option.row[*o].name));
    if (takers.length)
        fault_set(fault, ERR_USAGE, "`%s` has no option %s; it belongs to %s", buf_text(&name),
                  option, buf_text(&takers));
    else if (near.count > 0)
        fault_set(fault, ERR_USAGE, "`%s` has no option %s", buf_text(&name), option);
    else
        fault_set(fault, ERR_USAGE, "`%s` has no option %s; see `%s --help`", buf_text(&name),
                  option, buf_text(&name));
    if (!takers.length)
        near_append(&near, "", fault);
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
              o->words == 1 ? "is" : "are", o->words, o->words == 1 ? "" : "s");
    buf_release(&usage);
    if (p->name || o->words == 0)
        return ERR_USAGE;
    struct near near = near_to(o->word[0]); /* perhaps a program was meant */
    for (unsigned i = 0; i < table->rows; i++)
        if (table->row[i].name && (i == 0 || table->row[i].name != table->row[i - 1].name))
            near_try(&near, table->row[i].name, strlen(table->row[i].name));
    return near_append(&near, "", fault);
}

/* ---- reading ---- */

/* An option that the program takes or does not. */
static enum err read_option(const struct program_table *table, const char *name, const char *value,
                            struct options *o, struct fault *fault)
{
    const struct program *program = o->program;
    const struct option *row =
        table->option.row + option_find(&table->option, program->option, name);
    if (!row->name)
        return refuse_option(table, program, name, fault);
    if (row->value && !value)
        return refuse(table, program, fault, name, " needs a value", "");
    return row->read(row, value, o, fault);
}

enum err program_read(const struct program_table *table, int count, char **word,
                      struct options *options, struct fault *fault)
{
    const struct hints hints = take_hints(table, count, word);
    const char *name = knows_name(table, hints.operand[0]) ? hints.operand[0] : NULL;
    struct option_words words = hints.words;
    enum option_kind kind;
    enum err err = OK;
    const char *value;
    char *at;
    options->program = choose(table, name, &hints);
    options->help = hints.wants_help;
    if (options->help)
        return OK;
    if (!options->program && hints.operand[0])
        return fault_set(fault, ERR_USAGE, "there is no program %s; see `%s --help`",
                         hints.operand[0], table->called);
    if (!options->program)
        return fault_set(fault, ERR_USAGE, "name a program; see `%s --help`", table->called);
    const char *form = options->program->form;
    int skip = (name != NULL) + (form && *form != '-'); /* operands that said which program */
    options->word = word;
    options->words = 0;
    while (!err && (kind = option_next(&words, &at, &value)) != OPTION_END) {
        if (kind == OPTION_OPTION)
            err = read_option(table, at, value, options, fault);
        else if (skip > 0)
            skip--;
        else
            word[options->words++] = at;
    }
    return err ? err : check_operands(table, options, fault);
}

int program_main(const struct program_table *table, int count, char **word, struct options *options)
{
    struct fault fault = {0};
    struct buf help = {0};
    console_init(table->called);
    enum err err = program_read(table, count - 1, word + 1, options, &fault);
    if (!err && !options->help)
        return console_finish(options->program->run(options, &fault), &fault);
    if (!err && (!options->program || !options->program->name))
        program_add_overview(&help, table);
    else if (!err)
        program_add_help(&help, table, options->program->name);
    fputs(buf_text(&help), stdout);
    buf_release(&help);
    return console_finish(err, &fault);
}
