#include "engine/measure.h"

#include <stdlib.h>

/* The search around one voxel. */
struct search {
    const struct scene *scene;
    int64_t at[3], least[3], most[3]; /* of the voxel; steps that lead to voxels within reach */
    uint32_t from;                    /* its cell */
    uint8_t label;
    struct border_distance nearest;
};

static void search_init(struct search *s, const struct scene *scene, uint32_t cell)
{
    const struct place p = grid_place(&scene->grid, cell);
    *s = (struct search){.scene = scene,
                         .at = {p.x, p.y, p.z},
                         .from = cell,
                         .label = scene->cell[cell].label,
                         .nearest = {.squared = UINT64_MAX, .reach_nm = UINT64_MAX}};
    for (int a = 0; a < 3; a++) {
        const int64_t nm = scene->spacing_nm[a], end = (int64_t)scene->grid.size[a] - 1;
        const int64_t far =
            MEASURE_REACH_NM / nm < MEASURE_STEPS ? MEASURE_REACH_NM / nm : MEASURE_STEPS;
        s->least[a] = s->at[a] < far ? -s->at[a] : -far;
        s->most[a] = end - s->at[a] < far ? end - s->at[a] : far;
        const bool whole = s->at[a] <= far && end - s->at[a] <= far;
        const uint64_t reach = (uint64_t)(far * nm);
        if (!whole && reach < s->nearest.reach_nm)
            s->nearest.reach_nm = reach;
    }
}

static bool on_border(const struct search *s, uint32_t cell)
{
    const struct cell *at = s->scene->cell + cell;
    for (int a = 0; a < 3; a++)
        if (at[s->scene->grid.step[a]].label != s->label ||
            at[-s->scene->grid.step[a]].label != s->label)
            return true;
    return false;
}

static uint64_t squared_nm(const struct search *s, int a, int64_t steps)
{
    const uint64_t nm = (uint64_t)llabs(steps) * s->scene->spacing_nm[a];
    return nm * nm;
}

static void try_voxel(struct search *s, const int64_t step[3], uint64_t row_squared)
{
    if (step[0] < s->least[0] || step[0] > s->most[0])
        return;
    const ptrdiff_t *by = s->scene->grid.step;
    const uint32_t cell = (uint32_t)(s->from + step[0] * by[0] + step[1] * by[1] + step[2] * by[2]);
    const uint64_t squared = row_squared + squared_nm(s, 0, step[0]);
    struct border_distance *nearest = &s->nearest;
    if (s->scene->cell[cell].label != s->label || squared > nearest->squared ||
        (squared == nearest->squared && nearest->cell < cell) || !on_border(s, cell))
        return;
    nearest->cell = cell;
    nearest->squared = squared;
}

/* All voxels whose largest step along an axis is `r`. */
static void search_shell(struct search *s, int64_t r)
{
    int64_t step[3];
    for (step[2] = -r; step[2] <= r; step[2]++)
        for (step[1] = -r; step[1] <= r; step[1]++) {
            if (step[2] < s->least[2] || step[2] > s->most[2] || step[1] < s->least[1] ||
                step[1] > s->most[1])
                continue;
            const uint64_t row = squared_nm(s, 1, step[1]) + squared_nm(s, 2, step[2]);
            const bool on_face = llabs(step[1]) == r || llabs(step[2]) == r;
            if (row > s->nearest.squared)
                continue;
            for (step[0] = -r; step[0] <= r; step[0] += on_face ? 1 : 2 * r)
                try_voxel(s, step, row);
        }
}

struct border_distance measure_border_distance(const struct scene *scene, uint32_t cell)
{
    struct search s;
    search_init(&s, scene, cell);
    uint64_t finest = scene->spacing_nm[0];
    int64_t shells = 0;
    for (int a = 0; a < 3; a++) {
        finest = scene->spacing_nm[a] < finest ? scene->spacing_nm[a] : finest;
        shells = s.most[a] > shells ? s.most[a] : shells;
        shells = -s.least[a] > shells ? -s.least[a] : shells;
    }
    struct task task = task_begin(scene->watch, "distance to the border", 0);
    for (int64_t r = 0; r <= shells; r++) {
        const uint64_t nm = (uint64_t)r * finest; /* of a voxel in this shell, at the least */
        if (nm * nm > s.nearest.squared || !task_advance(&task, (uint64_t)(24 * r * r + 2)))
            break;
        search_shell(&s, r);
    }
    s.nearest.found = s.nearest.squared != UINT64_MAX &&
                      (s.nearest.reach_nm == UINT64_MAX ||
                       s.nearest.squared <= s.nearest.reach_nm * s.nearest.reach_nm);
    return s.nearest;
}
