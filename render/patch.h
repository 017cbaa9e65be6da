/*
 * Patches: squares of pixels of which only the corners, and one in the middle, are refined.
 *
 * Where a voxel is many pixels wide, or many samples, the surface is all but flat between pixels
 * side by side (render/field.h: what is shown is smoothed over voxels). So from look 3 on, a tile
 * whose corners and middle lie on one smooth surface takes depth and normal of the others from
 * them, as one of their own points between them; where they do not agree, its quarters are tried,
 * and then each pixel is refined by itself. Voxels, and so labels, are of each pixel's own point in
 * any case.
 *
 * A patch is no wider than a voxel, nothing may lie in front of it, and it has no silhouette. It
 * lies within a tile, and follows from the tile's maps of cubes: what is seen stays a pure function
 * of these.
 */
#ifndef RENDER_PATCH_H
#define RENDER_PATCH_H

#include "render/normal.h"
#include "render/refine.h"

/* The pixels of a tile: bit y * TILE + x. */
typedef uint64_t tile_mask;

/* Refines the pixels of the whole tile at this place, and gives back those that have their normal
 * too. The maps of cubes are made. */
tile_mask patches_refine(struct rendition *rendition, struct refiner *refiner,
                         struct normals *normals, uint32_t left, uint32_t top);

#endif
