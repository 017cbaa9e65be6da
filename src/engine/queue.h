/* SPDX-License-Identifier: MIT */
/*
 * The queue: cells waiting at levels (cost, hops), served in the order of levels.
 *
 * Within a level there is no order, and none is needed: keys of one level make no offers within it.
 * Each group of 256 costs has a bucket; when a group is served, its bucket is distributed over its
 * costs, and when a cost is served, its bucket over the hops. Entries are never removed early: an
 * entry whose cell has moved to another level is stale and is skipped when the level is served (the
 * cell's own key and CELL_QUEUED decide).
 *
 * Buckets are lists of small chunks from a pool. If the pool cannot grow, entries are dropped and
 * `failed` is set: the result of the pass is then invalid.
 */
#ifndef ENGINE_QUEUE_H
#define ENGINE_QUEUE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct queue;

/* Create a queue. Its memory grows with its entries, and an empty queue keeps `kept_bytes` of it.
 * NULL if out of memory. */
struct queue *queue_new(size_t kept_bytes);
void queue_free(struct queue *queue);

/* A cell and the level (cost << 16 | hops) at which it waits. */
struct waiting {
    uint32_t level, cell;
};

/* Add cells at levels above the one being served; queue_push_hops is for a level of the same cost
 * as the one being served. */
void queue_push(struct queue *queue, uint32_t level, uint32_t cell);
void queue_push_many(struct queue *queue, const struct waiting *item, size_t count);
void queue_push_hops(struct queue *queue, uint32_t level, const uint32_t *cell, size_t count);

/* A lower bound of the levels of all entries, below which none may be pushed later; QUEUE_EMPTY for
 * an empty queue. The level itself may have no entries. */
#define QUEUE_EMPTY UINT64_MAX
uint64_t queue_lowest(const struct queue *queue);

/* Serve a level from now on. It must not be above queue_lowest. */
void queue_serve(struct queue *queue, uint32_t level);

/* Remove up to `capacity` (at least 254) entries of the level being served; 0 if there are no
 * more. */
size_t queue_take(struct queue *queue, uint32_t *cells, size_t capacity);

/* Stop serving in the middle of a pass: entries stay, and lower levels may be pushed again. The
 * next pass starts at the lowest. */
void queue_rewind(struct queue *queue);

/* Return the memory of an empty queue to the system, except `kept_bytes`. */
void queue_trim(struct queue *queue);

/* Drop all entries and clear `failed`. */
void queue_clear(struct queue *queue);
bool queue_failed(const struct queue *queue);

/* Bytes in use. */
size_t queue_memory(const struct queue *queue);

#endif
