/* SPDX-License-Identifier: MIT */
/*
 * The walk of a pixel's ray through the scene, from cube to cube.
 *
 * It goes from crossing to crossing in the order of (t, axis). At crossing `at` the ray is in the
 * cube whose flipped position along axis b is the number of planes of b, after plane 0, that have
 * been crossed by then. Cubes are those of voxels, or of blocks of 2^bits of them a side, which
 * count from voxel 0 on: so one can go from block to block, and from voxel to voxel where there is
 * something to be found.
 */
#ifndef RENDER_WALK_H
#define RENDER_WALK_H

#include "render/view.h"

struct walk {
    int64_t at;                /* the crossing by which the ray has come into the cube, */
    uint32_t cell;             /* and that cube's voxel, or the number of the block, x fastest */
    uint32_t step[3];          /* from that to the next one along each axis */
    int64_t next[3], apart[3]; /* crossings of the planes ahead, and between planes */
    int64_t end;               /* the crossing by which the ray leaves the scene's cubes */
};

/* Blocks along an axis; the last one may lie in the scene in part. */
static inline uint32_t walk_blocks(const struct grid *grid, int a, unsigned bits)
{
    return ((grid->size[a] - 1) >> bits) + 1;
}

static inline size_t walk_blocks_in(const struct grid *grid, unsigned bits)
{
    return (size_t)walk_blocks(grid, 0, bits) * walk_blocks(grid, 1, bits) *
           walk_blocks(grid, 2, bits);
}

/* To the cube in which the ray is at `from`, or is first where it comes into the scene later;
 * INT64_MIN starts before the scene. False where it is in none. */
static inline bool walk_begin(struct walk *walk, const struct camera *camera, unsigned bits,
                              uint32_t column, uint32_t row, int64_t from)
{
    const struct grid *grid = &camera->scene->grid;
    int64_t first[3], at = from;
    uint32_t step = 1;
    for (int a = 0; a < 3; a++) {
        first[a] = camera_crossing(camera, a, 0, column, row);
        at = first[a] > at ? first[a] : at;
    }
    walk->at = at;
    walk->cell = bits ? 0 : grid_cell(grid, 0, 0, 0);
    walk->end = INT64_MAX;
    for (int a = 0; a < 3; a++) {
        const int64_t cubes = walk_blocks(grid, a, bits), apart = camera->T[a] * (1 << bits);
        if (camera->flip[a]) /* the first block begins before the scene */
            first[a] -= ((cubes << bits) - grid->size[a]) * camera->T[a];
        const int64_t n = (at - first[a]) / apart, end = first[a] + cubes * apart;
        if (n >= cubes)
            return false;
        walk->apart[a] = apart;
        walk->next[a] = first[a] + (n + 1) * apart;
        walk->end = end < walk->end ? end : walk->end;
        const uint32_t beyond = bits ? step : (uint32_t)grid->step[a];
        walk->step[a] = camera->flip[a] ? -beyond : beyond;
        walk->cell += (uint32_t)(camera->flip[a] ? cubes - 1 - n : n) * beyond;
        step *= (uint32_t)cubes;
    }
    return true;
}

/* The crossing by which the ray leaves the cube. */
static inline int64_t walk_leaves(const struct walk *walk)
{
    const int64_t next = walk->next[0] < walk->next[1] ? walk->next[0] : walk->next[1];
    return next < walk->next[2] ? next : walk->next[2];
}

static inline void walk_cross(struct walk *walk, int a, int64_t at)
{
    const int64_t is_crossed = -(int64_t)(walk->next[a] == at);
    walk->next[a] += walk->apart[a] & is_crossed;
    walk->cell += walk->step[a] & (uint32_t)is_crossed;
}

/* To the next cube; false where the ray leaves the scene. Nobody can foresee across which axis, so
 * there is no branch for it. */
static inline bool walk_on(struct walk *walk)
{
    const int64_t at = walk_leaves(walk);
    if (at == walk->end)
        return false;
    walk->at = at;
    walk_cross(walk, 0, at);
    walk_cross(walk, 1, at);
    walk_cross(walk, 2, at);
    return true;
}

#endif
