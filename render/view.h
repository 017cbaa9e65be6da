/* SPDX-License-Identifier: MIT */
/*
 * The view: the direction from which a scene is seen, and the exact arithmetic of its rays.
 *
 * Angles. (0, 0, 0) is the front: the patient faces the viewer, with the left side on the right.
 * Yaw moves the viewer around the patient towards the left side, pitch upwards, and roll turns the
 * picture counter-clockwise.
 *
 * The focus is the place of the scene in the centre of the picture, whatever the angles, the zoom
 * and the size: views rotate about it. It is stored in the scene, not in the picture, so that it is
 * independent of the others. Initially it is the scene's middle.
 *
 * Rays. Projection is orthogonal. The ray of pixel (px, py) crosses the plane n of axis a at
 *
 *     t_a(n) = n * T_a + px * A_a + py * B_a + C_a
 *
 * integers, constant for a view, in units of 2^-24 pixels along the view direction; t = 0 is in the
 * plane of the scene's middle, whatever the focus. Axes are flipped so that T_a > 0, and a
 * direction cosine near zero is replaced by a tiny one. Two crossings are compared as (t, axis),
 * which resolves every tie as the same infinitesimal shift of the ray would: hence the value stored
 * is 4 * t + axis, and crossings of different axes are never equal. A voxel is a cube; a ray is
 * inside it if the last of its three near crossings precedes the first of its three far crossings.
 * The depth of a pixel is that last near crossing, including the axis bits.
 *
 * No floating point: sines are computed by integer CORDIC, so a view is the same on every machine.
 */
#ifndef RENDER_VIEW_H
#define RENDER_VIEW_H

#include <stdbool.h>
#include <stdint.h>

#include "base/err.h"
#include "engine/scene.h"

enum {
    VIEW_SIDE_MOST = 8192,
    VIEW_TURN = 360000,   /* a full turn in thousandths of a degree */
    VIEW_ZOOM_ONE = 1000, /* zoom is in thousandths: pixels per smallest voxel spacing */
    VIEW_ZOOM_LEAST = 10,
    VIEW_ZOOM_MOST = 64000,
    VIEW_FOCUS_BITS = 16,     /* fraction bits of a voxel; a pixel is at least a 256th of one */
    CROSSING_PIXEL_BITS = 26, /* fraction bits of a depth: 4 * 2^24 to a pixel */
};

struct view {
    int32_t angle[3];       /* yaw, pitch, roll, thousandths of a degree, 0..359999 */
    uint32_t zoom;          /* VIEW_ZOOM_LEAST..VIEW_ZOOM_MOST */
    uint32_t width, height; /* pixels, 1..VIEW_SIDE_MOST */
    int64_t focus[3];       /* from the scene's middle, along voxel axes, in 2^-16 voxels */
};

/* 512x512 from the front, at zoom 1, or less if the scene would not fit. */
struct view view_default(const struct scene *scene);
/* Return the largest zoom at which the scene fits the picture in any orientation, and a camera for
 * samples x samples a pixel exists. */
uint32_t view_fitting_zoom(const struct scene *scene, uint32_t width, uint32_t height,
                           uint32_t samples);

/* The same for an object of a given diameter, in pixels at a zoom of 1, squared; and the squared
 * diagonal of a box of `size` voxels. */
uint32_t view_zoom_across(const struct scene *scene, uint32_t width, uint32_t height,
                          uint32_t samples, uint64_t squares);
uint64_t view_squares(const uint64_t side[3], const uint32_t size[3]);
void view_sides(uint64_t side[3], const struct scene *scene); /* its sides of a voxel */

/* Return the largest zoom up to `wanted` at which a view of that place has a camera for samples x
 * samples a pixel. */
uint32_t view_possible_zoom(const struct scene *scene, const struct view *view,
                            const uint32_t place[3], uint32_t samples, uint64_t wanted);

/* Return the length of one pixel at zoom 1, in nanometres: the smallest spacing. */
uint32_t view_unit(const struct scene *scene);

/* Look up one of the six named views. False for any other name. */
#define VIEW_NAMES "front|back|left|right|top|bottom"
bool view_by_name(const char *name, int32_t angle[3]);
/* Return the name of these angles, or NULL. */
const char *view_name(const int32_t angle[3]);

/* Return the picture's unit vectors in the patient (Right, Anterior, Superior), times 2^30: to the
 * right of the picture, up, and away from the viewer. */
void view_look(const struct view *view, int32_t right[3], int32_t up[3], int32_t ahead[3]);

