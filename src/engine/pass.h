/* SPDX-License-Identifier: MIT */
/*
 * The inside of a forest, and the pass that solves it level by level: for forest.c, which edits
 * seeds, and forest_walk.c, which checks all voxels. engine/forest.h defines the words.
 */
#ifndef ENGINE_PASS_H
#define ENGINE_PASS_H

#include "base/hash.h"
#include "engine/brush.h"
#include "engine/changes.h"
#include "engine/labels.h"
#include "engine/queue.h"
#include "engine/weight.h"

/* A growing list of cells. */
struct cells {
    uint32_t *item;
    size_t count, capacity;
};

/* An offer to a cell that another worker owns, and a growing list of them. */
struct posted_offer {
    uint64_t key;
    uint32_t cell, state;
};
struct outbox {
    struct posted_offer *item;
    size_t count, capacity;
};

/* One thread of a pass. It writes its status for the others before they meet (engine/pass.c). */
struct worker {
    unsigned number;
    struct queue *queue;
    struct outbox outbox[TEAM_MOST];   /* to each other worker */
    uint64_t key_digest, label_digest; /* sums that it added in this pass */
    uint64_t served, relabelled;       /* voxels; relabelled ones in a pass from scratch only */
    bool starved;                      /* memory ran out */
    bool too_far;                      /* a path has as many hops as a key can hold (T3) */
    struct status {
        uint64_t lowest; /* the lowest level in its queue, or QUEUE_EMPTY */
        uint64_t served;
        enum err err;
    } status;
};

/* Reaches, and the seeds that have one. */
struct reaches {
    struct reach *item; /* item[n - 1] has number n */
    size_t count, capacity;
    uint16_t exact; /* number of the exact reach, or 0 */
    uint16_t *of; /* [grid.cells], number of the seed's reach, or 0; NULL before the first reach */
    size_t seeds; /* seeds that have a reach */
};

struct forest {
    struct scene *scene;
    struct cell *cell; /* scene->cell */
    struct adjacency adjacency;
    struct arc_rule arcs;
    ptrdiff_t bytes_to[26]; /* the adjacency's offsets, in bytes */
    uint32_t state[26];     /* state of a queued voxel with label 0, reached along each direction */
    uint32_t taken_mask;    /* bits of a state that stay when an offer is accepted */
    uint32_t settled_mask;  /* bits that stay when a voxel has been served */
    size_t seeds;
    struct reaches reaches;

    struct change *change; /* [change_limit] */
    size_t changes, listed, change_limit;
    size_t unsettled; /* touched voxels without their final key */
    bool everything;
    uint64_t relabelled; /* voxels that the current edit has relabelled so far */

    struct edit *batch;          /* the current edit, sorted by cell, each voxel once */
    struct edit *inverse;        /* the edit that undoes it, likewise */
    const struct edit *changing; /* the one of them that is being carried out */
    size_t edits, batch_capacity, inverse_capacity;
    bool suspended; /* the forest has seeds only */

    struct cells cleared; /* voxels cleared in this edit; the first `offered` of them */
    size_t offered;       /* have accepted an offer, */
    size_t reoffered;     /* the first `reoffered` are not marked CELL_CLEARED any more */
    size_t clear_limit;   /* at this number, estimate how many voxels lose their tree: */
    bool lost_too_much;   /* the forest is rebuilt instead */

    /* The task of the current edit, which the watch may stop, except while the edit is undone. A
     * pass that is stopped while voxels lose their support leaves the forest torn: no inverse edit
     * leads back. */
    struct task task;
    bool may_stop, torn;
    _Atomic bool cut_short; /* ends the pass: all workers leave their level */
    bool alone;             /* the first worker acts for all; set before all meet */
    bool pauses;            /* all workers leave the pass so that it can be shown; likewise */

    bool from_scratch; /* the pass began with seeds only: no key will rise */
    struct forest_stats stats;
    uint64_t key_digest, label_digest;

    struct team *team; /* not owned; NULL for one worker */
    bool shared;       /* the whole team shares the pass; else worker 0 does it */
    unsigned owner_shift;
    uint8_t owner[256]; /* owner[cell >> owner_shift]: the worker that owns the cell, if shared */
    unsigned workers;
    struct worker *worker; /* [workers] */
};

