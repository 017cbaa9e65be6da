/* SPDX-License-Identifier: MIT */
/*
 * The margin of a voxel: by how much its label has won, and its rival, the label that comes next.
 *
 *     margin(t) = C'(t) - C(t)
 *
 * C(t) is the cost of t in the forest, the least f_max cost of a path to t from any seed, and C'(t)
 * the least f_max cost of a path to t from a seed of another label than t's. Both are costs of
 * paths in the whole region of interest, through whatever trees. So 0 says that another label
 * reaches the voxel as cheaply, and hops or the number of a root decided; a large margin says that
 * one would have to cross a much stronger edge.
 *
 * No forest of every label is computed. The labels whose paths come to t through a neighbour s are
 * the same for s: so
 *
 *     C'(t) = min over neighbours s of max(w(s, t), L(s) = L(t) ? C'(s) : C(s))
 *
 * and one pass over costs, from the borders of labels inwards, solves it: about the time of a run
 * from nothing, and two bytes a cell.
 *
 * That holds while w does not depend on the label of the path, so not under ARC_POLARITY. Where
 * seeds have reaches (engine/brush.h), C is what the forest has, and C' solves this equation from
 * there: what another label would cost from where it is now, wherever its seeds reach. It may be
 * less than C: then the margin is 0, since nothing but a reach has decided.
 *
 * The rival of one voxel is the label that would take it, were the seeds of its own label gone. It
 * is looked for backwards from the voxel, through voxels of its label, along steps from the least
 * weight up, until what is found costs no more than any further step: little work where borders are
 * near, that of a run where there are none.
 */
#ifndef ENGINE_MARGIN_H
#define ENGINE_MARGIN_H

#include "engine/forest.h"

/* No seed of another label reaches the voxel (at a cost below 65535), or none at all does. */
enum { MARGIN_NONE = 65535 };

/* The margins by cell, [grid.cells], freed by free(); MARGIN_NONE in cells that are no voxels. The
 * forest has no edits under way. ERR_USAGE under ARC_POLARITY, ERR_MEMORY, ERR_CANCELLED by the
 * scene's watch; then *margin is NULL. */
enum err margin_new(uint16_t **margin, const struct forest *forest, struct fault *fault);

struct rival {
    bool exists;   /* false where no seed of another label reaches the voxel */
    uint32_t cost; /* C' of the voxel */
    uint8_t label; /* of several that cost as little, the smallest of those that were looked at */
};

/* Of a voxel that a seed reaches, in a forest without edits under way. ERR_USAGE under
 * ARC_POLARITY, ERR_MEMORY, ERR_CANCELLED by the scene's watch. */
enum err rival_find(struct rival *rival, const struct forest *forest, uint32_t cell,
                    struct fault *fault);

#endif
