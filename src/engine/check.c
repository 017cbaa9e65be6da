/* The checks of engine/forest.h: every invariant, checked at every voxel. */
#include "engine/forest.h"

/* What the equation of the forest gives for one voxel, from its neighbours' keys. */
static uint64_t solve_at(const struct forest *forest, uint32_t at)
{
    const struct adjacency *adjacency = forest_adjacency(forest);
    const struct cell *cell = forest_scene(forest)->cell + at;
    uint64_t best = cell->flags & CELL_SEED ? key_make(0, 0, at) : KEY_NONE;
    for (unsigned i = 0; i < adjacency->count; i++) {
        const struct cell *neighbour = cell + adjacency->offset[i];
        if (!cell_is_reached(neighbour) || !forest_may_hold(forest, key_root(neighbour->key), at))
            continue;
        uint64_t offer =
            key_extend(neighbour->key, arc_weight_now(forest_arcs(forest), neighbour, cell));
        best = offer < best ? offer : best;
    }
    return best;
}

static const char *voxel_wrong(const struct forest *forest, uint32_t at)
{
    const struct adjacency *adjacency = forest_adjacency(forest);
    const struct cell *cell = forest_scene(forest)->cell + at;
    if (cell->flags & CELL_OUTSIDE)
        return cell->key || cell->label || cell->direction != DIRECTION_NONE ||
                       cell->flags != CELL_OUTSIDE
                   ? "S2: outside the region of interest, but not as the rim"
                   : NULL;
    if (cell->key != solve_at(forest, at))
        return "T1: its key does not solve the equation of the forest";
    if (cell->flags & ~CELL_SEED || cell->former_label)
        return "it is marked as if in the middle of a pass";
    if (cell->key == KEY_NONE)
        return cell->label || cell->direction != DIRECTION_NONE ? "T2: unreached but labelled"
                                                                : NULL;
    if (key_hops(cell->key) == KEY_HOPS_LIMIT)
        return "T3: too many hops";
    if (cell->flags & CELL_SEED)
        return cell->direction == DIRECTION_NONE ? NULL : "T2: a seed has a predecessor";
    if (cell->direction >= adjacency->count)
        return "T2: no predecessor";
    const struct cell *from = cell - adjacency->offset[cell->direction];
    if (!cell_is_reached(from) || !forest_may_hold(forest, key_root(from->key), at) ||
        key_extend(from->key, arc_weight_now(forest_arcs(forest), from, cell)) != cell->key)
        return "T2: its predecessor does not support it";
    return from->label == cell->label ? NULL : "T2: its label is not that of its predecessor";
}

bool forest_check(const struct forest *forest, struct fault *fault)
{
    const struct scene *scene = forest_scene(forest);
    const struct grid *grid = &scene->grid;
    size_t seeds = 0;
    for (uint32_t z = 0; z < grid->size[2]; z++)
        for (uint32_t y = 0; y < grid->size[1]; y++)
            for (uint32_t x = 0; x < grid->size[0]; x++) {
                uint32_t at = grid_cell(grid, x, y, z);
                const char *wrong = voxel_wrong(forest, at);
                if (wrong) {
                    fault_set(fault, ERR_CHECK, "voxel %u,%u,%u: %s", x, y, z, wrong);
                    return false;
                }
                seeds += scene->cell[at].flags & CELL_SEED;
            }
    uint64_t keys, labels;
    forest_recount(forest, &keys, &labels);
    if (keys != forest_digest(forest) || labels != forest_label_digest(forest) ||
        seeds != forest_seeds(forest)) {
        fault_set(fault, ERR_CHECK,
                  "T4: a digest or the number of seeds is not what a recount gives");
        return false;
    }
    return true;
}
