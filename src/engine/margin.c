/* SPDX-License-Identifier: MIT */
#include "engine/margin.h"

#include <stdlib.h>

#include "base/mem.h"
#include "engine/queue.h"

/* Costs are served one after another, from the lowest up; serving a cost adds cells to it and to
 * higher ones. */
struct search {
    const struct scene *scene;
    const struct adjacency *adjacency;
    const struct arc_rule *arcs;
    struct queue *queue;
    uint32_t *level; /* cells of the cost being served, in the order in which they were found */
    size_t count, capacity;
    bool starved;
    uint32_t enough; /* costs from here on are not served */

    uint16_t
        *cost; /* for margins, [grid.cells]: of the best path from another label, or MARGIN_NONE */
    uint32_t *after; /* for a rival, [grid.cells]: 1 plus the greatest weight from there on; or 0 */
    struct rival *rival;
    uint8_t label; /* the label whose rival is searched */
};

/* Start a search. Without memory for a queue it is starved. */
static struct search search_begin(const struct forest *forest)
{
    const struct scene *scene = forest_scene(forest);
    struct queue *queue = queue_new(0);
    return (struct search){.scene = scene,
                           .adjacency = forest_adjacency(forest),
                           .arcs = forest_arcs(forest),
                           .queue = queue,
                           .starved = !queue,
                           .enough = UINT32_MAX};
}

static enum err search_end(struct search *s, const char *what, struct fault *fault)
{
    const bool lacks_memory = s->starved || queue_failed(s->queue);
    free(s->level);
    queue_free(s->queue);
    return lacks_memory ? fault_memory(fault, what) : watch_fault(s->scene->watch, fault);
}

/* Queue a cell that was found at the cost `here`. */
static inline void wait_at(struct search *s, uint32_t here, uint32_t cost, uint32_t cell)
{
    if (cost > here)
        queue_push(s->queue, cost << 16, cell);
    else if (mem_grow(&s->level, &s->capacity, s->count + 1, sizeof *s->level))
        s->level[s->count++] = cell;
    else
        s->starved = true;
}

/* Examine the neighbours of each queued cell. An entry whose cell has a lower cost by now is
 * skipped. Memory is prefetched for a cell that follows soon: most of the time is spent waiting for
 * it. */
typedef void look_around(struct search *s, uint32_t cell, uint32_t cost);
static inline __attribute__((always_inline)) void
serve(struct search *s, look_around *look, const void *values, size_t bytes, struct task *task)
{
    enum { TAKEN = 64, AHEAD = 8 };
    uint64_t lowest;
    while ((lowest = queue_lowest(s->queue)) != QUEUE_EMPTY && !s->starved) {
        const uint32_t cost = (uint32_t)lowest >> 16;
        if (cost >= s->enough)
            return;
        queue_serve(s->queue, (uint32_t)lowest);
        do {
            s->starved |= !mem_grow(&s->level, &s->capacity, TAKEN, sizeof *s->level);
            s->count = s->starved ? 0 : queue_take(s->queue, s->level, TAKEN);
            for (size_t n = 0; n < s->count && !s->starved; n++) {
                const uint32_t ahead = s->level[n + AHEAD < s->count ? n + AHEAD : n];
                for (unsigned i = 0; i < s->adjacency->count; i++) {
                    const size_t near = ahead + (size_t)s->adjacency->offset[i];
                    __builtin_prefetch(s->scene->cell + near);
                    __builtin_prefetch((const char *)values + near * bytes);
                }
                look(s, s->level[n], cost);
                if (!task_advance(task, 1))
                    return;
            }
        } while (s->count > 0);
    }
}

/* ---- margins ---- */

/* Offer of neighbour s to t, which has another label or the same. */
static uint32_t offer(const struct search *search, uint32_t s, uint32_t t)
{
    const struct cell *cell = search->scene->cell;
    const uint32_t w = arc_weight_now(search->arcs, cell + s, cell + t);
    const uint32_t has = cell[s].label == cell[t].label ? search->cost[s] : key_cost(cell[s].key);
    return w > has ? w : has;
}

/* Set the cost of t to the best offer of neighbours with another label, and queue t. */
static void begin_at(struct search *search, uint32_t t)
{
    const struct adjacency *adjacency = search->adjacency;
    const struct cell *cell = search->scene->cell + t;
    uint32_t best = MARGIN_NONE;
    if (!cell_is_reached(cell))
        return;
    for (unsigned i = 0; i < adjacency->count; i++) {
        const struct cell *from = cell + adjacency->offset[i];
        if (from->label == cell->label || !cell_is_reached(from))
            continue;
        const uint32_t offered = offer(search, t + (uint32_t)adjacency->offset[i], t);
        best = offered < best ? offered : best;
    }
    if (best == MARGIN_NONE)
        return;
    search->cost[t] = (uint16_t)best;
    queue_push(search->queue, best << 16, t);
}

