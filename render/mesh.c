/* SPDX-License-Identifier: MIT */
#include "render/mesh.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "engine/changes.h"
#include "render/view.h"

enum {
    REGION_BITS = 6, /* log2 of the largest side of the voxels of one net */
    REGION_BRICKS = 1 << (REGION_BITS - BORDER_BLOCK_BITS),
    BRICKS = REGION_BRICKS * REGION_BRICKS * REGION_BRICKS,
};

/* ---- bricks ---- */

static size_t brick_bytes(const struct mesh_brick *brick)
{
    return brick ? sizeof *brick + brick->vertices * sizeof *brick->vertex +
                       brick->quads * sizeof *brick->quad
                 : 0;
}

void mesh_release(struct mesh *mesh)
{
    for (uint32_t i = 0; i < mesh->bricks && mesh->brick; i++)
        free(mesh->brick[i]);
    free(mesh->brick);
    free(mesh->stale);
    for (int i = 0; i < TEAM_MOST; i++)
        net_scratch_free(mesh->scratch[i]);
    *mesh = (struct mesh){0};
}

size_t mesh_bytes(const struct mesh *mesh)
{
    size_t bytes =
        mesh->bytes + mesh->bricks * sizeof *mesh->brick + mesh->regions * sizeof *mesh->stale;
    for (int i = 0; i < TEAM_MOST; i++)
        bytes += net_scratch_bytes(mesh->scratch[i]);
    return bytes;
}

static uint32_t number_of(const struct mesh *mesh, const uint32_t brick[3])
{
    return (uint32_t)(((size_t)brick[2] * mesh->size[1] + brick[1]) * mesh->size[0] + brick[0]);
}

void mesh_first(const struct mesh *mesh, uint32_t number, uint32_t first[3])
{
    first[0] = number % mesh->size[0] * MESH_SIDE;
    first[1] = number / mesh->size[0] % mesh->size[1] * MESH_SIDE;
    first[2] = number / mesh->size[0] / mesh->size[1] * MESH_SIDE;
}

static unsigned row_of(unsigned key)
{
    return key / (MESH_SIDE * MESH_FACES);
}

const struct mesh_quad *mesh_find(const struct mesh *mesh, const struct mesh_brick **brick,
                                  struct place p, unsigned face)
{
    const unsigned key = mesh_key(p, face), row = row_of(key);
    const uint32_t at[3] = {p.x / MESH_SIDE, p.y / MESH_SIDE, p.z / MESH_SIDE};
    *brick = mesh->brick[number_of(mesh, at)];
    if (!*brick)
        return NULL;
    const struct mesh_quad *end = (*brick)->quad + (*brick)->row[row + 1];
    for (const struct mesh_quad *q = (*brick)->quad + (*brick)->row[row]; q < end; q++)
        if (q->key == key)
            return q;
    return NULL;
}

/* ---- nets of a region ---- */

/* Group of a quad: all opaque labels, or one translucent label. */
enum { OPAQUE = 0 };

struct group_source {
    const struct border *border;
    uint8_t group[256]; /* group of each visible label */
    uint8_t wanted;
    bool is_all;   /* the group has all visible voxels, and nothing is cut away, so labels are
                      needed only at the border */
    uint8_t label; /* (net.h); elsewhere the previous label is used */
};

/* Read up to 64 cells from `cell` on. */
static void read_bits(struct group_source *s, uint32_t cell, uint32_t count, uint16_t *voxel)
{
    const uint64_t none = UINT64_MAX << (count - 1) << 1;
    const uint64_t shown = border_bits_at(s->border->shown, cell) & ~none;
    uint64_t seen = border_bits_at(s->border->border, cell) & ~none;
    if (shown == 0) {
        memset(voxel, 0, count * sizeof *voxel);
        return;
    }
    for (uint32_t i = 0; i < count; i++)
        voxel[i] = (uint16_t)(-(shown >> i & 1) & s->label);
    for (; seen; seen &= seen - 1) {
        const uint32_t i = (uint32_t)__builtin_ctzll(seen);
        voxel[i] = s->label = labels_at(&s->border->labels, cell + i);
    }
}

