#include "engine/intensities.h"

#include <string.h>

static const size_t VOXELS_MOST = 1u << 22;

void intensities_count(uint32_t count[UINT16_MAX + 1], const struct scene *scene)
{
    const struct grid *grid = &scene->grid;
    const size_t rows = (size_t)grid->size[1] * grid->size[2];
    const size_t each = (grid->voxels + VOXELS_MOST - 1) / VOXELS_MOST;
    memset(count, 0, (UINT16_MAX + 1) * sizeof *count);
    for (size_t r = 0; r < rows; r += each) {
        const struct span row =
            grid_row(grid, (uint32_t)(r % grid->size[1]), (uint32_t)(r / grid->size[1]));
        for (uint32_t c = row.first; c < row.end; c++)
            count[scene->cell[c].intensity]++;
    }
}

void intensities_range(int32_t range[2], const uint32_t count[UINT16_MAX + 1], uint64_t low,
                       uint64_t high)
{
    uint64_t below = 0, all = 0;
    for (int32_t i = 0; i <= UINT16_MAX; i++)
        all += count[i];
    range[0] = range[1] = 0;
    for (int32_t i = 0; i <= UINT16_MAX; i++) {
        if (below * 1000 <= all * low)
            range[0] = i;
        if (below * 1000 < all * high)
            range[1] = i;
        below += count[i];
    }
}
