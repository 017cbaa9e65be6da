/* SPDX-License-Identifier: MIT */
/*
 * The pass: levels (cost, hops) are served from the lowest up. A served voxel has its final key and
 * offers it to its neighbours. Keys of one level make no offers within it, so the voxels of a level
 * may be served in any order, and by several workers.
 *
 * Voxels are served in windows. First each makes its offers: neighbours that may accept one are
 * recorded without a branch, since the outcome is hard to predict. Then the offers are compared
 * again, and accepted where they still are the best. Cells are fetched two windows before they are
 * served, their neighbours one window before. On a scene of 7 million voxels this needs half the
 * time of serving voxel by voxel.
 *
 * Workers. If a forest grows from seeds only, a thread team shares the pass. Each cell has one
 * owner, the only worker that changes it and queues it. An offer to a cell of another worker goes
 * to the outbox for that worker, which reads it when all have served the level. A worker reads keys
 * of cells that it does not own while their owners may lower them: the owner declines a useless
 * offer, and no key ever rises. So each level ends with the same keys as if one worker had served
 * it. If the first worker has to wait for the others, because the machine is busy with other
 * programs, it continues alone in place of all of them. It does the same while levels are small,
 * as in scenes of 16 bits: the others sleep until a level is large.
 *
 * Support. Every key except a seed's is an offer of the predecessor. A voxel loses this support
 * when a seed is removed or the key of its predecessor changes; such voxels are processed first.
 */
#include "engine/pass.h"

#include <stdlib.h>

#include "base/clock.h"
#include "base/mem.h"

enum {
    WINDOW = 16,  /* voxels served together */
    BATCH = 1024, /* queue entries taken at once */
    OFFERS = WINDOW * 26 + 1,
    AHEAD = 6,              /* cleared voxels between prefetching one and using it */
    PATIENCE_NS = 15000000, /* waiting time after which the first worker continues alone */
    SMALL = 256,            /* a level with fewer voxels is small; */
    SMALL_LEVELS = 1024,    /* after more small levels in sequence one worker continues alone, */
    LARGE = 4096,           /* until a level has more voxels */
};

/* Parameters for which code is compiled separately, as constants: loops unroll and tests vanish. */
struct kind {
    unsigned neighbours;
    enum arc_kind arcs;
    bool mends;  /* keys may have changed under their children */
    bool shares; /* some cells are owned by other workers */
    bool limits; /* some seeds have a reach */
};
#define PER_KIND static inline __attribute__((always_inline))

/* Offers in three arrays, so that adding one needs three stores and an addition. */
struct offers {
    uint64_t key[OFFERS];
    uint32_t cell[OFFERS];
    uint32_t state[OFFERS]; /* state of the cell if it accepts the offer */
    size_t count;
};

/* One addition; indexing would need a multiplication. */
static inline const struct cell *neighbour_of(const struct forest *forest, const struct cell *cell,
                                              unsigned direction)
{
    return (const struct cell *)((const char *)cell + forest->bytes_to[direction]);
}

/* ---- the best offer ---- */

struct offer {
    uint64_t key;
    unsigned direction; /* from the neighbour to here */
};

/* The best offer to a voxel from neighbours with keys below `limit`, except cleared ones, computed
 * without a branch. `neighbours` and `arcs` are those of the forest, and `limits` is true if any
 * seed has a reach; they are constants where possible. */
PER_KIND struct offer best_offer(const struct forest *forest, uint32_t at, uint64_t limit,
                                 const unsigned neighbours, const enum arc_kind arcs,
                                 const bool limits)
{
    const struct cell *here = forest->cell + at;
    const struct place place =
        limits ? grid_place(&forest->scene->grid, at) : (struct place){0, 0, 0};
    struct offer best = {KEY_NONE, DIRECTION_NONE};
    for (unsigned i = 0; i < neighbours; i++) {
        const struct cell *neighbour = here + forest->adjacency.offset[i];
        bool offers = (neighbour->key - 1 < limit - 1) & !(neighbour->flags & CELL_CLEARED);
        if (limits && offers)
            offers = tree_may_hold(forest, key_root(neighbour->key), place);
        const uint32_t weight = arc_weight(&forest->arcs, arcs, neighbour, here, neighbour->label);
        const uint64_t key = key_extend(neighbour->key, weight) | ((uint64_t)offers - 1);
        best.direction = key < best.key ? neighbours - 1 - i : best.direction;
        best.key = key < best.key ? key : best.key;
    }
    return best;
}

