#include "render/mesh.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "render/view.h"

enum {
    REGION_BITS = 6, /* voxels a side of what one net is made of, at most */
    REGION_BRICKS = 1 << (REGION_BITS - BORDER_BLOCK_BITS),
    FAR = NET_MARGIN, /* voxels from a change to what may change with it */
};

/* ---- bricks ---- */

static void free_brick(struct mesh_brick *brick)
{
    if (!brick)
        return;
    free(brick->vertex);
    free(brick->quad);
    free(brick);
}

static size_t brick_bytes(const struct mesh_brick *brick)
{
    return brick ? sizeof *brick + brick->vertices * sizeof *brick->vertex +
                       brick->quads * sizeof *brick->quad
                 : 0;
}

void mesh_release(struct mesh *mesh)
{
    for (uint32_t i = 0; i < mesh->bricks && mesh->brick; i++)
        free_brick(mesh->brick[i]);
    free(mesh->brick);
    free(mesh->stale);
    for (int i = 0; i < TEAM_MOST; i++)
        net_scratch_free(mesh->scratch[i]);
    *mesh = (struct mesh){0};
}

size_t mesh_bytes(const struct mesh *mesh)
{
    return mesh->bytes + mesh->bricks * sizeof *mesh->brick + mesh->regions * sizeof *mesh->stale;
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

const struct mesh_quad *mesh_find(const struct mesh *mesh, const struct mesh_brick **brick,
                                  uint32_t *number, uint32_t cell, unsigned face)
{
    enum { LAST = MESH_SIDE - 1 };
    const struct place p = grid_place(&mesh->border->scene->grid, cell);
    const uint32_t row = (p.z & LAST) * MESH_SIDE + (p.y & LAST);
    const unsigned key = (row * MESH_SIDE + (p.x & LAST)) * 8 + face;
    *number =
        ((p.z / MESH_SIDE) * mesh->size[1] + p.y / MESH_SIDE) * mesh->size[0] + p.x / MESH_SIDE;
    *brick = mesh->brick[*number];
    if (!*brick)
        return NULL;
    const struct mesh_quad *end = (*brick)->quad + (*brick)->row[row + 1];
    for (const struct mesh_quad *q = (*brick)->quad + (*brick)->row[row]; q < end; q++)
        if (q->key == key)
            return q;
    return NULL;
}

/* ---- nets of a region ---- */

/* What quads of a net are of: all opaque labels, or a translucent one. */
enum { OPAQUE = 0 };

static bool has_own_net(const struct mesh *mesh, uint8_t label)
{
    return (mesh->kind & MESH_APART) || mesh->border->opacity[label] < BORDER_OPAQUE;
}

struct group_source {
    const struct border *border;
    uint8_t group[256]; /* of each visible label */
    uint8_t wanted;
};

static void read_row(void *context, int32_t x, int32_t y, int32_t z, uint32_t count,
                     uint16_t *voxel)
{
    const struct group_source *s = context;
    const struct border *border = s->border;
    const struct grid *grid = &border->scene->grid;
    const bool is_cut = !cut_is_none(&border->cut);
    const bool is_inside =
        y >= 0 && z >= 0 && y < (int32_t)grid->size[1] && z < (int32_t)grid->size[2];
    for (uint32_t i = 0; i < count; i++) {
        const int32_t at = x + (int32_t)i;
        voxel[i] = NET_CLOSED;
        if (!is_inside || at < 0 || at >= (int32_t)grid->size[0])
            continue;
        const uint32_t cell = grid_cell(grid, (uint32_t)at, (uint32_t)y, (uint32_t)z);
        const bool is_shown = border_shows(border, cell);
        voxel[i] = 0;
        if (!is_shown && !is_cut)
            continue;
        const uint8_t label = labels_at(&border->labels, cell);
        if (border->visible[label] && s->group[label] == s->wanted)
            voxel[i] = is_shown ? label : NET_CLOSED;
    }
}

/* Voxels of a region whose quads are made anew, and the bricks that come of it. */
struct region {
    struct mesh_box box;
    uint32_t first[3], end[3]; /* the bricks in which these voxels lie */
    struct mesh_brick *brick[REGION_BRICKS * REGION_BRICKS * REGION_BRICKS]; /* [z][y][x] */
    enum err err;
};

static uint32_t brick_in(const uint32_t brick[3])
{
    return ((brick[2] % REGION_BRICKS) * REGION_BRICKS + brick[1] % REGION_BRICKS) * REGION_BRICKS +
           brick[0] % REGION_BRICKS;
}

/* Where the groups of a region lie: of each, the voxels it is between. */
struct extent {
    int32_t first[3], last[3];
    bool is_there;
};

static void find_extents(const struct mesh *mesh, const struct region *r, const uint8_t group[256],
                         struct extent extent[256])
{
    const struct border *border = mesh->border;
    const struct grid *grid = &border->scene->grid;
    const bool has_walls = (mesh->kind & MESH_APART) || border_is_translucent(border);
    const uint32_t *first = r->box.first, *end = r->box.end;
    memset(extent, 0, 256 * sizeof *extent);
    for (uint32_t z = first[2]; z < end[2]; z++)
        for (uint32_t y = first[1]; y < end[1]; y++) {
            const uint32_t row = grid_cell(grid, first[0], y, z);
            for (uint32_t x = first[0]; x < end[0]; x++) {
                const uint32_t cell = row + x - first[0];
                if (!(has_walls ? border_shows(border, cell) : border_holds(border, cell)))
                    continue;
                const uint8_t label = labels_at(&border->labels, cell);
                struct extent *e = &extent[group[label]];
                const int32_t at[3] = {(int32_t)x, (int32_t)y, (int32_t)z};
                for (int a = 0; a < 3; a++) {
                    e->first[a] = e->is_there && e->first[a] < at[a] ? e->first[a] : at[a];
                    e->last[a] = e->is_there && e->last[a] > at[a] ? e->last[a] : at[a];
                }
                e->is_there = true;
            }
        }
}

/* Quads of a net that are of one brick. */
struct sorting {
    uint32_t *order; /* numbers of quads, brick by brick */
    uint32_t count[REGION_BRICKS * REGION_BRICKS * REGION_BRICKS + 1];
    uint32_t *local; /* of vertices: their number in the brick at hand, */
    uint32_t *of;    /* and which brick that is, counted from 1 */
};

static uint32_t brick_of(const struct net_quad *q)
{
    const uint32_t brick[3] = {(uint32_t)q->voxel[0] / MESH_SIDE, (uint32_t)q->voxel[1] / MESH_SIDE,
                               (uint32_t)q->voxel[2] / MESH_SIDE};
    return brick_in(brick);
}

static bool grow(struct mesh_brick **brick, uint32_t quads)
{
    if (!*brick)
        *brick = mem_new(sizeof **brick);
    if (!*brick)
        return false;
    struct mesh_brick *b = *brick;
    struct mesh_quad *quad = mem_array(b->quads + quads, sizeof *quad);
    struct mesh_vertex *vertex = mem_array(b->vertices + 4 * quads, sizeof *vertex);
    if (!quad || !vertex) {
        free(quad);
        free(vertex);
        return false;
    }
    if (b->quads) {
        memcpy(quad, b->quad, b->quads * sizeof *quad);
        memcpy(vertex, b->vertex, b->vertices * sizeof *vertex);
    }
    free(b->quad);
    free(b->vertex);
    b->quad = quad;
    b->vertex = vertex;
    return true;
}

/* Adds quads of a net to a brick. */
static bool add_quads(struct mesh_brick **brick, const struct net *net, const uint32_t *order,
                      uint32_t count, struct sorting *s, uint32_t number)
{
    enum { LAST = MESH_SIDE - 1 };
    if (!grow(brick, count))
        return false;
    struct mesh_brick *b = *brick;
    for (uint32_t i = 0; i < count; i++) {
        const struct net_quad *from = &net->quad[order[i]];
        const int32_t *v = from->voxel;
        struct mesh_quad *q = &b->quad[b->quads++];
        const int at = (v[0] & LAST) + MESH_SIDE * ((v[1] & LAST) + MESH_SIDE * (v[2] & LAST));
        *q = (struct mesh_quad){.key = (uint16_t)(at * 8 + from->face),
                                .label = from->label,
                                .is_closed = from->is_closed};
        for (int k = 0; k < 4; k++) {
            const uint32_t c = from->corner[k];
            if (s->of[c] != number) {
                const struct net_vertex *n = &net->vertex[c];
                struct mesh_vertex *out = &b->vertex[b->vertices];
                out->normal[3] = 0;
                for (int a = 0; a < 3; a++) {
                    out->at[a] = (n->cube[a] - (v[a] & ~LAST)) * NET_ONE + n->at[a];
                    out->normal[a] = n->normal[a];
                }
                s->of[c] = number;
                s->local[c] = b->vertices++;
            }
            q->corner[k] = (uint16_t)s->local[c];
        }
        int32_t place[4][3];
        for (int k = 0; k < 4; k++)
            memcpy(place[k], b->vertex[q->corner[k]].at, sizeof place[k]);
        if (net_diagonal(place, from->face) == 1)
            memcpy(q->corner, (uint16_t[]){q->corner[1], q->corner[2], q->corner[3], q->corner[0]},
                   sizeof q->corner);
    }
    return true;
}

/* Shares out a net's quads to the bricks of a region. */
static bool share_out(struct region *r, const struct net *net)
{
    enum { BRICKS = REGION_BRICKS * REGION_BRICKS * REGION_BRICKS };
    struct sorting *s = mem_new(sizeof *s);
    bool made = s != NULL;
    if (made) {
        s->order = mem_array(net->quads + 1, sizeof *s->order);
        s->local = mem_array(net->vertices + 1, sizeof *s->local);
        s->of = mem_new((net->vertices + 1) * sizeof *s->of);
        made = s->order && s->local && s->of;
    }
    for (uint32_t q = 0; made && q < net->quads; q++)
        s->count[brick_of(&net->quad[q]) + 1]++;
    for (uint32_t b = 0; made && b < BRICKS; b++)
        s->count[b + 1] += s->count[b];
    for (uint32_t q = 0; made && q < net->quads; q++)
        s->order[s->count[brick_of(&net->quad[q])]++] = q;
    for (uint32_t b = 0, first = 0; made && b < BRICKS; first = s->count[b++])
        if (s->count[b] > first)
            made = add_quads(&r->brick[b], net, s->order + first, s->count[b] - first, s, b + 1);
    if (s) {
        free(s->order);
        free(s->local);
        free(s->of);
    }
    free(s);
    return made;
}

static bool lies_in(const struct mesh_box *box, const uint32_t first[3], unsigned key)
{
    const unsigned at = key >> 3;
    const uint32_t voxel[3] = {first[0] + at % MESH_SIDE, first[1] + at / MESH_SIDE % MESH_SIDE,
                               first[2] + at / MESH_SIDE / MESH_SIDE};
    for (int a = 0; a < 3; a++)
        if (voxel[a] < box->first[a] || voxel[a] >= box->end[a])
            return false;
    return true;
}

/* Adds those of the quads that were there of which the voxels lie outside the box. */
static bool add_former(struct mesh_brick **brick, const struct mesh_brick *former,
                       const struct mesh_box *box, const uint32_t first[3])
{
    uint32_t count = 0;
    for (uint32_t q = 0; q < former->quads; q++)
        count += !lies_in(box, first, former->quad[q].key);
    if (count == 0)
        return true;
    uint32_t *number = mem_new(former->vertices * sizeof *number); /* in the new one, from 1 */
    if (!number || !grow(brick, count)) {
        free(number);
        return false;
    }
    struct mesh_brick *b = *brick;
    for (uint32_t i = 0; i < former->quads; i++) {
        if (lies_in(box, first, former->quad[i].key))
            continue;
        struct mesh_quad *q = &b->quad[b->quads++];
        *q = former->quad[i];
        for (int k = 0; k < 4; k++) {
            const uint16_t c = q->corner[k];
            if (!number[c]) {
                b->vertex[b->vertices++] = former->vertex[c];
                number[c] = b->vertices;
            }
            q->corner[k] = (uint16_t)(number[c] - 1);
        }
    }
    free(number);
    return true;
}

/* What lies outside the box in bricks of which the box is a part. */
static bool add_rest(const struct mesh *mesh, struct region *r)
{
    bool made = true;
    for (uint32_t z = r->first[2]; z < r->end[2] && made; z++)
        for (uint32_t y = r->first[1]; y < r->end[1] && made; y++)
            for (uint32_t x = r->first[0]; x < r->end[0] && made; x++) {
                const uint32_t at[3] = {x, y, z};
                const uint32_t first[3] = {x * MESH_SIDE, y * MESH_SIDE, z * MESH_SIDE};
                const struct mesh_brick *former = mesh->brick[number_of(mesh, at)];
                if (former)
                    made = add_former(&r->brick[brick_in(at)], former, &r->box, first);
            }
    return made;
}

static int by_key(const void *a, const void *b)
{
    return (int)((const struct mesh_quad *)a)->key - (int)((const struct mesh_quad *)b)->key;
}

static void finish_brick(struct mesh_brick *b)
{
    bool is_sorted = true;
    for (uint32_t q = 1; q < b->quads; q++)
        is_sorted = is_sorted && b->quad[q - 1].key < b->quad[q].key;
    if (!is_sorted)
        qsort(b->quad, b->quads, sizeof *b->quad, by_key);
    for (uint32_t q = 0, row = 0; row <= MESH_ROWS; row++) {
        while (q < b->quads && b->quad[q].key < row * MESH_SIDE * 8)
            q++;
        b->row[row] = (uint16_t)q;
    }
    struct mesh_vertex *vertex = realloc(b->vertex, b->vertices * sizeof *vertex);
    b->vertex = vertex ? vertex : b->vertex;
}

static void make_region(const struct mesh *mesh, struct region *r, struct net_scratch *scratch,
                        struct fault *fault)
{
    const struct border *border = mesh->border;
    struct group_source groups = {.border = border};
    struct net_source source = {read_row, &groups, {0}, mesh->kind & MESH_CUBES, scratch};
    struct extent *extent = mem_array(256, sizeof *extent);
    const uint64_t unit = view_unit(border->scene);
    if (!extent) {
        r->err = fault_memory(fault, "a surface");
        return;
    }
    for (int label = 1; label < 256; label++)
        groups.group[label] = has_own_net(mesh, (uint8_t)label) ? (uint8_t)label : OPAQUE;
    for (int a = 0; a < 3; a++)
        source.scale[a] = (uint32_t)((unit << 12) / border->scene->spacing_nm[a]);
    find_extents(mesh, r, groups.group, extent);
    for (int g = 0; g < 256 && !r->err; g++) {
        struct net net;
        uint32_t size[3];
        if (!extent[g].is_there)
            continue;
        groups.wanted = (uint8_t)g;
        for (int a = 0; a < 3; a++)
            size[a] = (uint32_t)(extent[g].last[a] - extent[g].first[a] + 1);
        r->err = net_make(&net, &source, extent[g].first, size, fault);
        if (r->err)
            break;
        if (!share_out(r, &net))
            r->err = fault_memory(fault, "a surface");
        net_release(&net);
    }
    if (!r->err && !add_rest(mesh, r))
        r->err = fault_memory(fault, "a surface");
    for (size_t i = 0; i < sizeof r->brick / sizeof *r->brick && !r->err; i++)
        if (r->brick[i])
            finish_brick(r->brick[i]);
    free(extent);
}

/* ---- what is stale ---- */

static uint32_t regions_along(const struct mesh *mesh, int a)
{
    return (mesh->size[a] - 1) / REGION_BRICKS + 1;
}

static struct mesh_box *box_of(struct mesh *mesh, uint32_t x, uint32_t y, uint32_t z)
{
    return &mesh->stale[((size_t)z * regions_along(mesh, 1) + y) * regions_along(mesh, 0) + x];
}

static bool is_none(const struct mesh_box *box)
{
    return box->first[0] >= box->end[0];
}

/* Quads of voxels at most FAR steps from these along each axis. */
static void mark(struct mesh *mesh, const uint32_t first[3], const uint32_t last[3])
{
    const uint32_t *size = mesh->border->scene->grid.size;
    struct mesh_box all;
    for (int a = 0; a < 3; a++) {
        all.first[a] = first[a] < FAR ? 0 : first[a] - FAR;
        all.end[a] = last[a] + FAR + 1 < size[a] ? last[a] + FAR + 1 : size[a];
    }
    for (uint32_t z = all.first[2] >> REGION_BITS; z <= (all.end[2] - 1) >> REGION_BITS; z++)
        for (uint32_t y = all.first[1] >> REGION_BITS; y <= (all.end[1] - 1) >> REGION_BITS; y++)
            for (uint32_t x = all.first[0] >> REGION_BITS; x <= (all.end[0] - 1) >> REGION_BITS;
                 x++) {
                const uint32_t at[3] = {x, y, z};
                struct mesh_box *box = box_of(mesh, x, y, z);
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

static void mark_cell(struct mesh *mesh, uint32_t cell)
{
    const struct place p = grid_place(&mesh->border->scene->grid, cell);
    const uint32_t at[3] = {p.x, p.y, p.z};
    mark(mesh, at, at);
}

static void mark_all(struct mesh *mesh)
{
    const uint32_t *size = mesh->border->scene->grid.size;
    mark(mesh, (const uint32_t[]){0, 0, 0},
         (const uint32_t[]){size[0] - 1, size[1] - 1, size[2] - 1});
}

void mesh_note(struct mesh *mesh, const struct border *border, const struct changes *changes)
{
    if (mesh->border != border)
        return;
    if (changes->everything || border->version != mesh->version + 1) {
        mesh->is_lost = true; /* mesh_update looks for itself */
        return;
    }
    for (size_t i = 0; i < changes->count; i++) {
        const struct change *c = changes->item + i;
        if (!border->visible[c->former_label] && !border->visible[c->label])
            continue;
        mark_cell(mesh, c->cell);
    }
    mesh->version = border->version;
}

/* Voxels of one row from a cell on, before another one: marks them, and says how many cells. */
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
        mark(mesh, least, most);
    return run;
}

/* After a recount: words of shown voxels that have changed, and voxels seen whose label has. */
static void mark_recounted(struct mesh *mesh)
{
    const struct border *border = mesh->border;
    const struct grid *grid = &border->scene->grid;
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
            const uint32_t at = brick->quad[q].key >> 3;
            const uint32_t cell =
                grid_cell(grid, first[0] + at % 8, first[1] + at / 8 % 8, first[2] + at / 64);
            if (labels_at(&border->labels, cell) != brick->quad[q].label)
                mark_cell(mesh, cell);
        }
    }
}

