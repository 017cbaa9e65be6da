/* SPDX-License-Identifier: MIT */
#include "session/tally.h"

#include <math.h>
#include <string.h>

struct tally tally_of_none(const struct scene *scene)
{
    return (struct tally){.voxels = {scene->grid.voxels}};
}

void tally_follow(struct tally *tally, const struct changes *changes, struct watch *watch)
{
    struct task task = task_begin(watch, "counting labels", changes->count);
    if (changes->everything) {
        tally_forget(tally);
        return;
    }
    memset(tally->gained, 0, sizeof tally->gained);
    memset(tally->lost, 0, sizeof tally->lost);
    for (size_t i = 0; i < changes->count && task_advance(&task, 1); i++) {
        tally->lost[changes->item[i].former_label]++;
        tally->gained[changes->item[i].label]++;
    }
    for (unsigned label = 0; label < 256; label++)
        tally->voxels[label] += tally->gained[label] - tally->lost[label];
    tally->knows_moves = true;
}

void tally_forget(struct tally *tally)
{
    tally->stale = true;
    tally->knows_moves = false;
}

/* ---- counting ---- */

struct counting {
    const struct labels *labels;
    struct team *team;
    uint64_t voxels[TEAM_MOST][256];
};

static void count_part(void *context, unsigned worker)
{
    struct counting *counting = context;
    const struct labels *labels = counting->labels;
    uint32_t count[4][256] = {{0}}; /* a scene has less than 2^32 cells */
    struct grid_walk w = scene_walk(labels->scene, "counting labels", counting->team, worker);
    while (grid_walk_next(&w))
        /* Neighbours mostly have the same label: four counters in turn avoid waiting for each
         * other. */
        for (uint32_t c = w.row.first; c < w.row.end; c++) {
            scene_fetch_ahead(labels->scene, c);
            count[c & 3][labels_at(labels, c)]++;
        }
    for (unsigned label = 0; label < 256; label++)
        for (unsigned i = 0; i < 4; i++)
            counting->voxels[worker][label] += count[i][label];
}

bool tally_refresh(struct tally *tally, const struct labels *labels, struct team *team)
{
    struct counting counting = {.labels = labels, .team = team};
    if (!tally->stale)
        return true;
    team_run(team, count_part, &counting);
    if (watch_stops(labels->scene->watch))
        return false;
    memset(tally->voxels, 0, sizeof tally->voxels);
    for (unsigned worker = 0; worker < team_size(team); worker++)
        for (unsigned label = 0; label < 256; label++)
            tally->voxels[label] += counting.voxels[worker][label];
    tally->stale = false;
    return true;
}

/* ---- volumes ---- */

void tally_write_volume(struct buf *out, const struct geometry *geometry, uint64_t voxels)
{
    static const struct {
        uint64_t least_um3, um3;
        const char *name;
    } unit[] = {
        {UINT64_C(1000000000000000), UINT64_C(1000000000000000), "l"},
        {UINT64_C(1000000000000), UINT64_C(1000000000000), "ml"},
        {10000000, 1000000000, "mm3"},
    };
    const uint32_t *nm = geometry->spacing_nm;
    /* To the nearest um3; 10^19 at most. */
    const double boxes = (double)voxels * nm[0] * nm[1] * nm[2] / 1e9;
    const double exact = floor(boxes * geometry_fill(geometry) + 0.5);
    const uint64_t um3 = exact < 1e19 ? (uint64_t)exact : UINT64_C(10000000000000000000);
    for (size_t i = 0; i < sizeof unit / sizeof *unit; i++)
        if (um3 >= unit[i].least_um3) {
            /* Three digits: hundredths below 10 of the unit, tenths below 100. */
            uint64_t step = unit[i].um3 / 100;
            while (step < unit[i].um3 && (um3 + step / 2) / step >= 1000)
                step *= 10;
            buf_printf(out, "%g", (double)((um3 + step / 2) / step) / (double)(unit[i].um3 / step));
            buf_printf(out, " %s", unit[i].name);
            return;
        }
    buf_printf(out, "%llu um3", (unsigned long long)um3);
}

double tally_voxel_mm3(const struct geometry *geometry)
{
    const uint32_t *nm = geometry->spacing_nm;
    return nm[0] / 1e6 * (nm[1] / 1e6) * (nm[2] / 1e6) * geometry_fill(geometry);
}
