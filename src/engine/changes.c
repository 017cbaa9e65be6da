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

/* ---- labels before a rebuild ---- */

void former_labels_take(struct former_labels *former, const struct scene *scene)
{
    struct grid_walk w = scene_walk(scene, "labels of before", NULL, 0);
    bool fits = true;
    former->count = 0;
    while (fits && grid_walk_next(&w))
        for (uint32_t c = w.row.first; fits && c < w.row.end; c++) {
            const struct cell *cell = scene->cell + c;
            const uint8_t label = cell->flags & CELL_TOUCHED ? cell->former_label : cell->label;
            scene_fetch_ahead(scene, c);
            if (former->count && former->run[former->count - 1].label == label) {
                former->run[former->count - 1].end = c + 1;
                continue;
            }
            fits =
                mem_grow(&former->run, &former->capacity, former->count + 1, sizeof *former->run);
            if (fits)
                former->run[former->count++] = (struct label_run){c + 1, label};
        }
    former->taken = fits && !(scene->watch && scene->watch->stopped);
}

uint64_t former_labels_differences(const struct former_labels *former, const struct scene *scene)
{
    const struct label_run *run = former->run;
    uint64_t differences = 0;
    for (struct grid_walk w = scene_walk(scene, "labels that changed", NULL, 0);
         grid_walk_next(&w);)
        for (uint32_t c = w.row.first; c < w.row.end; c++) {
            scene_fetch_ahead(scene, c);
            run += c >= run->end;
            differences += scene->cell[c].label != run->label;
        }
    return differences;
}

void former_labels_release(struct former_labels *former)
{
    free(former->run);
    *former = (struct former_labels){0};
}
