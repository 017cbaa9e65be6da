/*
 * Surfaces: what encloses the voxels of each label, as triangles. Integers only.
 *
 * A node lies between each two voxels with a face in common that have different labels, on the line
 * between their centres. The eight centres around a corner of voxels make a cube; in each cube
 * marching cubes join the nodes on its edges, once for each label there, so that each label has a
 * surface of its own. Smoothing moves nodes along their lines and never to their ends. Voxels
 * outside the scene have label 0, which has no surface.
 *
 * Marching cubes, and not surface nets: with a node on each line, and no vertex in the middle of a
 * cube that two sheets must share, a surface is a manifold for any labels, without repair.
 *
 * Promises
 *   U1 closed: each edge of a surface has exactly two triangles, which run along it in opposite
 *      directions, also where a label touches itself or another at an edge or a corner;
 *   U2 no two points of a surface have the same place, so U1 holds for files without numbers of
 *      points (STL) as well;
 *   U3 until it is reduced, a surface has the centres of all voxels of its label inside and of all
 *      others outside; voxels of a label that share no face are apart;
 *   U4 normals point out of the label;
 *   U5 the same labels give the same triangles in the same order, on every machine;
 *   U6 where two labels touch, their surfaces have the same points, until they are reduced.
 * tests/surface_check.h asserts U1 and U2.
 */
#ifndef ENGINE_SURFACE_H
#define ENGINE_SURFACE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/err.h"
#include "base/watch.h"

enum { SURFACE_ONE = 65536 }; /* the distance of two voxels, in the places of points */

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

enum { SURFACE_PASSES_MOST = 100 };

/* The surfaces of the labels that are `wanted`, without those that have no voxel, smoothed `passes`
 * times, 0..SURFACE_PASSES_MOST, and then set so that they enclose the volume of their voxels. All
 * labels take part in that, wanted or not, so that surfaces made one by one fit one another.
 * ERR_MEMORY; ERR_LIMIT for more than 2^31 nodes; ERR_CANCELLED by the watch, or NULL. The caller
 * frees. */
enum err surface_new(struct surface **surface, const struct surface_source *source,
                     const bool wanted[256], unsigned passes, struct watch *watch,
                     struct fault *fault);
void surface_free(struct surface *surface);

/* Takes triangles away until no more than `most` are left, or none can go: each time the point
 * whose triangles sweep the least volume when it moves to a neighbour. Surfaces stay closed, and
 * hold U1, U2 and U4. On failure *surface is of no use but to be freed. */
enum err surface_reduce(struct surface *surface, size_t most, struct watch *watch,
                        struct fault *fault);

#endif
