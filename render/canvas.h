/* SPDX-License-Identifier: MIT */
/*
 * A canvas: the pixels of slices, mosaics and words, or a part of them.
 *
 * Pixels are sRGB, rows from the top, columns from the left; opaque, except in layers to be laid
 * over another picture. Drawing may extend beyond the edges; pixels outside are clipped. A part
 * borrows the pixels of the whole.
 *
 * A canvas may hold only some rows of its picture, from row `from` on: drawing works as on the
 * whole, and other rows are clipped.
 *
 * If `cell` is not NULL it holds the voxel shown by each pixel, or CELL_NONE.
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
    uint8_t *words;      /* the same: not 0 at words and their outlines; or NULL */
    uint8_t *below;      /* the same: the greys of slices, without labels and notes; or NULL */
    uint32_t from, rows; /* rows held; 0: all */
};

/* Optional maps: `cell`; `words` and `below`. */
enum { CANVAS_CELLS = 1, CANVAS_NOTES = 2 };

/* Make a black canvas of 1..VIEW_SIDE_MOST pixels a side with these maps, released by the caller.
 * ERR_MEMORY: it is {0}. */
enum err canvas_init(struct canvas *canvas, uint32_t width, uint32_t height, unsigned maps,
                     struct fault *fault);

/* Replace a canvas, or {0}, by a black one with all maps, for successive pictures. The memory of a
 * canvas of the same size is reused. ERR_MEMORY: it is {0}. */
enum err canvas_renew(struct canvas *canvas, uint32_t width, uint32_t height, struct fault *fault);
void canvas_release(struct canvas *canvas);

/* Return the part from column `left` and row `top` on, which must be inside the canvas. */
struct canvas canvas_part(const struct canvas *canvas, uint32_t left, uint32_t top, uint32_t width,
                          uint32_t height);

/* Fill a box of width x height pixels. */
void canvas_box(const struct canvas *canvas, int64_t left, int64_t top, int64_t width,
                int64_t height, const uint8_t rgb[3]);

/* Blend a colour over a pixel with coverage share / 255, 1..255: squares of colours are added, as
 * light is. A clear pixel becomes the colour, with the share as its alpha. */
void canvas_blend(uint8_t pixel[4], const uint8_t rgb[3], uint32_t share);

/* Put a layer [pixels][4] over another picture; the layer receives the result. */
void canvas_lay_over(uint8_t *layer, const uint8_t *below, size_t pixels);

/* Return a sum mod 2^64, over the pixels of a whole canvas, of a mix of position and colour. */
uint64_t canvas_digest(const struct canvas *canvas);

/* Return the row after the last one held. */
static inline uint32_t canvas_end(const struct canvas *canvas)
{
    return canvas->rows ? canvas->from + canvas->rows : canvas->height;
}

/* Return a pixel of a row that is held. */
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
