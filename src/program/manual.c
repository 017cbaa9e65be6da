/* SPDX-License-Identifier: MIT */
/*
 * iftty-manual FOLDER: writes the manual pages and the completions of bash, zsh and fish below a
 * folder that has the folders of PREFIX/share. Both are generated from the tables of programs,
 * options and commands; only the sentences between are written here. It runs where iftty is built
 * and is not installed.
 *
 * Pages use the macros of man(7), as groff and mandoc both set them: special characters are
 * escaped, and no line is longer than LINE_MOST.
 */
#include <ctype.h>
#include <stdio.h>
#include <string.h>

#include "base/buf.h"
#include "base/file.h"
#include "base/mem.h"
#include "base/version.h"
#include "command/command.h"
#include "program/program.h"

enum { LINE_MOST = 78, OPTIONS_MOST = 64 };

/* ---- the table of programs ---- */

/* The name of the program in a row; "" for the program without one. */
static const char *name_of(unsigned row)
{
    const char *name = program_table.row[row].name;
    return name ? name : "";
}

/* The first row from this one on whose name no earlier row has; otherwise the number of rows. */
static unsigned new_row(unsigned row)
{
    for (unsigned i = 0; row < program_table.rows && i < row; i++)
        if (strcmp(name_of(i), name_of(row)) == 0)
            return new_row(row + 1);
    return row;
}

/* Add the names of all programs but the nameless one. */
static void add_names(struct buf *out, const char *between)
{
    const char *before = "";
    for (unsigned i = new_row(0); i < program_table.rows; i = new_row(i + 1))
        if (*name_of(i)) {
            buf_printf(out, "%s%s", before, name_of(i));
            before = between;
        }
}

/* ---- text in pages ---- */

/* Add text with special characters escaped, such as '-', which would become a hyphen; a line may
 * break after '|'. */
static void add_escaped(struct buf *out, const char *text, size_t length)
{
    static const char plain[] = "\\-`'~^\"|";
    static const char *const set[] = {"\\e",   "\\-",   "\\(ga", "\\(aq",
                                      "\\(ti", "\\(ha", "\\(dq", "|\\:"};
    for (size_t i = 0; i < length; i++) {
        const char *special = text[i] ? strchr(plain, text[i]) : NULL;
        if (special)
            buf_add_text(out, set[special - plain]);
        else
            buf_add_char(out, text[i]);
    }
}

/* Add text in lines; each line feed of `text` ends a paragraph. */
static void add_text(struct buf *out, const char *text, const char *between)
{
    OWNED(buf_release) struct buf word = {0};
    for (size_t column = 0; *text;) {
        const size_t length = strcspn(text, " \n");
        buf_clear(&word);
        add_escaped(&word, text, length);
        if (column && column + 1 + word.length > LINE_MOST) {
            buf_add_char(out, '\n');
            column = 0;
        }
        const char *before = column ? " " : *buf_text(&word) == '.' ? "\\&" : "";
        buf_printf(out, "%s%s", before, buf_text(&word));
        column += strlen(before) + word.length;
        text += length;
        if (*text == '\n' && text[1]) {
            buf_printf(out, "\n%s\n", between);
            column = 0;
        }
        text += strspn(text, " \n");
    }
    buf_add_char(out, '\n');
    out->failed |= word.failed;
}

/* Add a line in bold, and release its text. */
static void add_typed(struct buf *out, struct buf *typed)
{
    buf_add_text(out, "\\fB");
    add_escaped(out, buf_text(typed), typed->length);
    buf_add_text(out, "\\fP\n");
    out->failed |= typed->failed;
    buf_release(typed);
}

static void add_capitals(struct buf *out, const char *text)
{
    for (; *text; text++)
        buf_add_char(out, (char)toupper((unsigned char)*text));
}

static void add_title(struct buf *out, const char *name, int section, const char *summary)
{
    buf_add_text(out, ".TH ");
    add_capitals(out, name);
    buf_printf(out, " %d " PROGRAM_DATE " \"iftty " PROGRAM_VERSION "\"\n.ad l\n.SH NAME\n",
               section);
    add_escaped(out, name, strlen(name));
    buf_add_text(out, " \\- ");
    add_text(out, summary, "");
}

/* ---- pages ---- */

static void add_usage(struct buf *out, const struct program *program)
{
    struct buf usage = {0};
    program_add_usage(&usage, &program_table, program);
    add_typed(out, &usage);
}

