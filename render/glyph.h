/* SPDX-License-Identifier: MIT */
/*
 * A glyph: one letter of the face at a size, as pixels.
 *
 * Ink is the covered part of a pixel, exact to a 256th of a pixel for the lines that curves are
 * divided into. The halo is all pixels whose middle is nearer to the outline than its radius.
 *
 * Baseline and letter heights are aligned to whole rows, so that small letters are crisp; heights
 * in between are stretched. Round letters overshoot only where that is half a row.
 *
 * All in integers: the same pixels on every machine.
 */
#ifndef RENDER_GLYPH_H
#define RENDER_GLYPH_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "render/canvas.h"

/*
 * The face for words in pictures: outlines of letters, as a table of integers (render/face_table.h,
 * whose head names the font and its licence).
 *
 * Outlines are lines and quadratic curves, as in TrueType fonts: an off-curve point is the control
 * point between its neighbours, and halfway between two of them is an implied point on the curve. x
 * points right, y up from the baseline; FACE_SIZE units are the font size.
 */

enum { /* in units of the face */
       FACE_SIZE = 1024,
       FACE_CAPITAL = 747, /* height of capitals */
       FACE_SMALL = 560,   /* height of small letters */
       FACE_ROUND = 14,    /* overshoot of round letters, up and down */
       FACE_TALLEST = 778, /* height of small letters with an ascender */
       FACE_LOWEST = 213,  /* depth of descenders */
};
enum { FACE_OUTLINES = 641, FACE_POINTS_MOST = 256 /* points of one outline */ };

struct face_point {
    int16_t x, y;
    bool is_on, begins; /* on the curve; the first of a contour, which is on it */
};

/* Return the outline of a character; 0, a box, if the face lacks it. */
unsigned face_find(uint32_t point);

/* Return the advance to the next letter, and the kerning of a pair of letters. */
int face_advance(unsigned outline);
int face_kerning(uint32_t point, uint32_t next);

/* Read the points of an outline, contour by contour, and return their number. */
size_t face_read(struct face_point out[FACE_POINTS_MOST], unsigned outline);

enum {
    GLYPH_BITS = 8,
    GLYPH_ONE = 1 << GLYPH_BITS, /* parts of a pixel */
    GLYPH_TALL_MOST = 512,       /* rows of a capital */
    GLYPH_HALO_MOST = 16,        /* pixels */
    GLYPH_LINES_MOST = 2048,     /* lines of an outline */
};

/* Convert units of the face to parts of a pixel, rounded, for capitals of `tall` rows. */
int64_t glyph_scaled(int64_t units, uint32_t tall);

struct spot {
    int32_t x, y; /* parts of a pixel, right and down */
};

/* An outline at a size, as lines. */
struct glyph {
    struct spot from[GLYPH_LINES_MOST], to[GLYPH_LINES_MOST]; /* relative to the origin of the glyph
                                                                 */
    int64_t column, row;                                      /* pixel of that origin */
    size_t lines;
    struct spot least, most;
};

/* Make the outline of a letter that begins `left` parts of a pixel from the canvas' edge, with its
 * baseline at the upper edge of row `base`, for capitals of 1..GLYPH_TALL_MOST rows. */
void glyph_make(struct glyph *glyph, unsigned outline, uint32_t tall, int64_t left, int64_t base);

/* Draw its halo, whose radius is given in parts of a pixel and at least a pixel, or with 0 its ink.
 * Marks the pixels in canvas->words if that is not NULL. */
void glyph_draw(const struct canvas *canvas, const struct glyph *glyph, uint32_t halo,
                const uint8_t rgb[3]);

#endif
