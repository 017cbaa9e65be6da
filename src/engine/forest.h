/* SPDX-License-Identifier: MIT */
/*
 * The forest: every voxel belongs to the tree of the seed that reaches it best.
 *
 * The key of a voxel is (cost, hops, root), compared as one integer. A seed has key (0, 0, itself).
 * A voxel s offers its neighbour t
 *
 *     extend(key(s), w) = (w, 0, root)            where w > cost,     w = weight of the arc
 *                         (cost, hops + 1, root)  otherwise           (engine/weight.h)
 *
 * and the forest is the solution of key(t) = min(own seed's key, min over neighbours of what they
 * offer). extend is strictly increasing, so there is one solution: the forest is a function of
 * the set of seeds, whatever the order in which they were planted, removed, or processed. Cost is
 * the textbook f_max cost; hops and root decide every tie. (Method: Audigier, Lotufo, Falcao 2006;
 * differential transform: Falcao and Bergo 2004; the canonical key is this program's own.)
 *
 * A seed may have a reach, beyond which its tree offers nothing: see struct reach in
 * engine/brush.h.
 *
 * An edit changes the set of seeds and repairs the solution in time proportional to what changes.
 *
 * Words here and in the literature
 *   seed         marker voxel of the image foresting transform; a seed is the root of its tree
 *   eliminator   a deletion marker of the differential transform: its tree is cleared
 *   root         the seed at the end of the path of predecessors, P* in the papers
 *   predecessor  P(t), the voxel whose offer t has taken; its offers are how paths are extended
 *   cost         C(t), the f_max cost of the best path: the largest weight on it
 *   hops         plateau distance: steps along the path since its cost last rose; the literature's
 *                FIFO order within a cost decides by it, and lexicographic costs are (cost, hops)
 *   level        (cost, hops), a bucket of the priority queue
 *   cleared, frontier   voxels that have lost their tree, and those around them that have not
 *   region of interest (roi)   voxels outside it take no part
 *   outbox       offers that one worker has for cells that another worker owns
 *
 * Invariants between calls
 *   T1 every key solves the equation above; forest_check asserts it;
 *   T2 label and root of a voxel are those of its predecessor, to which cell.direction leads; a
 *      seed is its own root;
 *   T3 no voxel has hops 65535: an edit that would need more steps is refused, and undone;
 *   T4 both digests equal a recount; forest_check asserts it.
 * Invariant in the middle of a pass
 *   T5 every key is supported by its predecessor, or that predecessor is queued; and a voxel that
 *      others might offer better than it has is queued, and marked CELL_RAISED. So an edit is taken
 *      back, at any moment, by the inverse edit: no copy of the former state is needed.
 */
#ifndef ENGINE_FOREST_H
#define ENGINE_FOREST_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/team.h"
#include "base/err.h"
#include "engine/brush.h"
#include "engine/changes.h"
#include "engine/scene.h"
#include "engine/weight.h"

struct forest;

/* What an edit does to one voxel: plant a seed of a label (in place of one that may be there; not
 * outside the region of interest), or remove the seed. */
enum { EDIT_ERASE = -1 };
struct edit {
    uint32_t cell;
    int16_t label;  /* 0..255, or EDIT_ERASE */
    uint16_t reach; /* of the seed, by its number (forest_add_reach); 0 for none, or no seed */
};

/* From now on the labels are noted before all grows anew, so that changes are counted there too,
 * for a scan of the scene before and after. */
void forest_count_anew(struct forest *forest);

/* A forest without seeds over a scene with weights; the scene outlives it. Adjacency 6 or 26. */
enum err forest_new(struct forest **forest, struct scene *scene, unsigned adjacency,
                    struct fault *fault);
void forest_free(struct forest *forest);

/*
 * Applies `count` edits as one. A later edit of the same voxel wins. Planting what is planted or
 * erasing what is not is allowed and does nothing. The scene's watch is polled after every level of
 * the pass, while an edit is taken back too. On any error the forest is as before, and
 * forest_changes is of no use: ERR_CANCELLED (the watch stopped it), ERR_LIMIT (T3), ERR_MEMORY,
 * after which it may have its former seeds alone and be suspended (forest_suspend).
 */
enum err forest_edit(struct forest *forest, const struct edit *edit, size_t count,
                     struct fault *fault);

/* Computes the whole forest again from its seeds: after weights, adjacency or region of interest
 * have changed, or to compare an update with. On error the forest is as before, or, where even that
 * could not be computed again, it has its seeds and no keys; the words say which. */
