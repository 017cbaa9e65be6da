/* SPDX-License-Identifier: MIT */
/*
 * Fitting: the zoom at which the visible objects fill a picture, and the place in its centre.
 *
 * The extent of objects in a direction is decided by the ends of their rows of voxels along x: two
 * are kept for each row, and serve any number of views. A voxel counts as a cube. If nothing is
 * visible, the scene is fitted.
 */
#ifndef RENDER_FIT_H
#define RENDER_FIT_H

#include <stdbool.h>

#include "render/border.h"
#include "render/view.h"

enum { FIT_MARGIN = 32 }; /* this part of the picture's shorter side stays free on every side */

struct fit {
    const struct scene *scene;
    uint32_t (*end)[3]; /* voxels */
    size_t ends;
    bool is_scene; /* nothing is visible */
};

/* Fit the voxels that an up-to-date border shows. ERR_MEMORY. */
enum err fit_init(struct fit *fit, const struct border *border, struct fault *fault);
void fit_release(struct fit *fit);

/* Return the voxel nearest to the middle of the visible extent at a view's angles, in depth too. */
void fit_place(const struct fit *fit, const struct view *view, uint32_t place[3]);

/* Return the largest zoom at which all of it fits, with a margin, at the view's angles and size
 * with that voxel in the centre, and at which a camera for samples x samples a pixel exists. */
uint32_t fit_zoom(const struct fit *fit, const struct view *view, const uint32_t place[3],
                  uint32_t samples);

/* Return the voxel in the middle of the bounding box. */
void fit_middle(const struct fit *fit, uint32_t place[3]);

/* Return the largest zoom at which all of it fits from any direction, in a view of that size with
 * that voxel in the centre, or with NULL the middle of the scene: for the whole scene this is
 * view_fitting_zoom. */
uint32_t fit_all_round(const struct fit *fit, const struct view *view, const uint32_t *place,
                       uint32_t samples);

#endif