/* ---- support ---- */

static void fetch_around(const struct forest *forest, uint32_t at)
{
    const struct adjacency *adjacency = &forest->adjacency;
    for (unsigned i = 0; i < adjacency->count; i++)
        __builtin_prefetch(forest->cell + at + adjacency->offset[i], 1);
}

static void clear_voxel(struct forest *forest, uint32_t at)
{
    struct cell *cell = forest->cell + at;
    touch(forest, at);
    cell->key = KEY_NONE;
    cell->label = 0;
    cell->direction = DIRECTION_NONE;
    cell->flags = (uint8_t)((cell->flags & ~(CELL_QUEUED | CELL_RAISED)) | CELL_CLEARED);
}

/* Clear a voxel and all its descendants, and append them to `cleared`. Stop if the list reaches
 * `limit` and the edit loses too much, or if the watch stops. The remaining descendants keep their
 * former keys, which are valid again after the inverse edit. */
static void clear_subtree(struct forest *forest, uint32_t top, size_t limit)
{
    const struct adjacency *adjacency = &forest->adjacency;
    struct cells *cleared = &forest->cleared;
    size_t next = cleared->count;
    if (!mem_grow(&cleared->item, &cleared->capacity, next + 1, sizeof *cleared->item)) {
        forest->worker[0].starved = true;
        return;
    }
    cleared->item[cleared->count++] = top;
    for (; next < cleared->count; next++) {
        if (next == limit && loses_too_much(forest)) {
            forest->lost_too_much = true;
            return;
        }
        if (!mem_grow(&cleared->item, &cleared->capacity, cleared->count + adjacency->count,
                      sizeof *cleared->item)) {
            cleared->count = next; /* the rest keeps its former keys; the pass fails */
            forest->worker[0].starved = true;
            return;
        }
        if (!forest_advance(forest, 1)) {
            cleared->count = next;
            return;
        }
        const uint32_t at = cleared->item[next];
        if (next + AHEAD < cleared->count)
            fetch_around(forest, cleared->item[next + AHEAD]);
        size_t count = cleared->count;
        for (unsigned i = 0; i < adjacency->count; i++) {
            const uint32_t child = at + (uint32_t)adjacency->offset[i];
            cleared->item[count] = child; /* stays in the list if it is a child */
            count += forest->cell[child].direction == i;
        }
        cleared->count = count;
        clear_voxel(forest, at);
    }
}

void remove_seed(struct forest *forest, uint32_t at)
{
    forest->cell[at].flags &= (uint8_t)~CELL_SEED;
    forest->seeds--;
    if (forest->cell[at].key != KEY_NONE)
        clear_subtree(forest, at, forest->clear_limit);
}

PER_KIND void offer_to_cleared(struct forest *forest, const bool limits)
{
    const struct adjacency *adjacency = &forest->adjacency;
    const struct cells *cleared = &forest->cleared;
    for (; forest->offered < cleared->count && forest_advance(forest, 1); forest->offered++) {
        const size_t i = forest->offered;
        if (i + AHEAD < cleared->count)
            fetch_around(forest, cleared->item[i + AHEAD]);
        const struct offer offer = best_offer(forest, cleared->item[i], KEY_NONE, adjacency->count,
                                              forest->arcs.kind, limits);
        if (offer.key == KEY_NONE)
            continue;
        const uint32_t at = cleared->item[i];
        const struct cell *from = forest->cell + at - adjacency->offset[offer.direction];
        accept(forest, at, offer.key, from->label, offer.direction);
    }
}

void reoffer_cleared(struct forest *forest)
{
    const struct cells *cleared = &forest->cleared;
    if (forest->reaches.seeds > 0)
        offer_to_cleared(forest, true);
    else
        offer_to_cleared(forest, false);
    if (forest->offered < cleared->count)
        return;
    const size_t before = forest->reoffered;
    for (; forest->reoffered < cleared->count && forest_advance(forest, 1); forest->reoffered++)
        forest->cell[cleared->item[forest->reoffered]].flags &= (uint8_t)~CELL_CLEARED;
    forest->stats.cleared += forest->reoffered - before;
}

