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
 * From look 4 on, squares of several tiles are tried first, patches side by side in a block share
 * corners, and the middle is not refined, but the field looked at there. Where a patch shows one
 * object, a sample in the middle of each pixel of the reduced picture stands for all of them. A
 * patch that is one pixel may be more curved and folded, since only its mean is seen.
 *
 * A patch is no wider than a voxel, nothing may lie in front of it, and it has no silhouette. It
 * lies within a block, and follows from the block's maps of cubes: what is seen stays a pure
 * function of these.
 */
#ifndef RENDER_PATCH_H
#define RENDER_PATCH_H

#include "render/normal.h"
#include "render/refine.h"

enum {
    PATCH_TILES = 4, /* of a block, along each side, at most */
    PATCH_SIDE = PATCH_TILES * TILE,
};

/* What is known of a tile's samples. */
struct patched {
    tile_mask is_refined; /* depth and voxel are made, or another one stands for it; */
    tile_mask has_normal; /* the normal is, too */
    tile_mask stands;     /* and the label: it stands for its pixel, of which the others are not */
};

/* A block of tiles. */
struct patches {
    struct rendition *r;
    struct refiner *refiner;
    struct normals *normals;
    uint32_t left, top, side; /* of the block, in pixels; PATCH_SIDE at most */
    uint32_t samples; /* a pixel of the reduced picture has samples x samples, of which one may
                         stand for all; 1 where none does */
    bool
        has_lattice; /* patches side by side in a block share corners, and lie on the ground of pits
                         too: from look 4 on */
    struct patched tile[PATCH_TILES][PATCH_TILES]; /* [y][x]; nothing is known at first */
};

/* Refines a square of 2 or 4 tiles a side within a block, from pixel x, y of it on, as one patch.
 * True where one sample stands for each of its pixels then; else they are still to be refined. The
 * maps of cubes are made. */
bool patches_refine_square(struct patches *patches, uint32_t x, uint32_t y, uint32_t side);

/* Refines all pixels of a tile, but those that others stand for. */
void patches_refine_tile(struct patches *patches, uint32_t x, uint32_t y);

/* The samples of all pixels that one of these stands for. */
tile_mask patches_covered(tile_mask stands, uint32_t samples);

/* Of four depths, at the left and right corner above, then below, of a square of pixels: what lies
 * at one of them between. */
int64_t patch_between(const int64_t corner[4], uint32_t side, uint32_t x, uint32_t y);

#endif
