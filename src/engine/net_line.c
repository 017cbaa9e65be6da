/* SPDX-License-Identifier: MIT */
#include "engine/net_line.h"

enum {
    FAR = NET_LEVELS - 1, /* vertices on either side */
    TURN_MOST = 4 * 128,  /* the square of a tangent, 128 for 1 */
};

/* The places of vertices along the border less that of v, which is along[0]; how many on either
 * side. Beyond where it is held, it goes on as what it is, mirrored in that place. */
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

/* How far the parabola through m vertices on either side is trusted, of 256: not where it runs on
 * by less than .35 voxels each, less and less where it turns by 55 to 63 degrees from its middle to
 * an end. Its slope is 3 slope / (m (m + 1) (2 m + 1)), and it bends by
 * 15 bend / (m (m + 1) (2 m - 1) (2 m + 1) (2 m + 3)). */
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
    const int64_t square = 100 * m * m * turns / one; /* of the tangent; 128 is 1 */
    const int64_t trust = TURN_MOST - square;
    return trust <= 0 ? 0 : trust >= 256 ? 256 : (int32_t)trust;
}

/* How far the parabola is from the vertex in the middle. */
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

bool net_line_find(struct net_graph *g)
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
