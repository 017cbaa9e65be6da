/* SPDX-License-Identifier: MIT */
#include "engine/net_graph.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

/* Corners that are connected by faces with the lowest corner of `left`, through `left`. */
static uint8_t grown_from(uint8_t left)
{
    uint32_t grown = (uint32_t)(left & -left), before;
    do {
        before = grown;
        for (uint32_t c = 0; c < NET_CORNERS; c++)
            if (grown >> c & 1)
                grown |= left & (1U << (c ^ 1) | 1U << (c ^ 2) | 1U << (c ^ 4));
    } while (grown != before);
    return (uint8_t)grown;
}

/* Find links through air on the side of the cube that has a crossing there and is not closed. Two
 * parts of one side are diagonal: the other two corners are in the object. */
static void find_links(struct net_part *part, int axis, uint8_t air, uint8_t closed)
{
    const int u = 1 << (axis + 1) % 3, v = 1 << (axis + 2) % 3;
    const int corner[4] = {0, u, v, u | v};
    int count = 0;
    memset(part->link[axis], NET_UNLINKED, sizeof part->link[axis]);
    for (int i = 0; i < 4; i++) {
        const int c = corner[i];
        const bool beside_u = !(air >> (c ^ u) & 1), beside_v = !(air >> (c ^ v) & 1);
        if (!(part->air >> c & 1) || closed >> c & 1 || !(beside_u || beside_v))
            continue;
        if (count == 0 || (beside_u && beside_v && part->link[axis][0] == (c ^ u ^ v)))
            part->link[axis][count++] = (uint8_t)c;
    }
}

/* Compute the cube whose corners outside the object are `air`, some of them closed. */
static void net_cube_init(struct net_cube *cube, uint8_t air, uint8_t closed)
{
    uint8_t left = air == UINT8_MAX ? 0 : air;
    memset(cube, 0, sizeof *cube);
    while (left) {
        struct net_part *part = &cube->part[cube->count++];
        part->air = grown_from(left);
        left = (uint8_t)(left & ~part->air);
        int32_t sum[3] = {0}, crossings = 0;
        for (int c = 0; c < NET_CORNERS; c++)
            for (int a = 0; a < 3 && part->air >> c & 1; a++) {
                const int other = c ^ 1 << a;
                if (air >> other & 1)
                    continue;
                if (closed >> c & 1) {
                    part->lock |= (uint8_t)(1 << a);
                    continue;
                }
                part->lock |= NET_NATURAL;
                part->normal[a] = (int8_t)(part->normal[a] + (c >> a & 1 ? 1 : -1));
                for (int k = 0; k < 3; k++)
                    sum[k] += ((c >> k & 1) + (other >> k & 1) - 1) * (NET_ONE / 2);
                crossings++;
            }
        for (int k = 0; k < 3 && crossings > 0; k++) {
            /* Halves away from 0: a mirrored cube has the mirrored mean. */
            const int32_t half = sum[k] < 0 ? -crossings : crossings;
            const bool is_locked = part->lock >> k & 1;
            part->start[k] = (int16_t)(is_locked ? 0 : (2 * sum[k] + half) / (2 * crossings));
        }
        for (int a = 0; a < 3; a++)
            find_links(part, a, air, closed);
    }
}

static struct net_cube cube_of_air[256];

static void make_cubes(void)
{
    for (int air = 0; air < 256; air++)
        net_cube_init(&cube_of_air[air], (uint8_t)air, 0);
}

const struct net_cube *net_cubes(void)
{
    static pthread_once_t once = PTHREAD_ONCE_INIT;
    pthread_once(&once, make_cubes);
    return cube_of_air;
}

/* A cube with vertices. */
struct net_cell {
    int16_t x, y, z;
    uint8_t air, level;
};

void *net_store(struct net_scratch *scratch, enum net_store which, size_t count, size_t size)
{
    size_t bytes;
    if (!size_multiply(count + 4, size, &bytes))
        return NULL;
    if (bytes > scratch->store[which].bytes) {
        free(scratch->store[which].items);
        scratch->store[which].bytes = 0;
        scratch->store[which].items = mem_array(bytes + bytes / 8, 1);
        if (!scratch->store[which].items)
            return NULL;
        scratch->store[which].bytes = bytes + bytes / 8;
    }
    return scratch->store[which].items;
}

/* ---- levels ---- */

static int32_t most_of(int32_t a, int32_t b)
{
    return a > b ? a : b;
}

static int32_t level_of(int32_t x, int32_t y, int32_t z)
{
    const int32_t steps = x + y + z, most = most_of(x, most_of(y, z));
    return steps < NET_TERMS ? steps : most_of(NET_TERMS, most_of(most, steps - 2));
}

