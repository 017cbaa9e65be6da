/* SPDX-License-Identifier: MIT */
/*
 * Normals and light: the direction of the surface at the point of a pixel, and its colour there.
 *
 * A normal is interpolated from the triangle's corners (engine/net.h), and turned to the viewer if
 * it faces away. A closed face, where an object was cut open or the scene ends, is flat.
 *
 * Light is Phong's model, darker with distance. It moves with the viewer.
 *
 * Vectors are along voxel axes; the length of a normal in the world is 2^NORMAL_BITS.
 */
#ifndef RENDER_LIGHT_H
#define RENDER_LIGHT_H

#include "render/projection.h"

enum {
    NORMAL_BITS = NET_NORMAL_BITS, /* 1 of a normal's length */
    TRIANGLES_BITS = 6,
    NORMALISED = TILE * TILE, /* number processed at once */
};

/* Parts along x, y, z of NORMALISED vectors. */
struct gradients {
    int32_t along[3][NORMALISED]; /* above -2^31 */
};
struct directions {
    int16_t along[3][NORMALISED];
};

/* Everything that normals depend on except the pixel. */
struct normals {
    struct drawer drawer;
    int32_t viewer[3];
};
void normals_init(struct normals *normals, const struct camera *camera, const struct mesh *mesh);

/* A cache of triangles, by the hash of their numbers, across the tiles of a picture. */
struct triangles {
    struct seen seen[1 << TRIANGLES_BITS];
};
void triangles_init(struct triangles *triangles);

/* Compute the normals of pixels, and `open`: the face of its voxel that the pixel shows, counted
 * from 1, if it is closed, otherwise 0. */
void normals_of(struct directions *out, uint8_t open[NORMALISED], const struct normals *normals,
                struct triangles *triangles, const struct tile_pixels *pixels);

/* Return the pixels to a voxel, at least 1. */
int64_t normal_stride(const struct camera *camera);

/* ---- gradients to normals ---- */

/* Scale to length 2^NORMAL_BITS; a zero gradient, which has no direction, becomes 0, 0, 0. */
void normalise_all(struct directions *directions, const struct gradients *gradients);

/* The same for one gradient of any size below 2^63; false, with nothing set, if it is 0. */
bool normalise_one(int16_t direction[3], const int64_t gradient[3]);

/* Return 2^45 over the square root of v, for v of 2^28..2^32 - 1, right to 18 bits: a chord of the
 * curve and two Newton steps. */
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
    LIGHT_GLOSSES = 1 << LIGHT_GLOSS_BITS, /* number of tabulated cosines */
};

struct light {
    int32_t toward[3], half[3];
    int64_t front, depth_range; /* front and depth of the scene, in crossings */
    int64_t cue;                /* loss of light at the far end, over (depth_range >> cue_shift) */
    unsigned cue_shift;
    int32_t gloss[LIGHT_GLOSSES + 1]; /* by the cosine to `half`, times LIGHT_UNIT */
};

/* Set the light from `angle`, thousandths of a degree: yaw to the viewer's right, pitch upwards.
 * The far end of the scene is darker by `cue_percent`. */
void light_init(struct light *light, const struct camera *camera, const int32_t angle[2],
                uint32_t cue_percent);

/* Return the part of a colour that remains at a depth, of LIGHT_UNIT. */
int64_t light_cue(const struct light *light, int64_t depth);

/* Many surfaces at once: `colour` is [red, green, blue][which], of surfaces before and of pixels
 * after. `open` is the part of the ambient and diffuse light that arrives, and `cue` the part of
 * the colour that remains at the depth: both 0..LIGHT_UNIT. */
struct lit {
    uint8_t colour[3][NORMALISED];
    uint16_t open[NORMALISED], cue[NORMALISED];
};
void light_surfaces(struct lit *lit, const struct light *light, const struct directions *normals);

#endif
