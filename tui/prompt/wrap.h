/*
 * Text for a raw terminal, its long lines broken between words.
 *
 * A terminal breaks a long line in the middle of a word. Here it breaks at a blank, and goes on
 * below where its text began: behind its first run of two blanks or more, as in lists of names and
 * values, else at the left. In a window of 30 columns:
 *
 *     view      90 0 0 degrees, left,
 *               zoom 1
 *
 * A word that is wider than the room it has stays whole, so that a path can be copied.
 */
#ifndef TUI_PROMPT_WRAP_H
#define TUI_PROMPT_WRAP_H

#include "base/buf.h"

/* Adds `text` with lines of at most `columns` cells, each ended by CR LF; colours (CSI ... m) take
 * no room. */
void wrap_text(struct buf *out, const struct buf *text, unsigned columns);

#endif
