/* SPDX-License-Identifier: MIT */
/*
 * Reduction of triangles: one point after another moves to a neighbour, and the two triangles
 * between them are removed.
 *
 * Corner 3 t + k is that of triangle t at its point k. `across` of a corner is the corner beyond
 * the edge opposite to it: it defines all connections of triangles. Points keep their positions.
 *
 * The next move is the one of the least cost: the volume that it sweeps, which does not depend on
 * spacing, plus a term for its length, so that flat parts have even triangles. After Lindstrom and
 * Turk, "Fast and memory efficient polygonal simplification" (1998), who use volumes between the
 * current surface and the next, not the original one.
 *
 * A surface is larger than the L1 and L2 caches, and moves are scattered over it: so the data of a
 * point fit half a cache line, and likewise of a triangle; costs are stored in the heap. Values
 * that all moves of a point share are computed once.
 */
#include "engine/surface.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

enum {
    SHIFT = NET_BITS - 8,  /* positions count 1/256 voxel here: */
    LENGTH_MOST = 64 << 8, /* limit of an edge along an axis, so that products fit */
    LENGTH_PRICE = 16,     /* equals one triangle that moves by 1/16 voxel */
    SPOKES_MOST = 1024,    /* a point with more neighbours is not moved */
};

static const uint32_t NONE = UINT32_MAX;
static const uint64_t NEVER = UINT64_MAX;

struct corner {
    uint32_t point, across;
};

struct node {
    uint32_t at[3];  /* its position, in units of 2^SHIFT */
    uint32_t corner; /* a corner at the point; NONE if it was removed */
    uint32_t to;     /* the point that it moves to at the least cost */
    uint32_t rank;   /* its rank in the heap; finally its new number */
};

/* Cost of moving a point; NEVER if it cannot move. */
struct price {
    uint64_t cost;
    uint32_t point;
};

/* A neighbour of the current point, and the triangle between it and the next one. */
struct spoke {
    uint32_t corner;   /* corner of the point; the next one is the neighbour's */
    bool is_out;       /* excluded as a target */
    int64_t way[3];    /* to the neighbour */
    int64_t normal[3]; /* normal of the triangle, with twice its area as length */
    int64_t turn[3];   /* (from this neighbour to the next) x normal */
    int64_t squared;   /* normal . normal */
};

struct reduction {
    struct surface *surface;
    struct corner *corner;
    struct node *node;  /* by point */
    struct price *heap; /* the least cost first, and the first point on a tie */
    uint32_t in_heap;
    size_t triangles; /* triangles left */

    /* Neighbours of the current point. */
    unsigned spokes;
    uint64_t seen; /* bit n % 64 of each neighbour n */
    uint32_t neighbour[SPOKES_MOST];
    struct spoke spoke[SPOKES_MOST];
};

/* ---- corners ---- */

static uint32_t next_in_triangle(uint32_t corner)
{
    return corner % 3 == 2 ? corner - 2 : corner + 1;
}

static uint32_t last_in_triangle(uint32_t corner)
{
    return corner % 3 == 0 ? corner + 2 : corner - 1;
}

static uint32_t point_at(const struct reduction *r, uint32_t corner)
{
    return r->corner[corner].point;
}

/* The next corner around the same point: its triangle has the edge from the point to the last point
 * of this one. */
static uint32_t swing(const struct reduction *r, uint32_t corner)
{
    return next_in_triangle(r->corner[next_in_triangle(corner)].across);
}

static void glue(struct reduction *r, uint32_t corner, uint32_t other)
{
    r->corner[corner].across = other;
    r->corner[other].across = corner;
}

/* Find the opposite of each edge, with a list of corners for each point in `next`. */
static void find_across(struct reduction *r, uint32_t *next)
{
    const uint32_t corners = (uint32_t)(3 * r->surface->triangles);
    for (uint32_t c = 0; c < corners; c++) {
        const uint32_t point = r->surface->triangle[c / 3].point[c % 3];
        r->corner[c].point = point;
        next[c] = r->node[point].corner;
        r->node[point].corner = c;
    }
    for (uint32_t c = 0; c < corners; c++) {
        const uint32_t from = point_at(r, next_in_triangle(c)),
                       to = point_at(r, last_in_triangle(c));
        uint32_t k = r->node[to].corner;
        while (point_at(r, next_in_triangle(k)) != from)
            k = next[k];
        r->corner[c].across = last_in_triangle(k);
    }
}

