/* SPDX-License-Identifier: MIT */
#include "engine/forest.h"

#include <assert.h>
#include <stdlib.h>

#include "base/mem.h"
#include "base/sort.h"
#include "engine/pass.h"

enum {
    CHANGES_SHARE = 16,     /* above this part of the scene the list becomes "everything" */
    CLEARED_HELD = 1 << 20, /* entries of the list that are kept after an edit */
    CLEARED_SHARE = 32,     /* if a scene loses this part of itself, estimate the whole loss ... */
    CLEARED_FEW = 1 << 16,  /* ... provided that it is more voxels than this */
    OWNED_PARTS = 16,       /* parts of the scene for each worker */
    SAMPLES = 4096,         /* voxels sampled to estimate how many an edit clears */
    REPAIR_PERCENT = 38,    /* if an edit clears more of the voxels, one worker rebuilds faster */
    REPAIR_PERCENT_TEAM = 24, /* the same for a team, which shares rebuilds only */
};

/* ---- changes ---- */

static void forget_cleared(struct forest *forest)
{
    forest->cleared.count = forest->offered = forest->reoffered = 0;
}

/* Settle the voxels that a pass from scratch has not served. */
static void settle_unreached(struct forest *forest)
{
    const struct cell *end = forest->cell + forest->scene->grid.cells;
    for (struct cell *cell = forest->cell; cell < end; cell++) {
        forest->relabelled += cell->flags & CELL_TOUCHED && cell->label != cell->former_label;
        cell->state &= forest->settled_mask;
    }
}

/* Settle the voxels that are still unsettled after a pass: cleared voxels that no seed reaches.
 * Return false if the watch stopped it. */
static bool finish_changes(struct forest *forest)
{
    struct cells *cleared = &forest->cleared;
    for (size_t i = 0; forest->unsettled > 0 && i < cleared->count; i++) {
        if (!forest_advance(forest, 1))
            return false;
        if (forest->cell[cleared->item[i]].flags & CELL_TOUCHED)
            settle(forest, cleared->item[i]);
    }
    assert(forest->unsettled == 0);
    forest->listed = forest->changes;
    if (forest->everything)
        forest->changes = 0;
    if (forest->from_scratch) {
        forest->stats.touched = forest->scene->grid.voxels;
        if (forest->stats.served < forest->stats.touched)
            settle_unreached(forest);
    }
    forget_cleared(forest);
    if (cleared->capacity > CLEARED_HELD) {
        free(cleared->item);
        *cleared = (struct cells){0};
    }
    return true;
}

/* ---- seeds ---- */

static enum err pass_fault(struct fault *fault, enum err err)
{
    if (err == ERR_MEMORY)
        return fault_memory(fault, "the forest");
    if (err == ERR_LIMIT)
        return fault_set(fault, err,
                         "a path over a plateau has more than %d steps; plant a seed "
                         "nearer by (nothing has changed)",
                         KEY_HOPS_LIMIT - 1);
    return fault_set(fault, err, "cancelled; nothing has changed");
}

/* Set the reaches of the edits' seeds. From here on no voxel belongs to a seed whose reach
 * changes. */
static void set_reaches(struct forest *forest, const struct edit *edit, size_t count)
{
    struct reaches *reaches = &forest->reaches;
    for (size_t i = 0; reaches->of && i < count; i++) {
        uint16_t *of = reaches->of + edit[i].cell;
        reaches->seeds += (size_t)(edit[i].reach != 0);
        reaches->seeds -= (size_t)(*of != 0);
        *of = edit[i].reach;
    }
}

/* True if this edit removes the seed at its voxel, which may be replaced. */
static bool removes_seed(const struct forest *forest, const struct edit *edit)
{
    const struct cell *cell = forest->cell + edit->cell;
    const unsigned reach = forest->reaches.of ? forest->reaches.of[edit->cell] : 0;
    return cell->flags & CELL_SEED && (cell->label != edit->label || reach != edit->reach);
}

