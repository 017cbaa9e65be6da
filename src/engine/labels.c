/* SPDX-License-Identifier: MIT */
#include "engine/labels.h"

#include <string.h>

void labels_copy_row(const struct labels *labels, struct span row, uint8_t *out)
{
    if (labels->finished) {
        memcpy(out, labels->finished + row.first, row.end - row.first);
        return;
    }
    for (uint32_t c = row.first; c < row.end; c++) {
        scene_fetch_ahead(labels->scene, c);
        *out++ = labels->scene->cell[c].label;
    }
}

/* ---- the whole scene ---- */

struct work {
    const struct labels *labels;
    struct team *team;
    uint8_t *out;
    uint64_t sum[TEAM_MOST];
};

/* Copy planes of cells including the rim, so that all of `out` is written. */
static void copy_part(void *context, unsigned worker)
{
    const struct work *work = context;
    const struct scene *scene = work->labels->scene;
    const size_t plane = (size_t)scene->grid.step[2];
    const struct share share = team_share(work->team, worker, scene->grid.cells / plane);
    struct task task =
        task_begin_part(scene->watch, "labels", (share.end - share.first) * plane, worker);
    for (size_t p = share.first; p < share.end; p++) {
        const struct span cells = {(uint32_t)(p * plane), (uint32_t)((p + 1) * plane)};
        labels_copy_row(work->labels, cells, work->out + cells.first);
        if (!task_advance(&task, plane))
            return;
    }
}

void labels_copy(const struct labels *labels, uint8_t *out, struct team *team)
{
    struct work work = {.labels = labels, .team = team, .out = out};
    team_run(team, copy_part, &work);
}

static void digest_part(void *context, unsigned worker)
{
    struct work *work = context;
    struct grid_walk w =
        scene_walk(work->labels->scene, "digest of the labels", work->team, worker);
    uint64_t sum = 0;
    while (grid_walk_next(&w))
        for (uint32_t c = w.row.first; c < w.row.end; c++) {
            const uint8_t label = labels_at(work->labels, c);
            sum += label ? label_share(c, label) : 0;
        }
    work->sum[worker] = sum;
}

uint64_t labels_digest(const struct labels *labels, struct team *team)
{
    struct work work = {.labels = labels, .team = team};
    uint64_t sum = 0;
    team_run(team, digest_part, &work);
    for (unsigned worker = 0; worker < team_size(team); worker++)
        sum += work.sum[worker];
    return sum;
}

void overlap_add(struct overlap *overlap, const uint8_t *a, const uint8_t *b, size_t voxels)
{
    overlap->voxels += voxels;
    for (size_t i = 0; i < voxels; i++) {
        overlap->a[a[i]]++;
        overlap->b[b[i]]++;
        overlap->both[a[i]] += a[i] == b[i];
        overlap->differing += a[i] != b[i];
    }
}

unsigned overlap_dice(const struct overlap *overlap, uint8_t label)
{
    const uint64_t sum = overlap->a[label] + overlap->b[label];
    const uint64_t common = 2 * overlap->both[label];
    return sum ? (unsigned)((2 * common * DICE_ONE + sum) / (2 * sum)) : DICE_ONE;
}

struct overlap_counts overlap_counts_of(const struct overlap *overlap, unsigned label)
{
    struct overlap_counts sum = {0};
    for (unsigned l = label ? label : 1; l < 256 && (l == label || !label); l++) {
        sum.a += overlap->a[l];
        sum.b += overlap->b[l];
        sum.both += overlap->both[l];
    }
    return sum;
}
