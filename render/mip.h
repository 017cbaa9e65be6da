/* SPDX-License-Identifier: MIT */
/*
 * The maximum intensity projection: of each pixel, the brightest voxel that its ray goes through.
 *
 * It shows the scene itself behind and around the objects. Brightness is that of slices: 0 at the
 * black end of the window, 255 at the white one. What is cut away is left out; what objects there
 * are is of no consequence, so an edit leaves it as it is. It is stored with what it was made of:
 * the same again takes no time, another view one walk of its rays from block to block of voxels,
 * and from voxel to voxel in blocks alone that have a brighter one than was met before.
 *
 * What is dark shines through: over black a pixel of brightness b is the grey b, and over any
 * other background air does not hide that.
 */
#ifndef RENDER_MIP_H
#define RENDER_MIP_H

#include "base/team.h"
#include "render/cut.h"
#include "render/view.h"

enum { MIP_BLOCK_BITS = 3, MIP_BLOCK = 1 << MIP_BLOCK_BITS };

/* What it shows. */
struct mip_source {
    const struct scene *scene;
    uint64_t digest;   /* the scene's (scene_digest) */
    int32_t window[2]; /* the intensities that are black and white; they differ, and either may be
                          the greater */
    struct cut cut;
};

struct mip {
    struct mip_source of; /* scene is NULL where nothing is stored; it may have gone since */
    size_t bytes;         /* of the two maps that follow from it alone */
    struct view view;     /* of the map; of width 0 where there is none */
    uint8_t *grey;        /* [grid.cells]; 0 in the rim, and where the scene is cut away */
    uint8_t *most;        /* of each block of MIP_BLOCK voxels a side, by x, y, z: its greatest */
    uint8_t *brightness;  /* [height][width] */
};

/* A new one is zeroed. */
void mip_release(struct mip *mip);
size_t mip_bytes(const struct mip *mip);

/* Makes `brightness` that of a source, whose scene the camera looks at, by a team and under the
 * scene's watch. ERR_MEMORY, ERR_CANCELLED. */
enum err mip_draw(struct mip *mip, const struct mip_source *source, const struct camera *camera,
                  struct team *team, struct fault *fault);

/* The pixels of a picture, [count][4] as those of renditions are, over as many of a map. */
void mip_put_behind(uint8_t *out, const uint8_t *rgba, const uint8_t *brightness, size_t count);

#endif
