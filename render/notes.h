/* SPDX-License-Identifier: MIT */
/*
 * Notes: words, bars, and marks of seeds and eliminators, drawn over slices and renditions. A seed
 * is a dot of its label's colour, an eliminator an x, outlined in white while it waits for a run,
 * otherwise in black.
 *
 * Sizes follow the picture: marks by `unit`, the width of a thin line in pixels (slice_unit), words
 * and bars by `tall`, the rows of a capital. Everything has an outline, so that it shows on any
 * background.
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
 * The size is the height of a capital in rows. Letters have a halo, so that they show on any
 * background: black or another colour, a tenth as wide as letters are tall, and at least a pixel.
 * Ink is drawn over the halos of neighbours. No library and no floating point is involved, so
 * golden images with words are the same on every machine.
 *
 * Words are UTF-8. Missing characters, bytes that are not UTF-8 and invisible characters become
 * boxes.
 */

struct ink {
    uint8_t rgb[3], outline[3];
};

/* Draw words; a line feed begins the next line. The first letter begins at column `left`, and the
 * top of its capitals is row `top`; accents, descenders and the halo extend beyond. `tall` is
 * 1..GLYPH_TALL_MOST. */
void text_draw(const struct canvas *canvas, int64_t left, int64_t top, uint32_t tall,
               const char *words, const struct ink *ink);

/* Return the width of halos, in whole pixels. */
int64_t text_halo(uint32_t tall);

/* Return the columns of one line; and the rows from one line to the next. */
int64_t text_width(const char *words, uint32_t tall);
int64_t text_line(uint32_t tall);

/* Shorten a line to whole letters followed by an ellipsis, to fit into `columns`; empty if not even
 * that fits. `capacity` is that of `words`. */
void text_cut(char *words, size_t capacity, uint32_t tall, int64_t columns);

enum {                          /* smallest shorter side of a picture, in pixels, with */
       NOTES_LETTERS_FROM = 48, /* letters of the patient's sides */
       NOTES_BARS_FROM = 128,   /* bars */
       NOTES_LARGE_FROM = 192,  /* larger letters and marks */
};

/* Colours of words and bars, as in slices; and for bright backgrounds. */
extern const struct ink notes_light, notes_dark;
extern const uint8_t notes_yellow[3]; /* the cross-hair's in files, */
extern const uint8_t
    notes_lime[3]; /* and on a screen, far from labels 1 to 8, also without colours */

/* Return the picture's shorter side. */
uint32_t notes_side(const struct canvas *canvas);

/* Return the height of words in a picture with this shorter side, about that of print in a picture
 * one column wide; and that of letters of the patient's sides. */
uint32_t notes_tall(uint32_t side);
uint32_t notes_tall_letters(uint32_t side);

/* Return the margin between such words or bars and the edge. */
int64_t notes_margin(uint32_t tall);

/* Draw words in the middle of the left, right, upper and lower edges, as large as in a picture of
 * that shorter side. */
void notes_draw_sides(const struct canvas *canvas, uint32_t side, const char *const word[4],
                      const struct ink *ink);

/* Draw a bar of `pixels` length at the bottom left, with its length in words above it. */
void notes_draw_scale(const struct canvas *canvas, uint32_t tall, int64_t pixels, const char *words,
                      const struct ink *ink);

/* ---- marks ---- */

struct mark {
    int64_t column, row; /* pixel of its middle */
    size_t at;           /* its place in struct mark_runs, if used */
    uint8_t label;       /* a label whose colour is black is marked in light grey */
    bool eliminates, waits;
};

/* The seeds to mark, by cell: `shows` selects them; {0}: all. */
struct mark_choice {
    bool (*shows)(const void *of, uint32_t cell);
    const void *of;
};

static inline bool mark_choice_has(const struct mark_choice *choice, uint32_t cell)
{
    return !choice->shows || choice->shows(choice->of, cell);
}

/* {0} is empty; the caller frees `mark`. */
struct marks {
    struct mark *mark;
    size_t count, capacity;
    bool failed; /* memory ran out for a mark */
};

void marks_add(struct marks *marks, struct mark mark);

/* Draw all outlines first, so that a ball of seeds has one outline, and x over dots. `unit` is the
 * width of a thin line; marks are `more` pixels larger on every side. */
void marks_draw(const struct canvas *canvas, const struct marks *marks, int64_t unit, int64_t more,
                const struct palette *palette);

/* Return the enlargement for a picture that is large enough not to be hidden by marks. */
int64_t marks_more(const struct canvas *canvas);

/* Return the colour of a label's seeds. */
const uint8_t *marks_colour(const struct palette *palette, uint8_t label);

/* The runs of equal seeds at each place, row by row: mark_run of its seed, 0 without a seed. */
struct mark_runs {
    uint16_t *run;
    size_t columns, rows;
    size_t step; /* distance of a place from its neighbours */
};

/* Return the value that equal seeds share: their label, and the state of waiting; 0 is no seed. */
uint16_t mark_run(const struct mark *mark);

/* Remove seeds with more than `most` equal neighbours, of four: keep only the rims of runs; or only
 * isolated seeds, which have none among eight. */
enum { MARKS_OF_RIMS = 3, MARKS_ALONE = 0 };
void marks_keep(struct marks *marks, const struct mark_runs *runs, unsigned most);

#endif
