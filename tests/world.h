/* SPDX-License-Identifier: MIT */
/* A scene and a forest in it, for tests of the engine. */
#ifndef TESTS_WORLD_H
#define TESTS_WORLD_H

#include "engine/forest.h"
#include "tests/check.h"
#include "tests/random.h"

struct world {
    struct scene *scene;
    struct forest *forest;
};

static inline struct world world_new(uint32_t x, uint32_t y, uint32_t z, unsigned adjacency)
{
    struct world w = {0};
    CHECK(scene_new(&w.scene, (uint32_t[]){x, y, z}, NULL) == OK);
    CHECK(forest_new(&w.forest, w.scene, adjacency, NULL) == OK);
    return w;
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

#endif
