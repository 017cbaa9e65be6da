/* SPDX-License-Identifier: MIT */
/*
 * The tally: how many voxels each label has, kept up to date from what edits change.
 *
 * An edit changes the counts of the voxels that it gave another label, which takes no time worth
 * mentioning in a scene of any size. Where a forest grows from nothing, or so much of it that
 * there is no list, the tally is stale: it is counted again by the first caller who asks, every
 * thread of the team at once, and a replay that never asks never pays.
 *
 * Label 0 has the background and all that no seed reaches. The counts of all labels make the scene.
 *
 * Invariant
 *   Y1 a tally that is not stale equals a recount; tally_check asserts it.
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
    bool knows_moves;                /* there is a list of what the last edit has changed: */
    uint64_t gained[256], lost[256]; /* voxels that came to each label, and went */
};

/* Of a forest without seeds. */
struct tally tally_of_none(const struct scene *scene);

/* Of no use where the watch, or NULL, has stopped it. */
void tally_follow(struct tally *tally, const struct changes *changes, struct watch *watch);

/* Labels are others in a way that no list says. */
void tally_forget(struct tally *tally);

/* Counts where that is needed. False where the scene's watch has stopped it: still stale then. */
bool tally_refresh(struct tally *tally, const struct labels *labels, struct team *team);

bool tally_check(const struct tally *tally, const struct labels *labels);

/* Adds "1.24 l", "142 ml", "9.5 mm3" or "800 um3": what so many voxels take, to three digits,
 * halves rounded up; for more than 10 000 l, 10 000 l. */
void tally_write_volume(struct buf *out, const struct geometry *geometry, uint64_t voxels);

/* What one voxel takes, for reports: cubic millimetres. */
double tally_voxel_mm3(const struct geometry *geometry);

#endif
