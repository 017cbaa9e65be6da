/* SPDX-License-Identifier: MIT */
/* Checks of the forest's invariants at every voxel; and the reaches of its seeds, with the count of
 * voxels that all trees around them cannot reach. */
#include "engine/forest.h"

#include <stdlib.h>

#include "base/mem.h"
#include "engine/pass.h"
#include "engine/roi.h"

/* ---- the invariants of engine/forest.h, at every voxel ---- */

/* The least key that neighbours offer a voxel: neighbours whose trees may hold it, or the
 * others. */
static uint64_t least_offer(const struct forest *forest, uint32_t at, bool may_hold)
{
    const struct cell *cell = forest->cell + at;
    uint64_t least = KEY_NONE;
    for (unsigned i = 0; i < forest->adjacency.count; i++) {
        const struct cell *from = cell + forest->adjacency.offset[i];
        if (!cell_is_reached(from) || forest_may_hold(forest, key_root(from->key), at) != may_hold)
            continue;
        const uint64_t offer = key_extend(from->key, arc_weight_now(&forest->arcs, from, cell));
        least = offer < least ? offer : least;
    }
    return least;
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
    const uint64_t best =
        cell->flags & CELL_SEED ? key_make(0, 0, at) : least_offer(forest, at, true);
    if (cell->key != best)
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

bool forest_check(const struct forest *forest, struct fault *fault)
{
    size_t seeds = 0;
    uint64_t keys = 0, labels = 0;
    const struct grid *grid = &forest->scene->grid;
    for (struct grid_walk w = grid_rows(grid, NULL, NULL); grid_walk_next(&w);)
        for (uint32_t c = w.row.first; c < w.row.end; c++) {
            const struct cell *cell = forest->cell + c;
            const char *wrong = voxel_wrong(forest, c);
            if (wrong) {
                fault_set(fault, ERR_CHECK, "voxel %u,%u,%u: %s", c - w.row.first, w.y, w.z, wrong);
                return false;
            }
            seeds += cell->flags & CELL_SEED;
            keys += cell_is_reached(cell) ? key_share(c, cell->key) : 0;
            labels += label_share(c, cell->label);
        }
    if (keys != forest->key_digest || labels != forest->label_digest || seeds != forest->seeds) {
        fault_set(fault, ERR_CHECK, "T4: a digest or the number of seeds differs from a recount");
        return false;
    }
    return true;
}

/* ---- reaches of seeds ---- */

enum err forest_add_reach(struct forest *forest, const struct reach *reach, uint16_t *number,
                          struct fault *fault)
{
    struct reaches *all = &forest->reaches;
    const bool is_exact = reach->radius == REACH_EXACT;
    if (is_exact && all->exact) {
        *number = all->exact;
        return OK;
    }
    if (all->count == UINT16_MAX)
        return fault_set(fault, ERR_LIMIT,
                         "%d markers of this session end within a distance already, and no more "
                         "are held; nothing was planted",
                         UINT16_MAX);
    if (!all->of)
        all->of = mem_pages(forest->scene->grid.cells * sizeof *all->of);
    if (!all->of || !mem_grow(&all->item, &all->capacity, all->count + 1, sizeof *all->item))
        return fault_memory(fault, "the reach of a marker");
    all->item[all->count++] = *reach;
    *number = (uint16_t)all->count;
    all->exact = is_exact ? *number : all->exact;
    return OK;
}

bool forest_is_exact(const struct forest *forest, uint16_t reach)
{
    return reach && reach == forest->reaches.exact;
}

const struct reach *forest_reach(const struct forest *forest, uint32_t seed)
{
    return forest->reaches.of ? reach_of(forest, seed) : NULL;
}

uint16_t forest_reach_number(const struct forest *forest, uint32_t seed)
{
    return forest->reaches.of ? forest->reaches.of[seed] : 0;
}

bool forest_may_hold(const struct forest *forest, uint32_t root, uint32_t cell)
{
    return !forest->reaches.of ||
           tree_may_hold(forest, root, grid_place(&forest->scene->grid, cell));
}

size_t forest_limited_seeds(const struct forest *forest)
{
    return forest->reaches.seeds;
}

uint64_t forest_refused_offer(const struct forest *forest, uint32_t cell)
{
    return forest->cell[cell].flags & CELL_OUTSIDE ? KEY_NONE : least_offer(forest, cell, false);
}

struct flood {
    const struct forest *forest;
    uint64_t *seen; /* bits: voxels that were visited */
    uint32_t *cell; /* stack of voxels whose neighbours are not visited yet */
    size_t count, capacity;
    size_t voxels;
};

/* Push the neighbours of a voxel that belong to no tree and were not visited. */
static bool look_around(struct flood *flood, uint32_t at)
{
    const struct adjacency *adjacency = &flood->forest->adjacency;
    if (!mem_grow(&flood->cell, &flood->capacity, flood->count + adjacency->count,
                  sizeof *flood->cell))
        return false;
    for (unsigned i = 0; i < adjacency->count; i++) {
        const uint32_t cell = at + (uint32_t)adjacency->offset[i];
        const uint64_t bit = UINT64_C(1) << (cell & 63);
        if (flood->forest->cell[cell].key != KEY_NONE || flood->seen[cell >> 6] & bit)
            continue;
        flood->seen[cell >> 6] |= bit;
        flood->voxels++;
        flood->cell[flood->count++] = cell;
    }
    return true;
}

/* Flood from every voxel of a tree through voxels of no tree. */
static bool flood_scene(struct flood *flood)
{
    struct grid_walk w = scene_walk(flood->forest->scene, "voxels out of reach", NULL, 0);
    bool fits = true;
    while (fits && grid_walk_next(&w)) {
        for (uint32_t c = w.row.first; fits && c < w.row.end; c++)
            fits = !cell_is_reached(flood->forest->cell + c) || look_around(flood, c);
        while (fits && flood->count > 0 && task_advance(&w.task, 1))
            fits = look_around(flood, flood->cell[--flood->count]);
    }
    return fits;
}

enum err forest_count_refused(const struct forest *forest, size_t *voxels, struct fault *fault)
{
    struct watch *watch = forest->scene->watch;
    *voxels = 0;
    if (forest->reaches.seeds == 0)
        return OK;
    OWNED(mem_release) uint64_t *seen = mem_new(mask_bytes(&forest->scene->grid));
    struct flood flood = {.forest = forest, .seen = seen};
    const bool fits = seen && flood_scene(&flood);
    *voxels = flood.voxels;
    free(flood.cell);
    return fits ? watch_fault(watch, fault) : fault_memory(fault, "voxels out of reach");
}
