/* SPDX-License-Identifier: MIT */
#include "engine/roi.h"

#include <assert.h>

#include "base/hash.h"
#include "base/mem.h"

size_t mask_bytes(const struct grid *grid)
{
    return (grid->cells / 64 + 1) * sizeof(uint64_t);
}

uint64_t *mask_new(const struct grid *grid)
{
    return mem_new(mask_bytes(grid));
}

struct roi_tally roi_tally(const struct roi *roi, const struct scene *scene)
{
    const struct grid *grid = &scene->grid;
    struct roi_tally tally = {0};
    uint64_t voxel = 0;
    if (roi_is_none(roi))
        return (struct roi_tally){.inside = grid->voxels};
    struct task task = task_begin(scene->watch, "region of interest", grid->voxels);
    for (uint32_t z = 0; z < grid->size[2]; z++)
        for (uint32_t y = 0; y < grid->size[1]; y++) {
            const struct span row = grid_row(grid, y, z);
            for (uint32_t c = row.first; c < row.end; c++, voxel++) {
                const bool inside = roi_holds(roi, scene, c);
                tally.inside += inside;
                tally.seeds_outside += !inside && scene->cell[c].flags & CELL_SEED;
                tally.digest += inside ? 0 : hash_mix_at(voxel, 0);
            }
            if (!task_advance(&task, grid->size[0]))
                return tally;
        }
    return tally;
}

static void apply_at(struct cell *cell, bool inside)
{
    const bool was_inside = !(cell->flags & CELL_OUTSIDE);
    assert(inside || !(cell->flags & CELL_SEED));
    if (inside == was_inside)
        return;
    cell->flags ^= CELL_OUTSIDE;
    cell->key = inside ? KEY_NONE : 0;
    cell->label = 0;
    cell->direction = DIRECTION_NONE;
}

void roi_apply(const struct roi *roi, struct scene *scene)
{
    const struct grid *grid = &scene->grid;
    struct task task = task_begin(scene->watch, "region of interest", grid->voxels);
    for (uint32_t z = 0; z < grid->size[2]; z++)
        for (uint32_t y = 0; y < grid->size[1]; y++) {
            const struct span row = grid_row(grid, y, z);
            for (uint32_t c = row.first; c < row.end; c++)
                apply_at(scene->cell + c, roi_holds(roi, scene, c));
            if (!task_advance(&task, grid->size[0]))
                return;
        }
}
