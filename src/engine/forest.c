#include "engine/forest.h"

#include <assert.h>
#include <stdlib.h>

#include "base/hash.h"
#include "base/mem.h"
#include "engine/queue.h"

enum {
    CHANGES_SHARE = 16, /* beyond this part of the scene the list becomes "everything" */
    BATCH = 1024,       /* queue entries taken at once */
    AHEAD = 8,          /* queue entries between fetching and serving */
};

/* A list of cells that grows. */
struct cells {
    uint32_t *item;
    size_t count, capacity;
};

struct forest {
    struct scene *scene;
    struct cell *cell; /* scene->cell */
    struct adjacency adjacency;
    struct arc_rule arcs;
    struct queue *queue;
    size_t seeds;

    struct change *change; /* [change_limit], each touched voxel once */
    size_t changes, change_limit;
    bool everything;
    bool must_recount; /* the digests are not right any more */

    struct edit *batch;   /* the edit at hand, in the order of cells, each voxel once */
    struct edit *inverse; /* what takes it back, likewise */
    size_t edits, batch_capacity, inverse_capacity;

    struct cells cleared; /* voxels that have lost their tree and wait for an offer */
    bool starved;         /* memory ran out in this pass */
    struct forest_stats stats;
    uint64_t key_digest, label_digest;
};

/* ---- digests ---- */

static inline uint64_t key_share(uint32_t cell, uint64_t key)
{
    return key == KEY_NONE ? 0 : hash_mix_at(cell, key);
}

static inline uint64_t label_share(uint32_t cell, uint8_t label)
{
    return label == 0 ? 0 : hash_mix_at(cell, label);
}

void forest_recount(const struct forest *forest, uint64_t *keys, uint64_t *labels)
{
    const struct grid *grid = &forest->scene->grid;
    *keys = *labels = 0;
    for (uint32_t z = 0; z < grid->size[2]; z++)
        for (uint32_t y = 0; y < grid->size[1]; y++) {
            struct span row = grid_row(grid, y, z);
            for (uint32_t c = row.first; c < row.end; c++) {
                const struct cell *cell = forest->cell + c;
                if (!cell_is_reached(cell))
                    continue;
                *keys += key_share(c, cell->key);
                *labels += label_share(c, cell->label);
            }
        }
}

/* ---- changes ---- */

/* Notes the first time that an edit is about to change a voxel. Its shares leave the digests here,
 * and serve adds the new ones: a pass serves each voxel that it touched and that has a key at its
 * end exactly once. Nothing is noted, or left to subtract, where the forest begins empty. */
static inline void touch(struct forest *forest, uint32_t at)
{
    struct cell *cell = forest->cell + at;
    if (cell->flags & CELL_TOUCHED || forest->everything)
        return;
    if (forest->changes == forest->change_limit) {
        forest->everything = forest->must_recount = true;
        return;
    }
    cell->flags |= CELL_TOUCHED;
    forest->change[forest->changes++] = (struct change){at, cell->label};
    forest->key_digest -= key_share(at, cell->key);
    forest->label_digest -= label_share(at, cell->label);
}

static void finish_changes(struct forest *forest)
{
    forest->stats.touched = forest->everything ? forest->scene->grid.voxels : forest->changes;
    for (size_t i = 0; i < forest->changes; i++)
        forest->cell[forest->change[i].cell].flags &= (uint8_t)~CELL_TOUCHED;
    if (forest->everything)
        forest->changes = 0;
    if (forest->must_recount)
        forest_recount(forest, &forest->key_digest, &forest->label_digest);
    forest->must_recount = false;
}

/* ---- offers ---- */

/* Gives a voxel a key and puts it in the queue, unless it waits at that level already. */
static inline void accept(struct forest *forest, uint32_t at, uint64_t key, uint8_t label,
                          unsigned direction)
{
    struct cell *cell = forest->cell + at;
    touch(forest, at);
    bool waits = cell->flags & CELL_QUEUED && key_level(cell->key) == key_level(key);
    cell->key = key;
    cell->label = label;
    cell->direction = (uint8_t)direction;
    if (!waits) {
        cell->flags |= CELL_QUEUED;
        queue_push(forest->queue, key_level(key), at);
    }
}

/* ---- clearing ---- */

