/* SPDX-License-Identifier: MIT */
/*
 * Surfaces that enclose the voxels of each label, as triangles: the nets that pictures show
 * (engine/net.h), joined from boxes. Integers only.
 *
 * The surface of a single label is its net, point by point. With several labels, each has the quads
 * of its own net, so that it is closed by itself, and the surfaces fit: points next to air have the
 * positions of the net of all labels together, as in pictures of opaque objects; walls between
 * labels have the means of the positions in their own nets. Voxels outside the scene have label 0,
 * which has no surface.
 *
 * In a net, four quads may share an edge, and two sheets a vertex, if voxels touch at an edge or a
 * corner. Here such edges and vertices are split, so voxels of a label that share no face may be
 * separate although a picture joins them; the points of a split vertex have the same position.
 *
 * Promises
 *   U1 closed: each edge of a surface has exactly two triangles, in opposite directions, and the
 *      triangles around a point are one fan, also where a label touches itself or another at an
 *      edge or a corner;
 *   U2 a surface has the points of the net, independent of the boxes it is made from;
 *   U3 until it is reduced, no point is further than 1/4 voxel outside its cube of voxels; a
 *      surface that meets no other encloses the volume of its voxels, to 2 % for a ball with a
 *      radius of 3 voxels or more;
 *   U4 normals point out of the label;
 *   U5 the same labels make the same triangles in the same order, on every machine;
 *   U6 where two labels touch, their surfaces have points at the same positions, until they are
 *      reduced.
 * tests/surface_check.h asserts U1. No two points of a surface have the same position in files
 * (image/surface_file.h).
 */
#ifndef ENGINE_SURFACE_H
#define ENGINE_SURFACE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/err.h"
#include "base/watch.h"
#include "engine/net.h"

enum { SURFACE_ONE = NET_ONE }; /* the distance of two voxels, in positions of points */

/* A position, in voxels times SURFACE_ONE along x, y, z: the centre of voxel i is i + 1, so that
 * positions outside the scene are not negative. */
struct surface_point {
    uint32_t at[3];
};

struct surface_triangle {
    uint32_t point[3]; /* counter-clockwise seen from outside, for right-handed axes */
};

/* The surface of one label: a range of the points and of the triangles. */
struct surface_part {
    uint8_t label;
    size_t point, points;       /* the first one, and their number */
    size_t triangle, triangles; /* likewise */
    uint64_t voxels;            /* number of voxels that it encloses */
};

struct surface {
    struct surface_point *point;
    struct surface_triangle *triangle;
    size_t points, triangles;
    struct surface_part part[255]; /* sorted by label */
    unsigned parts;
};

/* Labels of a box of voxels. `row` fills size[0] labels; it is called once for each row in order, y
 * faster than z. */
struct surface_source {
    const uint32_t *size; /* [3], each 1..65534 */
    void (*row)(void *context, uint32_t y, uint32_t z, uint8_t *label);
    void *context;
};

/* Options of surfaces. */
struct surface_choice {
    bool wanted[256]; /* labels; others are air */
    bool joins;       /* join all labels to one, with label 1 */
    bool is_cubes;    /* the faces of voxels */
};

/* Compute the surfaces of the labels that have voxels. ERR_MEMORY; ERR_LIMIT for more than 2^31
 * points; ERR_CANCELLED by the watch, or NULL. The caller frees them. */
enum err surface_new(struct surface **surface, const struct surface_source *source,
                     const struct surface_choice *choice, struct watch *watch, struct fault *fault);
void surface_free(struct surface *surface);

/* Remove triangles until at most `most` are left, or none can be removed: each time, move the point
 * whose triangles sweep the least volume to a neighbour. Surfaces stay closed, with U1 and U4. On
 * failure *surface can only be freed. */
enum err surface_reduce(struct surface *surface, size_t most, struct watch *watch,
                        struct fault *fault);

#endif