bool loses_too_much(const struct forest *forest)
{
    const size_t cells = forest->scene->grid.cells, step = cells / SAMPLES + 1;
    size_t reached = 0, lost = 0;
    for (size_t at = step / 2; at < cells; at += step) {
        const struct cell *cell = forest->cell + at;
        const bool cleared = cell->flags & CELL_CLEARED;
        if (!cleared && !cell_is_reached(cell))
            continue;
        const struct edit wanted = {.cell = key_root(cell->key)};
        const struct edit *edit = cleared ? NULL
                                          : bsearch(&wanted, forest->changing, forest->edits,
                                                    sizeof wanted, sort_compare_32);
        reached++;
        lost +=
            cleared ||
            (edit && (!(forest->cell[edit->cell].flags & CELL_SEED) || removes_seed(forest, edit)));
    }
    return lost * 100 > reached * (forest->workers > 1 ? REPAIR_PERCENT_TEAM : REPAIR_PERCENT);
}

/*
 * Change the seeds and queue all that follows from it; the pass does the rest. First every removed
 * tree is cleared, then cleared voxels accept offers of their neighbours, then seeds are planted. A
 * seed that changes its label or reach is removed and planted. If the edit clears so large a part
 * that a rebuild is faster, `lost_too_much` is set and the forest is undefined. May be stopped
 * anywhere: the former keys are valid again once the former seeds are planted.
 */
static void change_seeds(struct forest *forest, const struct edit *edit, size_t count)
{
    forest->lost_too_much = false;
    forest->changing = edit;
    for (size_t i = 0; forest->seeds > 0 && i < count && !forest->lost_too_much; i++) {
        if (!forest_advance(forest, 1))
            return;
        if (removes_seed(forest, edit + i))
            remove_seed(forest, edit[i].cell);
    }
    if (forest->lost_too_much || is_stopped(forest))
        return;
    set_reaches(forest, edit, count);
    reoffer_cleared(forest);
    for (size_t i = 0; !is_stopped(forest) && i < count && forest_advance(forest, 1); i++) {
        const uint32_t at = edit[i].cell;
        if (edit[i].label == EDIT_ERASE || forest->cell[at].flags & CELL_SEED)
            continue;
        forest->cell[at].flags |= CELL_SEED;
        forest->seeds++;
        accept(forest, at, key_make(0, 0, at), (uint8_t)edit[i].label, DIRECTION_NONE);
    }
}

/* Fill batch with the last edit of each voxel, sorted by cell. */
static enum err put_in_order(struct forest *forest, const struct edit *edit, size_t count,
                             struct fault *fault)
{
    uint64_t *rank =
        mem_array(count, sizeof *rank); /* cell and index in the edits, as one number */
    if (!rank)
        return fault_memory(fault, "an edit");
    for (size_t i = 0; i < count; i++)
        rank[i] = (uint64_t)edit[i].cell << 32 | i;
    enum err err = sort_by_upper_half(rank, count, forest->scene->watch, fault);
    forest->edits = 0;
    for (size_t i = 0; !err && i < count; i++)
        if (i + 1 == count || rank[i + 1] >> 32 != rank[i] >> 32)
            forest->batch[forest->edits++] = edit[(uint32_t)rank[i]];
    free(rank);
    return err;
}

/* Fill batch, and fill inverse with the current seeds of its voxels. */
static enum err prepare(struct forest *forest, const struct edit *edit, size_t count,
                        struct fault *fault)
{
    if (count > UINT32_MAX)
        return fault_set(fault, ERR_LIMIT, "%zu seeds at once are too many", count);
    if (!mem_grow(&forest->batch, &forest->batch_capacity, count, sizeof *forest->batch) ||
        !mem_grow(&forest->inverse, &forest->inverse_capacity, count, sizeof *forest->inverse))
        return fault_memory(fault, "an edit");
    bool in_order = true;
    for (size_t i = 1; in_order && i < count; i++)
        in_order = edit[i - 1].cell < edit[i].cell;
    forest->edits = count;
    TRY(in_order ? OK : put_in_order(forest, edit, count, fault));
    struct task task = task_begin(forest->scene->watch, "forest", forest->edits);
    for (size_t i = 0; i < forest->edits; i++) {
        if (!task_advance(&task, 1))
            return watch_fault(task.watch, fault);
        if (in_order)
            forest->batch[i] = edit[i];
        const struct edit *e = forest->batch + i;
        const struct cell *cell = forest->cell + e->cell;
        assert(!(cell->flags & CELL_RIM));
        assert(!(cell->flags & CELL_OUTSIDE) || e->label == EDIT_ERASE);
        assert(e->reach <= forest->reaches.count && (!e->reach || e->label != EDIT_ERASE));
        forest->inverse[i] =
            (struct edit){e->cell, cell->flags & CELL_SEED ? cell->label : EDIT_ERASE,
                          forest_reach_number(forest, e->cell)};
    }
    return OK;
}

