/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "base/least.h"
#include "engine/net_graph.h"

/* Sum over its links of its own value minus theirs. */
static inline net_lanes net_apart(const struct net_graph *g, const net_lanes *x, int32_t v)
{
    const int32_t *link = g->link[v];
    net_lanes apart =
        6 * x[v] - (x[link[0]] + x[link[1]] + x[link[2]]) - (x[link[3]] + x[link[4]] + x[link[5]]);
    for (int32_t k = g->degree[v] > NET_SLOTS ? g->head[v] : -1; k >= 0; k = g->more[k].next)
        apart += x[v] - x[g->more[k].to];
    return apart;
}

/*
 * Position of borders between labels on a surface net (net.h).
 *
 * The position of a border at a vertex is that of the least-squares parabola through the vertex and
 * equally many border vertices before and after it, at their positions before smoothing. It neither
 * moves straight lines nor shrinks round ones, and half of a wave of 12 voxels remains. (Savitzky &
 * Golay, Smoothing and differentiation of data, 1964.) It uses the most vertices, up to eight on
 * either side, between which the border turns by about 60 degrees at most, so that patches of few
 * voxels keep their area; intermediate cases are weighted, to avoid hooks.
 *
 * Root-mean-square distance from the line, in voxels: on a flat surface .08, in any direction .24,
 * at slopes of 1 in 8, 12, 20 .05, .12, .21. Patches of one voxel keep their area, those of radius
 * 2, 3, 5, 8 .99, .97, .98, 1.00 of it, squares of 3 to 21 voxels 1.00 to 1.01. Eight vertices are
 * few for a wave of 20: .8 of it remains.
 */

/* True if a border of two labels passes through a vertex. It is fixed at its ends, and where it
 * meets others. */
static inline bool net_line_is_at(const struct net_graph *graph, int32_t v)
{
    return graph->has_labels && graph->lines[v] == 2;
}

enum {
    FAR = NET_LEVELS - 1, /* vertices on either side */
    TURN_MOST = 4 * 128,  /* squared tangent, 128 for 1 */
};

/* Collect the positions of vertices along the border minus that of v, which is along[0]; return
 * their number on either side. Beyond a fixed end, the border is continued by mirroring it in that
 * place. */
static int follow(const struct net_graph *g, int32_t v, net_lanes *along)
{
    int last[2], far = FAR;
    for (int side = 0; side < 2; side++) {
        int32_t before = v, is = g->line[v][side];
        int k = 1;
        for (; k < FAR && net_line_is_at(g, is); k++) {
            const int32_t next = g->line[is][g->line[is][0] == before];
            along[side ? k : -k] = g->at[is] - g->at[v];
            before = is;
            is = next;
        }
        along[side ? k : -k] = g->at[is] - g->at[v];
        last[side] = k;
    }
    for (int side = 0; side < 2; side++) {
        const int known = 2 * last[side] + last[!side];
        far = known < far ? known : far;
    }
    for (int side = 0; side < 2; side++) {
        const int one = side ? 1 : -1, end = last[side];
        for (int k = end + 1; k <= far; k++)
            along[one * k] = 2 * along[one * end] - along[one * (2 * end - k)];
    }
    return far;
}

/* Weight of the parabola through m vertices on either side, of 256: 0 if it is shorter than .35
 * voxels a vertex; falling from 55 to 63 degrees of turn between its middle and an end. Its slope
 * is 3 slope / (m (m + 1) (2 m + 1)), its bend 15 bend / (m (m + 1) (2 m - 1) (2 m + 1) (2 m +
 * 3)). */
static int32_t trust_of(net_lanes slope, net_lanes bend, int64_t m)
{
    const int64_t least = m * (m + 1) * (2 * m + 1) / 3 * NET_ONE / 64;
    int64_t runs = 0, turns = 0;
    for (int k = 0; k < 3; k++) {
        const int64_t s = slope[k] / 64, b = bend[k] / 64;
        runs += s * s;
        turns += b * b;
    }
    if (8 * runs < least * least)
        return 0;
    const int64_t one = (2 * m - 1) * (2 * m - 1) * (2 * m + 3) * (2 * m + 3) * (runs / 128 + 1);
    const int64_t square = 100 * m * m * turns / one; /* squared tangent; 128 is 1 */
    const int64_t trust = TURN_MOST - square;
    return trust <= 0 ? 0 : trust >= 256 ? 256 : (int32_t)trust;
}

