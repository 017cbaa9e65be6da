#include "engine/weight.h"

#include "base/hash.h"

static uint16_t morph_at(const struct cell *cell, const struct adjacency *adjacency)
{
    uint16_t low = cell->intensity;
    uint16_t high = low;
    for (unsigned i = 0; i < adjacency->count; i++) {
        const struct cell *neighbour = cell + adjacency->offset[i];
        if (neighbour->flags & CELL_RIM)
            continue;
        low = neighbour->intensity < low ? neighbour->intensity : low;
        high = neighbour->intensity > high ? neighbour->intensity : high;
    }
    return (uint16_t)(high - low);
}

void weight_morph(struct scene *scene, const struct adjacency *adjacency)
{
    const struct grid *grid = &scene->grid;
    for (uint32_t z = 0; z < grid->size[2]; z++)
        for (uint32_t y = 0; y < grid->size[1]; y++) {
            struct span row = grid_row(grid, y, z);
            for (uint32_t c = row.first; c < row.end; c++)
                scene->cell[c].weight = morph_at(scene->cell + c, adjacency);
        }
}

uint64_t weight_digest(const struct scene *scene)
{
    const struct grid *grid = &scene->grid;
    uint64_t sum = 0, voxel = 0;
    for (uint32_t z = 0; z < grid->size[2]; z++)
        for (uint32_t y = 0; y < grid->size[1]; y++) {
            struct span row = grid_row(grid, y, z);
            for (uint32_t c = row.first; c < row.end; c++)
                sum += hash_mix(voxel++ << 16 | scene->cell[c].weight);
        }
    return sum;
}
