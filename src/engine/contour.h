/*
 * The contour of a set of voxels: those of its voxels that have a neighbour, by a face, an edge or
 * a corner, which is not in the set. What lies beyond the scene is no neighbour, so a set that the
 * edge of the scene cuts off has no contour there. This is the surface that ITK measures distances
 * of (ContourMeanDistanceImageFilter, SignedMaurerDistanceMapImageFilter).
 */
#ifndef ENGINE_CONTOUR_H
#define ENGINE_CONTOUR_H

#include <stdbool.h>
#include <stdint.h>

#include "base/watch.h"

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
