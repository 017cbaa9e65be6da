/*
 * Fewer triangles: one point after another moves to a neighbour, and the two triangles between them
 * vanish.
 *
 * Corner 3 t + k is that of triangle t at its point k. across[c] is the corner beyond the edge that
 * faces c: the whole of how triangles hang together. Points keep their places, so no two of them
 * ever share one.
 *
 * The next move is the one of the least cost: the volume that it sweeps, which does not depend on
 * spacing, and something for its length, so that flat parts get even triangles. After Lindstrom and
 * Turk, "Fast and memory efficient polygonal simplification" (1998), who judge by volumes between
 * the surface at hand and the next, and not by what it once was.
 */
#include "engine/surface.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

enum {
    SHIFT = 8,             /* places count 1/256 voxel here: */
    LENGTH_MOST = 64 << 8, /* no edge becomes longer along an axis, so that products fit */
    LENGTH_PRICE = 16,     /* as much as one triangle that goes 1/16 voxel off */
};

static const uint32_t NONE = UINT32_MAX;
static const uint64_t NEVER = UINT64_MAX;

struct reduction {
    struct surface *surface;
    uint32_t *across;    /* by corner */
    uint32_t *corner_of; /* by point: one of its corners; NONE where it has gone */
    uint32_t *mark;      /* by point: the last question that it was marked for */
    uint32_t marks;
    uint32_t *to;   /* by point: where it moves at the least cost */
    uint64_t *cost; /* by point: that cost; NEVER where it cannot move */
    uint32_t *heap; /* points, the one of the least cost first */
    uint32_t *rank; /* by point: where it is in the heap */
    uint32_t in_heap;
    size_t triangles; /* that are left */
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
    return r->surface->triangle[corner / 3].point[corner % 3];
}

/* The next corner around the same point: its triangle has the edge that leads from the point to
 * the last point of this one. */
static uint32_t swing(const struct reduction *r, uint32_t corner)
{
    return next_in_triangle(r->across[next_in_triangle(corner)]);
}

static void glue(struct reduction *r, uint32_t corner, uint32_t other)
{
    r->across[corner] = other;
    r->across[other] = corner;
}

/* Finds what is across each edge: corners in a list for each point, by `next`. */
static void find_across(struct reduction *r, uint32_t *next)
{
    const uint32_t corners = (uint32_t)(3 * r->surface->triangles);
    for (uint32_t c = 0; c < corners; c++) {
        const uint32_t point = point_at(r, c);
        next[c] = r->corner_of[point];
        r->corner_of[point] = c;
    }
    for (uint32_t c = 0; c < corners; c++) {
        const uint32_t from = point_at(r, next_in_triangle(c)),
                       to = point_at(r, last_in_triangle(c));
        uint32_t k = r->corner_of[to];
        while (point_at(r, next_in_triangle(k)) != from)
            k = next[k];
        r->across[c] = last_in_triangle(k);
    }
}

/* ---- may it move, and at what cost ---- */

static bool has_four_neighbours(const struct reduction *r, uint32_t point)
{
    const uint32_t first = r->corner_of[point];
    return swing(r, swing(r, swing(r, first))) != first;
}

/* Whether the surface stays a manifold: the two points have no neighbours in common but those of
 * the triangles between them, and these have four or more. `corner` is the point's, with the edge
 * to the other one after it; the point's neighbours are marked. */
static bool stays_manifold(const struct reduction *r, uint32_t corner)
{
    const uint32_t to = point_at(r, next_in_triangle(corner));
    const uint32_t first = r->corner_of[to];
    const uint32_t left = point_at(r, last_in_triangle(corner));
    const uint32_t right = point_at(r, r->across[last_in_triangle(corner)]);
    unsigned common = 0;
    uint32_t c = first;
    if (!has_four_neighbours(r, left) || !has_four_neighbours(r, right))
        return false;
    do {
        common += r->mark[point_at(r, next_in_triangle(c))] == r->marks;
        c = swing(r, c);
    } while (c != first);
    return common == 2;
}

/* False where that is too long. */
static bool way(int64_t out[3], const struct reduction *r, uint32_t from, uint32_t to)
{
    bool fits = true;
    for (int a = 0; a < 3; a++) {
        const struct surface_point *point = r->surface->point;
        out[a] = (int64_t)(point[to].at[a] >> SHIFT) - (int64_t)(point[from].at[a] >> SHIFT);
        fits &= out[a] < LENGTH_MOST && out[a] > -LENGTH_MOST;
    }
    return fits;
}

static void cross_product(int64_t out[3], const int64_t u[3], const int64_t v[3])
{
    for (int a = 0; a < 3; a++) {
        const int i = (a + 1) % 3, k = (a + 2) % 3;
        out[a] = u[i] * v[k] - u[k] * v[i];
    }
}

