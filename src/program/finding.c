/* SPDX-License-Identifier: MIT */
#include "program/finding.h"

#include <string.h>

#include "command/find.h"

enum { KEYS_MOST = 6 };

/* The row that does the same as words of a command: by its line, or as it is called. NULL for none.
 */
static const struct pilot_row *row_of(const char *words, size_t length)
{
    const size_t name = strcspn(words, " \t\n");
    for (const struct pilot_row *row = pilot_table; row < pilot_table + pilot_rows; row++)
        if (row->command && strncmp(row->command, words, length) == 0 &&
            row->command[length] == '\n')
            return row;
    for (const struct pilot_row *row = pilot_table; row < pilot_table + pilot_rows; row++)
        if (row->name && strncmp(row->name, words, name) == 0 && row->name[name] == '\0')
            return row;
    return NULL;
}

static bool has_piece(const char *text, const char *piece)
{
    return text && strcasestr(text, piece);
}

/* As notes of the list, which are no words to be taken; but for those that stand there. */
static void add_keys(struct buf *out, const char *piece, const struct pilot_setup *setup,
                     const bool *is_there)
{
    unsigned count = 0;
    for (const struct pilot_row *row = pilot_table; row < pilot_table + pilot_rows; row++) {
        const char *help = row->help && *row->help ? row->help : row->hint ? row->hint : "";
        if (!row->name || is_there[row - pilot_table] ||
            !(has_piece(row->name, piece) || has_piece(help, piece)) || count++ == KEYS_MOST)
            continue;
        buf_add_char(out, '\t');
        setup_add_keys(out, setup, row, 1);
        buf_printf(out, "\tin the pilot, %s%s%s\n", row->name, *help ? ": " : "", help);
    }
}

void finding_add(struct buf *words, const char *piece, const struct pilot_setup *setup)
{
    const bool are_some = words->length > 0;
    bool is_there[SETUP_ROWS_MOST] = {false};
    struct buf all = {0};
    command_find_by_piece(words, piece, are_some);
    for (const char *at = buf_text(words); *at;) {
        const size_t line = strcspn(at, "\n"), word = strcspn(at, "\t\n");
        const struct pilot_row *row = row_of(at, word);
        buf_add(&all, at, word);
        buf_add_char(&all, '\t');
        if (row) {
            is_there[row - pilot_table] = true;
            setup_add_keys(&all, setup, row, 1);
            buf_add_text(&all, word < line ? " in the pilot: " : "");
        }
        buf_add(&all, at + word + (word < line), line - word - (word < line));
        buf_add_char(&all, '\n');
        at += line + (at[line] == '\n');
    }
    if (!are_some)
        add_keys(&all, piece, setup, is_there);
    all.failed |= words->failed;
    buf_release(words);
    *words = all;
}
