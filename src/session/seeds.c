/* Seeds of a session: planted, eliminated, run; and what labels come to have. */
#include "session/session.h"

#include <stdlib.h>

#include "base/mem.h"

/* ---- markers ---- */

enum err session_plant(struct session *session, const uint32_t *cell, size_t count, int16_t label,
                       struct fault *fault)
{
    enum err err = markers_add(&session->markers, label, cell, count, fault);
    if (err)
        return err;
    const size_t number = session->markers.count;
    err = edits_add(&session->now.lists.markers, (struct edit){(uint32_t)number, 1}, fault);
    session->markers.marker[number - 1].stands = err == OK;
    for (size_t i = 0; !err && i < count; i++)
        err = edits_add(&session->now.lists.pending, (struct edit){cell[i], label}, fault);
    return err;
}

/* Where no later marker covers a voxel, those below decide from now on. */
static enum err take_away(struct session *session, uint32_t number, struct fault *fault)
{
    const struct markers *markers = &session->markers;
    struct marker *marker = markers->marker + number - 1;
    enum err err = edits_add(&session->now.lists.markers, (struct edit){number, EDIT_ERASE}, fault);
    if (err)
        return err;
    marker->stands = false;
    for (size_t i = 0; !err && i < marker->voxels; i++) {
        const uint32_t cell = markers->cover[marker->first + i].cell;
        if (markers_at(markers, cell) < number)
            err = edits_add(&session->now.lists.pending,
                            (struct edit){cell, markers_seed(markers, cell)}, fault);
    }
    return err;
}

enum err session_take_away(struct session *session, const uint32_t *number, size_t count,
                           struct fault *fault)
{
    const struct markers *markers = &session->markers;
    enum err err = OK;
    for (size_t i = 0; !err && i < count; i++)
        if (number[i] < 1 || number[i] > markers->count || !markers->marker[number[i] - 1].stands)
            err = fault_set(fault, ERR_CHECK, "no marker %u stands", number[i]);
        else
            err = take_away(session, number[i], fault);
    return err;
}

static int compare_cells(const void *a, const void *b)
{
    const uint32_t *x = a, *y = b;
    return *x < *y ? -1 : *x > *y;
}

/* The cells where seeds wait to be planted, in order, so that a ball of eliminators among a ball of
 * seeds takes no time worth mentioning. NULL when out of memory. */
static uint32_t *waiting_seeds(const struct session *session, size_t *count)
{
    const struct edit *pending = edits_first(&session->now.lists.pending);
    const size_t pendings = session_pendings(session);
    uint32_t *cell = mem_array(pendings, sizeof *cell);
    *count = 0;
    for (size_t i = 0; cell && i < pendings; i++)
        if (pending[i].label != EDIT_ERASE)
            cell[(*count)++] = pending[i].cell;
    if (cell)
        qsort(cell, *count, sizeof *cell, compare_cells);
    return cell;
}

static enum err holds_nothing(const struct session *session, struct fault *fault)
{
    if (forest_seeds(session->forest) == 0 && session_pendings(session) > 0)
        return fault_set(fault, ERR_INPUT,
                         "no tree holds this voxel yet: seeds wait for `run`; nothing has changed");
    return fault_set(fault, ERR_INPUT,
                     "no tree holds this voxel: no seed reaches it; nothing has changed");
}

/* The seeds that some voxels belong to: the voxel itself where one waits to be planted there, else
 * the root of its tree. One that several belong to is there as often. An array that the caller
 * frees; it may be empty. */
static enum err find_seeds(const struct session *session, const uint32_t *cell, size_t count,
                           uint32_t **seed, size_t *seeds, struct fault *fault)
{
    size_t waits;
    uint32_t *waiting = waiting_seeds(session, &waits);
    *seed = mem_array(count, sizeof **seed);
    *seeds = 0;
    for (size_t i = 0; waiting && *seed && i < count; i++) {
        const struct cell *at = session->scene->cell + cell[i];
        if (bsearch(&cell[i], waiting, waits, sizeof *waiting, compare_cells))
            (*seed)[(*seeds)++] = cell[i];
        else if (cell_is_reached(at))
            (*seed)[(*seeds)++] = key_root(at->key);
    }
    const bool lacks = !waiting || !*seed;
    free(waiting);
    return lacks ? fault_memory(fault, "eliminators") : OK;
}

