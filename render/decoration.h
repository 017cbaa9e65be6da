/* SPDX-License-Identifier: MIT */
/*
 * Decorations: annotations drawn over a rendition.
 *
 *     letters   the patient's sides, R L A P S I, at the edges of the picture; in an oblique view
 *               two or three, the nearest first. If the orientation is unknown: the axes, "+x"
 *     scale     a bar of a round length; in voxels if the spacing is unknown
 *     legend    the visible labels, with their amounts
 *     seeds     placed seeds (not those from pieces of a file) and eliminators whose voxels are
 *               visible, marked as in slices
 *     cross     the cross-hair, if its voxel is visible
 *
 * Only colours change: the voxel of a pixel is the one below. Decorations have outlines, so that
 * they show on any background, and are opaque except at the edges of letters. Their size follows
 * the picture; a picture that is too small for a part omits it.
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
    const struct rendition *frame; /* the picture, whose colours the canvas has; used for seeds and
                                      the cross-hair alone */
    const struct camera *camera;   /* the camera of its samples */
    uint32_t samples;              /* samples a side of a pixel */
    const struct palette *palette;
    struct mark_choice marked;      /* the seeds to mark */
    bool is_bright;                 /* the background is bright: draw dark words */
    const struct legend_line *line; /* [lines] */
    size_t lines;
    const uint32_t *eliminator; /* [eliminators], cells */
    size_t eliminators;
    uint32_t cross; /* a cell */
};

/* ERR_MEMORY, with the canvas half drawn. */
enum err decoration_draw(const struct canvas *canvas, const struct decoration *decoration,
                         struct fault *fault);

/* The words at the left, right, upper and lower edges. */
enum { DECORATION_WORD = 8 };
void decoration_sides(char word[4][DECORATION_WORD], const struct camera *camera);

/* Return the bar's length in pixels of a picture of that width, and in words; 0 for no bar. */
int64_t decoration_scale(char words[32], const struct camera *camera, uint32_t samples,
                         uint32_t width);

#endif
