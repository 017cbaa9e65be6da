/* What bash, zsh and fish complete: programs, their options, and what the value of one can be. A
 * word that is no name in a table is a file. */
#include "manual/manual.h"

#include <string.h>

#include "command/command.h"
#include "program/program.h"

/* ---- what there is to complete ---- */

enum { OPTIONS_MOST = 64 };

/* An option of a program in any of its forms. */
struct offer {
    const struct option *option;
    const char *help;
};

static bool is_named(unsigned row, const char *name)
{
    const char *own = program_table.row[row].name;
    return name && own ? strcmp(own, name) == 0 : name == own;
}

/* Those of the program of that name, NULL for the nameless one, each once. What says which form is
 * meant has the words of that form. */
static size_t list_offers(struct offer offer[OPTIONS_MOST], const char *name)
{
    size_t n = 0;
    for (unsigned i = 0; i < program_table.rows; i++)
        for (const uint8_t *o = program_table.row[i].option; *o && is_named(i, name); o++) {
            const struct option *option = program_table.option.row + *o;
            size_t k = 0;
            while (k < n && strcmp(offer[k].option->name, option->name) != 0)
                k++;
            if (k == n && n < OPTIONS_MOST)
                offer[n++] = (struct offer){option, *option->help ? option->help
                                                                  : program_table.row[i].summary};
        }
    return n;
}

enum kind { KIND_NONE, KIND_FREE, KIND_WORDS, KIND_FILE, KIND_FOLDER };

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

/* The names of all programs. */
static void add_names(struct buf *out, const char *between)
{
    const char *before = "";
    for (unsigned i = 0; i < program_table.rows; i++)
        if (program_table.row[i].name && manual_is_first(i)) {
            buf_printf(out, "%s%s", before, program_table.row[i].name);
            before = between;
        }
}

/* Words that a program takes besides files: those of its forms, and for `help`, which has no other
 * operand, the names of commands and programs. */