/* ---- the cost of moves ---- */

/* True if the point of a corner has four neighbours or more. */
static bool has_four_neighbours(const struct reduction *r, uint32_t corner)
{
    return swing(r, swing(r, swing(r, corner))) != corner;
}

static bool is_neighbour(const struct reduction *r, uint32_t point)
{
    if (!(r->seen >> point % 64 & 1))
        return false;
    for (unsigned i = 0; i < r->spokes; i++)
        if (r->neighbour[i] == point)
            return true;
    return false;
}

/* True if the surface stays a manifold: the current point and the other one have no neighbours in
 * common except those of the triangles between them, and these have four or more neighbours.
 * `corner` is the point's, followed by the edge to the other one. */
static bool stays_manifold(const struct reduction *r, uint32_t corner)
{
    const uint32_t left = last_in_triangle(corner), right = r->corner[left].across;
    const uint32_t first = next_in_triangle(corner);
    unsigned common = 0;
    uint32_t c = first;
    if (!has_four_neighbours(r, left) || !has_four_neighbours(r, right))
        return false;
    do {
        common += is_neighbour(r, point_at(r, next_in_triangle(c)));
        c = swing(r, c);
    } while (c != first);
    return common == 2;
}

static void cross_product(int64_t out[3], const int64_t u[3], const int64_t v[3])
{
    out[0] = u[1] * v[2] - u[2] * v[1];
    out[1] = u[2] * v[0] - u[0] * v[2];
    out[2] = u[0] * v[1] - u[1] * v[0];
}

static int64_t product(const int64_t u[3], const int64_t v[3])
{
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
}

/* Find the neighbours of a point; false if it has too many. */
static bool find_neighbours(struct reduction *r, uint32_t point)
{
    const uint32_t first = r->node[point].corner;
    uint32_t c = first;
    r->spokes = 0;
    r->seen = 0;
    do {
        const uint32_t neighbour = point_at(r, next_in_triangle(c));
        r->seen |= UINT64_C(1) << neighbour % 64;
        r->neighbour[r->spokes] = neighbour;
        r->spoke[r->spokes++].corner = c;
        c = swing(r, c);
    } while (c != first && r->spokes < SPOKES_MOST);
    return c == first;
}

/* Cost of moving to a neighbour; NEVER if it is not below `most`, or if a triangle would turn over:
 * its normal would be normal - step x edge. Two of the triangles are removed. */
static uint64_t cost_of_move(const struct reduction *r, unsigned to, uint64_t most)
{
    const int64_t *step = r->spoke[to].way;
    const unsigned before = to ? to - 1 : r->spokes - 1;
    uint64_t cost = (uint64_t)product(step, step) * LENGTH_PRICE;
    for (unsigned i = 0; i < r->spokes && cost < most; i++) {
        const struct spoke *spoke = r->spoke + i;
        if (i == to || i == before)
            continue;
        if (product(step, spoke->turn) >= spoke->squared)
            return NEVER;
        cost += (uint64_t)llabs(product(spoke->normal, step));
    }
    return cost < most ? cost : NEVER;
}

/* The least cost of the neighbours that are not excluded; the first on a tie. */
static uint64_t least_cost(const struct reduction *r, unsigned *to)
{
    uint64_t least = NEVER;
    for (unsigned i = 0; i < r->spokes; i++) {
        const uint64_t cost = r->spoke[i].is_out ? NEVER : cost_of_move(r, i, least);
        if (cost < least) {
            least = cost;
            *to = i;
        }
    }
    return least;
}

