/* SPDX-License-Identifier: MIT */
#include "tests/bench/effort_hand.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "base/mem.h"

static const double clicked = 1.5; /* voxels that a polygon of clicks may be off */

void hand_outline_release(struct hand_outline *outline)
{
    polyline_release(&outline->line);
    free(outline->place);
    *outline = (struct hand_outline){0};
}

uint64_t hand_random(uint64_t *random)
{
    *random += UINT64_C(0x9e3779b97f4a7c15);
    return hash_mix(*random);
}

/* The sum of four even bytes, nearly normal, with a standard deviation of 1. */
static double deviate(uint64_t *random)
{
    const uint64_t mix = hand_random(random);
    int sum = -510;
    for (int i = 0; i < 4; i++)
        sum += (int)(mix >> 8 * i & 255);
    return sum / 147.8;
}

static double length(const struct hand_place *a, const struct hand_place *b)
{
    const double x = b->at[0] - a->at[0], y = b->at[1] - a->at[1];
    return sqrt(x * x + y * y);
}

static bool add(struct hand_outline *outline, double x, double y)
{
    if (!mem_grow(&outline->place, &outline->capacity, outline->count + 1, sizeof *outline->place))
        return false;
    outline->place[outline->count++] = (struct hand_place){{x, y}};
    return true;
}

/* ---- around a piece ---- */

static bool is_in(const struct hand_slice *piece, int64_t x, int64_t y)
{
    return x >= 0 && y >= 0 && x < piece->size[0] && y < piece->size[1] &&
           piece->voxel[(size_t)y * piece->size[0] + (size_t)x];
}

/* From the first voxel on, by the neighbour that comes first in clockwise order after the one
 * outside that was looked at last, until the same step would be taken again (Moore, Jacob). */
static bool trace(struct hand_outline *outline, const struct hand_slice *piece)
{
    static const int way[8][2] = {{1, 0},  {1, 1},   {0, 1},  {-1, 1},
                                  {-1, 0}, {-1, -1}, {0, -1}, {1, -1}};
    const size_t all = (size_t)piece->size[0] * piece->size[1];
    const uint8_t *first = memchr(piece->voxel, 1, all);
    const int64_t start = first ? first - piece->voxel : 0;
    const int64_t from[2] = {start % piece->size[0], start / piece->size[0]};
    int64_t x = from[0], y = from[1];
    int outside = 4, begin = -1;
    outline->count = 0;
    while (first) {
        int i = 1, d;
        while (i <= 8 &&
               !is_in(piece, x + way[(outside + i) % 8][0], y + way[(outside + i) % 8][1]))
            i++;
        d = (outside + i) % 8;
        if (x == from[0] && y == from[1] && (d == begin || i > 8))
            return outline->count > 0 || add(outline, (double)x, (double)y);
        begin = begin < 0 ? d : begin;
        if (!add(outline, (double)x, (double)y))
            return false;
        x += way[d][0], y += way[d][1];
        outside = (d + (d % 2 ? 5 : 6)) % 8;
    }
    return true;
}

/* ---- as a hand does it ---- */

static double around(const struct hand_outline *outline)
{
    double sum = 0;
    for (size_t i = 0; i < outline->count; i++)
        sum += length(&outline->place[i], &outline->place[(i + 1) % outline->count]);
    return sum;
}

static double around_polygon(const struct polyline *line)
{
    double sum = 0;
    for (size_t i = 0; i < line->count; i++) {
        const uint32_t *a = line->corner[i], *b = line->corner[(i + 1) % line->count];
        sum += length(&(struct hand_place){{a[0], a[1]}}, &(struct hand_place){{b[0], b[1]}});
    }
    return sum;
}

static bool shake(struct hand_outline *outline, double off, uint64_t *random)
{
    const double all = around(outline);
    const size_t knots = all > 4 * HAND_TREMOR ? (size_t)(all / HAND_TREMOR) : 4;
    struct hand_place *knot = mem_array(knots, sizeof *knot);
    double way = 0;
    if (!knot)
        return false;
    for (size_t k = 0; k < knots; k++)
        for (int a = 0; a < 2; a++)
            knot[k].at[a] = off * deviate(random);
    struct hand_place before = outline->place[0];
    for (size_t i = 0; i < outline->count; i++) {
        struct hand_place *p = &outline->place[i];
        const struct hand_place here = *p;
        way += length(&before, &here);
        before = here;
        const double place = all > 0 ? way / all * (double)knots : 0;
        const size_t k = (size_t)place % knots, next = (k + 1) % knots;
        const double part = place - floor(place);
        const double one = sqrt(part * part + (1 - part) * (1 - part));
        for (int a = 0; a < 2; a++)
            p->at[a] += ((1 - part) * knot[k].at[a] + part * knot[next].at[a]) / one;
    }
    free(knot);
    return true;
}

