/* SPDX-License-Identifier: MIT */
/*
 * The region of interest: the part of the scene in which the forest grows.
 *
 * A voxel is inside where the mask holds it and its intensity lies within the range. One outside is
 * to the forest as a cell of the rim (S2 of engine/scene.h): it takes no tree, lets none through,
 * and is background. Weights do not depend on it: they are a function of all intensities.
 *
 * Invariant: between calls of the session, a voxel has CELL_OUTSIDE exactly where it is outside the
 * region of interest that was applied last; no seed is.
 */
#ifndef ENGINE_ROI_H
#define ENGINE_ROI_H

#include "engine/scene.h"

struct roi {
    const uint64_t *mask; /* bit c % 64 of word c / 64: it holds cell c; NULL: every voxel */
    uint16_t low, high;   /* the range, both ends included; 0 and 65535 where there is none */
};

/* Nothing is outside. */
static inline struct roi roi_none(void)
{
    return (struct roi){NULL, 0, UINT16_MAX};
}

static inline bool roi_is_none(const struct roi *roi)
{
    return !roi->mask && roi->low == 0 && roi->high == UINT16_MAX;
}

static inline bool roi_holds(const struct roi *roi, const struct scene *scene, uint32_t cell)
{
    const uint16_t intensity = scene->cell[cell].intensity;
    return intensity >= roi->low && intensity <= roi->high &&
           (!roi->mask || roi->mask[cell >> 6] >> (cell & 63) & 1);
}

/* Of a mask; where they are 0, it holds nothing. */
size_t mask_bytes(const struct grid *grid);

/* What it would do to a scene, whatever region of interest the scene has now. Of no use where the
 * scene's watch has stopped it. */
struct roi_tally {
    size_t inside;        /* voxels */
    size_t seeds_outside; /* of those planted */
    uint64_t digest;      /* a sum mod 2^64 over the voxels outside; 0 where there are none */
};
struct roi_tally roi_tally(const struct roi *roi, const struct scene *scene);

/* Applies it in place of the former one; every seed is inside. forest_rebuild must follow where
 * there are seeds. Where the scene's watch has stopped it, a part of the scene has the former
 * one. */
void roi_apply(const struct roi *roi, struct scene *scene);

#endif
