/* SPDX-License-Identifier: MIT */
/* A screen of a plain terminal: the output of a program is drawn in cells, so that a story can
 * check what a user would see.
 *
 * It supports what the prompt may send: text with wide characters and combining marks, deferred
 * wrap, CR, LF, BEL, CSI A B C D G H J K m, the alternate screen (CSI ? 1049 h), modes, and strings
 * (DCS, APC, OSC), which draw nothing. After a change of size the cells common to both sizes stay,
 * as in xterm. */
#ifndef TESTS_SCREEN_H
#define TESTS_SCREEN_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tui/cells.h"

enum { SCREEN_ROWS = 60, SCREEN_COLUMNS = 200 };

struct screen_cell {
    char text[16]; /* a character and its marks; "" for a blank, and behind a wide one */
    bool grey, behind_wide;
};

struct screen {
    unsigned rows, columns, row, column;
    bool wraps; /* the last column is written: the next character goes to the next row */
    bool grey;
    unsigned scrolled;       /* rows */
    unsigned questions;      /* DA1, asked so far */
    unsigned bells, colours; /* CSI .. m, other than the plain one */
    struct screen_cell cell[SCREEN_ROWS][SCREEN_COLUMNS];
    struct screen_cell usual[SCREEN_ROWS][SCREEN_COLUMNS]; /* while the other screen shows, */
    unsigned usual_row, usual_column;                      /* and its cursor */
    bool is_other;
    char pending[256]; /* bytes of an incomplete sequence or character */
    size_t pendings;
};

static inline void screen_resize(struct screen *s, unsigned columns, unsigned rows)
{
    for (unsigned y = 0; y < SCREEN_ROWS; y++)
        for (unsigned x = 0; x < SCREEN_COLUMNS; x++)
            if (y >= rows || x >= columns)
                s->cell[y][x] = (struct screen_cell){0};
    s->columns = columns;
    s->rows = rows;
    s->row = s->row < rows ? s->row : rows - 1;
    s->column = s->column < columns ? s->column : columns - 1;
    s->wraps = false;
}

static inline void screen_line_feed(struct screen *s)
{
    if (s->row + 1 < s->rows) {
        s->row++;
        return;
    }
    memmove(s->cell[0], s->cell[1], sizeof s->cell[0] * (s->rows - 1));
    memset(s->cell[s->rows - 1], 0, sizeof s->cell[0]);
    s->scrolled++;
}

static inline void screen_put(struct screen *s, const char *text, size_t length, unsigned width)
{
    if (width == 0) {
        unsigned at = s->wraps ? s->column : s->column > 0 ? s->column - 1 : 0;
        at -= at > 0 && s->cell[s->row][at].behind_wide;
        char *base = s->cell[s->row][at].text;
        const size_t used = strnlen(base, sizeof s->cell[0][0].text - 1);
        for (size_t i = 0; i < length && used + i + 1 < sizeof s->cell[0][0].text; i++)
            base[used + i] = text[i];
        return;
    }
    if (s->wraps || s->column + width > s->columns) {
        s->column = 0;
        s->wraps = false;
        screen_line_feed(s);
    }
    struct screen_cell *cell = &s->cell[s->row][s->column];
    *cell = (struct screen_cell){.grey = s->grey};
    memcpy(cell->text, text, length);
    for (unsigned i = 1; i < width; i++)
        cell[i] = (struct screen_cell){.grey = s->grey, .behind_wide = true};
    s->column += width;
    if (s->column == s->columns) {
        s->column--;
        s->wraps = true;
    }
}

static inline void screen_erase(struct screen *s, unsigned y, unsigned from)
{
    for (unsigned x = from; x < s->columns; x++)
        s->cell[y][x] = (struct screen_cell){0};
}

static inline void screen_change(struct screen *s, bool to_other)
{
    if (s->is_other == to_other)
        return;
    s->is_other = to_other;
    if (to_other) {
        memcpy(s->usual, s->cell, sizeof s->usual);
        memset(s->cell, 0, sizeof s->cell);
        s->usual_row = s->row;
        s->usual_column = s->column;
    } else {
        memcpy(s->cell, s->usual, sizeof s->cell);
        s->row = s->usual_row < s->rows ? s->usual_row : s->rows - 1;
        s->column = s->usual_column < s->columns ? s->usual_column : s->columns - 1;
    }
}

