/*
 * A tree of the forest, by itself: from its root by the children, which the directions of voxels
 * lead back from. So what is asked of a tree takes time by the tree, and not by the scene; and no
 * memory, since the way down and up again is in the cells.
 */
#ifndef ENGINE_TREE_H
#define ENGINE_TREE_H

#include "engine/forest.h"

/* How many voxels the tree of a planted seed has. Where they are more than `most`, counting ends:
 * most + 1. */
size_t tree_voxels(const struct forest *forest, uint32_t seed, size_t most);

#endif
