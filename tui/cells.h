/* SPDX-License-Identifier: MIT */
/*
 * Text as a terminal shows it, in cells: the width of a text, and lines that fit.
 *
 * A combining mark, a joiner or a direction mark is 0 cells wide; an East Asian wide character or
 * an emoji is 2; any other is 1. The widths are those of libc in the locale C.UTF-8, independent of
 * the environment: a session over SSH often has no locale. Common terminals agree on them except
 * for sequences of emoji.
 */
#ifndef TUI_CELLS_H
#define TUI_CELLS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/buf.h"

unsigned char_width(uint32_t point);

/* Read the UTF-8 character at `text` (`length` > 0) into *point and return its bytes; for an
 * invalid byte, 1 and CHAR_BROKEN. */
#define CHAR_BROKEN UINT32_MAX
size_t char_read(const char *text, size_t length, uint32_t *point);

/* Remove the last character of a text, which is not empty. */
void char_erase(struct buf *text);

/* Return the upper or lower case letter of a letter, or the character itself if it has none. */
uint32_t char_letter(uint32_t point, bool upper);

/* Return the cells that `length` bytes take where unsafe bytes are drawn as \xNN. */
size_t cells_width(const char *text, size_t length);

/* Return the bytes of the character or colour (CSI .. m) that a text begins with, and its cells: 0
 * for a colour. The text is safe to print except for colours; `length` > 0. */
size_t cells_next(const char *text, size_t length, size_t *cells);

/* Return true if the environment selects UTF-8: LC_ALL, else LC_CTYPE, else LANG. */
bool locale_is_utf8(void);

/* Add `text`, which is safe to print, with each line cut to `columns` cells (0: not cut). For
 * drawings, which would be unreadable if the terminal wrapped them. */
void cells_crop(struct buf *out, const char *text, unsigned columns);

/* Return the number of bytes of a line that fit `columns` cells, up to a blank; a wider word is
 * whole. */
size_t cells_fit(const char *line, size_t length, size_t columns);

/*
 * Add `text` for a raw terminal, with lines of at most `columns` cells, each ended by CR LF;
 * colours (CSI ... m) have no width. A long line is broken at a blank, where a terminal would break
 * words, and continues in the column where its text began: after its first run of two blanks or
 * more, as in lists of names and values, else at the left. In a window of 30 columns:
 *
 *     view      90 0 0 degrees, left,
 *               zoom 1
 *
 * A word that is wider than its room stays whole, so that a path can be copied.
 */
void cells_wrap(struct buf *out, const struct buf *text, unsigned columns);

/* ---- themes ---- */

/*
 * The colours of text, for a dark terminal, a light one, or none. Pictures have the colours of
 * labels and greys under every theme; under `none`, as under NO_COLOR, they are made of characters.
 */
struct theme {
    const char *name;
    const char *hint, *hint_16; /* CSI .. m, in 256 colours and in 16: hints after a line */
    const char *alarm;          /* a state that must be noticed */
    const char *heading, *key;  /* in a page of keys */
    bool has_colours;
};

#define THEME_NAMES "dark|light|none"
extern const struct theme theme_dark;

/* Return the theme of that name, or NULL. */
const struct theme *theme_find(const char *name);

/* Return the chosen theme, or if that is NULL the one for the background. */
const struct theme *theme_for(const struct theme *chosen, bool is_light);

#endif