/*
 * Handle a voxel whose predecessor, in `direction`, has just been served and offers it a greater
 * key than it has.
 *
 * extend preserves the order of levels, but not that of keys: if the level of a voxel falls, the
 * levels of its offers do not rise. So while weights do not depend on labels, a voxel whose
 * predecessor changed its key is still offered its own level, only by another root. The voxel that
 * offers it has a lower level and is no descendant, since all descendants have higher ones. So the
 * voxel waits at its level like any other, accepts the best offer when it is served, and its
 * children follow: nothing is cleared. If weights depend on labels, its level may rise, and if the
 * other root has a reach, it may receive no offer at all. Then its descendants cannot be
 * distinguished from voxels that might support it, and are cleared.
 */
static void lose_support(struct forest *forest, uint32_t at, uint64_t offer, unsigned direction)
{
    struct cell *cell = forest->cell + at;
    if (key_level(offer) == key_level(cell->key)) {
        accept(forest, at, offer, cell[-forest->adjacency.offset[direction]].label, direction);
        cell->flags |= CELL_RAISED;
    } else {
        clear_subtree(forest, at, SIZE_MAX);
        reoffer_cleared(forest);
        forest->torn |= is_stopped(forest);
    }
}

/* ---- offers ---- */

/* Accept the best offer for a voxel that had to accept another root: neighbours on lower levels
 * have their final keys by now. */
PER_KIND void accept_best_offer(struct forest *forest, uint32_t s, const struct kind kind)
{
    struct cell *here = forest->cell + s;
    const uint64_t limit = key_level_begin(key_level(here->key));
    const struct offer best = best_offer(forest, s, limit, kind.neighbours, kind.arcs, kind.limits);
    here->flags &= (uint8_t)~CELL_RAISED;
    if (best.key < here->key) {
        here->key = best.key;
        here->direction = (uint8_t)best.direction;
        here->label = here[-forest->adjacency.offset[best.direction]].label;
    }
}

/* Serve one voxel: record its offers to neighbours whose key is higher than the offer, and to
 * children whose key differs from it. An offer may be none. */
PER_KIND void make_offers(struct forest *forest, struct worker *worker, uint32_t s,
                          struct offers *offers, const struct kind kind)
{
    struct cell *here = forest->cell + s;
    if (kind.mends && here->flags & CELL_RAISED)
        accept_best_offer(forest, s, kind);
    const uint64_t key = here->key, hop = key_hop(key);
    const uint32_t root = key_root(key), state = cell_state(here->label, 0, 0);
    const struct reach *reach = kind.limits ? reach_of(forest, root) : NULL;
    const struct place place =
        reach ? grid_place(&forest->scene->grid, s) : (struct place){0, 0, 0};
    size_t count = offers->count;
    worker->served++;
    worker->key_digest += key_share(s, key);
    if (kind.mends) {
        settle(forest, s);
    } else {
        worker->label_digest += label_share(s, here->label);
        worker->relabelled += here->label != here->former_label;
        here->state &= forest->settled_mask;
    }
#pragma GCC unroll 6
    for (unsigned i = 0; i < kind.neighbours; i++) {
        const struct cell *t = neighbour_of(forest, here, i);
        const uint32_t weight = arc_weight(&forest->arcs, kind.arcs, here, t, here->label);
        const int8_t *step = forest->adjacency.step[i];
        const bool refuses = kind.limits && reach &&
                             !reach_holds(reach, (int64_t)place.x + step[0],
                                          (int64_t)place.y + step[1], (int64_t)place.z + step[2]);
        const uint64_t offer = refuses ? KEY_NONE : key_greater(key_rise(weight, root), hop);
        const uint64_t present = kind.shares ? __atomic_load_n(&t->key, __ATOMIC_RELAXED) : t->key;
        bool matters = offer < present;
        if (kind.mends)
            matters |= (t->direction == i) & (offer != present);
        offers->key[count] = offer;
        offers->cell[count] = s + (uint32_t)forest->adjacency.offset[i];
        offers->state[count] = state | forest->state[i];
        count += matters;
    }
    offers->count = count;
}

