/* SPDX-License-Identifier: MIT */
/*
 * Shapes of seeds: the voxels of a ball, a stroke, a box or a polygon. All computations are in
 * integers, so that a command plants the same seeds on every machine.
 *
 *     ball     voxels whose centre is no farther than the radius from the centre of the middle one,
 *              in voxels, or in millimetres by the spacing
 *     stroke   a ball at each step of the straight line from each corner to the next. A line has a
 *              step for each voxel along its longest axis; step i of n is the voxel nearest to i/n
 *              of the line, the farther one of two equally near. So removing a corner on a straight
 *              line (base/polyline.h) leaves the voxels unchanged
 *     shell    of a ball: its voxels with a neighbour outside; of a box: its six faces
 *     box      all voxels between two corners, both included
 *     polygon  in a slice, the voxels whose centre is inside the closed outline through the centres
 *              of the corners (the nonzero rule), or on it
 *     ring     of a polygon: voxels outside it in its slice, no farther than its width from a voxel
 *              inside, from centre to centre, in voxels
 *
 * Voxels outside the scene are left out.
 */
#ifndef SESSION_PAINT_H
#define SESSION_PAINT_H

#include "base/err.h"
#include "base/watch.h"
#include "engine/brush.h"
#include "engine/grid.h"

/* Each voxel once, in the order of cells; {0} is empty. */
struct voxels {
    uint32_t *cell;
    size_t count, capacity;
};
void voxels_release(struct voxels *voxels);

/* Number of steps of a straight line, and the voxel after `part` of `parts` steps: the first if
 * there are no steps. */
int64_t paint_steps(const uint32_t from[3], const uint32_t to[3]);
void paint_step(int64_t at[3], const uint32_t from[3], const uint32_t to[3], int64_t part,
                int64_t parts);

/* Collect the voxels in an empty list, which stays empty on errors. Corners are in the scene;
 * there is at least one. Memory is bounded by the scene, whatever the number of corners.
 * ERR_MEMORY, ERR_CANCELLED. */
enum err paint_stroke(struct voxels *out, const struct grid *grid, const struct brush *brush,
                      const uint32_t (*corner)[3], size_t corners, struct watch *watch,
                      struct fault *fault);

/* The part of a ball, hollow by brush_hollow, that is in the scene. */
enum err paint_shell(struct voxels *out, const struct grid *grid, const struct brush *brush,
                     const uint32_t middle[3], struct watch *watch, struct fault *fault);

/* The box between two corners, or (`is_hollow`) its faces. */
enum err paint_box(struct voxels *out, const struct grid *grid, const uint32_t corner[3],
                   const uint32_t opposite[3], bool is_hollow, struct watch *watch,
                   struct fault *fault);

/* ERR_INPUT if the corners do not all have one index in common. */
enum err paint_polygon(struct voxels *out, const struct grid *grid, const uint32_t (*corner)[3],
                       size_t corners, struct watch *watch, struct fault *fault);

/* The ring around the result of paint_polygon for these corners; width 0..BRUSH_REACH_MOST. */
enum err paint_ring(struct voxels *out, const struct grid *grid, const struct voxels *inside,
                    const uint32_t (*corner)[3], size_t corners, int width, struct watch *watch,
                    struct fault *fault);

#endif
