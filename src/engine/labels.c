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

struct walk {
    const struct labels *labels;
    struct team *team;
    uint8_t *out;
    uint64_t sum[TEAM_MOST];
};

/* Planes of cells, the rim's among them, so that all of `out` is written. */
static void copy_part(void *context, unsigned worker)
{
    const struct walk *walk = context;
    const struct scene *scene = walk->labels->scene;
    const size_t plane = (size_t)scene->grid.step[2];
    const struct share share = team_share(walk->team, worker, scene->grid.cells / plane);
    struct task task =
        task_begin_part(scene->watch, "labels", (share.end - share.first) * plane, worker);
    for (size_t p = share.first; p < share.end; p++) {
        const struct span cells = {(uint32_t)(p * plane), (uint32_t)((p + 1) * plane)};
        labels_copy_row(walk->labels, cells, walk->out + cells.first);
        if (!task_advance(&task, plane))
            return;
    }
}

void labels_copy(const struct labels *labels, uint8_t *out, struct team *team)
{
    struct walk walk = {.labels = labels, .team = team, .out = out};
    team_run(team, copy_part, &walk);
}

static void digest_part(void *context, unsigned worker)
{
    struct walk *walk = context;
    const struct scene *scene = walk->labels->scene;
    const struct grid *grid = &scene->grid;
    const struct slab slab = grid_slab(grid, worker, team_size(walk->team));
    uint64_t sum = 0;
    struct task task =
        task_begin_part(scene->watch, "digest of the labels", slab_voxels(grid, slab), worker);
    for (uint32_t z = slab.first; z < slab.end; z++)
        for (uint32_t y = 0; y < grid->size[1]; y++) {
            const struct span row = grid_row(grid, y, z);
            for (uint32_t c = row.first; c < row.end; c++) {
                const uint8_t label = labels_at(walk->labels, c);
                sum += label ? label_share(c, label) : 0;
            }
            if (!task_advance(&task, grid->size[0]))
                return;
        }
    walk->sum[worker] = sum;
}

uint64_t labels_digest(const struct labels *labels, struct team *team)
{
    struct walk walk = {.labels = labels, .team = team};
    uint64_t sum = 0;
    team_run(team, digest_part, &walk);
    for (unsigned worker = 0; worker < team_size(team); worker++)
        sum += walk.sum[worker];
    return sum;
}

void overlap_count(struct overlap *overlap, const uint8_t *a, const uint8_t *b, size_t voxels)
{
    *overlap = (struct overlap){0};
    overlap_add(overlap, a, b, voxels);
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
