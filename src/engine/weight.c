/* SPDX-License-Identifier: MIT */
#include "engine/weight.h"

#include <assert.h>
#include <stdlib.h>

#include "base/hash.h"
#include "base/mem.h"

/* These depend on both ends of an arc (struct arc_rule); weights of a file are read, not
 * computed. */
const struct weight_method difference_weight = {.arcs = ARC_DIFFERENCE};
const struct weight_method polarity_weight = {.arcs = ARC_POLARITY};
static const struct weight_method file_weight = {.arcs = ARC_TARGET};

#define ROW(kind, name, argument, usual, help)                                                     \
    [WEIGHT_##kind] = {#name, WEIGHT_TAKES_##argument, usual, &name##_weight},
const struct weight_row weight_table[] = {
    WEIGHT_LIST(ROW, ROW)[WEIGHT_FILE] = {"FILE", WEIGHT_TAKES_NOTHING, 0, &file_weight},
};

enum arc_kind weight_arcs(enum weight_kind kind)
{
    return weight_table[kind].method->arcs;
}

/* ---- computing ---- */

void weight_work_release(struct weight_work *work)
{
    free(work->bytes);
    free(work->best);
    *work = (struct weight_work){0};
}

/* The memory of each part begins on its own cache line. */
static uint64_t bytes_for_part(const struct grid *grid, const struct weight_choice *choice)
{
    const struct weight_method *method = weight_table[choice->kind].method;
    return method->bytes ? (method->bytes(grid, choice->argument) + 63) / 64 * 64 : 0;
}

enum err weight_work_reserve(struct weight_work *work, const struct grid *grid,
                             const struct weight_choice *choice, struct fault *fault)
{
    const uint64_t needed = bytes_for_part(grid, choice) * team_size(work->team);
    if (needed <= work->capacity)
        return OK;
    void *bytes = needed <= SIZE_MAX ? mem_array((size_t)needed, 1) : NULL;
    if (!bytes)
        return fault_memory(fault, "weights");
    free(work->bytes);
    work->bytes = bytes;
    work->capacity = (size_t)needed;
    return OK;
}

struct weighing {
    struct scene *scene;
    const struct adjacency *adjacency;
    const struct weight_choice *choice;
    struct weight_work *work;
};

static void weigh_part(void *context, unsigned worker)
{
    const struct weighing *w = context;
    const struct slab slab = grid_slab(&w->scene->grid, worker, team_size(w->work->team));
    const size_t room = (size_t)bytes_for_part(&w->scene->grid, w->choice);
    void *bytes = room ? (char *)w->work->bytes + worker * room : NULL;
    if (slab.first == slab.end)
        return;
    weight_table[w->choice->kind].method->weigh(w->scene, w->adjacency, w->choice->argument, slab,
                                                bytes);
}

void weight_compute(struct scene *scene, const struct adjacency *adjacency,
                    const struct weight_choice *choice, struct weight_work *work)
{
    struct weighing weighing = {scene, adjacency, choice, work};
    assert(bytes_for_part(&scene->grid, choice) * team_size(work->team) <= work->capacity);
    if (!weight_table[choice->kind].method->weigh)
        return;
    team_run(work->team, weigh_part, &weighing);
    for (unsigned i = 0; scene->channels && i <= scene->channels; i++) {
        if (i) {
            scene_swap_channel(scene, i - 1, work->team);
            team_run(work->team, weigh_part, &weighing);
        }
        for (size_t c = 0; c < scene->grid.cells; c++) {
            const uint32_t scaled = scene->cell[c].weight * scene->percent / 100;
            const uint16_t weight = (uint16_t)(scaled < WEIGHT_MOST ? scaled : WEIGHT_MOST);
            work->best[c] = i && work->best[c] > weight ? work->best[c] : weight;
        }
        if (i)
            scene_swap_channel(scene, i - 1, work->team);
    }
    for (size_t c = 0; scene->channels && c < scene->grid.cells; c++)
        scene->cell[c].weight = work->best[c];
}

/* ---- digests ---- */

/* Sum over voxels of the weights in cells, or (`method`) of the weights of a plain scene. */
struct digesting {
    const struct scene *scene;
    const struct adjacency *adjacency;
    const struct weight_method *method;
    struct team *team;
    uint64_t sum[TEAM_MOST];
};

/* A scene_weigh_row. */
static void digest_plain_row(void *context, unsigned worker, uint32_t y, uint32_t z,
                             uint16_t *weight)
{
    struct digesting *d = context;
    const uint32_t *size = d->scene->grid.size;
    uint64_t sum = 0, voxel = ((uint64_t)z * size[1] + y) * size[0];
    d->method->weigh_row(weight, d->scene, d->adjacency, y, z);
    for (uint32_t x = 0; x < size[0]; x++)
        sum += hash_mix(voxel++ << 16 | weight[x]);
    d->sum[worker] += sum;
}

static void digest_slab(void *context, unsigned worker)
{
    struct digesting *d = context;
    const uint32_t *size = d->scene->grid.size;
    uint16_t weight[GRID_SIDE_MOST];
    struct grid_walk w =
        scene_walk(d->scene, d->method ? "weights" : "digest of the weights", d->team, worker);
    while (grid_walk_next(&w)) {
        if (d->method) {
            digest_plain_row(d, worker, w.y, w.z, weight);
            continue;
        }
        uint64_t sum = 0, voxel = ((uint64_t)w.z * size[1] + w.y) * size[0];
        for (uint32_t c = w.row.first; c < w.row.end; c++) {
            scene_fetch_ahead(d->scene, c);
            sum += hash_mix(voxel++ << 16 | d->scene->cell[c].weight);
        }
        d->sum[worker] += sum;
    }
}

static uint64_t sum_of(const struct digesting *d)
{
    uint64_t sum = 0;
    for (unsigned worker = 0; worker < team_size(d->team); worker++)
        sum += d->sum[worker];
    return sum;
}

uint64_t weight_digest(const struct scene *scene, const struct arc_rule *arcs, struct team *team)
{
    struct digesting digesting = {.scene = scene, .team = team};
    if (arcs->kind == ARC_TARGET) {
        team_run(team, digest_slab, &digesting);
        return sum_of(&digesting);
    }
    uint64_t sum = hash_mix_at(0, arcs->kind);
    for (uint32_t label = 0; arcs->kind == ARC_POLARITY && label < 256; label++)
        sum += hash_mix_at(1 + label, (uint64_t)(POLARITY_MOST + arcs->polarity[label]));
    return sum;
}

/* ---- plain scenes ---- */

bool weight_is_by_rows(const struct weight_choice *choice)
{
    const struct weight_method *method = weight_table[choice->kind].method;
    return method->weigh_row && choice->argument == method->row_argument;
}

uint64_t weight_plain_digest(const struct scene *scene, const struct adjacency *adjacency,
                             const struct weight_choice *choice, struct team *team)
{
    struct digesting d = {scene, adjacency, weight_table[choice->kind].method, team, {0}};
    team_run(team, digest_slab, &d);
    return sum_of(&d);
}

uint64_t weight_make_cells(struct scene *scene, const struct adjacency *adjacency,
                           const struct weight_choice *choice, struct team *team)
{
    struct digesting d = {scene, adjacency, weight_table[choice->kind].method, team, {0}};
    scene_make_cells(scene, team, digest_plain_row, &d);
    return sum_of(&d);
}
