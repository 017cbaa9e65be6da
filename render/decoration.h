/* SPDX-License-Identifier: MIT */
/*
 * Decorations: what may be drawn over a rendition, for people who look at it.
 *
 *     letters   the patient's sides, R L A P S I, at the edges of the picture; the two or three of
 *               an oblique view with the nearest first. Of unknown orientation: the axes, "+x"
 *     scale     a bar of a round length; in voxels where their distance is unknown
 *     legend    the labels that are shown, with how much each takes
 *     seeds     seeds that were placed, not those of a file's pieces, and eliminators, whose voxels
 *               pixels show, as slices mark them
 *     cross     the cross-hair, if a pixel shows its voxel
 *
 * Only colours change: which voxel a pixel shows is what is below. What is drawn has an outline, so
 * that it shows on any ground, and is opaque but for the edges of letters. Sizes follow the
 * picture; one that is too small for a part goes without it.
 */
#ifndef RENDER_DECORATION_H
#define RENDER_DECORATION_H

#include "render/canvas.h"
#include "render/notes.h"
#include "render/palette.h"
#include "render/rendition.h"

#define DECORATIONS "letters|scale|legend|seeds|cross"
enum { /* bits, in that order */
       DECORATE_LETTERS = 1,
       DECORATE_SCALE = 2,
       DECORATE_LEGEND = 4,
       DECORATE_SEEDS = 8,
       DECORATE_CROSS = 16,
       DECORATE_ALL = 31,
};

/* A label of the legend. */
struct legend_line {
    uint8_t label;
    char name[32], amount[32];
};

struct decoration {
    uint32_t parts;
    const struct rendition *frame; /* the picture, of which the canvas has the colours; for seeds
                                      and the cross-hair alone */
    const struct camera *camera;   /* of its samples, */
    uint32_t samples;              /* so many a side for a pixel */
    const struct palette *palette;
    struct mark_choice marked;      /* of the seeds */
    bool is_bright;                 /* what is behind the objects: words are dark then */
    const struct legend_line *line; /* [lines] */
    size_t lines;
    const uint32_t *eliminator; /* [eliminators], cells */
    size_t eliminators;
    uint32_t cross; /* a cell */
};

/* ERR_MEMORY, with the canvas half drawn. */
enum err decoration_draw(const struct canvas *canvas, const struct decoration *decoration,
                         struct fault *fault);

/* What stands at the left, right, upper and lower edges. */
enum { DECORATION_WORD = 8 };
void decoration_sides(char word[4][DECORATION_WORD], const struct camera *camera);

/* The bar's length in pixels of a picture of that width, and in words; 0 for none. */
int64_t decoration_scale(char words[32], const struct camera *camera, uint32_t samples,
                         uint32_t width);

#endif