/* Whether the mesh is of other things altogether. Labels of voxels that have no quad count where
 * they are cut away, and where objects may come to have walls. */
static bool is_other(const struct mesh *mesh, const struct border *border, enum mesh_kind kind)
{
    const bool is_cut = mesh->is_cut || !cut_is_none(&border->cut);
    const bool has_walls = (kind & MESH_APART) || border_is_translucent(border);
    return mesh->kind != kind ||
           memcmp(mesh->opacity, border->opacity, sizeof mesh->opacity) != 0 ||
           (is_cut && memcmp(mesh->visible, border->visible, sizeof mesh->visible) != 0) ||
           (mesh->is_lost && (is_cut || has_walls));
}

static void take_after(struct mesh *mesh, const struct border *border, enum mesh_kind kind)
{
    mesh->kind = kind;
    memcpy(mesh->opacity, border->opacity, sizeof mesh->opacity);
    memcpy(mesh->visible, border->visible, sizeof mesh->visible);
    mesh->is_cut = !cut_is_none(&border->cut);
    mesh->version = border->version;
}

static enum err begin(struct mesh *mesh, const struct border *border, struct fault *fault)
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

/* The regions in which bricks are to be made anew. */
struct updating {
    struct mesh *mesh;
    struct region *region;
    size_t regions;
    struct team *team;
    struct fault fault[TEAM_MOST];
};