/* Compute the data shared by all moves of a point; false if it cannot move. */
static bool look_around(struct reduction *r, uint32_t point)
{
    if (!find_neighbours(r, point))
        return false;
    const uint32_t *from = r->node[point].at;
    for (unsigned i = 0; i < r->spokes; i++) {
        const uint32_t *to = r->node[r->neighbour[i]].at;
        r->spoke[i].is_out = false;
        for (int a = 0; a < 3; a++)
            r->spoke[i].way[a] = (int64_t)to[a] - (int64_t)from[a];
    }
    /* No edge is too long now, and none may become too long: exclude neighbours that are too far
     * from others. */
    int64_t low[3] = {0}, high[3] = {0};
    for (unsigned i = 0; i < r->spokes; i++)
        for (int j = 0; j < 3; j++) {
            const int64_t way = r->spoke[i].way[j];
            low[j] = way < low[j] ? way : low[j];
            high[j] = way > high[j] ? way : high[j];
        }
    bool fits = true;
    for (int j = 0; j < 3; j++)
        fits &= high[j] < LENGTH_MOST && low[j] > -LENGTH_MOST;
    for (unsigned i = 0; fits && i < r->spokes; i++)
        for (int j = 0; j < 3; j++)
            r->spoke[i].is_out |= high[j] - r->spoke[i].way[j] >= LENGTH_MOST ||
                                  r->spoke[i].way[j] - low[j] >= LENGTH_MOST;
    if (!fits)
        return false;
    for (unsigned i = 0; i < r->spokes; i++) {
        struct spoke *spoke = r->spoke + i;
        const struct spoke *next = r->spoke + (i + 1 < r->spokes ? i + 1 : 0);
        int64_t edge[3];
        for (int a = 0; a < 3; a++)
            edge[a] = next->way[a] - spoke->way[a];
        cross_product(spoke->normal, spoke->way, next->way);
        cross_product(spoke->turn, edge, spoke->normal);
        spoke->squared = product(spoke->normal, spoke->normal);
    }
    return true;
}

/* Find the move of the least cost, the first around the point on a tie; return the cost. If it is
 * to be sound, it keeps the current surface a manifold; for others that test is postponed until the
 * move is the next one: few ever are. */
static uint64_t find_move(struct reduction *r, uint32_t point, bool is_sound)
{
    uint64_t cost;
    unsigned to = 0;
    if (!look_around(r, point))
        return NEVER;
    while ((cost = least_cost(r, &to)) != NEVER) {
        r->node[point].to = r->neighbour[to];
        if (!is_sound || stays_manifold(r, r->spoke[to].corner))
            break;
        r->spoke[to].is_out = true;
    }
    return cost;
}

/* ---- the heap ---- */

static bool comes_before(struct price a, struct price b)
{
    return a.cost < b.cost || (a.cost == b.cost && a.point < b.point);
}

static void put_at(struct reduction *r, uint32_t rank, struct price price)
{
    r->heap[rank] = price;
    r->node[price.point].rank = rank;
}

/* Insert a price into the heap, starting at the free rank. */
static void settle(struct reduction *r, uint32_t rank, struct price price)
{
    for (; rank && comes_before(price, r->heap[(rank - 1) / 2]); rank = (rank - 1) / 2)
        put_at(r, rank, r->heap[(rank - 1) / 2]);
    for (;;) {
        uint32_t below = 2 * rank + 1;
        if (below >= r->in_heap)
            break;
        if (below + 1 < r->in_heap && comes_before(r->heap[below + 1], r->heap[below]))
            below++;
        if (!comes_before(r->heap[below], price))
            break;
        put_at(r, rank, r->heap[below]);
        rank = below;
    }
    put_at(r, rank, price);
}

/* ---- moving ---- */

static uint32_t corner_towards(const struct reduction *r, uint32_t point, uint32_t to)
{
    uint32_t c = r->node[point].corner;
    while (point_at(r, next_in_triangle(c)) != to)
        c = swing(r, c);
    return c;
}

static void move_point(struct reduction *r, uint32_t point)
{
    const uint32_t to = r->node[point].to, corner = corner_towards(r, point, to);
    const uint32_t other =
        r->corner[last_in_triangle(corner)].across; /* corner of the adjacent triangle */
    const uint32_t left = point_at(r, last_in_triangle(corner)), right = point_at(r, other);
    uint32_t c = corner;
    do {
        r->corner[c].point = to;
        c = swing(r, c);
    } while (c != corner);
    const uint32_t ahead = r->corner[next_in_triangle(corner)].across; /* the edge to the left */
    const uint32_t behind = r->corner[next_in_triangle(other)].across; /* and to the right */
    glue(r, r->corner[corner].across, ahead);
    glue(r, r->corner[last_in_triangle(other)].across, behind);
    r->node[to].corner = next_in_triangle(ahead);
    r->node[left].corner = last_in_triangle(ahead);
    r->node[right].corner = next_in_triangle(behind);
    r->node[point].corner = NONE;
    r->corner[corner / 3 * 3].point = NONE;
    r->corner[other / 3 * 3].point = NONE;
    r->triangles -= 2;
}

