/* SPDX-License-Identifier: MIT */
/*
 * Ambient occlusion: how much of the light that comes from all sides does not reach a surface,
 * because of what is shown around it. Sulci become darker, and what is convex stays as it is.
 *
 * How full the scene is around a point is known of bricks: some 4 smallest spacings long along each
 * axis, which are 4, 2 or 1 voxels. Of each, the shown voxels are counted; counts are smoothed by
 * 1 2 1 along each axis, and what lies between the centres of bricks is interpolated. Occlusion is
 * how full it is at a few points outside of the surface, along its normal, less what a flat surface
 * has there. So it is a pure function of what is shown near the point, and of the normal.
 *
 * Where the border changes, bricks are made anew plane by plane.
 */
#ifndef RENDER_OCCLUSION_H
#define RENDER_OCCLUSION_H

#include "render/border.h"
#include "render/view.h"

enum {
    BRICK_BITS = 2,     /* a brick is 2^2 voxels long, or less along axes of larger spacing */
    BRICK_RIM = 2,      /* bricks before the scene; after it there is one more */
    BRICK_FULL = 65536, /* what there is around a point, where all is shown */
    OCCLUSION_POINTS = 3,
};

struct bricks {
    const struct border *border; /* of which they are as of its version; NULL: of none */
    uint32_t version;
    unsigned bits[3]; /* a brick is 2^bits voxels long along each axis */
    uint32_t size[3]; /* in bricks, with the rim */
    uint8_t *count;   /* [z][y][x]: voxels that are shown */
    uint16_t *full;   /* likewise, smoothed, of 4096 */
    uint16_t *room;   /* for two planes in the making */
    uint8_t *stale;   /* [z]: while they are made */
};

/* A new one is zeroed. */
void bricks_release(struct bricks *bricks);
size_t bricks_bytes(const struct bricks *bricks);

/* Makes them those of the border, which outlives them. ERR_MEMORY: they are of none. */
enum err bricks_take(struct bricks *bricks, const struct border *border, struct fault *fault);

/* How full it is around a point, 0..BRICK_FULL. Points are those of fields (render/field.h), and
 * may lie anywhere. */
uint32_t bricks_around(const struct bricks *bricks, const int32_t point[3]);

/* What pixels of a picture are occluded by. */
struct occluder {
    const struct bricks *bricks; /* borrowed */
    struct locator locator[3];
    int32_t away[OCCLUSION_POINTS][3]; /* of each point, in 1/256 voxels, along a normal of 1 */
    uint32_t percent;                  /* of the occlusion that is seen */
};

void occluder_init(struct occluder *occluder, const struct bricks *bricks,
                   const struct camera *camera, uint32_t percent);

/* What is left of the ambient and the diffuse light, 0..LIGHT_UNIT, on a surface with this normal
 * (render/light.h), at the point that a pixel shows at a depth. */
uint16_t occluder_leaves(const struct occluder *occluder, const int16_t normal[3], int64_t depth,
                         uint32_t x, uint32_t y);

/* It depends on voxels that are at most so many steps away along each axis. */
int occlusion_reach(const struct scene *scene);

#endif
