/*
 * Refined layers (render/layers.h): the smooth surfaces that the rays of a tile come through, of
 * each object by itself.
 *
 * A ray is walked from its first cube on. Voxels are solid for a label where they have it or have a
 * face neighbour that does (render/refine.h). From where the ray comes to such a voxel it is
 * followed to where it comes inside of what has the label: that is a layer, unless the ray has left
 * the same label at most LAYERS_GAP and a half voxels before. Where it does not come inside, it is
 * followed again from where that ended, and else once it has been in a voxel that is not solid for
 * the label. In voxels that are no edge (render/seams.h) nothing begins, and where none is near the
 * ray goes on by several voxels at once.
 *
 * In patches, as render/patch.h has them, the rays of the corners and of one in the middle are
 * walked alone: where these have layers of the same labels in the same order, each of them flat,
 * those of the pixels between lie between them.
 */
#ifndef RENDER_LAYERS_REFINE_H
#define RENDER_LAYERS_REFINE_H

#include "render/layers.h"
#include "render/refine.h"

/* Those of the pixels of a footprint within a tile, whose maps of cubes are made. */
void layers_refine(struct rendition *rendition, struct refiner *refiner, struct footprint tile);

#endif