/* Whether there is something to be made of a region, or to be taken away: the bricks of its box. */
static bool find_region(struct mesh *mesh, struct region *r)
{
    bool is_any = false;
    for (int a = 0; a < 3; a++) {
        r->first[a] = r->box.first[a] / MESH_SIDE;
        r->end[a] = (r->box.end[a] - 1) / MESH_SIDE + 1;
    }
    for (uint32_t z = r->first[2]; z < r->end[2]; z++)
        for (uint32_t y = r->first[1]; y < r->end[1]; y++)
            for (uint32_t x = r->first[0]; x < r->end[0]; x++) {
                const uint32_t number = number_of(mesh, (const uint32_t[]){x, y, z});
                is_any = is_any || mesh->border->occupied[number] || mesh->brick[number];
            }
    return is_any;
}

static bool find_regions(struct updating *u)
{
    size_t capacity = 0;
    for (uint32_t i = 0; i < u->mesh->regions; i++) {
        const struct mesh_box *box = &u->mesh->stale[i];
        if (is_none(box))
            continue;
        if (!mem_grow(&u->region, &capacity, u->regions + 1, sizeof *u->region))
            return false;
        memset(&u->region[u->regions], 0, sizeof *u->region);
        u->region[u->regions].box = *box;
        u->regions += find_region(u->mesh, &u->region[u->regions]);
    }
    return true;
}

