/* SPDX-License-Identifier: MIT */
/*
 * The cut: parts of the scene that are cut away to show the inside.
 *
 * A voxel is cut away by any of three means: slabs keep the voxels between two slices of an axis,
 * planes remove the voxels beyond them, boxes remove the voxels inside. All are in voxel
 * coordinates, so they move with the patient when the view turns; a voxel is cut as a whole, by its
 * centre. The cut depends on position alone, not on labels.
 *
 * Along one row of voxels each means is an interval, so cutting a scene costs time per row, not per
 * voxel.
 *
 * Integers without padding: cuts are equal if their bytes are.
 */
#ifndef RENDER_CUT_H
#define RENDER_CUT_H

#include <stdbool.h>
#include <stdint.h>

#include "engine/scene.h"

enum {
    CUT_PLANES_MOST = 8,
    CUT_BOXES_MOST = 8,
    CUT_NORMAL_BITS = 40, /* components are below 2^40, so that sums over voxels fit 64 bits */
};

struct cut_plane {
    int64_t normal[3]; /* along voxel axes, in any unit, towards the voxels that stay */
    int64_t least;     /* voxels stay if normal times (x, y, z) is at least this */
};

struct cut_box {
    uint32_t first[3], last[3]; /* removed, both ends included; first <= last */
};

struct cut {
    uint32_t first[3], last[3]; /* kept, both ends included; 0 and UINT32_MAX for a whole axis */
    uint32_t planes, boxes;
    struct cut_plane plane[CUT_PLANES_MOST];
    struct cut_box box[CUT_BOXES_MOST];
};

/* Nothing is cut away. */
struct cut cut_none(void);
bool cut_is_none(const struct cut *cut);

/* Return true if the voxel of a cell is cut away. */
bool cut_removes(const struct cut *cut, const struct grid *grid, uint32_t cell);

/* Return the plane that keeps the voxels whose centres are ahead of that of `place` in the
 * direction `into`, or at most `behind` behind it. `into` is the progress in that direction of one
 * step along each voxel axis, in any unit, and `behind` is in the same unit. Components of more
 * than CUT_NORMAL_BITS lose their lowest bits. */
struct cut_plane cut_plane_at(const int64_t into[3], const uint32_t place[3], int64_t behind);

/* Clear the bits (c % 64 of word c / 64) of all voxels that are cut away, under the scene's watch.
 * False if the watch has stopped it. */
bool cut_clear(const struct cut *cut, const struct scene *scene, uint64_t *bits);

#endif