/* Offer the final cost of s to neighbours of the same label. */
static inline void pass_on(struct search *search, uint32_t s, uint32_t cost)
{
    const struct adjacency *adjacency = search->adjacency;
    const struct cell *cell = search->scene->cell;
    if (search->cost[s] != cost)
        return;
    for (unsigned i = 0; i < adjacency->count; i++) {
        const uint32_t t = s + (uint32_t)adjacency->offset[i];
        if (cell[t].label != cell[s].label || !cell_is_reached(cell + t))
            continue;
        const uint32_t offered = offer(search, s, t);
        if (offered >= search->cost[t])
            continue;
        search->cost[t] = (uint16_t)offered;
        wait_at(search, cost, offered, t);
    }
}

enum err margin_new(uint16_t **margin, const struct forest *forest, struct fault *fault)
{
    const struct scene *scene = forest_scene(forest);
    const size_t cells = scene->grid.cells;
    *margin = NULL;
    if (forest_arcs(forest)->kind == ARC_POLARITY)
        return fault_set(fault, ERR_USAGE,
                         "there is no margin under `weight polarity`, where the cost of a step "
                         "depends on the label; expected another weight; nothing was written");
    struct search search = search_begin(forest);
    uint16_t *const cost = search.cost = mem_array(cells, sizeof *cost);
    search.starved |= !cost;
    for (size_t c = 0; cost && c < cells; c++)
        cost[c] = MARGIN_NONE;
    if (!search.starved) {
        for (struct grid_walk w = scene_walk(scene, "borders of labels", NULL, 0);
             grid_walk_next(&w);)
            for (uint32_t c = w.row.first; c < w.row.end; c++) {
                scene_fetch_ahead(scene, c);
                begin_at(&search, c);
            }
        struct task task = task_begin(scene->watch, "margins", scene->grid.voxels);
        serve(&search, pass_on, cost, sizeof *cost, &task);
    }
    const enum err err = search_end(&search, "the margins", fault);
    if (err) {
        free(cost);
        return err;
    }
    for (size_t c = 0; c < cells; c++) {
        const uint32_t own = key_cost(scene->cell[c].key);
        if (cost[c] != MARGIN_NONE)
            cost[c] = (uint16_t)(cost[c] > own ? cost[c] - own : 0);
    }
    *margin = cost;
    return OK;
}

/* ---- the rival of one voxel ---- */

static inline void look_back(struct search *s, uint32_t at, uint32_t here)
{
    const struct adjacency *adjacency = s->adjacency;
    const struct cell *cell = s->scene->cell;
    if (s->after[at] != here + 1)
        return;
    for (unsigned i = 0; i < adjacency->count; i++) {
        const uint32_t from = at + (uint32_t)adjacency->offset[i];
        if (!cell_is_reached(cell + from))
            continue;
        const uint32_t step = arc_weight_now(s->arcs, cell + from, cell + at);
        const uint32_t after = step > here ? step : here;
        if (cell[from].label != s->label) {
            const uint32_t has = key_cost(cell[from].key), cost = has > after ? has : after;
            if (cost < s->enough || (cost == s->enough && cell[from].label < s->rival->label))
                *s->rival = (struct rival){true, cost, cell[from].label};
            s->enough = s->rival->cost;
            continue;
        }
        if (s->after[from] && s->after[from] <= after + 1)
            continue;
        s->after[from] = after + 1;
        wait_at(s, here, after, from);
    }
}

enum err rival_find(struct rival *rival, const struct forest *forest, uint32_t cell,
                    struct fault *fault)
{
    const struct scene *scene = forest_scene(forest);
    const size_t cells = scene->grid.cells;
    *rival = (struct rival){.exists = false};
    if (forest_arcs(forest)->kind == ARC_POLARITY)
        return fault_set(fault, ERR_USAGE,
                         "no other label is looked for under `weight polarity`, where the cost of "
                         "a step depends on the label");
    struct search s = search_begin(forest);
    s.rival = rival;
    s.label = scene->cell[cell].label;
    s.after = mem_pages(cells * sizeof *s.after);
    s.starved |= !s.after;
    if (!s.starved) {
        struct task task = task_begin(scene->watch, "other labels", 0);
        s.after[cell] = 1;
        queue_push(s.queue, 0, cell);
        serve(&s, look_back, s.after, sizeof *s.after, &task);
    }
    mem_pages_free(s.after, cells * sizeof *s.after);
    return search_end(&s, "other labels", fault);
}
