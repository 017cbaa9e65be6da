/* SPDX-License-Identifier: MIT */
/*
 * The forest: each voxel belongs to the tree of the seed with the best path to the voxel.
 *
 * The key of a voxel is (cost, hops, root), one integer with the cost in its highest bits; the
 * least key is the best. A seed has the key (0, 0, itself). A voxel s offers its neighbour t the
 * key
 *
 *     extend(key(s), w) = (w, 0, root)            where w > cost,     w = weight of the arc
 *                         (cost, hops + 1, root)  otherwise           (engine/weight.h)
 *
 * and the forest is the solution of
 *
 *     key(t) = min(offers of the neighbours of t; (0, 0, t) if t is a seed)
 *
 * Since extend(k, w) > k for all k and w, there is exactly one solution: the forest is a function
 * of the set of seeds and does not depend on the order in which they were planted, removed or
 * processed. The cost is the f_max cost of the literature; hops and root break every tie.
 * (Method: Audigier, Lotufo, Falcao 2006; differential transform: Falcao and Bergo 2004; the
 * canonical key is this program's own.)
 *
 * A seed may have a reach, beyond which its tree makes no offers (struct reach in engine/brush.h).
 *
 * An edit changes the set of seeds and updates the solution in time proportional to the change.
 *
 * Terms, and their names in the literature
 *   seed         marker voxel of the image foresting transform; a seed is the root of its tree
 *   eliminator   deletion marker of the differential transform: it clears the tree of its voxel
 *   root         R(t), seed at the start of the path P*(t), the chain of predecessors of t
 *   offer        extend(key(s), w): key of the path to s, extended by the arc to a neighbour
 *   predecessor  P(t), neighbour of t whose offer became the key of t
 *   cost         C(t), the f_max cost of the best path: the largest weight on it
 *   hops         plateau distance: steps along the path since its cost last rose; it corresponds to
 *                the literature's FIFO order within a cost, and (cost, hops) to lexicographic costs
 *   level        (cost, hops), a bucket of the priority queue
 *   cleared      voxels whose tree was removed
 *   frontier     neighbours of cleared voxels that still belong to a tree
 *   region of interest (roi)   voxels outside it belong to no tree
 *   outbox       offers of one worker for cells that another worker owns
 *
 * Invariants between calls
 *   T1 the keys solve the equation above;
 *   T2 label and root of a voxel are those of its predecessor, to which cell.direction points; a
 *      seed is its own root;
 *   T3 the hops of a voxel are below 65535: an edit that would need more is rejected and undone;
 *   T4 both digests equal a recomputation over all voxels.
 *      forest_check checks T1 to T4.
 * Invariant during a pass
 *   T5 every key, except a seed's, is the offer of its predecessor, unless the predecessor is
 *      queued; a voxel that has lost this offer and accepted another of the same level is queued
 *      and marked CELL_RAISED, since a neighbour may offer a better key. So a pass can be stopped
 *      at any moment, and its edit undone by the inverse edit, without a copy of the former state.
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

/* An edit of one voxel: plant a seed, which replaces an existing one, or remove the seed. Seeds are
 * planted only inside the region of interest. */
enum { EDIT_ERASE = -1 };
struct edit {
    uint32_t cell;
    int16_t label;  /* 0..255, or EDIT_ERASE */
    uint16_t reach; /* number of the seed's reach (forest_add_reach); 0 for none */
};

/* Create a forest without seeds for a scene with weights, which must outlive the forest.
 * `adjacency` is 6 or 26. ERR_MEMORY. The caller frees the forest. */
enum err forest_new(struct forest **forest, struct scene *scene, unsigned adjacency,
                    struct fault *fault);
void forest_free(struct forest *forest);

/*
 * Apply `count` edits as one. If a voxel has several edits, the last one counts. Planting an
 * existing seed again, or erasing a voxel without a seed, is allowed and has no effect. The scene's
 * watch is polled after every level of the pass, also while an edit is undone. On an error the
 * forest is unchanged and forest_changes is undefined: ERR_CANCELLED (stopped by the watch),
 * ERR_LIMIT (T3, or 2^32 edits), ERR_MEMORY. One exception: if memory runs out while the edit is
 * undone, the forest is suspended with its former seeds (forest_suspend): ERR_MEMORY.
 */
enum err forest_edit(struct forest *forest, const struct edit *edit, size_t count,
                     struct fault *fault);

/* Recompute the whole forest from its seeds: after a change of weights, adjacency or region of
 * interest, or to compare with an update. On an error the forest has its seeds, but no keys, until
 * a later rebuild. ERR_CANCELLED, ERR_LIMIT, ERR_MEMORY, as of forest_edit. */
