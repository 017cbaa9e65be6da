/* SPDX-License-Identifier: MIT */
/* Plant and erase the seeds of a session, and run the edits. */
#include "session/session.h"
#include "session/session_inside.h"

#include <stdlib.h>

#include "base/mem.h"
#include "engine/way.h"
#include "base/sort.h"

/* ---- markers ---- */

size_t session_pendings(const struct session *session)
{
    return edits_count(&session->now.lists.pending);
}

/* Add a pending edit. ERR_INPUT for a seed outside the region of interest: the forest cannot
 * have one there, but the edit of a voxel that another marker restores may name one. */
static enum err add_pending(struct session *session, struct edit edit, struct fault *fault)
{
    const struct grid *grid = &session->scene->grid;
    if (edit.label == EDIT_ERASE || !(session->scene->cell[edit.cell].flags & CELL_OUTSIDE))
        return edits_add(&session->now.lists.pending, edit, fault);
    const struct place p = grid_place(grid, edit.cell);
    return fault_set(fault, ERR_INPUT,
                     "voxel %u,%u,%u would get a seed of label %d, and it is outside the region of "
                     "interest; widen the region with `mask` or `range` first; nothing has changed",
                     p.x, p.y, p.z, edit.label);
}

enum err session_add_reach(struct session *session, const struct reach *reach, uint16_t *number,
                           struct fault *fault)
{
    return forest_add_reach(session->forest, reach, number, fault);
}

void session_truncate_markers(struct session *session, size_t count)
{
    markers_drop(&session->markers, count, session->watch);
}

enum err session_plant(struct session *session, const uint32_t *cell, size_t count, int16_t label,
                       uint16_t reach, struct fault *fault)
{
    struct task task = task_begin(session->watch, "edits", count);
    TRY(markers_add(&session->markers, label, cell, count, session->watch, fault));
    const size_t number = session->markers.count;
    enum err err =
        edits_go_on(&session->now.lists.markers, (struct edit){(uint32_t)number, 1, 0}, fault);
    session->markers.marker[number - 1].reach = reach;
    session->markers.marker[number - 1].is_exact = forest_is_exact(session->forest, reach);
    session->markers.marker[number - 1].is_valid = err == OK;
    for (size_t i = 0; !err && i < count && task_advance(&task, 1); i++)
        err = add_pending(session, (struct edit){cell[i], label, reach}, fault);
    return err ? err : watch_fault(session->watch, fault);
}

enum err session_yield(struct session *session, const struct marker_run *run, size_t runs,
                       struct fault *fault)
{
    return markers_yield(&session->markers, run, runs, fault);
}

enum err session_free_voxels(struct session *session, const uint32_t *cell, size_t count,
                             struct fault *fault)
{
    const struct markers *markers = &session->markers;
    size_t i = markers->covers;
    struct adjacency around;
    adjacency_init(&around, 26, &session->scene->grid);
    TRY(markers_free(&session->markers, session->scene->cell, &around, cell, count, session->watch,
                     fault));
    struct task task = task_begin(session->watch, "edits", markers->covers - i);
    for (; i < markers->covers && task_advance(&task, 1); i++) {
        const uint32_t changed = markers->cover[i].cell;
        if (markers_can_plant(markers, changed))
            TRY(add_pending(session, markers_edit(markers, changed), fault));
    }
    return watch_fault(session->watch, fault);
}

void session_join(struct session *session)
{
    session->markers.marker[session->markers.count - 1].joined = true;
}

/* Remove a marker: where no later one covers a voxel, those below it decide. */
static enum err remove_marker(struct session *session, uint32_t number, struct fault *fault)
{
    const struct markers *markers = &session->markers;
    struct marker *marker = markers->marker + number - 1;
    TRY(edits_go_on(&session->now.lists.markers, (struct edit){number, EDIT_ERASE, 0}, fault));
    marker->is_valid = false;
    const size_t covers = marker->voxels + marker->frees;
    struct task task = task_begin(session->watch, "markers", covers);
    for (size_t i = 0; i < covers && task_advance(&task, 1); i++) {
        const uint32_t cell = markers->cover[marker->first + i].cell;
        if (markers_can_plant(markers, cell) && markers_at(markers, cell) < number)
            TRY(add_pending(session, markers_edit(markers, cell), fault));
    }
    const bool ends = marker->yields && markers->ends;
    for (size_t i = marker->first + covers; ends && i < markers->covers; i++) {
        const struct cover *cover = markers->cover + i;
        if (cover->is_beside && cover->from == number)
            TRY(add_pending(session, markers_edit(markers, cover->cell), fault));
    }
    return watch_fault(session->watch, fault);
}

