/*
 * Marks of seeds and eliminators in pictures: a seed is a dot of its label's colour, an eliminator
 * an x, outlined in white where it waits for a run, else in black.
 */
#ifndef RENDER_MARKS_H
#define RENDER_MARKS_H

#include <stdbool.h>

#include "render/canvas.h"
#include "render/palette.h"

struct mark {
    int64_t column, row; /* the pixel of its middle */
    size_t at;           /* where it lies in struct mark_runs, if that is made */
    uint8_t label;       /* one whose colour is black is marked in light grey */
    bool eliminates, waits;
};

/* {0} is none; the caller frees `mark`. */
struct marks {
    struct mark *mark;
    size_t count, capacity;
    bool failed; /* there was no memory for one */
};

void marks_add(struct marks *marks, struct mark mark);

/* All outlines first, so that a ball of seeds is one thing with one outline; x over dots. `unit` is
 * how many pixels a thin line is wide. */
void marks_draw(const struct canvas *canvas, const struct marks *marks, int64_t unit,
                const struct palette *palette);

/* Which places, row by row, have seeds that are alike: what mark_run has for them, 0 for none. */
struct mark_runs {
    uint16_t *run;
    size_t columns, rows;
    size_t step; /* from a place to its neighbours */
};

/* What is the same of the seeds of a run: their label, and whether they wait; 0 is no seed. */
uint16_t mark_run(const struct mark *mark);

/* Takes seeds away whose four neighbours are like them: of a run only the rim stays. */
void marks_keep_rims(struct marks *marks, const struct mark_runs *runs);

#endif
