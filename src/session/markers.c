#include "session/markers.h"

#include <stdlib.h>

#include "base/mem.h"

void markers_release(struct markers *markers)
{
    free(markers->marker);
    free(markers->cover);
    free(markers->bucket);
    *markers = (struct markers){0};
}

size_t markers_memory(const struct markers *markers)
{
    return markers->capacity * sizeof *markers->marker +
           markers->cover_capacity * sizeof *markers->cover +
           markers->buckets * sizeof *markers->bucket;
}

/* ---- covers, by voxel ---- */

static uint32_t *bucket_of(const struct markers *markers, uint32_t cell)
{
    const uint64_t mixed = cell * UINT64_C(0x9e3779b97f4a7c15);
    return markers->bucket + ((mixed >> 32) & (markers->buckets - 1));
}

static void put_in(struct markers *markers, size_t i)
{
    uint32_t *bucket = bucket_of(markers, markers->cover[i].cell);
    markers->cover[i].below = *bucket;
    *bucket = (uint32_t)i;
}

/* The latest first: covers are put in as they were added. */
static void fill_buckets(struct markers *markers, struct task *task)
{
    for (size_t i = 0; i < markers->buckets; i++)
        markers->bucket[i] = COVER_NONE;
    for (size_t i = 0; i < markers->covers; i++, task_show(task, 1))
        put_in(markers, i);
}

/* At least as many buckets as covers. False when out of memory; nothing has changed then. */
static bool grow_buckets(struct markers *markers, size_t covers, struct task *task)
{
    size_t buckets = markers->buckets ? markers->buckets : 64;
    while (buckets < covers)
        buckets *= 2;
    if (buckets == markers->buckets)
        return true;
    uint32_t *bucket = mem_array(buckets, sizeof *bucket);
    if (!bucket)
        return false;
    free(markers->bucket);
    markers->bucket = bucket;
    markers->buckets = buckets;
    fill_buckets(markers, task);
    return true;
}

/* ---- markers ---- */

enum err markers_add(struct markers *markers, int16_t label, const uint32_t *cell, size_t count,
                     struct watch *watch, struct fault *fault)
{
    const size_t first = markers->covers;
    struct task task = task_begin(watch, "markers", count);
    if (count >= COVER_NONE - first)
        return fault_set(fault, ERR_LIMIT, "more than %u seeds in one history; nothing has changed",
                         COVER_NONE);
    if (!mem_grow(&markers->marker, &markers->capacity, markers->count + 1,
                  sizeof *markers->marker) ||
        !mem_grow(&markers->cover, &markers->cover_capacity, first + count,
                  sizeof *markers->cover) ||
        !grow_buckets(markers, first + count, &task))
        return fault_memory(fault, "a marker");
    markers->marker[markers->count++] =
        (struct marker){.first = first, .voxels = count, .label = label};
    for (size_t i = 0; i < count && task_advance(&task, 1); i++) {
        markers->cover[first + i] =
            (struct cover){.cell = cell[i], .marker = (uint32_t)markers->count};
        put_in(markers, markers->covers++);
    }
    const enum err err = watch_fault(watch, fault);
    if (err)
        markers_drop(markers, markers->count - 1, watch);
    return err;
}

void markers_drop(struct markers *markers, size_t count, struct watch *watch)
{
    struct task task = task_begin(watch, "markers", 0);
    for (; markers->count > count; markers->count--) {
        const struct marker *last = markers->marker + markers->count - 1;
        for (; markers->covers > last->first; task_show(&task, 1)) {
            const struct cover *cover = markers->cover + --markers->covers;
            *bucket_of(markers, cover->cell) = cover->below;
        }
    }
}

uint32_t markers_at(const struct markers *markers, uint32_t cell)
{
    uint32_t at = markers->buckets ? *bucket_of(markers, cell) : COVER_NONE;
    for (; at != COVER_NONE; at = markers->cover[at].below) {
        const struct cover *cover = markers->cover + at;
        if (cover->cell == cell && markers->marker[cover->marker - 1].stands)
            return cover->marker;
    }
    return 0;
}

struct edit markers_edit(const struct markers *markers, uint32_t cell)
{
    const uint32_t number = markers_at(markers, cell);
    if (!number)
        return (struct edit){cell, EDIT_ERASE, 0};
    const struct marker *marker = &markers->marker[number - 1];
    return (struct edit){cell, marker->label, marker->reach};
}

int16_t markers_seed(const struct markers *markers, uint32_t cell)
{
    return markers_edit(markers, cell).label;
}

uint32_t markers_stroke(const struct markers *markers, uint32_t number)
{
    while (markers->marker[number - 1].joined)
        number--;
    return number;
}

uint32_t markers_next(const struct markers *markers, uint32_t number)
{
    const struct marker *next = markers->marker + number;
    return number < markers->count && next->joined && next->stands ? number + 1 : 0;
}
