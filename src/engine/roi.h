/* SPDX-License-Identifier: MIT */
/*
 * The region of interest: the part of the scene in which the forest grows.
 *
 * A voxel is inside if the mask contains it and its intensity in one channel is within the range,
 * whichever channel is shown. The forest treats a voxel outside like a cell of the rim (S2 of
 * engine/scene.h): it belongs to no tree, no tree passes it, and it is background. Weights do not
 * depend on the region: they are a function of all intensities.
 *
 * Invariant: between calls of the session, a voxel has CELL_OUTSIDE exactly if it is outside the
 * region of interest that was applied last; no seed is outside.
 */
#ifndef ENGINE_ROI_H
#define ENGINE_ROI_H

#include "engine/scene.h"

struct roi {
    const uint64_t *mask; /* bit c % 64 of word c / 64 for cell c; NULL: every voxel */
    uint16_t low, high;   /* the range, both ends included; 0 and 65535 for no range */
    unsigned channel;     /* its channel, 0 for the first (engine/scene.h) */
};

/* The region that contains every voxel. */
static inline struct roi roi_none(void)
{
    return (struct roi){.high = UINT16_MAX};
}

static inline bool roi_is_none(const struct roi *roi)
{
    return !roi->mask && roi->low == 0 && roi->high == UINT16_MAX;
}

static inline bool roi_holds(const struct roi *roi, const struct scene *scene, uint32_t cell)
{
    const uint16_t intensity = scene_intensity(scene, roi->channel, cell);
    return intensity >= roi->low && intensity <= roi->high &&
           (!roi->mask || roi->mask[cell >> 6] >> (cell & 63) & 1);
}

/* Size of a mask in bytes; zeros are an empty mask. */
size_t mask_bytes(const struct grid *grid);

/* Effect of a region on a scene, independent of the scene's current region. Undefined if the
 * scene's watch has stopped it. */
struct roi_tally {
    size_t inside;        /* voxels */
    size_t seeds_outside; /* planted seeds outside */
    uint64_t digest;      /* sum mod 2^64 over the voxels outside; 0 for none */
};
struct roi_tally roi_tally(const struct roi *roi, const struct scene *scene);

/* Apply a region in place of the former one; every seed must be inside. forest_rebuild must follow
 * if there are seeds. If the scene's watch stops it, a part of the scene keeps the former
 * region. */
void roi_apply(const struct roi *roi, struct scene *scene);

#endif