/* Voxels of the slice, each once where it comes several times in a row. */
static void go_by_voxels(struct hand_outline *outline, const uint32_t size[2])
{
    size_t kept = 0;
    for (size_t i = 0; i < outline->count; i++) {
        struct hand_place p = outline->place[i];
        for (int a = 0; a < 2; a++) {
            p.at[a] = floor(p.at[a] + 0.5);
            p.at[a] = p.at[a] < 0 ? 0 : p.at[a] > size[a] - 1 ? size[a] - 1 : p.at[a];
        }
        if (kept == 0 || length(&outline->place[kept - 1], &p) > 0)
            outline->place[kept++] = p;
    }
    while (kept > 1 && length(&outline->place[kept - 1], &outline->place[0]) <= 0)
        kept--;
    outline->count = kept;
}

/* ---- simpler ---- */

static double away(const struct hand_place *p, const struct hand_place *a,
                   const struct hand_place *b)
{
    const double x = b->at[0] - a->at[0], y = b->at[1] - a->at[1], all = x * x + y * y;
    double part = all > 0 ? ((p->at[0] - a->at[0]) * x + (p->at[1] - a->at[1]) * y) / all : 0;
    part = part < 0 ? 0 : part > 1 ? 1 : part;
    return length(p, &(struct hand_place){{a->at[0] + part * x, a->at[1] + part * y}});
}

/* Of the places between two that stay, the farthest from the way between them stays where it is too
 * far (Douglas, Peucker). `last` may be the first one, come around. */
static void keep_between(bool *stays, const struct hand_outline *o, size_t first, size_t last,
                         double most)
{
    size_t farthest = first;
    double far = most;
    for (size_t i = first + 1; i < last; i++) {
        const double d = away(&o->place[i], &o->place[first], &o->place[last % o->count]);
        farthest = d > far ? i : farthest;
        far = d > far ? d : far;
    }
    if (farthest == first)
        return;
    stays[farthest] = true;
    keep_between(stays, o, first, farthest, most);
    keep_between(stays, o, farthest, last, most);
}

/* How many stay: the first, the one that is farthest from it, and those that are needed. */
static size_t choose(bool *stays, const struct hand_outline *o, double most)
{
    size_t farthest = 0, count = 0;
    for (size_t i = 1; i < o->count; i++)
        if (length(&o->place[i], &o->place[0]) > length(&o->place[farthest], &o->place[0]))
            farthest = i;
    memset(stays, 0, o->count);
    stays[0] = stays[farthest] = true;
    keep_between(stays, o, 0, farthest, most);
    keep_between(stays, o, farthest, o->count, most);
    for (size_t i = 0; i < o->count; i++)
        count += stays[i];
    return count;
}

/* The polygon, from its first corner and back to it. */
static bool simplify(struct hand_outline *outline)
{
    outline->line.count = 0;
    for (size_t i = 0; i <= outline->count; i++) {
        const double *at = outline->place[i % outline->count].at;
        if (!polyline_add(&outline->line, (const uint32_t[]){(uint32_t)at[0], (uint32_t)at[1], 0}))
            return false;
    }
    polyline_simplify(&outline->line);
    outline->line.count -= outline->line.count > 1;
    return true;
}

enum err hand_draw(struct hand_outline *outline, const struct hand_slice *piece, unsigned tenths,
                   uint64_t *random, struct fault *fault)
{
    if (!trace(outline, piece) || !shake(outline, tenths / 10.0, random))
        return fault_memory(fault, "an outline");
    go_by_voxels(outline, piece->size);
    bool *stays = mem_array(outline->count, sizeof *stays);
    if (!stays || !simplify(outline)) {
        free(stays);
        return fault_memory(fault, "an outline");
    }
    outline->clicks = (unsigned)choose(stays, outline, clicked);
    outline->path = around_polygon(&outline->line);
    free(stays);
    return OK;
}
