/* SPDX-License-Identifier: MIT */
/*
 * Hints: the places where the border between labels is least certain.
 *
 * A voxel is at the border if a face neighbour has another label; seeds reach both, and the edge
 * between them is the greater weight of the two steps. The certainty of the voxel is
 *
 *     margin + edge - the cost of its path HINT_BACK steps before
 *
 * The margin (engine/margin.h) is the extra cost of the other label. On most of a border it is 0,
 * since both labels pay for the same edge; then the certainty is the height of the edge above the
 * cost paid before. It is negative if the path has cost more than the edge: then the edge does not
 * separate the labels, and the number of steps has decided where they meet.
 *
 * Weak voxels have a certainty of at most `limit`, the least number that at least a HINT_SHARE-th
 * of all border voxels do not exceed. A place is a set of weak voxels between the same two labels,
 * connected by faces, edges or corners, within one block of HINT_BLOCK^3 voxels: longer stretches
 * are several places, which can be inspected separately.
 *
 * The doubt of a place is the sum over its voxels of limit + 1 - certainty. Places are sorted by
 * doubt, the greatest first; ties by the lower cell.
 *
 * The result is a function of the forest, in integers.
 */
#ifndef ENGINE_HINTS_H
#define ENGINE_HINTS_H

#include "engine/forest.h"

enum { HINT_SHARE = 10, HINT_BLOCK = 16, HINT_BACK = 3, HINTS_MOST = 999 };

struct hint {
    uint32_t cell;     /* the least certain voxel; of several, the nearest to the middle */
    uint32_t voxels;   /* number of its voxels, on both sides of the border */
    int32_t certainty; /* properties of the cell: */
    uint16_t margin, edge;
    uint8_t label;
    uint8_t other; /* label of the neighbour of the cell with the least offer */
    uint64_t doubt;
};

/* {0} is empty. */
struct hint_list {
    struct hint *item; /* HINTS_MOST at most */
    size_t count, capacity;
    size_t border, weak; /* numbers of voxels */
    int32_t limit;
};

/* Find the hints of a forest and its margins (margin_new), replacing the former ones. `heat` may be
 * NULL, or [cells] and 0: it is set to the uncertainty of the border, 2 for weak voxels and 1 for
 * the weakest quarter, and likewise for voxels of the same label within one step of each, by
 * corners too. ERR_MEMORY, ERR_CANCELLED by the scene's watch; the list is then empty. */
enum { HINT_HEATS = 2, HINT_WARM = 4 };
enum err hints_find(struct hint_list *hints, const struct forest *forest, const uint16_t *margin,
                    uint8_t *heat, struct fault *fault);
void hints_release(struct hint_list *hints);

#endif