static void clear_voxel(struct forest *forest, uint32_t at)
{
    struct cells *cleared = &forest->cleared;
    if (!mem_grow(&cleared->item, &cleared->capacity, cleared->count + 1, sizeof *cleared->item)) {
        forest->starved = true;
        return;
    }
    touch(forest, at);
    struct cell *cell = forest->cell + at;
    cell->key = KEY_NONE;
    cell->label = 0;
    cell->direction = DIRECTION_NONE;
    cell->heard = 0;
    cell->flags = (uint8_t)((cell->flags & ~CELL_QUEUED) | CELL_CLEARED);
    cleared->item[cleared->count++] = at;
}

/* Clears a voxel and all its descendants, appending them to `cleared`. */
static void clear_subtree(struct forest *forest, uint32_t top)
{
    const struct adjacency *adjacency = &forest->adjacency;
    size_t next = forest->cleared.count;
    clear_voxel(forest, top);
    for (; next < forest->cleared.count; next++) {
        uint32_t at = forest->cleared.item[next];
        for (unsigned i = 0; i < adjacency->count; i++) {
            uint32_t child = (uint32_t)(at + adjacency->offset[i]);
            if (forest->cell[child].direction == i)
                clear_voxel(forest, child);
        }
    }
}

/* Whether another neighbour offers a voxel the very key it has; if so, that is its predecessor from
 * now on. It cannot be a descendant: those have greater keys. On plateaus there often is one, and a
 * subtree need not be cleared. */
static bool finds_support(struct forest *forest, uint32_t at)
{
    const struct adjacency *adjacency = &forest->adjacency;
    struct cell *cell = forest->cell + at;
    for (unsigned i = 0; i < adjacency->count; i++) {
        const struct cell *neighbour = cell + adjacency->offset[i];
        if (neighbour->flags & CELL_CLEARED || !cell_is_reached(neighbour) ||
            key_extend(neighbour->key, arc_weight_now(&forest->arcs, neighbour, cell)) != cell->key)
            continue;
        cell->direction = (uint8_t)(adjacency->count - 1 - i); /* from the neighbour to here */
        return true;
    }
    return false;
}

/* The best offer of the neighbours that kept their tree: the frontier seen from within. */
static void reoffer(struct forest *forest, uint32_t at)
{
    const struct adjacency *adjacency = &forest->adjacency;
    const struct cell *cell = forest->cell + at;
    uint64_t best = KEY_NONE;
    unsigned direction = 0;
    for (unsigned i = 0; i < adjacency->count; i++) {
        const struct cell *neighbour = cell + adjacency->offset[i];
        if (neighbour->flags & CELL_CLEARED || !cell_is_reached(neighbour))
            continue;
        uint64_t offer = key_extend(neighbour->key, arc_weight_now(&forest->arcs, neighbour, cell));
        if (offer < best) {
            best = offer;
            direction = adjacency->count - 1 - i; /* from the neighbour to here */
        }
    }
    if (best != KEY_NONE)
        accept(forest, at, best, forest->cell[at - adjacency->offset[direction]].label, direction);
}

/* Every cleared voxel takes the best offer of its neighbours that kept theirs, and waits. */
static void reoffer_cleared(struct forest *forest)
{
    struct cells *cleared = &forest->cleared;
    for (size_t i = 0; i < cleared->count; i++)
        reoffer(forest, cleared->item[i]);
    for (size_t i = 0; i < cleared->count; i++)
        forest->cell[cleared->item[i]].flags &= (uint8_t)~CELL_CLEARED;
    forest->stats.cleared += cleared->count;
    cleared->count = 0;
}

/* ---- the pass ---- */

/* Compiled once for 6 neighbours and once for 26 and each kind of arc, as constants: loops over
 * them unroll, and the whole pass takes half the time. */
#define PER_ADJACENCY static inline __attribute__((always_inline))

/*
 * Passes the final key of s on. A neighbour takes an offer below its own key. A child of s whose
 * key is below the offer has lost its support, since extend does not keep the order of keys: its
 * subtree is cleared. All keys it may get lie above the level being served, so one monotone
 * pass is enough.
 *
 * A neighbour that still waits need not offer anything back when its turn comes: its key will be
 * above that of s. It remembers so in `heard`, and each pair of neighbours is looked at once
 * instead of twice: 40 % fewer cache misses and mispredicted branches.
 */
