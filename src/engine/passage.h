/*
 * The passage: the edge through which most of the voxels came that an edit took from a label.
 *
 * Of those voxels, PASSAGE_SAMPLES are looked at, evenly over the list of changes. On each one's
 * path back to its seed the cost rises at edges. The passage is the strongest edge that at least
 * half of the paths have in common; where no edge is, that which most of them share. So it is where
 * a leak comes through, not an edge somewhere beyond it.
 *
 * That takes time by the length of so many paths, and none by how much has changed; an edit that is
 * not asked about pays nothing.
 */
#ifndef ENGINE_PASSAGE_H
#define ENGINE_PASSAGE_H

#include "engine/forest.h"

enum { PASSAGE_SAMPLES = 16 };

/* The voxel in which the cost rises there. False where no list tells the voxels that the label has
 * lost (changes.listed), or no path to them crosses an edge. */
bool passage_find(uint32_t *cell, const struct forest *forest, unsigned label);

#endif
