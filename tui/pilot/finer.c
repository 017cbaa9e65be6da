/* SPDX-License-Identifier: MIT */
#include "tui/pilot/flow.h"

#include <stdlib.h>
#include <string.h>

#include "base/least.h"
#include "base/mem.h"

enum { GAP_MOST = 6 };            /* tiles */
enum { BLOCK = 3 * REFINE_TILE }; /* rows; whole bands of sixels, which have six */
/* Levels of a channel in coarse tiles; in the coarsest so few that neighbours are often equal. */
enum { COARSEST = 1 << (REFINE_LEVELS - 1), LEVELS = 32, LEVELS_OF_COARSEST = 8 };

/* Bytes per tile before any frame was sent: about the size in palette pictures. */
static const double cost_at_first[REFINE_LEVELS] = {160, 70, 35, 20, 6};

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

static uint8_t rounded(uint8_t channel, unsigned levels)
{
    return (uint8_t)(channel * levels / 256 * 255 / (levels - 1));
}

/* Fill a block with the colour in its middle, in fewer levels. A mean would need new entries in the
 * palette. Words stay sharp, in the coarsest tiles in as few levels. */
static void copy_block(struct refine *r, const struct image_view *wanted, uint32_t left,
                       uint32_t top, uint32_t coarse)
{
    const size_t middle = middle_of(r, wanted, left, top, coarse);
    const unsigned levels = coarse < COARSEST ? LEVELS : LEVELS_OF_COARSEST;
    const unsigned of_words = coarse < COARSEST ? 256 : levels;
    uint8_t block[4];
    for (unsigned k = 0; k < 4; k++)
        block[k] = rounded(wanted->rgba[4 * middle + k], levels);
    for (uint32_t y = top; y < top + coarse && y < r->height; y++)
        for (uint32_t x = left; x < left + coarse && x < r->width; x++) {
            const size_t at = (size_t)y * r->width + x;
            const bool is_word = wanted->words && wanted->words[at];
            for (unsigned k = 0; k < 4; k++)
                r->rgba[4 * at + k] =
                    is_word ? rounded(wanted->rgba[4 * at + k], of_words) : block[k];
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

/* List the tiles that differ from the wanted picture, inside the focus or outside, by columns of
 * blocks if they are to be fine; make those fine whose greys the terminal has. Return false without
 * memory. */
static bool list_stale(struct refine *r, const struct image_view *wanted, bool in_focus, bool moves)
{
    const uint32_t rows = moves ? REFINE_TILE : BLOCK, blocks = (r->height + rows - 1) / rows;
    const uint32_t across = (r->width + REFINE_TILE - 1) / REFINE_TILE, down = rows / REFINE_TILE;
    for (uint32_t i = 0; i < blocks * across * down; i++) {
        const uint32_t top = i / down / across * rows + i % down * REFINE_TILE;
        const struct raster_box t = tile_at(r, i / down % across * REFINE_TILE, top);
        bool differs = false;
        if (top >= r->height || is_within(&wanted->focus, &t) != in_focus)
            continue;
        for (uint32_t y = top; !differs && y < top + t.height; y++) {
            const size_t at = 4 * ((size_t)y * r->width + t.left);
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

/* Return the number of fine tiles in a frame where `fit` fit: up to the end of a row of blocks, if
 * it is near, since each piece of one has a fixed cost. */
static size_t to_end_of_row(const struct refine *r, size_t fit)
{
    size_t end = fit;
    while (end < r->stales && r->stale[end].left >= r->stale[end - 1].left)
        end++;
    return end <= fit + fit / 2 ? end : fit;
}

bool refine_begin(struct refine *r, const struct image_view *wanted, bool moves, size_t budget,
                  struct image_view *shown)
{
    const bool is_new = !r->rgba || r->width != wanted->width || r->height != wanted->height;
    if (r->cost[0] <= 0)
        memcpy(r->cost, cost_at_first, sizeof r->cost);
    r->stales = 0;
    r->waits = false;
    if (is_new) {
        refine_forget(r);
        r->rgba = calloc((size_t)wanted->width * wanted->height, 4);
        r->width = wanted->width;
        r->height = wanted->height;
    }
    moves |= r->is_begun;
    if (!r->rgba || !list_stale(r, wanted, true, moves) || !list_stale(r, wanted, false, moves))
        return false;
    const size_t stale = r->stales;
    const double may = (double)budget;
    unsigned level = 0;
    while (moves && level + 1 < REFINE_LEVELS && (double)stale * r->cost[level] > may)
        level++;
    const double fit = may / r->cost[level] < 1 ? 1 : may / r->cost[level];
    size_t most = stale;
    if (fit < (double)stale && (is_new || !moves))
        most = moves ? (size_t)fit : to_end_of_row(r, (size_t)fit);
    r->is_begun = is_new && moves && most < stale;
    r->level = level;
    r->tiles = most;
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
