/*
 * A caret under what is wrong in a line that was typed:
 *
 *     ch2> sede 1,1,1 2                 ch2> a line that did not fit, and so was wrapped ..
 *          ^                            ...seed 100,100,50 liver radius=2...
 *                                                          ^
 *
 * Pure. Columns are those of the terminal: a wide character takes two, and what was drawn as \xNN
 * takes four.
 */
#ifndef TUI_PROMPT_CARET_H
#define TUI_PROMPT_CARET_H

#include <stdbool.h>
#include <stddef.h>

#include "base/buf.h"

struct caret {
    const char *prompt, *text; /* the line as it was typed */
    size_t at;                 /* the byte of `text` that is wrong, or one behind its end */
    bool below;                /* what is added stands right below it */
    bool coloured;
};

/* Adds a line with a caret, below as much of the line as fits where that is needed. In less than 8
 * columns nothing is added. */
void caret_add(struct buf *out, const struct caret *caret, unsigned columns);

#endif
