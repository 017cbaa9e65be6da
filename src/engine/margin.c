/* SPDX-License-Identifier: MIT */
#include "engine/margin.h"

#include <stdlib.h>
#include <string.h>

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

    /* For margins, [grid.cells]: MARGIN_NONE less the bar of each root, or 0; and C' so far, which
     * becomes the margin when it is final. */
    uint16_t *bar, *cost;
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
 * it. All cells that wait at a cost are served together, in the order in which they were found. */
typedef void look_around(struct search *s, uint32_t cell, uint32_t cost);
static inline __attribute__((always_inline)) void
serve(struct search *s, look_around *look, const void *values, size_t bytes, struct task *task)
{
    enum { TAKEN = 256, AHEAD = 8 };
    uint64_t lowest;
    while ((lowest = queue_lowest(s->queue)) != QUEUE_EMPTY && !s->starved) {
        const uint32_t cost = (uint32_t)lowest >> 16;
        if (cost >= s->enough)
            return;
        queue_serve(s->queue, (uint32_t)lowest);
        do {
            s->count = 0;
            for (size_t taken = 1; taken > 0 && !s->starved; s->count += taken) {
                s->starved |=
                    !mem_grow(&s->level, &s->capacity, s->count + TAKEN, sizeof *s->level);
                taken = s->starved ? 0 : queue_take(s->queue, s->level + s->count, TAKEN);
            }
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

/* Return true if the margin of a reached cell is known to be 0: its cost is not below the bar of
 * its root. */
static inline bool is_at_bar(const struct search *search, const struct cell *cell)
{
    const uint32_t has = key_cost(cell->key);
    return has < MARGIN_NONE && has + search->bar[key_root(cell->key)] >= MARGIN_NONE;
}

/* Return the best offer of neighbours whose C' or C is known: of another label, or at the bar. */
static uint32_t best_offer(const struct search *search, const struct cell *cell)
{
    const struct adjacency *adjacency = search->adjacency;
    uint32_t best = MARGIN_NONE;
    for (unsigned i = 0; i < adjacency->count; i++) {
        const struct cell *from = cell + adjacency->offset[i];
        if (!cell_is_reached(from) || (from->label == cell->label && !is_at_bar(search, from)))
            continue;
        const uint32_t w = arc_weight_now(search->arcs, from, cell), has = key_cost(from->key);
        const uint32_t offer = w > has ? w : has;
        best = offer < best ? offer : best;
    }
    return best;
}

/* Lower the bar of the root of t: a path from another label reaches t at its best offer, which is
 * not below C(t), and the root at that or at the weight of the root. */
static void lower_bar(struct search *search, uint32_t t)
{
    const struct cell *cell = search->scene->cell + t;
    if (!cell_is_reached(cell) || is_at_bar(search, cell))
        return;
    const struct cell *root = search->scene->cell + key_root(cell->key);
    const uint32_t offer = best_offer(search, cell), w = arc_weight_now(search->arcs, root, root);
    const uint32_t bar = MARGIN_NONE - (w > offer ? w : offer);
    uint16_t *const known = search->bar + key_root(cell->key);
    *known = (uint16_t)(bar > *known ? bar : *known);
}

/* Set the margin of t, or queue it at its best offer. */
static void begin_at(struct search *search, uint32_t t)
{
    const struct cell *cell = search->scene->cell + t;
    if (!cell_is_reached(cell))
        return;
    const bool is_known = is_at_bar(search, cell);
    const uint32_t best = is_known ? 0 : best_offer(search, cell);
    search->cost[t] = (uint16_t)best;
    if (!is_known && best < MARGIN_NONE)
        queue_push(search->queue, best << 16, t);
}

/* Offer the final cost of s to neighbours of the same label, and turn it into the margin: no later
 * offer is below that. The outcome is hard to predict, so there is no branch. Neighbours of another
 * label have had the offer of C(s), which is not above that of C'(s), unless seeds have reaches. */
static inline void pass_on(struct search *search, uint32_t s, uint32_t here)
{
    const struct adjacency *adjacency = search->adjacency;
    const struct cell *cell = search->scene->cell;
    const uint32_t own = key_cost(cell[s].key);
    struct waiting rise[26];
    size_t rises = 0;
    if (search->cost[s] != here)
        return;
    search->cost[s] = (uint16_t)(here > own ? here - own : 0);
    if (search->capacity < search->count + adjacency->count)
        search->starved |= !mem_grow(&search->level, &search->capacity,
                                     search->count + adjacency->count, sizeof *search->level);
    for (unsigned i = 0; i < adjacency->count && !search->starved; i++) {
        const uint32_t t = s + (uint32_t)adjacency->offset[i];
        uint16_t *to = search->cost + t;
        const uint32_t w = arc_weight_now(search->arcs, cell + s, cell + t);
        const uint32_t offer = w > here ? w : here;
        const bool takes =
            (offer < *to) & (cell[t].label == cell[s].label) & cell_is_reached(cell + t);
        *to = (uint16_t)(takes ? offer : *to);
        search->level[search->count] = t;
        search->count += takes & (offer == here);
        rise[rises] = (struct waiting){offer << 16, t};
        rises += takes & (offer > here);
    }
    if (rises > 0)
        queue_push_many(search->queue, rise, rises);
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
    search.cost = mem_array(cells, sizeof *search.cost);
    search.bar = mem_pages(cells * sizeof *search.bar);
    search.starved |= !search.cost || !search.bar;
    if (search.cost)
        memset(search.cost, 0xff, cells * sizeof *search.cost);
    /* If seeds have reaches, C' may be below C, and there are no bars. */
    for (int pass = forest_limited_seeds(forest) > 0; pass < 2 && !search.starved; pass++)
        for (struct grid_walk w = scene_walk(scene, "borders of labels", NULL, 0);
             grid_walk_next(&w);)
            for (uint32_t c = w.row.first; c < w.row.end; c++) {
                scene_fetch_ahead(scene, c);
                (pass ? begin_at : lower_bar)(&search, c);
            }
    if (!search.starved) {
        struct task task = task_begin(scene->watch, "margins", scene->grid.voxels);
        serve(&search, pass_on, search.cost, sizeof *search.cost, &task);
    }
    const enum err err = search_end(&search, "the margins", fault);
    mem_pages_free(search.bar, cells * sizeof *search.bar);
    if (err)
        free(search.cost);
    else
        *margin = search.cost;
    return err;
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
        return OK;
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
