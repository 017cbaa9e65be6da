/* SPDX-License-Identifier: MIT */
/*
 * Notes: what slices and renditions have in common of what is drawn over them: words and bars, and
 * marks of seeds and eliminators. A seed is a dot of its label's colour, an eliminator an x,
 * outlined in white where it waits for a run, else in black.
 *
 * Sizes follow the picture: marks by `unit`, how many pixels a thin line is wide (slice_unit), and
 * words and bars by `tall`, how many rows a capital has. All of it has an outline, so that it shows
 * on any ground.
 */
#ifndef RENDER_NOTES_H
#define RENDER_NOTES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "render/canvas.h"
#include "render/palette.h"

/*
 * Words in pictures, set in one face (render/glyph.h) at any size.
 *
 * A size is how many rows a capital is tall. Around letters is a halo, so that they stand on any
 * ground: of black or what is asked for, a tenth as wide as they are tall, and a pixel at least.
 * Where letters meet ink goes over halos. No library draws them, and no float, so that a golden
 * image with words in it is the same on every machine.
 *
 * Words are UTF-8. What the face lacks is a box, as is each byte that is no such text, and a
 * character that nobody would see.
 */

struct ink {
    uint8_t rgb[3], outline[3];
};

/* Draws words; a line feed begins the next line. The first letter stands at column `left`, and the
 * top of its capitals is row `top`; accents, tails and the halo go beyond. `tall` is
 * 1..GLYPH_TALL_MOST. */
void text_draw(const struct canvas *canvas, int64_t left, int64_t top, uint32_t tall,
               const char *words, const struct ink *ink);

/* How wide halos are, in whole pixels. */
int64_t text_halo(uint32_t tall);

/* Columns that one line takes; rows from one line to the next. */
int64_t text_width(const char *words, uint32_t tall);
int64_t text_line(uint32_t tall);

/* Cuts a line at whole letters, and ends it with dots, so that it takes no more columns; where
 * nothing fits, nothing is left. `capacity` is that of `words`. */
void text_cut(char *words, size_t capacity, uint32_t tall, int64_t columns);

enum {                          /* pixels of the picture's shorter side */
       NOTES_LETTERS_FROM = 48, /* at which letters of the patient's sides begin, */
       NOTES_BARS_FROM = 128,   /* and bars, */
       NOTES_LARGE_FROM = 192,  /* and from which letters and marks are larger */
};

/* Of words and bars, as slices have it; for what is mostly bright. */
extern const struct ink notes_light, notes_dark;
extern const uint8_t notes_yellow[3]; /* of the cross-hair */

/* The picture's shorter side. */
uint32_t notes_side(const struct canvas *canvas);

/* How tall words are in a picture with so many pixels on its shorter side: about as in print, where
 * it is as wide as a column; and letters of the patient's sides. */
uint32_t notes_tall(uint32_t side);
uint32_t notes_tall_letters(uint32_t side);

/* How far words so tall, and bars, stay from the edge. */
int64_t notes_margin(uint32_t tall);

/* Words in the middle of the left, right, upper and lower edges, as large as in a picture of that
 * shorter side. */
void notes_draw_sides(const struct canvas *canvas, uint32_t side, const char *const word[4],
                      const struct ink *ink);

/* Bottom left: a bar so many pixels long, and its length in words above it. */
void notes_draw_scale(const struct canvas *canvas, uint32_t tall, int64_t pixels, const char *words,
                      const struct ink *ink);

/* ---- marks ---- */

struct mark {
    int64_t column, row; /* the pixel of its middle */
    size_t at;           /* where it lies in struct mark_runs, if that is made */
    uint8_t label;       /* one whose colour is black is marked in light grey */
    bool eliminates, waits;
};

/* Which seeds are marked, by their cells: those that `shows` says; {0}: all. */
struct mark_choice {
    bool (*shows)(const void *of, uint32_t cell);
    const void *of;
};

static inline bool mark_choice_has(const struct mark_choice *choice, uint32_t cell)
{
    return !choice->shows || choice->shows(choice->of, cell);
}

/* {0} is none; the caller frees `mark`. */
struct marks {
    struct mark *mark;
    size_t count, capacity;
    bool failed; /* there was no memory for one */
};

void marks_add(struct marks *marks, struct mark mark);

/* All outlines first, so that a ball of seeds is one thing with one outline; x over dots. `unit` is
 * how many pixels a thin line is wide, and marks have `more` on every side than that takes. */
void marks_draw(const struct canvas *canvas, const struct marks *marks, int64_t unit, int64_t more,
                const struct palette *palette);

/* More in a picture in which that does not hide what is marked. */
int64_t marks_more(const struct canvas *canvas);

/* The colour of a label's seeds. */
const uint8_t *marks_colour(const struct palette *palette, uint8_t label);

/* Which places, row by row, have seeds that are alike: what mark_run has for them, 0 for none. */
struct mark_runs {
    uint16_t *run;
    size_t columns, rows;
    size_t step; /* from a place to its neighbours */
};

/* What is the same of the seeds of a run: their label, and whether they wait; 0 is no seed. */
uint16_t mark_run(const struct mark *mark);

/* Removes seeds that have more than `most` neighbours like them, of four: of a run only the rim
 * stays; or only seeds that are alone. */
enum { MARKS_OF_RIMS = 3, MARKS_ALONE = 0 };
void marks_keep(struct marks *marks, const struct mark_runs *runs, unsigned most);

#endif
