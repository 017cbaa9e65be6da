/* SPDX-License-Identifier: MIT */
/*
 * Ways: what follows from the predecessors of voxels.
 *
 * The way of a voxel is its path back to the seed. The cost rises for the last time at the
 * strongest edge of the path: where a label has leaked, it has leaked there.
 *
 * The passage is the edge through which most of the voxels came that an edit took from a label. Of
 * those voxels, PASSAGE_SAMPLES are looked at, evenly over the list of changes. On each one's way
 * the cost rises at edges. The passage is the strongest edge that at least half of the ways have in
 * common; where no edge is, that which most of them share. So it is where a leak comes through, not
 * an edge somewhere beyond it. That takes time by the length of so many ways, and none by how much
 * has changed; an edit that is not asked about pays nothing.
 *
 * A tree goes from its root by the children, which the directions of voxels lead back from. So what
 * is asked of a tree takes time by the tree, and not by the scene; and no memory, since the way
 * down and up again is in the cells.
 */
#ifndef ENGINE_WAY_H
#define ENGINE_WAY_H

#include "engine/forest.h"

/* {0} is of no voxel. */
struct way {
    uint32_t *cell; /* [count]: from the voxel to its seed */
    size_t count, capacity;
    uint32_t edge; /* into which voxel the strongest one leads; CELL_NONE where the cost is 0 */
};

/* Of a voxel that a seed reaches, in place of the former one. ERR_MEMORY. */
enum err way_find(struct way *way, const struct forest *forest, uint32_t cell, struct fault *fault);
void way_release(struct way *way);

enum { PASSAGE_SAMPLES = 16 };

/* The voxel in which the cost rises there. False where no list names the voxels that the label has
 * lost (changes.listed), or no path to them crosses an edge. */
bool passage_find(uint32_t *cell, const struct forest *forest, unsigned label);

/* How many voxels the tree of a planted seed has. Where they are more than `most`, counting ends:
 * most + 1. */
size_t tree_voxels(const struct forest *forest, uint32_t seed, size_t most);

#endif
