/* SPDX-License-Identifier: MIT */
/*
 * Pairs: how many pairs of voxels have the same label, for each way in which one may lie from the
 * other. The area of a surface is estimated from them (show/label_area.h): a pair of which one
 * voxel alone has the label has the surface between its two.
 *
 * Two voxels make a pair where they are at most two steps apart along each axis. A step is one
 * voxel along the axis with the widest spacing, and as many as are about as long along the others,
 * STEP_MOST at most: so pairs lead about as far in all directions. The kind of a pair is how many
 * steps it is long along each axis, |x| + 3 |y| + 9 |z|; pairs of kind 0 are single voxels. No pair
 * leads out of the scene, so the edge of the scene is a surface too.
 *
 * Counts are kept up to date: an edit notes what it changes (engine/changes.h), and
 * label_pairs_refresh follows, with 124 looks around each voxel that has another label, and one
 * byte a voxel for the label that it was last seen with. All are integers, and the same for any
 * number of threads. Label 0 has no surface and is not counted.
 *
 * Invariant
 *   P1 after label_pairs_refresh the counts equal a recount (test_tally).
 */
#ifndef ENGINE_LABEL_PAIRS_H
#define ENGINE_LABEL_PAIRS_H

#include "base/team.h"
#include "engine/changes.h"
#include "engine/labels.h"

enum { PAIR_KINDS = 27, STEP_MOST = 8 };

/* The voxels of one step along each axis. */
void label_pairs_step(uint32_t step[3], const uint32_t spacing_nm[3]);

struct label_pairs;

/* Of a scene, which outlives it, so far of nothing. ERR_MEMORY. */
enum err label_pairs_new(struct label_pairs **pairs, const struct scene *scene,
                         struct fault *fault);
void label_pairs_free(struct label_pairs *pairs);

/* An edit of the forest has changed labels; to NULL nothing happens. */
void label_pairs_follow(struct label_pairs *pairs, const struct changes *changes);
/* The labels of the forest are others in a way that nobody says. */
void label_pairs_forget(struct label_pairs *pairs);

/* Counts what is not counted yet of these labels, which are always the forest's, or, the one time
 * that this is called, any. ERR_MEMORY, or ERR_CANCELLED by the scene's watch; all is counted the
 * next time then. */
enum err label_pairs_refresh(struct label_pairs *pairs, const struct labels *labels,
                             struct team *team, struct fault *fault);

/* As of the last refresh. */
const uint64_t *label_pairs_of(const struct label_pairs *pairs, unsigned label); /* [PAIR_KINDS] */
const uint8_t *label_pairs_labels(const struct label_pairs *pairs); /* [cells], 0 in the rim */

size_t label_pairs_memory(const struct label_pairs *pairs); /* bytes; of NULL too */

#endif
