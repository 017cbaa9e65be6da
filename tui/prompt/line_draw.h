/* SPDX-License-Identifier: MIT */
/*
 * Drawing the line being edited: prompt, text and cursor over as many rows as they need; and what
 * stands below it: the candidates for a word, and a caret under what is wrong.
 *
 *     CSI nA CR CSI J   prompt text   CSI nA CR CSI nC       all of a redraw, in one write
 *
 * Rows break where the terminal breaks them: at the right margin, a wide character early. After a
 * character in the last column terminals wait with the wrap, so when the text ends there, CR LF
 * makes it happen. When there are more rows than the terminal has, those around the cursor show.
 * What is no printable UTF-8 is drawn as \xNN, and takes four columns. A hint goes no further than
 * the row of the cursor; of what stands below, as much shows as there are rows. Pure: bytes out.
 */
#ifndef TUI_PROMPT_LINE_DRAW_H
#define TUI_PROMPT_LINE_DRAW_H

#include <stdbool.h>
#include <stddef.h>

#include "base/buf.h"

/* What stands on the screen: `struct line_drawing d = {0}` is nothing, cursor at a line's start. */
struct line_drawing {
    size_t cells; /* from the start of the first row shown to the cursor */
    unsigned row; /* the cursor's, 0 is the first row shown */
};

struct line_content {
    const char *prompt;
    const char *text;
    size_t length, cursor; /* in bytes of text */
    const char *hint;      /* after the text, where the cursor is; safe to print, or NULL */
    const char *grey;      /* CSI .. m that makes it so */
    const char *below;     /* lines that stand below, safe to print and narrower than the screen,
                              each ended by a line feed; NULL for none */
};

void line_draw(struct line_drawing *drawing, const struct line_content *content, unsigned columns,
               unsigned rows, struct buf *out);

/* ---- candidates ---- */

/* Whole words, each ended by a line feed, with a tab and what it means before that where there is
 * something to say; and what all of the words begin with. */
struct candidates {
    const char *words;
    size_t count;
    size_t notes;      /* lines that begin with a tab: they are shown, and are no words */
    const char *first; /* the first of them, */
    size_t common;     /* and how many bytes of it all begin with, whole characters */
};

struct candidates candidates_of(const char *words);

/* Adds the list in lines that end in CR LF, for a terminal of so many columns and rows, of which
 * the list leaves three. Candidates stand in columns, read downwards, without what is the same in
 * all of them up to a slash, and without quotes:
 *
 *     scans/a b.nii  ->  a b.nii   masks/
 *     scans/ch2.nii      ch2.nii
 *
 * Where words have a meaning and there are rows for all of them, each has one of its own, with what
 * fits of the meaning beside it:
 *
 *     seed       plant a seed, a ball of seeds, or a stroke
 *     seed-file  plant the seeds of a .csv list or a label map
 *
 * Notes stand below these, what they are about in the place of the word.
 *
 * For what does not fit the screen there is one line: "and 214 more". */
void candidates_list(const struct candidates *c, unsigned columns, unsigned rows, struct buf *out);

/* ---- the caret ---- */

/*     ch2> sede 1,1,1 2                 ch2> a line that did not fit, and so was wrapped ..
 *          ^                            ...seed 100,100,50 liver radius=2...
 *                                                          ^
 */
struct caret {
    const char *prompt, *text; /* the line as it was typed */
    size_t at;                 /* the byte of `text` that is wrong, or one after its end */
    bool below;                /* what is added stands right below it */
    bool coloured;
};

/* Adds a line with a caret, below as much of the line as fits where that is needed. In less than 8
 * columns nothing is added. */
void caret_add(struct buf *out, const struct caret *caret, unsigned columns);

#endif
