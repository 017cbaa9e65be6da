#include "engine/weight.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "base/mem.h"
#include "engine/morph.h"

bool weight_choice_equals(const struct weight_choice *a, const struct weight_choice *b)
{
    return a->kind == b->kind && a->radius == b->radius &&
           a->sigma_thousandths == b->sigma_thousandths;
}

enum arc_kind weight_arcs(enum weight_kind kind)
{
    return kind == WEIGHT_DIFFERENCE ? ARC_DIFFERENCE
           : kind == WEIGHT_POLARITY ? ARC_POLARITY
                                     : ARC_TARGET;
}

bool weight_is_gradient(enum weight_kind kind)
{
    return kind <= WEIGHT_GAUSS;
}

/* ---- morph ---- */

void weight_morph(struct scene *scene, const struct adjacency *adjacency)
{
    morph_weigh(scene, adjacency, grid_slab(&scene->grid, 0, 1));
}

/*
 * A wider one, row by row. What R steps reach is, in each row of voxels nearby, an interval about
 * this voxel: of half-length R - |dy| - |dz| by faces, of R by corners too. Rows of equal
 * half-length are merged voxel by voxel into lane[half-length]; then lane R is widened by one voxel
 * and merged with lane R - 1, and so on down to lane 0. (Inside a box, steps need no detour.) The
 * erosion is the dilation of 65535 - intensity.
 */
struct lanes {
    size_t width;
    uint16_t *high, *low; /* [radius + 1][width]; nothing merged yet is 0 */
};

static uint64_t lanes_bytes(const struct grid *grid, uint32_t radius)
{
    return 2 * ((uint64_t)radius + 1) * grid->size[0] * sizeof(uint16_t);
}

static uint16_t larger(uint16_t a, uint16_t b)
{
    return a > b ? a : b;
}

static void merge_row(struct lanes *lanes, uint32_t lane, const struct cell *cell)
{
    uint16_t *high = lanes->high + lane * lanes->width, *low = lanes->low + lane * lanes->width;
    for (size_t x = 0; x < lanes->width; x++) {
        high[x] = larger(high[x], cell[x].intensity);
        low[x] = larger(low[x], (uint16_t)(65535 - cell[x].intensity));
    }
}

/* inner[x] = max(inner[x], outer[x - 1], outer[x], outer[x + 1]) */
static void widen_into(uint16_t *inner, const uint16_t *outer, size_t width)
{
    for (size_t x = 0; x < width; x++) {
        const uint16_t left = outer[x > 0 ? x - 1 : x], right = outer[x + 1 < width ? x + 1 : x];
        inner[x] = larger(larger(inner[x], outer[x]), larger(left, right));
    }
}

static void merge_around(struct lanes *lanes, const struct scene *scene, bool by_faces,
                         int32_t radius, uint32_t y, uint32_t z)
{
    for (int32_t dz = -radius; dz <= radius; dz++)
        for (int32_t dy = -radius; dy <= radius; dy++) {
            const int64_t at[2] = {(int64_t)y + dy, (int64_t)z + dz};
            const int32_t reach = by_faces ? radius - abs(dy) - abs(dz) : radius;
            if (reach < 0 || !grid_contains(&scene->grid, 0, at[0], at[1]))
                continue;
            const struct span row = grid_row(&scene->grid, (uint32_t)at[0], (uint32_t)at[1]);
            merge_row(lanes, (uint32_t)reach, scene->cell + row.first);
        }
}

static void morph_wide(struct scene *scene, const struct adjacency *adjacency, uint32_t radius,
                       struct slab slab, void *work)
{
    const struct grid *grid = &scene->grid;
    const size_t width = grid->size[0], lane_values = (radius + 1) * width;
    struct lanes lanes = {width, work, (uint16_t *)work + lane_values};
    struct task task =
        task_begin_part(scene->watch, "weights", slab_voxels(grid, slab), slab.first);
    for (uint32_t z = slab.first; z < slab.end; z++)
        for (uint32_t y = 0; y < grid->size[1]; y++) {
            memset(work, 0, 2 * lane_values * sizeof(uint16_t));
            merge_around(&lanes, scene, adjacency->count == 6, (int32_t)radius, y, z);
            for (size_t lane = radius; lane > 0; lane--) {
                const size_t outer = lane * width, inner = outer - width;
                widen_into(lanes.high + inner, lanes.high + outer, width);
                widen_into(lanes.low + inner, lanes.low + outer, width);
            }
            struct cell *cell = scene->cell + grid_row(grid, y, z).first;
            for (size_t x = 0; x < width; x++)
                cell[x].weight = (uint16_t)(lanes.high[x] + lanes.low[x] - 65535);
            if (!task_advance(&task, width))
                return;
        }
}

