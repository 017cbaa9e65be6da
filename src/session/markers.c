#include "session/markers.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

void markers_release(struct markers *markers)
{
    free(markers->marker);
    free(markers->cover);
    free(markers->run);
    free(markers->bucket);
    *markers = (struct markers){0};
}

size_t markers_memory(const struct markers *markers)
{
    return markers->capacity * sizeof *markers->marker +
           markers->cover_capacity * sizeof *markers->cover +
           markers->run_capacity * sizeof *markers->run +
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

/* For so many covers more; nothing has changed on errors. */
static enum err make_room(struct markers *markers, size_t more, struct task *task,
                          struct fault *fault)
{
    const size_t covers = markers->covers + more;
    if (more >= COVER_NONE - markers->covers)
        return fault_set(fault, ERR_LIMIT, "more than %u seeds in one history; nothing has changed",
                         COVER_NONE);
    return mem_grow(&markers->cover, &markers->cover_capacity, covers, sizeof *markers->cover) &&
                   grow_buckets(markers, covers, task)
               ? OK
               : fault_memory(fault, "a marker");
}

/* Of the last marker. */
static void add_cover(struct markers *markers, uint32_t cell, uint32_t frees)
{
    markers->cover[markers->covers] =
        (struct cover){.cell = cell, .marker = (uint32_t)markers->count, .frees = frees};
    put_in(markers, markers->covers++);
}

/* ---- markers ---- */

enum err markers_add(struct markers *markers, int16_t label, const uint32_t *cell, size_t count,
                     struct watch *watch, struct fault *fault)
{
    const size_t first = markers->covers;
    struct task task = task_begin(watch, "markers", count);
    enum err err = make_room(markers, count, &task, fault);
    if (err)
        return err;
    if (!mem_grow(&markers->marker, &markers->capacity, markers->count + 1,
                  sizeof *markers->marker))
        return fault_memory(fault, "a marker");
    markers->marker[markers->count++] = (struct marker){.first = (uint32_t)first,
                                                        .voxels = (uint32_t)count,
                                                        .run = (uint32_t)markers->runs,
                                                        .label = label};
    for (size_t i = 0; i < count && task_advance(&task, 1); i++)
        add_cover(markers, cell[i], 0);
    err = watch_fault(watch, fault);
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
        markers->runs = last->run;
    }
}

/* ---- what yields, and what is freed ---- */

enum err markers_yield(struct markers *markers, const struct marker_run *run, size_t runs,
                       struct fault *fault)
{
    struct marker *last = markers->marker + markers->count - 1;
    if (runs >= UINT32_MAX - markers->runs)
        return fault_set(fault, ERR_LIMIT, "more than %u rows of pieces; nothing has changed",
                         UINT32_MAX);
    if (!mem_grow(&markers->run, &markers->run_capacity, markers->runs + runs,
                  sizeof *markers->run))
        return fault_memory(fault, "a marker");
    if (runs)
        memcpy(markers->run + markers->runs, run, runs * sizeof *run);
    markers->runs += runs;
    last->runs = (uint32_t)runs;
    last->yields = true;
    markers->yields = true;
    return OK;
}

/* The voxels of a marker, or of its piece, as runs in order. */
static size_t stretches(const struct marker *marker)
{
    return marker->runs ? marker->runs : marker->voxels;
}

static struct marker_run stretch(const struct markers *markers, const struct marker *marker,
                                 size_t i)
{
    const uint32_t cell = markers->cover[marker->first + (marker->runs ? 0 : i)].cell;
    return marker->runs ? markers->run[marker->run + i] : (struct marker_run){cell, cell + 1};
}

/* Whether one of the voxels first..end-1 of a row is among them: by the last run that begins before
 * their end. */
static bool has_one(const struct markers *markers, const struct marker *marker,
                    struct marker_run row)
{
    size_t low = 0, high = stretches(marker);
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        if (stretch(markers, marker, middle).first < row.end)
            low = middle + 1;
        else
            high = middle;
    }
    return low > 0 && stretch(markers, marker, low - 1).end > row.first;
}

static bool meet(const struct markers *markers, const struct marker *a, const struct marker *b)
{
    const bool swaps = stretches(b) < stretches(a);
    const struct marker *few = swaps ? b : a, *many = swaps ? a : b;
    bool has = false;
    for (size_t i = 0; !has && i < stretches(few); i++)
        has = has_one(markers, many, stretch(markers, few, i));
    return has;
}

enum { UNKNOWN, YIELDS, STAYS };

/* What a marker does before the last one. */
static uint8_t ask(const struct markers *markers, uint32_t number)
{
    const struct marker *marker = markers->marker + number - 1;
    const struct marker *last = markers->marker + markers->count - 1;
    return marker->yields && marker->label != last->label && meet(markers, marker, last) ? YIELDS
                                                                                         : STAYS;
}

/* How many markers give way in a voxel, whether they stand or not; `does` is what each marker does,
 * or UNKNOWN. With `adds`, the last one frees it from them, for which there is room. */
static size_t free_one(struct markers *markers, uint8_t *does, uint32_t cell, bool adds)
{
    size_t count = 0;
    for (uint32_t at = *bucket_of(markers, cell); at != COVER_NONE; at = markers->cover[at].below) {
        const struct cover *cover = markers->cover + at;
        const uint32_t number = cover->marker;
        if (cover->cell != cell || cover->frees)
            continue;
        if (does[number] == UNKNOWN)
            does[number] = ask(markers, number);
        if (does[number] == STAYS)
            continue;
        count++;
        if (adds)
            add_cover(markers, cell, number);
    }
    return count;
}

enum err markers_free(struct markers *markers, const uint32_t *cell, size_t count,
                      struct watch *watch, struct fault *fault)
{
    struct task task = task_begin(watch, "markers", count);
    uint8_t *does = mem_new(markers->count + 1); /* each marker */
    enum err err = does ? OK : fault_memory(fault, "a marker");
    for (size_t i = 0; !err && i < count && task_advance(&task, 1); i++) {
        const size_t more = free_one(markers, does, cell[i], false);
        err = more ? make_room(markers, more, &task, fault) : OK;
        if (!err && more)
            markers->marker[markers->count - 1].frees +=
                (uint32_t)free_one(markers, does, cell[i], true);
    }
    free(does);
    return err ? err : watch_fault(watch, fault);
}

/* ---- who decides ---- */

/* Whether a later marker that stands frees the voxel of a cover from its marker; `at` is where its
 * bucket begins. */
static bool is_freed(const struct markers *markers, uint32_t at, const struct cover *from)
{
    for (const struct cover *cover; (cover = markers->cover + at) != from; at = cover->below)
        if (cover->cell == from->cell && cover->frees == from->marker &&
            markers->marker[cover->marker - 1].stands)
            return true;
    return false;
}

uint32_t markers_at(const struct markers *markers, uint32_t cell)
{
    const uint32_t latest = markers->buckets ? *bucket_of(markers, cell) : COVER_NONE;
    for (uint32_t at = latest; at != COVER_NONE; at = markers->cover[at].below) {
        const struct cover *cover = markers->cover + at;
        const struct marker *marker = markers->marker + cover->marker - 1;
        if (cover->cell == cell && !cover->frees && marker->stands &&
            !(marker->yields && is_freed(markers, latest, cover)))
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
