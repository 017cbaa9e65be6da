/*
 * Normals: which way the surface faces at the point that a pixel shows.
 *
 * Its normal comes from one of
 *
 *   surface   the smoothed field of shown voxels (render/field.h): the direction in which it falls.
 *             Look 1 reads it on the surface; look 2 before it, where thin sheets have a slope too,
 *             and turns what would face away to the viewer
 *   scene     the gradient of the scene's intensities, turned outward by the surface's normal,
 *             which is used where the scene is flat
 *   depth     the plane that fits the depths around the pixel best
 *   cubes     as surface; what is seen are the faces of voxels, as all of look 1 has them
 *
 * The first and the last go by all that is shown, or by the pixel's object alone: then there is a
 * crease where two objects touch.
 *
 * A normal lies along voxel axes, and its length in the world is 2^NORMAL_BITS.
 */
#ifndef RENDER_NORMAL_H
#define RENDER_NORMAL_H

#include "render/field.h"
#include "render/look.h"
#include "render/rendition.h"

enum {
    NORMAL_BITS = 14, /* 1 of a normal's length */
    NORMALISED = 64,  /* at once: the pixels of a tile */
};

/* Along x, y, z; of each as many as are at once. */
struct gradients {
    int32_t along[3][NORMALISED]; /* above -2^31 */
};
struct directions {
    int16_t along[3][NORMALISED];
};

enum {
    NORMAL_FIT_STEPS = 3,           /* voxels each way to which a plane is fitted */
    NORMAL_REACH = FIELD_REACH + 1, /* as FIELD_REACH, where the field is read before the surface */
};

/* All that normals depend on besides the pixel. */
struct normals {
    const struct camera *camera;
    enum shade_mode mode;
    bool creases;   /* each object has normals of its own, as if it touched no other */
    bool looks_out; /* slopes of the field are read before the surface, as look 2 has them */
    struct locator locator[3];
    int32_t viewer[3];
    int16_t before[3]; /* the viewer's side, of length 2^NORMAL_BITS in voxels */
    int32_t scale[3];  /* unit / spacing times 2^12: gradients per voxel to gradients per length */
    int64_t stride;    /* pixels between the depths that a plane is fitted to: a voxel's */
    struct field_reader shown, scene;
};

/* `shown`, and in mode `scene` both, are fields of what the camera looks at, and outlive this; a
 * mode that has no use for one takes NULL. */
void normals_init(struct normals *normals, const struct camera *camera, enum shade_mode mode,
                  bool looks_out, struct field *shown, struct field *scene);

/* Pixels of a tile that show something. */
struct tile_pixels {
    unsigned count;
    uint32_t x[NORMALISED], y[NORMALISED];
};

/* Their normals. */
void normals_of(struct directions *out, struct normals *normals, const struct rendition *rendition,
                const struct tile_pixels *pixels);

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