/* A part of a stroke is removed with the first part; an eraser cannot be removed. */
static bool is_removable(const struct markers *markers, uint32_t number)
{
    if (number < 1 || number > markers->count)
        return false;
    const struct marker *marker = &markers->marker[number - 1];
    return marker->is_valid && !marker->joined && marker->label != EDIT_ERASE;
}

enum err session_remove_markers(struct session *session, const uint32_t *number, size_t count,
                                struct fault *fault)
{
    const struct markers *markers = &session->markers;
    for (size_t i = 0; i < count; i++)
        if (!is_removable(markers, number[i]))
            return fault_set(fault, ERR_CHECK, "there is no valid marker %u", number[i]);
        else
            for (uint32_t n = number[i]; n; n = markers_next(markers, n))
                TRY(remove_marker(session, n, fault));
    return OK;
}

/* Find the cells of pending seeds, sorted in the upper halves of numbers, so that a ball of
 * eliminators in a ball of seeds is fast. A pending seed that was erased before any run is
 * excluded. The caller frees *waiting, even on errors. */
static enum err find_waiting(uint64_t **waiting, size_t *count, const struct session *session,
                             struct fault *fault)
{
    const struct edit *pending = edits_first(&session->now.lists.pending);
    const size_t pendings = session_pendings(session);
    *waiting = mem_array(pendings, sizeof **waiting);
    *count = 0;
    if (!*waiting)
        return fault_memory(fault, "eliminators");
    for (size_t i = 0; i < pendings; i++)
        if (pending[i].label != EDIT_ERASE &&
            markers_seed(&session->markers, pending[i].cell) != EDIT_ERASE)
            (*waiting)[(*count)++] = (uint64_t)pending[i].cell << 32;
    return sort_by_upper_half(*waiting, *count, session->watch, fault);
}

static bool seed_waits(const uint64_t *waiting, size_t count, uint32_t cell)
{
    const uint64_t at = (uint64_t)cell << 32;
    return bsearch(&at, waiting, count, sizeof at, sort_compare) != NULL;
}

static enum err report_no_tree(const struct session *session, struct fault *fault)
{
    OWNED(mem_release) uint64_t *waiting = NULL;
    size_t count;
    TRY(find_waiting(&waiting, &count, session, fault));
    if (forest_seeds(session->forest) == 0 && count > 0)
        return fault_set(fault, ERR_INPUT,
                         "no tree holds this voxel yet: seeds wait for `run`; nothing has changed");
    return fault_set(fault, ERR_INPUT,
                     "no tree holds this voxel: no seed reaches it; nothing has changed");
}

/* Find the seeds of some voxels: the voxel itself if a seed is pending there, otherwise the root
 * of its tree. Seeds may repeat. The caller frees *seed, even on errors; it may be empty. */
static enum err find_seeds(const struct session *session, const uint32_t *cell, size_t count,
                           uint32_t **seed, size_t *seeds, struct fault *fault)
{
    OWNED(mem_release) uint64_t *waiting = NULL;
    size_t waits;
    struct task task = task_begin(session->watch, "eliminators", count);
    enum err err = find_waiting(&waiting, &waits, session, fault);
    *seed = mem_array(count, sizeof **seed);
    *seeds = 0;
    if (!err && !*seed)
        err = fault_memory(fault, "eliminators");
    for (size_t i = 0; !err && i < count && task_advance(&task, 1); i++) {
        const struct cell *at = session->scene->cell + cell[i];
        if (seed_waits(waiting, waits, cell[i]))
            (*seed)[(*seeds)++] = cell[i];
        else if (cell_is_reached(at))
            (*seed)[(*seeds)++] = key_root(at->key);
    }
    return err ? err : watch_fault(session->watch, fault);
}

/* A pending seed with an eraser above it belongs to no marker any more. */
enum err session_find_markers(const struct session *session, const uint32_t *cell, size_t count,
                              uint32_t **number, size_t *numbers, struct fault *fault)
{
    const struct markers *markers = &session->markers;
    struct task task = task_begin(session->watch, "eliminators", count);
    size_t seeds;
    *numbers = 0;
    /* seeds first, then markers */
    enum err err = find_seeds(session, cell, count, number, &seeds, fault);
    /* for each marker: one of its seeds was found */
    OWNED(mem_release) bool *holds = mem_new(markers->count + 1);
    if (!err && !holds)
        err = fault_memory(fault, "eliminators");
    for (size_t i = 0; !err && i < seeds && task_advance(&task, 1); i++) {
        const uint32_t one = markers_at(markers, (*number)[i]);
        holds[one ? markers_stroke(markers, one) : 0] = true;
    }
    for (size_t n = 1; !err && n <= markers->count; n++)
        if (holds[n] && markers->marker[n - 1].label != EDIT_ERASE)
            (*number)[(*numbers)++] = (uint32_t)n;
    err = err ? err : watch_fault(session->watch, fault);
    return err || *numbers ? err : report_no_tree(session, fault);
}

