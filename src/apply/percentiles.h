/* SPDX-License-Identifier: MIT */
/*
 * Between which intensities most voxels of each label lie: percentiles 10 and 90, as real values.
 * By those the grey of an object in one scene is matched with that in another.
 */
#ifndef APPLY_PERCENTILES_H
#define APPLY_PERCENTILES_H

#include "base/err.h"
#include "session/session.h"

struct percentiles {
    uint64_t voxels[256];
    double low[256], high[256]; /* 0 for a label without voxels */
};

/* Of label[z][y][x], 0..255; other numbers count for nothing. ERR_MEMORY: it takes 256 kB for each
 * label. */
enum err percentiles_find(struct percentiles *out, const struct session *session,
                          const uint16_t *label, struct fault *fault);

/* The real value of the intensity at a voxel. */
double percentiles_value(const struct session *session, uint32_t cell);

#endif