PER_ADJACENCY void serve(struct forest *forest, uint32_t s, const unsigned neighbours,
                         const enum arc_kind arcs)
{
    struct cell *cell = forest->cell;
    const struct adjacency *adjacency = &forest->adjacency;
    const uint64_t key = cell[s].key;
    const uint64_t hop = key_hop(key);
    const uint32_t root = key_root(key);
    const uint8_t label = cell[s].label;
    uint32_t open = ((1u << neighbours) - 1) & ~(uint32_t)cell[s].heard;
    cell[s].flags &= (uint8_t)~CELL_QUEUED;
    cell[s].heard = 0;
    forest->stats.served++;
    forest->key_digest += key_share(s, key);
    forest->label_digest += label_share(s, label);
    for (; open; open &= open - 1) {
        const unsigned i = (unsigned)__builtin_ctz(open);
        const uint32_t t = (uint32_t)(s + adjacency->offset[i]);
        const uint32_t weight = arc_weight(&forest->arcs, arcs, cell + s, cell + t, label);
        const uint64_t offer = key_greater(key_rise(weight, root), hop);
        if (offer < cell[t].key)
            accept(forest, t, offer, label, i);
        else if (__builtin_expect(cell[t].direction == i, 0) && offer != cell[t].key &&
                 !finds_support(forest, t))
            clear_subtree(forest, t);
        if (cell[t].flags & CELL_QUEUED)
            cell[t].heard |= (uint8_t)(1u << (neighbours - 1 - i)); /* of 26, the first 8 fit */
    }
    if (forest->cleared.count)
        reoffer_cleared(forest);
}

/* Two steps ahead of serve: first the cell, then, when it is there, what it will look at. */
static inline void fetch_cell(const struct forest *forest, uint32_t at)
{
    __builtin_prefetch(forest->cell + at, 1);
}

PER_ADJACENCY void fetch_neighbours(const struct forest *forest, uint32_t at,
                                    const unsigned neighbours)
{
    const ptrdiff_t *offset = forest->adjacency.offset;
    const struct cell *cell = forest->cell + at;
    const uint32_t heard = cell->heard;
#pragma GCC unroll 6
    for (unsigned i = 0; i < neighbours; i++) /* without a branch: itself is there already */
        __builtin_prefetch(cell + (heard & 1u << i ? 0 : offset[i]), 1);
}

PER_ADJACENCY void serve_level(struct forest *forest, uint32_t level, const unsigned neighbours,
                               const enum arc_kind arcs)
{
    uint32_t at[BATCH];
    for (size_t count; (count = queue_take(forest->queue, at, BATCH)) > 0;) {
        for (size_t i = 0; i < 2 * AHEAD && i < count; i++)
            fetch_cell(forest, at[i]);
        for (size_t i = 0; i < AHEAD && i < count; i++)
            fetch_neighbours(forest, at[i], neighbours);
        for (size_t i = 0; i < count; i++) {
            if (i + 2 * AHEAD < count)
                fetch_cell(forest, at[i + 2 * AHEAD]);
            if (i + AHEAD < count)
                fetch_neighbours(forest, at[i + AHEAD], neighbours);
            const struct cell *cell = forest->cell + at[i];
            if (cell->flags & CELL_QUEUED && key_level(cell->key) == level)
                serve(forest, at[i], neighbours, arcs);
        }
    }
}

PER_ADJACENCY void serve_level_of(struct forest *forest, uint32_t level, const enum arc_kind arcs)
{
    if (forest->adjacency.count == 6)
        serve_level(forest, level, 6, arcs);
    else
        serve_level(forest, level, 26, arcs);
}

/* Serves every level from the lowest up, until the queue is empty or something is wrong. */
static enum err pass(struct forest *forest, const struct forest_watch *watch)
{
    uint32_t level;
    while (queue_next_level(forest->queue, &level)) {
        const uint64_t before = forest->stats.served;
        if (forest->arcs.kind == ARC_TARGET)
            serve_level_of(forest, level, ARC_TARGET);
        else if (forest->arcs.kind == ARC_DIFFERENCE)
            serve_level_of(forest, level, ARC_DIFFERENCE);
        else
            serve_level_of(forest, level, ARC_POLARITY);
        if (forest->starved || queue_failed(forest->queue))
            return ERR_MEMORY;
        if ((level & 0xFFFF) == KEY_HOPS_LIMIT && forest->stats.served > before)
            return ERR_LIMIT;
        if (watch && watch->cancelled(watch->context, forest->stats.served))
            return ERR_CANCELLED;
    }
    /* Also where memory ran out before the first level, so that the queue was empty. */
    return forest->starved || queue_failed(forest->queue) ? ERR_MEMORY : OK;
}

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

