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
 * ones too: terminals differ in what they do with the rest; but none below the last row, where the
 * last band has more. Colours are whole percents, so a channel may come back up to 1 of 255 off.
 * Only those that occur are declared, numbered anew, so each picture is complete in itself.
 */
#ifndef TUI_PICTURE_SIXEL_H
#define TUI_PICTURE_SIXEL_H

#include "base/buf.h"
#include "tui/picture/image_view.h"
#include "image/raster.h"

/* Memory that is kept from picture to picture. `struct sixel_writer w = {0}` is ready. */
struct sixel_writer {
    struct sixel_run *run;
    size_t capacity;
};

void sixel_release(struct sixel_writer *writer);

/* Adds a raster that has a palette. As below, without memory out->failed is set. */
void sixel_add(struct sixel_writer *writer, const struct raster *raster, struct buf *out);

/* Adds `view` (not empty). */
void sixel_encode(const struct image_view *view, struct buf *out);

#endif
