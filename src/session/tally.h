/* SPDX-License-Identifier: MIT */
/*
 * The tally: number of voxels of each label, updated from the changes of edits.
 *
 * An edit updates the counts of the voxels whose labels it changed, in no noticeable time for a
 * scene of any size. After a forest grew from nothing, or changed too much for a list, the tally is
 * stale: the first request counts it again, by all threads of the team, and a replay without
 * requests has no cost.
 *
 * Label 0 includes the background and all voxels that no seed reaches. The sum of all labels is the
 * number of voxels.
 *
 * Invariant
 *   Y1 a tally that is not stale equals a recount; tests/small_scene.h asserts it.
 */
#ifndef SESSION_TALLY_H
#define SESSION_TALLY_H

#include <stdbool.h>
#include <stdint.h>

#include "base/buf.h"
#include "base/team.h"
#include "engine/forest.h"
#include "engine/labels.h"
#include "image/geometry.h"

struct tally {
    bool stale;
    uint64_t voxels[256];
    bool knows_moves;                /* the changes of the last edit are known: */
    uint64_t gained[256], lost[256]; /* voxels that each label gained and lost */
};

/* The tally of a forest without seeds. */
struct tally tally_of_none(const struct scene *scene);

/* Invalid if the watch, or NULL, stopped it. */
void tally_follow(struct tally *tally, const struct changes *changes, struct watch *watch);

/* Labels changed, extent unknown: recount. */
void tally_forget(struct tally *tally);

/* Count if stale. False if the scene's watch stopped it: still stale. */
bool tally_refresh(struct tally *tally, const struct labels *labels, struct team *team);

/* Append the volume of `voxels`, "1.24 l", "142 ml", "9.5 mm3" or "800 um3", to three digits,
 * halves rounded up; at most 10 000 l. */
void tally_write_volume(struct buf *out, const struct geometry *geometry, uint64_t voxels);

/* Volume of one voxel in cubic millimetres. */
double tally_voxel_mm3(const struct geometry *geometry);

#endif
