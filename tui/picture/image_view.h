/* SPDX-License-Identifier: MIT */
/*
 * A picture as the encoders see it: pixels in memory, borrowed from their maker.
 *
 * rgba[y][x][4], x fastest, rows without padding, 8 bits each. Alpha is how much of the pixel
 * covers the black background: 0 is black whatever the colour says, 255 the colour itself. All
 * encoders look at pixels through image_view_colour, so they agree.
 */
#ifndef TUI_PICTURE_IMAGE_VIEW_H
#define TUI_PICTURE_IMAGE_VIEW_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "image/picture.h"

/* A part of a slice, and the number of its greys in the terminal; 0: it lacks them. */
struct image_strip {
    struct raster_box box;
    uint32_t number;
};

struct image_view {
    uint32_t width, height;
    const uint8_t *rgba;
    const uint8_t *fine; /* the final picture, for which the palette is made; NULL: rgba */
    /* 0xRRGGBB of the labels that may be visible, in any order, repetitions allowed. Another set
     * means another palette, and the picture is sent whole. NULL if unknown. */
    const uint32_t *hue;
    unsigned hues;           /* 0 if no label is visible: greys alone */
    bool has_tints;          /* hues are laid over greys, however small the area is */
    bool has_balls;          /* markers: levels of tints, unless bytes count */
    struct raster_box focus; /* sent finely first; empty: none */
    const uint8_t *words;    /* [height][width]: not 0 for words, which stay sharp; or NULL */
    const struct raster_note *note; /* [notes]; those outside the picture are ignored */
    size_t notes;
    const uint8_t *below;            /* [height][width]: greys of slices alone, without overlays */
    const struct raster_box *slice;  /* [slices] boxes of the slices; `below` is valid inside, */
    unsigned slices;                 /* and nowhere if this is 0 */
    const struct image_strip *strip; /* [strips], by painter_keep: strips of these boxes */
    unsigned strips;
    bool is_coarse;     /* changes come in blocks of pixels: bytes cost more than time */
    bool is_slow;       /* the line is slow: bytes cost more than time */
    bool has_few_greys; /* by the painter: SHADES_GREYS_FEW are enough */
    bool is_hasty;      /* drawn in a hurry: with more time there is a better picture */
    /* Send all 24 bits of every colour if the terminal can, at several times the bytes; otherwise
     * shades are rounded to a palette (tui/picture/shades.h). */
    bool smooth;
};

/* Return pixel number `i` (row by row) over black, as 0xRRGGBB. */
static inline uint32_t image_view_colour(const struct image_view *view, size_t i)
{
    const uint8_t *p = view->rgba + 4 * i;
    uint32_t a = p[3];
    if (a == 255)
        return (uint32_t)p[0] << 16 | (uint32_t)p[1] << 8 | p[2];
    if (a == 0)
        return 0;
    return (p[0] * a + 127) / 255 << 16 | (p[1] * a + 127) / 255 << 8 | (p[2] * a + 127) / 255;
}

/* Set the largest size of the same shape within most_width x most_height, never larger than the
 * view and never 0. */
void image_view_fit(const struct image_view *view, uint32_t most_width, uint32_t most_height,
                    uint32_t *width, uint32_t *height);

/* Average the view down to width x height (each 1 .. the view's own): every new pixel is the mean
 * of the area that it covers, with fractions of pixels, in integers. Return opaque RGBA for the
 * caller to free, or NULL without memory. */
uint8_t *image_view_shrink(const struct image_view *view, uint32_t width, uint32_t height);

#endif
