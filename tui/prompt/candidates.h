/*
 * What a word may be completed to: what all candidates begin with, and their list below the line.
 *
 * Candidates are whole words, each ended by a line feed. In the list they stand in columns, read
 * downwards, without what is the same in all of them up to a slash, and without quotes:
 *
 *     scans/a b.nii  ->  a b.nii   masks/
 *     scans/ch2.nii      ch2.nii
 *
 * What does not fit the screen is told in one line: "and 214 more". Pure.
 */
#ifndef TUI_PROMPT_CANDIDATES_H
#define TUI_PROMPT_CANDIDATES_H

#include <stddef.h>

#include "base/buf.h"

struct candidates {
    const char *words;
    size_t count;
    const char *first; /* the first of them, */
    size_t common;     /* and how many bytes of it all begin with, whole characters */
};

struct candidates candidates_of(const char *words);

/* Adds the list in lines that end in CR LF, for a terminal of so many columns and rows, of which
 * the list leaves three. */
void candidates_list(const struct candidates *c, unsigned columns, unsigned rows, struct buf *out);

#endif