/* Start a pass. A pass from seeds only is shared by the whole team. */
static void begin_pass(struct forest *forest, bool from_scratch)
{
    forest->task =
        task_begin(forest->scene->watch, "forest", from_scratch ? forest->scene->grid.voxels : 0);
    forest->torn = false;
    forest->changes = forest->listed = 0;
    forest->relabelled = 0;
    forest->everything = from_scratch;
    forest->from_scratch = from_scratch;
    forest->shared = from_scratch && forest->workers > 1;
    forest->stats = (struct forest_stats){0};
}

/* Replace the seeds at the voxels of `edit`, without computing anything. */
static void set_seeds(struct forest *forest, const struct edit *edit, size_t count)
{
    set_reaches(forest, edit, count);
    for (size_t i = 0; i < count; i++) {
        struct cell *cell = forest->cell + edit[i].cell;
        cell_touch(cell);
        forest->seeds -= (cell->flags & CELL_SEED) != 0;
        cell->flags &= (uint8_t)~CELL_SEED;
        if (edit[i].label != EDIT_ERASE) {
            forest->seeds++;
            cell->flags |= CELL_SEED;
            cell->label = (uint8_t)edit[i].label;
        }
    }
}

/* ---- rebuilding ---- */

/* Clear a cell. A seed keeps its flag and label, and is queued if it is to be `planted`. Return
 * whether the cell is a seed. */
static bool clear_cell(struct forest *forest, uint32_t at, bool planted)
{
    struct cell *cell = forest->cell + at;
    const uint8_t fixed = cell->flags & (CELL_SEED | CELL_OUTSIDE | CELL_RIM);
    if (fixed & CELL_RIM)
        return false;
    cell_touch(cell);
    cell->key = fixed & CELL_OUTSIDE ? 0 : KEY_NONE;
    cell->label = fixed & CELL_SEED ? cell->label : 0;
    cell->direction = DIRECTION_NONE;
    cell->flags = fixed | CELL_TOUCHED;
    if (fixed & CELL_SEED && planted)
        accept(forest, at, key_make(0, 0, at), cell->label, DIRECTION_NONE);
    return fixed & CELL_SEED;
}

struct clearing {
    struct forest *forest;
    bool planted;
    size_t seeds[TEAM_MOST]; /* counted by each worker */
};

enum { CLEARED_AT_ONCE = 1 << 14 };

static void clear_owned(void *context, unsigned number)
{
    struct clearing *clearing = context;
    struct forest *forest = clearing->forest;
    const size_t cells = forest->scene->grid.cells, part = (size_t)1 << forest->owner_shift;
    struct task task =
        task_begin_part(forest->scene->watch, "forest", cells / forest->workers, number);
    for (size_t first = number * part; first < cells; first += forest->workers * part) {
        const size_t end = first + part < cells ? first + part : cells;
        for (size_t at = first; at < end; at += CLEARED_AT_ONCE) {
            const size_t least = at + CLEARED_AT_ONCE < end ? at + CLEARED_AT_ONCE : end;
            size_t seeds = 0;
            for (size_t c = at; c < least; c++)
                seeds += clear_cell(forest, (uint32_t)c, clearing->planted);
            clearing->seeds[number] += seeds;
            if (!forest->may_stop)
                task_show(&task, least - at);
            else if (!task_advance(&task, least - at))
                return;
        }
    }
}

static void clear_all(struct forest *forest, bool planted)
{
    struct clearing clearing = {.forest = forest, .planted = planted};
    for (unsigned i = 0; i < forest->workers; i++)
        queue_clear(forest->worker[i].queue);
    begin_pass(forest, true);
    forget_cleared(forest);
    forest->unsettled = 0;
    forest->seeds = 0;
    forest->key_digest = forest->label_digest = 0;
    team_run(forest->team, clear_owned, &clearing);
    for (unsigned i = 0; i < forest->workers; i++)
        forest->seeds += clearing.seeds[i];
}

static enum err rebuild(struct forest *forest, struct fault *fault)
{
    clear_all(forest, true);
    enum err err = is_stopped(forest) ? ERR_CANCELLED : forest_pass(forest);
    if (err) {
        pass_fault(fault, err);
        forest->may_stop = false;
        clear_all(forest, false);
    }
    finish_changes(forest);
    return err;
}

/* ---- edits, and how they are undone ---- */