/* Offset of the parabola from the vertex in the middle. */
static net_lanes parabola(const net_lanes *along, int far)
{
    net_lanes sum = {0}, slope = {0}, square = {0}, off = {0};
    for (int m = 1; m <= far; m++) {
        const net_lanes both = along[m] + along[-m];
        sum += both;
        slope += m * (along[m] - along[-m]);
        square += m * m * both;
        const net_lanes bend = 3 * square - m * (m + 1) * sum;
        const int32_t part = (2 * m - 1) * (2 * m + 3), trust = trust_of(slope, bend, m);
        for (int k = 0; k < 3 && trust > 0; k++) {
            const int32_t is = (part * sum[k] - 5 * bend[k]) / (part * (2 * m + 1));
            off[k] += (is - off[k]) * trust / 256;
        }
    }
    return off;
}

/* Compute `border` of the graph, from the initial positions of vertices. False without memory. */
static bool net_line_find(struct net_graph *g)
{
    const int32_t count = g->upto[0];
    g->border = net_store(g->scratch, NET_BORDER, (size_t)count, sizeof *g->border);
    for (int32_t v = 0; v < count && g->border; v++)
        if (net_line_is_at(g, v)) {
            net_lanes along[2 * FAR + 1] = {{0}};
            const int far = follow(g, v, along + FAR);
            g->border[v] = g->at[v] + parabola(along + FAR, far);
        }
    return g->border;
}

enum {
    SLACK = NET_ONE / 4,           /* distance that a vertex may be outside its cube */
    PUSH_MOST = 15 * NET_ONE / 16, /* largest push */
    LINKS = NET_LINKS_MOST + 1,
    AREA_BITS = 10, /* rounding of sums of areas, */
    TERM_BITS = 24, /* and of terms: to 2^-18 voxels */
};

/* ---- rounding ---- */

/* p / 2^bits; halves away from 0, so that mirroring commutes with rounding. */
static inline int64_t rounded(int64_t p, int bits)
{
    return (p + (INT64_C(1) << (bits - 1)) + (p >> 63)) >> bits;
}

typedef uint32_t counts __attribute__((vector_size(16)));

/* x share / 2^bits of each, halves away from 0; share is at most 2^16, and so is 2^bits. Computed
 * in two halves of x, whose products fit 32 bits. */
static inline net_lanes part_of(net_lanes x, int32_t share, int bits)
{
    const counts low = (counts)(x & 0xffff) * (uint32_t)share;
    const int32_t high = share * (1 << (16 - bits));
    return (x >> 16) * high + (net_lanes)((low + (1U << (bits - 1)) + (counts)(x >> 31)) >> bits);
}

/* numerator / denominator, rounded to 2^-bits. */
#define FIXED(numerator, denominator, bits)                                                        \
    ((int32_t)((((int64_t)(numerator) << ((bits) + 1)) / (denominator) + 1) / 2))

enum { WHOLE = 16, TWICE = 15, MANY = 13 }; /* bits of factors up to 1, 2 and 8 */

/* numerator / denominator / links, by links. */
static void shares(int32_t share[LINKS], int32_t numerator, int32_t denominator, int bits)
{
    share[0] = 0;
    for (int n = 1; n < LINKS; n++)
        share[n] = FIXED(numerator, denominator * n, bits);
}

/* 1 / sqrt(x), by Newton's rule: times 2^30 for x in units of 2^-32, from 1/4 up. */
static inline uint64_t root_share(uint64_t x)
{
    uint64_t y = UINT64_C(2244120412) - (x * 5025111 >> 24);
    for (int k = 0; k < 3; k++) {
        const uint64_t off = x * (y * y >> 30) >> 32;
        y = y * ((UINT64_C(3) << 30) - off) >> 31;
    }
    return y;
}