/* ---- the watch ---- */

/* Advance the task by `units`. False, only on the caller's own thread: end early, and leave the
 * rest to the inverse edit (T5). */
static inline bool forest_advance(struct forest *forest, uint64_t units)
{
    if (forest->may_stop)
        return task_advance(&forest->task, units);
    task_show(&forest->task, units);
    return true;
}

static inline bool is_stopped(const struct forest *forest)
{
    const struct watch *watch = forest->scene->watch;
    return forest->may_stop && watch && watch->stopped;
}

/* ---- digests ---- */

static inline uint64_t key_share(uint32_t cell, uint64_t key)
{
    return key == KEY_NONE ? 0 : hash_mix_at(cell, key);
}

/* ---- changes ---- */

/* Call before an edit changes a voxel. The first call subtracts the voxel's share from the key
 * digest and stores its former label. settle must be called once when the voxel has its final key.
 * A pass from scratch has touched all voxels. */
static inline void touch(struct forest *forest, uint32_t at)
{
    struct cell *cell = forest->cell + at;
    if (forest->from_scratch || cell->flags & CELL_TOUCHED)
        return;
    cell_touch(cell);
    forest->key_digest -= key_share(at, cell->key);
    forest->unsettled++;
    forest->stats.touched++;
}

/* The touched voxel has its final key, or none, and will not be touched again in this edit. */
static inline void settle(struct forest *forest, uint32_t at)
{
    struct cell *cell = forest->cell + at;
    const bool relabelled = cell->label != cell->former_label;
    if (forest->changes == forest->change_limit)
        forest->everything = true;
    else
        forest->change[forest->changes] = (struct change){at, cell->former_label, cell->label};
    forest->changes += relabelled & !forest->everything;
    forest->relabelled += relabelled;
    forest->label_digest += label_share(at, cell->label) - label_share(at, cell->former_label);
    forest->unsettled--;
    cell->state &= forest->settled_mask;
}

/* ---- reaches, if there are any ---- */

static inline const struct reach *reach_of(const struct forest *forest, uint32_t root)
{
    const uint16_t number = forest->reaches.of[root];
    return number ? forest->reaches.item + number - 1 : NULL;
}

static inline bool tree_may_hold(const struct forest *forest, uint32_t root, struct place place)
{
    const struct reach *reach = reach_of(forest, root);
    return !reach || reach_holds(reach, place.x, place.y, place.z);
}

/* ---- offers ---- */

static inline unsigned owner_of(const struct forest *forest, uint32_t at)
{
    return forest->owner[at >> forest->owner_shift];
}

/* Set the key of a voxel and queue it, unless it is queued at that level already. */
static inline void accept(struct forest *forest, uint32_t at, uint64_t key, uint8_t label,
                          unsigned direction)
{
    struct cell *cell = forest->cell + at;
    touch(forest, at);
    const bool waits = cell->flags & CELL_QUEUED && key_level(cell->key) == key_level(key);
    cell->key = key;
    cell->label = label;
    cell->direction = (uint8_t)direction;
    cell->flags |= CELL_QUEUED;
    if (!waits)
        queue_push(forest->worker[forest->shared ? owner_of(forest, at) : 0].queue, key_level(key),
                   at);
}

/* ---- the work ---- */

/* By forest.c: estimate from samples whether a rebuild is faster than a repair. */
bool loses_too_much(const struct forest *forest);

/* Remove a seed: clear its tree, which then waits for reoffer_cleared. */
void remove_seed(struct forest *forest, uint32_t at);

/* Have every cleared voxel accept the best offer of the frontier around it, and queue it. After a
 * stop, the next call continues. */
void reoffer_cleared(struct forest *forest);

/* Serve every level from the lowest up, until the queue is empty or an error occurs: ERR_MEMORY,
 * ERR_LIMIT (T3), or ERR_CANCELLED, if the watch stops it and the forest `may_stop`. The caller
 * writes the message. */
enum err forest_pass(struct forest *forest);

#endif
