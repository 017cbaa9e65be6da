/* SPDX-License-Identifier: MIT */
/* What bash, zsh and fish complete: programs, their options, and what the value of one can be. A
 * word that is no name in a table is a file. */
#include "manual/manual.h"

#include <string.h>

#include "command/command.h"
#include "program/program.h"

/* ---- what there is to complete ---- */

enum { OPTIONS_MOST = 64 };
enum kind { KIND_NONE, KIND_FREE, KIND_WORDS, KIND_FILE, KIND_FOLDER, KINDS };

/* An option of a program in any of its forms, and what its value can be. */
struct offer {
    const char *program; /* NULL: the nameless one */
    const struct option *option;
    const char *help;
    enum kind kind;
};

static enum kind kind_of(const struct option *option)
{
    static const char *const files[] = {"FILE", "FILE.png", "PROGRAM", "KEY", "WAY"};
    if (!option->value)
        return KIND_NONE;
    if (option->add_choices)
        return KIND_WORDS;
    if (strcmp(option->value, "DIR") == 0)
        return KIND_FOLDER;
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++)
        if (strcmp(option->value, files[i]) == 0)
            return KIND_FILE;
    return KIND_FREE;
}

/* The options of a program, each once. What says which form is meant has the words of that form. */
static void add_offers(struct buf *out, const char *name,
                       void add(struct buf *out, const struct offer *offer))
{
    struct offer offer[OPTIONS_MOST];
    size_t n = 0;
    for (unsigned i = 0; i < program_table.rows; i++) {
        const struct program *p = program_table.row + i;
        for (const uint8_t *o = p->option; *o && manual_has_name(i, name); o++) {
            const struct option *option = program_table.option.row + *o;
            const char *help = *option->help ? option->help : p->summary;
            size_t k = 0;
            while (k < n && strcmp(offer[k].option->name, option->name) != 0)
                k++;
            if (k == n && n < OPTIONS_MOST)
                offer[n++] = (struct offer){name, option, help, kind_of(option)};
        }
    }
    for (size_t i = 0; i < n; i++)
        add(out, offer + i);
}

/* Each program that has a name, once. */
static void add_programs(struct buf *out, void add(struct buf *out, const char *name))
{
    for (unsigned i = 0; i < program_table.rows; i++)
        if (manual_new_name(i))
            add(out, manual_new_name(i));
}

/* The names of all programs. */
static void add_names(struct buf *out, const char *between)
{
    const char *before = "";
    for (unsigned i = 0; i < program_table.rows; i++)
        if (manual_new_name(i)) {
            buf_printf(out, "%s%s", before, manual_new_name(i));
            before = between;
        }
}

/* Words that a program takes besides files: those of its forms, and for `help`, which has no other
 * operand, the names of commands and programs. */
static void add_operands(struct buf *out, const char *name)
{
    for (unsigned i = 0; i < program_table.rows; i++) {
        const struct program *p = program_table.row + i;
        if (manual_has_name(i, name) && p->form && *p->form != '-')
            buf_printf(out, "%s%s", out->length ? " " : "", p->form);
        if (!manual_has_name(i, name) || !strstr(p->words, "COMMAND|PROGRAM"))
            continue;
        add_names(out, " ");
        for (unsigned k = 0; k < command_count(); k++)
            buf_printf(out, " %s", command_at(k)->name);
    }
}

/* Text between single quotes, with a backslash before each of these; bash and zsh end the quotes
 * for one. */
static void add_quoted(struct buf *out, const char *text, const char *special, bool ends)
{
    for (; *text; text++)
        if (*text == '\'')
            buf_add_text(out, ends ? "'\\''" : "\\'");
        else
            buf_printf(out, "%s%c", strchr(special, *text) ? "\\" : "", *text);
}

/* ---- bash ---- */

