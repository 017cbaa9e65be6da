/* SPDX-License-Identifier: MIT */
#include "engine/measure.h"

#include <stdlib.h>

/* The search around a place for the nearest voxel of a label that satisfies `counts`. */
struct search {
    const struct scene *scene;
    int64_t at[3], least[3], most[3]; /* the place; steps that lead to voxels within the limits */
    uint32_t unit[3];                 /* length of a step */
    unsigned label;
    bool (*counts)(const struct scene *scene, uint32_t cell);
    uint32_t cell;    /* the nearest one so far, */
    uint64_t squared; /* and its squared distance; UINT64_MAX for none */
};

static void try_voxel(struct search *s, const int64_t step[3], uint64_t row_squared)
{
    if (step[0] < s->least[0] || step[0] > s->most[0])
        return;
    const uint32_t cell = grid_cell(&s->scene->grid, (uint32_t)(s->at[0] + step[0]),
                                    (uint32_t)(s->at[1] + step[1]), (uint32_t)(s->at[2] + step[2]));
    const uint64_t along = (uint64_t)llabs(step[0]) * s->unit[0];
    const uint64_t squared = row_squared + along * along;
    if (s->scene->cell[cell].label != s->label || squared > s->squared ||
        (squared == s->squared && s->cell < cell) || !s->counts(s->scene, cell))
        return;
    s->cell = cell;
    s->squared = squared;
}

/* False if the watch has stopped it. */
static bool search_nearest(struct search *s, const char *what)
{
    uint64_t finest = s->unit[0];
    int64_t shells = 0;
    for (int a = 0; a < 3; a++) {
        finest = s->unit[a] < finest ? s->unit[a] : finest;
        shells = s->most[a] > shells ? s->most[a] : shells;
        shells = -s->least[a] > shells ? -s->least[a] : shells;
    }
    struct task task = task_begin(s->scene->watch, what, 0);
    s->squared = UINT64_MAX;
    for (int64_t r = 0; r <= shells; r++) {
        const uint64_t far = (uint64_t)r * finest; /* least distance of a voxel in this shell */
        if (far * far > s->squared)
            break;
        if (!task_advance(&task, (uint64_t)(24 * r * r + 2)))
            return false;
        /* All voxels whose largest step along an axis is `r`. */
        int64_t step[3];
        for (step[2] = -r; step[2] <= r; step[2]++)
            for (step[1] = -r; step[1] <= r; step[1]++) {
                if (step[2] < s->least[2] || step[2] > s->most[2] || step[1] < s->least[1] ||
                    step[1] > s->most[1])
                    continue;
                const uint64_t down = (uint64_t)llabs(step[1]) * s->unit[1];
                const uint64_t deep = (uint64_t)llabs(step[2]) * s->unit[2];
                const uint64_t row = down * down + deep * deep;
                const bool on_face = llabs(step[1]) == r || llabs(step[2]) == r;
                if (row > s->squared)
                    continue;
                for (step[0] = -r; step[0] <= r; step[0] += on_face ? 1 : 2 * r)
                    try_voxel(s, step, row);
            }
    }
    return true;
}

/* ---- the border ---- */

static bool is_on_border(const struct scene *scene, uint32_t cell)
{
    const struct cell *at = scene->cell + cell;
    for (int a = 0; a < 3; a++)
        if (at[scene->grid.step[a]].label != at->label ||
            at[-scene->grid.step[a]].label != at->label)
            return true;
    return false;
}

struct border_distance measure_border_distance(const struct scene *scene, uint32_t cell)
{
    const struct place p = grid_place(&scene->grid, cell);
    struct search s = {.scene = scene,
                       .at = {p.x, p.y, p.z},
                       .label = scene->cell[cell].label,
                       .counts = is_on_border};
    uint64_t reach_nm = UINT64_MAX;
    for (int a = 0; a < 3; a++) {
        const int64_t nm = scene->spacing_nm[a], end = (int64_t)scene->grid.size[a] - 1;
        const int64_t far =
            MEASURE_REACH_NM / nm < MEASURE_STEPS ? MEASURE_REACH_NM / nm : MEASURE_STEPS;
        s.unit[a] = scene->spacing_nm[a];
        s.least[a] = s.at[a] < far ? -s.at[a] : -far;
        s.most[a] = end - s.at[a] < far ? end - s.at[a] : far;
        const bool whole = s.at[a] <= far && end - s.at[a] <= far;
        if (!whole && (uint64_t)(far * nm) < reach_nm)
            reach_nm = (uint64_t)(far * nm);
    }
    search_nearest(&s, "distance to the border");
    const bool found =
        s.squared != UINT64_MAX && (reach_nm == UINT64_MAX || s.squared <= reach_nm * reach_nm);
    return (struct border_distance){found, s.cell, s.squared, reach_nm};
}

/* ---- the centre ---- */

static bool is_reached(const struct scene *scene, uint32_t cell)
{
    return cell_is_reached(scene->cell + cell);
}

bool centre_of_label(const struct scene *scene, unsigned label, uint32_t place[3])
{
    struct search s = {.scene = scene, .unit = {1, 1, 1}, .label = label, .counts = is_reached};
    uint64_t voxels = 0, sum[3] = {0};
    for (struct grid_walk w = scene_walk(scene, "the centre of a label", NULL, 0);
         grid_walk_next(&w);)
        for (uint32_t c = w.row.first; c < w.row.end; c++)
            if (scene->cell[c].label == label && is_reached(scene, c)) {
                voxels++;
                sum[0] += c - w.row.first;
                sum[1] += w.y;
                sum[2] += w.z;
            }
    if (voxels == 0 || watch_stops(scene->watch))
        return false;
    for (int a = 0; a < 3; a++) {
        s.at[a] = (int64_t)(sum[a] / voxels);
        s.least[a] = -s.at[a];
        s.most[a] = (int64_t)scene->grid.size[a] - 1 - s.at[a];
    }
    if (!search_nearest(&s, "the centre of a label"))
        return false;
    grid_find(&scene->grid, s.cell, place);
    return true;
}
