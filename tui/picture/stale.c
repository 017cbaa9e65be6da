#include "tui/picture/stale.h"

#include <string.h>

static uint32_t least(uint32_t a, uint32_t b)
{
    return a < b ? a : b;
}

static uint64_t cost_of(struct raster_box box, uint32_t box_cost)
{
    return (uint64_t)box.width * box.height + box_cost;
}

static struct raster_box around(struct raster_box a, struct raster_box b)
{
    const uint32_t right =
        a.left + a.width > b.left + b.width ? a.left + a.width : b.left + b.width;
    const uint32_t bottom =
        a.top + a.height > b.top + b.height ? a.top + a.height : b.top + b.height;
    const uint32_t left = least(a.left, b.left), top = least(a.top, b.top);
    return (struct raster_box){left, top, right - left, bottom - top};
}

/* Joins a box with that of the others for which it costs least, as long as that is no more than
 * both cost apart, or there is no room for another. */
static void add_box(struct stale *stale, struct raster_box box, uint32_t box_cost)
{
    while (stale->count > 0) {
        unsigned best = 0;
        int64_t least_growth = INT64_MAX;
        for (unsigned i = 0; i < stale->count; i++) {
            const int64_t growth =
                (int64_t)(cost_of(around(stale->box[i], box), box_cost) -
                          cost_of(stale->box[i], box_cost) - cost_of(box, box_cost));
            if (growth < least_growth) {
                least_growth = growth;
                best = i;
            }
        }
        if (least_growth > 0 && stale->count < STALE_MOST)
            break;
        box = around(stale->box[best], box);
        stale->box[best] = stale->box[--stale->count];
    }
    stale->box[stale->count++] = box;
}

/* The first and last of `length` bytes that differ; false where none do. */
static bool differing(const uint8_t *a, const uint8_t *b, size_t length, size_t *first,
                      size_t *last)
{
    if (memcmp(a, b, length) == 0)
        return false;
    *first = 0;
    *last = length - 1;
    while (a[*first] == b[*first])
        ++*first;
    while (a[*last] == b[*last])
        --*last;
    return true;
}

/* Cuts a tile down to what differs in it; false where nothing does. */
static bool tighten(struct raster_box *tile, const struct raster *now, const struct raster *then)
{
    const size_t each = raster_pixel_bytes(now);
    uint32_t left = tile->width, right = 0, top = tile->height, bottom = 0;
    for (uint32_t y = 0; y < tile->height; y++) {
        size_t first, last;
        if (!differing(now->bytes + (tile->top + y) * now->stride + tile->left * each,
                       then->bytes + (tile->top + y) * then->stride + tile->left * each,
                       tile->width * each, &first, &last))
            continue;
        left = least(left, (uint32_t)(first / each));
        right = right > last / each ? right : (uint32_t)(last / each);
        top = least(top, y);
        bottom = y;
    }
    if (top == tile->height)
        return false;
    *tile =
        (struct raster_box){tile->left + left, tile->top + top, right - left + 1, bottom - top + 1};
    return true;
}

/* The first and last column of bytes in which some of these rows differ. */
static bool row_span(const struct raster *now, const struct raster *then, uint32_t top,
                     uint32_t height, size_t *from, size_t *to)
{
    *from = SIZE_MAX;
    *to = 0;
    for (uint32_t y = top; y < top + height; y++) {
        size_t first, last;
        if (!differing(now->bytes + y * now->stride, then->bytes + y * then->stride,
                       now->width * raster_pixel_bytes(now), &first, &last))
            continue;
        *from = first < *from ? first : *from;
        *to = last > *to ? last : *to;
    }
    return *from != SIZE_MAX;
}

void stale_find(struct stale *stale, const struct raster *now, const struct raster *then,
                const struct stale_rule *rule)
{
    const size_t each = raster_pixel_bytes(now);
    stale->count = 0;
    stale->cost = 0;
    for (uint32_t top = 0; top < now->height; top += rule->tile_height) {
        const uint32_t height = least(rule->tile_height, now->height - top);
        size_t from, to;
        if (!row_span(now, then, top, height, &from, &to))
            continue;
        uint32_t left = (uint32_t)(from / each / rule->tile_width) * rule->tile_width;
        for (; left < now->width && left <= to / each; left += rule->tile_width) {
            const struct raster_box tile = {left, top, least(rule->tile_width, now->width - left),
                                            height};
            struct raster_box tight = tile;
            if (tighten(&tight, now, then))
                add_box(stale, rule->whole_tiles ? tile : tight, rule->box_cost);
        }
    }
    for (unsigned i = 0; i < stale->count; i++)
        stale->cost += cost_of(stale->box[i], rule->box_cost);
}
