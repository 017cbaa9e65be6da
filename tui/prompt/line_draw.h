/*
 * Drawing the line being edited: prompt, text and cursor over as many rows as they need.
 *
 *     CSI nA CR CSI J   prompt text   CSI nA CR CSI nC       all of a redraw, in one write
 *
 * Rows break where the terminal breaks them: at the right margin, a wide character early. After a
 * character in the last column terminals wait with the wrap, so when the text ends there, CR LF
 * makes it happen. When there are more rows than the terminal has, those around the cursor show.
 * What is no printable UTF-8 is drawn as \xNN. A hint goes no further than the row of the cursor.
 * Pure: bytes out.
 */
#ifndef TUI_PROMPT_LINE_DRAW_H
#define TUI_PROMPT_LINE_DRAW_H

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
};

void line_draw(struct line_drawing *drawing, const struct line_content *content, unsigned columns,
               unsigned rows, struct buf *out);

#endif