static uint16_t read_one(const struct group_source *s, uint32_t cell)
{
    const bool is_shown = border_shows(s->border, cell);
    if (!is_shown && cut_is_none(&s->border->cut))
        return 0;
    const uint8_t label = labels_at(&s->border->labels, cell);
    if (!s->border->visible[label] || s->group[label] != s->wanted)
        return 0;
    return is_shown ? label : NET_CLOSED;
}

static void read_row(void *context, int32_t x, int32_t y, int32_t z, uint32_t count,
                     uint16_t *voxel)
{
    struct group_source *s = context;
    const struct grid *grid = &s->border->scene->grid;
    const int32_t width = (int32_t)grid->size[0], end = x + (int32_t)count;
    const bool is_inside =
        y >= 0 && z >= 0 && y < (int32_t)grid->size[1] && z < (int32_t)grid->size[2];
    const int32_t from = x < 0 ? 0 : x, to = !is_inside ? from : end < width ? end : width;
    for (int32_t at = x; at < end; at++)
        if (at < from || at >= to)
            voxel[at - x] = NET_CLOSED;
    for (int32_t at = from; at < to; at += 64) {
        const uint32_t cell = grid_cell(grid, (uint32_t)at, (uint32_t)y, (uint32_t)z);
        const uint32_t some = to - at < 64 ? (uint32_t)(to - at) : 64;
        if (s->is_all)
            read_bits(s, cell, some, voxel + (at - x));
        for (uint32_t i = 0; i < some && !s->is_all; i++)
            voxel[at - x + (int32_t)i] = read_one(s, cell + i);
    }
}

/* The voxels of a region whose quads are recomputed, and the resulting bricks. */
struct region {
    struct mesh_box box;
    uint32_t first[3], end[3];        /* the bricks of these voxels */
    struct mesh_brick *brick[BRICKS]; /* [z][y][x] */
    bool is_short;                    /* memory ran out */
};

static uint32_t brick_in(const uint32_t brick[3])
{
    return ((brick[2] % REGION_BRICKS) * REGION_BRICKS + brick[1] % REGION_BRICKS) * REGION_BRICKS +
           brick[0] % REGION_BRICKS;
}

/* The bounding box of a group in a region. */
struct extent {
    uint32_t first[3], last[3];
    uint8_t label; /* one of its labels; 0: the group is empty */
};

static bool has_walls(const struct mesh *mesh)
{
    return (mesh->kind & MESH_APART) || border_is_translucent(mesh->border);
}

static void find_extents(const struct mesh *mesh, const struct region *r, const uint8_t group[256],
                         struct extent extent[256])
{
    const struct border *border = mesh->border;
    const bool is_all = !has_walls(mesh);
    const uint32_t *first = r->box.first, *end = r->box.end;
    memset(extent, 0, 256 * sizeof *extent);
    for (uint32_t z = first[2]; z < end[2]; z++)
        for (uint32_t y = first[1]; y < end[1]; y++) {
            const uint32_t cell = grid_cell(&border->scene->grid, first[0], y, z);
            const uint32_t count = end[0] - first[0]; /* at most 64 in a region */
            uint64_t bits = border_bits_at(is_all ? border->border : border->shown, cell) &
                            UINT64_MAX >> (64 - count);
            while (bits) {
                const uint32_t x = (uint32_t)__builtin_ctzll(bits);
                const uint32_t last = is_all ? 63 - (uint32_t)__builtin_clzll(bits) : x;
                const uint8_t label = labels_at(&border->labels, cell + x);
                const uint32_t low[3] = {first[0] + x, y, z}, high[3] = {first[0] + last, y, z};
                struct extent *e = &extent[group[label]];
                for (int a = 0; a < 3; a++) {
                    e->first[a] = e->label && e->first[a] < low[a] ? e->first[a] : low[a];
                    e->last[a] = e->label && e->last[a] > high[a] ? e->last[a] : high[a];
                }
                e->label = label;
                bits = is_all ? 0 : bits & (bits - 1);
            }
        }
}

