/* SPDX-License-Identifier: MIT */
/*
 * Normals and light: which way the surface faces at the point that a pixel shows, and the colour
 * that it has there.
 *
 * A normal is the mean of those of the triangle's corners (engine/net.h), turned to the viewer
 * where it faces away. A face that is closed, because it was cut open or the scene ends there, is
 * flat.
 *
 * Light is Phong's model, and darker the further away the surface is. It moves with the viewer.
 *
 * Vectors lie along voxel axes; the length of a normal in the world is 2^NORMAL_BITS.
 */
#ifndef RENDER_LIGHT_H
#define RENDER_LIGHT_H

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

/* ---- light ---- */

enum {
    LIGHT_UNIT_BITS = 15,
    LIGHT_UNIT = 1 << LIGHT_UNIT_BITS, /* 1 of a brightness */
    LIGHT_GLOSS_BITS = 10,
    LIGHT_GLOSSES = 1 << LIGHT_GLOSS_BITS, /* different cosines */
};

struct light {
    int32_t toward[3], half[3];
    int64_t front, depth_range; /* of the scene, in crossings */
    int64_t cue;                /* how much the far end loses, over (depth_range >> cue_shift) */
    unsigned cue_shift;
    int32_t gloss[LIGHT_GLOSSES + 1]; /* by the cosine to `half`, times LIGHT_UNIT */
};

/* From `angle`, thousandths of a degree: yaw to the viewer's right, pitch above him. The far end of
 * the scene is darker by `cue_percent`. */
void light_init(struct light *light, const struct camera *camera, const int32_t angle[2],
                uint32_t cue_percent);

/* What the depth leaves of a colour, of LIGHT_UNIT. */
int64_t light_cue(const struct light *light, int64_t depth);

/* Many surfaces at once: `colour` is [red, green, blue][which], of surfaces and then of pixels.
 * `open` of the ambient and diffuse light comes to each, and the depth leaves `cue` of its colour:
 * both 0..LIGHT_UNIT. */
struct lit {
    uint8_t colour[3][NORMALISED];
    uint16_t open[NORMALISED], cue[NORMALISED];
};
void light_surfaces(struct lit *lit, const struct light *light, const struct directions *normals);

#endif
