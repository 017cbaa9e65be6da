/* SPDX-License-Identifier: MIT */
/* Models of painting that examine every voxel: balls by distance, strokes by the voxel nearest to
 * each step, polygons by the winding number around each centre, rings by the distance from each
 * voxel inside. They are independent of session/paint.c. Each sets covers[cell] where it paints. */
#ifndef TESTS_PAINT_MODEL_H
#define TESTS_PAINT_MODEL_H

#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>

#include "base/mem.h"
#include "engine/grid.h"

typedef const uint32_t (*corners_of)[3];

/* Set covers[cell] of all voxels for which the expression, in their place x, y, z, is true. */
#define EACH_VOXEL(grid, ...)                                                                      \
    for (uint32_t z = 0; z < (grid)->size[2]; z++)                                                 \
        for (uint32_t y = 0; y < (grid)->size[1]; y++)                                             \
            for (uint32_t x = 0; x < (grid)->size[0]; x++)                                         \
    covers[grid_cell(grid, x, y, z)] |= (__VA_ARGS__)

static inline int64_t gap(int64_t a, int64_t b)
{
    return a < b ? b - a : a - b;
}

static inline bool is_between(int64_t a, int64_t at, int64_t b)
{
    return gap(a, at) + gap(at, b) == gap(a, b);
}

static inline int64_t distance_2(const int64_t a[3], const int64_t b[3], const uint32_t unit[3])
{
    int64_t sum = 0;
    for (int i = 0; i < 3; i++)
        sum += gap(a[i], b[i]) * unit[i] * (gap(a[i], b[i]) * unit[i]);
    return sum;
}

static inline void model_ball(bool *covers, const struct grid *grid, const int64_t middle[3],
                              const uint32_t unit[3], int64_t radius)
{
    EACH_VOXEL(grid, distance_2((const int64_t[]){x, y, z}, middle, unit) <= radius * radius);
}

/* Return the voxel nearest to part/parts of the way from a to b, found by trying all from a on; of
 * two, the farther one. */
static inline int64_t nearest(int64_t a, int64_t b, int64_t part, int64_t parts)
{
    int64_t best = a;
    for (int64_t at = a; gap(a, at) <= gap(a, b); at += b < a ? -1 : 1)
        if (gap(parts * at, parts * a + part * (b - a)) <=
            gap(parts * best, parts * a + part * (b - a)))
            best = at;
    return best;
}

static inline void model_stroke(bool *covers, const struct grid *grid, corners_of corner,
                                size_t corners, const uint32_t unit[3], int64_t radius)
{
    model_ball(covers, grid, (int64_t[]){corner[0][0], corner[0][1], corner[0][2]}, unit, radius);
    for (size_t c = 1; c < corners; c++) {
        int64_t steps = 0, at[3];
        for (int a = 0; a < 3; a++)
            if (gap(corner[c - 1][a], corner[c][a]) > steps)
                steps = gap(corner[c - 1][a], corner[c][a]);
        for (int64_t i = 1; i <= steps; i++) {
            for (int a = 0; a < 3; a++)
                at[a] = nearest(corner[c - 1][a], corner[c][a], i, steps);
            model_ball(covers, grid, at, unit, radius);
        }
    }
}

static inline void model_box(bool *covers, const struct grid *grid, const uint32_t a[3],
                             const uint32_t b[3])
{
    EACH_VOXEL(grid,
               is_between(a[0], x, b[0]) && is_between(a[1], y, b[1]) && is_between(a[2], z, b[2]));
}

/* Return the side of the line through a and b: positive for the left. */
static inline int64_t side_of(const int64_t a[2], const int64_t b[2], const int64_t p[2])
{
    return (b[0] - a[0]) * (p[1] - a[1]) - (p[0] - a[0]) * (b[1] - a[1]);
}

static inline bool is_filled(corners_of corner, size_t corners, int axis, const int64_t at[3])
{
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    const int64_t p[2] = {at[u], at[v]};
    int winds = 0;
    for (size_t i = 0; i < corners; i++) {
        const uint32_t *from = corner[i], *to = corner[(i + 1) % corners];
        const int64_t a[2] = {from[u], from[v]}, b[2] = {to[u], to[v]}, side = side_of(a, b, p);
        if (side == 0 && is_between(a[0], p[0], b[0]) && is_between(a[1], p[1], b[1]))
            return true;
        winds += a[1] <= p[1] && b[1] > p[1] && side > 0;
        winds -= a[1] > p[1] && b[1] <= p[1] && side < 0;
    }
    return winds != 0;
}

/* All corners have the same place along `axis`. */
static inline void model_polygon(bool *covers, const struct grid *grid, corners_of corner,
                                 size_t corners, int axis)
{
    EACH_VOXEL(grid, (const uint32_t[]){x, y, z}[axis] == corner[0][axis] &&
                         is_filled(corner, corners, axis, (const int64_t[]){x, y, z}));
}

/* Paint in the slice of that polygon, along the first axis where all corners have the same place.
 * */
static inline void model_ring(bool *covers, const struct grid *grid, corners_of corner,
                              size_t corners, int width)
{
    static const uint32_t ones[3] = {1, 1, 1};
    OWNED(mem_release) bool *inside = calloc(grid->cells, sizeof *inside);
    int axis = 0;
    for (size_t i = 0; i < corners && axis < 3; i++)
        if (corner[i][axis] != corner[0][axis]) {
            axis++;
            i = 0;
        }
    model_polygon(inside, grid, corner, corners, axis);
    for (uint32_t cell = 0; cell < grid->cells; cell++) {
        const struct place at = grid_place(grid, cell);
        const int64_t middle[3] = {at.x, at.y, at.z};
        if (inside[cell])
            EACH_VOXEL(grid, (const uint32_t[]){x, y, z}[axis] == corner[0][axis] &&
                                 distance_2((const int64_t[]){x, y, z}, middle, ones) <=
                                     (int64_t)width * width);
    }
    for (uint32_t cell = 0; cell < grid->cells; cell++)
        covers[cell] &= !inside[cell];
}

#endif