/* An eraser decides where a seed waits to be taken away: that one belongs to no marker any more. */
enum err session_find_markers(const struct session *session, const uint32_t *cell, size_t count,
                              uint32_t **number, size_t *numbers, struct fault *fault)
{
    const struct markers *markers = &session->markers;
    uint32_t *all; /* seeds, and in their places the numbers of their markers */
    size_t seeds, found = 0;
    enum err err = find_seeds(session, cell, count, &all, &seeds, fault);
    for (size_t i = 0; i < seeds; i++) {
        const uint32_t one = markers_at(markers, all[i]);
        if (one && markers->marker[one - 1].label != EDIT_ERASE)
            all[found++] = one;
    }
    *number = all;
    *numbers = 0;
    if (err)
        return err;
    qsort(all, found, sizeof *all, compare_cells);
    for (size_t i = 0; i < found; i++)
        if (i == 0 || all[i] != all[i - 1])
            all[(*numbers)++] = all[i];
    return *numbers ? OK : holds_nothing(session, fault);
}

/* ---- single trees ---- */

enum err session_erase_trees(struct session *session, const uint32_t *cell, size_t count,
                             struct fault *fault)
{
    uint32_t *seed;
    size_t seeds;
    enum err err = find_seeds(session, cell, count, &seed, &seeds, fault);
    if (!err)
        err = seeds ? session_plant(session, seed, seeds, EDIT_ERASE, fault)
                    : holds_nothing(session, fault);
    free(seed);
    return err;
}

enum err session_erase_seeds(struct session *session, const uint32_t *seed, size_t count,
                             struct fault *fault)
{
    size_t waits;
    uint32_t *waiting = waiting_seeds(session, &waits);
    enum err err = waiting ? OK : fault_memory(fault, "eliminators");
    for (size_t i = 0; !err && i < count; i++)
        if (!(session->scene->cell[seed[i]].flags & CELL_SEED) &&
            !bsearch(&seed[i], waiting, waits, sizeof *seed, compare_cells))
            err = fault_set(fault, ERR_CHECK, "no seed is planted where one was taken away");
    free(waiting);
    return err ? err : session_plant(session, seed, count, EDIT_ERASE, fault);
}

enum err session_note_eliminator(struct session *session, uint32_t cell, struct fault *fault)
{
    return edits_add(&session->now.lists.eliminators, (struct edit){cell, EDIT_ERASE}, fault);
}

/* ---- runs ---- */

enum err session_run(struct session *session, struct fault *fault)
{
    struct state next = session->now;
    struct edit_lists *lists = &next.lists;
    struct edits batch = lists->pending;
    if (edits_count(&batch) == 0)
        return OK;
    lists->pending = (struct edits){0};
    lists->eliminators.first += lists->applied;
    lists->applied = edits_count(&lists->eliminators);
    edits_hold(&batch);
    enum err err = session_go(session, &next, edits_first(&batch), edits_count(&batch), fault);
    edits_release(&batch);
    return err;
}

/* ---- what labels have ---- */

enum err session_count_labels(struct session *session, struct fault *fault)
{
    return tally_refresh(&session->tally, session->scene, session->team)
               ? OK
               : watch_fault(session->scene->watch, fault);
}

enum err session_count_before(struct session *session, struct fault *fault)
{
    forest_count_anew(session->forest);
    enum err err = session_count_labels(session, fault);
    session->former_tally = session->tally;
    return err;
}

/* A forest that grew from nothing had label 0 everywhere. */
uint64_t session_changed_voxels(const struct session *session)
{
    const uint64_t background = session->tally.voxels[0], all = session->scene->grid.voxels;
    const uint64_t changed = forest_changes(session->forest).voxels;
    const bool had_none = session->former_tally.voxels[0] == all;
    return changed == CHANGES_UNKNOWN && had_none ? all - background : changed;
}
