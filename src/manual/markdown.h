/* SPDX-License-Identifier: MIT */
/*
 * A text in Markdown as part of a page of the manual: that of journal/FORMAT.md, which is in no
 * table. It knows what such a text is written with, and refuses all else, so that nothing comes out
 * as something else:
 *
 *     # and ##            sections
 *     paragraphs          of `typed`, **strong** and *stressed* words
 *     - and 1.            items, without paragraphs of their own
 *     four blanks, ```    lines as they are
 *     | a | b |           a table, of which each row becomes an item: "a: ..., b: ...", as what has
 *                         sentences in its cells fits no width
 */
#ifndef MANUAL_MARKDOWN_H
#define MANUAL_MARKDOWN_H

#include "base/buf.h"

/* Adds it; 0, or the number of the line that could not be set. */
unsigned markdown_add(struct buf *out, const char *text);

#endif
