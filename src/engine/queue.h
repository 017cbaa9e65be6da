/* SPDX-License-Identifier: MIT */
/*
 * The queue: cells waiting at levels (cost, hops), served in the order of levels.
 *
 * Within a level there is no order, and none is needed: keys of one level never offer within it.
 * A bucket per cost holds what waits there; when a cost comes up, its bucket is distributed over
 * the hops. Entries are never taken out early: one whose cell has moved to another level is
 * stale, and is skipped when the level is served (the cell's own key and CELL_QUEUED decide).
 *
 * Buckets are lists of small chunks from a pool. Where that runs out, entries are dropped and
 * `failed` is set: the result of the pass is then worthless.
 */
#ifndef ENGINE_QUEUE_H
#define ENGINE_QUEUE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct queue;

/* For a scene of `cells`: room for eight entries a cell, as addresses only; memory is taken as it
 * is needed, and an empty queue still holds `kept_bytes` of it. NULL when out of memory. */
struct queue *queue_new(size_t cells, size_t kept_bytes);
void queue_free(struct queue *queue);

/* A cell and the level (cost << 16 | hops) it waits at. */
struct waiting {
    uint32_t level, cell;
};

/* Adds a cell at a level, which lies above the one being served. Many at once take a third of the
 * time; queue_push_hops is for a level of the same cost as the one being served. */
void queue_push(struct queue *queue, uint32_t level, uint32_t cell);
void queue_push_many(struct queue *queue, const struct waiting *item, size_t count);
void queue_push_hops(struct queue *queue, uint32_t level, const uint32_t *cell, size_t count);

/* No entry lies below the level it returns, and none may be pushed below it later; QUEUE_EMPTY when
 * there is none at all. The level itself may turn out to hold no entries. */
#define QUEUE_EMPTY UINT64_MAX
uint64_t queue_lowest(const struct queue *queue);

/* Serves a level from now on: one that is not above queue_lowest. */
void queue_serve(struct queue *queue, uint32_t level);

/* Takes up to `capacity` (62 at least) entries of the level being served; 0 when there are no
 * more. */
size_t queue_take(struct queue *queue, uint32_t *cells, size_t capacity);

/* Stops serving in the middle of a pass: what waits stays, and levels below may be pushed again.
 * The next pass starts at the lowest. */
void queue_rewind(struct queue *queue);

/* Gives memory back that an empty queue holds, beyond a little. */
void queue_trim(struct queue *queue);

/* Forgets every entry, and that memory ran out. */
void queue_clear(struct queue *queue);
bool queue_failed(const struct queue *queue);

/* Bytes held. */
size_t queue_memory(const struct queue *queue);

#endif