/* ---- bricks of nets ---- */

/* A net, with its quads sorted by brick. */
struct part {
    struct net net;
    uint32_t *order;            /* numbers of quads, by brick */
    uint32_t first[BRICKS + 2]; /* start of each brick in `order` */
};

/* A region in progress: its nets, and one brick. */
struct assembly {
    struct part *part;
    size_t parts, capacity;
    struct mesh_quad *quad;
    struct mesh_vertex *vertex;
    uint32_t quads, vertices;
    size_t quads_most, vertices_most;
    uint32_t *local; /* for each vertex of a net or former brick: its number in the new one */
    uint32_t *of;    /* the source that set that number, counted from 1 */
    uint32_t sources;
};

static uint32_t brick_of(const struct net_quad *q)
{
    const uint32_t brick[3] = {(uint32_t)q->voxel[0] / MESH_SIDE, (uint32_t)q->voxel[1] / MESH_SIDE,
                               (uint32_t)q->voxel[2] / MESH_SIDE};
    return brick_in(brick);
}

/* Return the number of a vertex in the new brick, adding it if it is new. */
static uint16_t take_vertex(struct assembly *a, uint32_t vertex, bool *is_new)
{
    *is_new = a->of[vertex] != a->sources;
    if (*is_new) {
        a->of[vertex] = a->sources;
        a->local[vertex] = a->vertices++;
    }
    return (uint16_t)a->local[vertex];
}

static void take_quad(struct assembly *a, const struct net *net, const struct net_quad *from)
{
    const int32_t *v = from->voxel;
    const struct place voxel = {(uint32_t)v[0], (uint32_t)v[1], (uint32_t)v[2]};
    struct mesh_quad *q = &a->quad[a->quads++];
    uint16_t corner[4];
    int32_t place[4][3];
    for (int k = 0; k < 4; k++) {
        bool is_new;
        corner[k] = take_vertex(a, from->corner[k], &is_new);
        struct mesh_vertex *out = &a->vertex[corner[k]];
        if (is_new) {
            const struct net_vertex *n = &net->vertex[from->corner[k]];
            for (int i = 0; i < 3; i++) {
                out->at[i] = (n->cube[i] - (v[i] & ~(MESH_SIDE - 1))) * NET_ONE + n->at[i];
                out->normal[i] = n->normal[i];
            }
            out->normal[3] = 0;
        }
        memcpy(place[k], out->at, sizeof place[k]);
    }
    const unsigned d = net_diagonal(place, from->face);
    *q = (struct mesh_quad){{corner[d], corner[d + 1], corner[d + 2], corner[(d + 3) % 4]},
                            (uint16_t)mesh_key(voxel, from->face),
                            from->label,
                            from->is_closed};
}

/* Build a brick of the collected quads, sorted by key. */
static struct mesh_brick *finish_brick(const struct assembly *a)
{
    struct mesh_brick *b;
    struct mesh_vertex *vertex;
    struct mesh_quad *quad;
    uint16_t next[MESH_ROWS];
    const struct mem_part parts[] = {{&b, 1, sizeof *b},
                                     {&vertex, a->vertices, sizeof *vertex},
                                     {&quad, a->quads, sizeof *quad}};
    if (!mem_parts(parts, sizeof parts / sizeof *parts))
        return NULL;
    *b = (struct mesh_brick){a->vertices, a->quads, vertex, quad, {0}};
    memcpy(vertex, a->vertex, a->vertices * sizeof *vertex);
    for (uint32_t q = 0; q < a->quads; q++)
        b->row[row_of(a->quad[q].key) + 1]++;
    for (uint32_t row = 0; row < MESH_ROWS; row++)
        b->row[row + 1] = (uint16_t)(b->row[row + 1] + b->row[row]);
    memcpy(next, b->row, sizeof next);
    for (const struct mesh_quad *q = a->quad; q < a->quad + a->quads; q++) {
        const uint32_t row = row_of(q->key);
        uint32_t at = next[row]++;
        for (; at > b->row[row] && b->quad[at - 1].key > q->key; at--)
            b->quad[at] = b->quad[at - 1];
        b->quad[at] = *q;
    }
    return b;
}

