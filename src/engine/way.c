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