/* Add all forms of a program with their options. */
static void add_forms(struct buf *out, const char *name)
{
    for (unsigned i = 0; i < program_table.rows; i++) {
        const struct program *p = program_table.row + i;
        if (strcmp(name_of(i), name) != 0)
            continue;
        buf_add_text(out, ".SS ");
        add_usage(out, p);
        buf_add_char(out, (char)toupper((unsigned char)*p->summary));
        add_text(out, p->summary + 1, ".PP");
        if (p->detail) {
            buf_add_text(out, ".PP\n");
            add_text(out, p->detail, ".PP");
        }
        for (const uint8_t *o = p->option; *o; o++) {
            const struct option *option = program_table.option.row + *o;
            if (!*option->help)
                continue;
            buf_add_text(out, ".TP\n\\fB");
            add_escaped(out, option->name, strlen(option->name));
            buf_add_text(out, option->value ? "\\fP " : "\\fP");
            if (option->add_choices)
                option->add_choices(out, "|\\:", "|\\:");
            else if (option->value)
                add_escaped(out, option->value, strlen(option->value));
            buf_add_char(out, '\n');
            add_text(out, option->help, ".IP");
        }
    }
}

/* Add the names of all pages but `own`: "iftty", "iftty-verify", "iftty-journal". */
static void add_see_also(struct buf *out, const char *own)
{
    const char *between = ".SH SEE ALSO\n.BR ";
    for (unsigned i = new_row(0); i < program_table.rows; i = new_row(i + 1)) {
        const char *name = name_of(i);
        char page[64];
        snprintf(page, sizeof page, "iftty%s%s", *name ? "-" : "", name);
        if (strcmp(page, own) == 0)
            continue;
        buf_add_text(out, between);
        add_escaped(out, page, strlen(page));
        buf_add_text(out, " (1)");
        between = ",\n.BR ";
    }
    buf_add_text(out, strcmp(own, "iftty-journal") == 0 ? "\n" : ",\n.BR iftty\\-journal (5)\n");
}

/* Write iftty(1) of the nameless program, or iftty-NAME(1); `first` is its first row. */
static void add_program_page(struct buf *out, unsigned first)
{
    char page[64];
    const char *name = name_of(first);
    snprintf(page, sizeof page, "iftty%s%s", *name ? "-" : "", name);
    add_title(out, page, 1,
              *name ? program_table.row[first].summary : strchr(program_table.about, ' ') + 1);
    buf_add_text(out, ".SH SYNOPSIS\n.nf\n");
    for (unsigned i = 0; i < program_table.rows; i++)
        if (!*name || strcmp(name_of(i), name) == 0)
            add_usage(out, program_table.row + i);
    buf_add_text(out, ".fi\n.SH DESCRIPTION\n");
    if (!*name) {
        buf_add_text(out, "Each program has a page of its own, such as\n.BR iftty\\-verify (1).\n"
                          "The commands of prompt, script and journal are in\n"
                          ".BR iftty\\-journal (5).\n");
        for (unsigned i = 0; i < program_table.rows; i++) {
            buf_add_text(out, ".TP\n");
            add_usage(out, program_table.row + i);
            add_text(out, program_table.row[i].summary, ".IP");
        }
        buf_add_text(out, ".SH OPTIONS\n");
    }
    add_forms(out, name);
    if (!*name) {
        buf_add_text(out, ".SH EXIT STATUS\n.nf\n");
        add_text(out, program_table.closing, ".br");
        buf_add_text(out, ".fi\n.SH NOTES\n"
                          "This is software for research, and no medical device: nothing that\n"
                          "it computes or shows is meant for diagnosis or treatment.\n");
    }
    add_see_also(out, page);
}

static void add_journal_page(struct buf *out)
{
    add_title(out, "iftty-journal", 5, "the commands of a session, in order, with their results");
    buf_add_text(out, ".SH DESCRIPTION\n");
    add_text(out,
             "A journal is a text file. Its first line has its format, and the meaning of its "
             "commands as a number. Each record is a command as it is typed at the prompt, and a "
             "line with digests of its results and a chain of digests over all records before. A "
             "script is a file of commands without that first line.\n"
             "The commands follow. FORMAT.md, which is installed with the documentation of iftty, "
             "defines a journal byte for byte.",
             ".PP");
    for (enum command_group group = 0; group < GROUPS; group++) {
        buf_add_text(out, ".SH ");
        add_capitals(out, command_group_name[group]);
        buf_add_char(out, '\n');
        for (unsigned i = 0; i < command_count(); i++) {
            const struct command *command = command_at(i);
            struct buf usage = {0}, example = {0};
            if (command->group != group)
                continue;
            command_usage(&usage, command);
            buf_add_text(out, ".TP\n");
            add_typed(out, &usage);
            add_text(out, command->summary, ".IP");
            if (command->detail) {
                buf_add_text(out, ".IP\n");
                add_text(out, command->detail, ".IP");
            }
            buf_add_text(out, ".IP\nExample:\n");
            buf_add_text(&example, command->example);
            add_typed(out, &example);
        }
    }
    add_see_also(out, "iftty-journal");
}

