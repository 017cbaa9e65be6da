/* SPDX-License-Identifier: MIT */
#include "tui/pilot/flow.h"

#include <stdlib.h>
#include <string.h>

#include "base/least.h"
#include "base/mem.h"

enum { GAP_MOST = 6 }; /* tiles */
/* Levels of a channel in coarse tiles; in the coarsest so few that neighbours are often equal. */
enum { COARSEST = 1 << (REFINE_LEVELS - 1), LEVELS = 32, LEVELS_OF_COARSEST = 8 };

/* Bytes per tile before any frame was sent: about the size in palette pictures. */
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

/* Return one tile of the picture, cut at the edges. */
static struct raster_box tile_at(const struct refine *r, uint32_t left, uint32_t top)
{
    return (struct raster_box){left, top, least(REFINE_TILE, r->width - left),
                               least(REFINE_TILE, r->height - top)};
}

/* Return the pixel in the middle of a block of `coarse` pixels a side; not one of words, if
 * possible. */
static size_t middle_of(const struct refine *r, const struct image_view *wanted, uint32_t left,
                        uint32_t top, uint32_t coarse)
{
    const uint32_t x = least(left + coarse / 2, r->width - 1);
    const uint32_t y = least(top + coarse / 2, r->height - 1);
    const size_t middle = (size_t)y * r->width + x, first = (size_t)top * r->width + left;
    for (uint32_t i = 0; wanted->words && wanted->words[middle] && i < coarse * coarse; i++) {
        const size_t at = first + (size_t)(i / coarse) * r->width + i % coarse;
        if (left + i % coarse < r->width && top + i / coarse < r->height && !wanted->words[at])
            return at;
    }
    return middle;
}

/* Fill a block with the colour in its middle, in fewer levels. A mean would need new entries in the
 * palette. */
static void copy_block(struct refine *r, const struct image_view *wanted, uint32_t left,
                       uint32_t top, uint32_t coarse)
{
    const size_t middle = middle_of(r, wanted, left, top, coarse);
    const unsigned levels = coarse < COARSEST ? LEVELS : LEVELS_OF_COARSEST;
    uint8_t block[4];
    for (unsigned k = 0; k < 4; k++)
        block[k] = (uint8_t)(wanted->rgba[4 * middle + k] * levels / 256 * 255 / (levels - 1));
    for (uint32_t y = top; y < top + coarse && y < r->height; y++)
        for (uint32_t x = left; x < left + coarse && x < r->width; x++) {
            const size_t at = (size_t)y * r->width + x;
            const bool is_word = wanted->words && wanted->words[at];
            memcpy(r->rgba + 4 * at, is_word ? wanted->rgba + 4 * at : block, 4);
        }
}

static void copy_tile(struct refine *r, const struct image_view *wanted, const struct raster_box *t,
                      uint32_t coarse)
{
    for (uint32_t y = t->top; coarse == 1 && y < t->top + t->height; y++) {
        const size_t at = 4 * ((size_t)y * r->width + t->left);
        memcpy(r->rgba + at, wanted->rgba + at, (size_t)4 * t->width);
    }
    for (uint32_t y = t->top; coarse > 1 && y < t->top + t->height; y += coarse)
        for (uint32_t x = t->left; x < t->left + t->width; x += coarse)
            copy_block(r, wanted, x, y, coarse);
}

static bool is_within(const struct raster_box *box, const struct raster_box *t)
{
    return t->left + t->width > box->left && t->left < box->left + box->width &&
           t->top + t->height > box->top && t->top < box->top + box->height;
}

enum below { BELOW_NOTHING, BELOW_THERE, BELOW_AWAITED };

static enum below below_of(const struct image_view *wanted, const struct raster_box *t)
{
    enum below below = BELOW_NOTHING;
    for (unsigned i = 0; i < wanted->strips; i++)
        if (is_within(&wanted->strip[i].box, t)) {
            if (!wanted->strip[i].number)
                return BELOW_AWAITED;
            below = BELOW_THERE;
        }
    return below;
}

