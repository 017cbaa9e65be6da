#include "engine/centre.h"

#include <stdlib.h>

static bool has_label(const struct cell *cell, unsigned label)
{
    return cell_is_reached(cell) && cell->label == label;
}

static bool find_mean(const struct scene *scene, unsigned label, int64_t mean[3])
{
    const struct grid *grid = &scene->grid;
    struct task task = task_begin(scene->watch, "the centre of a label", grid->voxels);
    uint64_t voxels = 0, sum[3] = {0};
    for (uint32_t z = 0; z < grid->size[2]; z++)
        for (uint32_t y = 0; y < grid->size[1]; y++) {
            const struct span row = grid_row(grid, y, z);
            uint64_t here = 0;
            for (uint32_t c = row.first; c < row.end; c++)
                if (has_label(scene->cell + c, label)) {
                    here++;
                    sum[0] += c - row.first;
                }
            voxels += here;
            sum[1] += here * y;
            sum[2] += here * z;
            if (!task_advance(&task, grid->size[0]))
                return false;
        }
    for (int a = 0; a < 3 && voxels > 0; a++)
        mean[a] = (int64_t)(sum[a] / voxels);
    return voxels > 0;
}

struct nearest {
    const struct scene *scene;
    unsigned label;
    int64_t mean[3], squared; /* the least distance so far */
    uint32_t cell;            /* and the first that has it */
};

/* Those of a row whose distance along x is `r`, or where all count at most that. */
static void look_at_row(struct nearest *n, int64_t y, int64_t z, int64_t r, bool all)
{
    const struct grid *grid = &n->scene->grid;
    const int64_t down = y - n->mean[1], deep = z - n->mean[2];
    for (int64_t along = -r; along <= r; along += all || r == 0 ? 1 : 2 * r) {
        const int64_t x = n->mean[0] + along;
        if (x < 0 || x >= grid->size[0])
            continue;
        const int64_t squared = along * along + down * down + deep * deep;
        const uint32_t cell = grid_cell(grid, (uint32_t)x, (uint32_t)y, (uint32_t)z);
        if (squared > n->squared || (squared == n->squared && cell > n->cell) ||
            !has_label(n->scene->cell + cell, n->label))
            continue;
        n->squared = squared;
        n->cell = cell;
    }
}

/* The voxels whose largest distance along an axis is `r`. */
static void look_at_shell(struct nearest *n, int64_t r)
{
    const uint32_t *size = n->scene->grid.size;
    for (int64_t z = n->mean[2] - r; z <= n->mean[2] + r; z++)
        for (int64_t y = n->mean[1] - r; y <= n->mean[1] + r; y++)
            if (z >= 0 && z < size[2] && y >= 0 && y < size[1])
                look_at_row(n, y, z, r, llabs(z - n->mean[2]) == r || llabs(y - n->mean[1]) == r);
}

bool centre_of_label(const struct scene *scene, unsigned label, uint32_t place[3])
{
    struct nearest n = {.scene = scene, .label = label, .squared = INT64_MAX};
    if (!find_mean(scene, label, n.mean))
        return false;
    struct task task = task_begin(scene->watch, "the centre of a label", 0);
    for (int64_t r = 0; r * r <= n.squared; r++) {
        if (!task_advance(&task, (uint64_t)(24 * r * r + 2)))
            return false;
        look_at_shell(&n, r);
    }
    const struct place at = grid_place(&scene->grid, n.cell);
    place[0] = at.x;
    place[1] = at.y;
    place[2] = at.z;
    return true;
}