static void post_offer(struct worker *worker, unsigned to, uint64_t key, uint32_t cell,
                       uint32_t state)
{
    struct outbox *outbox = worker->outbox + to;
    if (mem_grow(&outbox->item, &outbox->capacity, outbox->count + 1, sizeof *outbox->item))
        outbox->item[outbox->count++] = (struct posted_offer){key, cell, state};
    else
        worker->starved = true;
}

/*
 * Have cells accept the offers that are below their keys. The outcome is hard to predict, as three
 * voxels often make one cell the same offer: so keys and states are always written through masks,
 * and cells are appended to the queue without a branch.
 */
PER_KIND void accept_offers(struct forest *forest, struct worker *worker, uint32_t level,
                            const struct offers *offers, const struct kind kind)
{
    uint32_t hop[OFFERS];
    struct waiting rise[OFFERS];
    size_t hops = 0, rises = 0;
    for (size_t i = 0; i < offers->count; i++) {
        const uint32_t at = offers->cell[i];
        const uint64_t offer = offers->key[i];
        struct cell *cell = forest->cell + at;
        if (kind.shares && owner_of(forest, at) != worker->number) {
            post_offer(worker, owner_of(forest, at), offer, at, offers->state[i]);
            continue;
        }
        const uint64_t former = cell->key;
        const bool takes = offer < former;
        if (kind.mends) {
            if (takes) {
                touch(forest, at);
            } else {
                const unsigned direction = cell_state_direction(offers->state[i]);
                if (offer != former && cell->direction == direction)
                    lose_support(forest, at, offer, direction);
                continue;
            }
        }
        const bool waits =
            ((cell->flags & CELL_QUEUED) != 0) & (key_level(former) == key_level(offer));
        const bool hopped = key_level(offer) == level + 1;
        const uint64_t key_mask = -(uint64_t)takes;
        const uint32_t state = offers->state[i] | (cell->state & forest->taken_mask);
        __atomic_store_n(&cell->key, former ^ ((former ^ offer) & key_mask), __ATOMIC_RELAXED);
        cell->state ^= (cell->state ^ state) & (uint32_t)key_mask;
        hop[hops] = at;
        hops += takes & !waits & hopped;
        rise[rises] = (struct waiting){key_level(offer), at};
        rises += takes & !waits & !hopped;
    }
    queue_push_hops(worker->queue, level + 1, hop, hops);
    queue_push_many(worker->queue, rise, rises);
}

/* ---- levels ---- */

static inline void fetch_cell(const struct forest *forest, uint32_t at)
{
    __builtin_prefetch(forest->cell + at, 1);
}

PER_KIND void fetch_neighbours(const struct forest *forest, uint32_t at, const struct kind kind)
{
#pragma GCC unroll 6
    for (unsigned i = 0; i < kind.neighbours; i++)
        __builtin_prefetch(neighbour_of(forest, forest->cell + at, i), 1);
}

PER_KIND void serve_batch(struct forest *forest, struct worker *worker, uint32_t level,
                          const uint32_t *at, size_t count, const struct kind kind)
{
    struct offers offers;
    for (size_t i = 0; i < 2 * WINDOW && i < count; i++)
        fetch_cell(forest, at[i]);
    for (size_t i = 0; i < WINDOW && i < count; i++)
        fetch_neighbours(forest, at[i], kind);
    for (size_t begin = 0; begin < count; begin += WINDOW) {
        const size_t end = begin + WINDOW < count ? begin + WINDOW : count;
        offers.count = 0;
        for (size_t i = begin; i < end; i++) {
            if (i + 2 * WINDOW < count)
                fetch_cell(forest, at[i + 2 * WINDOW]);
            if (i + WINDOW < count)
                fetch_neighbours(forest, at[i + WINDOW], kind);
            const struct cell *cell = forest->cell + at[i];
            if (cell->flags & CELL_QUEUED && key_level(cell->key) == level)
                make_offers(forest, worker, at[i], &offers, kind);
        }
        accept_offers(forest, worker, level, &offers, kind);
    }
}

