/* SPDX-License-Identifier: MIT */
/*
 * The colours of labels.
 *
 * Those that a session begins with stand off grey, which slices are, off the yellows of the
 * cross-hair and of the pilot's frames, off the red of eliminators, and off one another; also for
 * eyes without long, middle or short cones. Label 1 and 2, then 3, ... are furthest apart.
 *
 * Distances are those of OKLab (Ottosson 2020) in 10 000ths; 200 is about what can just be told
 * apart side by side. What an eye without one kind of cones sees is that of Machado, Oliveira and
 * Fernandes (2009). tests/test_palette.c has the least distances, and measures them.
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
 * The background: what is seen where no object is.
 *
 * A rendition holds objects alone: their colours, and in alpha how much of each pixel they cover.
 * The background is put behind them where a picture is shown, or written as colours; golden images
 * and OpenEXR files have the objects with their alpha, so that another program can put its own
 * behind them. Where a pixel is covered in part, light adds up as in samples (rendition_reduce):
 * the mean is taken of squares.
 */

/* What commands call them, beside a colour, in the order of the kinds below. */
#define BACKGROUNDS "black|white|gradient|transparent"

/* A background: one of these kinds, the plain one with 0xRRGGBB. */
enum {
    BACKGROUND_PLAIN = 1 << 24,
    BACKGROUND_GRADIENT = 2 << 24, /* from a calm grey at the top to a darker one */
    BACKGROUND_CLEAR = 3 << 24     /* alpha stays; black where that cannot be shown */
};
enum { BACKGROUND_WHITE = BACKGROUND_PLAIN | 0xffffff };

/* As commands call it: "white", "#e0e0e0". */
void background_write(struct buf *out, uint32_t background);

/* The same where all has to be opaque: black for what is clear. */
uint32_t background_opaque(uint32_t background);

/* The colour in a row of a picture of that height, sRGB. */
void background_at(uint8_t rgb[3], uint32_t background, uint32_t row, uint32_t height);

/* A pixel over what is behind it; exactly either where it is covered whole or not at all. */
void background_over(uint8_t rgb[3], const uint8_t rgba[4], const uint8_t behind[3]);

/* Puts the background behind a picture [height][width][4], which is opaque afterwards unless that
 * is clear. */
void background_put(uint8_t *rgba, uint32_t width, uint32_t height, uint32_t background);
/* The same of `rows` rows from row `top` on, which begin at `rgba`. */
void background_put_rows(uint8_t *rgba, uint32_t width, uint32_t top, uint32_t rows,
                         uint32_t height, uint32_t background);

#endif
