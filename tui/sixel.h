/*
 * Sixel graphics (DEC STD 070): a picture as bands of six rows, one pass per colour and band.
 *
 *     ESC P 0;1 q "1;1;W;H             pixels are square, W x H of them
 *     #3;2;100;0;50                    colour 3 is RGB 100 %, 0 %, 50 %
 *     #3!12~?@                         colour 3: 12 times six pixels, six left out, the top one
 *     $                                back to the left edge, for the next colour of this band
 *     -                                down to the next band
 *     ESC \
 *
 * A sixel is a byte 63 + bits, the lowest bit on top; !N repeats. Every pixel is painted, black
 * ones too: terminals differ in what they do with the rest. Colours are whole percents, so a
 * channel may come back up to 1 of 255 off; at most 250 colours, which every sixel terminal has.
 */
#ifndef TUI_SIXEL_H
#define TUI_SIXEL_H

#include "base/buf.h"
#include "tui/image_view.h"

enum { SIXEL_COLOURS = 250 };

/* Adds `view` (not empty) to `out`; without memory out->failed is set. */
void sixel_encode(const struct image_view *view, struct buf *out);

#endif
