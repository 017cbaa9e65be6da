/* SPDX-License-Identifier: MIT */
#include "engine/hints.h"

#include <stdlib.h>

#include "base/mem.h"
#include "base/sort.h"
#include "engine/margin.h"

/* A voxel at the border. */
struct edge_voxel {
    uint32_t cell;
    int32_t certainty;
    uint16_t margin, edge;
    uint8_t label, other;
};

struct finding {
    const struct forest *forest;
    const struct scene *scene;
    const struct arc_rule *arcs;
    const uint16_t *margin;
    struct adjacency faces, corners;
    struct edge_voxel *voxel; /* all at the border; later the weak ones, sorted by cell */
    size_t count, capacity;
    int32_t limit[HINT_HEATS];
    uint32_t *place; /* numbers of weak voxels of the current place */
    size_t placed, place_capacity;
    bool *taken; /* [count]: belongs to a place already */
};

/* ---- the border ---- */

/* The neighbour with another label that makes the best offer to a voxel; the first of several.
 * CELL_NONE if there is no such neighbour. */
static uint32_t find_other(const struct finding *f, uint32_t at)
{
    const struct cell *cell = f->scene->cell + at;
    uint32_t least = UINT32_MAX, found = CELL_NONE;
    for (int i = 0; i < 6; i++) {
        const struct cell *from = cell + f->faces.offset[i];
        if (from->label == cell->label || !cell_is_reached(from))
            continue;
        const uint32_t weight = arc_weight_now(f->arcs, from, cell), has = key_cost(from->key);
        const uint32_t cost = weight > has ? weight : has;
        if (cost >= least)
            continue;
        least = cost;
        found = at + (uint32_t)f->faces.offset[i];
    }
    return found;
}

static uint32_t cost_before(const struct finding *f, uint32_t at)
{
    for (int i = 0; i < HINT_BACK; i++) {
        const uint32_t before = forest_predecessor(f->forest, at);
        at = before == CELL_NONE ? at : before;
    }
    return key_cost(f->scene->cell[at].key);
}

static bool add_row(struct finding *f, struct span row)
{
    for (uint32_t c = row.first; c < row.end; c++) {
        scene_fetch_ahead(f->scene, c);
        const uint32_t other = f->margin[c] == MARGIN_NONE ? CELL_NONE : find_other(f, c);
        if (other == CELL_NONE)
            continue;
        if (!mem_grow(&f->voxel, &f->capacity, f->count + 1, sizeof *f->voxel))
            return false;
        const struct cell *cell = f->scene->cell;
        const uint32_t to = arc_weight_now(f->arcs, cell + other, cell + c);
        const uint32_t from = arc_weight_now(f->arcs, cell + c, cell + other);
        const uint32_t edge = to > from ? to : from, before = cost_before(f, c);
        f->voxel[f->count++] =
            (struct edge_voxel){.cell = c,
                                .certainty = f->margin[c] + (int32_t)edge - (int32_t)before,
                                .margin = f->margin[c],
                                .edge = (uint16_t)edge,
                                .label = cell[c].label,
                                .other = cell[other].label};
    }
    return true;
}

/* ---- weak voxels ---- */

enum { CERTAINTIES = 3 * MARGIN_NONE };

static enum err find_limits(struct finding *f, struct fault *fault)
{
    static const size_t share[HINT_HEATS] = {HINT_SHARE, HINT_WARM};
    OWNED(mem_release) size_t *voxels = mem_new(CERTAINTIES * sizeof *voxels);
    if (!voxels)
        return fault_memory(fault, "the border");
    for (size_t i = 0; i < f->count; i++)
        voxels[f->voxel[i].certainty + MARGIN_NONE]++;
    for (int i = 0; f->count && i < HINT_HEATS; i++) {
        /* The least certainty that at least one voxel in share[i] does not exceed. */
        int32_t limit = -MARGIN_NONE;
        for (size_t below = voxels[0]; below * share[i] < f->count;
             below += voxels[limit + MARGIN_NONE])
            limit++;
        f->limit[i] = limit;
    }
    return OK;
}

/* ---- places ---- */

static bool in_same_block(const struct grid *grid, uint32_t a, uint32_t b)
{
    const struct place p = grid_place(grid, a), q = grid_place(grid, b);
    return p.x / HINT_BLOCK == q.x / HINT_BLOCK && p.y / HINT_BLOCK == q.y / HINT_BLOCK &&
           p.z / HINT_BLOCK == q.z / HINT_BLOCK;
}

/* Add a weak voxel to the current place. */
static bool take_voxel(struct finding *f, size_t number)
{
    if (!mem_grow(&f->place, &f->place_capacity, f->placed + 1, sizeof *f->place))
        return false;
    f->taken[number] = true;
    f->place[f->placed++] = (uint32_t)number;
    return true;
}

