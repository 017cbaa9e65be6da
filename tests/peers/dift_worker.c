/* SPDX-License-Identifier: MIT */
/* A textbook differential image foresting transform as a worker (Falcao, Bergo: Interactive volume
 * segmentation with differential image foresting transforms, IEEE TMI 23(9), 2004). It shares no
 * code with the engine. The path cost is f_max over the gradient, with 6 neighbours; the queue is
 * an array of buckets, first in, first out within a cost. Each run updates the former forest.
 *
 * The stages: "cells", making the nodes after a reset; "list", finding the edits in the map of
 * markers; "run", the update; and "read", copying the labels out of the nodes. */
#include "tests/peers/worker.h"

enum { INFINITE = UINT16_MAX, NO_PARENT = 6 }; /* weights are below INFINITE */
#define NO_NODE UINT32_MAX

struct node {
    uint32_t previous, next; /* within a bucket */
    uint16_t cost, weight;
    uint8_t label;  /* label + 1; 0 for none */
    uint8_t parent; /* direction from the predecessor to here, or NO_PARENT */
    uint8_t sides;  /* bit i: there is a neighbour in direction i */
    bool queued;
};
static struct node *node;                                /* [voxels] */
static uint32_t first[INFINITE + 1], last[INFINITE + 1]; /* the buckets; NO_NODE where empty */
static uint32_t step[6];                                 /* of each direction, modulo 2^32 */
static uint8_t *planted;                                 /* the markers of the former run */
static uint32_t *edit, *removed;
static size_t edits, removals;

static void enqueue(uint32_t at)
{
    struct node *n = node + at;
    n->queued = true;
    n->next = NO_NODE;
    n->previous = last[n->cost];
    *(n->previous == NO_NODE ? &first[n->cost] : &node[n->previous].next) = at;
    last[n->cost] = at;
}

static void dequeue(uint32_t at)
{
    struct node *n = node + at;
    n->queued = false;
    *(n->previous == NO_NODE ? &first[n->cost] : &node[n->previous].next) = n->next;
    *(n->next == NO_NODE ? &last[n->cost] : &node[n->next].previous) = n->previous;
}

static void set(uint32_t at, uint16_t cost, uint8_t label, uint8_t parent)
{
    node[at].cost = cost;
    node[at].label = label;
    node[at].parent = parent;
}

static void remove_node(uint32_t at)
{
    set(at, INFINITE, 0, NO_PARENT);
    removed[removals++] = at;
}

static void remove_tree(uint32_t root)
{
    size_t next = removals;
    for (remove_node(root); next < removals; next++)
        for (int i = 0; i < 6; i++) {
            const uint32_t s = removed[next], t = s + step[i];
            if (node[s].sides >> i & 1 && node[t].parent == i)
                remove_node(t);
        }
}

/* Queue the neighbours of removed trees that still belong to a tree. */
static void enqueue_frontier(void)
{
    for (size_t k = 0; k < removals; k++)
        for (int i = 0; i < 6; i++) {
            const uint32_t s = removed[k], t = s + step[i];
            if (node[s].sides >> i & 1 && !node[t].queued && node[t].cost != INFINITE)
                enqueue(t);
        }
}

static void offer(uint32_t s, uint16_t cost, uint8_t direction)
{
    const uint32_t t = s + step[direction];
    const uint16_t c = node[t].weight > cost ? node[t].weight : cost;
    if (c >= node[t].cost && node[t].parent != direction)
        return;
    if (node[t].queued)
        dequeue(t);
    set(t, c, node[s].label, direction);
    enqueue(t);
}

static void propagate(void)
{
    for (uint16_t cost = 0; cost < INFINITE; cost++)
        while (first[cost] != NO_NODE) {
            const uint32_t s = first[cost];
            dequeue(s);
            for (uint8_t i = 0; i < 6; i++)
                if (node[s].sides >> i & 1)
                    offer(s, cost, i);
        }
}

static void make_nodes(const struct worker *worker)
{
    const unsigned *size = worker->size;
    struct node *n = node;
    for (unsigned z = 0; z < size[2]; z++)
        for (unsigned y = 0; y < size[1]; y++)
            for (unsigned x = 0; x < size[0]; x++, n++) {
                const int sides = (x > 0) | (x + 1 < size[0]) << 1 | (y > 0) << 2 |
                                  (y + 1 < size[1]) << 3 | (z > 0) << 4 | (z + 1 < size[2]) << 5;
                *n = (struct node){.cost = INFINITE, .parent = NO_PARENT, .sides = (uint8_t)sides};
                n->weight = worker->gradient[n - node];
            }
}

static void update(const uint8_t *marker)
{
    removals = 0;
    for (size_t i = 0; i < edits; i++)
        if (planted[edit[i]])
            remove_tree(edit[i]);
    for (size_t i = 0; i < edits; i++) {
        planted[edit[i]] = marker[edit[i]];
        if (marker[edit[i]]) {
            set(edit[i], 0, marker[edit[i]], NO_PARENT);
            enqueue(edit[i]);
        }
    }
    enqueue_frontier();
    propagate();
}

static bool run(struct worker *worker)
{
    worker_stage(worker, NULL);
    if (worker->afresh) {
        memset(planted, 0, worker->voxels);
        make_nodes(worker);
        worker_stage(worker, "cells");
    }
    edits = 0;
    for (size_t i = 0; i < worker->voxels; i++)
        if (worker->marker[i] != planted[i])
            edit[edits++] = (uint32_t)i;
    worker_stage(worker, "list");
    update(worker->marker);
    worker_stage(worker, "run");
    for (size_t i = 0; i < worker->voxels; i++)
        worker->label[i] = node[i].label;
    worker_stage(worker, "read");
    for (size_t i = 0; i < worker->voxels; i++)
        worker->cost[i] = node[i].cost;
    return true;
}

int main(int argc, char **argv)
{
    struct worker worker = {0};
    if (argc != 2 || !worker_begin(&worker, argv[1]))
        return 3;
    const uint32_t row = worker.size[0], plane = row * worker.size[1];
    memcpy(step, (uint32_t[6]){-1U, 1, -row, row, -plane, plane}, sizeof step);
    node = malloc(worker.voxels * sizeof *node);
    planted = malloc(worker.voxels);
    edit = malloc(worker.voxels * sizeof *edit);
    removed = malloc(worker.voxels * sizeof *removed);
    worker.cost = malloc(worker.voxels * sizeof *worker.cost);
    memset(first, 0xff, sizeof first);
    memset(last, 0xff, sizeof last);
    if (!node || !planted || !edit || !removed || !worker.cost)
        return 3;
    worker_serve(&worker, run);
    return 0;
}