/* ---- any ---- */

void weight_work_release(struct weight_work *work)
{
    free(work->bytes);
    *work = (struct weight_work){0};
}

static uint64_t bytes_for(const struct grid *grid, const struct weight_choice *choice)
{
    switch (choice->kind) {
    case WEIGHT_MORPH:
        return choice->radius > 1 ? lanes_bytes(grid, choice->radius) : 0;
    case WEIGHT_SOBEL:
        return sobel_bytes(grid);
    case WEIGHT_GAUSS:
        return gauss_bytes(grid, choice->sigma_thousandths);
    case WEIGHT_DIFFERENCE:
    case WEIGHT_POLARITY:
    case WEIGHT_FILE:
        break;
    }
    return 0;
}

/* Room for each part begins on a line of the cache of its own. */
static uint64_t bytes_for_part(const struct grid *grid, const struct weight_choice *choice)
{
    return (bytes_for(grid, choice) + 63) / 64 * 64;
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
    switch (w->choice->kind) {
    case WEIGHT_MORPH:
        if (w->choice->radius > 1)
            morph_wide(w->scene, w->adjacency, w->choice->radius, slab, bytes);
        else
            morph_weigh(w->scene, w->adjacency, slab);
        break;
    case WEIGHT_SOBEL:
        sobel_weigh(w->scene, slab, bytes);
        break;
    case WEIGHT_GAUSS:
        gauss_weigh(w->scene, w->choice->sigma_thousandths, slab, bytes);
        break;
    case WEIGHT_DIFFERENCE:
    case WEIGHT_POLARITY:
    case WEIGHT_FILE:
        break;
    }
}

void weight_compute(struct scene *scene, const struct adjacency *adjacency,
                    const struct weight_choice *choice, struct weight_work *work)
{
    struct weighing weighing = {scene, adjacency, choice, work};
    assert(bytes_for_part(&scene->grid, choice) * team_size(work->team) <= work->capacity);
    if (weight_is_gradient(choice->kind))
        team_run(work->team, weigh_part, &weighing);
}

/* ---- digest ---- */

static uint64_t rule_digest(const struct arc_rule *arcs)
{
    uint64_t sum = hash_mix_at(0, arcs->kind);
    for (uint32_t label = 0; arcs->kind == ARC_POLARITY && label < 256; label++)
        sum += hash_mix_at(1 + label, (uint64_t)(POLARITY_MOST + arcs->polarity[label]));
    return sum;
}

struct summing {
    const struct scene *scene;
    struct team *team;
    uint64_t sum[TEAM_MOST];
};

static void sum_part(void *context, unsigned worker)
{
    struct summing *s = context;
    const struct grid *grid = &s->scene->grid;
    const struct slab slab = grid_slab(grid, worker, team_size(s->team));
    uint64_t sum = 0, voxel = (uint64_t)slab.first * grid->size[1] * grid->size[0];
    struct task task = task_begin_part(s->scene->watch, "digest of the weights",
                                       slab_voxels(grid, slab), slab.first);
    for (uint32_t z = slab.first; z < slab.end; z++)
        for (uint32_t y = 0; y < grid->size[1]; y++) {
            struct span row = grid_row(grid, y, z);
            for (uint32_t c = row.first; c < row.end; c++) {
                scene_fetch_ahead(s->scene, c);
                sum += hash_mix(voxel++ << 16 | s->scene->cell[c].weight);
            }
            if (!task_advance(&task, grid->size[0]))
                return;
        }
    s->sum[worker] = sum;
}

uint64_t weight_digest(const struct scene *scene, const struct arc_rule *arcs, struct team *team)
{
    struct summing summing = {.scene = scene, .team = team};
    uint64_t sum = 0;
    if (arcs->kind != ARC_TARGET)
        return rule_digest(arcs);
    team_run(team, sum_part, &summing);
    for (unsigned worker = 0; worker < team_size(team); worker++)
        sum += summing.sum[worker];
    return sum;
}
