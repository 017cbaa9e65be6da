#include "session/held.h"

#include <stdlib.h>

#include "engine/tree.h"
#include "session/session_inside.h"

/* One seed more. */
static void count_seed(struct held *held, const struct session *session, uint32_t seed)
{
    if (!(session->scene->cell[seed].flags & CELL_SEED)) {
        held->waits++;
    } else {
        held->trees++;
        held->voxels += tree_voxels(session->forest, seed, HELD_MOST - held->voxels);
    }
    held->has_more = held->voxels > HELD_MOST || held->waits > HELD_MOST;
}

/* Whether the marker decides about a voxel, or a part of the same stroke does. */
static bool decides(const struct markers *markers, uint32_t number, uint32_t cell)
{
    const uint32_t one = markers_at(markers, cell);
    return one && markers_stroke(markers, one) == number;
}

static void count_marker(struct held *held, const struct session *session)
{
    const struct markers *markers = &session->markers;
    held->label = (uint8_t)markers->marker[held->marker - 1].label;
    for (uint32_t n = held->marker; n; n = markers_next(markers, n)) {
        const struct marker *marker = markers->marker + n - 1;
        for (size_t i = 0; i < marker->voxels && !held->has_more; i++) {
            const uint32_t cell = markers->cover[marker->first + i].cell;
            if (markers_at(markers, cell) == n)
                count_seed(held, session, cell);
        }
    }
}

static enum err find_marker(struct held *held, const struct session *session, uint32_t cell,
                            struct fault *fault)
{
    uint32_t *number;
    size_t numbers;
    enum err err = session_find_markers(session, &cell, 1, &number, &numbers, fault);
    if (!err) {
        held->marker = *number;
        count_marker(held, session);
    }
    free(number);
    return err;
}

static enum err find_tree(struct held *held, const struct session *session, uint32_t cell,
                          struct fault *fault)
{
    uint32_t *seed;
    size_t seeds;
    enum err err = session_find_seeds(session, &cell, 1, &seed, &seeds, fault);
    if (!err && !seeds)
        err = fault_set(fault, ERR_INPUT, "no tree holds this voxel");
    if (!err) {
        const int16_t label = markers_seed(&session->markers, *seed);
        held->seed = *seed;
        held->label = (uint8_t)(label == EDIT_ERASE ? session->scene->cell[*seed].label : label);
        count_seed(held, session, *seed);
    }
    free(seed);
    return err;
}

enum err session_find_held(struct held *held, const struct session *session, uint32_t cell,
                           bool tree, struct fault *fault)
{
    *held = (struct held){.seed = CELL_NONE};
    return tree || !semantics_has(session->semantics, MEANING_MARKERS)
               ? find_tree(held, session, cell, fault)
               : find_marker(held, session, cell, fault);
}

bool session_is_held(const struct session *session, const struct held *held, uint32_t cell)
{
    const struct cell *at = session->scene->cell + cell;
    const uint32_t root = cell_is_reached(at) ? key_root(at->key) : CELL_NONE;
    if (!held->marker)
        return root == held->seed || cell == held->seed;
    return (root != CELL_NONE && decides(&session->markers, held->marker, root)) ||
           decides(&session->markers, held->marker, cell);
}