static void add_bash_value(struct buf *out, const struct offer *offer)
{
    static const char *const takes[KINDS] = {NULL, "free", "words", "files", "folders"};
    if (offer->kind == KIND_NONE)
        return;
    buf_printf(out, "    %s,%s) ", offer->program ? offer->program : "", offer->option->name);
    if (offer->kind == KIND_WORDS) {
        buf_add_text(out, "words='");
        offer->option->add_choices(out, " ", " ");
        buf_add_text(out, "' ");
    }
    buf_printf(out, "takes=%s ;;\n", takes[offer->kind]);
}

static void add_bash_values(struct buf *out, const char *name)
{
    add_offers(out, name, add_bash_value);
}

static void add_bash_name(struct buf *out, const struct offer *offer)
{
    buf_printf(out, "%s ", offer->option->name);
}

static void add_bash_words(struct buf *out, const char *name)
{
    buf_printf(out, "    %s) options='", name ? name : "''");
    add_offers(out, name, add_bash_name);
    buf_add_text(out, "--help' words='");
    if (name)
        add_operands(out, name);
    else
        add_names(out, " ");
    buf_add_text(out, "' ;;\n");
}

void completion_bash(struct buf *out)
{
    buf_add_text(out, "# Completion of iftty for bash, made of its tables.\n"
                      "_iftty() {\n"
                      "    local word=${COMP_WORDS[COMP_CWORD]} program= any= at\n"
                      "    local options= words= takes=operands\n"
                      "    for ((at = 1; at < COMP_CWORD; at++)); do\n"
                      "        case ${COMP_WORDS[at]} in\n"
                      "        ");
    for (unsigned i = 1, k; i < program_table.option.rows; i++) {
        const struct option *row = program_table.option.row;
        for (k = 1; strcmp(row[k].name, row[i].name) != 0; k++)
            ;
        if (row[i].value && k == i) /* names may come again */
            buf_printf(out, "%s | ", row[i].name);
    }
    buf_add_text(out, "--) at=$((at + 1)) ;;\n"
                      "        -*) ;;\n"
                      "        *) program=${COMP_WORDS[at]} any=yes; break ;;\n"
                      "        esac\n"
                      "    done\n"
                      "    case $program in\n"
                      "    ");
    add_names(out, " | ");
    buf_add_text(out, ") ;;\n"
                      "    *) program= ;;\n"
                      "    esac\n"
                      "    case $program in\n");
    add_bash_words(out, NULL);
    add_programs(out, add_bash_words);
    buf_add_text(out, "    esac\n"
                      "    [ -z \"$any\" ] || [ -n \"$program\" ] || words=\n"
                      "    case $program,${COMP_WORDS[COMP_CWORD - 1]} in\n");
    add_bash_values(out, NULL);
    add_programs(out, add_bash_values);
    buf_add_text(out,
                 "    esac\n"
                 "    COMPREPLY=()\n"
                 "    case $takes,$word in\n"
                 "    operands,-*) mapfile -t COMPREPLY < <(compgen -W \"$options\" -- \"$word\")\n"
                 "        return ;;\n"
                 "    operands,* | words,*)\n"
                 "        mapfile -t COMPREPLY < <(compgen -W \"$words\" -- \"$word\") ;;\n"
                 "    esac\n"
                 "    case $takes in\n"
                 "    operands | files) at=-f ;;\n"
                 "    folders) at=-d ;;\n"
                 "    *) return ;;\n"
                 "    esac\n"
                 "    compopt -o filenames 2>/dev/null\n"
                 "    mapfile -t -O ${#COMPREPLY[@]} COMPREPLY < <(compgen $at -- \"$word\")\n"
                 "}\n"
                 "complete -F _iftty iftty\n");
}

/* ---- zsh ---- */