static int64_t product(const int64_t u[3], const int64_t v[3])
{
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
}

/* What the triangle of a corner costs when the point of the corner moves by `step`; NEVER where it
 * would turn over, or be too large. */
static uint64_t cost_of_triangle(const struct reduction *r, uint32_t corner, const int64_t step[3])
{
    int64_t left[3], right[3], normal[3], after[3];
    const uint32_t point = point_at(r, corner);
    if (!way(left, r, point, point_at(r, next_in_triangle(corner))) ||
        !way(right, r, point, point_at(r, last_in_triangle(corner))))
        return NEVER;
    cross_product(normal, left, right);
    const int64_t volume = product(normal, step);
    for (int a = 0; a < 3; a++) {
        left[a] -= step[a];
        right[a] -= step[a];
        if (llabs(left[a]) >= LENGTH_MOST || llabs(right[a]) >= LENGTH_MOST)
            return NEVER;
    }
    cross_product(after, left, right);
    return product(normal, after) > 0 ? (uint64_t)llabs(volume) : NEVER;
}

/* Of moving a point along the edge after its corner; NEVER where that is no less than `most`. */
static uint64_t cost_of_move(const struct reduction *r, uint32_t corner, uint64_t most)
{
    int64_t step[3];
    const uint32_t point = point_at(r, corner), to = point_at(r, next_in_triangle(corner));
    if (!way(step, r, point, to))
        return NEVER;
    uint64_t cost = (uint64_t)product(step, step) * LENGTH_PRICE;
    uint32_t c = swing(r, corner);
    for (; cost < most && point_at(r, last_in_triangle(c)) != to; c = swing(r, c)) {
        const uint64_t more = cost_of_triangle(r, c, step);
        cost = more == NEVER ? NEVER : cost + more;
    }
    return cost < most && stays_manifold(r, corner) ? cost : NEVER;
}

static void mark_neighbours(struct reduction *r, uint32_t point)
{
    const uint32_t first = r->corner_of[point];
    uint32_t c = first;
    r->marks++;
    do {
        r->mark[point_at(r, next_in_triangle(c))] = r->marks;
        c = swing(r, c);
    } while (c != first);
}

/* The move of the least cost, of those the first one around the point. */
static void find_move(struct reduction *r, uint32_t point)
{
    const uint32_t first = r->corner_of[point];
    uint32_t c = first;
    r->cost[point] = NEVER;
    mark_neighbours(r, point);
    do {
        const uint64_t cost = cost_of_move(r, c, r->cost[point]);
        if (cost < r->cost[point]) {
            r->cost[point] = cost;
            r->to[point] = point_at(r, next_in_triangle(c));
        }
        c = swing(r, c);
    } while (c != first);
}

/* ---- the heap ---- */

static bool comes_before(const struct reduction *r, uint32_t point, uint32_t other)
{
    return r->cost[point] < r->cost[other] || (r->cost[point] == r->cost[other] && point < other);
}

static void put_at(struct reduction *r, uint32_t rank, uint32_t point)
{
    r->heap[rank] = point;
    r->rank[point] = rank;
}

/* Puts a point where its cost belongs, from the rank on where it is. */
static void settle(struct reduction *r, uint32_t point)
{
    uint32_t rank = r->rank[point];
    for (; rank && comes_before(r, point, r->heap[(rank - 1) / 2]); rank = (rank - 1) / 2)
        put_at(r, rank, r->heap[(rank - 1) / 2]);
    for (;;) {
        uint32_t below = 2 * rank + 1;
        if (below >= r->in_heap)
            break;
        if (below + 1 < r->in_heap && comes_before(r, r->heap[below + 1], r->heap[below]))
            below++;
        if (!comes_before(r, r->heap[below], point))
            break;
        put_at(r, rank, r->heap[below]);
        rank = below;
    }
    put_at(r, rank, point);
}

static void take_out(struct reduction *r, uint32_t point)
{
    const uint32_t rank = r->rank[point], last = r->heap[--r->in_heap];
    if (last == point)
        return;
    put_at(r, rank, last);
    settle(r, last);
}

/* ---- moving ---- */

static uint32_t corner_towards(const struct reduction *r, uint32_t point, uint32_t to)
{
    uint32_t c = r->corner_of[point];
    while (point_at(r, next_in_triangle(c)) != to)
        c = swing(r, c);
    return c;
}

