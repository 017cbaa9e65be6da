/* SPDX-License-Identifier: MIT */
#include "engine/grid.h"

enum err grid_init(struct grid *grid, const uint32_t size[3], struct fault *fault)
{
    uint64_t cells = 1;
    for (int a = 0; a < 3; a++) {
        if (size[a] == 0)
            return fault_set(fault, ERR_INPUT, "a scene needs at least one voxel on every side");
        if (size[a] > GRID_SIDE_MOST)
            return fault_set(fault, ERR_LIMIT, "%u voxels on one side; at most %d are held",
                             size[a], GRID_SIDE_MOST);
        cells *= size[a] + UINT64_C(2); /* at most 2^48 */
    }
    if (cells >= CELL_NONE || cells > SIZE_MAX / 64)
        return fault_set(fault, ERR_LIMIT, "%ux%ux%u voxels; at most 2^32 cells are held", size[0],
                         size[1], size[2]);
    grid->cells = (size_t)cells;
    grid->voxels = (size_t)size[0] * size[1] * size[2];
    for (int a = 0; a < 3; a++)
        grid->size[a] = size[a];
    grid->step[0] = 1;
    grid->step[1] = (ptrdiff_t)size[0] + 2;
    grid->step[2] = grid->step[1] * ((ptrdiff_t)size[1] + 2);
    return OK;
}

struct place grid_place(const struct grid *grid, uint32_t cell)
{
    uint32_t row = (uint32_t)grid->step[1];
    uint32_t plane = (uint32_t)grid->step[2];
    return (struct place){cell % row - 1, cell % plane / row - 1, cell / plane - 1};
}

void grid_find(const struct grid *grid, uint32_t cell, uint32_t place[3])
{
    const struct place p = grid_place(grid, cell);
    place[0] = p.x, place[1] = p.y, place[2] = p.z;
}

uint32_t grid_voxel(const struct grid *grid, uint32_t cell)
{
    struct place p = grid_place(grid, cell);
    return (uint32_t)(p.x + (size_t)grid->size[0] * (p.y + (size_t)grid->size[1] * p.z));
}

struct grid_walk grid_walk(const struct grid *grid, struct watch *watch, const char *what,
                           struct slab slab, unsigned worker)
{
    return (struct grid_walk){.grid = grid,
                              .y = UINT32_MAX, /* before the first row */
                              .z = slab.first,
                              .end = slab.end,
                              .task =
                                  task_begin_part(watch, what, slab_voxels(grid, slab), worker)};
}

bool grid_walk_next(struct grid_walk *walk)
{
    const uint32_t *size = walk->grid->size;
    if (walk->y != UINT32_MAX && !task_advance(&walk->task, size[0]))
        return false;
    if (++walk->y == size[1]) {
        walk->y = 0;
        walk->z++;
    }
    if (walk->z >= walk->end)
        return false;
    walk->row = grid_row(walk->grid, walk->y, walk->z);
    return true;
}

void adjacency_init(struct adjacency *adjacency, unsigned count, const struct grid *grid)
{
    unsigned n = 0;
    for (int z = -1; z <= 1; z++)
        for (int y = -1; y <= 1; y++)
            for (int x = -1; x <= 1; x++) {
                int moved = (x != 0) + (y != 0) + (z != 0);
                if (moved == 0 || (count == 6 && moved != 1))
                    continue;
                adjacency->step[n][0] = (int8_t)x;
                adjacency->step[n][1] = (int8_t)y;
                adjacency->step[n][2] = (int8_t)z;
                adjacency->offset[n] = x * grid->step[0] + y * grid->step[1] + z * grid->step[2];
                n++;
            }
    adjacency->count = n;
}