/* ---- completions: names of programs, their options, and choices of values; else files ---- */

enum kind { KIND_NONE, KIND_FREE, KIND_WORDS, KIND_FILE, KIND_FOLDER, KINDS };

static enum kind kind_of(const struct option *option)
{
    static const char files[] = " FILE FILE.png PROGRAM KEY WAY ";
    char value[32];
    if (!option->value || option->add_choices)
        return option->value ? KIND_WORDS : KIND_NONE;
    snprintf(value, sizeof value, " %s ", option->value);
    return strcmp(option->value, "DIR") == 0 ? KIND_FOLDER
           : strstr(files, value)            ? KIND_FILE
                                             : KIND_FREE;
}

/* An option of any form of a program. An option that selects a form is described by the summary of
 * that form. */
struct offer {
    const struct option *option;
    const char *help;
};

static size_t find_offers(struct offer offer[OPTIONS_MOST], const char *name)
{
    size_t n = 0;
    for (unsigned i = 0; i < program_table.rows; i++) {
        const struct program *p = program_table.row + i;
        for (const uint8_t *o = p->option; *o && strcmp(name_of(i), name) == 0; o++) {
            const struct option *option = program_table.option.row + *o;
            size_t k = 0;
            while (k < n && strcmp(offer[k].option->name, option->name) != 0)
                k++;
            if (k == n && n < OPTIONS_MOST)
                offer[n++] = (struct offer){option, *option->help ? option->help : p->summary};
        }
    }
    return n;
}

/* Add the words that a program accepts in addition to files. */
static void add_operands(struct buf *out, unsigned row)
{
    const bool has_commands = strstr(program_table.row[row].words, "COMMAND");
    if (!*name_of(row) || has_commands)
        add_names(out, " ");
    for (unsigned k = 0; has_commands && k < command_count(); k++)
        buf_printf(out, " %s", command_at(k)->name);
}

static void add_bash(struct buf *out)
{
    static const char *const kinds[KINDS] = {NULL, "free", "words", "files", "folders"};
    struct offer offer[OPTIONS_MOST];
    buf_add_text(out, "__iftty() {\n"
                      "    local word=${COMP_WORDS[COMP_CWORD]} program= any= at IFS=$' \\n'\n"
                      "    local options= words= kind=operands\n"
                      "    for ((at = 1; at < COMP_CWORD; at++)); do\n"
                      "        case ${COMP_WORDS[at]} in\n"
                      "        ");
    for (unsigned i = 1; i < program_table.option.rows; i++)
        if (program_table.option.row[i].value)
            buf_printf(out, "%s | ", program_table.option.row[i].name);
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
    for (unsigned i = new_row(0); i < program_table.rows; i = new_row(i + 1)) {
        const char *name = name_of(i);
        buf_printf(out, "    %s) options='", *name ? name : "''");
        for (size_t k = 0, n = find_offers(offer, name); k < n; k++)
            buf_printf(out, "%s ", offer[k].option->name);
        buf_add_text(out, "--help' words='");
        add_operands(out, i);
        buf_add_text(out, "' ;;\n");
    }
    buf_add_text(out, "    esac\n"
                      "    [ -z \"$any\" ] || [ -n \"$program\" ] || words=\n"
                      "    case $program,${COMP_WORDS[COMP_CWORD - 1]} in\n");
    for (unsigned i = new_row(0); i < program_table.rows; i = new_row(i + 1)) {
        const char *name = name_of(i);
        for (size_t k = 0, n = find_offers(offer, name); k < n; k++) {
            const enum kind kind = kind_of(offer[k].option);
            if (kind == KIND_NONE)
                continue;
            buf_printf(out, "    %s,%s) kind=%s words='", name, offer[k].option->name, kinds[kind]);
            if (kind == KIND_WORDS)
                offer[k].option->add_choices(out, " ", " ");
            buf_add_text(out, "' ;;\n");
        }
    }
    buf_add_text(out, "    esac\n"
                      "    case $kind,$word in\n"
                      "    operands,-*) kind=options words=$options ;;\n"
                      "    operands,* | files,*) at=-f ;;\n"
                      "    folders,*) at=-d ;;\n"
                      "    esac\n"
                      "    IFS=$'\\n'\n"
                      "    COMPREPLY=($(IFS=' '; compgen -W \"$words\" -- \"$word\"))\n"
                      "    case $kind in\n"
                      "    operands | files | folders)\n"
                      "        COMPREPLY+=($(compgen $at -- \"$word\"))\n"
                      "        compopt -o filenames 2>/dev/null ;;\n"
                      "    esac\n"
                      "}\n"
                      "complete -F __iftty iftty\n");
}

