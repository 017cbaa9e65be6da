/* SPDX-License-Identifier: MIT */
/*
 * Measures of what the labels make: how far a voxel is from the border of its object, and where the
 * centre of a label is.
 *
 * An object is all voxels of one label, label 0 too; the border here is that of the object,
 * whatever is shown or cut away: those of its voxels with a face neighbour of another label, or at
 * the edge of the scene, which counts as label 0. So a voxel on the border is 0 away. Distances are
 * between centres.
 *
 * The centre of a label is the voxel of it that is nearest to the mean of all of them, in voxels,
 * so that it lies within even where the mean does not. The mean takes one look at the scene.
 *
 * Both searches go outward in shells, and end where no voxel further off can be nearer; of voxels
 * as near, the first in cell order is found. That takes time by the distance, and is watched.
 */
#ifndef ENGINE_MEASURE_H
#define ENGINE_MEASURE_H

#include "engine/scene.h"

enum {
    MEASURE_STEPS = 100,         /* the search goes no more voxels than that along an axis, */
    MEASURE_REACH_NM = 100000000 /* and no further; so that squares fit 64 bits */
};

struct border_distance {
    bool found;        /* else the border is further than reach_nm, or there is none */
    uint32_t cell;     /* of the nearest border voxel */
    uint64_t squared;  /* nm^2 */
    uint64_t reach_nm; /* how far everything was searched */
};

/* From the cell of a voxel. Of no use where the scene's watch has stopped it. */
struct border_distance measure_border_distance(const struct scene *scene, uint32_t cell);

/* Of the voxels that a seed reaches. False where the label has none, or the scene's watch has
 * stopped it. */
bool centre_of_label(const struct scene *scene, unsigned label, uint32_t place[3]);

#endif
