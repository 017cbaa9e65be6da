/* SPDX-License-Identifier: MIT */
/*
 * Surfaces: what encloses the voxels of each label, as triangles: the nets that pictures show
 * (engine/net.h), sewn together from boxes. Integers only.
 *
 * The surface of a single label is its net, point by point. Of several, each has the quads of a net
 * of its own, so that it is closed by itself, and they lie where they fit: what meets air has the
 * places of the net of all labels together, as pictures of opaque objects show it; walls between
 * labels have the means of the places that their own nets give. Voxels outside the scene have label
 * 0, which has no surface.
 *
 * In a net, four quads may share an edge, and a vertex may be that of two sheets, where voxels
 * touch at an edge or a corner. Here such edges and vertices are split, so voxels of a label that
 * share no face may be apart though a picture joins them; the points of a split vertex have the
 * same place.
 *
 * Promises
 *   U1 closed: each edge of a surface has exactly two triangles, which run along it in opposite
 *      directions, and the triangles around a point are one fan, also where a label touches itself
 *      or another at an edge or a corner;
 *   U2 a surface has the points of the net, whatever boxes it is made from;
 *   U3 until it is reduced, no point is further than 1/4 voxel outside the cube of voxels that it
 *      is of; a surface that meets no other encloses as much as its voxels do, to 2 % where it is
 *      a ball with a radius of 3 voxels or more;
 *   U4 normals point out of the label;
 *   U5 the same labels give the same triangles in the same order, on every machine;
 *   U6 where two labels touch, their surfaces have points at the same places, until they are
 *      reduced.
 * tests/surface_check.h asserts U1. No two points of a surface have the same place in files
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

enum { SURFACE_ONE = NET_ONE }; /* the distance of two voxels, in the places of points */

/* A place, in voxels times SURFACE_ONE along x, y, z: the centre of voxel i is i + 1, so that what
 * is outside the scene has no sign. */
struct surface_point {
    uint32_t at[3];
};

struct surface_triangle {
    uint32_t point[3]; /* counter-clockwise seen from outside, where the axes are right-handed */
};

/* The surface of one label: a stretch of the points and of the triangles. */
struct surface_part {
    uint8_t label;
    size_t point, points;       /* the first one, and how many */
    size_t triangle, triangles; /* likewise */
    uint64_t voxels;            /* that it encloses */
};

struct surface {
    struct surface_point *point;
    struct surface_triangle *triangle;
    size_t points, triangles;
    struct surface_part part[255]; /* by rising labels */
    unsigned parts;
};

/* Labels of a box of voxels. `row` is asked for the rows in order, y faster than z, each once, and
 * fills size[0] labels. */
struct surface_source {
    const uint32_t *size; /* [3], each 1..65534 */
    void (*row)(void *context, uint32_t y, uint32_t z, uint8_t *label);
    void *context;
};

/* Which surfaces. */
struct surface_choice {
    bool wanted[256]; /* labels; others are air */
    bool joins;       /* all of them as one, which then has label 1 */
    bool is_cubes;    /* the faces of voxels */
};

/* Those of the labels that have voxels. ERR_MEMORY; ERR_LIMIT for more than 2^31 points;
 * ERR_CANCELLED by the watch, or NULL. The caller frees. */
enum err surface_new(struct surface **surface, const struct surface_source *source,
                     const struct surface_choice *choice, struct watch *watch, struct fault *fault);
void surface_free(struct surface *surface);

/* Takes triangles away until no more than `most` are left, or none can go: each time the point
 * whose triangles sweep the least volume when it moves to a neighbour. Surfaces stay closed, and
 * hold U1 and U4. On failure *surface is of no use but to be freed. */
enum err surface_reduce(struct surface *surface, size_t most, struct watch *watch,
                        struct fault *fault);

#endif