/* ---- edits ---- */

static void uproot(struct forest *forest, uint32_t at)
{
    forest->cell[at].flags &= (uint8_t)~CELL_SEED;
    forest->seeds--;
    if (forest->cell[at].key != KEY_NONE)
        clear_subtree(forest, at);
}

static void plant(struct forest *forest, uint32_t at, uint8_t label)
{
    forest->cell[at].flags |= CELL_SEED;
    forest->seeds++;
    accept(forest, at, key_make(0, 0, at), label, DIRECTION_NONE);
}

/*
 * Changes the seeds and queues what follows from it; the pass does the rest. First every tree that
 * goes is cleared, then what was cleared takes its offers, then seeds are planted. A seed that
 * gets another label is removed and planted.
 */
static void change_seeds(struct forest *forest, const struct edit *edit, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        const struct cell *cell = forest->cell + edit[i].cell;
        if (cell->flags & CELL_SEED && cell->label != edit[i].label)
            uproot(forest, edit[i].cell);
    }
    reoffer_cleared(forest);
    for (size_t i = 0; i < count; i++)
        if (edit[i].label != EDIT_ERASE && !(forest->cell[edit[i].cell].flags & CELL_SEED))
            plant(forest, edit[i].cell, (uint8_t)edit[i].label);
}

/* Orders pointers to edits by cell, and those of one cell by their place in the batch. */
static int compare_edits(const void *a, const void *b)
{
    const struct edit *const *x = a, *const *y = b;
    if ((*x)->cell != (*y)->cell)
        return (*x)->cell < (*y)->cell ? -1 : 1;
    return *x < *y ? -1 : *x > *y;
}

/* Fills batch with the last edit of each voxel, and inverse with what is there now. */
static enum err prepare(struct forest *forest, const struct edit *edit, size_t count,
                        struct fault *fault)
{
    const struct edit **order = mem_array(count, sizeof *order);
    if (!order ||
        !mem_grow(&forest->batch, &forest->batch_capacity, count, sizeof *forest->batch) ||
        !mem_grow(&forest->inverse, &forest->inverse_capacity, count, sizeof *forest->inverse)) {
        free(order);
        return fault_memory(fault, "an edit");
    }
    for (size_t i = 0; i < count; i++)
        order[i] = edit + i;
    qsort(order, count, sizeof *order, compare_edits);
    forest->edits = 0;
    for (size_t i = 0; i < count; i++) {
        if (i + 1 < count && order[i + 1]->cell == order[i]->cell)
            continue;
        const struct cell *cell = forest->cell + order[i]->cell;
        assert(!(cell->flags & (CELL_RIM | CELL_FENCED)));
        int16_t former = cell->flags & CELL_SEED ? cell->label : EDIT_ERASE;
        forest->batch[forest->edits] = *order[i];
        forest->inverse[forest->edits++] = (struct edit){order[i]->cell, former};
    }
    free(order);
    return OK;
}

static void begin(struct forest *forest)
{
    forest->changes = 0;
    forest->everything = false;
    forest->starved = false;
    forest->stats = (struct forest_stats){0};
}

/* What a queued voxel has heard holds for a monotone pass; the inverse edit starts another. */
static void forget_offers(void *context, uint32_t at)
{
    const struct forest *forest = context;
    forest->cell[at].heard = 0;
}

/* Back to before the edit at hand, in the middle of its pass (T5). Where memory has run out and
 * entries were lost, the former seeds are put back and everything is computed again. */
static void take_back(struct forest *forest, enum err reason, struct fault *fault)
{
    if (reason != ERR_MEMORY) {
        queue_rewind(forest->queue);
        queue_each(forest->queue, forget_offers, forest);
        change_seeds(forest, forest->inverse, forest->edits);
        forest->must_recount = true; /* some voxels have been served twice */
        if (pass(forest, NULL) == OK) {
            finish_changes(forest);
            begin(forest);
            return;
        }
    }
    for (size_t i = 0; i < forest->edits; i++) {
        struct cell *cell = forest->cell + forest->inverse[i].cell;
        cell->flags &= (uint8_t)~CELL_SEED;
        if (forest->inverse[i].label != EDIT_ERASE) {
            cell->flags |= CELL_SEED;
            cell->label = (uint8_t)forest->inverse[i].label;
        }
    }
    struct fault again;
    if (forest_rebuild(forest, NULL, &again) != OK)
        fault_set(fault, ERR_MEMORY, "out of memory; the seeds are as before, run again");
}

