/* SPDX-License-Identifier: MIT */
/*
 * Normals: which way the surface faces at the point that a pixel shows.
 *
 * It is the mean of those of the triangle's corners (engine/net.h), turned to the viewer where it
 * faces away. A face that is closed, because it was cut open or the scene ends there, is flat.
 *
 * A normal lies along voxel axes, and its length in the world is 2^NORMAL_BITS.
 */
#ifndef RENDER_NORMAL_H
#define RENDER_NORMAL_H

#include "render/projection.h"

enum {
    NORMAL_BITS = 14, /* 1 of a normal's length */
    TRIANGLES_BITS = 6,
    NORMALISED = TILE * TILE, /* at once */
};

/* Along x, y, z; of each as many as are at once. */
struct gradients {
    int32_t along[3][NORMALISED]; /* above -2^31 */
};
struct directions {
    int16_t along[3][NORMALISED];
};

/* All that normals depend on besides the pixel. */
struct normals {
    const struct camera *camera;
    struct drawer drawer;
    int32_t viewer[3];
};
void normals_init(struct normals *normals, const struct camera *camera, const struct mesh *mesh);

/* Triangles at hand, by what their numbers are mixed to, from one tile of a picture to the next. */
struct triangles {
    struct seen seen[1 << TRIANGLES_BITS];
};
void triangles_init(struct triangles *triangles);

/* Normals of pixels; and `open`: 0, or which face of its voxel the pixel shows where that is
 * closed, counted from 1. */
void normals_of(struct directions *out, uint8_t open[NORMALISED], const struct normals *normals,
                struct triangles *triangles, const struct tile_pixels *pixels);

/* Pixels to a voxel, at least 1. */
int64_t normal_stride(const struct camera *camera);

/* ---- gradients to normals ---- */

/* Of length 2^NORMAL_BITS; 0, 0, 0 where the gradient is, which has no direction. */
void normalise_all(struct directions *directions, const struct gradients *gradients);

/* The same of one gradient, of any size below 2^63; false, and nothing is set, where it is 0. */
bool normalise_one(int16_t direction[3], const int64_t gradient[3]);

/* 2^45 over the square root of v, for v of 2^28..2^32 - 1, right to 18 bits: a chord of the curve
 * and two steps of Newton's. */
static inline int64_t inverse_root(uint64_t v)
{
    const int64_t one = INT64_C(1) << 30;
    const int doubled = v < (UINT64_C(1) << 30);
    const int64_t x = (int64_t)(doubled ? v << 2 : v); /* 1..4, times 2^30 */
    int64_t r = x < 2 * one ? (one * 163 - x * 37) >> 7 : (one * 114 - x * 13) >> 7;
    for (int i = 0; i < 2; i++)
        r = r * (3 * one - (x * (r * r >> 30) >> 30)) >> 31;
    return r << doubled;
}

#endif