static void move_point(struct reduction *r, uint32_t point)
{
    const uint32_t to = r->to[point], corner = corner_towards(r, point, to);
    const uint32_t other = r->across[last_in_triangle(corner)]; /* in the triangle beside it */
    const uint32_t left = point_at(r, last_in_triangle(corner)), right = point_at(r, other);
    uint32_t c = corner;
    do {
        r->surface->triangle[c / 3].point[c % 3] = to;
        c = swing(r, c);
    } while (c != corner);
    const uint32_t ahead = r->across[next_in_triangle(corner)]; /* beyond the edge to the left */
    const uint32_t behind = r->across[next_in_triangle(other)]; /* and to the right */
    glue(r, r->across[corner], ahead);
    glue(r, r->across[last_in_triangle(other)], behind);
    r->corner_of[to] = next_in_triangle(ahead);
    r->corner_of[left] = last_in_triangle(ahead);
    r->corner_of[right] = next_in_triangle(behind);
    r->corner_of[point] = NONE;
    r->surface->triangle[corner / 3].point[0] = NONE;
    r->surface->triangle[other / 3].point[0] = NONE;
    r->triangles -= 2;
}

static void find_move_again(struct reduction *r, uint32_t point)
{
    find_move(r, point);
    settle(r, point);
}

/* Whether a point may still move where it was to: its own triangles are as they were, or that would
 * have been found again, but not those further off. */
static bool still_moves(struct reduction *r, uint32_t point)
{
    mark_neighbours(r, point);
    return stays_manifold(r, corner_towards(r, point, r->to[point]));
}

static void reduce(struct reduction *r, size_t most, struct task *task)
{
    while (r->triangles > most && task_advance(task, 16)) {
        const uint32_t point = r->heap[0], to = r->to[point];
        if (r->cost[point] == NEVER)
            return;
        if (!still_moves(r, point)) {
            find_move_again(r, point);
            continue;
        }
        move_point(r, point);
        take_out(r, point);
        const uint32_t first = r->corner_of[to];
        find_move_again(r, to);
        uint32_t c = first;
        do {
            find_move_again(r, point_at(r, next_in_triangle(c)));
            c = swing(r, c);
        } while (c != first);
    }
}

/* ---- what is left ---- */

/* Puts what is left of each part together; `number` becomes the new numbers of points. */
static void gather(struct reduction *r, uint32_t *number)
{
    struct surface *s = r->surface;
    size_t points = 0, triangles = 0;
    for (unsigned p = 0; p < s->parts; p++) {
        struct surface_part *part = &s->part[p];
        const struct surface_part was = *part;
        part->point = points;
        part->triangle = triangles;
        for (size_t i = was.point; i < was.point + was.points; i++) {
            number[i] = (uint32_t)points;
            if (r->corner_of[i] != NONE)
                s->point[points++] = s->point[i];
        }
        for (size_t i = was.triangle; i < was.triangle + was.triangles; i++) {
            const struct surface_triangle is = s->triangle[i];
            for (int k = 0; is.point[0] != NONE && k < 3; k++)
                s->triangle[triangles].point[k] = number[is.point[k]];
            triangles += is.point[0] != NONE;
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
    *r = (struct reduction){.surface = surface, .triangles = surface->triangles};
    if (corners >= NONE)
        return fault_set(fault, ERR_LIMIT, "%zu triangles; no more than %u can be reduced",
                         surface->triangles, NONE / 3);
    r->across = mem_array(corners, sizeof *r->across);
    r->corner_of = mem_array(points, sizeof *r->corner_of);
    r->mark = mem_array(points, sizeof *r->mark);
    r->to = mem_array(points, sizeof *r->to);
    r->cost = mem_array(points, sizeof *r->cost);
    r->heap = mem_array(points, sizeof *r->heap);
    r->rank = mem_array(points, sizeof *r->rank);
    uint32_t *next = mem_array(corners, sizeof *next);
    const bool fits =
        r->across && r->corner_of && r->mark && r->to && r->cost && r->heap && r->rank && next;
    if (fits) {
        memset(r->corner_of, 0xff, points * sizeof *r->corner_of); /* NONE */
        memset(r->mark, 0, points * sizeof *r->mark);
        find_across(r, next);
    }
    free(next);
    return fits ? OK : fault_memory(fault, "a surface");
}

static void reduction_release(struct reduction *r)
{
    free(r->across);
    free(r->corner_of);
    free(r->mark);
    free(r->to);
    free(r->cost);
    free(r->heap);
    free(r->rank);
}

enum err surface_reduce(struct surface *surface, size_t most, struct watch *watch,
                        struct fault *fault)
{
    struct reduction r;
    if (surface->triangles <= most)
        return OK;
    enum err err = reduction_init(&r, surface, fault);
    if (!err) {
        struct task task = task_begin(watch, "fewer triangles",
                                      16 * surface->points + 8 * (surface->triangles - most));
        for (uint32_t i = 0; i < surface->points && task_advance(&task, 16); i++) {
            find_move(&r, i);
            put_at(&r, r.in_heap++, i);
            settle(&r, i);
        }
        if (!watch_stops(watch))
            reduce(&r, most, &task);
        gather(&r, r.rank);
        err = watch_fault(watch, fault);
    }
    reduction_release(&r);
    return err;
}