/* The cubes of a row that are needed; false for none. */
static bool row_of(const struct net_graph *g, int32_t y, int32_t z, int32_t *low, int32_t *high)
{
    const int32_t dy = net_outside(g, 1, y, 1), dz = net_outside(g, 2, z, 1), last = NET_LEVELS - 1;
    const int32_t left = last + 2 - dy - dz, reach = left < last ? left : last;
    if (y < 0 || z < 0 || y + 1 >= g->size[1] || z + 1 >= g->size[2] || dy > last || dz > last ||
        left < 0)
        return false;
    *low = NET_MARGIN - 1 - reach;
    *high = g->size[0] - NET_MARGIN - 1 + reach;
    return true;
}

/* ---- voxels ---- */

/* Bits of four voxels of 16 bits each. */
static uint64_t four_bits(uint64_t lanes)
{
    return (lanes >> 8 & UINT64_C(0x0001000100010001)) * UINT64_C(0x0001000200040008) >> 48 & 15;
}

static void find_bits(struct net_graph *g, int32_t y, int32_t z, uint16_t *label)
{
    const size_t row = (size_t)z * (size_t)g->size[1] + (size_t)y;
    const uint16_t *voxel = g->voxel + row * (size_t)g->stride;
    for (int32_t k = 0; k < g->words; k++, voxel += NET_STEP) {
        uint64_t in = 0, closed = 0;
        for (int i = 0; i < 16; i++) {
            const uint16_t *v = voxel + 4 * i;
            const uint64_t four =
                v[0] | (uint64_t)v[1] << 16 | (uint64_t)v[2] << 32 | (uint64_t)v[3] << 48;
            if (four == 0)
                continue;
            in |= four_bits((four + UINT64_C(0x00ff00ff00ff00ff)) & ~four) << 4 * i;
            closed |= four_bits(four) << 4 * i;
            if (four != *label * UINT64_C(0x0001000100010001))
                for (int j = 0; j < 4; j++) {
                    if (v[j] == 0 || v[j] == NET_CLOSED)
                        continue;
                    g->has_labels |= *label && v[j] != *label;
                    *label = v[j];
                }
        }
        g->in[row * (size_t)g->words + (size_t)k] = in;
        g->closed[row * (size_t)g->words + (size_t)k] = closed;
        g->has_closed |= closed != 0;
    }
}

static bool read_voxels(struct net_graph *g, const struct net_source *source,
                        const int32_t first[3])
{
    const int32_t side = g->size[0];
    size_t rows, voxels, words;
    g->words = (side + NET_STEP - 1) / NET_STEP;
    g->stride = g->words * NET_STEP + 4;
    if (!size_multiply((size_t)g->size[1], (size_t)g->size[2], &rows) ||
        !size_multiply(rows, (size_t)g->stride, &voxels) || voxels > INT32_MAX)
        return false;
    words = rows * (size_t)g->words;
    g->voxel = net_store(g->scratch, NET_VOXEL, voxels, sizeof *g->voxel);
    g->in = net_store(g->scratch, NET_BITS_IN, words, sizeof *g->in);
    g->closed = net_store(g->scratch, NET_BITS_CLOSED, words, sizeof *g->closed);
    g->first = net_store(g->scratch, NET_FIRST, voxels, sizeof *g->first);
    if (!g->voxel || !g->in || !g->closed || !g->first)
        return false;
    uint16_t label = 0;
    for (int32_t z = 0; z < g->size[2]; z++)
        for (int32_t y = 0; y < g->size[1]; y++) {
            int32_t low, high;
            if (!row_of(g, y, z, &low, &high) && !row_of(g, y - 1, z, &low, &high) &&
                !row_of(g, y, z - 1, &low, &high) && !row_of(g, y - 1, z - 1, &low, &high))
                continue;
            uint16_t *voxel = g->voxel + net_index(g, 0, y, z);
            source->row(source->context, first[0] - NET_MARGIN, first[1] - NET_MARGIN + y,
                        first[2] - NET_MARGIN + z, (uint32_t)side, voxel);
            memset(voxel + side, 0, (size_t)(g->stride - side) * sizeof *voxel);
            find_bits(g, y, z, &label);
        }
    return true;
}

/* ---- cubes ---- */

/* The words of the four rows of voxels between which a row of cubes extends. */
struct bundle {
    const uint64_t *row[4];
};

static struct bundle bundle_of(const struct net_graph *g, const uint64_t *bits, int32_t y,
                               int32_t z)
{
    const size_t up = (size_t)g->words, on = up * (size_t)g->size[1];
    const uint64_t *first = bits + (size_t)z * on + (size_t)y * up;
    return (struct bundle){{first, first + up, first + on, first + on + up}};
}

