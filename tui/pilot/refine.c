#include "tui/pilot/refine.h"

#include <stdlib.h>
#include <string.h>

#include "base/least.h"
#include "base/mem.h"

enum { GAP_MOST = 6 }; /* tiles */

/* Bytes a tile before anything is known: about what palette pictures take. */
static const double cost_at_first[REFINE_LEVELS] = {160, 70, 35, 22, 10};

void refine_forget(struct refine *r)
{
    free(r->rgba);
    r->rgba = NULL;
    r->width = r->height = 0;
    r->is_coarse = false;
}

void refine_release(struct refine *r)
{
    free(r->rgba);
    free(r->stale);
    *r = (struct refine){0};
}

/* A part of the picture: one tile, cut at the edges. */
struct tile {
    uint32_t left, top, width, height;
};

static struct tile tile_at(const struct refine *r, uint32_t left, uint32_t top)
{
    return (struct tile){left, top, least(REFINE_TILE, r->width - left),
                         least(REFINE_TILE, r->height - top)};
}

static bool tile_differs(const struct refine *r, const uint8_t *wanted, const struct tile *t)
{
    for (uint32_t y = t->top; y < t->top + t->height; y++) {
        const size_t at = 4 * ((size_t)y * r->width + t->left);
        if (memcmp(r->rgba + at, wanted + at, (size_t)4 * t->width) != 0)
            return true;
    }
    return false;
}

/* Blocks of `coarse` pixels a side, each of the colour in its middle: no mean, so that a palette
 * stays what it was. */
static void copy_tile(struct refine *r, const uint8_t *wanted, const struct tile *t,
                      uint32_t coarse)
{
    for (uint32_t y = t->top; coarse == 1 && y < t->top + t->height; y++) {
        const size_t at = 4 * ((size_t)y * r->width + t->left);
        memcpy(r->rgba + at, wanted + at, (size_t)4 * t->width);
    }
    for (uint32_t y = t->top; coarse > 1 && y < t->top + t->height; y++)
        for (uint32_t x = t->left; x < t->left + t->width; x++) {
            const uint32_t from_x = least(x / coarse * coarse + coarse / 2, r->width - 1);
            const uint32_t from_y = least(y / coarse * coarse + coarse / 2, r->height - 1);
            memcpy(r->rgba + 4 * ((size_t)y * r->width + x),
                   wanted + 4 * ((size_t)from_y * r->width + from_x), 4);
        }
}

/* Lists the tiles that differ from what is wanted. False without memory. */
static bool list_stale(struct refine *r, const uint8_t *wanted)
{
    r->stales = 0;
    for (uint32_t top = 0; top < r->height; top += REFINE_TILE)
        for (uint32_t left = 0; left < r->width; left += REFINE_TILE) {
            const struct tile t = tile_at(r, left, top);
            if (!tile_differs(r, wanted, &t))
                continue;
            if (!mem_grow(&r->stale, &r->stale_capacity, r->stales + 1, sizeof *r->stale))
                return false;
            r->stale[r->stales++] = (struct refine_place){left, top};
        }
    return true;
}

/* In a hurry, fine tiles between coarse ones go coarse as well: they would be sent again with what
 * is around them, and cost more than all of that. */
static void coarsen_between(struct refine *r, const uint8_t *wanted, size_t i, uint32_t coarse)
{
    const struct refine_place *here = r->stale + i, *before = here - 1;
    if (i == 0 || before->top != here->top || here->left - before->left > GAP_MOST * REFINE_TILE)
        return;
    for (uint32_t left = before->left + REFINE_TILE; left < here->left; left += REFINE_TILE) {
        const struct tile t = tile_at(r, left, here->top);
        copy_tile(r, wanted, &t, coarse);
    }
}

static bool begin_size(struct refine *r, const struct image_view *wanted)
{
    if (r->rgba && r->width == wanted->width && r->height == wanted->height)
        return true;
    refine_forget(r);
    r->rgba = calloc((size_t)wanted->width * wanted->height, 4);
    r->width = wanted->width;
    r->height = wanted->height;
    return r->rgba != NULL;
}

bool refine_begin(struct refine *r, const struct image_view *wanted, bool moves, size_t budget,
                  struct image_view *shown)
{
    if (r->cost[0] <= 0)
        memcpy(r->cost, cost_at_first, sizeof r->cost);
    if (!begin_size(r, wanted) || !list_stale(r, wanted->rgba))
        return false;
    const size_t stale = r->stales;
    const double may = (double)budget;
    unsigned level = 0;
    while (moves && level + 1 < REFINE_LEVELS && (double)stale * r->cost[level] > may)
        level++;
    size_t most = stale;
    if (!moves) { /* as many as there is room for, in full */
        const double fit = may / r->cost[0];
        most = fit < 1 ? 1 : fit < (double)stale ? (size_t)fit : stale;
    }
    r->level = level;
    r->tiles = most < stale ? most : stale;
    for (size_t i = 0; i < r->tiles; i++) {
        const struct tile t = tile_at(r, r->stale[i].left, r->stale[i].top);
        copy_tile(r, wanted->rgba, &t, 1U << level);
        if (level > 0)
            coarsen_between(r, wanted->rgba, i, 1U << level);
    }
    r->is_coarse = level > 0 || most < stale;
    *shown = *wanted;
    shown->rgba = r->rgba;
    shown->is_coarse = level > 0;
    return true;
}

void refine_sent(struct refine *r, size_t bytes)
{
    if (r->tiles < 4)
        return; /* what goes with every frame counts for more than the tiles */
    const double cost = (double)bytes / (double)r->tiles;
    r->cost[r->level] += (cost - r->cost[r->level]) / 2;
    r->cost[r->level] = r->cost[r->level] < 1 ? 1 : r->cost[r->level];
}
