/* Seeds of a session: planted, eliminated, run; and what labels come to have. */
#include "session/session.h"

#include <stdlib.h>

#include "base/mem.h"

/* Nothing is made of what only waits. */
static enum err wait_for_run(struct session *session, uint32_t cell, int16_t label,
                             struct fault *fault)
{
    return edits_add(&session->now.pending, (struct edit){cell, label}, fault);
}

enum err session_plant(struct session *session, uint32_t cell, uint8_t label, struct fault *fault)
{
    return wait_for_run(session, cell, label, fault);
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
    const struct edit *pending = edits_first(&session->now.pending);
    const size_t pendings = edits_count(&session->now.pending);
    uint32_t *cell = mem_array(pendings, sizeof *cell);
    *count = 0;
    for (size_t i = 0; cell && i < pendings; i++)
        if (pending[i].label != EDIT_ERASE)
            cell[(*count)++] = pending[i].cell;
    if (cell)
        qsort(cell, *count, sizeof *cell, compare_cells);
    return cell;
}

enum err session_eliminate(struct session *session, const uint32_t *cell, size_t count,
                           struct fault *fault)
{
    const size_t before = edits_count(&session->now.pending);
    size_t seeds;
    uint32_t *seed = waiting_seeds(session, &seeds);
    enum err err = seed ? OK : fault_memory(fault, "eliminators");
    for (size_t i = 0; !err && i < count; i++) {
        const struct cell *at = session->scene->cell + cell[i];
        if (bsearch(&cell[i], seed, seeds, sizeof *seed, compare_cells))
            err = wait_for_run(session, cell[i], EDIT_ERASE, fault);
        else if (cell_is_reached(at))
            err = wait_for_run(session, key_root(at->key), EDIT_ERASE, fault);
    }
    free(seed);
    if (!err && edits_count(&session->now.pending) == before)
        err = fault_set(fault, ERR_INPUT,
                        "no tree holds this voxel: no seed reaches it; nothing has changed");
    return err;
}

enum err session_eliminate_seeds(struct session *session, const uint32_t *seed, size_t count,
                                 struct fault *fault)
{
    size_t waits;
    uint32_t *waiting = waiting_seeds(session, &waits);
    enum err err = waiting ? OK : fault_memory(fault, "eliminators");
    for (size_t i = 0; !err && i < count; i++) {
        const bool is_planted = session->scene->cell[seed[i]].flags & CELL_SEED;
        if (is_planted || bsearch(&seed[i], waiting, waits, sizeof *seed, compare_cells))
            err = wait_for_run(session, seed[i], EDIT_ERASE, fault);
        else
            err = fault_set(fault, ERR_CHECK, "no seed is planted where one was taken away");
    }
    free(waiting);
    return err;
}

enum err session_note_eliminator(struct session *session, uint32_t cell, struct fault *fault)
{
    return edits_add(&session->now.eliminators, (struct edit){cell, EDIT_ERASE}, fault);
}

/* ---- runs ---- */

enum err session_run(struct session *session, struct fault *fault)
{
    struct edits batch = session->now.pending;
    struct state next = session->now;
    if (edits_count(&batch) == 0)
        return OK;
    next.pending = (struct edits){0};
    next.eliminators.first += next.applied;
    next.applied = edits_count(&next.eliminators);
    edits_hold(&batch);
    enum err err = session_go(session, &next, edits_first(&batch), edits_count(&batch), fault);
    edits_release(&batch);
    return err;
}

/* ---- what labels have ---- */

enum err session_count_labels(struct session *session, struct fault *fault)
{
    if (!tally_refresh(&session->tally, session->scene, session->team))
        return watch_fault(session->scene->watch, fault);
    if (!session->edited && !session->regrown)
        session->former_tally = session->tally;
    return OK;
}

uint64_t session_label_voxels(const struct session *session, uint8_t label)
{
    return session->tally.voxels[label];
}

uint64_t session_label_former_voxels(const struct session *session, uint8_t label)
{
    return session->former_tally.voxels[label];
}