/* ---- the next step ---- */

enum proposal session_find_proposal(const struct session *session)
{
    const struct markers *markers = &session->markers;
    unsigned objects = 0, backgrounds = 0;
    int16_t object = 0;
    for (const struct marker *m = markers->marker; m < markers->marker + markers->count; m++) {
        if (!m->is_valid)
            continue;
        if (m->label == EDIT_ERASE || m->yields || (m->label && object && m->label != object))
            return PROPOSE_NOTHING;
        object = m->label ? m->label : object;
        objects += m->label != 0;
        backgrounds += m->label == 0;
    }
    return !objects                           ? PROPOSE_NOTHING
           : !backgrounds                     ? PROPOSE_SPHERE
           : objects == 1 && backgrounds == 1 ? PROPOSE_OUTLINE
                                              : PROPOSE_NOTHING;
}

/* ---- single trees ---- */

enum err session_erase_trees(struct session *session, const uint32_t *cell, size_t count,
                             struct fault *fault)
{
    OWNED(mem_release) uint32_t *seed = NULL;
    size_t seeds;
    const enum err err = find_seeds(session, cell, count, &seed, &seeds, fault);
    return err     ? err
           : seeds ? session_plant(session, seed, seeds, EDIT_ERASE, 0, fault)
                   : report_no_tree(session, fault);
}

enum err session_erase_seeds(struct session *session, const uint32_t *seed, size_t count,
                             struct fault *fault)
{
    OWNED(mem_release) uint64_t *waiting = NULL;
    size_t waits;
    TRY(find_waiting(&waiting, &waits, session, fault));
    for (size_t i = 0; i < count; i++)
        if (!(session->scene->cell[seed[i]].flags & CELL_SEED) &&
            !seed_waits(waiting, waits, seed[i]))
            return fault_set(fault, ERR_CHECK, "no seed is planted where one was taken away");
    return session_plant(session, seed, count, EDIT_ERASE, 0, fault);
}

enum err session_note_eliminator(struct session *session, uint32_t cell, struct fault *fault)
{
    return edits_add(&session->now.lists.eliminators, (struct edit){cell, EDIT_ERASE, 0}, fault);
}

/* ---- runs ---- */

enum err session_run(struct session *session, struct fault *fault)
{
    struct state next = session->now;
    struct edit_lists *lists = &next.lists;
    if (session_pendings(session) == 0)
        return OK;
    OWNED(edits_release) struct edits batch = lists->pending;
    edits_hold(&batch);
    lists->pending = (struct edits){0};
    lists->eliminators.first += lists->applied;
    lists->applied = edits_count(&lists->eliminators);
    return session_go(session, &next, edits_first(&batch), edits_count(&batch), fault);
}

/* ---- the effect of an eliminator ---- */

/* Count one seed. */
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

/* True if the marker, or a part of the same stroke, decides about a voxel. */
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
        if (marker->label != held->label) /* the ring of an outline */
            continue;
        for (size_t i = 0; i < marker->voxels && !held->has_more; i++) {
            const uint32_t cell = markers->cover[marker->first + i].cell;
            if (markers_at(markers, cell) == n)
                count_seed(held, session, cell);
        }
    }
}

enum err session_find_held(struct held *held, const struct session *session, uint32_t cell,
                           bool tree, struct fault *fault)
{
    OWNED(mem_release) uint32_t *found = NULL; /* the seed or the number of the marker */
    size_t count;
    *held = (struct held){.seed = CELL_NONE};
    const enum err err = tree ? find_seeds(session, &cell, 1, &found, &count, fault)
                              : session_find_markers(session, &cell, 1, &found, &count, fault);
    if (err || !count)
        return err ? err : fault_set(fault, ERR_INPUT, "no tree holds this voxel");
    if (!tree) {
        held->marker = *found;
        count_marker(held, session);
        return OK;
    }
    const int16_t label = markers_seed(&session->markers, *found);
    held->seed = *found;
    held->label = (uint8_t)(label == EDIT_ERASE ? session->scene->cell[*found].label : label);
    count_seed(held, session, *found);
    return OK;
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
