/* SPDX-License-Identifier: MIT */
/*
 * The colours of labels.
 *
 * The default colours differ from grey, the colour of slices, from the yellows of the cross-hair
 * and of marks, from the red of eliminators, and from one another, also for people without long,
 * middle or short cones. Labels 1 and 2, then 3, ... differ most, and labels 1 to 8 also in grey.
 *
 * Distances are those of OKLab (Ottosson 2020) in 10 000ths; 200 is about the smallest visible
 * difference of adjacent areas. Colour blindness is simulated by Machado, Oliveira and Fernandes
 * (2009). tests/test_palette.c lists the smallest distances and measures them.
 */
#ifndef RENDER_PALETTE_H
#define RENDER_PALETTE_H

#include <stdint.h>

#include "base/buf.h"

struct palette {
    uint8_t rgb[256][3]; /* sRGB, per label */
};

void palette_default(struct palette *palette);

/*
 * The background: the pixels without objects.
 *
 * A rendition holds objects alone: their colours, and in alpha the coverage of each pixel. The
 * background is put behind them for display, or in files of colours alone; golden images and
 * OpenEXR files have the objects with their alpha, so that another program can add its own
 * background. Partly covered pixels are blended as light, as in samples (rendition_reduce): squares
 * are averaged.
 */

/* Their names in commands, in addition to colours, in the order of the kinds below. */
#define BACKGROUNDS "black|white|gradient|transparent"

/* A background: one of these kinds, the plain one with 0xRRGGBB. */
enum {
    BACKGROUND_PLAIN = 1 << 24,
    BACKGROUND_GRADIENT = 2 << 24, /* from grey at the top to a darker grey */
    BACKGROUND_CLEAR = 3 << 24     /* keep alpha; black where that is impossible */
};
enum { BACKGROUND_WHITE = BACKGROUND_PLAIN | 0xffffff };

/* Write its name in commands: "white", "#e0e0e0". */
void background_write(struct buf *out, uint32_t background);

/* Return it, or black instead of a clear one. */
uint32_t background_opaque(uint32_t background);

/* Return the colour in a row of a picture of that height, sRGB. */
void background_at(uint8_t rgb[3], uint32_t background, uint32_t row, uint32_t height);

/* Blend a pixel over the colour behind it; exact at full and at no coverage. */
void background_over(uint8_t rgb[3], const uint8_t rgba[4], const uint8_t behind[3]);

/* Put the background behind a picture [height][width][4], which becomes opaque unless the
 * background is clear. */
void background_put(uint8_t *rgba, uint32_t width, uint32_t height, uint32_t background);
/* The same for `rows` rows from row `top` on, which begin at `rgba`. */
void background_put_rows(uint8_t *rgba, uint32_t width, uint32_t top, uint32_t rows,
                         uint32_t height, uint32_t background);

#endif