/* Bits of cubes low to high of a word that have voxels of the object and others. */
static uint64_t mixed_of(const struct bundle *b, int32_t word, int32_t low, int32_t high)
{
    uint64_t some = 0, all = UINT64_MAX;
    for (int i = 0; i < 4; i++) {
        some |= b->row[i][word];
        all &= b->row[i][word];
    }
    return (some | some >> 1) & ~(all & all >> 1) & net_bits(word, low, high);
}

static uint8_t corners_of(const struct bundle *b, int32_t word, int bit)
{
    uint32_t corners = 0;
    for (int i = 0; i < 4; i++)
        corners |= (uint32_t)(b->row[i][word] >> bit & 3) << 2 * i;
    return (uint8_t)corners;
}

/* Vertices of a cube; cubes with closed corners are computed in `made`. */
static const struct net_cube *cube_of(const struct net_graph *g, const struct net_cell *cell,
                                      const struct net_cube *cubes, struct net_cube *made)
{
    const struct bundle b = bundle_of(g, g->closed, cell->y, cell->z);
    const uint8_t closed =
        g->has_closed ? corners_of(&b, cell->x / NET_STEP, cell->x % NET_STEP) : 0;
    if (!closed)
        return &cubes[cell->air];
    net_cube_init(made, cell->air, closed);
    return made;
}

static bool find_cells(struct net_graph *g, struct net_cell **out, size_t *count)
{
    const struct net_cube *cubes = net_cubes();
    int32_t at_level[NET_LEVELS] = {0};
    struct net_cell *cell = NULL;
    for (int pass = 0; pass < 2; pass++) {
        *count = 0;
        for (int32_t z = 0; z + 1 < g->size[2]; z++)
            for (int32_t y = 0; y + 1 < g->size[1]; y++) {
                int32_t low, high;
                if (!row_of(g, y, z, &low, &high))
                    continue;
                const int32_t dy = net_outside(g, 1, y, 1), dz = net_outside(g, 2, z, 1);
                const struct bundle rows = bundle_of(g, g->in, y, z);
                for (int32_t k = 0; k < g->words; k++) {
                    uint64_t mixed = mixed_of(&rows, k, low, high);
                    if (pass == 0)
                        *count += (size_t)__builtin_popcountll(mixed);
                    for (; mixed && pass == 1; mixed &= mixed - 1) {
                        const int bit = __builtin_ctzll(mixed);
                        const int32_t x = k * NET_STEP + bit;
                        const uint8_t air = (uint8_t)~corners_of(&rows, k, bit);
                        const int32_t level = level_of(net_outside(g, 0, x, 1), dy, dz);
                        cell[(*count)++] = (struct net_cell){(int16_t)x, (int16_t)y, (int16_t)z,
                                                             air, (uint8_t)level};
                        at_level[level] += (int32_t)cubes[air].count;
                    }
                }
            }
        if (pass == 0)
            cell = *out = net_store(g->scratch, NET_CELL, *count, sizeof *cell);
        if (!cell)
            return false;
    }
    for (int k = 0, sum = 0; k < NET_LEVELS; k++)
        g->upto[k] = sum += at_level[k];
    return true;
}

/* ---- links ---- */

static void add_slot(struct net_graph *g, int32_t v, int32_t to, int32_t *mores)
{
    const int32_t count = g->degree[v]++;
    if (count < NET_SLOTS) {
        g->link[v][count] = to;
        return;
    }
    g->more[*mores] = (struct net_more){to, count == NET_SLOTS ? -1 : g->head[v]};
    g->head[v] = (*mores)++;
}

static void add_line(struct net_graph *g, int32_t v, int32_t to)
{
    if (g->lines[v] < 2)
        g->line[v][g->lines[v]] = to;
    g->lines[v] = (uint8_t)(g->lines[v] < 3 ? g->lines[v] + 1 : 3);
}

/* True if the voxels of the object next to the air through which a link passes, on the low side of
 * a cube, have several labels. */
static bool is_border(const struct net_graph *g, size_t cube, int axis, uint8_t air, int corner)
{
    const size_t step[3] = {1, (size_t)g->stride, (size_t)g->stride * (size_t)g->size[1]};
    const int u = (axis + 1) % 3, v = (axis + 2) % 3, across = 1 << u | 1 << v;
    const bool is_alone = !(air >> (corner ^ 1 << u) & 1) && !(air >> (corner ^ 1 << v) & 1);
    uint16_t label = 0;
    bool differ = false;
    for (int i = 0; i < 4; i++) {
        const int c = corner ^ ((i & 1) << u | i >> 1 << v);
        const uint16_t is = g->voxel[cube + (c >> u & 1) * step[u] + (c >> v & 1) * step[v]];
        if (air >> c & 1 || (is_alone && (c ^ corner) == across))
            continue;
        const bool beside = (air >> (c ^ 1 << u) & 1) || (air >> (c ^ 1 << v) & 1);
        differ |= beside && label && is != label;
        label = beside ? is : label;
    }
    return differ;
}

