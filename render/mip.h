/* SPDX-License-Identifier: MIT */
/*
 * The maximum intensity projection: for each pixel, the brightest voxel on its ray.
 *
 * It shows the scene itself behind and around the objects. Brightness is as in slices: 0 at the
 * black end of the window, 255 at the white one. Voxels that are cut away do not count, and objects
 * have no influence, so edits leave it unchanged. It is cached with its parameters: repeating them
 * costs nothing, another view one walk of its rays from block to block of voxels, and from voxel to
 * voxel only in blocks that have a brighter voxel than found before.
 *
 * Dark pixels are translucent: over black a pixel of brightness b is the grey b, and air does not
 * hide any other background.
 */
#ifndef RENDER_MIP_H
#define RENDER_MIP_H

#include "base/team.h"
#include "render/cut.h"
#include "render/view.h"

enum { MIP_BLOCK_BITS = 3, MIP_BLOCK = 1 << MIP_BLOCK_BITS };

/* Its parameters. */
struct mip_source {
    const struct scene *scene;
    uint64_t digest;   /* the scene's (scene_digest) */
    int32_t window[2]; /* the intensities shown as black and white; they differ, in either order */
    struct cut cut;
};

struct mip {
    struct mip_source of; /* scene is NULL if nothing is cached; it may no longer exist */
    size_t bytes;         /* size of the two maps that depend on it alone */
    struct view view;     /* the last map's; width 0 without a map */
    uint8_t *grey;        /* [grid.cells]; 0 in the rim, and where the scene is cut away */
    uint8_t *most;        /* maximum of each block of MIP_BLOCK voxels a side, by x, y, z */
    uint8_t *brightness;  /* [height][width] */
};

/* A new one is zeroed. */
void mip_release(struct mip *mip);
size_t mip_bytes(const struct mip *mip);

/* Compute `brightness` for the camera's scene, by a team and under the scene's watch. ERR_MEMORY,
 * ERR_CANCELLED. */
enum err mip_draw(struct mip *mip, const struct mip_source *source, const struct camera *camera,
                  struct team *team, struct fault *fault);

/* Put the pixels of a picture, [count][4] as in renditions, over the same number of a map. */
void mip_put_behind(uint8_t *out, const uint8_t *rgba, const uint8_t *brightness, size_t count);

#endif
