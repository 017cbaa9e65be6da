/* SPDX-License-Identifier: MIT */
/* Walks through the whole forest: its invariants checked, and the voxels counted that every tree
 * around them is kept from. */
#include "engine/forest.h"

#include <stdlib.h>

#include "base/mem.h"
#include "engine/pass.h"
#include "engine/roi.h"

/* ---- the invariants of engine/forest.h, at every voxel ---- */

/* What the equation of the forest gives for one voxel, from its neighbours' keys. */
static uint64_t solve_at(const struct forest *forest, uint32_t at)
{
    const struct adjacency *adjacency = &forest->adjacency;
    const struct cell *cell = forest->cell + at;
    uint64_t best = cell->flags & CELL_SEED ? key_make(0, 0, at) : KEY_NONE;
    for (unsigned i = 0; i < adjacency->count; i++) {
        const struct cell *neighbour = cell + adjacency->offset[i];
        if (!cell_is_reached(neighbour) || !forest_may_hold(forest, key_root(neighbour->key), at))
            continue;
        uint64_t offer = key_extend(neighbour->key, arc_weight_now(&forest->arcs, neighbour, cell));
        best = offer < best ? offer : best;
    }
    return best;
}

static const char *voxel_wrong(const struct forest *forest, uint32_t at)
{
    const struct adjacency *adjacency = &forest->adjacency;
    const struct cell *cell = forest->cell + at;
    if (cell->flags & CELL_OUTSIDE)
        return cell->key || cell->label || cell->direction != DIRECTION_NONE ||
                       cell->flags != CELL_OUTSIDE
                   ? "S2: outside the region of interest, but not as the rim"
                   : NULL;
    if (cell->key != solve_at(forest, at))
        return "T1: its key does not solve the equation of the forest";
    if (cell->flags & ~CELL_SEED || cell->former_label)
        return "it is marked as if in the middle of a pass";
    if (cell->key == KEY_NONE)
        return cell->label || cell->direction != DIRECTION_NONE ? "T2: unreached but labelled"
                                                                : NULL;
    if (key_hops(cell->key) == KEY_HOPS_LIMIT)
        return "T3: too many hops";
    if (cell->flags & CELL_SEED)
        return cell->direction == DIRECTION_NONE ? NULL : "T2: a seed has a predecessor";
    if (cell->direction >= adjacency->count)
        return "T2: no predecessor";
    const struct cell *from = cell - adjacency->offset[cell->direction];
    if (!cell_is_reached(from) || !forest_may_hold(forest, key_root(from->key), at) ||
        key_extend(from->key, arc_weight_now(&forest->arcs, from, cell)) != cell->key)
        return "T2: its predecessor does not support it";
    return from->label == cell->label ? NULL : "T2: its label is not that of its predecessor";
}

/* Both digests, from every voxel. */
static void recount(const struct forest *forest, uint64_t *keys, uint64_t *labels)
{
    const struct grid *grid = &forest->scene->grid;
    struct task task = task_begin(forest->scene->watch, "digests", grid->voxels);
    *keys = *labels = 0;
    for (uint32_t z = 0; z < grid->size[2]; z++)
        for (uint32_t y = 0; y < grid->size[1]; y++) {
            struct span row = grid_row(grid, y, z);
            for (uint32_t c = row.first; c < row.end; c++) {
                const struct cell *cell = forest->cell + c;
                if (!cell_is_reached(cell))
                    continue;
                *keys += key_share(c, cell->key);
                *labels += label_share(c, cell->label);
            }
            if (!task_advance(&task, grid->size[0]))
                return;
        }
}

bool forest_check(const struct forest *forest, struct fault *fault)
{
    const struct scene *scene = forest->scene;
    const struct grid *grid = &scene->grid;
    size_t seeds = 0;
    for (uint32_t z = 0; z < grid->size[2]; z++)
        for (uint32_t y = 0; y < grid->size[1]; y++)
            for (uint32_t x = 0; x < grid->size[0]; x++) {
                uint32_t at = grid_cell(grid, x, y, z);
                const char *wrong = voxel_wrong(forest, at);
                if (wrong) {
                    fault_set(fault, ERR_CHECK, "voxel %u,%u,%u: %s", x, y, z, wrong);
                    return false;
                }
                seeds += scene->cell[at].flags & CELL_SEED;
            }
    uint64_t keys, labels;
    recount(forest, &keys, &labels);
    if (keys != forest->key_digest || labels != forest->label_digest || seeds != forest->seeds) {
        fault_set(fault, ERR_CHECK,
                  "T4: a digest or the number of seeds is not what a recount gives");
        return false;
    }
    return true;
}

/* ---- voxels that every tree around them is kept from ---- */

struct flood {
    const struct forest *forest;
    uint64_t *seen; /* bits */
    uint32_t *cell; /* that wait to be looked around */
    size_t count, capacity;
    size_t voxels;
};

static bool see_voxel(struct flood *flood, uint32_t at)
{
    uint64_t *word = &flood->seen[at >> 6];
    const uint64_t bit = UINT64_C(1) << (at & 63);
    if (flood->forest->cell[at].key != KEY_NONE || *word & bit)
        return true;
    *word |= bit;
    flood->voxels++;
    if (!mem_grow(&flood->cell, &flood->capacity, flood->count + 1, sizeof *flood->cell))
        return false;
    flood->cell[flood->count++] = at;
    return true;
}

static bool look_around(struct flood *flood, uint32_t at)
{
    const struct adjacency *adjacency = &flood->forest->adjacency;
    bool fits = true;
    for (unsigned i = 0; fits && i < adjacency->count; i++)
        fits = see_voxel(flood, at + (uint32_t)adjacency->offset[i]);
    return fits;
}

/* From every voxel that has a tree, through those that have none. */
static bool flood_scene(struct flood *flood, struct task *task)
{
    const struct grid *grid = &flood->forest->scene->grid;
    bool fits = true;
    for (uint32_t z = 0; fits && z < grid->size[2]; z++)
        for (uint32_t y = 0; fits && y < grid->size[1]; y++) {
            const struct span row = grid_row(grid, y, z);
            for (uint32_t c = row.first; fits && c < row.end; c++)
                fits = !cell_is_reached(flood->forest->cell + c) || look_around(flood, c);
            while (fits && flood->count > 0 && task_advance(task, 1))
                fits = look_around(flood, flood->cell[--flood->count]);
            if (!task_advance(task, grid->size[0]))
                return true;
        }
    return fits;
}

enum err forest_count_refused(const struct forest *forest, size_t *voxels, struct fault *fault)
{
    struct watch *watch = forest->scene->watch;
    struct flood flood = {.forest = forest};
    *voxels = 0;
    if (forest->reaches.seeds == 0)
        return OK;
    struct task task = task_begin(watch, "voxels out of reach", forest->scene->grid.voxels);
    flood.seen = mask_new(&forest->scene->grid);
    const bool fits = flood.seen && flood_scene(&flood, &task);
    *voxels = flood.voxels;
    free(flood.seen);
    free(flood.cell);
    return fits ? watch_fault(watch, fault) : fault_memory(fault, "voxels out of reach");
}