static void add_operands(struct buf *out, const char *name)
{
    for (unsigned i = 0; i < program_table.rows; i++) {
        const struct program *p = program_table.row + i;
        if (is_named(i, name) && p->form && *p->form != '-')
            buf_printf(out, "%s%s", out->length ? " " : "", p->form);
        if (!is_named(i, name) || !strstr(p->words, "COMMAND|PROGRAM"))
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

static void add_bash_values(struct buf *out, const char *name)
{
    struct offer offer[OPTIONS_MOST];
    const size_t n = list_offers(offer, name);
    for (size_t i = 0; i < n; i++) {
        const enum kind kind = kind_of(offer[i].option);
        if (kind == KIND_NONE)
            continue;
        buf_printf(out, "    %s,%s) ", name ? name : "", offer[i].option->name);
        if (kind == KIND_WORDS) {
            buf_add_text(out, "words='");
            offer[i].option->add_choices(out, " ", " ");
            buf_add_text(out, "' takes=words ;;\n");
        } else {
            buf_printf(out, "takes=%s ;;\n",
                       kind == KIND_FILE     ? "files"
                       : kind == KIND_FOLDER ? "folders"
                                             : "free");
        }
    }
}

static void add_bash_words(struct buf *out, const char *name)
{
    struct offer offer[OPTIONS_MOST];
    const size_t n = list_offers(offer, name);
    buf_printf(out, "    %s) options='", name ? name : "''");
    for (size_t i = 0; i < n; i++)
        buf_printf(out, "%s ", offer[i].option->name);
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
    for (unsigned i = 0; i < program_table.rows; i++)
        if (program_table.row[i].name && manual_is_first(i))
            add_bash_words(out, program_table.row[i].name);
    buf_add_text(out, "    esac\n"
                      "    [ -z \"$any\" ] || [ -n \"$program\" ] || words=\n"
                      "    case $program,${COMP_WORDS[COMP_CWORD - 1]} in\n");
    add_bash_values(out, NULL);
    for (unsigned i = 0; i < program_table.rows; i++)
        if (program_table.row[i].name && manual_is_first(i))
            add_bash_values(out, program_table.row[i].name);
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

static void add_zsh_options(struct buf *out, const char *name)
{
    struct offer offer[OPTIONS_MOST];
    const size_t n = list_offers(offer, name);
    for (size_t i = 0; i < n; i++) {
        const struct option *option = offer[i].option;
        const enum kind kind = kind_of(option);
        buf_printf(out, " \\\n            '%s[", option->name);
        add_quoted(out, offer[i].help, "[]:\\", true);
        buf_add_char(out, ']');
        if (kind != KIND_NONE) {
            buf_add_char(out, ':');
            add_quoted(out, option->value, ":\\", true);
            buf_add_text(out, kind == KIND_FILE     ? ":_files"
                              : kind == KIND_FOLDER ? ":_files -/"
                              : kind == KIND_WORDS  ? ":("
                                                    : ": ");
        }
        if (kind == KIND_WORDS) {
            option->add_choices(out, " ", " ");
            buf_add_char(out, ')');
        }
        buf_add_char(out, '\'');
    }
}

void completion_zsh(struct buf *out)
{
    buf_add_text(out, "#compdef iftty\n"
                      "# Completion of iftty for zsh, made of its tables.\n"
                      "_iftty() {\n"
                      "    local curcontext=$curcontext state line\n"
                      "    typeset -A opt_args\n"
                      "    local -a programs=(");
    for (unsigned i = 0; i < program_table.rows; i++) {
        if (!program_table.row[i].name || !manual_is_first(i))
            continue;
        buf_printf(out, "\n        '%s:", program_table.row[i].name);
        add_quoted(out, program_table.row[i].summary, ":\\", true);
        buf_add_char(out, '\'');
    }
    buf_add_text(out, ")\n    _arguments -C");
    add_zsh_options(out, NULL);
    buf_add_text(out, " \\\n            '1: :->first' '*:: :->rest' && return\n"
                      "    case $state in\n"
                      "    first) _describe -t programs program programs; _files ;;\n"
                      "    rest)\n"
                      "        case $line[1] in\n");
    for (unsigned i = 0; i < program_table.rows; i++) {
        const char *name = program_table.row[i].name;
        struct buf operands = {0};
        if (!name || !manual_is_first(i))
            continue;
        buf_printf(out, "        %s) _arguments", name);
        add_zsh_options(out, name);
        add_operands(&operands, name);
        if (operands.length)
            buf_printf(out, " \\\n            '1: :(%s)'", buf_text(&operands));
        buf_add_text(out, " \\\n            '*: :_files' ;;\n");
        out->failed |= operands.failed;
        buf_release(&operands);
    }
    buf_add_text(out, "        esac ;;\n"
                      "    esac\n"
                      "}\n"
                      "_iftty \"$@\"\n");
}

/* ---- fish ---- */

static void add_fish_options(struct buf *out, const char *name)
{
    struct offer offer[OPTIONS_MOST];
    const size_t n = list_offers(offer, name);
    for (size_t i = 0; i < n; i++) {
        const struct option *option = offer[i].option;
        const enum kind kind = kind_of(option);
        const bool is_long = option->name[1] == '-';
        buf_printf(out, "complete -c iftty -n '%s__fish_seen_subcommand_from ", name ? "" : "not ");
        if (name)
            buf_add_text(out, name);
        else
            add_names(out, " ");
        buf_printf(out, "' %s %s", is_long ? "-l" : "-s", option->name + (is_long ? 2 : 1));
        if (kind == KIND_WORDS) {
            buf_add_text(out, " -x -a '");
            option->add_choices(out, " ", " ");
            buf_add_char(out, '\'');
        } else if (kind != KIND_NONE) {
            buf_add_text(out, kind == KIND_FILE     ? " -r -F"
                              : kind == KIND_FOLDER ? " -x -a '(__fish_complete_directories)'"
                                                    : " -x");
        }
        buf_add_text(out, " -d '");
        add_quoted(out, offer[i].help, "\\", false);
        buf_add_text(out, "'\n");
    }
}

void completion_fish(struct buf *out)
{
    buf_add_text(out, "# Completion of iftty for fish, made of its tables.\n");
    add_fish_options(out, NULL);
    for (unsigned i = 0; i < program_table.rows; i++) {
        const char *name = program_table.row[i].name;
        struct buf operands = {0};
        if (!name || !manual_is_first(i))
            continue;
        buf_printf(out, "complete -c iftty -n __fish_use_subcommand -a %s -d '", name);
        add_quoted(out, program_table.row[i].summary, "\\", false);
        buf_add_text(out, "'\n");
        add_fish_options(out, name);
        add_operands(&operands, name);
        if (operands.length)
            buf_printf(out, "complete -c iftty -n '__fish_seen_subcommand_from %s' -a '%s'\n", name,
                       buf_text(&operands));
        out->failed |= operands.failed;
        buf_release(&operands);
    }
}