static void make_share(void *context, unsigned thread)
{
    struct updating *u = context;
    struct task task = task_begin_part(u->mesh->border->scene->watch, "surface",
                                       u->regions << (3 * REGION_BITS), thread);
    for (size_t i = thread; i < u->regions; i += team_size(u->team)) {
        if (!u->mesh->scratch[thread])
            u->mesh->scratch[thread] = net_scratch_new(); /* or NULL: then it takes longer */
        make_region(u->mesh, &u->region[i], u->mesh->scratch[thread], &u->fault[thread]);
        if (u->region[i].err || !task_advance(&task, UINT64_C(1) << (3 * REGION_BITS)))
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
                free_brick(mesh->brick[number]);
                mesh->brick[number] = *next;
                *next = NULL;
            }
}

enum err mesh_update(struct mesh *mesh, const struct border *border, enum mesh_kind kind,
                     struct team *team, const struct mesh_listener *listener, struct fault *fault)
{
    struct updating u = {.mesh = mesh, .team = team};
    enum err err = OK;
    if (mesh->border != border)
        err = begin(mesh, border, fault);
    else if (is_other(mesh, border, kind))
        mark_all(mesh);
    else if (mesh->version != border->version)
        mark_recounted(mesh);
    if (err || (!mesh->is_stale && mesh->version == border->version))
        return err;
    const struct mesh former = *mesh;
    take_after(mesh, border, kind);
    if (!find_regions(&u))
        err = fault_memory(fault, "a surface");
    u.team = u.regions > 1 ? team : NULL;
    if (!err)
        team_run(u.team, make_share, &u);
    for (size_t i = 0; i < u.regions && !err; i++)
        if (u.region[i].err) {
            err = u.region[i].err;
            fault_memory(fault, "a surface");
        }
    if (!err)
        err = watch_fault(border->scene->watch, fault);
    for (size_t i = 0; i < u.regions; i++) {
        if (!err)
            take_region(mesh, &u.region[i], listener);
        for (size_t b = 0; b < sizeof u.region[i].brick / sizeof *u.region[i].brick; b++)
            free_brick(u.region[i].brick[b]);
    }
    if (err)
        *mesh = former;
    else
        memset(mesh->stale, 0, mesh->regions * sizeof *mesh->stale);
    mesh->is_stale = err != OK;
    mesh->is_lost = mesh->is_lost && err;
    free(u.region);
    return err;
}