static void put_again(struct reduction *r, uint32_t point, uint64_t cost)
{
    settle(r, r->node[point].rank, (struct price){cost, point});
}

/* Update the moves around a point to which another has moved. */
static void find_moves_around(struct reduction *r, uint32_t to)
{
    const uint32_t first = r->node[to].corner;
    uint32_t c = first;
    put_again(r, to, find_move(r, to, false));
    do {
        const uint32_t point = point_at(r, next_in_triangle(c));
        put_again(r, point, find_move(r, point, false));
        c = swing(r, c);
    } while (c != first);
}

static void reduce_triangles(struct reduction *r, size_t most, struct task *task)
{
    while (r->triangles > most && task_advance(task, 16)) {
        const uint32_t point = r->heap[0].point, to = r->node[point].to;
        if (r->heap[0].cost == NEVER)
            return;
        find_neighbours(r, point);
        if (!(stays_manifold(r, corner_towards(r, point, r->node[point].to)))) {
            put_again(r, point, find_move(r, point, true));
            continue;
        }
        move_point(r, point);
        const struct price last = r->heap[--r->in_heap];
        if (last.point != point)
            settle(r, r->node[point].rank, last);
        find_moves_around(r, to);
    }
}

/* ---- the result ---- */

/* Compact the rest of each part; `rank` becomes the new number of points. */
static void gather_parts(struct reduction *r)
{
    struct surface *s = r->surface;
    size_t points = 0, triangles = 0;
    for (unsigned p = 0; p < s->parts; p++) {
        struct surface_part *part = &s->part[p];
        const struct surface_part was = *part;
        part->point = points;
        part->triangle = triangles;
        for (size_t i = was.point; i < was.point + was.points; i++) {
            r->node[i].rank = (uint32_t)points;
            if (r->node[i].corner != NONE)
                s->point[points++] = s->point[i];
        }
        for (size_t i = was.triangle; i < was.triangle + was.triangles; i++) {
            const struct corner *is = r->corner + 3 * i;
            for (int k = 0; is->point != NONE && k < 3; k++)
                s->triangle[triangles].point[k] = r->node[is[k].point].rank;
            triangles += is->point != NONE;
        }
        part->points = points - part->point;
        part->triangles = triangles - part->triangle;
    }
    s->points = points;
    s->triangles = triangles;
}

static enum err reduction_init(struct reduction *r, struct surface *surface, struct fault *fault)
{
    const size_t points = surface->points, corners = 3 * surface->triangles;
    r->surface = surface;
    r->triangles = surface->triangles;
    if (corners >= NONE)
        return fault_set(fault, ERR_LIMIT, "%zu triangles; no more than %u can be reduced",
                         surface->triangles, NONE / 3);
    r->corner = mem_array(corners, sizeof *r->corner);
    r->node = mem_array(points, sizeof *r->node);
    r->heap = mem_array(points, sizeof *r->heap);
    OWNED(mem_release) uint32_t *next = mem_array(corners, sizeof *next);
    const bool fits = r->corner && r->node && r->heap && next;
    for (size_t i = 0; fits && i < points; i++) {
        const uint32_t *at = surface->point[i].at;
        r->node[i] =
            (struct node){.at = {at[0] >> SHIFT, at[1] >> SHIFT, at[2] >> SHIFT}, .corner = NONE};
    }
    if (fits)
        find_across(r, next);
    return fits ? OK : fault_memory(fault, "a surface");
}

enum err surface_reduce(struct surface *surface, size_t most, struct watch *watch,
                        struct fault *fault)
{
    if (surface->triangles <= most)
        return OK;
    OWNED(mem_release) struct reduction *r = mem_new(sizeof *r);
    if (!r)
        return fault_memory(fault, "a surface");
    enum err err = reduction_init(r, surface, fault);
    if (!err) {
        struct task task = task_begin(watch, "fewer triangles",
                                      16 * surface->points + 8 * (surface->triangles - most));
        for (uint32_t i = 0; i < surface->points && task_advance(&task, 16); i++) {
            const struct price price = {find_move(r, i, false), i};
            settle(r, r->in_heap++, price);
        }
        if (!watch_stops(watch))
            reduce_triangles(r, most, &task);
        gather_parts(r);
        err = watch_fault(watch, fault);
    }
    free(r->corner);
    free(r->node);
    free(r->heap);
    return err;
}
