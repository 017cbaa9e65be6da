/*
 * Support: every key but a seed's is what the predecessor offers. This file is about voxels that
 * lose that, because a seed was removed or because the key of their predecessor has changed.
 */
#include "engine/forest_parts.h"

#include "base/mem.h"

enum { AHEAD = 6 }; /* voxels between fetching one and using it */

/* ---- the best offer ---- */

static void take(struct forest *forest, uint32_t at, struct offer offer)
{
    const struct cell *from = forest->cell + at - forest->adjacency.offset[offer.direction];
    accept(forest, at, offer.key, from->label, offer.direction);
}

static void fetch_around(const struct forest *forest, uint32_t at)
{
    const struct adjacency *adjacency = &forest->adjacency;
    for (unsigned i = 0; i < adjacency->count; i++)
        __builtin_prefetch(forest->cell + at + adjacency->offset[i], 1);
}

/* ---- clearing ---- */

static void clear_voxel(struct forest *forest, uint32_t at)
{
    struct cell *cell = forest->cell + at;
    touch(forest, at);
    cell->key = KEY_NONE;
    cell->label = 0;
    cell->direction = DIRECTION_NONE;
    cell->flags = (uint8_t)((cell->flags & ~(CELL_QUEUED | CELL_RAISED)) | CELL_CLEARED);
}

/* Clears a voxel and all its descendants, appending them to `cleared`; stops where that is to grow
 * beyond `limit`, and where the watch says so. Descendants that are left then have the keys of
 * before, which the inverse edit will find to be right. */
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
        if (next >= limit) {
            forest->lost_too_much = true;
            return;
        }
        if (!mem_grow(&cleared->item, &cleared->capacity, cleared->count + adjacency->count,
                      sizeof *cleared->item)) {
            cleared->count = next; /* the rest has its former keys; the pass is lost */
            forest->worker[0].starved = true;
            return;
        }
        if (!goes_on(forest, 1)) {
            cleared->count = next;
            return;
        }
        const uint32_t at = cleared->item[next];
        if (next + AHEAD < cleared->count)
            fetch_around(forest, cleared->item[next + AHEAD]);
        size_t count = cleared->count;
        for (unsigned i = 0; i < adjacency->count; i++) {
            const uint32_t child = at + (uint32_t)adjacency->offset[i];
            cleared->item[count] = child; /* stays, if it is one */
            count += forest->cell[child].direction == i;
        }
        cleared->count = count;
        clear_voxel(forest, at);
    }
}

void uproot(struct forest *forest, uint32_t at)
{
    forest->cell[at].flags &= (uint8_t)~CELL_SEED;
    forest->seeds--;
    if (forest->cell[at].key != KEY_NONE)
        clear_subtree(forest, at, forest->clear_limit);
}

static inline __attribute__((always_inline)) void offer_to_cleared(struct forest *forest,
                                                                   const bool limits)
{
    const struct adjacency *adjacency = &forest->adjacency;
    const struct cells *cleared = &forest->cleared;
    for (; forest->offered < cleared->count && goes_on(forest, 1); forest->offered++) {
        const size_t i = forest->offered;
        if (i + AHEAD < cleared->count)
            fetch_around(forest, cleared->item[i + AHEAD]);
        const struct offer offer = best_offer(forest, cleared->item[i], KEY_NONE, adjacency->count,
                                              forest->arcs.kind, limits);
        if (offer.key != KEY_NONE)
            take(forest, cleared->item[i], offer);
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
    for (; forest->reoffered < cleared->count && goes_on(forest, 1); forest->reoffered++)
        forest->cell[cleared->item[forest->reoffered]].flags &= (uint8_t)~CELL_CLEARED;
    forest->stats.cleared += forest->reoffered - before;
}

/*
 * extend preserves the order of levels, though not that of keys: where the level of a voxel falls,
 * those of its offers do not rise. So while weights do not depend on labels, a voxel whose
 * predecessor got another key is still offered its own level, only by another root. The voxel that
 * offers it that level has a lower one, and is no descendant, for all their levels are above. So it
 * waits at its level like any other, takes the best offer when it is served, and its children
 * follow: nothing is cleared. Where weights depend on labels its level may rise, and where the
 * other root has a reach it may be offered nothing any more; then its descendants cannot be
 * distinguished from voxels that might support it, and are cleared.
 */
void lose_support(struct forest *forest, uint32_t at, uint64_t offer, unsigned direction)
{
    struct cell *cell = forest->cell + at;
    if (key_level(offer) == key_level(cell->key)) {
        accept(forest, at, offer, cell[-forest->adjacency.offset[direction]].label, direction);
        cell->flags |= CELL_RAISED;
        forest->stats.raised++;
    } else {
        clear_subtree(forest, at, SIZE_MAX);
        reoffer_cleared(forest);
        forest->torn |= is_stopped(forest);
    }
}