/* Serve a level. The first worker's thread polls the watch within the level too: on a plateau it
 * may be as large as the scene. Unserved voxels stay in the queue (T5). */
PER_KIND void serve_level(struct forest *forest, struct worker *worker, uint32_t level,
                          const struct kind kind)
{
    uint32_t at[BATCH];
    for (size_t count; !forest->cut_short && (count = queue_take(worker->queue, at, BATCH)) > 0;) {
        serve_batch(forest, worker, level, at, count, kind);
        if ((worker->number == 0 || forest->alone) &&
            !forest_advance(forest, count * kind.neighbours / 6))
            forest->cut_short = true;
    }
}

PER_KIND void serve_around(struct forest *forest, struct worker *worker, uint32_t level,
                           const struct kind kind)
{
    struct kind faces = kind, corners = kind;
    faces.neighbours = 6;
    corners.neighbours = 26;
    if (forest->adjacency.count == 6)
        serve_level(forest, worker, level, faces);
    else
        serve_level(forest, worker, level, corners);
}

PER_KIND void serve_by(struct forest *forest, struct worker *worker, uint32_t level,
                       const enum arc_kind arcs)
{
    if (!forest->from_scratch)
        serve_around(forest, worker, level, (struct kind){.arcs = arcs, .mends = true});
    else if (!forest->shared)
        serve_around(forest, worker, level, (struct kind){.arcs = arcs});
    else
        serve_around(forest, worker, level, (struct kind){.arcs = arcs, .shares = true});
}

/* With reaches, the other properties are tested at run time: such forests are rare. */
static void serve(struct forest *forest, struct worker *worker, uint32_t level)
{
    const enum arc_kind arcs = forest->arcs.kind;
    if (forest->reaches.seeds > 0)
        serve_around(forest, worker, level,
                     (struct kind){.arcs = arcs,
                                   .mends = !forest->from_scratch,
                                   .shares = forest->shared,
                                   .limits = true});
    else if (arcs == ARC_TARGET)
        serve_by(forest, worker, level, ARC_TARGET);
    else if (arcs == ARC_DIFFERENCE)
        serve_by(forest, worker, level, ARC_DIFFERENCE);
    else
        serve_by(forest, worker, level, ARC_POLARITY);
}

/* Accept the offers that other workers have posted to this one. */
static void accept_posted_offers(struct forest *forest, struct worker *worker, uint32_t level)
{
    struct offers offers;
    for (unsigned from = 0; from < forest->workers; from++) {
        const struct outbox *outbox = forest->worker[from].outbox + worker->number;
        for (size_t i = 0; i < outbox->count;) {
            for (offers.count = 0; offers.count < OFFERS && i < outbox->count; i++) {
                offers.key[offers.count] = outbox->item[i].key;
                offers.cell[offers.count] = outbox->item[i].cell;
                offers.state[offers.count++] = outbox->item[i].state;
            }
            accept_offers(forest, worker, level, &offers, (struct kind){0});
        }
    }
}

/* ---- workers ---- */

struct pass {
    struct forest *forest;
    uint64_t begin_ns, waited_ns; /* begin of the pass, and waiting time of the first worker */
    uint64_t served;              /* voxels of all levels before the current one */
    unsigned small;               /* small levels in sequence */
    bool is_impatient;            /* the first worker is alone because it had to wait */
    bool calls_team;              /* the first worker stops being alone */
};

static void post_status(struct worker *worker, enum err err)
{
    if (!err && (worker->starved || queue_failed(worker->queue)))
        err = ERR_MEMORY;
    if (!err && worker->too_far)
        err = ERR_LIMIT;
    worker->status.lowest = queue_lowest(worker->queue);
    worker->status.served = worker->served;
    worker->status.err = err;
}

/* Status of all workers together; each worker computes the same. */
static struct status gather_status(const struct forest *forest)
{
    struct status all = {QUEUE_EMPTY, 0, OK};
    for (unsigned i = 0; i < (forest->shared ? forest->workers : 1); i++) {
        const struct worker *worker = forest->worker + i;
        all.lowest = worker->status.lowest < all.lowest ? worker->status.lowest : all.lowest;
        all.served += worker->status.served;
        all.err = all.err ? all.err : worker->status.err;
    }
    return all;
}

