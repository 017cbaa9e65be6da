/*
 * A picture at the prompt, in whatever way the terminal can show it.
 *
 *     CR  R x LF  ESC[R A  ESC 7  picture  ESC 8  ESC[R B  CR        R = its height in cells
 *
 * The line feeds make room by scrolling, before the picture is there; the cursor is saved and put
 * back because every terminal leaves it elsewhere after a picture. Blocks are lines of text and
 * need none of this. Pure: facts and pixels in, bytes out.
 */
#ifndef TUI_PICTURE_SHOW_H
#define TUI_PICTURE_SHOW_H

#include "base/buf.h"
#include "tui/picture/image_view.h"
#include "tui/probe.h"

/* Adds what shows `view` to `out`. The cursor must be at the start of a line and is at the start
 * of the line below the picture afterwards. A picture larger than the columns x rows of the
 * terminal, less a row for the prompt, or than the largest it draws, is shrunk. Nothing is added
 * for an empty view or GRAPHICS_NONE; without memory out->failed is set. */
void show_inline(const struct terminal_facts *facts, const struct image_view *view,
                 uint32_t columns, uint32_t rows, struct buf *out);

#endif
