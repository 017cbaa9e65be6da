/* SPDX-License-Identifier: MIT */
/*
 * A glyph: one letter of the face at a size, as pixels.
 *
 * Ink is the part of a pixel that the outline covers, exact for lines to a 256th of a pixel, which
 * curves are divided into. A halo is what lies nearer to the outline than its radius, measured from
 * the middle of the pixel.
 *
 * The lines that letters stand on and reach up to are moved to whole rows, so that small ones are
 * crisp; in between rows are stretched. Letters that are round reach over them only where that is
 * half a row.
 *
 * All in integers: the same pixels on every machine.
 */
#ifndef RENDER_GLYPH_H
#define RENDER_GLYPH_H

#include "render/canvas.h"

enum {
    GLYPH_ONE = 256,         /* parts of a pixel */
    GLYPH_TALL_MOST = 512,   /* rows of a capital */
    GLYPH_HALO_MOST = 16,    /* pixels */
    GLYPH_LINES_MOST = 2048, /* of an outline */
};

/* Parts of a pixel for units of the face, to the nearest, where capitals have `tall` rows. */
int64_t glyph_scaled(int64_t units, uint32_t tall);

struct spot {
    int32_t x, y; /* parts of a pixel, right and down */
};

/* An outline at a size, as lines. */
struct glyph {
    struct spot from[GLYPH_LINES_MOST], to[GLYPH_LINES_MOST]; /* from where the glyph begins on, */
    int64_t column, row; /* which is the corner of this pixel */
    size_t lines;
    struct spot least, most;
};

/* An outline of the face that begins `left` parts of a pixel from the canvas' edge and stands on
 * the upper edge of row `base`, where capitals have 1..GLYPH_TALL_MOST rows. */
void glyph_make(struct glyph *glyph, unsigned outline, uint32_t tall, int64_t left, int64_t base);

/* Draws its halo, whose radius is in parts of a pixel, a pixel at least; or for 0 its ink. Where
 * the canvas remembers words, it is told. */
void glyph_draw(const struct canvas *canvas, const struct glyph *glyph, uint32_t halo,
                const uint8_t rgb[3]);

#endif