static inline uint64_t square_of(net_lanes n)
{
    uint64_t square = 0;
    for (int k = 0; k < 3; k++)
        square += (uint64_t)((int64_t)n[k] * n[k]);
    return square;
}

/* Scale a positive square by 4^half to units of 2^-32, from 1/4 up. */
static inline uint64_t as_part(uint64_t square, int *half)
{
    *half = (__builtin_clzll(square) >> 1) - 16;
    return *half < 0 ? square >> -2 * *half : square << 2 * *half;
}

static inline int32_t length_of(net_lanes n)
{
    const uint64_t square = square_of(n);
    int half;
    if (square == 0)
        return 0;
    const uint64_t part = as_part(square, &half);
    return (int32_t)(part * root_share(part) >> (46 + half));
}

/* Normalise to length 2^NET_NORMAL_BITS. */
static inline net_lanes long_as_one(net_lanes n)
{
    const uint64_t square = square_of(n);
    int half;
    if (square == 0)
        return (net_lanes){0};
    const int64_t share = (int64_t)root_share(as_part(square, &half));
    for (int k = 0; k < 3; k++)
        n[k] = (int32_t)rounded(n[k] * share, 46 - NET_NORMAL_BITS - half);
    n[3] = 0;
    return n;
}

/* ---- positions ---- */

/* Masks of the axes that are not locked. */
static const net_lanes free_of[8] = {
    {-1, -1, -1, -1}, {0, -1, -1, -1}, {-1, 0, -1, -1}, {0, 0, -1, -1},
    {-1, -1, 0, -1},  {0, -1, 0, -1},  {-1, 0, 0, -1},  {0, 0, 0, -1},
};

static inline net_lanes unlocked(const struct net_graph *g, int32_t v, net_lanes x)
{
    return x & free_of[g->place[v].lock & 7];
}

static inline net_lanes middle_of(const struct net_graph *g, int32_t v)
{
    const struct net_place *p = &g->place[v];
    return (net_lanes){p->x, p->y, p->z, 0} * NET_ONE + (net_lanes){1, 1, 1, 0} * (NET_ONE / 2);
}

static inline net_lanes clamped(const struct net_graph *g, int32_t v, net_lanes at)
{
    const net_lanes middle = middle_of(g, v);
    net_lanes off = at - middle;
    for (int k = 0; k < 3; k++) {
        const int32_t most = NET_ONE / 2 + SLACK;
        off[k] = off[k] < -most ? -most : off[k] > most ? most : off[k];
    }
    return middle + off;
}

/* Chebyshev's polynomial of three passes, least from 1/2 to 2: 1 - u (1092 - 960 u + 256 u^2) / 365
 * of the umbrella operator u. */
WIDE static void smooth(struct net_graph *g, net_lanes *off, net_lanes *next)
{
    int32_t share[LINKS], last[LINKS];
    shares(share, 1, 1, WHOLE);
    shares(last, 256, 365, WHOLE);
    for (int32_t v = 0; v < g->upto[7]; v++)
        off[v] = unlocked(g, v, part_of(net_apart(g, g->at, v), share[g->degree[v]], WHOLE));
    for (int32_t v = 0; v < g->upto[6]; v++)
        next[v] = unlocked(g, v,
                           part_of(net_apart(g, off, v), last[g->degree[v]], WHOLE) -
                               part_of(off[v], FIXED(960, 365, MANY), MANY));
    for (int32_t v = 0; v < g->upto[5]; v++)
        g->at[v] =
            clamped(g, v,
                    g->at[v] - unlocked(g, v,
                                        part_of(net_apart(g, next, v), share[g->degree[v]], WHOLE) +
                                            part_of(off[v], FIXED(1092, 365, MANY), MANY)));
}

/* Direction of faces of voxels around each vertex, smoothed twice; links weigh 1, the vertex itself
 * the rest of six. */
WIDE static void find_push(struct net_graph *g, net_lanes *next)
{
    for (int32_t v = 0; v < g->upto[6]; v++)
        next[v] = 6 * g->push[v] - net_apart(g, g->push, v);
    for (int32_t v = 0; v < g->upto[5]; v++)
        g->push[v] = long_as_one(unlocked(g, v, 6 * next[v] - net_apart(g, next, v)));
}

