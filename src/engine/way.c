/* SPDX-License-Identifier: MIT */
#include "engine/way.h"

#include <stdlib.h>

#include "base/mem.h"

enum err way_find(struct way *way, const struct forest *forest, uint32_t cell, struct fault *fault)
{
    const struct cell *cells = forest_scene(forest)->cell;
    way->count = 0;
    way->edge = CELL_NONE;
    for (uint32_t at = cell; at != CELL_NONE; at = forest_predecessor(forest, at)) {
        if (!mem_grow(&way->cell, &way->capacity, way->count + 1, sizeof *way->cell))
            return fault_memory(fault, "a path");
        way->cell[way->count++] = at;
        if (way->edge == CELL_NONE && key_cost(cells[at].key) > 0 && key_hops(cells[at].key) == 0)
            way->edge = at;
    }
    return OK;
}

void way_release(struct way *way)
{
    free(way->cell);
    *way = (struct way){0};
}

/* ---- the passage ---- */

enum { EDGES_MOST = 64 }; /* edges of a path, from the strongest on */

struct edge {
    uint32_t cell, cost;
    unsigned paths;
};

struct edges {
    struct edge item[PASSAGE_SAMPLES * EDGES_MOST];
    size_t count;
    unsigned paths;
};

static void add_path(struct edges *edges, const struct forest *forest, uint32_t at)
{
    const struct cell *cells = forest_scene(forest)->cell;
    unsigned found = 0;
    uint32_t before;
    edges->paths++;
    for (; found < EDGES_MOST && (before = forest_predecessor(forest, at)) != CELL_NONE;
         at = before)
        if (key_hops(cells[at].key) == 0) {
            size_t i = 0;
            while (i < edges->count && edges->item[i].cell != at)
                i++;
            if (i == edges->count)
                edges->item[edges->count++] = (struct edge){at, key_cost(cells[at].key), 0};
            edges->item[i].paths++;
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
    struct {
        uint64_t hash;
        uint32_t cell;
    } sample[PASSAGE_SAMPLES]; /* those of the least hashes, in any order of the changes */
    size_t samples = 0;
    for (size_t i = 0; i < changes.listed; i++) {
        const uint32_t at = changes.item[i].cell;
        const uint64_t hash = hash_mix(at);
        if (changes.item[i].former_label != label ||
            (samples == PASSAGE_SAMPLES && sample[samples - 1].hash < hash))
            continue;
        size_t k = samples < PASSAGE_SAMPLES ? samples++ : samples - 1;
        for (; k > 0 && sample[k - 1].hash > hash; k--)
            sample[k] = sample[k - 1];
        sample[k].hash = hash;
        sample[k].cell = at;
    }
    for (size_t i = 0; i < samples; i++)
        add_path(&edges, forest, sample[i].cell);
    for (const struct edge *e = edges.item; e < edges.item + edges.count; e++)
        if (!best || is_better(&edges, e, best))
            best = e;
    if (best)
        *cell = best->cell;
    return best != NULL;
}

/* ---- a tree ---- */

/* Each voxel is entered from its predecessor, and left for it when all its children are counted. */
size_t tree_voxels(const struct forest *forest, uint32_t seed, size_t most)
{
    const struct adjacency *adjacency = forest_adjacency(forest);
    const struct cell *cell = forest_scene(forest)->cell;
    const ptrdiff_t *offset = adjacency->offset;
    uint32_t at = seed;
    size_t voxels = 1;
    for (unsigned i = 0; voxels <= most;) {
        while (i < adjacency->count && cell[at + (uint32_t)offset[i]].direction != i)
            i++;
        if (i < adjacency->count) {
            at += (uint32_t)offset[i];
            voxels++;
            i = 0;
        } else if (at != seed) {
            i = cell[at].direction;
            at -= (uint32_t)offset[i++];
        } else {
            break;
        }
    }
    return voxels;
}
