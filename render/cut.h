/* SPDX-License-Identifier: MIT */
/*
 * The cut: what of the scene is cut away, so that the inside can be seen.
 *
 * Three means, and a voxel is cut away where any of them says so: slabs leave the voxels between
 * two slices of an axis, planes what lies beyond them, boxes are taken out. All are held in voxels
 * of the scene, so they stay with the patient however the view turns; a voxel is cut whole, by its
 * centre. Labels do not matter: a cut is a function of place alone.
 *
 * Along one row of voxels each means is an interval, so that cutting a scene takes time by its
 * rows; only single voxels are tested one by one.
 *
 * Integers, without padding: two cuts are the same where their bytes are.
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
    int64_t normal[3]; /* along voxel axes, in any unit: into what is left */
    int64_t least;     /* left: normal times (x, y, z) is this or more */
};

struct cut_box {
    uint32_t first[3], last[3]; /* taken out, both ends included; first <= last */
};

struct cut {
    uint32_t first[3], last[3]; /* left, both ends included; 0 and UINT32_MAX along a whole axis */
    uint32_t planes, boxes;
    struct cut_plane plane[CUT_PLANES_MOST];
    struct cut_box box[CUT_BOXES_MOST];
};

/* Nothing is cut away. */
struct cut cut_none(void);
bool cut_is_none(const struct cut *cut);

/* Whether the cell of a voxel is cut away. */
bool cut_takes(const struct cut *cut, const struct grid *grid, uint32_t cell);

/* The plane that leaves the voxels whose centres lie `into` of that of a voxel, or at most `behind`
 * against it: `into` is by how much a step along each voxel axis leads there, in any unit, and
 * `behind` counts in the same. Where components have more than CUT_NORMAL_BITS, the least bits are
 * dropped. */
struct cut_plane cut_plane_at(const int64_t into[3], const uint32_t place[3], int64_t behind);

/* Clears the bits (c % 64 of word c / 64) of all voxels that are cut away, under the scene's watch.
 * False where that has stopped it. */
bool cut_clear(const struct cut *cut, const struct scene *scene, uint64_t *bits);

#endif
