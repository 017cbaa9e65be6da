/* SPDX-License-Identifier: MIT */
/* The voxels that a ray goes through, found by testing each voxel of the scene. */
#ifndef TESTS_RAY_SEARCH_H
#define TESTS_RAY_SEARCH_H

#include <stdlib.h>

#include "render/view.h"

/* A cube that the ray goes through. */
struct passed {
    int64_t depth;
    uint32_t cell;
    uint8_t label; /* for stories of their own; 0 here */
};

static inline int passed_by_depth(const void *a, const void *b)
{
    const struct passed *p = a, *q = b;
    return p->depth < q->depth ? -1 : p->depth > q->depth;
}

/* All of them for the ray of a pixel, the nearest first: how many. There is room for all voxels. */
static inline size_t ray_search(struct passed *out, const struct camera *camera, uint32_t column,
                                uint32_t row)
{
    const struct grid *grid = &camera->scene->grid;
    size_t count = 0;
    for (uint32_t v = 0; v < grid->voxels; v++) {
        const uint32_t x = v % grid->size[0], y = v / grid->size[0] % grid->size[1];
        const uint32_t at[3] = {x, y, v / grid->size[0] / grid->size[1]};
        int64_t first = INT64_MIN, last = INT64_MAX;
        for (int a = 0; a < 3; a++) {
            const int64_t n = camera->flip[a] ? (int64_t)grid->size[a] - 1 - at[a] : at[a];
            const int64_t near = camera_crossing(camera, a, n, column, row);
            const int64_t far = camera_crossing(camera, a, n + 1, column, row);
            first = near > first ? near : first;
            last = far < last ? far : last;
        }
        if (first < last)
            out[count++] = (struct passed){first, grid_cell(grid, at[0], at[1], at[2]), 0};
    }
    qsort(out, count, sizeof *out, passed_by_depth);
    return count;
}

#endif
