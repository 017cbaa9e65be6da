/* Reaches of seeds: their table, and the voxels that they leave without a tree. */
#include "engine/reach.h"

#include <stdlib.h>

#include "base/mem.h"
#include "engine/forest_parts.h"
#include "engine/roi.h"

enum err forest_add_reach(struct forest *forest, const struct reach *reach, uint16_t *number,
                          struct fault *fault)
{
    struct reaches *all = &forest->reaches;
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
    return OK;
}

void reaches_release(struct reaches *reaches, size_t cells)
{
    free(reaches->item);
    mem_pages_free(reaches->of, cells * sizeof *reaches->of);
    *reaches = (struct reaches){0};
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

uint64_t forest_refused_offer(const struct forest *forest, uint32_t cell)
{
    const struct cell *here = forest->cell + cell;
    uint64_t least = KEY_NONE;
    for (unsigned i = 0; i < forest->adjacency.count; i++) {
        const struct cell *from = here + forest->adjacency.offset[i];
        if (here->flags & CELL_OUTSIDE || !cell_is_reached(from) ||
            forest_may_hold(forest, key_root(from->key), cell))
            continue;
        const uint64_t offer = key_extend(from->key, arc_weight_now(&forest->arcs, from, here));
        least = offer < least ? offer : least;
    }
    return least;
}

size_t forest_limited_seeds(const struct forest *forest)
{
    return forest->reaches.seeds;
}

/* ---- voxels that every tree around them is kept from ---- */

struct flood {
    const struct forest *forest;
    uint64_t *seen; /* bits */
    uint32_t *cell; /* that wait to be looked around */
    size_t count, capacity;
    size_t voxels;
};

static bool see(struct flood *flood, uint32_t at)
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
        fits = see(flood, at + (uint32_t)adjacency->offset[i]);
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
