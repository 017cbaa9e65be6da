/* SPDX-License-Identifier: MIT */
/*
 * Pictures out of text, for terminals that know no graphics: block characters, whose foreground
 * (ink) has some parts of the cell and whose background (paper) the others.
 *
 *     ESC[38;2;200;10;10;48;2;90;5;5m U+2580      ink and paper, and the upper half block
 *     38;5;N and 48;5;N with 256 colours; 30..37, 90..97 and 40..47, 100..107 with 16
 *
 *     BLOCK_HALF 1x2 parts   BLOCK_QUADRANT 2x2, U+2596 ..   BLOCK_SEXTANT 2x3, U+1FB00 ..
 *
 * A cell of more than two colours is parted into the two sets with the least squared error to their
 * means. A colour is sent only where it changes; a cell of one colour is a space on it. Without
 * colours a cell is one character of a ramp from dark to bright.
 *
 * A note of the view (tui/picture/image_view.h) is a cell of its own: a bright character on black.
 *
 * A cell counts as half as wide as it is high, as nearly all are. So that pictures have square
 * pixels, a cell stands for 1x2, 2x4 or 6x12 of them, and a part has the mean of its own.
 */
#ifndef TUI_PICTURE_BLOCKS_H
#define TUI_PICTURE_BLOCKS_H

#include <stdbool.h>

#include "base/buf.h"
#include "tui/picture/image_view.h"
#include "tui/probe.h"

/* Adds `view` (not empty), shrunk into columns x rows cells (each at least 1) in its own shape, as
 * lines that end in CR LF. Without memory out->failed is set. */
void blocks_encode(const struct image_view *view, enum colours colours, enum block_shape shape,
                   uint32_t columns, uint32_t rows, struct buf *out);

/* ---- cell by cell ---- */

/* The pixels of a cell. */
void blocks_pixels(enum block_shape shape, uint32_t *width, uint32_t *height);

struct block {
    int32_t ink, paper; /* 0xRRGGBB, or a number of the palette, or BLOCK_DEFAULT, the terminal's */
    uint8_t parts;      /* those that have the ink, bit by bit from the top left, which never has;
                           without colours the character */
    char note;          /* stands there in place of parts, or 0 */
};

enum { BLOCK_DEFAULT = -1 };

/* Fills cell[row * stride + column] with the cells that a view reaches into. What the last ones
 * have beyond the view is black. */
void blocks_fill(struct block *cell, size_t stride, const struct image_view *view,
                 enum colours colours, enum block_shape shape);

/* The nearest of the 240 fixed entries (16..255) of the 256-colour palette: a 6x6x6 cube and a
 * ramp of 24 greys. */
uint8_t blocks_nearest_256(uint32_t colour);

#endif
