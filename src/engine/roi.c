/* SPDX-License-Identifier: MIT */
#include "engine/roi.h"

#include <assert.h>

#include "base/hash.h"

size_t mask_bytes(const struct grid *grid)
{
    return (grid->cells / 64 + 1) * sizeof(uint64_t);
}

struct roi_tally roi_tally(const struct roi *roi, const struct scene *scene)
{
    struct roi_tally tally = {0};
    uint64_t voxel = 0;
    if (roi_is_none(roi))
        return (struct roi_tally){.inside = scene->grid.voxels};
    for (struct grid_walk w = scene_walk(scene, "region of interest", NULL, 0); grid_walk_next(&w);)
        for (uint32_t c = w.row.first; c < w.row.end; c++, voxel++) {
            const bool inside = roi_holds(roi, scene, c);
            tally.inside += inside;
            tally.seeds_outside += !inside && scene->cell[c].flags & CELL_SEED;
            tally.digest += inside ? 0 : hash_mix_at(voxel, 0);
        }
    return tally;
}

void roi_apply(const struct roi *roi, struct scene *scene)
{
    for (struct grid_walk w = scene_walk(scene, "region of interest", NULL, 0); grid_walk_next(&w);)
        for (uint32_t c = w.row.first; c < w.row.end; c++) {
            struct cell *cell = scene->cell + c;
            const bool inside = roi_holds(roi, scene, c),
                       was_inside = !(cell->flags & CELL_OUTSIDE);
            assert(inside || !(cell->flags & CELL_SEED));
            if (inside == was_inside)
                continue;
            if (cell->label) /* a forest with labels is rebuilt afterwards */
                cell_touch(cell);
            cell->flags ^= CELL_OUTSIDE;
            cell->key = inside ? KEY_NONE : 0;
            cell->label = 0;
            cell->direction = DIRECTION_NONE;
        }
}
