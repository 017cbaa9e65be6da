/* SPDX-License-Identifier: MIT */
/*
 * Distances from each voxel of a box to the nearest voxel of a set; and the contours of sets of
 * voxels, from which surfaces are measured.
 *
 * Exact Euclidean distances between the centres of voxels, with a separate spacing along each axis,
 * in time proportional to the number of voxels: one pass along each axis, in which the value of a
 * voxel is the minimum of f(i) + (step (x - i))^2 over its line (Meijster, Roerdink, Hesselink
 * 2000; the parabolas of Felzenszwalb and Huttenlocher 2012). All arithmetic is in integers:
 * distances are squared and counted in a unit that divides the spacing, so they are the same on
 * every machine and for any number of threads.
 *
 * The contour of a set are its voxels with a neighbour, by a face, an edge or a corner, that is not
 * in the set. Places outside the scene are no neighbours, so a set has no contour where the edge of
 * the scene cuts it off. ITK measures distances of this surface
 * (ContourMeanDistanceImageFilter, SignedMaurerDistanceMapImageFilter).
 */
#ifndef ENGINE_DISTANCE_H
#define ENGINE_DISTANCE_H

#include <stdbool.h>
#include <stdint.h>

#include "base/err.h"
#include "base/team.h"
#include "base/watch.h"

/* Unit of the squared distances of a box. */
struct distance_scale {
    uint32_t step[3]; /* units between voxel centres along x, y, z; 1.. */
    uint64_t unit_nm;
};

/* Choose the unit: the greatest common divisor of the spacing. For a box with more than 2^30 units
 * along an axis, it is the least sufficient multiple by a power of two, and the steps are rounded:
 * by less than 1 in 30 000, and by less than 1 in 400 000 up to 2 metres. Sides are 1..2^20. */
struct distance_scale distance_scale_of(const uint32_t spacing_nm[3], const uint32_t size[3]);

#define DISTANCE_NONE UINT64_MAX

/* Transform squared[z][y][x], x fastest: in, 0 in the voxels of the set and DISTANCE_NONE in all
 * others; out, the squared distance to the nearest voxel of the set, or DISTANCE_NONE for an empty
 * set. `size` and `scale` are those of distance_scale_of, or smaller. ERR_MEMORY, ERR_CANCELLED. */
enum err distance_spread(uint64_t *squared, const uint32_t size[3],
                         const struct distance_scale *scale, struct team *team, struct watch *watch,
                         struct fault *fault);

/* A box of the scene, [z][y][x]; no voxel outside it is in a set. */
struct contour_box {
    uint32_t size[3];
    bool ends[3][2]; /* the scene ends at the first, at the last voxel along x, y, z */
};

/* Find contours of up to eight sets at once, one per bit of a byte: from `set` to `contour`, with
 * working memory `room`; each has a byte a voxel. Undefined if the watch (or NULL) has stopped
 * it. */
void contour_find(uint8_t *contour, const uint8_t *set, uint8_t *room,
                  const struct contour_box *box, struct watch *watch);

#endif