static bool grow_place(struct finding *f, size_t first)
{
    const struct grid *grid = &f->scene->grid;
    const struct edge_voxel *begin = f->voxel + first;
    f->placed = 0;
    if (!take_voxel(f, first))
        return false;
    for (size_t next = 0; next < f->placed; next++) {
        const struct edge_voxel *here = f->voxel + f->place[next];
        for (int i = 0; i < 26; i++) {
            const struct edge_voxel sought = {.cell = here->cell + (uint32_t)f->corners.offset[i]};
            const struct edge_voxel *beside =
                bsearch(&sought, f->voxel, f->count, sizeof sought, sort_compare_32);
            if (beside && !f->taken[beside - f->voxel] &&
                ((beside->label == begin->label && beside->other == begin->other) ||
                 (beside->label == begin->other && beside->other == begin->label)) &&
                in_same_block(grid, beside->cell, begin->cell) &&
                !take_voxel(f, (size_t)(beside - f->voxel)))
                return false;
        }
    }
    return true;
}

/* Make the hint of the current place. */
static struct hint make_hint(const struct finding *f)
{
    struct hint hint = {.voxels = (uint32_t)f->placed, .cell = CELL_NONE};
    int64_t middle[3] = {0}, nearest = 0;
    for (size_t i = 0; i < f->placed; i++) {
        const struct place p = grid_place(&f->scene->grid, f->voxel[f->place[i]].cell);
        middle[0] += p.x;
        middle[1] += p.y;
        middle[2] += p.z;
    }
    for (int a = 0; a < 3; a++)
        middle[a] /= (int64_t)f->placed;
    for (size_t i = 0; i < f->placed; i++) {
        const struct edge_voxel *v = f->voxel + f->place[i];
        const struct place p = grid_place(&f->scene->grid, v->cell);
        const int64_t x = p.x - middle[0], y = p.y - middle[1], z = p.z - middle[2];
        const int64_t far = x * x + y * y + z * z;
        hint.doubt += (uint64_t)(f->limit[0] - v->certainty) + 1;
        if (hint.cell != CELL_NONE &&
            (v->certainty > hint.certainty || (v->certainty == hint.certainty && far >= nearest)))
            continue;
        hint.cell = v->cell;
        hint.certainty = v->certainty;
        hint.margin = v->margin;
        hint.edge = v->edge;
        hint.label = v->label;
        hint.other = v->other;
        nearest = far;
    }
    return hint;
}

static int compare_hints(const void *a, const void *b)
{
    const struct hint *x = a, *y = b;
    if (x->doubt != y->doubt)
        return x->doubt < y->doubt ? 1 : -1;
    return (x->cell > y->cell) - (x->cell < y->cell);
}

static enum err find_places(struct hint_list *hints, struct finding *f, struct fault *fault)
{
    struct task task = task_begin(f->scene->watch, "places", f->count);
    f->taken = mem_new(f->count + 1);
    if (!f->taken)
        return fault_memory(fault, "the border");
    for (size_t i = 0; i < f->count; i++) {
        if (!task_advance(&task, 1))
            return watch_fault(f->scene->watch, fault);
        if (f->taken[i])
            continue;
        if (!grow_place(f, i) ||
            !mem_grow(&hints->item, &hints->capacity, hints->count + 1, sizeof *hints->item))
            return fault_memory(fault, "the border");
        hints->item[hints->count++] = make_hint(f);
    }
    if (hints->count)
        qsort(hints->item, hints->count, sizeof *hints->item, compare_hints);
    hints->count = hints->count < HINTS_MOST ? hints->count : HINTS_MOST;
    return OK;
}

enum err hints_find(struct hint_list *hints, const struct forest *forest, const uint16_t *margin,
                    uint8_t *heat, struct fault *fault)
{
    const struct scene *scene = forest_scene(forest);
    struct finding f = {
        .forest = forest, .scene = scene, .arcs = forest_arcs(forest), .margin = margin};
    adjacency_init(&f.faces, 6, &scene->grid);
    adjacency_init(&f.corners, 26, &scene->grid);
    hints->count = 0;
    struct grid_walk w = scene_walk(scene, "borders of labels", NULL, 0);
    bool fits = true;
    while (fits && grid_walk_next(&w))
        fits = add_row(&f, w.row);
    enum err err = fits ? watch_fault(scene->watch, fault) : fault_memory(fault, "the border");
    if (!err)
        err = find_limits(&f, fault);
    for (size_t i = 0; heat && !err && i < f.count; i++) {
        const struct edge_voxel *voxel = f.voxel + i;
        const struct cell *cell = f.scene->cell;
        uint8_t degree = 0;
        for (int k = 0; k < HINT_HEATS; k++)
            degree = (uint8_t)(degree + (voxel->certainty <= f.limit[k]));
        heat[voxel->cell] = degree > heat[voxel->cell] ? degree : heat[voxel->cell];
        for (int k = 0; k < 26; k++) {
            const uint32_t at = voxel->cell + (uint32_t)f.corners.offset[k];
            if (cell_is_reached(cell + at) && cell[at].label == voxel->label && degree > heat[at])
                heat[at] = degree;
        }
    }
    hints->border = f.count;
    f.count = 0;
    for (size_t i = 0; i < hints->border; i++)
        if (f.voxel[i].certainty <= f.limit[0])
            f.voxel[f.count++] = f.voxel[i];
    hints->weak = f.count;
    hints->limit = f.limit[0];
    if (!err)
        err = find_places(hints, &f, fault);
    if (err)
        hints->count = 0;
    free(f.voxel);
    free(f.place);
    free(f.taken);
    return err;
}

void hints_release(struct hint_list *hints)
{
    free(hints->item);
    *hints = (struct hint_list){0};
}
