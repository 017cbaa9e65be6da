/* A scene and a forest in it, for tests of the engine. */
#ifndef TESTS_WORLD_H
#define TESTS_WORLD_H

#include "engine/forest.h"
#include "tests/check.h"

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

static inline void world_free(struct world *w)
{
    forest_free(w->forest);
    scene_free(w->scene);
}

#endif
