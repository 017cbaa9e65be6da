/*
 * The way of a voxel: its path back to the seed, and where on it the cost rises.
 *
 * The cost rises for the last time at the strongest edge of the path: where a label has leaked, it
 * has leaked there.
 */
#ifndef ENGINE_WAY_H
#define ENGINE_WAY_H

#include "engine/forest.h"

/* {0} is of no voxel. */
struct way {
    uint32_t *cell; /* [count]: from the voxel to its seed */
    size_t count, capacity;
    uint32_t
        edge; /* the voxel into which the strongest edge leads; CELL_NONE where the cost is 0 */
};

/* Of a voxel that a seed reaches, in place of the former one. ERR_MEMORY. */
enum err way_find(struct way *way, const struct forest *forest, uint32_t cell, struct fault *fault);
void way_release(struct way *way);

#endif
