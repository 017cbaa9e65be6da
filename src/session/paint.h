/* SPDX-License-Identifier: MIT */
/*
 * What a hand paints: which voxels a ball, a stroke, a box or a polygon covers. Integers alone, so
 * that a command plants the same seeds wherever it is carried out.
 *
 *     ball     the voxels whose centre is no farther than the radius from that of the middle one,
 *              in voxels, or in the world by the spacing of voxels
 *     stroke   a ball at each step of the straight way from each corner to the next. A way takes as
 *              many steps as its longest axis has voxels; step i of n goes to the voxel nearest to
 *              i/n of the way, the farther one where two are as near. So leaving out a corner on a
 *              straight way (base/polyline.h) leaves the voxels as they are
 *     shell    of a ball: the voxels of it that have a neighbour outside; of a box: its six faces
 *     box      all between two corners, both included
 *     polygon  in a slice, the voxels whose centre the outline through the centres of the corners,
 *              and from the last one back to the first, winds around (the nonzero rule), and those
 *              whose centre it goes through
 *     ring     of a polygon: the voxels of its slice that lie outside, no farther from one inside
 *              than its width, from centre to centre, in voxels
 *
 * What lies beyond the scene is left out.
 */
#ifndef SESSION_PAINT_H
#define SESSION_PAINT_H

#include "base/err.h"
#include "base/watch.h"
#include "engine/brush.h"
#include "engine/grid.h"

/* Each voxel once, in the order of cells; {0} holds none. */
struct voxels {
    uint32_t *cell;
    size_t count, capacity;
};
void voxels_release(struct voxels *voxels);

/* The steps of a straight way, and the voxel after `part` of its `parts` steps: the first where
 * there are none. */
int64_t paint_steps(const uint32_t from[3], const uint32_t to[3]);
void paint_step(int64_t at[3], const uint32_t from[3], const uint32_t to[3], int64_t part,
                int64_t parts);

/* The voxels, into an empty list; on error it stays empty. Corners lie in the scene, and there is
 * one at least. Memory is bounded by the scene, whatever the number of corners. ERR_MEMORY,
 * ERR_CANCELLED. */
enum err paint_stroke(struct voxels *out, const struct grid *grid, const struct brush *brush,
                      const uint32_t (*corner)[3], size_t corners, struct watch *watch,
                      struct fault *fault);

/* What of a ball, as brush_hollow leaves it, lies in the scene. */
enum err paint_shell(struct voxels *out, const struct grid *grid, const struct brush *brush,
                     const uint32_t middle[3], struct watch *watch, struct fault *fault);
enum err paint_faces(struct voxels *out, const struct grid *grid, const uint32_t corner[3],
                     const uint32_t opposite[3], struct watch *watch, struct fault *fault);
enum err paint_box(struct voxels *out, const struct grid *grid, const uint32_t corner[3],
                   const uint32_t opposite[3], struct watch *watch, struct fault *fault);

/* ERR_INPUT where the corners do not all have one index in common. */
enum err paint_polygon(struct voxels *out, const struct grid *grid, const uint32_t (*corner)[3],
                       size_t corners, struct watch *watch, struct fault *fault);

/* Around what paint_polygon gave of these corners; width 0..BRUSH_REACH_MOST. */
enum err paint_ring(struct voxels *out, const struct grid *grid, const struct voxels *inside,
                    const uint32_t (*corner)[3], size_t corners, int width, struct watch *watch,
                    struct fault *fault);

#endif
