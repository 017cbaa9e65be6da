#include "engine/margin.h"

#include <stdlib.h>

#include "base/mem.h"
#include "engine/queue.h"

struct second {
    const struct scene *scene;
    const struct adjacency *adjacency;
    const struct arc_rule *arcs;
    uint16_t *cost; /* [grid.cells], of the best path from another label; MARGIN_NONE for none */
    struct queue *queue;
    uint32_t *level; /* cells of the cost being served, which gives itself further ones */
    size_t count, capacity;
    bool starved;
};

/* What neighbour s offers t, which holds another label or the same. */
static uint32_t offer(const struct second *second, uint32_t s, uint32_t t)
{
    const struct cell *cell = second->scene->cell;
    const uint32_t w = arc_weight_now(second->arcs, cell + s, cell + t);
    const uint32_t has = cell[s].label == cell[t].label ? second->cost[s] : key_cost(cell[s].key);
    return w > has ? w : has;
}

/* The best offer of neighbours with another label. */
static void begin_at(struct second *second, uint32_t t)
{
    const struct adjacency *adjacency = second->adjacency;
    const struct cell *cell = second->scene->cell + t;
    uint32_t best = MARGIN_NONE;
    if (!cell_is_reached(cell))
        return;
    for (unsigned i = 0; i < adjacency->count; i++) {
        const struct cell *from = cell + adjacency->offset[i];
        if (from->label == cell->label || !cell_is_reached(from))
            continue;
        const uint32_t offered = offer(second, t + (uint32_t)adjacency->offset[i], t);
        best = offered < best ? offered : best;
    }
    if (best == MARGIN_NONE)
        return;
    second->cost[t] = (uint16_t)best;
    queue_push(second->queue, best << 16, t);
}

static void begin(struct second *second)
{
    const struct grid *grid = &second->scene->grid;
    struct task task = task_begin(second->scene->watch, "borders of labels", grid->voxels);
    for (uint32_t z = 0; z < grid->size[2]; z++)
        for (uint32_t y = 0; y < grid->size[1]; y++) {
            const struct span row = grid_row(grid, y, z);
            for (uint32_t c = row.first; c < row.end; c++) {
                scene_fetch_ahead(second->scene, c);
                begin_at(second, c);
            }
            if (!task_advance(&task, grid->size[0]))
                return;
        }
}

/* Neighbours of the same label that s, which has its final cost, offers less than they have. */
static void pass_on(struct second *second, uint32_t s)
{
    const struct adjacency *adjacency = second->adjacency;
    const struct cell *cell = second->scene->cell;
    for (unsigned i = 0; i < adjacency->count; i++) {
        const uint32_t t = s + (uint32_t)adjacency->offset[i];
        if (cell[t].label != cell[s].label || !cell_is_reached(cell + t))
            continue;
        const uint32_t offered = offer(second, s, t);
        if (offered >= second->cost[t])
            continue;
        second->cost[t] = (uint16_t)offered;
        if (offered > second->cost[s])
            queue_push(second->queue, offered << 16, t);
        else if (mem_grow(&second->level, &second->capacity, second->count + 1,
                          sizeof *second->level))
            second->level[second->count++] = t;
        else
            second->starved = true;
    }
}

/* One cost after another, from the lowest up; an entry whose cell has a lower cost by now is passed
 * over. */
static void serve(struct second *second)
{
    enum { TAKEN = 64 };
    uint32_t taken[TAKEN];
    uint64_t lowest;
    struct task task = task_begin(second->scene->watch, "margins", second->scene->grid.voxels);
    while ((lowest = queue_lowest(second->queue)) != QUEUE_EMPTY && !second->starved) {
        const uint32_t level = (uint32_t)lowest;
        queue_serve(second->queue, level);
        for (size_t n; (n = queue_take(second->queue, taken, TAKEN)) > 0;)
            for (size_t i = 0; i < n; i++) {
                if (second->cost[taken[i]] == level >> 16)
                    pass_on(second, taken[i]);
                while (second->count > 0 && !second->starved)
                    pass_on(second, second->level[--second->count]);
                if (!task_advance(&task, 1))
                    return;
            }
    }
}

/* In place of the costs. */
static void subtract(const struct second *second)
{
    const struct cell *cell = second->scene->cell;
    for (size_t c = 0; c < second->scene->grid.cells; c++) {
        const uint32_t other = second->cost[c], own = key_cost(cell[c].key);
        if (other != MARGIN_NONE)
            second->cost[c] = (uint16_t)(other > own ? other - own : 0);
    }
}

enum err margin_new(uint16_t **margin, const struct forest *forest, struct fault *fault)
{
    const struct scene *scene = forest_scene(forest);
    const size_t cells = scene->grid.cells;
    struct second second = {
        .scene = scene, .adjacency = forest_adjacency(forest), .arcs = forest_arcs(forest)};
    *margin = NULL;
    if (second.arcs->kind == ARC_POLARITY)
        return fault_set(fault, ERR_USAGE,
                         "there is no margin under `weight polarity`, where the cost of a step "
                         "depends on the label; expected another weight; nothing was written");
    second.cost = mem_array(cells, sizeof *second.cost);
    second.queue = queue_new(cells, 0);
    enum err err = second.cost && second.queue ? OK : fault_memory(fault, "the margins");
    for (size_t c = 0; !err && c < cells; c++)
        second.cost[c] = MARGIN_NONE;
    if (!err) {
        begin(&second);
        serve(&second);
        err = second.starved || queue_failed(second.queue) ? fault_memory(fault, "the margins")
                                                           : watch_fault(scene->watch, fault);
    }
    if (!err) {
        subtract(&second);
        *margin = second.cost;
        second.cost = NULL;
    }
    free(second.cost);
    free(second.level);
    queue_free(second.queue);
    return err;
}
