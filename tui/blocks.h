/*
 * Pictures out of text: two pixels a cell by the upper half block U+2580, whose foreground is the
 * upper pixel and whose background the lower one; for terminals that know no graphics.
 *
 *     ESC[38;2;200;10;10m ESC[48;2;90;5;5m U+2580    24-bit;  38;5;N and 48;5;N with 256 colours
 *
 * A colour is sent only where it changes; a cell of one colour is a space on that background; every
 * line ends with ESC[m. Without colours a cell is one character of a ramp from dark to bright.
 * A cell counts as half as wide as it is high, as nearly all are.
 */
#ifndef TUI_BLOCKS_H
#define TUI_BLOCKS_H

#include "base/buf.h"
#include "tui/image_view.h"

enum colours { COLOURS_NONE, COLOURS_16, COLOURS_256, COLOURS_24BIT };

/* Pixels that a cell shows in two colours: 1x2, 2x2 (U+2596..259F) or 2x3 (U+1FB00..1FB3B), as far
 * as the terminal's font is known to have them. */
enum block_shape { BLOCK_HALF, BLOCK_QUADRANT, BLOCK_SEXTANT };

/* Adds `view` (not empty), shrunk into columns x rows cells (each at least 1) in its own shape, as
 * lines that end in CR LF. Without memory out->failed is set. */
void blocks_encode(const struct image_view *view, enum colours colours, uint32_t columns,
                   uint32_t rows, struct buf *out);

/* The nearest of the 240 fixed entries (16..255) of the 256-colour palette: a 6x6x6 cube and a
 * ramp of 24 greys. */
uint8_t blocks_nearest_256(uint32_t colour);

#endif
