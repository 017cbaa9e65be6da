#include "engine/tree.h"

/* Each voxel is entered from its predecessor and left for it, when all its children are counted. */
size_t tree_voxels(const struct forest *forest, uint32_t seed, size_t most)
{
    const struct adjacency *adjacency = forest_adjacency(forest);
    const struct cell *cell = forest_scene(forest)->cell;
    const ptrdiff_t *offset = adjacency->offset;
    uint32_t at = seed;
    size_t voxels = 1;
    for (unsigned i = 0; voxels <= most;) {
        while (i < adjacency->count && cell[at + (uint32_t)offset[i]].direction != i)
            i++;
        if (i < adjacency->count) {
            at += (uint32_t)offset[i];
            voxels++;
            i = 0;
        } else if (at != seed) {
            i = cell[at].direction;
            at -= (uint32_t)offset[i++];
        } else {
            break;
        }
    }
    return voxels;
}
