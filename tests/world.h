/* SPDX-License-Identifier: MIT */
/* A scene and a forest in it, for tests of the engine. */
#ifndef TESTS_WORLD_H
#define TESTS_WORLD_H

#include "engine/forest.h"
#include "tests/random.h"

struct world {
    struct scene *scene;
    struct forest *forest;
};

static inline struct world world_new(uint32_t x, uint32_t y, uint32_t z, unsigned adjacency)
{
    struct world w = {0};
    CHECK(scene_new(&w.scene, (uint32_t[]){x, y, z}, NULL, NULL, NULL) == OK);
    CHECK(forest_new(&w.forest, w.scene, adjacency, NULL) == OK);
    return w;
}

static inline void world_plant(struct world *w, uint32_t cell, int label)
{
    CHECK(forest_edit(w->forest, &(struct edit){cell, (int16_t)label, 0}, 1, NULL) == OK);
}

/* Cell by cell, and in digests. */
static inline bool world_is_same(const struct world *a, const struct world *b)
{
    for (size_t i = 0; i < a->scene->grid.cells; i++)
        if (a->scene->cell[i].key != b->scene->cell[i].key ||
            a->scene->cell[i].label != b->scene->cell[i].label)
            return false;
    return forest_digest(a->forest) == forest_digest(b->forest) &&
           forest_label_digest(a->forest) == forest_label_digest(b->forest) &&
           forest_seeds(a->forest) == forest_seeds(b->forest);
}

static inline void world_free(struct world *w)
{
    forest_free(w->forest);
    scene_free(w->scene);
}

/* True if the forest equals one in which its seeds are planted at once. `reach` lists the reaches
 * that were added to the forest, in their order. */
static inline bool world_equals_scratch(const struct world *w, struct team *team,
                                        const struct reach *reach, unsigned reaches)
{
    const struct grid *g = &w->scene->grid;
    OWNED(world_free)
    struct world fresh =
        world_new(g->size[0], g->size[1], g->size[2], forest_adjacency(w->forest)->count);
    OWNED(mem_release) struct edit *seed = malloc((g->voxels + 1) * sizeof *seed);
    size_t seeds = 0;
    CHECK(!team || forest_set_team(fresh.forest, team, NULL) == OK);
    for (uint32_t i = 0; i < g->cells; i++) {
        const struct cell *from = w->scene->cell + i;
        struct cell *to = fresh.scene->cell + i;
        to->weight = from->weight;
        to->intensity = from->intensity;
        if (from->flags & CELL_OUTSIDE) {
            to->flags |= CELL_OUTSIDE;
            to->key = 0;
        }
        if (from->flags & CELL_SEED)
            seed[seeds++] = (struct edit){i, from->label, forest_reach_number(w->forest, i)};
    }
    for (unsigned i = 0; i < reaches; i++) {
        uint16_t number;
        CHECK(forest_add_reach(fresh.forest, &reach[i], &number, NULL) == OK && number == i + 1);
    }
    forest_set_arcs(fresh.forest, forest_arcs(w->forest));
    CHECK(forest_edit(fresh.forest, seed, seeds, NULL) == OK);
    return world_is_same(w, &fresh);
}

#endif
