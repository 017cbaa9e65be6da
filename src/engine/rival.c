#include "engine/rival.h"

#include <stdlib.h>

#include "base/mem.h"
#include "engine/queue.h"

struct search {
    const struct scene *scene;
    const struct adjacency *adjacency;
    const struct arc_rule *arcs;
    struct rival *rival;
    uint8_t label;
    uint32_t *after; /* [grid.cells]: 1 more than the greatest weight from there on; 0: not known */
    struct queue *queue;
    uint32_t *level; /* cells of the weight being served, which gives itself further ones */
    size_t count, capacity;
    bool starved;
};

static void meet(struct rival *rival, uint32_t cost, uint8_t label)
{
    if (!rival->exists || cost < rival->cost || (cost == rival->cost && label < rival->label))
        *rival = (struct rival){true, cost, label};
}

static void look_around(struct search *s, uint32_t at)
{
    const struct adjacency *adjacency = s->adjacency;
    const struct cell *cell = s->scene->cell;
    const uint32_t here = s->after[at] - 1;
    for (unsigned i = 0; i < adjacency->count; i++) {
        const uint32_t from = at + (uint32_t)adjacency->offset[i];
        if (!cell_is_reached(cell + from))
            continue;
        const uint32_t step = arc_weight_now(s->arcs, cell + from, cell + at);
        const uint32_t after = step > here ? step : here;
        if (cell[from].label != s->label) {
            const uint32_t cost = key_cost(cell[from].key);
            meet(s->rival, cost > after ? cost : after, cell[from].label);
            continue;
        }
        if (s->after[from] && s->after[from] <= after + 1)
            continue;
        s->after[from] = after + 1;
        if (after > here)
            queue_push(s->queue, after << 16, from);
        else if (mem_grow(&s->level, &s->capacity, s->count + 1, sizeof *s->level))
            s->level[s->count++] = from;
        else
            s->starved = true;
    }
}

/* From the least weight up; an entry whose cell has a lower one by now is passed over. */
static void serve(struct search *s)
{
    enum { TAKEN = 64 };
    uint32_t taken[TAKEN];
    uint64_t lowest;
    struct task task = task_begin(s->scene->watch, "other labels", 0);
    while ((lowest = queue_lowest(s->queue)) != QUEUE_EMPTY && !s->starved) {
        const uint32_t level = (uint32_t)lowest;
        if (s->rival->exists && s->rival->cost <= level >> 16)
            return;
        queue_serve(s->queue, level);
        for (size_t n; (n = queue_take(s->queue, taken, TAKEN)) > 0;)
            for (size_t i = 0; i < n; i++) {
                if (s->after[taken[i]] == (level >> 16) + 1)
                    look_around(s, taken[i]);
                while (s->count > 0 && !s->starved) {
                    look_around(s, s->level[--s->count]);
                    if (!task_advance(&task, 1))
                        return;
                }
            }
    }
}

enum err rival_find(struct rival *rival, const struct forest *forest, uint32_t cell,
                    struct fault *fault)
{
    const struct scene *scene = forest_scene(forest);
    const size_t cells = scene->grid.cells;
    struct search s = {.scene = scene,
                       .adjacency = forest_adjacency(forest),
                       .arcs = forest_arcs(forest),
                       .rival = rival,
                       .label = scene->cell[cell].label};
    *rival = (struct rival){.exists = false};
    if (s.arcs->kind == ARC_POLARITY)
        return fault_set(fault, ERR_USAGE,
                         "no other label is looked for under `weight polarity`, where the cost of "
                         "a step depends on the label");
    s.after = mem_pages(cells * sizeof *s.after);
    s.queue = queue_new(cells, 0);
    enum err err = s.after && s.queue ? OK : fault_memory(fault, "other labels");
    if (!err) {
        s.after[cell] = 1;
        queue_push(s.queue, 0, cell);
        serve(&s);
        err = s.starved || queue_failed(s.queue) ? fault_memory(fault, "other labels")
                                                 : watch_fault(scene->watch, fault);
    }
    mem_pages_free(s.after, cells * sizeof *s.after);
    free(s.level);
    queue_free(s.queue);
    return err;
}
