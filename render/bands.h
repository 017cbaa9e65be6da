/* SPDX-License-Identifier: MIT */
/*
 * Bands: draw a picture of many samples a few rows at a time.
 *
 * A picture of 2048x2048 pixels with 4x4 samples has 67 million samples, some 1.7 GB, and none is
 * needed after its pixel is computed. So a few rows are drawn as a rendition of their own, by a
 * camera that sees these rows alone (camera_rows), and reduced at once. With edges, colours depend
 * on nearby pixels (shade_reach), so a thread keeps the rows around its band. The result equals the
 * whole picture drawn at once and reduced, bit for bit.
 *
 * Threads draw separate bands and share only their input. The picture need not be stored: a
 * caller that needs only colours receives those of each band, and the band's memory is reused.
 */
#ifndef RENDER_BANDS_H
#define RENDER_BANDS_H

#include "render/projection.h"
#include "render/shade.h"

/* Receives the rows of the picture from row `top` on, each once, from any thread and in any order.
 * The caller's changes to their colours are lost afterwards. */
typedef void take_rows(void *context, const struct rendition *rows, uint32_t top);

struct bands {
    projection *project;         /* project_border is shared among threads */
    const struct camera *camera; /* look->samples times as large as the picture */
    const struct mesh *mesh;     /* up to date */
    const struct palette *palette;
    const struct look *look;
    struct shader *shader;
    uint32_t rows;   /* rows of the picture in a band, or a few more; 0: the fastest */
    take_rows *take; /* or NULL */
    void *context;
};

/* Draw into `out`, of the size of the picture, or, if it is NULL, for `take` alone, under the
 * scene's watch. ERR_MEMORY, with undefined pixels. */
enum err bands_draw(struct rendition *out, const struct bands *bands, struct fault *fault);

#endif