/* Wait for the other workers; the first one measures its waiting time. */
static void meet(struct pass *pass, struct team *team, unsigned number)
{
    const uint64_t begin = team && number == 0 ? clock_ns() : 0;
    team_wait(team);
    if (begin)
        pass->waited_ns += clock_ns() - begin;
}

static void serve_own(struct forest *forest, struct worker *worker, uint32_t level)
{
    queue_serve(worker->queue, level);
    for (unsigned i = 0; i < forest->workers; i++)
        worker->outbox[i].count = 0;
    const uint64_t before = worker->served;
    serve(forest, worker, level);
    if ((level & 0xFFFF) == KEY_HOPS_LIMIT && worker->served > before)
        worker->too_far = true;
}

/* The work of one worker in a pass. */
static void work(void *context, unsigned number)
{
    struct pass *pass = context;
    struct forest *forest = pass->forest;
    struct team *team = forest->shared ? forest->team : NULL;
    unsigned end = number + 1; /* acts for the workers number..end-1 */
    post_status(forest->worker + number, OK);
    meet(pass, team, number);
    for (;;) {
        if (forest->alone && number > 0)
            break;
        if (forest->alone) {
            end = forest->workers;
            team = NULL;
        }
        const struct status all = gather_status(forest);
        if (all.err || all.lowest == QUEUE_EMPTY || forest->pauses || pass->calls_team)
            break;
        const uint32_t level = (uint32_t)all.lowest;
        for (unsigned i = number; i < end; i++)
            serve_own(forest, forest->worker + i, level);
        meet(pass, team, number);
        bool cancelled = false;
        if (number == 0) {
            /* Continue alone after a long wait, if that was most of the time, and while levels are
             * small. Once alone, write no more: the other workers may not have read it yet. */
            const uint64_t served = all.served - pass->served;
            pass->served = all.served;
            pass->small = served < SMALL ? pass->small + 1 : 0;
            if (team) {
                pass->is_impatient = pass->waited_ns > PATIENCE_NS &&
                                     pass->waited_ns > (clock_ns() - pass->begin_ns) / 2;
                forest->alone = pass->is_impatient || pass->small > SMALL_LEVELS;
            } else {
                pass->calls_team = forest->alone && !pass->is_impatient && served > LARGE;
            }
            if (forest->task.watch) {
                forest->task.done = all.served;
                cancelled = (!task_poll(&forest->task) && forest->may_stop) || forest->cut_short;
            }
            forest->pauses = forest->may_stop && watch_wants_show(forest->task.watch);
        }
        for (unsigned i = number; i < end; i++) {
            if (forest->shared)
                accept_posted_offers(forest, forest->worker + i, level);
            post_status(forest->worker + i, cancelled ? ERR_CANCELLED : OK);
        }
        meet(pass, team, number);
    }
}

enum err forest_pass(struct forest *forest)
{
    struct pass pass = {.forest = forest, .begin_ns = clock_ns()};
    struct status all;
    forest->cut_short = forest->alone = false;
    do {
        forest->alone = forest->alone && !pass.calls_team;
        forest->pauses = pass.calls_team = false;
        team_run(forest->shared ? forest->team : NULL, work, &pass);
        all = gather_status(forest);
        if (forest->pauses && !all.err)
            watch_show(forest->task.watch);
    } while ((forest->pauses || pass.calls_team) && !all.err);
    for (unsigned i = 0; i < forest->workers; i++) {
        struct worker *worker = forest->worker + i;
        forest->stats.served += worker->served;
        forest->key_digest += worker->key_digest;
        forest->label_digest += worker->label_digest;
        forest->relabelled += worker->relabelled;
        worker->served = worker->relabelled = worker->key_digest = worker->label_digest = 0;
        worker->starved = worker->too_far = false;
        for (unsigned to = 0; to < forest->workers; to++) {
            free(worker->outbox[to].item);
            worker->outbox[to] = (struct outbox){0};
        }
        if (!all.err)
            queue_trim(worker->queue);
    }
    return all.err;
}