enum err forest_edit(struct forest *forest, const struct edit *edit, size_t count,
                     const struct forest_watch *watch, struct fault *fault)
{
    enum err err = prepare(forest, edit, count, fault);
    if (err)
        return err;
    begin(forest);
    forest->everything = forest->seeds == 0; /* from scratch */
    change_seeds(forest, forest->batch, forest->edits);
    err = pass(forest, watch);
    if (err) {
        pass_fault(fault, err);
        take_back(forest, err, fault);
        return err;
    }
    finish_changes(forest);
    return OK;
}

enum err forest_revert(struct forest *forest, struct fault *fault)
{
    struct edit *inverse = mem_array(forest->edits, sizeof *inverse);
    if (!inverse)
        return fault_memory(fault, "taking an edit back");
    for (size_t i = 0; i < forest->edits; i++)
        inverse[i] = forest->inverse[i];
    enum err err = forest_edit(forest, inverse, forest->edits, NULL, fault);
    free(inverse);
    return err;
}

/* Leaves every voxel unreached and the queue empty; seeds stay, with their labels, and are queued
 * again where they are to be `planted`. */
static void clear_all(struct forest *forest, bool planted)
{
    const struct grid *grid = &forest->scene->grid;
    queue_clear(forest->queue);
    begin(forest);
    forest->cleared.count = 0;
    forest->everything = true;
    forest->seeds = 0;
    forest->key_digest = forest->label_digest = 0;
    for (uint32_t z = 0; z < grid->size[2]; z++)
        for (uint32_t y = 0; y < grid->size[1]; y++) {
            struct span row = grid_row(grid, y, z);
            for (uint32_t c = row.first; c < row.end; c++) {
                struct cell *cell = forest->cell + c;
                const bool seed = cell->flags & CELL_SEED;
                cell->flags &= CELL_SEED | CELL_FENCED;
                cell->key = cell->flags & CELL_FENCED ? 0 : KEY_NONE;
                cell->label = seed ? cell->label : 0;
                cell->direction = DIRECTION_NONE;
                cell->heard = 0;
                forest->seeds += seed;
                if (seed && planted)
                    accept(forest, c, key_make(0, 0, c), cell->label, DIRECTION_NONE);
            }
        }
}

enum err forest_rebuild(struct forest *forest, const struct forest_watch *watch,
                        struct fault *fault)
{
    clear_all(forest, true);
    enum err err = pass(forest, watch);
    if (err) {
        pass_fault(fault, err);
        fault_prefix(fault, err, "the forest has its seeds, but is not computed");
        clear_all(forest, false);
    }
    finish_changes(forest);
    return err;
}

/* ---- life ---- */

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
    forest->change = mem_pages(forest->change_limit * sizeof *forest->change);
    forest->queue = queue_new(scene->grid.cells);
    if (!forest->change || !forest->queue) {
        forest_free(forest);
        return fault_memory(fault, "a forest");
    }
    forest_set_adjacency(forest, adjacency);
    *out = forest;
    return OK;
}

void forest_set_adjacency(struct forest *forest, unsigned count)
{
    adjacency_init(&forest->adjacency, count, &forest->scene->grid);
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
    queue_free(forest->queue);
    free(forest->batch);
    free(forest->inverse);
    free(forest->cleared.item);
    free(forest);
}

struct changes forest_changes(const struct forest *forest)
{
    return (struct changes){forest->everything, forest->changes, forest->change};
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
    return sizeof *forest + forest->change_limit * sizeof *forest->change +
           queue_memory(forest->queue) + forest->cleared.capacity * sizeof(uint32_t) +
           (forest->batch_capacity + forest->inverse_capacity) * sizeof(struct edit);
}

uint64_t forest_digest(const struct forest *forest)
{
    return forest->key_digest;
}

uint64_t forest_label_digest(const struct forest *forest)
{
    return forest->label_digest;
}
