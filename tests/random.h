/* SPDX-License-Identifier: MIT */
/* Random voxels of a scene, and random values in them. */
#ifndef TESTS_RANDOM_H
#define TESTS_RANDOM_H

#include "engine/scene.h"
#include "tests/check.h"

static inline uint32_t random_voxel(const struct grid *g, uint64_t *random)
{
    return grid_cell(g, check_below(random, g->size[0]), check_below(random, g->size[1]),
                     check_below(random, g->size[2]));
}

static inline void random_place(const struct grid *g, uint64_t *random, uint32_t place[3])
{
    for (int a = 0; a < 3; a++)
        place[a] = check_below(random, g->size[a]);
}

/* Weights of few levels, for plateaus; intensities below `brightest`. */
static inline void random_values(struct scene *scene, uint32_t brightest, uint64_t *random)
{
    for (size_t i = 0; i < scene->grid.cells; i++)
        if (!(scene->cell[i].flags & CELL_RIM)) {
            scene->cell[i].weight = (uint16_t)check_below(random, 6);
            scene->cell[i].intensity = (uint16_t)check_below(random, brightest);
        }
}

#endif