/*
 * Undo the current edit in the middle of its pass (T5). A forest that had no seeds before is
 * cleared. If entries were lost because memory ran out, or the forest was being rebuilt, or is
 * torn, plant the former seeds and rebuild; if even that fails, suspend the forest and return
 * ERR_MEMORY. Otherwise return `reason`.
 */
static enum err undo_edit(struct forest *forest, bool from_nothing, enum err reason,
                          struct fault *fault)
{
    forest->may_stop = false;
    if (from_nothing) {
        set_seeds(forest, forest->inverse, forest->edits);
        clear_all(forest, false);
        finish_changes(forest);
        begin_pass(forest, false);
        return reason;
    }
    if (reason != ERR_MEMORY && !forest->from_scratch && !forest->torn) {
        queue_rewind(forest->worker[0].queue);
        change_seeds(forest, forest->inverse, forest->edits);
        if (!forest->lost_too_much && forest_pass(forest) == OK) {
            finish_changes(forest);
            begin_pass(forest, false);
            return reason;
        }
    }
    set_seeds(forest, forest->inverse, forest->edits);
    struct fault again;
    if (rebuild(forest, &again) == OK)
        return reason;
    forest->suspended = true;
    return fault_set(fault, ERR_MEMORY,
                     "out of memory; the seeds are as before, and the next command recomputes "
                     "the forest");
}

enum err forest_edit(struct forest *forest, const struct edit *edit, size_t count,
                     struct fault *fault)
{
    TRY(prepare(forest, edit, count, fault));
    const bool from_nothing = forest->seeds == 0;
    if (forest->suspended) {
        set_seeds(forest, forest->batch, forest->edits);
        return OK;
    }
    begin_pass(forest, from_nothing);
    forest->may_stop = true;
    change_seeds(forest, forest->batch, forest->edits);
    if (forest->lost_too_much) {
        set_seeds(forest, forest->batch, forest->edits);
        clear_all(forest, true);
    }
    enum err err = is_stopped(forest) ? ERR_CANCELLED : forest_pass(forest);
    if (!err && !finish_changes(forest))
        err = ERR_CANCELLED;
    if (err) {
        pass_fault(fault, err);
        err = undo_edit(forest, from_nothing, err, fault);
    }
    return err;
}

enum err forest_rebuild(struct forest *forest, struct fault *fault)
{
    if (forest->suspended)
        return OK;
    forest->may_stop = true;
    return rebuild(forest, fault);
}

struct seed_changes forest_seed_changes(const struct forest *forest)
{
    return (struct seed_changes){forest->edits, forest->batch, forest->inverse};
}

void forest_suspend(struct forest *forest)
{
    forest->suspended = true;
}

bool forest_is_suspended(const struct forest *forest)
{
    return forest->suspended;
}

enum err forest_catch_up(struct forest *forest, struct fault *fault)
{
    forest->suspended = false;
    return forest_rebuild(forest, fault);
}

/* ---- creation and release ---- */

static void release_workers(struct worker *worker, unsigned workers)
{
    for (unsigned i = 0; worker && i < workers; i++) {
        queue_free(worker[i].queue);
        for (unsigned to = 0; to < workers; to++)
            free(worker[i].outbox[to].item);
    }
    free(worker);
}

/* One worker for each thread. Each owns several parts of the scene, so that all have work wherever
 * the trees grow. */
enum err forest_set_team(struct forest *forest, struct team *team, struct fault *fault)
{
    const size_t cells = forest->scene->grid.cells;
    const unsigned workers = team_size(team);
    struct worker *worker = mem_new(workers * sizeof *worker);
    if (!worker)
        return fault_memory(fault, "a forest");
    for (unsigned i = 0; i < workers; i++) {
        worker[i].number = i;
        worker[i].queue = queue_new(cells / workers);
        if (!worker[i].queue) {
            release_workers(worker, workers);
            return fault_memory(fault, "a forest");
        }
    }
    release_workers(forest->worker, forest->workers);
    forest->team = team;
    forest->worker = worker;
    forest->workers = workers;
    while (cells >> forest->owner_shift > OWNED_PARTS * (size_t)workers - 1 ||
           cells >> forest->owner_shift > 255)
        forest->owner_shift++;
    for (unsigned part = 0; part < 256; part++)
        forest->owner[part] = (uint8_t)(part % workers);
    return OK;
}