/* List the tiles that differ from the wanted picture, inside the focus or outside; make those fine
 * whose greys the terminal has. Return false without memory. */
static bool list_stale(struct refine *r, const struct image_view *wanted, bool in_focus, bool moves)
{
    for (uint32_t top = 0; top < r->height; top += REFINE_TILE)
        for (uint32_t left = 0; left < r->width; left += REFINE_TILE) {
            const struct raster_box t = tile_at(r, left, top);
            bool differs = false;
            if (is_within(&wanted->focus, &t) != in_focus)
                continue;
            for (uint32_t y = top; !differs && y < top + t.height; y++) {
                const size_t at = 4 * ((size_t)y * r->width + left);
                differs = memcmp(r->rgba + at, wanted->rgba + at, (size_t)4 * t.width) != 0;
            }
            if (!differs)
                continue;
            const enum below below = below_of(wanted, &t);
            if (below == BELOW_THERE)
                copy_tile(r, wanted, &t, 1);
            r->waits |= below == BELOW_AWAITED && !moves;
            if (below == BELOW_THERE || (below == BELOW_AWAITED && !moves))
                continue;
            if (!mem_grow(&r->stale, &r->stale_capacity, r->stales + 1, sizeof *r->stale))
                return false;
            r->stale[r->stales++] = t;
        }
    return true;
}

bool refine_begin(struct refine *r, const struct image_view *wanted, bool moves, size_t budget,
                  struct image_view *shown)
{
    if (r->cost[0] <= 0)
        memcpy(r->cost, cost_at_first, sizeof r->cost);
    r->stales = 0;
    r->waits = false;
    if (!r->rgba || r->width != wanted->width || r->height != wanted->height) {
        refine_forget(r);
        r->rgba = calloc((size_t)wanted->width * wanted->height, 4);
        r->width = wanted->width;
        r->height = wanted->height;
    }
    if (!r->rgba || !list_stale(r, wanted, true, moves) || !list_stale(r, wanted, false, moves))
        return false;
    const size_t stale = r->stales;
    const double may = (double)budget;
    unsigned level = 0;
    while (moves && level + 1 < REFINE_LEVELS && (double)stale * r->cost[level] > may)
        level++;
    size_t most = stale;
    if (!moves) { /* full tiles, limited by the budget */
        const double fit = may / r->cost[0];
        most = fit < 1 ? 1 : fit < (double)stale ? (size_t)fit : stale;
    }
    r->level = level;
    r->tiles = most < stale ? most : stale;
    for (size_t i = 0; i < r->tiles; i++) {
        const struct raster_box *here = r->stale + i, *before = i ? here - 1 : here;
        uint32_t left = here->left;
        /* Fine tiles between coarse ones become coarse too: they would be sent again with the
         * tiles around them, and cost more than all of those. */
        if (level > 0 && before->top == here->top && here->left > before->left &&
            here->left - before->left <= GAP_MOST * REFINE_TILE)
            left = before->left + REFINE_TILE;
        for (; left <= here->left; left += REFINE_TILE) {
            const struct raster_box t = tile_at(r, left, here->top);
            copy_tile(r, wanted, &t, 1U << level);
        }
    }
    r->is_coarse = level > 0 || most < stale || r->waits;
    *shown = *wanted;
    shown->rgba = r->rgba, shown->fine = wanted->rgba;
    shown->is_coarse = level > 0;
    return true;
}

void refine_sent(struct refine *r, size_t bytes)
{
    if (r->tiles < 4)
        return; /* the fixed bytes of a frame exceed those of the tiles */
    const double cost = (double)bytes / (double)r->tiles;
    r->cost[r->level] += (cost - r->cost[r->level]) / 2;
    r->cost[r->level] = r->cost[r->level] < 1 ? 1 : r->cost[r->level];
}