/* Build one brick of a region, from its nets and from former quads outside the region's box. */
static bool make_brick(struct assembly *a, const struct mesh *mesh, struct region *r,
                       const uint32_t at[3])
{
    const uint32_t b = brick_in(at);
    const uint32_t first[3] = {at[0] * MESH_SIDE, at[1] * MESH_SIDE, at[2] * MESH_SIDE};
    const struct mesh_brick *former = mesh->brick[number_of(mesh, at)];
    size_t most = former ? former->quads : 0;
    for (size_t i = 0; i < a->parts; i++)
        most += a->part[i].first[b + 1] - a->part[i].first[b];
    if (!mem_grow(&a->quad, &a->quads_most, most, sizeof *a->quad) ||
        !mem_grow(&a->vertex, &a->vertices_most, 4 * most, sizeof *a->vertex))
        return false;
    a->quads = a->vertices = 0;
    if (former) {
        a->sources++;
        /* Keep the former quads whose voxels are outside the box. */
        for (uint32_t i = 0; i < former->quads; i++) {
            const unsigned key = former->quad[i].key;
            const struct place v = mesh_voxel(first, key);
            if (v.x >= r->box.first[0] && v.x < r->box.end[0] && v.y >= r->box.first[1] &&
                v.y < r->box.end[1] && v.z >= r->box.first[2] && v.z < r->box.end[2])
                continue;
            struct mesh_quad *q = &a->quad[a->quads++];
            *q = former->quad[i];
            for (int k = 0; k < 4; k++) {
                bool is_new;
                const uint16_t was = q->corner[k];
                q->corner[k] = take_vertex(a, was, &is_new);
                if (is_new)
                    a->vertex[q->corner[k]] = former->vertex[was];
            }
        }
    }
    for (const struct part *p = a->part; p < a->part + a->parts; p++) {
        a->sources++;
        for (uint32_t i = p->first[b]; i < p->first[b + 1]; i++)
            take_quad(a, &p->net, &p->net.quad[p->order[i]]);
    }
    if (a->quads > 0)
        r->brick[b] = finish_brick(a);
    return a->quads == 0 || r->brick[b];
}

static bool make_bricks(struct assembly *a, const struct mesh *mesh, struct region *r)
{
    size_t most = 1; /* most vertices of any source */
    for (uint32_t z = r->first[2]; z < r->end[2]; z++)
        for (uint32_t y = r->first[1]; y < r->end[1]; y++)
            for (uint32_t x = r->first[0]; x < r->end[0]; x++) {
                const struct mesh_brick *former =
                    mesh->brick[number_of(mesh, (const uint32_t[]){x, y, z})];
                most = former && former->vertices > most ? former->vertices : most;
            }
    for (size_t i = 0; i < a->parts; i++)
        most = a->part[i].net.vertices > most ? a->part[i].net.vertices : most;
    a->local = mem_array(most, sizeof *a->local);
    a->of = mem_new(most * sizeof *a->of);
    bool made = a->local && a->of;
    for (uint32_t z = r->first[2]; z < r->end[2] && made; z++)
        for (uint32_t y = r->first[1]; y < r->end[1] && made; y++)
            for (uint32_t x = r->first[0]; x < r->end[0] && made; x++)
                made = make_brick(a, mesh, r, (const uint32_t[]){x, y, z});
    return made;
}

