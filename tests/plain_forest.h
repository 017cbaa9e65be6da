/* SPDX-License-Identifier: MIT */
/*
 * A plain solution of the equation of engine/forest.h, by Dijkstra's algorithm without a queue. It
 * shares no code with the engine: seeds and reaches are those that the test has recorded.
 */
#ifndef TESTS_PLAIN_FOREST_H
#define TESTS_PLAIN_FOREST_H

#include <stdlib.h>

#include "tests/world.h"

enum { CELLS_MOST = 12 * 12 * 12, REACHES = 6 };

/* The reaches of a world: plain_reach[n - 1] has number n. */
static struct reach plain_reach[REACHES];

struct plain {
    uint32_t cost, hops, root; /* cost UINT32_MAX: none */
};

static inline bool is_less(const struct plain *a, const struct plain *b)
{
    return a->cost != b->cost   ? a->cost < b->cost
           : a->hops != b->hops ? a->hops < b->hops
                                : a->root < b->root;
}

static const struct plain nothing = {UINT32_MAX, UINT32_MAX, UINT32_MAX};

/* The seeds, as the test itself remembers them. */
struct planted {
    int16_t label[CELLS_MOST]; /* or EDIT_ERASE */
    uint16_t reach[CELLS_MOST];
};

static inline bool plainly_allowed(const struct planted *planted, uint32_t root,
                                   const int32_t at[3])
{
    const unsigned number = planted->reach[root];
    if (!number)
        return true;
    const struct reach *reach = &plain_reach[number - 1];
    double sum = 0; /* exact: small numbers */
    for (int a = 0; a < 3; a++) {
        const double way = ((double)at[a] - reach->centre[a]) * reach->unit[a];
        sum += way * way;
    }
    return reach->radius >= 0 && sum <= (double)reach->radius * (double)reach->radius;
}

static inline uint32_t plain_weight(const struct world *w, uint32_t s, uint32_t t, int label)
{
    const struct arc_rule *rule = forest_arcs(w->forest);
    const struct cell *cell = w->scene->cell;
    const int64_t from = cell[s].intensity, to = cell[t].intensity;
    if (rule->kind == ARC_TARGET)
        return cell[t].weight;
    if (rule->kind == ARC_DIFFERENCE)
        return (uint32_t)llabs(from - to);
    const int64_t a = from > to ? rule->polarity[label] : -rule->polarity[label];
    const int64_t weight = llabs(from - to) * (100 + a) / 100;
    return (uint32_t)(weight < 65535 ? weight : 65535);
}

/* What s offers t along the arc. */
static inline struct plain plain_offer(const struct world *w, const struct planted *planted,
                                       const struct plain *key, uint32_t s, uint32_t t,
                                       const int32_t at[3])
{
    const struct plain from = key[s];
    if (from.cost == UINT32_MAX || !plainly_allowed(planted, from.root, at))
        return nothing;
    const uint32_t weight = plain_weight(w, s, t, planted->label[from.root]);
    return weight > from.cost ? (struct plain){weight, 0, from.root}
                              : (struct plain){from.cost, from.hops + 1, from.root};
}

/* Cells with a key that is not served yet. */
struct plain_waiting {
    uint32_t cell[CELLS_MOST];
    size_t count;
};

/* Offers what s has to each neighbour. */
static inline void offer_around(const struct world *w, const struct planted *planted,
                                struct plain *key, uint32_t s, struct plain_waiting *waiting)
{
    const struct grid *g = &w->scene->grid;
    const bool corners = forest_adjacency(w->forest)->count == 26;
    const struct place p = grid_place(g, s);
    for (int32_t z = -1; z <= 1; z++)
        for (int32_t y = -1; y <= 1; y++)
            for (int32_t x = -1; x <= 1; x++) {
                const int moved = (x != 0) + (y != 0) + (z != 0);
                const int32_t n[3] = {(int32_t)p.x + x, (int32_t)p.y + y, (int32_t)p.z + z};
                if (!moved || (moved > 1 && !corners) || !grid_contains(g, n[0], n[1], n[2]))
                    continue;
                const uint32_t t = grid_cell(g, (uint32_t)n[0], (uint32_t)n[1], (uint32_t)n[2]);
                const struct plain offer = plain_offer(w, planted, key, s, t, n);
                if (w->scene->cell[t].flags & CELL_OUTSIDE || !is_less(&offer, &key[t]))
                    continue;
                if (key[t].cost == UINT32_MAX)
                    waiting->cell[waiting->count++] = t;
                key[t] = offer;
            }
}

/* The least waiting key is final, since all later offers are above it. It is searched for among all
 * that wait. */
static inline void solve(const struct world *w, const struct planted *planted, struct plain *key)
{
    static struct plain_waiting waiting;
    for (uint32_t c = 0; c < w->scene->grid.cells; c++) {
        const bool is_seed = planted->label[c] != EDIT_ERASE;
        key[c] = is_seed ? (struct plain){0, 0, c} : nothing;
        if (is_seed)
            waiting.cell[waiting.count++] = c;
    }
    while (waiting.count > 0) {
        size_t best = 0;
        for (size_t i = 1; i < waiting.count; i++)
            if (is_less(&key[waiting.cell[i]], &key[waiting.cell[best]]))
                best = i;
        const uint32_t s = waiting.cell[best];
        waiting.cell[best] = waiting.cell[--waiting.count];
        offer_around(w, planted, key, s, &waiting);
    }
}

/* True if keys and labels are the plain solution: its costs are the textbook's f_max costs if no
 * seed has a reach. */
static inline bool equals_plain(const struct world *w, const struct planted *planted,
                                struct plain key[CELLS_MOST])
{
    const struct grid *g = &w->scene->grid;
    bool same = true;
    solve(w, planted, key);
    for (size_t c = 0; c < g->cells; c++) {
        const struct cell *cell = w->scene->cell + c;
        if (cell->flags & (CELL_RIM | CELL_OUTSIDE))
            same &= cell->key == 0 && cell->label == 0;
        else if (key[c].cost == UINT32_MAX)
            same &= cell->key == KEY_NONE && cell->label == 0;
        else
            same &= cell->key == key_make(key[c].cost, key[c].hops, key[c].root) &&
                    cell->label == planted->label[key[c].root];
    }
    return same;
}

#endif
