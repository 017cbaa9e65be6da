/*
 * Border projection, from the nearest voxel to the furthest: a pixel that has been given a voxel
 * keeps it, so that what lies behind covered pixels is passed over, whole blocks of voxels at once.
 *
 * A ray runs towards larger numbers along every axis as the camera counts them (render/view.h), and
 * so from cube to cube, and from block to block of cubes. So the order of these numbers, by one
 * axis and where they are the same by the next, is that of cubes along any ray.
 */
#ifndef RENDER_COVER_H
#define RENDER_COVER_H

#include "base/watch.h"
#include "render/rendition.h"

/* The first cube of each pixel; the rendition has no layers that are projected. Uses its
 * `uncovered`. */
void cover_by_border(struct task *task, struct rendition *rendition, const struct camera *camera,
                     const struct border *border);

#endif
