/* SPDX-License-Identifier: MIT */
/*
 * Pixels ready to be written: places in a palette, 24-bit colours, or 24-bit colours and alpha.
 * They are borrowed, so a part of a picture is a raster too.
 */
#ifndef IMAGE_RASTER_H
#define IMAGE_RASTER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { RASTER_COLOURS_MOST = 256 };

struct raster {
    uint32_t width, height; /* never 0 */
    size_t stride;          /* bytes from row to row */
    const uint8_t *bytes;   /* a place a pixel; without a palette red, green, blue (and alpha) */
    const uint32_t *colour; /* [colours] 0xRRGGBB; NULL without a palette */
    unsigned colours;
    bool has_alpha; /* without a palette alone */
    bool has_clear; /* with a palette alone: RASTER_CLEAR is a place as well, seen through */
};

enum { RASTER_CLEAR = 255 }; /* where it is used a palette has fewer colours than that */

static inline size_t raster_pixel_bytes(const struct raster *raster)
{
    return raster->colour ? 1 : raster->has_alpha ? 4 : 3;
}

/* Pixels, in order of their places in the whole picture. */
struct raster_box {
    uint32_t left, top, width, height;
};

/* An ASCII character in a cell of the screen, for pictures made of text, whose pixels are too few
 * for letters. */
struct raster_note {
    uint16_t column, row; /* of the picture's cells */
    char character;
};

struct raster raster_part(const struct raster *raster, struct raster_box box);

/* The colours that do occur, numbered from 0 in the palette's order: place[p] is the number of what
 * stood at p. A raster without them is a raster of `used`. What is clear comes first, as black;
 * *is_clear, which may be NULL, says whether it occurs. Returns how many there are. */
unsigned raster_used(const struct raster *raster, uint8_t place[RASTER_COLOURS_MOST],
                     uint32_t used[RASTER_COLOURS_MOST], bool *is_clear);

#endif