/* Make the nets of a region, with their quads sorted by brick. */
static bool make_nets(struct assembly *a, const struct mesh *mesh, const struct region *r,
                      struct net_scratch *scratch)
{
    const struct border *border = mesh->border;
    struct group_source groups = {.border = border,
                                  .is_all = !has_walls(mesh) && cut_is_none(&border->cut)};
    struct net_source source = {read_row, &groups, {0}, mesh->kind & MESH_CUBES, scratch};
    struct extent extent[256];
    const uint64_t unit = view_unit(border->scene);
    for (int label = 1; label < 256; label++)
        groups.group[label] = mesh->kind & MESH_APART || border->opacity[label] < BORDER_OPAQUE
                                  ? (uint8_t)label
                                  : OPAQUE;
    for (int k = 0; k < 3; k++)
        source.scale[k] = (uint32_t)((unit << 12) / border->scene->spacing_nm[k]);
    find_extents(mesh, r, groups.group, extent);
    for (int g = 0; g < 256; g++) {
        const struct extent *e = &extent[g];
        int32_t first[3];
        uint32_t size[3];
        if (!e->label)
            continue;
        groups.wanted = (uint8_t)g;
        groups.label = e->label;
        for (int k = 0; k < 3; k++) {
            first[k] = (int32_t)e->first[k];
            size[k] = e->last[k] - e->first[k] + 1;
        }
        if (!mem_grow(&a->part, &a->capacity, a->parts + 1, sizeof *a->part))
            return false;
        struct part *p = &a->part[a->parts];
        p->order = NULL;
        if (net_make(&p->net, &source, first, size, NULL))
            return false;
        a->parts++;
        /* Sort the net's quads by brick of the region. */
        p->order = mem_array(p->net.quads, sizeof *p->order);
        if (!p->order)
            return false;
        memset(p->first, 0, sizeof p->first);
        for (uint32_t q = 0; q < p->net.quads; q++)
            p->first[brick_of(&p->net.quad[q]) + 2]++;
        for (uint32_t b = 2; b < BRICKS + 2; b++)
            p->first[b] += p->first[b - 1];
        for (uint32_t q = 0; q < p->net.quads; q++)
            p->order[p->first[brick_of(&p->net.quad[q]) + 1]++] = q;
    }
    return true;
}

static void make_region(const struct mesh *mesh, struct region *r, struct net_scratch *scratch)
{
    struct assembly a = {.parts = 0};
    r->is_short = !make_nets(&a, mesh, r, scratch) || !make_bricks(&a, mesh, r);
    for (size_t i = 0; i < a.parts; i++) {
        net_release(&a.part[i].net);
        free(a.part[i].order);
    }
    free(a.part);
    free(a.quad);
    free(a.vertex);
    free(a.local);
    free(a.of);
}

/* ---- stale regions ---- */

static uint32_t regions_along(const struct mesh *mesh, int a)
{
    return (mesh->size[a] - 1) / REGION_BRICKS + 1;
}

static bool is_none(const struct mesh_box *box)
{
    return box->first[0] >= box->end[0];
}

/* Mark the quads of voxels at most `far` steps from these along each axis. */
static void mark_regions(struct mesh *mesh, const uint32_t first[3], const uint32_t last[3],
                         uint32_t far)
{
    const uint32_t *size = mesh->border->scene->grid.size;
    struct mesh_box all;
    for (int a = 0; a < 3; a++) {
        all.first[a] = first[a] < far ? 0 : first[a] - far;
        all.end[a] = last[a] + far + 1 < size[a] ? last[a] + far + 1 : size[a];
    }
    for (uint32_t z = all.first[2] >> REGION_BITS; z <= (all.end[2] - 1) >> REGION_BITS; z++)
        for (uint32_t y = all.first[1] >> REGION_BITS; y <= (all.end[1] - 1) >> REGION_BITS; y++)
            for (uint32_t x = all.first[0] >> REGION_BITS; x <= (all.end[0] - 1) >> REGION_BITS;
                 x++) {
                const uint32_t at[3] = {x, y, z};
                struct mesh_box *box =
                    &mesh->stale[((size_t)z * regions_along(mesh, 1) + y) * regions_along(mesh, 0) +
                                 x];
                const bool is_new = is_none(box);
                for (int a = 0; a < 3; a++) {
                    const uint32_t from = at[a] << REGION_BITS, to = (at[a] + 1) << REGION_BITS;
                    const uint32_t low = all.first[a] > from ? all.first[a] : from;
                    const uint32_t high = all.end[a] < to ? all.end[a] : to;
                    box->first[a] = is_new || low < box->first[a] ? low : box->first[a];
                    box->end[a] = is_new || high > box->end[a] ? high : box->end[a];
                }
            }
    mesh->is_stale = true;
}

