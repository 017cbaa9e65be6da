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

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "render/canvas.h"

/*
 * The face that words in pictures are set in: outlines of letters, as a table of integers
 * (render/face_table.h, whose head names the font and its licence).
 *
 * Lines and quadratic curves, as fonts of TrueType have them: a point beside the curve draws it
 * towards itself between those on it, and between two such points lies one on the curve halfway.
 * x goes right, y up from the line that letters stand on; FACE_SIZE units are the font's size.
 */

enum { /* in units of the face */
       FACE_SIZE = 1024,
       FACE_CAPITAL = 747, /* how high capitals are, */
       FACE_SMALL = 560,   /* small letters, */
       FACE_ROUND = 14,    /* and how much further those that are round go, up and down; */
       FACE_TALLEST = 778, /* small letters with an ascender, */
       FACE_LOWEST = 213,  /* and how far descenders go down */
};
enum { FACE_OUTLINES = 641, FACE_POINTS_MOST = 256 /* of one of them */ };

struct face_point {
    int16_t x, y;
    bool is_on, begins; /* on the curve; the first of a contour, which is on it */
};

/* The outline of a character: 0, a box, for what the face lacks. */
unsigned face_find(uint32_t point);

/* How much further right the next letter begins, and what a pair of letters adds to that. */
int face_advance(unsigned outline);
int face_kerning(uint32_t point, uint32_t next);

/* The points of an outline, contour by contour; how many. */
size_t face_read(struct face_point out[FACE_POINTS_MOST], unsigned outline);

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
