#include "engine/label_runs.h"

#include <stdlib.h>

#include "base/mem.h"

static uint8_t label_before(const struct cell *cell)
{
    return cell->flags & CELL_TOUCHED ? cell->former_label : cell->label;
}

static bool take_row(struct label_runs *runs, const struct scene *scene, struct span row)
{
    for (uint32_t c = row.first; c < row.end; c++) {
        const uint8_t label = label_before(scene->cell + c);
        scene_fetch_ahead(scene, c);
        if (runs->count && runs->run[runs->count - 1].label == label) {
            runs->run[runs->count - 1].end = c + 1;
            continue;
        }
        if (!mem_grow(&runs->run, &runs->capacity, runs->count + 1, sizeof *runs->run))
            return false;
        runs->run[runs->count++] = (struct label_run){c + 1, label};
    }
    return true;
}

void label_runs_take(struct label_runs *runs, const struct scene *scene)
{
    const struct grid *grid = &scene->grid;
    bool fits = true;
    struct task task = task_begin(scene->watch, "labels of before", grid->voxels);
    runs->count = 0;
    for (uint32_t z = 0; fits && z < grid->size[2]; z++)
        for (uint32_t y = 0; fits && y < grid->size[1]; y++)
            fits =
                take_row(runs, scene, grid_row(grid, y, z)) && task_advance(&task, grid->size[0]);
    runs->taken = fits;
}

uint64_t label_runs_differences(const struct label_runs *runs, const struct scene *scene)
{
    const struct grid *grid = &scene->grid;
    const struct label_run *run = runs->run;
    uint64_t differences = 0;
    struct task task = task_begin(scene->watch, "labels that changed", grid->voxels);
    for (uint32_t z = 0; z < grid->size[2]; z++)
        for (uint32_t y = 0; y < grid->size[1]; y++) {
            const struct span row = grid_row(grid, y, z);
            for (uint32_t c = row.first; c < row.end; c++) {
                scene_fetch_ahead(scene, c);
                run += c >= run->end;
                differences += scene->cell[c].label != run->label;
            }
            if (!task_advance(&task, grid->size[0]))
                return 0;
        }
    return differences;
}

void label_runs_release(struct label_runs *runs)
{
    free(runs->run);
    *runs = (struct label_runs){0};
}