/* Mark a voxel that was added to or removed from the object, or changed its label. Without walls
 * between objects, only labels at the surface matter. */
static void mark_cell(struct mesh *mesh, uint32_t cell, bool is_shown, bool walls)
{
    const struct place p = grid_place(&mesh->border->scene->grid, cell);
    const uint32_t at[3] = {p.x, p.y, p.z};
    if (!is_shown || walls || border_holds(mesh->border, cell))
        mark_regions(mesh, at, at, NET_MARGIN);
}

static void mark_all(struct mesh *mesh)
{
    const uint32_t *size = mesh->border->scene->grid.size;
    mark_regions(mesh, (const uint32_t[]){0, 0, 0},
                 (const uint32_t[]){size[0] - 1, size[1] - 1, size[2] - 1}, 0);
}

void mesh_note(struct mesh *mesh, const struct border *border, const struct changes *changes)
{
    if (mesh->border != border)
        return;
    if (changes->everything || border->version != mesh->version + 1) {
        mesh->is_lost = true; /* mesh_update searches for changes itself */
        return;
    }
    const bool walls = has_walls(mesh); /* loops over all labels, so not for each voxel */
    for (size_t i = 0; i < changes->count; i++) {
        const struct change *c = changes->item + i;
        const bool was = border->visible[c->former_label], is = border->visible[c->label];
        if (was || is)
            mark_cell(mesh, c->cell, was && is, walls);
    }
    mesh->version = border->version;
}

/* Mark the voxels from `cell` to the end of its row, or to `end`, and return their number. */
static size_t mark_run(struct mesh *mesh, size_t cell, size_t end)
{
    const struct grid *grid = &mesh->border->scene->grid;
    const size_t x = cell % (size_t)grid->step[1], y = cell / (size_t)grid->step[1];
    const size_t rows = (size_t)(grid->step[2] / grid->step[1]);
    const uint32_t row = (uint32_t)(y % rows), plane = (uint32_t)(y / rows);
    size_t run = (size_t)grid->step[1] - x;
    run = run < end - cell ? run : end - cell;
    if (row == 0 || row > grid->size[1] || plane == 0 || plane > grid->size[2])
        return run;
    const uint32_t first = x ? (uint32_t)x - 1 : 0, last = (uint32_t)(x + run - 1);
    const uint32_t least[3] = {first, row - 1, plane - 1};
    const uint32_t most[3] = {last < grid->size[0] ? last : grid->size[0] - 1, row - 1, plane - 1};
    if (first < grid->size[0])
        mark_regions(mesh, least, most, NET_MARGIN);
    return run;
}

/* After a recount: mark changed words of shown voxels, and visible voxels with a changed label. */
static void mark_recounted(struct mesh *mesh)
{
    const struct border *border = mesh->border;
    const struct grid *grid = &border->scene->grid;
    const bool walls = has_walls(mesh);
    for (size_t w = 0; w + 1 < border->words; w++)
        for (size_t cell = w * 64, end = cell + 64;
             border->changed[w] > mesh->version && cell < end;)
            cell += mark_run(mesh, cell, end);
    for (uint32_t b = 0; b < mesh->bricks; b++) {
        const struct mesh_brick *brick = mesh->brick[b];
        uint32_t first[3];
        if (!brick)
            continue;
        mesh_first(mesh, b, first);
        for (uint32_t q = 0; q < brick->quads; q++) {
            const struct place p = mesh_voxel(first, brick->quad[q].key);
            const uint32_t cell = grid_cell(grid, p.x, p.y, p.z);
            if (labels_at(&border->labels, cell) != brick->quad[q].label)
                mark_cell(mesh, cell, true, walls);
        }
    }
}

