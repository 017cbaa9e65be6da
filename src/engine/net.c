/* SPDX-License-Identifier: MIT */
#include "engine/net.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "engine/net_graph.h"

/* Four corners of each face, counter-clockwise seen from outside: cubes next to a voxel, and the
 * corner of the cube that is the air there. */
struct corners {
    ptrdiff_t cube[6][4];
    int corner[6][4];
};

/* Bits of voxels whose neighbour through each face is not in the object. */
static void faces_of(const struct net_graph *g, int32_t word, int32_t y, int32_t z,
                     uint64_t face[6])
{
    const size_t up = (size_t)g->words, on = up * (size_t)g->size[1];
    const uint64_t *at = g->in + (size_t)z * on + (size_t)y * up + (size_t)word;
    const uint64_t own = at[0] & (UINT64_MAX >> (64 - NET_STEP));
    const uint64_t before = word > 0 ? at[-1] >> (NET_STEP - 1) & 1 : 0;
    const uint64_t beside[6] = {at[0] << 1 | before, at[0] >> 1, *(at - up), at[up],
                                *(at - on),          at[on]};
    for (int k = 0; k < 6; k++)
        face[k] = own & ~beside[k];
}

struct quads {
    struct net_sum *sum; /* [cubes], or NULL */
    struct net_quad *quad;
    uint8_t *is_used;
    const int32_t *origin; /* first voxel of the box */
    size_t count;
};

static void add_quad(const struct net_graph *g, struct quads *q, const struct corners *corners,
                     const int32_t at[3], int face, bool is_inside)
{
    const size_t voxel = net_index(g, at[0], at[1], at[2]);
    const ptrdiff_t step[3] = {1, g->stride, (ptrdiff_t)g->stride * g->size[1]};
    const ptrdiff_t beside = face & 1 ? step[face / 2] : -step[face / 2];
    const bool is_closed = g->voxel[voxel + (size_t)beside] == NET_CLOSED;
    int32_t corner[4];
    for (int k = 0; k < 4; k++)
        corner[k] =
            net_vertex_at(g, voxel + (size_t)corners->cube[face][k], corners->corner[face][k]);
    if (q->sum && !is_closed)
        net_add_quad(g, q->sum, corner, face);
    if (!is_inside)
        return;
    struct net_quad *quad = &q->quad[q->count++];
    for (int k = 0; k < 4; k++) {
        quad->corner[k] = (uint32_t)corner[k];
        q->is_used[corner[k]] = 1;
    }
    for (int a = 0; a < 3; a++)
        quad->voxel[a] = at[a] - NET_MARGIN + q->origin[a];
    quad->face = (uint8_t)face;
    quad->label = (uint8_t)g->voxel[voxel];
    quad->is_closed = is_closed;
}

/* Visit the quads of voxels within `reach` steps of the box; a voxel facing inward is one step
 * nearer along that axis. Quads of the box itself are stored. Without memory for them, count
 * them. */
static void walk_faces(const struct net_graph *g, struct quads *q, int32_t reach)
{
    struct corners corners;
    const ptrdiff_t step[3] = {1, g->stride, (ptrdiff_t)g->stride * g->size[1]};
    for (int face = 0; face < 6; face++) {
        const int a = face / 2, side = face & 1, u = (a + 1) % 3, v = (a + 2) % 3;
        for (int k = 0; k < 4; k++) {
            const int turn = side ? k : 3 - k, cu = turn == 0 || turn == 3, cv = turn < 2;
            corners.cube[face][k] = (side ? 0 : -step[a]) - cu * step[u] - cv * step[v];
            corners.corner[face][k] = side << a | cu << u | cv << v;
        }
    }
    for (int32_t z = 1; z + 1 < g->size[2]; z++)
        for (int32_t y = 1; y + 1 < g->size[1]; y++) {
            const int32_t dy = net_outside(g, 1, y, 0), dz = net_outside(g, 2, z, 0);
            const int32_t left = reach - (dy > 0 ? dy - 1 : 0) - (dz > 0 ? dz - 1 : 0);
            const bool is_row = dy == 0 && dz == 0;
            if (left < 0 || (reach == 0 && !is_row))
                continue;
            const int32_t low = NET_MARGIN - (reach ? left + 1 : 0);
            const int32_t high = g->size[0] - 1 - NET_MARGIN + (reach ? left + 1 : 0);
            for (int32_t k = 0; k < g->words; k++) {
                const uint64_t wanted = net_bits(k, low, high);
                uint64_t face[6], some = 0;
                faces_of(g, k, y, z, face);
                for (int f = 0; f < 6; f++) {
                    some |= face[f] & wanted;
                    q->count += q->quad ? 0 : (size_t)__builtin_popcountll(face[f] & wanted);
                }
                for (; some && q->quad; some &= some - 1) {
                    const int bit = __builtin_ctzll(some);
                    const int32_t at[3] = {k * NET_STEP + bit, y, z};
                    const bool is_inside = is_row && net_outside(g, 0, at[0], 0) == 0;
                    for (int f = 0; f < 6; f++)
                        if (face[f] >> bit & 1)
                            add_quad(g, q, &corners, at, f, is_inside);
                }
            }
        }
}

