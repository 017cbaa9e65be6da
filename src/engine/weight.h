/*
 * Arc weights: how dear it is to step into a voxel.
 *
 * The weight of an arc (s, t) is the gradient at t, so it is held once per voxel. All weights are
 * integers 0..65535 and a pure function of the intensities.
 */
#ifndef ENGINE_WEIGHT_H
#define ENGINE_WEIGHT_H

#include "engine/scene.h"

/*
 * The morphological gradient: dilation minus erosion over the voxel and its neighbours (6 or 26),
 * where what lies outside the scene is ignored. Writes cell.weight of every voxel. Forest keys
 * that were made under other weights no longer hold; the caller clears them.
 */
void weight_morph(struct scene *scene, const struct adjacency *adjacency);

/* A digest (sum over voxels) of the weights. */
uint64_t weight_digest(const struct scene *scene);

#endif
