/* SPDX-License-Identifier: MIT */
/*
 * The inside of a forest, and the pass that solves it level by level: for forest.c, which edits
 * seeds, and forest_walk.c, which looks at all of it. The words are those of engine/forest.h.
 */
#ifndef ENGINE_PASS_H
#define ENGINE_PASS_H

#include "base/hash.h"
#include "engine/brush.h"
#include "engine/changes.h"
#include "engine/labels.h"
#include "engine/queue.h"
#include "engine/weight.h"

/* A list of cells that grows. */
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
    struct forest *forest;
    unsigned number;
    struct queue *queue;
    struct outbox outbox[TEAM_MOST];   /* to each other worker */
    uint64_t key_digest, label_digest; /* what it added in this pass */
    uint64_t served;
    bool starved; /* memory ran out */
    bool too_far; /* a path has as many hops as a key can hold (T3) */
    struct status {
        uint64_t lowest; /* level that waits, or QUEUE_EMPTY */
        uint64_t served;
        enum err err;
    } status;
};

/* Reaches, and which seeds have one. */
struct reaches {
    struct reach *item; /* item[n - 1] has number n */
    size_t count, capacity;
    uint16_t *of; /* [grid.cells], of the seed there: its number, or 0; NULL until there is one */
    size_t seeds; /* that have one */
};

struct forest {
    struct scene *scene;
    struct cell *cell; /* scene->cell */
    struct adjacency adjacency;
    struct arc_rule arcs;
    ptrdiff_t bytes_to[26]; /* the adjacency's offsets, in bytes */
    uint32_t state[26];     /* of a voxel with label 0 that waits, reached along each direction */
    uint32_t taken_mask;    /* what of a state stays when an offer is taken */
    uint32_t settled_mask;  /* and when a voxel has been served */
    size_t seeds;
    struct reaches reaches;

    struct change *change; /* [change_limit] */
    size_t changes, listed, change_limit;
    size_t unsettled; /* touched voxels without their final key */
    bool everything;
    uint64_t relabelled;         /* voxels of the edit so far that have another label */
    struct former_labels former; /* labels of before all grows anew, where they are counted */
    bool counts_anew;            /* forest_count_anew */

    struct edit *batch;   /* the edit at hand, in the order of cells, each voxel once */
    struct edit *inverse; /* the edit that takes it back, likewise */
    size_t edits, batch_capacity, inverse_capacity;
    bool suspended; /* there are seeds only */

    struct cells cleared; /* voxels that have lost their tree in this edit; the first of these */
    size_t offered;       /* have taken an offer, */
    size_t reoffered;     /* and wait for none any more */
    size_t clear_limit;   /* beyond so many everything grows anew instead: */
    bool lost_too_much;

    /* The watch of the edit at hand, which may end it early; not while it is taken back. Where it
     * ends a pass among voxels that lose their support, the forest is torn: no inverse edit leads
     * back. */
    struct task task;
    bool may_stop, torn;
    _Atomic bool cut_short; /* the pass: all workers leave their level */
    bool alone;             /* the first worker acts for all; set before all meet */
    bool pauses;            /* all workers leave the pass, to be shown; likewise */
    uint32_t level;         /* up to which all is served; UINT32_MAX between passes */

    bool from_scratch; /* the pass began with seeds only: no key will rise */
    struct forest_stats stats;
    uint64_t key_digest, label_digest;

    struct team *team; /* not owned; NULL for one worker */
    bool shared;       /* the pass is the whole team's; else worker 0's */
    unsigned owner_shift;
    uint8_t owner[256]; /* owner[cell >> owner_shift]: whose cell it is, where shared */
    unsigned workers;
    struct worker *worker; /* [workers] */
};

/* ---- the watch ---- */

/* `units` more are done. False, for the caller's own thread: end early, and leave what there is to
 * the inverse edit (T5). */
static inline bool goes_on(struct forest *forest, uint64_t units)
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

/* To be called before an edit changes a voxel: the first time, its share leaves the digest of keys
 * and its former label is stored. When the voxel has its final key, settle is called once. Where
 * the forest grows from nothing there is nothing to store. */
static inline void touch(struct forest *forest, uint32_t at)
{
    struct cell *cell = forest->cell + at;
    if (forest->from_scratch || cell->flags & CELL_TOUCHED)
        return;
    cell->flags |= CELL_TOUCHED;
    cell->former_label = cell->label;
    forest->key_digest -= key_share(at, cell->key);
    forest->unsettled++;
    forest->stats.touched++;
}

/* A touched voxel has its final key, or none, and will not be touched again in this edit. */
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

/* ---- reaches, where there are any ---- */

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

/* Gives a voxel a key and puts it in the queue, unless it waits at that level already. */
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

/* Removes a seed: its tree is cleared, and waits for reoffer_cleared. */
void uproot(struct forest *forest, uint32_t at);

/* Every cleared voxel takes the best offer of the frontier around it, and waits in the queue. Where
 * it is stopped, the next call goes on. */
void reoffer_cleared(struct forest *forest);

/* Serves every level from the lowest up, until nothing waits or something is wrong: ERR_MEMORY,
 * ERR_LIMIT (T3), or ERR_CANCELLED, where the scene's watch stops it and the forest `may_stop`. The
 * caller finds the words. */
enum err forest_pass(struct forest *forest);

#endif