/* zsh uses the function of bash. */
static void add_zsh(struct buf *out)
{
    buf_add_text(out, "#compdef iftty\nautoload -U +X bashcompinit && bashcompinit\n");
    add_bash(out);
    buf_add_text(out, "_bash_complete -F __iftty\n");
}

/* Add a description between single quotes of fish. */
static void add_fish_help(struct buf *out, const char *text)
{
    buf_add_text(out, " -d '");
    for (; *text; text++)
        buf_printf(out, "%s%c", strchr("\\'", *text) ? "\\" : "", *text);
    buf_add_text(out, "'\n");
}

static void add_fish(struct buf *out)
{
    static const char *const kinds[KINDS] = {"", " -x", " -x -a '", " -r -F",
                                             " -x -a '(__fish_complete_directories)'"};
    struct offer offer[OPTIONS_MOST];
    for (unsigned i = new_row(0); i < program_table.rows; i = new_row(i + 1)) {
        const char *name = name_of(i);
        if (*name) {
            buf_printf(out, "complete -c iftty -n __fish_use_subcommand -a %s", name);
            add_fish_help(out, program_table.row[i].summary);
        }
        if (strstr(program_table.row[i].words, "COMMAND")) {
            buf_printf(out, "complete -c iftty -n '__fish_seen_subcommand_from %s' -a '", name);
            add_operands(out, i);
            buf_add_text(out, "'\n");
        }
        for (size_t k = 0, n = find_offers(offer, name); k < n; k++) {
            const struct option *option = offer[k].option;
            const bool is_long = option->name[1] == '-';
            buf_printf(out, "complete -c iftty -n '%s__fish_seen_subcommand_from %s",
                       *name ? "" : "not ", name);
            if (!*name)
                add_names(out, " ");
            buf_printf(out, "' %s %s%s", is_long ? "-l" : "-s", option->name + (is_long ? 2 : 1),
                       kinds[kind_of(option)]);
            if (kind_of(option) == KIND_WORDS) {
                option->add_choices(out, " ", " ");
                buf_add_char(out, '\'');
            }
            add_fish_help(out, offer[k].help);
        }
    }
}

/* ---- files ---- */

/* Write a file and empty the text. False, after a message, on error. */
static bool write_file(const char *folder, const char *name, struct buf *text)
{
    char path[4096];
    struct fault fault = {.text = "out of memory"};
    snprintf(path, sizeof path, "%s/%s", folder, name);
    const bool written =
        !text->failed && !file_write(path, text->data, text->length, FILE_REPLACE, &fault);
    if (!written)
        fprintf(stderr, "iftty-manual: %s\n", fault.text);
    buf_clear(text);
    return written;
}

int main(int count, char **word)
{
    static const struct {
        const char *name;
        void (*add)(struct buf *out);
    } single[] = {{"man/man5/iftty-journal.5", add_journal_page},
                  {"bash-completion/completions/iftty", add_bash},
                  {"zsh/site-functions/_iftty", add_zsh},
                  {"fish/vendor_completions.d/iftty.fish", add_fish}};
    OWNED(buf_release) struct buf text = {0};
    bool written = count == 2;
    for (size_t i = 0; written && i < sizeof single / sizeof single[0]; i++) {
        single[i].add(&text);
        written = write_file(word[1], single[i].name, &text);
    }
    for (unsigned i = new_row(0); written && i < program_table.rows; i = new_row(i + 1)) {
        const char *name = name_of(i);
        char file[128];
        add_program_page(&text, i);
        snprintf(file, sizeof file, "man/man1/iftty%s%s.1", *name ? "-" : "", name);
        written = write_file(word[1], file, &text);
    }
    return written ? 0 : 3;
}