enum err forest_rebuild(struct forest *forest, struct fault *fault);

/*
 * While a run goes on, the scene's watch may have it shown (watch.h): forest and scene can then be
 * read, by no more than one thread at a time or by the forest's own team, and are not to be
 * changed. Levels are served from the lowest up, and a voxel that is served has its key and label
 * for good: this says of which voxels that is true. Others have what they had before, or what was
 * offered to them so far, or nothing. Between runs it is true of every voxel that a seed reaches.
 */
bool forest_is_final(const struct forest *forest, uint32_t cell);

/* What the last edit did to seeds: of each of `count` voxels, once, what it has now and had before.
 * Until the next edit. */
struct seed_changes {
    size_t count;
    const struct edit *after, *before;
};
struct seed_changes forest_seed_changes(const struct forest *forest);

/* Since the forest is a function of the set of seeds, many edits need it only after the last: a
 * suspended forest has seeds only, T1, T2 and T4 do not hold, and edits and rebuilds compute
 * nothing, until forest_catch_up computes what they would have led to. On its errors, see
 * forest_rebuild. */
void forest_suspend(struct forest *forest);
bool forest_is_suspended(const struct forest *forest);
enum err forest_catch_up(struct forest *forest, struct fault *fault);

/* 6 or 26 neighbours from now on; forest_rebuild must follow. */
void forest_set_adjacency(struct forest *forest, unsigned count);

/* Arcs weigh by this rule from now on, instead of by ARC_TARGET; forest_rebuild must follow. */
void forest_set_arcs(struct forest *forest, const struct arc_rule *arcs);

/* The team whose threads grow a forest from nothing together; NULL, as at first, is the caller
 * alone. All teams give the same bits. The team outlives the forest. On ERR_MEMORY the former one
 * stays. */
enum err forest_set_team(struct forest *forest, struct team *team, struct fault *fault);

struct changes forest_changes(const struct forest *forest);
struct forest_stats forest_stats(const struct forest *forest);
/* The predecessor of a voxel that a seed reaches: of the neighbours that offer it its key the first
 * one, -z before -y before -x and so on, so that it does not depend on the order of work either
 * (cell.direction does). CELL_NONE for a seed. */
uint32_t forest_predecessor(const struct forest *forest, uint32_t cell);

const struct scene *forest_scene(const struct forest *forest);
const struct adjacency *forest_adjacency(const struct forest *forest);
const struct arc_rule *forest_arcs(const struct forest *forest);
size_t forest_seeds(const struct forest *forest);  /* their number */
size_t forest_memory(const struct forest *forest); /* bytes, without the scene */

/* ---- reaches of seeds ---- */

/* The number by which edits name a reach, for good. ERR_MEMORY, and ERR_LIMIT beyond 65535 of them.
 * The first takes two bytes a cell, as addresses only: memory is taken where roots are. */
enum err forest_add_reach(struct forest *forest, const struct reach *reach, uint16_t *number,
                          struct fault *fault);

/* That of a seed that is planted, NULL for none; and its number, or 0. */
const struct reach *forest_reach(const struct forest *forest, uint32_t seed);
uint16_t forest_reach_number(const struct forest *forest, uint32_t seed);

/* Whether the reach of `root`, a seed, lets its tree hold a voxel. */
bool forest_may_hold(const struct forest *forest, uint32_t root, uint32_t cell);

/* The least key that a neighbour's tree would offer a voxel, were it not for its reach; KEY_NONE
 * for none. */
uint64_t forest_refused_offer(const struct forest *forest, uint32_t cell);

/* How many seeds have one. */
size_t forest_limited_seeds(const struct forest *forest);

/* How many voxels are without a tree because all around them end before: a way leads to them from a
 * seed. A walk through the scene, unless no seed has a reach. ERR_MEMORY, ERR_CANCELLED. */
enum err forest_count_refused(const struct forest *forest, size_t *voxels, struct fault *fault);

/* Sums mod 2^64 over the voxels that a seed reaches: of a mix of (cell, key), and of a mix of cell
 * times label. */
uint64_t forest_digest(const struct forest *forest);
uint64_t forest_label_digest(const struct forest *forest);

/* Checks T1, T2, T3 and T4 at every voxel. False, with words, where one fails. */
bool forest_check(const struct forest *forest, struct fault *fault);

#endif
