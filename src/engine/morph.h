/*
 * The morphological gradient of radius 1: the largest less the smallest intensity among a voxel and
 * its neighbours, of which only those inside the scene count.
 */
#ifndef ENGINE_MORPH_H
#define ENGINE_MORPH_H

#include "engine/scene.h"

/* Writes cell.weight of the voxels of a slab, under the scene's watch. Takes no memory. */
void morph_weigh(struct scene *scene, const struct adjacency *adjacency, struct slab slab);

#endif
