/* SPDX-License-Identifier: MIT */
/*
 * The margin of a voxel: by how much its label has won; and its rival, the label that is next.
 *
 *     margin(t) = C'(t) - C(t)
 *
 * C(t) is the cost of t in the forest, the least f_max cost of a path to t from any seed, and C'(t)
 * the least f_max cost of a path to t from a seed of another label than t's. Both are costs of
 * paths in the whole region of interest, through any trees. A margin of 0 means that another label
 * reaches the voxel at the same cost, and hops or the number of a root decided; a large margin
 * means that another label would have to cross a much stronger edge.
 *
 * No forest of every label is computed. The labels whose paths reach t through a neighbour s are
 * the same for s: so
 *
 *     C'(t) = min over neighbours s of max(w(s, t), L(s) = L(t) ? C'(s) : C(s))
 *
 * and one pass over costs, from the borders of labels inwards, solves it. Most margins are 0 and
 * known before the pass: if C'(r) <= b for a root r, then C'(t) = C(t) for every t of its tree with
 * C(t) >= b, since the path from r to t costs C(t). The bar of a root is an upper bound of its C',
 * computed from the offers at the borders of its tree: the way back to r costs no more than the way
 * from r, or the weight of r. On ch2 an eighth of the voxels is left to the pass, and margins need
 * 0.4 of the time.
 *
 * This holds while w does not depend on the label of the path, so not under ARC_POLARITY. If seeds
 * have reaches (engine/brush.h), C is the cost in the forest, and C' solves this equation from
 * there: the cost of another label from its current voxels, ignoring its seeds' reaches. C' may be
 * less than C: then the margin is 0, since only a reach has decided.
 *
 * The rival of a voxel is the label that would win it if the seeds of its own label were removed.
 * The search runs backwards from the voxel, through voxels of its label, along steps from the least
 * weight up, until no further step can be cheaper than the result: little work near borders, the
 * work of a run if there are no borders.
 */
#ifndef ENGINE_MARGIN_H
#define ENGINE_MARGIN_H

#include "engine/forest.h"

/* No seed of another label reaches the voxel (at a cost below 65535), or no seed at all. */
enum { MARGIN_NONE = 65535 };

/* Compute the margins by cell, [grid.cells], freed by free(); MARGIN_NONE in cells that are no
 * voxels. No edit may be in progress. ERR_USAGE under ARC_POLARITY, ERR_MEMORY, ERR_CANCELLED by
 * the scene's watch; then *margin is NULL. */
enum err margin_new(uint16_t **margin, const struct forest *forest, struct fault *fault);

struct rival {
    bool exists;   /* false if no seed of another label reaches the voxel */
    uint32_t cost; /* C' of the voxel */
    uint8_t label; /* among labels of equal cost, the smallest that was examined */
};

/* Find the rival of a voxel that a seed reaches, none under ARC_POLARITY; no edit may be in
 * progress. ERR_MEMORY, ERR_CANCELLED by the scene's watch. */
enum err rival_find(struct rival *rival, const struct forest *forest, uint32_t cell,
                    struct fault *fault);

#endif
