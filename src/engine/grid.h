/* SPDX-License-Identifier: MIT */
/*
 * The grid: a box of voxels inside a rim of sentinel cells, one cell wide on every side.
 *
 * A voxel is identified either by its position (x, y, z), each from 0, x fastest, or by its *cell*:
 * its index in the array that includes the rim. Cells have the same order as voxel indices, so the
 * smaller of two cells also has the smaller voxel index. No inner loop needs a bounds check: the
 * neighbours of a voxel are always cells, and cells of the rim decline every offer.
 *
 * Invariants
 *   G1 cells < 2^32 - 1, so that a cell fits 32 bits and 0xFFFFFFFF means none;
 *   G2 cell 0 belongs to the rim, so no voxel is cell 0.
 */
#ifndef ENGINE_GRID_H
#define ENGINE_GRID_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/err.h"
#include "base/watch.h"

#define CELL_NONE UINT32_C(0xFFFFFFFF)
enum { GRID_SIDE_MOST = 65534 };

struct grid {
    uint32_t size[3];  /* voxels along x, y, z; each 1..65534 */
    ptrdiff_t step[3]; /* cells from a voxel to the next along x, y, z; step[0] is 1 */
    size_t cells;      /* (size[0] + 2) * (size[1] + 2) * (size[2] + 2) */
    size_t voxels;     /* size[0] * size[1] * size[2] */
};

struct place {
    uint32_t x, y, z;
};

/* ERR_INPUT for a side of 0, ERR_LIMIT for more than 65534 voxels on a side or more cells
 * than G1 allows. */
enum err grid_init(struct grid *grid, const uint32_t size[3], struct fault *fault);

static inline uint32_t grid_cell(const struct grid *grid, uint32_t x, uint32_t y, uint32_t z)
{
    return (uint32_t)((size_t)x + 1 + ((size_t)y + 1) * (size_t)grid->step[1] +
                      ((size_t)z + 1) * (size_t)grid->step[2]);
}

static inline bool same_size(const uint32_t a[3], const uint32_t b[3])
{
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

static inline bool grid_contains(const struct grid *grid, int64_t x, int64_t y, int64_t z)
{
    return x >= 0 && y >= 0 && z >= 0 && x < grid->size[0] && y < grid->size[1] &&
           z < grid->size[2];
}

/* Clamp a position to an axis of `size` voxels. */
static inline uint32_t grid_held(int64_t at, uint32_t size)
{
    return at < 0 ? 0 : at < size ? (uint32_t)at : size - 1;
}

/* The position of a voxel's cell. */
struct place grid_place(const struct grid *grid, uint32_t cell);
void grid_find(const struct grid *grid, uint32_t cell, uint32_t place[3]);

/* Voxel index x + size_x * (y + size_y * z) of a cell, as used in files. */
uint32_t grid_voxel(const struct grid *grid, uint32_t cell);

/*
 * An adjacency: the directions from a voxel to its neighbours, ordered so that direction
 * count - 1 - i is the opposite of direction i. The 6 faces are -z -y -x +x +y +z.
 */
struct adjacency {
    unsigned count; /* 6 or 26 */
    int8_t step[26][3];
    ptrdiff_t offset[26]; /* in cells */
};

void adjacency_init(struct adjacency *adjacency, unsigned count, const struct grid *grid);

/* The first and the one-past-last cell of the row of voxels (., y, z). */
struct span {
    uint32_t first, end;
};
static inline struct span grid_row(const struct grid *grid, uint32_t y, uint32_t z)
{
    uint32_t first = grid_cell(grid, 0, y, z);
    return (struct span){first, first + grid->size[0]};
}

/* The planes first..end-1 of part `part` of `parts`, which divide all planes evenly. */
struct slab {
    uint32_t first, end;
};
static inline struct slab grid_slab(const struct grid *grid, unsigned part, unsigned parts)
{
    const uint64_t planes = grid->size[2];
    return (struct slab){(uint32_t)(planes * part / parts),
                         (uint32_t)(planes * (part + 1) / parts)};
}

static inline uint64_t slab_voxels(const struct grid *grid, struct slab slab)
{
    return (uint64_t)grid->size[0] * grid->size[1] * (slab.end - slab.first);
}

/*
 * A walk over the rows of voxels of a slab, y faster than z, under a watch. `worker` is the number
 * of the thread, 0 for the caller alone.
 *
 *     for (struct grid_walk w = grid_walk(grid, watch, "digest", slab, 0); grid_walk_next(&w);)
 *         for (uint32_t c = w.row.first; c < w.row.end; c++)
 *
 * Each row advances the task by its voxels. The walk ends early if the watch stops it.
 */
struct grid_walk {
    const struct grid *grid;
    struct span row; /* cells of the current row */
    uint32_t y, z;
    uint32_t end; /* the plane after the last one */
    struct task task;
};
struct grid_walk grid_walk(const struct grid *grid, struct watch *watch, const char *what,
                           struct slab slab, unsigned worker);
bool grid_walk_next(struct grid_walk *walk);

/* A walk over all rows by one thread; without a watch (NULL) it cannot be stopped. */
static inline struct grid_walk grid_rows(const struct grid *grid, struct watch *watch,
                                         const char *what)
{
    return grid_walk(grid, watch, what, grid_slab(grid, 0, 1), 0);
}

#endif
