/* SPDX-License-Identifier: MIT */
/*
 * Fitting: the zoom at which what is shown fills a picture, and the place that comes to its middle.
 *
 * How far objects reach in a direction is decided by the ends of their rows of voxels along x:
 * those are held, two for each row, and asked about any number of views. A voxel counts as its
 * cube. Where nothing is shown, the scene is what has to fit.
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
    bool is_scene; /* nothing is shown */
};

/* Of what a border shows, which is up to date. ERR_MEMORY. */
enum err fit_init(struct fit *fit, const struct border *border, struct fault *fault);
void fit_release(struct fit *fit);

/* The voxel nearest to the middle of what is seen at a view's angles, in depth as well. */
void fit_place(const struct fit *fit, const struct view *view, uint32_t place[3]);

/* The largest zoom at which all of it is seen, with a margin, at the view's angles and size and
 * with that voxel in the middle, and at which there is a camera for samples x samples a pixel. */
uint32_t fit_zoom(const struct fit *fit, const struct view *view, const uint32_t place[3],
                  uint32_t samples);

/* The voxel in the middle of the box of what is shown. */
void fit_middle(const struct fit *fit, uint32_t place[3]);

/* The largest zoom at which all of it is seen from wherever one looks, in a view of that size, with
 * that voxel in the middle, or with NULL the middle of the scene: for the scene, then,
 * view_fitting_zoom. */
uint32_t fit_all_round(const struct fit *fit, const struct view *view, const uint32_t *place,
                       uint32_t samples);

#endif