static inline void screen_csi(struct screen *s, const char *body, char final)
{
    const unsigned given = (unsigned)strtoul(body, NULL, 10), n = given ? given : 1;
    const char *semicolon = strchr(body, ';');
    const unsigned second = semicolon ? (unsigned)strtoul(semicolon + 1, NULL, 10) : 1;
    if (final == 'c' && (*body == '\0' || *body == '0'))
        s->questions++;
    if (strcmp(body, "?1049") == 0)
        screen_change(s, final == 'h');
    if (strchr("?><=", *body) && *body)
        return;
    s->wraps = s->wraps && final == 'm';
    if (final == 'A')
        s->row -= n < s->row ? n : s->row;
    else if (final == 'B')
        s->row = s->row + n < s->rows ? s->row + n : s->rows - 1;
    else if (final == 'C')
        s->column = s->column + n < s->columns ? s->column + n : s->columns - 1;
    else if (final == 'D')
        s->column -= n < s->column ? n : s->column;
    else if (final == 'G')
        s->column = n - 1 < s->columns ? n - 1 : s->columns - 1;
    else if (final == 'H') {
        s->row = n - 1 < s->rows ? n - 1 : s->rows - 1;
        s->column = second > 0 && second - 1 < s->columns ? second - 1 : 0;
    } else if (final == 'K') {
        screen_erase(s, s->row, s->column);
    } else if (final == 'J') {
        screen_erase(s, s->row, given == 2 ? 0 : s->column);
        for (unsigned y = given == 2 ? 0 : s->row + 1; y < s->rows; y++)
            screen_erase(s, y, 0);
    } else if (final == 'm') {
        s->grey = strcmp(body, "38;5;244") == 0 || strcmp(body, "90") == 0;
        s->colours += given != 0;
    }
}

/* Draw what the pending bytes begin with, and return its length; 0 if it is incomplete. */
static inline size_t screen_take(struct screen *s)
{
    const char *at = s->pending;
    uint32_t point;
    if (*at == '\033' && s->pendings < 2)
        return 0;
    if (*at == '\033' && at[1] == '[') {
        for (size_t i = 2; i < s->pendings; i++)
            if (at[i] >= 0x40 && at[i] <= 0x7e) {
                char body[sizeof s->pending] = "";
                memcpy(body, at + 2, i - 2);
                screen_csi(s, body, at[i]);
                return i + 1;
            }
        return 0;
    }
    if (*at == '\033' && strchr("P_]^X", at[1])) {
        const char *end = memmem(at, s->pendings, "\033\\", 2);
        return end ? (size_t)(end - at) + 2 : 0;
    }
    if (*at == '\033')
        return 2;
    if (*at == '\r') {
        s->column = 0;
        s->wraps = false;
    } else if (*at == '\n') {
        s->wraps = false;
        screen_line_feed(s);
    } else if (*at == '\a') {
        s->bells++;
    } else if ((unsigned char)*at >= 32) {
        const unsigned char c = (unsigned char)*at;
        const size_t needed = c < 0x80 ? 1 : c < 0xe0 ? 2 : c < 0xf0 ? 3 : 4;
        if (s->pendings < needed)
            return 0;
        const size_t n = char_read(at, s->pendings, &point);
        screen_put(s, at, n, point == CHAR_BROKEN ? 1 : char_width(point));
        return n;
    }
    return 1;
}

static inline void screen_write(struct screen *s, const char *bytes, size_t length)
{
    for (size_t i = 0; i < length; i++) {
        if (s->pendings == sizeof s->pending - 1) { /* a string longer than all that is kept */
            memmove(s->pending + 2, s->pending + s->pendings - 2, 2);
            s->pendings = 4;
        }
        s->pending[s->pendings++] = bytes[i];
        const size_t n = screen_take(s);
        memmove(s->pending, s->pending + n, s->pendings - n);
        s->pendings -= n;
    }
}

/* The text of a row without the blanks at its end. Static storage; four at once. */
static inline const char *screen_row(const struct screen *s, unsigned y)
{
    static char line[4][SCREEN_COLUMNS * 16];
    static unsigned next;
    char *out = line[next++ % 4], *at = out, *end = out;
    for (unsigned x = 0; x < s->columns; x++) {
        const struct screen_cell *cell = &s->cell[y][x];
        if (cell->behind_wide)
            continue;
        at += sprintf(at, "%s", *cell->text ? cell->text : " ");
        if (*cell->text && strcmp(cell->text, " ") != 0)
            end = at;
    }
    *end = '\0';
    return out;
}

#endif
