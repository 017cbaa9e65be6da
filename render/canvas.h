/* SPDX-License-Identifier: MIT */
/*
 * A canvas: the pixels that slices, mosaics and words are drawn into, or a part of them.
 *
 * Pixels are sRGB, rows from the top, columns from the left; opaque, but where what is drawn is to
 * be laid over another picture. Drawing may go beyond
 * the edges: pixels outside are not drawn. A part borrows the pixels of the whole.
 *
 * A canvas may hold some rows of its picture alone, from row `from` on: what is drawn is drawn as
 * into the whole, and the rest of it left out.
 *
 * Where `cell` is not NULL it says which voxel each pixel shows, CELL_NONE for none.
 */
#ifndef RENDER_CANVAS_H
#define RENDER_CANVAS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/err.h"

struct canvas {
    uint32_t width, height;
    size_t stride;       /* pixels from one row to the next */
    uint8_t *rgba;       /* [height][stride][4], alpha 255 */
    uint32_t *cell;      /* [height][stride], or NULL */
    uint8_t *words;      /* the same: not 0 where words were drawn, with their outline; or NULL */
    uint8_t *below;      /* the same: the greys of slices, without labels and notes; or NULL */
    uint32_t from, rows; /* rows that are held, where these are not 0: all */
};

/* Maps besides the colours: `cell`; `words` and `below`. */
enum { CANVAS_CELLS = 1, CANVAS_NOTES = 2 };

/* Black, of 1..VIEW_SIDE_MOST pixels a side, with these maps. The caller releases it. ERR_MEMORY:
 * without any. */
enum err canvas_init(struct canvas *canvas, uint32_t width, uint32_t height, unsigned maps,
                     struct fault *fault);

/* One with all maps, black, in place of another, or of {0}: for pictures that follow each other. It
 * reuses the memory of a former one of the same size. ERR_MEMORY: it has no maps. */
enum err canvas_renew(struct canvas *canvas, uint32_t width, uint32_t height, struct fault *fault);
void canvas_release(struct canvas *canvas);

/* The part from column `left` and row `top` on, which lies within the canvas. */
struct canvas canvas_part(const struct canvas *canvas, uint32_t left, uint32_t top, uint32_t width,
                          uint32_t height);

/* Fills a box of width x height pixels. */
void canvas_box(const struct canvas *canvas, int64_t left, int64_t top, int64_t width,
                int64_t height, const uint8_t rgb[3]);

/* Lays a colour over a pixel, of which it covers 1..255 of 255: light adds up, so squares of
 * colours do. One that is clear takes the colour, and the share as its alpha. */
void canvas_blend(uint8_t pixel[4], const uint8_t rgb[3], uint32_t share);

/* Makes of a layer [pixels][4] what is seen where it lies over another picture. */
void canvas_lay_over(uint8_t *layer, const uint8_t *below, size_t pixels);

/* A sum mod 2^64 over the pixels of a whole canvas of a mix of place and colour. */
uint64_t canvas_digest(const struct canvas *canvas);

/* The row after the last one that is held. */
static inline uint32_t canvas_end(const struct canvas *canvas)
{
    return canvas->rows ? canvas->from + canvas->rows : canvas->height;
}

/* Of a row that is held. */
static inline uint8_t *canvas_pixel(const struct canvas *canvas, size_t column, size_t row)
{
    return canvas->rgba + 4 * ((row - canvas->from) * canvas->stride + column);
}

static inline void canvas_dot(const struct canvas *canvas, int64_t column, int64_t row,
                              const uint8_t rgb[3])
{
    if (column < 0 || row < canvas->from || column >= canvas->width || row >= canvas_end(canvas))
        return;
    uint8_t *pixel = canvas_pixel(canvas, (size_t)column, (size_t)row);
    for (int k = 0; k < 3; k++)
        pixel[k] = rgb[k];
    pixel[3] = 255;
}

#endif
