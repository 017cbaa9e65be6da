/* SPDX-License-Identifier: MIT */
/*
 * Bands: a picture of many samples, a few rows at a time.
 *
 * A picture of 2048x2048 pixels of 4x4 samples has 67 million of those, some 1.7 GB. None of them
 * is needed once its pixel is made. So rows of the picture are drawn as a rendition of their own,
 * by a camera that sees these rows alone (camera_rows), and reduced at once. Where there are edges,
 * colours depend on pixels near by (shade_reach), and a thread keeps the rows around that it has
 * drawn. What comes out is the whole drawn at once and reduced, bit for bit.
 *
 * Threads have bands of their own, and nothing in common but what they read. What is made of a
 * picture need not be stored: one who wants no more than colours takes those of each band, and the
 * rest of it is drawn over by the next.
 */
#ifndef RENDER_BANDS_H
#define RENDER_BANDS_H

#include "render/projection.h"
#include "render/shade.h"

/* Rows of the picture from row `top` on, as they are drawn: by any thread, in any order, and each
 * once. They are gone afterwards, so colours may be changed. */
typedef void take_rows(void *context, const struct rendition *rows, uint32_t top);

struct bands {
    projection *project;         /* project_border is the one that is shared by threads */
    const struct camera *camera; /* look->samples times as large as the picture */
    const struct mesh *mesh;     /* up to date */
    const struct palette *palette;
    const struct look *look;
    struct shader *shader;
    uint32_t rows;   /* of the picture, in a band, or some more; 0 for what is fast */
    take_rows *take; /* or NULL */
    void *context;
};

/* Draws into `out`, of the picture's size, or where that is NULL for `take` alone, under the
 * scene's watch. ERR_MEMORY, with pixels of no meaning. */
enum err bands_draw(struct rendition *out, const struct bands *bands, struct fault *fault);

#endif
