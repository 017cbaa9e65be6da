/* SPDX-License-Identifier: MIT */
/* B1 of render/border.h: the border equals a recount by the words there, voxel by voxel. */
#ifndef TESTS_BORDER_CHECK_H
#define TESTS_BORDER_CHECK_H

#include "render/border.h"

static inline bool border_should_show(const struct border *border, uint32_t cell)
{
    const struct scene *scene = border->scene;
    return border->visible[labels_at(&border->labels, cell)] && /* no cell of the rim */
           !cut_removes(&border->cut, &scene->grid, cell);
}

static inline bool border_check_block(const struct border *border, uint32_t x, uint32_t y,
                                      uint32_t z)
{
    const struct grid *grid = &border->scene->grid;
    const uint32_t across = ((grid->size[0] - 1) >> BORDER_BLOCK_BITS) + 1;
    const uint32_t down = ((grid->size[1] - 1) >> BORDER_BLOCK_BITS) + 1;
    const size_t plane = (size_t)(z >> BORDER_BLOCK_BITS) * down + (y >> BORDER_BLOCK_BITS);
    return border->occupied[plane * across + (x >> BORDER_BLOCK_BITS)] ||
           !border_shows(border, grid_cell(grid, x, y, z));
}

/* `why` names the first voxel where it does not hold. */
static inline bool border_check(const struct border *border, struct fault *why)
{
    const struct grid *grid = &border->scene->grid;
    for (uint32_t z = 0; z < grid->size[2]; z++)
        for (uint32_t y = 0; y < grid->size[1]; y++)
            for (uint32_t x = 0; x < grid->size[0]; x++) {
                uint32_t at = grid_cell(grid, x, y, z);
                bool shown = border_should_show(border, at);
                bool inside = shown;
                for (int a = 0; a < 3; a++)
                    inside = inside && border_should_show(border, at - (uint32_t)grid->step[a]) &&
                             border_should_show(border, at + (uint32_t)grid->step[a]);
                if (border_shows(border, at) != shown || !border_check_block(border, x, y, z) ||
                    border_holds(border, at) != (shown && !inside)) {
                    fault_set(why, ERR_CHECK, "voxel %u,%u,%u: B1: the border is not a recount", x,
                              y, z);
                    return false;
                }
            }
    return true;
}

#endif
