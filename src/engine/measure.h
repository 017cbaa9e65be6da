/* SPDX-License-Identifier: MIT */
/*
 * Measures of labels: the distance of a voxel to the border of its object, and the centre of a
 * label.
 *
 * An object is the set of all voxels of one label, label 0 too. Its border, independent of display
 * and cuts, are the voxels with a face neighbour of another label, where the outside of the scene
 * has label 0. So a voxel on the border has distance 0. Distances are between centres.
 *
 * The centre of a label is its voxel nearest to the mean of all its voxels, rounded down, in voxel
 * units, so that it is inside the label even if the mean is not. The mean needs one scan of the
 * scene.
 *
 * Both searches visit shells of growing size, and end when no voxel further out can be nearer; ties
 * are decided by the order of cells. The time depends on the distance, and is watched.
 */
#ifndef ENGINE_MEASURE_H
#define ENGINE_MEASURE_H

#include "engine/scene.h"

enum {
    MEASURE_STEPS = 100,         /* limit of the search along an axis in voxels, */
    MEASURE_REACH_NM = 100000000 /* and in nm; so that squares fit 64 bits */
};

struct border_distance {
    bool found;        /* false if the border is further than reach_nm, or does not exist */
    uint32_t cell;     /* the nearest border voxel */
    uint64_t squared;  /* nm^2 */
    uint64_t reach_nm; /* distance up to which the search is complete; UINT64_MAX: everywhere */
};

/* Distance from the cell of a voxel. Undefined if the scene's watch has stopped it. */
struct border_distance measure_border_distance(const struct scene *scene, uint32_t cell);

/* Centre of a label among the voxels that a seed reaches. False if it has none, or the scene's
 * watch has stopped it. */
bool centre_of_label(const struct scene *scene, unsigned label, uint32_t place[3]);

#endif