/* The same along a scene's voxel axes. */
void view_axes(const struct view *view, const struct scene *scene, int32_t right[3], int32_t up[3],
               int32_t ahead[3]);

/* Return the sine of `angle` thousandths of a degree, times 2^30; exact at quarter turns. */
int32_t view_sine(int32_t angle);

/*
 * A view compiled for one scene. "Flipped" coordinates count the voxels of an axis from the other
 * side if flip[a] is set, so that every ray runs towards larger numbers.
 */
struct camera {
    const struct scene *scene;
    struct view view;
    bool flip[3];
    int64_t T[3], A[3], B[3], C[3]; /* as above, each times 4; C holds the axis bits */
    /* The centre of the cube at flipped (n0, n1, n2) is at pixel column (centre[0] + sum of n_a *
     * column[0][a]) / 2^30, and at the row likewise; it covers no pixel further away than reach[0],
     * reach[1], likewise. Its depth is the third, from the plane of the scene's middle. */
    int64_t centre[3], column[3][3], reach[2];
    int32_t right[3], up[3], ahead[3]; /* unit vectors in voxel axes (not flipped), times 2^30 */
    int64_t unit_nm;                   /* length of one pixel at zoom 1 */
};

/* ERR_LIMIT if scene, zoom and picture together are too large for 64-bit crossings, or the focus is
 * further from the scene's middle than the scene is long. */
enum err camera_init(struct camera *camera, const struct scene *scene, const struct view *view,
                     struct fault *fault);

/* Return the camera of `height` rows from row `top` on: the same rays, bit for bit. */
struct camera camera_rows(const struct camera *camera, uint32_t top, uint32_t height);

/* Focus on a voxel; and pan, moving the picture to the right and down by thousandths of pixels, up
 * to 1000 times VIEW_SIDE_MOST each way. */
void view_focus_on(struct view *view, const struct scene *scene, const uint32_t place[3]);
void view_pan(struct view *view, const struct camera *camera, int64_t right, int64_t down);

static inline int64_t camera_crossing(const struct camera *camera, int a, int64_t n, int64_t px,
                                      int64_t py)
{
    return n * camera->T[a] + px * camera->A[a] + py * camera->B[a] + camera->C[a];
}

/* a * b / 2^30, rounded to nearest. */
static inline int64_t times30(int64_t a, int64_t b)
{
    return (a * b + (INT64_C(1) << 29)) >> 30;
}

/* Right shifts of negative numbers round down, as gcc and clang define them. */
_Static_assert((INT64_C(-3) >> 1) == -2, "right shifts must be arithmetic");

/* ---- points on rays ---- */

/* The locator: the position along one axis of the scene of the point that a pixel shows at a depth.
 * (depth - crossing of plane 0) / T, as a product. T is reduced to 20 bits first, so the relative
 * error is some 2^-20: less than the last bit of the result. */
enum {
    LOCATOR_POINT_BITS = 8, /* fraction bits of a voxel */
    LOCATOR_BITS = 20,
    LOCATOR_INVERSE_BITS = 44,
};

struct locator {
    int64_t C, A, B;
    unsigned shift;
    int64_t inverse; /* 2^44 / (T >> shift) */
    int32_t most;    /* the far side of the scene */
    bool flip;
};

static inline struct locator locator_of(const struct camera *camera, int a)
{
    struct locator l = {camera->C[a], camera->A[a], camera->B[a], 0, 0, 0, camera->flip[a]};
    while (camera->T[a] >> l.shift >> (LOCATOR_BITS + 1))
        l.shift++;
    l.inverse = (INT64_C(1) << LOCATOR_INVERSE_BITS) / (camera->T[a] >> l.shift);
    l.most = (int32_t)(camera->scene->grid.size[a] << LOCATOR_POINT_BITS);
    return l;
}

/* Return 1/256 voxels from the centre of voxel 0, along the scene's axis; on or in the scene. */
static inline int32_t locator_point(const struct locator *l, int64_t depth, uint32_t x, uint32_t y)
{
    const int64_t beyond = depth - (l->C + x * l->A + y * l->B);
    const int64_t flipped =
        (beyond >> l->shift) * l->inverse >> (LOCATOR_INVERSE_BITS - LOCATOR_POINT_BITS);
    const int32_t at = flipped < 0 ? 0 : flipped > l->most ? l->most : (int32_t)flipped;
    return (l->flip ? l->most - at : at) - (1 << (LOCATOR_POINT_BITS - 1));
}

#endif