static void add_zsh_option(struct buf *out, const struct offer *offer)
{
    static const char *const action[KINDS] = {NULL, ": ", ":(", ":_files", ":_files -/"};
    buf_printf(out, " \\\n            '%s[", offer->option->name);
    add_quoted(out, offer->help, "[]:\\", true);
    buf_add_char(out, ']');
    if (offer->kind != KIND_NONE) {
        buf_add_char(out, ':');
        add_quoted(out, offer->option->value, ":\\", true);
        buf_add_text(out, action[offer->kind]);
    }
    if (offer->kind == KIND_WORDS) {
        offer->option->add_choices(out, " ", " ");
        buf_add_char(out, ')');
    }
    buf_add_char(out, '\'');
}

static void add_zsh_summary(struct buf *out, const char *name)
{
    buf_printf(out, "\n        '%s:", name);
    add_quoted(out, manual_summary(name), ":\\", true);
    buf_add_char(out, '\'');
}

static void add_zsh_program(struct buf *out, const char *name)
{
    struct buf operands = {0};
    buf_printf(out, "        %s) _arguments", name);
    add_offers(out, name, add_zsh_option);
    add_operands(&operands, name);
    if (operands.length)
        buf_printf(out, " \\\n            '1: :(%s)'", buf_text(&operands));
    buf_add_text(out, " \\\n            '*: :_files' ;;\n");
    out->failed |= operands.failed;
    buf_release(&operands);
}

void completion_zsh(struct buf *out)
{
    buf_add_text(out, "#compdef iftty\n"
                      "# Completion of iftty for zsh, made of its tables.\n"
                      "_iftty() {\n"
                      "    local curcontext=$curcontext state line\n"
                      "    typeset -A opt_args\n"
                      "    local -a programs=(");
    add_programs(out, add_zsh_summary);
    buf_add_text(out, ")\n    _arguments -C");
    add_offers(out, NULL, add_zsh_option);
    buf_add_text(out, " \\\n            '1: :->first' '*:: :->rest' && return\n"
                      "    case $state in\n"
                      "    first) _describe -t programs program programs; _files ;;\n"
                      "    rest)\n"
                      "        case $line[1] in\n");
    add_programs(out, add_zsh_program);
    buf_add_text(out, "        esac ;;\n"
                      "    esac\n"
                      "}\n"
                      "_iftty \"$@\"\n");
}

/* ---- fish ---- */

static void add_fish_option(struct buf *out, const struct offer *offer)
{
    static const char *const takes[KINDS] = {"", " -x", " -x -a '", " -r -F",
                                             " -x -a '(__fish_complete_directories)'"};
    const char *own = offer->option->name;
    const bool is_long = own[1] == '-';
    buf_printf(out, "complete -c iftty -n '%s__fish_seen_subcommand_from ",
               offer->program ? "" : "not ");
    if (offer->program)
        buf_add_text(out, offer->program);
    else
        add_names(out, " ");
    buf_printf(out, "' %s %s%s", is_long ? "-l" : "-s", own + (is_long ? 2 : 1),
               takes[offer->kind]);
    if (offer->kind == KIND_WORDS) {
        offer->option->add_choices(out, " ", " ");
        buf_add_char(out, '\'');
    }
    buf_add_text(out, " -d '");
    add_quoted(out, offer->help, "\\", false);
    buf_add_text(out, "'\n");
}

static void add_fish_program(struct buf *out, const char *name)
{
    struct buf operands = {0};
    buf_printf(out, "complete -c iftty -n __fish_use_subcommand -a %s -d '", name);
    add_quoted(out, manual_summary(name), "\\", false);
    buf_add_text(out, "'\n");
    add_offers(out, name, add_fish_option);
    add_operands(&operands, name);
    if (operands.length)
        buf_printf(out, "complete -c iftty -n '__fish_seen_subcommand_from %s' -a '%s'\n", name,
                   buf_text(&operands));
    out->failed |= operands.failed;
    buf_release(&operands);
}

void completion_fish(struct buf *out)
{
    buf_add_text(out, "# Completion of iftty for fish, made of its tables.\n");
    add_offers(out, NULL, add_fish_option);
    add_programs(out, add_fish_program);
}
