/* SPDX-License-Identifier: MIT */
#include "engine/queue.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

enum {
    GROUP_COSTS = 256,
    GROUPS = 65536 / GROUP_COSTS,
    HOPS = 65536,
    CHUNK_ENTRIES = 254, /* even; with the two words before them 1024 bytes */
    PAGE_CHUNKS = 4,     /* in 4096 bytes */
};

struct chunk {
    uint32_t next; /* index of the next chunk of the list, 0 at the end */
    uint32_t count;
    uint32_t cell[CHUNK_ENTRIES];
};

/* A set of numbers 0..65535 in two levels: finding the lowest reads at most 16 + 1 words. */
struct marks {
    uint64_t upper[16];
    uint64_t lower[1024];
};

struct queue {
    struct chunk *pool; /* [chunks]; chunk 0 is never used, so that 0 ends a list. It moves when it
                           grows. */
    uint32_t chunks, used;
    uint32_t kept;  /* chunks at first, and after queue_trim */
    uint32_t free;  /* list of chunks that were used and are free again */
    uint32_t level; /* being served, if `open` */
    bool open;
    bool failed;
    /* Heads of lists, each the index of its first chunk. Only the costs of one group have lists of
     * their own, whose ends fit into the cache. Entries of other groups wait as pairs (level, cell)
     * and are distributed one by one when their group is served. Entries at (cost, 0), nearly all
     * in practice, move to the hops as whole lists when their cost is served; the others wait as
     * such pairs too. */
    uint32_t group; /* being served; 0 at first, so that costs of 8 bits never wait as pairs */
    uint32_t by_group[GROUPS];
    uint32_t at_rise[GROUP_COSTS];
    uint32_t later[GROUP_COSTS];
    uint32_t by_hops[HOPS];   /* entries of the cost being served, by hops */
    struct marks costs, hops; /* costs with a list; the first cost of a group that waits */
};

static void marks_set(struct marks *m, uint32_t n)
{
    m->lower[n >> 6] |= UINT64_C(1) << (n & 63);
    m->upper[n >> 12] |= UINT64_C(1) << (n >> 6 & 63);
}

static void marks_unset(struct marks *m, uint32_t n)
{
    m->lower[n >> 6] &= ~(UINT64_C(1) << (n & 63));
    if (m->lower[n >> 6] == 0)
        m->upper[n >> 12] &= ~(UINT64_C(1) << (n >> 6 & 63));
}

static bool marks_lowest(const struct marks *m, uint32_t *n)
{
    for (uint32_t i = 0; i < 16; i++)
        if (m->upper[i]) {
            uint32_t word = i << 6 | (uint32_t)__builtin_ctzll(m->upper[i]);
            *n = word << 6 | (uint32_t)__builtin_ctzll(m->lower[word]);
            return true;
        }
    return false;
}

struct queue *queue_new(size_t kept_bytes)
{
    struct queue *queue = mem_new(sizeof *queue);
    if (!queue)
        return NULL;
    queue->kept = (uint32_t)((kept_bytes / sizeof *queue->pool / PAGE_CHUNKS + 1) * PAGE_CHUNKS);
    queue->chunks = queue->kept;
    queue->used = 1;
    queue->pool = mem_pages(queue->chunks * sizeof *queue->pool);
    if (!queue->pool) {
        free(queue);
        return NULL;
    }
    return queue;
}

void queue_free(struct queue *queue)
{
    if (!queue)
        return;
    mem_pages_free(queue->pool, queue->chunks * sizeof *queue->pool);
    free(queue);
}

/* Change the number of chunks, in whole pages. */
static bool resize_pool(struct queue *queue, uint32_t chunks)
{
    if (!mem_pages_resize(&queue->pool, queue->chunks * sizeof *queue->pool,
                          chunks * sizeof *queue->pool))
        return false;
    queue->chunks = chunks;
    return true;
}

