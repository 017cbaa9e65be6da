/* SPDX-License-Identifier: MIT */
/*
 * The face that words in pictures are set in: outlines of letters, as a table of integers
 * (render/face_table.h, whose head names the font and its licence).
 *
 * Lines and quadratic curves, as fonts of TrueType have them: a point beside the curve draws it
 * towards itself between those on it, and between two such points lies one on the curve halfway.
 * x goes right, y up from the line that letters stand on; FACE_SIZE units are the font's size.
 */
#ifndef RENDER_FACE_H
#define RENDER_FACE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

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

#endif
