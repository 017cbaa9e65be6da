/* SPDX-License-Identifier: MIT */
/*
 * Hints: the places where the border between labels is least certain.
 *
 * A voxel is at the border where a voxel beside it, by a face, has another label; both are reached,
 * and the edge between them is the greater weight of the two steps. The certainty of the voxel is
 *
 *     margin + edge - what its path has cost HINT_BACK steps before
 *
 * The margin (engine/margin.h) is what the other label would have to pay more. On most of a border
 * it is 0, since both labels pay the same edge; then it counts how far that stands above what has
 * been paid before. Below 0 more has been paid than the edge: it does not hold the labels apart,
 * and the number of steps has decided where they meet.
 *
 * Weak are the voxels whose certainty is at most `limit`, the least number that a HINT_SHARE-th of
 * all voxels at the border or more do not exceed. Weak voxels between the same two labels that
 * hang together, by corners too, and lie in the same block of HINT_BLOCK^3 voxels, are a place: one
 * that is longer is several, and each can be looked at.
 *
 * The doubt of a place is the sum over its voxels of limit + 1 - certainty. Places come in the
 * order of their doubts, the greatest first; of equals, that with the lower cell.
 *
 * All of it is a function of the forest, in integers.
 */
#ifndef ENGINE_HINTS_H
#define ENGINE_HINTS_H

#include "engine/forest.h"

enum { HINT_SHARE = 10, HINT_BLOCK = 16, HINT_BACK = 3, HINTS_MOST = 999 };

struct hint {
    uint32_t cell;     /* its least certain voxel; of several the nearest to the middle of all, */
    uint32_t voxels;   /* and the first. How many there are, on both sides */
    int32_t certainty; /* of the cell, */
    uint16_t margin;   /* the margin of it, */
    uint16_t edge;     /* the edge at it, */
    uint8_t label;     /* its label, */
    uint8_t other;     /* and that of the neighbour which offers it least */
    uint64_t doubt;
};

/* {0} is of nothing. */
struct hint_list {
    struct hint *item; /* HINTS_MOST at most */
    size_t count, capacity;
    size_t border, weak; /* voxels */
    int32_t limit;
};

/* Those of a forest and its margins (margin_new), in place of the former ones. Where `heat` is not
 * NULL, [cells] and 0, it gets how uncertain the border is: 2 for the weak voxels of it, 1 for the
 * weakest quarter; and so the voxels of the same label beside each, by
 * corners too. ERR_MEMORY, ERR_CANCELLED by the scene's watch; then there are none. */
enum { HINT_HEATS = 2, HINT_WARM = 4 };
enum err hints_find(struct hint_list *hints, const struct forest *forest, const uint16_t *margin,
                    uint8_t *heat, struct fault *fault);
void hints_release(struct hint_list *hints);

#endif