/* Insert an empty chunk before *head. The pool grows by an eighth. */
static bool open_chunk(struct queue *queue, uint32_t *head)
{
    const uint32_t more = (queue->chunks / 8 / PAGE_CHUNKS + 1) * PAGE_CHUNKS;
    uint32_t handle = queue->free;
    if (handle) {
        queue->free = queue->pool[handle].next;
    } else if (queue->used < queue->chunks ||
               (queue->chunks < UINT32_MAX - more && resize_pool(queue, queue->chunks + more))) {
        handle = queue->used++;
    } else {
        queue->failed = true;
        return false;
    }
    queue->pool[handle].next = *head;
    queue->pool[handle].count = 0;
    *head = handle;
    return true;
}

static void release_chunk(struct queue *queue, uint32_t handle)
{
    queue->pool[handle].next = queue->free;
    queue->free = handle;
}

static inline void add_to(struct queue *queue, uint32_t *head, uint32_t word)
{
    if (!*head || queue->pool[*head].count == CHUNK_ENTRIES)
        if (!open_chunk(queue, head))
            return;
    struct chunk *chunk = queue->pool + *head;
    chunk->cell[chunk->count++] = word;
}

static inline void add_at_hops(struct queue *queue, uint32_t hops, uint32_t cell)
{
    if (!queue->by_hops[hops])
        marks_set(&queue->hops, hops);
    add_to(queue, &queue->by_hops[hops], cell);
}

/* Add two words. CHUNK_ENTRIES is even: a pair never straddles two chunks. */
static inline void add_pair(struct queue *queue, uint32_t *head, uint32_t word, uint32_t cell)
{
    add_to(queue, head, word);
    add_to(queue, head, cell);
}

static inline void add_at_cost(struct queue *queue, uint32_t level, uint32_t cell)
{
    const uint32_t cost = level >> 16, group = cost / GROUP_COSTS, i = cost % GROUP_COSTS;
    if (group != queue->group) {
        if (!queue->by_group[group])
            marks_set(&queue->costs, cost - i);
        add_pair(queue, &queue->by_group[group], level, cell);
        return;
    }
    if (!queue->at_rise[i] && !queue->later[i])
        marks_set(&queue->costs, cost);
    if ((level & 0xFFFF) == 0)
        add_to(queue, &queue->at_rise[i], cell);
    else
        add_pair(queue, &queue->later[i], level, cell);
}

void queue_push(struct queue *queue, uint32_t level, uint32_t cell)
{
    if (queue->open && level >> 16 == queue->level >> 16)
        add_at_hops(queue, level & 0xFFFF, cell);
    else
        add_at_cost(queue, level, cell);
}

void queue_push_many(struct queue *queue, const struct waiting *item, size_t count)
{
    for (size_t i = 0; i < count; i++)
        queue_push(queue, item[i].level, item[i].cell);
}

void queue_push_hops(struct queue *queue, uint32_t level, const uint32_t *cell, size_t count)
{
    uint32_t *head = &queue->by_hops[level & 0xFFFF];
    if (count > 0)
        marks_set(&queue->hops, level & 0xFFFF);
    while (count > 0) {
        if (!*head || queue->pool[*head].count == CHUNK_ENTRIES)
            if (!open_chunk(queue, head))
                return;
        struct chunk *chunk = queue->pool + *head;
        const uint32_t room = CHUNK_ENTRIES - chunk->count;
        const uint32_t part = count < room ? (uint32_t)count : room;
        for (uint32_t i = 0; i < part; i++)
            chunk->cell[chunk->count + i] = cell[i];
        chunk->count += part;
        cell += part;
        count -= part;
    }
}

/* Remove the first chunk of a list; 0 if the list is empty. The caller releases it. */
static uint32_t take_chunk(struct queue *queue, uint32_t *head)
{
    uint32_t handle = *head;
    if (handle)
        *head = queue->pool[handle].next;
    return handle;
}