static void link_part(struct net_graph *g, int32_t v, const struct net_part *part,
                      const struct net_cell *cell, int32_t *mores)
{
    const size_t cube = net_index(g, cell->x, cell->y, cell->z);
    const size_t step[3] = {1, (size_t)g->stride, (size_t)g->stride * (size_t)g->size[1]};
    for (int a = 0; a < 3; a++) {
        int32_t last = -1;
        for (int i = 0; i < 2 && part->link[a][i] != NET_UNLINKED; i++) {
            int32_t low, high;
            if (cell->level == NET_LEVELS - 1 && /* the adjacent cube may not exist */
                (!row_of(g, cell->y - (a == 1), cell->z - (a == 2), &low, &high) ||
                 cell->x - (a == 0) < low || cell->x - (a == 0) > high))
                continue;
            const int32_t to = net_vertex_at(g, cube - step[a], part->link[a][i] ^ 1 << a);
            if (to == last)
                continue;
            last = to;
            add_slot(g, v, to, mores);
            add_slot(g, to, v, mores);
            if (g->has_labels && is_border(g, cube, a, cell->air, part->link[a][i])) {
                add_line(g, v, to);
                add_line(g, to, v);
            }
        }
    }
}

static bool find_vertices(struct net_graph *g, const struct net_cell *cell, size_t cells)
{
    const struct net_cube *cubes = net_cubes();
    const size_t all = (size_t)g->upto[NET_LEVELS - 1];
    if (all > INT32_MAX / 2)
        return false;
    int32_t next[NET_LEVELS] = {0}, mores = 0;
    g->place = net_store(g->scratch, NET_PLACE, all, sizeof *g->place);
    g->at = net_store(g->scratch, NET_AT, all, sizeof *g->at);
    g->push = net_store(g->scratch, NET_PUSH, all, sizeof *g->push);
    g->link = net_store(g->scratch, NET_LINK, all, sizeof *g->link);
    g->degree = net_store(g->scratch, NET_DEGREE, all, 1);
    g->head = net_store(g->scratch, NET_HEAD, all, sizeof *g->head);
    g->more = net_store(g->scratch, NET_MORE, all * (NET_LINKS_MOST - NET_SLOTS), sizeof *g->more);
    if (!g->place || !g->at || !g->push || !g->link || !g->degree || !g->head || !g->more)
        return false;
    memset(g->degree, 0, all);
    if (g->has_labels) {
        g->line = net_store(g->scratch, NET_LINE, all, sizeof *g->line);
        g->lines = net_store(g->scratch, NET_LINES, all, 1);
        if (!g->line || !g->lines)
            return false;
        memset(g->lines, 0, all);
    }
    memcpy(next + 1, g->upto, (NET_LEVELS - 1) * sizeof *next);
    for (const struct net_cell *c = cell; c < cell + cells; c++) {
        struct net_cube made;
        const struct net_cube *cube = cube_of(g, c, cubes, &made);
        g->first[net_index(g, c->x, c->y, c->z)] = next[c->level] * 2 + (cube->count == 1);
        for (uint32_t k = 0; k < cube->count; k++) {
            const struct net_part *part = &cube->part[k];
            const int32_t v = next[c->level]++;
            g->place[v] = (struct net_place){c->x, c->y, c->z, part->lock, part->air};
            g->at[v] = (net_lanes){c->x * NET_ONE + NET_ONE / 2 + part->start[0],
                                   c->y * NET_ONE + NET_ONE / 2 + part->start[1],
                                   c->z * NET_ONE + NET_ONE / 2 + part->start[2], 0};
            g->push[v] = (net_lanes){part->normal[0], part->normal[1], part->normal[2], 0};
            for (int i = 0; i < NET_SLOTS; i++)
                g->link[v][i] = v;
            link_part(g, v, part, c, &mores);
        }
    }
    return true;
}

bool net_graph_make(struct net_graph *graph, const struct net_source *source,
                    const int32_t first[3], const uint32_t size[3], struct net_scratch *scratch)
{
    struct net_cell *cell = NULL;
    size_t cells = 0;
    *graph = (struct net_graph){.scratch = scratch};
    for (int a = 0; a < 3; a++) {
        if (size[a] > INT16_MAX - 2 * NET_MARGIN)
            return false;
        graph->size[a] = (int32_t)size[a] + 2 * NET_MARGIN;
    }
    return read_voxels(graph, source, first) && find_cells(graph, &cell, &cells) &&
           find_vertices(graph, cell, cells);
}
