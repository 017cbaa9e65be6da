#include "session/markers.h"

#include <assert.h>
#include <stdlib.h>

#include "base/mem.h"

void markers_release(struct markers *markers)
{
    free(markers->marker);
    free(markers->covered);
    free(markers->bucket);
    *markers = (struct markers){0};
}

size_t markers_memory(const struct markers *markers)
{
    return markers->capacity * sizeof *markers->marker +
           markers->cover_capacity * sizeof *markers->covered +
           markers->buckets * sizeof *markers->bucket;
}

/* ---- covers, by voxel ---- */

static uint32_t *bucket_of(const struct markers *markers, uint32_t cell)
{
    const uint64_t mixed = cell * UINT64_C(0x9e3779b97f4a7c15);
    return markers->bucket + ((mixed >> 32) & (markers->buckets - 1));
}

/* The latest first: covers are put in as they were added. */
static void fill_buckets(struct markers *markers, size_t from)
{
    for (size_t i = from; i < markers->covers; i++) {
        uint32_t *bucket = bucket_of(markers, markers->covered[i].cell);
        markers->covered[i].below = *bucket;
        *bucket = (uint32_t)i;
    }
}

/* At least as many buckets as covers. False when out of memory; nothing has changed then. */
static bool grow_buckets(struct markers *markers, size_t covers)
{
    size_t buckets = markers->buckets ? markers->buckets : 64;
    while (buckets < covers)
        buckets *= 2;
    if (buckets == markers->buckets)
        return true;
    uint32_t *bucket = mem_array(buckets, sizeof *bucket);
    if (!bucket)
        return false;
    for (size_t i = 0; i < buckets; i++)
        bucket[i] = COVER_NONE;
    free(markers->bucket);
    markers->bucket = bucket;
    markers->buckets = buckets;
    fill_buckets(markers, 0);
    return true;
}

/* ---- markers ---- */

enum err markers_add(struct markers *markers, int16_t label, const uint32_t *cell, size_t count,
                     struct fault *fault)
{
    const size_t first = markers->covers;
    if (count >= COVER_NONE - first)
        return fault_set(fault, ERR_LIMIT, "more than %u seeds in one history; nothing has changed",
                         COVER_NONE);
    if (!mem_grow(&markers->marker, &markers->capacity, markers->count + 1,
                  sizeof *markers->marker) ||
        !mem_grow(&markers->covered, &markers->cover_capacity, first + count,
                  sizeof *markers->covered) ||
        !grow_buckets(markers, first + count))
        return fault_memory(fault, "a marker");
    markers->marker[markers->count++] =
        (struct marker){.first = first, .voxels = count, .label = label, .stands = true};
    for (size_t i = 0; i < count; i++)
        markers->covered[first + i] =
            (struct cover){.cell = cell[i], .marker = (uint32_t)markers->count};
    markers->covers = first + count;
    fill_buckets(markers, first);
    return OK;
}

void markers_drop(struct markers *markers)
{
    const struct marker *last = markers->marker + --markers->count;
    assert(!last->planted && !last->planned);
    while (markers->covers > last->first) {
        const struct cover *cover = markers->covered + --markers->covers;
        *bucket_of(markers, cover->cell) = cover->below;
    }
}

static bool is_in(const struct markers *markers, enum marker_set set, uint32_t number)
{
    const struct marker *marker = markers->marker + number - 1;
    return set == MARKERS_STANDING  ? marker->stands
           : set == MARKERS_PLANTED ? marker->planted
                                    : marker->planned;
}

uint32_t markers_at(const struct markers *markers, enum marker_set set, uint32_t cell)
{
    uint32_t at = markers->buckets ? *bucket_of(markers, cell) : COVER_NONE;
    for (; at != COVER_NONE; at = markers->covered[at].below) {
        const struct cover *cover = markers->covered + at;
        if (cover->cell == cell && is_in(markers, set, cover->marker))
            return cover->marker;
    }
    return 0;
}

int16_t markers_seed(const struct markers *markers, enum marker_set set, uint32_t cell)
{
    const uint32_t number = markers_at(markers, set, cell);
    return number ? markers->marker[number - 1].label : EDIT_ERASE;
}

/* ---- from one set to another ---- */

void markers_plan_standing(struct markers *markers)
{
    for (size_t i = 0; i < markers->count; i++)
        markers->marker[i].planned = markers->marker[i].stands;
}

void markers_plant(struct markers *markers)
{
    for (size_t i = 0; i < markers->count; i++)
        markers->marker[i].planted = markers->marker[i].planned;
}

static bool changes(const struct marker *marker)
{
    return marker->planted != marker->planned;
}

/* Whether this cover is the latest one of its voxel whose marker changes: that one speaks for the
 * voxel. */
static bool speaks(const struct markers *markers, size_t of)
{
    const uint32_t cell = markers->covered[of].cell;
    for (uint32_t at = *bucket_of(markers, cell); at != of; at = markers->covered[at].below) {
        const struct cover *cover = markers->covered + at;
        if (cover->cell == cell && changes(markers->marker + cover->marker - 1))
            return false;
    }
    return true;
}

enum err markers_edits(const struct markers *markers, struct edit **edit, size_t *count,
                       struct fault *fault)
{
    size_t most = 0;
    for (size_t i = 0; i < markers->count; i++)
        most += changes(markers->marker + i) ? markers->marker[i].voxels : 0;
    *count = 0;
    *edit = mem_array(most + 1, sizeof **edit);
    if (!*edit)
        return fault_memory(fault, "seeds");
    for (size_t i = 0; i < markers->count; i++) {
        const struct marker *marker = markers->marker + i;
        for (size_t c = marker->first; changes(marker) && c < marker->first + marker->voxels; c++) {
            const uint32_t cell = markers->covered[c].cell;
            const int16_t now = markers_seed(markers, MARKERS_PLANNED, cell);
            if (speaks(markers, c) && now != markers_seed(markers, MARKERS_PLANTED, cell))
                (*edit)[(*count)++] = (struct edit){cell, now};
        }
    }
    return OK;
}