/* Return true if the whole mesh is out of date. Labels of voxels without quads matter if they are
 * cut away, and where objects may get walls. */
static bool is_other(const struct mesh *mesh, const struct border *border, enum mesh_kind kind)
{
    const bool is_cut = mesh->is_cut || !cut_is_none(&border->cut);
    return mesh->kind != kind ||
           memcmp(mesh->opacity, border->opacity, sizeof mesh->opacity) != 0 ||
           (is_cut && memcmp(mesh->visible, border->visible, sizeof mesh->visible) != 0) ||
           (mesh->is_lost && (is_cut || has_walls(mesh)));
}

static enum err begin_mesh(struct mesh *mesh, const struct border *border, struct fault *fault)
{
    const struct grid *grid = &border->scene->grid;
    mesh_release(mesh);
    mesh->bricks = 1;
    for (int a = 0; a < 3; a++) {
        mesh->size[a] = (grid->size[a] - 1) / MESH_SIDE + 1;
        mesh->bricks *= mesh->size[a];
    }
    mesh->brick = mem_new(mesh->bricks * sizeof *mesh->brick);
    mesh->regions = 1;
    for (int a = 0; a < 3; a++)
        mesh->regions *= regions_along(mesh, a);
    mesh->stale = mem_new(mesh->regions * sizeof *mesh->stale);
    if (!mesh->brick || !mesh->stale) {
        mesh_release(mesh);
        return fault_memory(fault, "a surface");
    }
    mesh->border = border;
    mark_all(mesh);
    return OK;
}

/* ---- the update ---- */

/* The regions whose bricks are recomputed. */
struct updating {
    struct mesh *mesh;
    struct region *region;
    size_t regions;
    struct team *team;
};

static bool add_region(struct updating *u, size_t *capacity, const struct mesh_box *box)
{
    if (!mem_grow(&u->region, capacity, u->regions + 1, sizeof *u->region))
        return false;
    /* Count the region only if a brick of its box is to be built or removed. */
    struct region *r = &u->region[u->regions];
    bool is_any = false;
    *r = (struct region){.box = *box};
    for (int a = 0; a < 3; a++) {
        r->first[a] = r->box.first[a] / MESH_SIDE;
        r->end[a] = (r->box.end[a] - 1) / MESH_SIDE + 1;
    }
    for (uint32_t z = r->first[2]; z < r->end[2]; z++)
        for (uint32_t y = r->first[1]; y < r->end[1]; y++)
            for (uint32_t x = r->first[0]; x < r->end[0]; x++) {
                const uint32_t number = number_of(u->mesh, (const uint32_t[]){x, y, z});
                is_any = is_any || u->mesh->border->occupied[number] || u->mesh->brick[number];
            }
    u->regions += is_any;
    return true;
}

/* Find the stale regions; or use one box around all of them, if it has no more bricks than a
 * region. */
static bool find_regions(struct updating *u)
{
    const struct mesh *mesh = u->mesh;
    struct mesh_box all = {{UINT32_MAX, UINT32_MAX, UINT32_MAX}, {0, 0, 0}};
    size_t capacity = 0;
    bool is_one = true, made = true;
    for (uint32_t i = 0; i < mesh->regions; i++)
        for (int a = 0; a < 3 && !is_none(&mesh->stale[i]); a++) {
            const struct mesh_box *box = &mesh->stale[i];
            all.first[a] = box->first[a] < all.first[a] ? box->first[a] : all.first[a];
            all.end[a] = box->end[a] > all.end[a] ? box->end[a] : all.end[a];
        }
    if (is_none(&all))
        return true;
    for (int a = 0; a < 3; a++)
        is_one = is_one && (all.end[a] - 1) / MESH_SIDE - all.first[a] / MESH_SIDE < REGION_BRICKS;
    if (is_one)
        return add_region(u, &capacity, &all);
    for (uint32_t i = 0; i < mesh->regions && made; i++)
        made = is_none(&mesh->stale[i]) || add_region(u, &capacity, &mesh->stale[i]);
    return made;
}

