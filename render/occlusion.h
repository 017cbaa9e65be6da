/* SPDX-License-Identifier: MIT */
/*
 * Ambient occlusion: the part of the light from all sides that does not reach a surface because of
 * what surrounds it. Sulci become darker, convex surfaces are unchanged.
 *
 * The fullness of the scene around a point is computed from bricks: some 4 smallest spacings along
 * each axis, which are 4, 2 or 1 voxels. The shown voxels of each are counted, smoothed by 1 2 1
 * along each axis, and interpolated between the centres of bricks. Occlusion is the fullness at a
 * few points outside the surface, along its normal, minus that at a flat surface. So it is a pure
 * function of the voxels shown nearby and of the normal.
 *
 * When the border changes, bricks are recomputed plane by plane.
 */
#ifndef RENDER_OCCLUSION_H
#define RENDER_OCCLUSION_H

#include "render/border.h"
#include "render/view.h"

enum {
    BRICK_BITS = 2,     /* a brick is 2^2 voxels long, or less along axes of larger spacing */
    BRICK_RIM = 2,      /* bricks before the scene; after it there is one more */
    BRICK_FULL = 65536, /* fullness where all is shown */
    OCCLUSION_POINTS = 3,
};

struct bricks {
    const struct border *border; /* the border they were computed from, at `version`; NULL: not
                                    computed */
    uint32_t version;
    unsigned bits[3]; /* a brick is 2^bits voxels long along each axis */
    uint32_t size[3]; /* in bricks, with the rim */
    uint8_t *count;   /* [z][y][x]: number of shown voxels */
    uint16_t *full;   /* likewise, smoothed, of 4096 */
    uint16_t *room;   /* scratch memory for two planes */
    uint8_t *stale;   /* [z]: used while they are computed */
};

/* A new one is zeroed. */
void bricks_release(struct bricks *bricks);
size_t bricks_bytes(const struct bricks *bricks);

/* Bring them up to date with a border, which must outlive them. ERR_MEMORY: they are not computed.
 * */
enum err bricks_update(struct bricks *bricks, const struct border *border, struct fault *fault);

/* Return the fullness around a point, 0..BRICK_FULL, given in 1/256 voxels from the centre of voxel
 * 0, as locator_point returns it; it may be anywhere. */
uint32_t bricks_around(const struct bricks *bricks, const int32_t point[3]);

/* The occlusion of the pixels of a picture. */
struct occluder {
    const struct bricks *bricks; /* borrowed */
    struct locator locator[3];
    int32_t away[OCCLUSION_POINTS]
                [3];  /* distance of each point, in 1/256 voxels, for a normal of 1 */
    uint32_t percent; /* strength of the occlusion */
};

void occluder_init(struct occluder *occluder, const struct bricks *bricks,
                   const struct camera *camera, uint32_t percent);

/* Return the part of the ambient and diffuse light, 0..LIGHT_UNIT, that reaches a surface with this
 * normal (render/light.h) at the point that a pixel shows at a depth. */
uint16_t occluder_light(const struct occluder *occluder, const int16_t normal[3], int64_t depth,
                        uint32_t x, uint32_t y);

/* Return the number of steps along each axis within which voxels influence the occlusion of a
 * point. */
int occlusion_reach(const struct scene *scene);

#endif
