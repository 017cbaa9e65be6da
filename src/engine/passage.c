#include "engine/passage.h"

enum { EDGES_MOST = 64 }; /* of a path, from the strongest on */

struct edge {
    uint32_t cell, cost;
    unsigned paths;
};

struct edges {
    struct edge item[PASSAGE_SAMPLES * EDGES_MOST];
    size_t count;
    unsigned paths;
};

static void add_edge(struct edges *edges, uint32_t cell, uint32_t cost)
{
    size_t i = 0;
    while (i < edges->count && edges->item[i].cell != cell)
        i++;
    if (i == edges->count)
        edges->item[edges->count++] = (struct edge){cell, cost, 0};
    edges->item[i].paths++;
}

static void add_path(struct edges *edges, const struct forest *forest, uint32_t at)
{
    const struct cell *cells = forest_scene(forest)->cell;
    unsigned found = 0;
    uint32_t before;
    edges->paths++;
    for (; found < EDGES_MOST && (before = forest_predecessor(forest, at)) != CELL_NONE;
         at = before)
        if (key_hops(cells[at].key) == 0) {
            add_edge(edges, at, key_cost(cells[at].key));
            found++;
        }
}

static bool is_better(const struct edges *edges, const struct edge *a, const struct edge *b)
{
    const bool a_common = 2 * a->paths >= edges->paths, b_common = 2 * b->paths >= edges->paths;
    if (a_common != b_common)
        return a_common;
    if (a_common && a->cost != b->cost)
        return a->cost > b->cost;
    if (a->paths != b->paths)
        return a->paths > b->paths;
    return a->cost != b->cost ? a->cost > b->cost : a->cell < b->cell;
}

bool passage_find(uint32_t *cell, const struct forest *forest, unsigned label)
{
    const struct changes changes = forest_changes(forest);
    struct edges edges = {.count = 0};
    const struct edge *best = NULL;
    size_t at = 0;
    for (size_t i = 0; i < PASSAGE_SAMPLES; i++) {
        const size_t even = changes.listed * i / PASSAGE_SAMPLES;
        at = even > at ? even : at;
        while (at < changes.listed && changes.item[at].former_label != label)
            at++;
        if (at < changes.listed)
            add_path(&edges, forest, changes.item[at++].cell);
    }
    for (const struct edge *e = edges.item; e < edges.item + edges.count; e++)
        if (!best || is_better(&edges, e, best))
            best = e;
    if (best)
        *cell = best->cell;
    return best != NULL;
}