enum err forest_new(struct forest **out, struct scene *scene, unsigned adjacency,
                    struct fault *fault)
{
    *out = NULL;
    struct forest *forest = mem_new(sizeof *forest);
    if (!forest)
        return fault_memory(fault, "a forest");
    forest->scene = scene;
    forest->cell = scene->cell;
    forest->change_limit = scene->grid.voxels / CHANGES_SHARE + 1;
    forest->clear_limit = scene->grid.voxels / CLEARED_SHARE;
    if (forest->clear_limit < CLEARED_FEW)
        forest->clear_limit = CLEARED_FEW;
    forest->change = mem_pages(forest->change_limit * sizeof *forest->change);
    enum err err =
        forest->change ? forest_set_team(forest, NULL, fault) : fault_memory(fault, "a forest");
    if (err) {
        forest_free(forest);
        return err;
    }
    forest_set_adjacency(forest, adjacency);
    *out = forest;
    return OK;
}

void forest_set_adjacency(struct forest *forest, unsigned count)
{
    adjacency_init(&forest->adjacency, count, &forest->scene->grid);
    for (unsigned i = 0; i < count; i++) {
        forest->bytes_to[i] = forest->adjacency.offset[i] * (ptrdiff_t)sizeof(struct cell);
        forest->state[i] = cell_state(0, (uint8_t)i, CELL_QUEUED);
    }
    const struct cell taken = {.flags = CELL_TOUCHED | CELL_RAISED, .former_label = 255};
    forest->taken_mask = taken.state;
    forest->settled_mask = cell_state(255, 255, (uint8_t) ~(CELL_QUEUED | CELL_TOUCHED));
}

void forest_set_arcs(struct forest *forest, const struct arc_rule *arcs)
{
    forest->arcs = *arcs;
}

void forest_free(struct forest *forest)
{
    if (!forest)
        return;
    mem_pages_free(forest->change, forest->change_limit * sizeof *forest->change);
    release_workers(forest->worker, forest->workers);
    free(forest->batch);
    free(forest->inverse);
    free(forest->cleared.item);
    free(forest->reaches.item);
    mem_pages_free(forest->reaches.of, forest->scene->grid.cells * sizeof *forest->reaches.of);
    free(forest);
}

/* ---- queries ---- */

uint32_t forest_predecessor(const struct forest *forest, uint32_t cell)
{
    const struct cell *here = forest->cell + cell;
    for (unsigned i = 0; !(here->flags & CELL_SEED) && i < forest->adjacency.count; i++) {
        const struct cell *neighbour = here + forest->adjacency.offset[i];
        if (cell_is_reached(neighbour) &&
            key_extend(neighbour->key, arc_weight_now(&forest->arcs, neighbour, here)) ==
                here->key &&
            forest_may_hold(forest, key_root(here->key), cell))
            return (uint32_t)(neighbour - forest->cell);
    }
    return CELL_NONE;
}

struct changes forest_changes(const struct forest *forest)
{
    return (struct changes){forest->everything, forest->changes, forest->change, forest->listed,
                            forest->relabelled};
}

struct forest_stats forest_stats(const struct forest *forest)
{
    return forest->stats;
}

const struct scene *forest_scene(const struct forest *forest)
{
    return forest->scene;
}

const struct adjacency *forest_adjacency(const struct forest *forest)
{
    return &forest->adjacency;
}

const struct arc_rule *forest_arcs(const struct forest *forest)
{
    return &forest->arcs;
}

size_t forest_seeds(const struct forest *forest)
{
    return forest->seeds;
}

size_t forest_memory(const struct forest *forest)
{
    size_t bytes = sizeof *forest + forest->change_limit * sizeof *forest->change +
                   forest->cleared.capacity * sizeof(uint32_t) +
                   (forest->batch_capacity + forest->inverse_capacity) * sizeof(struct edit) +
                   forest->reaches.capacity * sizeof(struct reach);
    if (forest->reaches.of)
        bytes += forest->scene->grid.cells * sizeof *forest->reaches.of;
    for (unsigned i = 0; i < forest->workers; i++) {
        const struct worker *worker = forest->worker + i;
        bytes += sizeof *worker + queue_memory(worker->queue);
        for (unsigned to = 0; to < forest->workers; to++)
            bytes += worker->outbox[to].capacity * sizeof(struct posted_offer);
    }
    return bytes;
}

uint64_t forest_digest(const struct forest *forest)
{
    return forest->key_digest;
}

uint64_t forest_label_digest(const struct forest *forest)
{
    return forest->label_digest;
}