enum err forest_rebuild(struct forest *forest, struct fault *fault);

/* The scene's watch may show a run before it ends (watch.h). Forest and scene can then be read, by
 * one thread at a time or by the forest's own team, and must not be changed. Voxels have their
 * final key, their former one, a preliminary one, or none. */

/* The seeds before and after the last edit, one entry for each of its `count` voxels. Valid until
 * the next edit. */
struct seed_changes {
    size_t count;
    const struct edit *after, *before;
};
struct seed_changes forest_seed_changes(const struct forest *forest);

/* Suspend and resume the forest, to compute it only once, after the last of a series of edits. A
 * suspended forest has seeds only: T1, T2 and T4 do not hold, and edits and rebuilds compute
 * nothing. forest_catch_up computes the forest of the present seeds; its errors are those of
 * forest_rebuild. */
void forest_suspend(struct forest *forest);
bool forest_is_suspended(const struct forest *forest);
enum err forest_catch_up(struct forest *forest, struct fault *fault);

/* Set 6 or 26 neighbours; forest_rebuild must follow. */
void forest_set_adjacency(struct forest *forest, unsigned count);

/* Set the rule of arc weights, initially ARC_TARGET; forest_rebuild must follow. */
void forest_set_arcs(struct forest *forest, const struct arc_rule *arcs);

/* Set the team whose threads rebuild the forest in parallel. NULL, the initial value, means the
 * caller's thread only. The result does not depend on the team. The team must outlive the forest.
 * On ERR_MEMORY the former team remains. */
enum err forest_set_team(struct forest *forest, struct team *team, struct fault *fault);

/* Changes by the last edit or rebuild, valid until the next one; and its work. */
struct changes forest_changes(const struct forest *forest);
struct forest_stats forest_stats(const struct forest *forest);

/* Predecessor of a voxel that a seed reaches: the first neighbour, in the order of the adjacency's
 * offsets, whose offer equals the voxel's key. Unlike cell.direction, it does not depend on the
 * order of computation. CELL_NONE for a seed. */
uint32_t forest_predecessor(const struct forest *forest, uint32_t cell);

const struct scene *forest_scene(const struct forest *forest);
const struct adjacency *forest_adjacency(const struct forest *forest);
const struct arc_rule *forest_arcs(const struct forest *forest);
size_t forest_seeds(const struct forest *forest);  /* the number of seeds */
size_t forest_memory(const struct forest *forest); /* bytes, without the scene */

/* ---- reaches of seeds ---- */

/* Add a reach, and set *number to the number for edit.reach. All exact reaches, those of seeds from
 * which no tree grows, share one number. The number remains valid. ERR_MEMORY; ERR_LIMIT for more
 * than 65535 reaches. The first reach reserves two bytes of address space per cell, but memory is
 * used only for pages that contain roots. */
enum err forest_add_reach(struct forest *forest, const struct reach *reach, uint16_t *number,
                          struct fault *fault);

/* True if no tree grows from seeds with a reach of this number. */
bool forest_is_exact(const struct forest *forest, uint16_t reach);

/* Reach of a planted seed (NULL for none), and its number (0 for none). */
const struct reach *forest_reach(const struct forest *forest, uint32_t seed);
uint16_t forest_reach_number(const struct forest *forest, uint32_t seed);

/* True if a voxel is within the reach of the seed `root`, or the seed has no reach. */
bool forest_may_hold(const struct forest *forest, uint32_t root, uint32_t cell);

/* The best offer (least key) that neighbouring trees would make to a voxel if it were not beyond
 * their reach; KEY_NONE if there is no such offer. */
uint64_t forest_refused_offer(const struct forest *forest, uint32_t cell);

/* Number of seeds with a reach. */
size_t forest_limited_seeds(const struct forest *forest);

/* Count the voxels that a path connects to a seed, but that are beyond the reach of all trees
 * around them. Scans the scene if any seed has a reach. ERR_MEMORY, ERR_CANCELLED. */
enum err forest_count_refused(const struct forest *forest, size_t *voxels, struct fault *fault);

/* Digests of keys and labels: sums mod 2^64, over the voxels that a seed reaches, of hash(cell,
 * key) and of hash(cell) * label. */
uint64_t forest_digest(const struct forest *forest);
uint64_t forest_label_digest(const struct forest *forest);

/* Check T1 to T4 at every voxel. Return false with a message if one fails. */
bool forest_check(const struct forest *forest, struct fault *fault);

#endif