bool net_smooth(struct net_graph *g, struct net_sum **sum)
{
    const size_t all = (size_t)g->upto[NET_LEVELS - 1];
    net_lanes *off = net_store(g->scratch, NET_LANES_0, all, sizeof *off);
    net_lanes *next = net_store(g->scratch, NET_LANES_1, all, sizeof *next);
    *sum = net_store(g->scratch, NET_SUM, (size_t)g->upto[5], sizeof **sum);
    if (!off || !next || !*sum || (g->has_labels && !net_line_find(g)))
        return false;
    smooth(g, off, next);
    find_push(g, next);
    memset(*sum, 0, (size_t)g->upto[5] * sizeof **sum);
    return true;
}

/* ---- volume ---- */

static inline void cross(const int64_t a[3], const int64_t b[3], int64_t out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

void net_add_quad(const struct net_graph *g, struct net_sum *sum, const int32_t corner[4], int face)
{
    const net_lanes *at = g->at, *push = g->push;
    const int32_t a = corner[0], b = corner[1], c = corner[2], d = corner[3];
    const net_lanes e4 = at[c] - at[a], g4 = at[d] - at[b], en4 = push[c] - push[a],
                    gn4 = push[d] - push[b];
    const net_lanes ec4 = e4 + middle_of(g, c) - middle_of(g, a),
                    gc4 = g4 + middle_of(g, d) - middle_of(g, b);
    const int64_t e[3] = {e4[0], e4[1], e4[2]}, f[3] = {g4[0], g4[1], g4[2]},
                  en[3] = {en4[0], en4[1], en4[2]}, fn[3] = {gn4[0], gn4[1], gn4[2]},
                  ec[3] = {ec4[0], ec4[1], ec4[2]}, fc[3] = {gc4[0], gc4[1], gc4[2]};
    int64_t is[3], was[3], once[3], other[3], twice[3];
    cross(e, f, is);
    cross(ec, fc, was);
    cross(e, fn, once);
    cross(en, f, other);
    cross(en, fn, twice);
    for (int k = 0; k < 3; k++) {
        once[k] += other[k];
        was[k] += is[k];
    }
    was[face >> 1] += (face & 1 ? 2 : -2) * (int64_t)NET_ONE * NET_ONE;
    for (int i = 0; i < 4; i++) {
        const int32_t v = corner[i];
        const net_lanes lost = middle_of(g, v) - at[v], n = push[v];
        struct net_sum *s = &sum[v];
        for (int k = 0; k < 3; k++) {
            s->area[k] += is[k];
            s->term[NET_LOST] += was[k] * lost[k];
            s->term[NET_BY_PUSH] += is[k] * n[k];
            s->term[NET_BY_SQUARE] += once[k] * n[k];
            s->term[NET_BY_CUBE] += twice[k] * n[k];
        }
    }
}

/* The push h with BY_PUSH h + BY_SQUARE h^2 + BY_CUBE h^3 = LOST: Newton's rule between bounds,
 * which are halved if it leaves them. A collapsed vertex has no BY_PUSH. */
static int32_t push_of(net_lanes m)
{
    int64_t low = -PUSH_MOST, high = PUSH_MOST, h = 0;
    while (high - low > 1) {
        const int64_t cube = m[NET_BY_CUBE] * h / NET_ONE, square = m[NET_BY_SQUARE];
        const int64_t off =
            (int64_t)m[NET_LOST] * NET_ONE - (m[NET_BY_PUSH] + (square + cube) * h / NET_ONE) * h;
        const int64_t slope = m[NET_BY_PUSH] + (2 * square + 3 * cube) * h / NET_ONE;
        if (off > 0)
            low = h;
        else
            high = h;
        const int64_t step = slope > 0 ? off / slope : 0;
        if (slope > 0 && step >= -1 && step <= 1)
            break;
        h += step;
        if (slope <= 0 || h <= low || h >= high)
            h = (low + high) / 2;
    }
    return (int32_t)h;
}

/* ---- borders between labels ---- */

/* Offset of a vertex from its border, along the surface. The normal part is left to the volume. */
static inline net_lanes off_border(const struct net_graph *g, net_lanes at, int32_t v)
{
    net_lanes off = unlocked(g, v, at - g->border[v]);
    const net_lanes n = g->push[v];
    const int64_t along =
        rounded((int64_t)off[0] * n[0] + (int64_t)off[1] * n[1] + (int64_t)off[2] * n[2], NET_BITS);
    for (int k = 0; k < 3; k++)
        off[k] -= (int32_t)rounded(along * n[k], NET_BITS);
    return off;
}

/* ---- volume and normals ---- */

/* The quantities that the passes filter: terms, and normals. */
struct both {
    net_lanes term, normal;
};

static inline struct both apart_of(const struct net_graph *g, const struct both *x, int32_t v)
{
    const int32_t *link = g->link[v];
    struct both apart = {6 * x[v].term, 6 * x[v].normal};
    for (int k = 0; k < NET_SLOTS; k++) {
        apart.term -= x[link[k]].term;
        apart.normal -= x[link[k]].normal;
    }
    for (int32_t k = g->degree[v] > NET_SLOTS ? g->head[v] : -1; k >= 0; k = g->more[k].next) {
        apart.term += x[v].term - x[g->more[k].to].term;
        apart.normal += x[v].normal - x[g->more[k].to].normal;
    }
    return apart;
}

/* Convert a normal from voxels to the world, and normalise it. */
static net_lanes in_world(net_lanes normal, const uint32_t scale[3])
{
    const uint32_t one = 1 << 12;
    for (int k = 0; k < 3 && (scale[0] != one || scale[1] != one || scale[2] != one); k++)
        normal[k] = (int32_t)rounded(normal[k] * (int64_t)scale[k], 12);
    return long_as_one(normal);
}

/* 1 / the roots of Chebyshev's polynomial of normals, of four passes, least from 3/4 to 2. */
static const int32_t normal_step[4] = {512184, 619511, 880419, 1253800}; /* 10^-6 */

/* Increase of the last step where the surface is nearly flat, by links, 2^-MANY: 0 to 2.946. There
 * the sum of the normals around is nearly as long as the sum of their lengths; its square is more
 * than .95: .97 on a ball of 10, .94 at the second vertex from the edge of a box. */
static inline int32_t longer_step(net_lanes normal, int links)
{
    const uint64_t square = square_of(normal);
    const uint64_t whole = (uint64_t)((int64_t)normal[3] * normal[3]);
    if (normal[3] < 64 || links == 0 || 20 * square <= 19 * whole)
        return 0;
    const uint64_t least = (square - whole / 20 * 19) * 20 / (whole >> 12);
    return (int32_t)((least < 4096 ? least : 4096) * FIXED(2946, 1000, MANY) >> 12) / links;
}

/* Chebyshev's polynomial of terms, of four passes, least from 1/5 to 2: 1 - u (283360 - 516000 u +
 * 352000 u^2 - 80000 u^3) / 45281. */
WIDE static void restore(struct net_graph *g, struct both *x, struct both *off, struct both *y,
                         struct both *t, const uint32_t scale[3], net_lanes *normal)
{
    int32_t share[LINKS], last[LINKS], step[4][LINKS];
    shares(share, 1, 1, WHOLE);
    shares(last, 80000, 45281, TWICE);
    for (int k = 0; k < 4; k++)
        shares(step[k], normal_step[k], 1000000, TWICE);
    for (int32_t v = 0; v < g->upto[3]; v++) {
        const struct both a = apart_of(g, x, v);
        const int n = g->degree[v];
        off[v].term = part_of(a.term, share[n], WHOLE);
        off[v].normal = x[v].normal - part_of(a.normal, step[0][n], TWICE);
    }
    for (int32_t v = 0; v < g->upto[2]; v++) {
        const struct both a = apart_of(g, off, v);
        const int n = g->degree[v];
        y[v].term = part_of(off[v].term, FIXED(352000, 45281, MANY), MANY) -
                    part_of(a.term, last[n], TWICE);
        y[v].normal = off[v].normal - part_of(a.normal, step[1][n], TWICE);
    }
    for (int32_t v = 0; v < g->upto[1]; v++) {
        const struct both a = apart_of(g, y, v);
        const int n = g->degree[v];
        t[v].term = part_of(a.term, share[n], WHOLE) -
                    part_of(off[v].term, FIXED(516000, 45281, MANY - 1), MANY - 1);
        t[v].normal = y[v].normal - part_of(a.normal, step[2][n], TWICE);
    }
    for (int32_t v = 0; v < g->upto[0]; v++) {
        const struct both a = apart_of(g, t, v);
        const int n = g->degree[v];
        const net_lanes term = x[v].term - part_of(a.term, share[n], WHOLE) -
                               part_of(off[v].term, FIXED(283360, 45281, MANY), MANY);
        const int32_t push = push_of(term);
        const net_lanes toward = push < 0 ? -g->push[v] : g->push[v];
        const net_lanes at = g->at[v] + part_of(toward, push < 0 ? -push : push, NET_BITS);
        g->at[v] = clamped(g, v, net_line_is_at(g, v) ? at - off_border(g, at, v) : at);
        const net_lanes mild = t[v].normal - part_of(a.normal, step[3][n], TWICE);
        const int32_t longer = longer_step(mild, n);
        normal[v] = in_world(longer ? mild - part_of(a.normal, longer, MANY) : mild, scale);
    }
}

bool net_restore(struct net_graph *g, const struct net_sum *sum, const uint32_t scale[3],
                 net_lanes **normal)
{
    struct both *x = net_store(g->scratch, NET_BOTH_0, (size_t)g->upto[4], sizeof *x);
    struct both *off = net_store(g->scratch, NET_BOTH_1, (size_t)g->upto[3], sizeof *off);
    struct both *y = net_store(g->scratch, NET_BOTH_2, (size_t)g->upto[2], sizeof *y);
    struct both *t = net_store(g->scratch, NET_BOTH_3, (size_t)g->upto[1], sizeof *t);
    *normal = net_store(g->scratch, NET_LANES_0, (size_t)g->upto[0], sizeof **normal);
    if (!x || !off || !y || !t || !*normal)
        return false;
    /* Divide terms by the number of links, so that their sum stays the same: a vertex with more
     * links has a larger part of the surface, and more neighbours read it. */
    static const int64_t times[NET_KINDS] = {48, 8, 16, 24};
    int64_t share[NET_KINDS][LINKS] = {{0}};
    for (int i = 0; i < NET_KINDS; i++)
        for (int n = 1; n < LINKS; n++)
            share[i][n] = (INT64_C(1) << 26) / (times[i] * n);
    for (int32_t v = 0; v < g->upto[4]; v++) {
        const struct net_sum *s = &sum[v];
        for (int i = 0; i < NET_KINDS; i++)
            x[v].term[i] = (int32_t)rounded(rounded(s->term[i], 16) * share[i][g->degree[v]],
                                            26 + TERM_BITS - 16);
        for (int k = 0; k < 3; k++)
            x[v].normal[k] = (int32_t)rounded(s->area[k], AREA_BITS);
        x[v].normal[3] = length_of(x[v].normal);
    }
    restore(g, x, off, y, t, scale, *normal);
    return true;
}

/* ---- cubes ---- */

bool net_centre(struct net_graph *g, const uint32_t scale[3], net_lanes **normal)
{
    net_lanes *next = net_store(g->scratch, NET_LANES_1, (size_t)g->upto[3], sizeof *next);
    net_lanes *is = g->push;
    if (!next)
        return false;
    for (int32_t v = 0; v < g->upto[4]; v++)
        is[v] = is[v] * (1 << 18);
    for (int k = 0; k < 4; k++) {
        int32_t step[LINKS];
        shares(step, normal_step[k], 1000000, TWICE);
        for (int32_t v = 0; v < g->upto[3 - k]; v++)
            next[v] = is[v] - part_of(net_apart(g, is, v), step[g->degree[v]], TWICE);
        net_lanes *former = is;
        is = next;
        next = former;
    }
    for (int32_t v = 0; v < g->upto[0]; v++) {
        g->at[v] = middle_of(g, v);
        is[v] = in_world(is[v], scale);
    }
    *normal = is;
    return true;
}
