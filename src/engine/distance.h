/* SPDX-License-Identifier: MIT */
/*
 * Distances: how far each voxel of a box is from the nearest one of some of its voxels; and the
 * contours of sets of voxels, from which surfaces are measured.
 *
 * Exact and Euclidean, between the centres of voxels, with a spacing of its own along each axis, in
 * time proportional to the number of voxels: one pass along each axis, in which a voxel takes the
 * least of f(i) + (step (x - i))^2 over its line (Meijster, Roerdink, Hesselink 2000; the parabolas
 * of Felzenszwalb and Huttenlocher 2012). All of it is in integers: distances are squared and
 * counted in a unit that divides the spacing, so they are the same on every machine and whatever
 * the number of threads.
 *
 * The contour of a set of voxels is those of its voxels that have a neighbour, by a face, an edge
 * or a corner, which is not in the set. What lies beyond the scene is no neighbour, so a set that
 * the edge of the scene cuts off has no contour there. This is the surface that ITK measures
 * distances of (ContourMeanDistanceImageFilter, SignedMaurerDistanceMapImageFilter).
 */
#ifndef ENGINE_DISTANCE_H
#define ENGINE_DISTANCE_H

#include <stdbool.h>
#include <stdint.h>

#include "base/err.h"
#include "base/team.h"
#include "base/watch.h"

/* Of the squared distances of a box. */
struct distance_scale {
    uint32_t step[3]; /* units between voxel centres along x, y, z; 1.. */
    uint64_t unit_nm;
};

/* The unit is the greatest common divisor of the spacing. In a box that has more than 2^30 of them
 * along an axis, it is the least multiple by a power of two that has not, and the steps are
 * rounded: by less than 1 in 30 000, and by less than 1 in 400 000 up to 2 metres. Sides are
 * 1..65534. */
struct distance_scale distance_scale_of(const uint32_t spacing_nm[3], const uint32_t size[3]);

#define DISTANCE_NONE UINT64_MAX

/* squared[z][y][x], x fastest: 0 in the voxels from which distances are measured, DISTANCE_NONE in
 * all others. Then the squared distance to the nearest of those, DISTANCE_NONE where there is none.
 * `size` and `scale` are as distance_scale_of has them, or smaller. ERR_MEMORY, ERR_CANCELLED. */
enum err distance_spread(uint64_t *squared, const uint32_t size[3],
                         const struct distance_scale *scale, struct team *team, struct watch *watch,
                         struct fault *fault);

/* A box of the scene, [z][y][x]; beyond it no voxel is in a set. */
struct contour_box {
    uint32_t size[3];
    bool ends[3][2]; /* the scene ends at the first, at the last voxel along x, y, z */
};

/* Each bit of a byte is a set; `contour` gets those of the contours. Both have a byte a voxel, as
 * has `room`. Of no use where the watch, or NULL, has stopped it. */
void contour_find(uint8_t *contour, const uint8_t *set, uint8_t *room,
                  const struct contour_box *box, struct watch *watch);

#endif