uint64_t queue_lowest(const struct queue *queue)
{
    uint32_t lowest;
    if (queue->open && marks_lowest(&queue->hops, &lowest))
        return (queue->level & 0xFFFF0000) | lowest;
    return marks_lowest(&queue->costs, &lowest) ? lowest << 16 : QUEUE_EMPTY;
}

/* Remove all pairs (level, cell) of a list, and add them again. */
static void distribute(struct queue *queue, uint32_t *head)
{
    for (uint32_t handle; (handle = take_chunk(queue, head));) {
        for (uint32_t i = 0; i + 1 < queue->pool[handle].count; i += 2) {
            const uint32_t *pair = queue->pool[handle].cell + i;
            queue_push(queue, pair[0], pair[1]);
        }
        release_chunk(queue, handle);
    }
}

void queue_serve(struct queue *queue, uint32_t level)
{
    const uint32_t cost = level >> 16, group = cost / GROUP_COSTS, i = cost % GROUP_COSTS;
    if (group != queue->group) {
        queue->group = group;
        queue->open = false;
        marks_unset(&queue->costs, group * GROUP_COSTS);
        distribute(queue, &queue->by_group[group]);
    }
    if (!queue->open || queue->level >> 16 != cost) {
        marks_unset(&queue->costs, cost);
        queue->level = level;
        queue->open = true;
        queue->by_hops[0] = queue->at_rise[i];
        queue->at_rise[i] = 0;
        if (queue->by_hops[0])
            marks_set(&queue->hops, 0);
        distribute(queue, &queue->later[i]);
    }
    queue->level = level;
}

size_t queue_take(struct queue *queue, uint32_t *cells, size_t capacity)
{
    const uint32_t hops = queue->level & 0xFFFF;
    size_t count = 0;
    while (count + CHUNK_ENTRIES <= capacity) {
        uint32_t handle = take_chunk(queue, &queue->by_hops[hops]);
        if (!handle) {
            marks_unset(&queue->hops, hops);
            break;
        }
        const struct chunk *chunk = queue->pool + handle;
        memcpy(cells + count, chunk->cell, chunk->count * sizeof *cells);
        count += chunk->count;
        release_chunk(queue, handle);
    }
    return count;
}

void queue_rewind(struct queue *queue)
{
    const uint32_t group = queue->group, end = (group + 1) * GROUP_COSTS;
    uint32_t hops;
    for (uint32_t cost = queue->level >> 16; queue->open && cost < end; cost++) {
        queue_serve(queue, cost << 16);
        queue->group = 0;
        while (marks_lowest(&queue->hops, &hops)) {
            for (uint32_t handle; (handle = take_chunk(queue, &queue->by_hops[hops]));) {
                for (uint32_t i = 0; i < queue->pool[handle].count; i++)
                    add_at_cost(queue, cost << 16 | hops, queue->pool[handle].cell[i]);
                release_chunk(queue, handle);
            }
            marks_unset(&queue->hops, hops);
        }
        queue->group = group;
    }
    queue->group = 0;
    queue->open = false;
}

void queue_trim(struct queue *queue)
{
    if (queue->chunks > queue->kept)
        resize_pool(queue, queue->kept);
    queue->used = 1; /* an empty queue holds free chunks only */
    queue->free = queue->group = 0;
    queue->open = false;
}

void queue_clear(struct queue *queue)
{
    queue->used = 1;
    queue->free = queue->group = 0;
    queue->open = queue->failed = false;
    queue->costs = queue->hops = (struct marks){{0}, {0}};
    memset(queue->by_group, 0, sizeof queue->by_group);
    memset(queue->at_rise, 0, sizeof queue->at_rise);
    memset(queue->later, 0, sizeof queue->later);
    memset(queue->by_hops, 0, sizeof queue->by_hops);
}

bool queue_failed(const struct queue *queue)
{
    return queue->failed;
}

size_t queue_memory(const struct queue *queue)
{
    return sizeof *queue + queue->used * sizeof(struct chunk);
}
