/* SPDX-License-Identifier: MIT */
/*
 * Paths along the predecessors of voxels, and trees.
 *
 * The path of a voxel leads back to its seed. The cost rises for the last time at the strongest
 * edge of the path: if a label has leaked, it has leaked there.
 *
 * The passage is the edge through which an edit reached most of the voxels that it removed from a
 * label. PASSAGE_SAMPLES of these voxels are examined, chosen by a hash of their places. On the
 * path of each, the cost rises at edges. The passage is the strongest edge common to at least half
 * of the paths; without one, the edge common to the most. So it is the place of the leak, not an
 * edge somewhere beyond it. The time is proportional to the length of the sampled paths and to the
 * number of changes; edits that are not examined need none.
 *
 * A tree is traversed from its root through the children, to which the directions of voxels lead
 * back. So a query of a tree needs time proportional to the tree, not to the scene, and no memory,
 * since the cells contain the path down and up again.
 */
#ifndef ENGINE_WAY_H
#define ENGINE_WAY_H

#include "engine/forest.h"

/* {0} is an empty path. */
struct way {
    uint32_t *cell; /* [count]: from the voxel to its seed */
    size_t count, capacity;
    uint32_t edge; /* the voxel after the strongest edge; CELL_NONE if the cost is 0 */
};

/* Find the path of a voxel that a seed reaches, replacing the former one. ERR_MEMORY. */
enum err way_find(struct way *way, const struct forest *forest, uint32_t cell, struct fault *fault);
void way_release(struct way *way);

enum { PASSAGE_SAMPLES = 16 };

/* Find the voxel after the passage of a label. False if the voxels that the label lost are not
 * listed (changes.listed), or no path to them crosses an edge. */
bool passage_find(uint32_t *cell, const struct forest *forest, unsigned label);

/* Number of voxels in the tree of a planted seed. Counting ends at most + 1. */
size_t tree_voxels(const struct forest *forest, uint32_t seed, size_t most);

#endif
