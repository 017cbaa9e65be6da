/* SPDX-License-Identifier: MIT */
/*
 * A slice: one plane of the scene in grey, with what is known about it drawn over.
 *
 * Pixels are square in millimetres. What label, seed or voxel a pixel shows is that of the voxel
 * that its centre falls in; grey is the same voxel's, or, where `smooth`, interpolated between the
 * centres of the four around. Beyond the scene there is black, and no label.
 *
 * Over it lie marks of seeds and eliminators, the cross-hair, letters, bars, a title. Their sizes
 * follow the picture: what is 1 pixel wide in one of 256 is 2 in one of 512. A picture that is too
 * small for a note goes without it.
 *
 * A slice is a pure function of what is passed, in integers.
 */
#ifndef RENDER_SLICE_H
#define RENDER_SLICE_H

#include <stdbool.h>
#include <stdint.h>

#include "base/err.h"
#include "render/canvas.h"
#include "render/notes.h"
#include "render/palette.h"
#include "render/slice_plan.h"

/* Something to mark: a seed by a dot of its label's colour, an eliminator by an x, outlined in
 * white where it waits for a run, else in black. */
struct slice_mark {
    uint32_t cell;
    uint8_t label;
    bool eliminates, waits;
};

#define SLICE_OVERLAYS "none|tint|contour"
enum slice_overlay {
    SLICE_PLAIN,   /* grey alone */
    SLICE_TINT,    /* a third of the label's colour, two thirds of the grey */
    SLICE_CONTOUR, /* the label's colour where another label is beside, above or below, as near as a
                      thin line is wide: one pixel, two where the picture's shorter side has 400.
                      A hairline, a quarter of the grey, is beside it where no label is, and, of two
                      pixels on, within the label too: so it is seen on white and on grey */
};

/* How slices are drawn, whichever they are. */
struct slice_style {
    uint8_t grey[UINT16_MAX + 1]; /* of each intensity */
    enum slice_overlay overlay;
    const struct palette *palette; /* a label of black there is marked in light grey */
    const bool *visible;           /* [256], whether a label is overlaid */
    const uint8_t *finished;       /* labels (engine/labels.h); NULL: those of the forest */
    bool crosses;                  /* the cross-hair */
    bool marks_seeds; /* seeds that are planted, but those that have four neighbours like them, */
    bool thin;        /* runs of those by a line around them, one alone by a dot, */
    struct mark_choice filled;     /* and a run of these, if any, by a tint; */
    struct mark_choice marked;     /* of those; and beside them: */
    const struct slice_mark *mark; /* [marks]; those of other slices are passed over */
    size_t marks;
    const char *least, *most; /* what stands at the ends of the bar of greys; ASCII */
};

/* Grey rises from black at intensity `low` to white at `high`, and stays so beyond; it falls where
 * low is above high. They differ. */
void slice_window(uint8_t grey[UINT16_MAX + 1], int32_t low, int32_t high);

/* Fills the whole canvas, and canvas->cell where it has that. ERR_MEMORY, with the canvas half
 * drawn. */
enum err slice_draw(const struct canvas *canvas, const struct scene *scene,
                    const struct slice_choice *choice, const struct slice_style *style,
                    struct fault *fault);

#endif