static bool make_net(struct net *out, const struct net_source *source, const int32_t first[3],
                     const uint32_t size[3], struct net_scratch *scratch)
{
    struct net net = {.vertices = 0};
    struct net_graph g;
    struct quads q = {.origin = first};
    net_lanes *normal;
    if (!net_graph_make(&g, source, first, size, scratch))
        return false;
    if (!source->is_cubes && !net_smooth(&g, &q.sum))
        return false;
    walk_faces(&g, &q, 0);
    net.quads = (uint32_t)q.count;
    net.quad = mem_array(q.count, sizeof *net.quad);
    q = (struct quads){q.sum, net.quad, net_store(scratch, NET_USED, (size_t)g.upto[0], 1), first,
                       0};
    bool made = net.quad && q.is_used;
    if (made) {
        memset(q.is_used, 0, (size_t)g.upto[0]);
        walk_faces(&g, &q, source->is_cubes ? 0 : NET_TERMS - 1);
        made = source->is_cubes ? net_centre(&g, source->scale, &normal)
                                : net_restore(&g, q.sum, source->scale, &normal);
    }
    size_t vertices = 0;
    for (int32_t v = 0; v < g.upto[0] && made; v++)
        vertices += q.is_used[v];
    net.vertex = made ? mem_array(vertices, sizeof *net.vertex) : NULL;
    if (!net.vertex) {
        net_release(&net);
        return false;
    }
    /* Number the vertices that quads use, and write them. */
    int32_t *number = g.first; /* no longer needed */
    for (int32_t v = 0; v < g.upto[0]; v++) {
        const struct net_place *p = &g.place[v];
        const int32_t cube[3] = {p->x, p->y, p->z};
        if (!q.is_used[v])
            continue;
        struct net_vertex *vertex = &net.vertex[net.vertices];
        number[v] = (int32_t)net.vertices++;
        for (int a = 0; a < 3; a++) {
            vertex->cube[a] = cube[a] - NET_MARGIN + q.origin[a];
            vertex->at[a] = (int16_t)(g.at[v][a] - cube[a] * NET_ONE);
            vertex->normal[a] = (int16_t)normal[v][a];
        }
        vertex->air = p->air;
    }
    for (uint32_t k = 0; k < net.quads; k++)
        for (int i = 0; i < 4; i++)
            net.quad[k].corner[i] = (uint32_t)number[net.quad[k].corner[i]];
    *out = net;
    return true;
}

enum err net_make(struct net *net, const struct net_source *source, const int32_t first[3],
                  const uint32_t size[3], struct fault *fault)
{
    struct net_scratch *own = source->scratch ? NULL : net_scratch_new();
    struct net_scratch *scratch = own ? own : source->scratch;
    const bool made = scratch && make_net(net, source, first, size, scratch);
    net_scratch_free(own);
    return made ? OK : fault_memory(fault, "a surface");
}

unsigned net_diagonal(int32_t corner[4][3], unsigned face)
{
    int64_t longer = 0; /* squared length of diagonal 0 to 2 minus that of 1 to 3 */
    for (int a = 0; a < 3; a++) {
        const int64_t d = corner[2][a] - corner[0][a], e = corner[3][a] - corner[1][a];
        longer += d * d - e * e;
    }
    return longer == 0 ? !(face & 1) : longer > 0;
}

void net_release(struct net *net)
{
    free(net->vertex);
    free(net->quad);
    *net = (struct net){.vertices = 0};
}

struct net_scratch *net_scratch_new(void)
{
    return mem_new(sizeof(struct net_scratch));
}

void net_scratch_free(struct net_scratch *scratch)
{
    for (int k = 0; k < NET_STORES && scratch; k++)
        free(scratch->store[k].items);
    free(scratch);
}

size_t net_scratch_bytes(const struct net_scratch *scratch)
{
    size_t bytes = 0;
    for (int k = 0; k < NET_STORES && scratch; k++)
        bytes += scratch->store[k].bytes;
    return bytes;
}
