/* SPDX-License-Identifier: MIT */
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

static void insert_cover(struct markers *markers, size_t i)
{
    uint32_t *bucket = bucket_of(markers, markers->cover[i].cell);
    markers->cover[i].below = *bucket;
    *bucket = (uint32_t)i;
}

/* Grow to at least as many buckets as covers. False, and no change, when out of memory. */
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
    /* The latest cover comes first: covers are inserted in the order of their addition. */
    for (size_t i = 0; i < markers->buckets; i++)
        markers->bucket[i] = COVER_NONE;
    for (size_t i = 0; i < markers->covers; i++, task_show(task, 1))
        insert_cover(markers, i);
    return true;
}

/* Reserve memory for `more` covers; no change on errors. */
static enum err reserve_covers(struct markers *markers, size_t more, struct task *task,
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

/* Add a cover of the last marker; `from` is the marker that yields to it, or 0. */
static void add_cover(struct markers *markers, uint32_t cell, uint32_t from, bool is_beside)
{
    markers->cover[markers->covers] = (struct cover){.cell = cell,
                                                     .marker = (uint32_t)markers->count,
                                                     .from = from & (UINT32_MAX >> 1),
                                                     .is_beside = is_beside};
    insert_cover(markers, markers->covers++);
}

/* ---- markers ---- */

enum err markers_add(struct markers *markers, int16_t label, const uint32_t *cell, size_t count,
                     struct watch *watch, struct fault *fault)
{
    const size_t first = markers->covers;
    struct task task = task_begin(watch, "markers", count);
    TRY(reserve_covers(markers, count, &task, fault));
    if (!mem_grow(&markers->marker, &markers->capacity, markers->count + 1,
                  sizeof *markers->marker))
        return fault_memory(fault, "a marker");
    markers->marker[markers->count++] = (struct marker){.first = (uint32_t)first,
                                                        .voxels = (uint32_t)count,
                                                        .run = (uint32_t)markers->runs,
                                                        .label = label};
    for (size_t i = 0; i < count && task_advance(&task, 1); i++)
        add_cover(markers, cell[i], 0, false);
    enum err err = watch_fault(watch, fault);
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

/* ---- markers that yield, and freed voxels ---- */

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

/* Number of runs of a marker's voxels, or of its piece, in order. */
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

/* True if a voxel first..end-1 of a row is among them: checks the last run that begins before
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

static bool pieces_meet(const struct markers *markers, const struct marker *a,
                        const struct marker *b)
{
    const bool swaps = stretches(b) < stretches(a);
    const struct marker *few = swaps ? b : a, *many = swaps ? a : b;
    bool has = false;
    for (size_t i = 0; !has && i < stretches(few); i++)
        has = has_one(markers, many, stretch(markers, few, i));
    return has;
}

/* True if a marker yields to the last one. */
static bool gives_way(const struct markers *markers, const struct marker *marker)
{
    const struct marker *last = markers->marker + markers->count - 1;
    return marker->yields && (last->is_exact || marker->label != last->label) &&
           pieces_meet(markers, marker, last);
}

/* Freed cells and their neighbours, a bit each; and which of them have a cover. */
struct freed {
    uint32_t first, last;
    uint64_t origin; /* added to a cell to find its bit */
    uint64_t *within, *covered;
    const struct cell *cells; /* cells of the scene: no seed is planted outside its region of
                                 interest */
};

static uint64_t bit_of(const struct freed *freed, uint32_t cell)
{
    return cell + freed->origin;
}

static bool has_bit(const uint64_t *set, uint64_t bit)
{
    return set[bit >> 6] >> (bit & 63) & 1;
}

static enum err freed_init(struct freed *freed, const struct adjacency *around,
                           const uint32_t *cell, size_t count, struct fault *fault)
{
    ptrdiff_t reach = 0;
    *freed = (struct freed){.first = UINT32_MAX};
    for (unsigned k = 0; k < around->count; k++)
        reach = around->offset[k] > reach ? around->offset[k] : reach;
    for (size_t i = 0; i < count; i++) {
        freed->first = cell[i] < freed->first ? cell[i] : freed->first;
        freed->last = cell[i] > freed->last ? cell[i] : freed->last;
    }
    const size_t words = (freed->last - freed->first + 2 * (size_t)reach) / 64 + 1;
    freed->origin = (uint64_t)reach - freed->first;
    freed->within = mem_new(words * sizeof *freed->within);
    freed->covered = mem_new(words * sizeof *freed->covered);
    if (!freed->within || !freed->covered)
        return fault_memory(fault, "a marker");
    for (size_t i = 0; i < count; i++)
        freed->within[bit_of(freed, cell[i]) >> 6] |= UINT64_C(1) << (bit_of(freed, cell[i]) & 63);
    return OK;
}

static bool has_cell(const struct markers *markers, const struct marker *marker, uint32_t cell)
{
    return has_one(markers, marker, (struct marker_run){cell, cell + 1});
}

/* Add a cover: the last marker frees a voxel from marker `number`, or that marker has a seed
 * next to a freed voxel. */
static enum err cover_once(struct markers *markers, uint32_t number, struct freed *freed,
                           uint32_t cell, struct task *task, struct fault *fault)
{
    const uint64_t bit = bit_of(freed, cell);
    const bool is_beside = !has_bit(freed->within, bit);
    if (is_beside ? freed->cells[cell].flags & CELL_OUTSIDE
                  : markers->marker[markers->count - 1].is_exact)
        return OK;
    if (has_bit(freed->covered, bit) || !has_cell(markers, markers->marker + number - 1, cell))
        return OK;
    TRY(reserve_covers(markers, 1, task, fault));
    freed->covered[bit >> 6] |= UINT64_C(1) << (bit & 63);
    add_cover(markers, cell, number, is_beside);
    markers->marker[markers->count - 1].frees++;
    markers->ends |= is_beside;
    return OK;
}

/* The same for a voxel and all its neighbours. */
static enum err free_one(struct markers *markers, uint32_t number, struct freed *freed,
                         const struct adjacency *around, uint32_t cell, struct task *task,
                         struct fault *fault)
{
    if (!has_cell(markers, markers->marker + number - 1, cell))
        return OK;
    TRY(cover_once(markers, number, freed, cell, task, fault));
    for (unsigned k = 0; k < around->count; k++) {
        const uint32_t beside = (uint32_t)(cell + around->offset[k]);
        if (!has_bit(freed->within, bit_of(freed, beside)))
            TRY(cover_once(markers, number, freed, beside, task, fault));
    }
    return OK;
}

/* True if a marker is a piece with voxels near the freed ones. */
static bool comes_near(const struct markers *markers, const struct marker *marker,
                       const struct freed *freed)
{
    const size_t count = marker->yields ? stretches(marker) : 0;
    return count && stretch(markers, marker, 0).first <= freed->last &&
           stretch(markers, marker, count - 1).end > freed->first;
}

enum err markers_free(struct markers *markers, const struct cell *cells,
                      const struct adjacency *around, const uint32_t *cell, size_t count,
                      struct watch *watch, struct fault *fault)
{
    struct task task = task_begin(watch, "markers", count);
    struct freed freed = {0};
    enum err err = count ? freed_init(&freed, around, cell, count, fault) : OK;
    freed.cells = cells;
    for (uint32_t number = (uint32_t)markers->former + 1; !err && count && number < markers->count;
         number++) {
        const struct marker *marker = markers->marker + number - 1;
        const size_t before = markers->covers;
        if (!comes_near(markers, marker, &freed) || !gives_way(markers, marker))
            continue;
        for (size_t i = 0; !err && i < count && task_advance(&task, 1); i++)
            err = free_one(markers, number, &freed, around, cell[i], &task, fault);
        for (size_t i = before; i < markers->covers; i++) {
            const uint64_t bit = bit_of(&freed, markers->cover[i].cell);
            freed.covered[bit >> 6] &= ~(UINT64_C(1) << (bit & 63));
        }
    }
    free(freed.within);
    free(freed.covered);
    return err ? err : watch_fault(watch, fault);
}

/* ---- the deciding marker ---- */

/* True if a valid marker frees the voxel from marker `number`; `at` is the beginning of the
 * bucket. */
static bool is_freed(const struct markers *markers, uint32_t at, uint32_t cell, uint32_t number)
{
    for (; at != COVER_NONE; at = markers->cover[at].below) {
        const struct cover *cover = markers->cover + at;
        if (cover->cell == cell && cover->from == number && !cover->is_beside &&
            markers->marker[cover->marker - 1].is_valid)
            return true;
    }
    return false;
}

bool markers_can_plant(const struct markers *markers, uint32_t cell)
{
    uint32_t at = markers->buckets ? *bucket_of(markers, cell) : COVER_NONE;
    for (; at != COVER_NONE; at = markers->cover[at].below) {
        const struct cover *cover = markers->cover + at;
        if (cover->cell == cell && (!cover->from || cover->is_beside))
            return true;
    }
    return false;
}

uint32_t markers_at(const struct markers *markers, uint32_t cell)
{
    const uint32_t latest = markers->buckets ? *bucket_of(markers, cell) : COVER_NONE;
    uint32_t decides = 0, freed = 0; /* the last one found to be freed: it is frequent */
    /* Older covers are of older markers. */
    for (uint32_t at = latest; at != COVER_NONE && markers->cover[at].marker > decides;
         at = markers->cover[at].below) {
        const struct cover *cover = markers->cover + at;
        const uint32_t number = cover->is_beside ? cover->from : cover->marker;
        if (cover->cell != cell || (cover->from && !cover->is_beside) || number <= decides ||
            number == freed || !markers->marker[number - 1].is_valid ||
            !markers->marker[cover->marker - 1].is_valid)
            continue;
        if (markers->marker[number - 1].yields && is_freed(markers, latest, cell, number))
            freed = number;
        else
            decides = number;
    }
    return decides;
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

bool markers_show(const void *markers, uint32_t cell)
{
    const struct markers *all = markers;
    const uint32_t number = all->yields ? markers_at(all, cell) : 0;
    return !number || !all->marker[number - 1].yields;
}

struct marker_kinds markers_kinds(const struct markers *markers, size_t count)
{
    struct marker_kinds kinds = {false};
    bool was_eraser = false;
    for (size_t m = 0; m < count; m++) {
        const struct marker *marker = &markers->marker[m];
        const bool is_eraser = marker->label == EDIT_ERASE;
        if (!marker->is_valid)
            continue;
        if (marker->yields && was_eraser) /* `labels here` */
            kinds.has_grown = false;
        kinds.has_exact |= marker->is_exact;
        kinds.has_pieces |= marker->yields && !marker->is_exact;
        kinds.has_grown |= !marker->yields && !marker->is_exact && !is_eraser;
        was_eraser = is_eraser;
    }
    return kinds;
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
    return number < markers->count && next->joined && next->is_valid ? number + 1 : 0;
}
