/*
 * A picture ready for the wire: places in a palette, or 24-bit colours. Pixels are borrowed, so a
 * part of a picture is a raster too.
 */
#ifndef TUI_PICTURE_RASTER_H
#define TUI_PICTURE_RASTER_H

#include <stddef.h>
#include <stdint.h>

enum { RASTER_COLOURS_MOST = 256 };

struct raster {
    uint32_t width, height; /* never 0 */
    size_t stride;          /* bytes from row to row */
    const uint8_t *bytes;   /* a place a pixel, or, without a palette, red, green, blue */
    const uint32_t *colour; /* [colours] 0xRRGGBB; NULL for 24-bit colours */
    unsigned colours;
};

static inline size_t raster_pixel_bytes(const struct raster *raster)
{
    return raster->colour ? 1 : 3;
}

/* Pixels, in order of their places in the whole picture. */
struct raster_box {
    uint32_t left, top, width, height;
};

struct raster raster_part(const struct raster *raster, struct raster_box box);

/* The colours that do occur, numbered from 0 in the palette's order: place[p] is the number of what
 * stood at p. A raster without them is a raster of `used`. Returns how many there are. */
unsigned raster_used(const struct raster *raster, uint8_t place[RASTER_COLOURS_MOST],
                     uint32_t used[RASTER_COLOURS_MOST]);

#endif
