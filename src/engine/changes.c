/* SPDX-License-Identifier: MIT */
#include "engine/changes.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

enum { VOXELS_A_CHANGE = 16 };

void change_log_add(struct change_log *log, const struct changes *changes, size_t voxels)
{
    const size_t count = log->count + changes->count;
    if (!log->follows)
        return;
    if (changes->everything || count > voxels / VOXELS_A_CHANGE ||
        !mem_grow(&log->item, &log->capacity, count, sizeof *log->item)) {
        change_log_give_up(log);
        return;
    }
    if (changes->count)
        memcpy(log->item + log->count, changes->item, changes->count * sizeof *log->item);
    log->count = count;
}

void change_log_give_up(struct change_log *log)
{
    log->follows = false;
    log->count = 0;
}

enum err change_log_settle(struct change_log *log, enum err err)
{
    log->follows = !err;
    log->count = 0;
    return err;
}

void change_log_release(struct change_log *log)
{
    free(log->item);
    *log = (struct change_log){0};
}

/* ---- labels of before all grows anew ---- */

static bool take_row(struct former_labels *former, const struct scene *scene, struct span row)
{
    for (uint32_t c = row.first; c < row.end; c++) {
        const struct cell *cell = scene->cell + c;
        const uint8_t label = cell->flags & CELL_TOUCHED ? cell->former_label : cell->label;
        scene_fetch_ahead(scene, c);
        if (former->count && former->run[former->count - 1].label == label) {
            former->run[former->count - 1].end = c + 1;
            continue;
        }
        if (!mem_grow(&former->run, &former->capacity, former->count + 1, sizeof *former->run))
            return false;
        former->run[former->count++] = (struct label_run){c + 1, label};
    }
    return true;
}

void former_labels_take(struct former_labels *former, const struct scene *scene)
{
    const struct grid *grid = &scene->grid;
    bool fits = true;
    struct task task = task_begin(scene->watch, "labels of before", grid->voxels);
    former->count = 0;
    for (uint32_t z = 0; fits && z < grid->size[2]; z++)
        for (uint32_t y = 0; fits && y < grid->size[1]; y++)
            fits =
                take_row(former, scene, grid_row(grid, y, z)) && task_advance(&task, grid->size[0]);
    former->taken = fits;
}

uint64_t former_labels_differences(const struct former_labels *former, const struct scene *scene)
{
    const struct grid *grid = &scene->grid;
    const struct label_run *run = former->run;
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

void former_labels_release(struct former_labels *former)
{
    free(former->run);
    *former = (struct former_labels){0};
}
