/*
 * The centre of a label: the voxel of it that is nearest to the mean of all of them, so that it
 * lies within even where the mean does not.
 *
 * The mean takes one look at the scene, which is watched; the nearest voxel is sought in shells
 * around it. Distances are in voxels; of those as near it is the first in cell order.
 */
#ifndef ENGINE_CENTRE_H
#define ENGINE_CENTRE_H

#include "engine/scene.h"

/* Of the voxels that a seed reaches. False where the label has none, or the scene's watch has
 * stopped it. */
bool centre_of_label(const struct scene *scene, unsigned label, uint32_t place[3]);

#endif