static void make_share(void *context, unsigned thread)
{
    struct updating *u = context;
    struct task task = task_begin_part(u->mesh->border->scene->watch, "surface",
                                       u->regions << (3 * REGION_BITS), thread);
    for (size_t i = thread; i < u->regions; i += team_size(u->team)) {
        if (!u->mesh->scratch[thread])
            u->mesh->scratch[thread] = net_scratch_new(); /* or NULL: slower */
        make_region(u->mesh, &u->region[i], u->mesh->scratch[thread]);
        if (u->region[i].is_short || !task_advance(&task, UINT64_C(1) << (3 * REGION_BITS)))
            return;
    }
}

static void take_region(struct mesh *mesh, struct region *r, const struct mesh_listener *listener)
{
    for (uint32_t z = r->first[2]; z < r->end[2]; z++)
        for (uint32_t y = r->first[1]; y < r->end[1]; y++)
            for (uint32_t x = r->first[0]; x < r->end[0]; x++) {
                const uint32_t at[3] = {x, y, z}, number = number_of(mesh, at);
                struct mesh_brick **next = &r->brick[brick_in(at)];
                if (listener)
                    listener->replaces(listener->context, mesh, number, *next);
                mesh->bytes += brick_bytes(*next) - brick_bytes(mesh->brick[number]);
                free(mesh->brick[number]);
                mesh->brick[number] = *next;
                *next = NULL;
            }
}

bool mesh_is_current(const struct mesh *mesh, const struct border *border, enum mesh_kind kind)
{
    return mesh->border == border && mesh->version == border->version && !mesh->is_stale &&
           !is_other(mesh, border, kind);
}

enum err mesh_update(struct mesh *mesh, const struct border *border, enum mesh_kind kind,
                     struct team *team, const struct mesh_listener *listener, struct fault *fault)
{
    struct updating u = {.mesh = mesh, .team = team};
    enum err err = OK;
    if (mesh->border != border)
        err = begin_mesh(mesh, border, fault);
    else if (is_other(mesh, border, kind))
        mark_all(mesh);
    else if (mesh->version != border->version)
        mark_recounted(mesh);
    if (err || (!mesh->is_stale && mesh->version == border->version))
        return err;
    struct mesh former = *mesh;
    mesh->kind = kind;
    memcpy(mesh->opacity, border->opacity, sizeof mesh->opacity);
    memcpy(mesh->visible, border->visible, sizeof mesh->visible);
    mesh->is_cut = !cut_is_none(&border->cut);
    mesh->version = border->version;
    if (!find_regions(&u))
        err = fault_memory(fault, "a surface");
    u.team = u.regions > 1 ? team : NULL;
    if (!err)
        team_run(u.team, make_share, &u);
    for (size_t i = 0; i < u.regions && !err; i++)
        if (u.region[i].is_short)
            err = fault_memory(fault, "a surface");
    if (!err)
        err = watch_fault(border->scene->watch, fault);
    for (size_t i = 0; i < u.regions; i++) {
        if (!err)
            take_region(mesh, &u.region[i], listener);
        for (size_t b = 0; b < sizeof u.region[i].brick / sizeof *u.region[i].brick; b++)
            free(u.region[i].brick[b]);
    }
    /* Free large scratch memory: for a scene of noise it would be several times all other memory.
     * */
    for (int i = 0; i < TEAM_MOST; i++)
        if (net_scratch_bytes(mesh->scratch[i]) > MESH_SCRATCH_MOST) {
            net_scratch_free(mesh->scratch[i]);
            mesh->scratch[i] = NULL;
        }
    memcpy(former.scratch, mesh->scratch, sizeof former.scratch);
    if (err)
        *mesh = former;
    else
        memset(mesh->stale, 0, mesh->regions * sizeof *mesh->stale);
    mesh->is_stale = err != OK;
    mesh->is_lost = mesh->is_lost && err;
    free(u.region);
    return err;
}
