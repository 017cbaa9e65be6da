/* SPDX-License-Identifier: MIT */
#include "engine/surface.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "base/sort.h"
#include "engine/net_graph.h"

enum {
    BOX = 64, /* largest side of a box whose nets are computed at once */
    CORNERS = 8,
};
static const size_t POINTS_MOST = INT32_MAX;
static const uint32_t NO_SPOT = UINT32_MAX;

struct extent {
    int32_t first[3], end[3];
};

struct quad {
    uint32_t corner[4]; /* points */
    uint32_t voxel;     /* its index, mod 2^32 */
    uint8_t face;
};

/* A position shared by all labels that meet there: in a cube, the crossings between voxels that
 * differ, as far as they are connected through the vertices of nets. */
struct spot {
    uint64_t cube;
    int32_t sum[3]; /* sum of positions from the centre of the cube's first voxel, in SURFACE_ONE */
    uint8_t count;
    uint8_t air; /* the part of air that defines the position; 0 for none */
};

struct making {
    const uint32_t *size;
    uint8_t *label; /* [z][y][x] */
    struct extent extent[256];
    uint64_t voxels[256];
    uint8_t of; /* the label whose net is computed; 0: all together */
    const struct surface_choice *choice;
    bool has_spots, box_has_spots; /* surfaces may meet, in the scene or in a box */
    struct surface *surface;
    size_t point_room;
    uint32_t *spot_of; /* [points]; NO_SPOT: it stays at the position of its label's net */
    size_t spot_of_room;
    struct quad *quad;
    size_t quads, quad_room;
    struct net_scratch *scratch;
    struct lookup sewn;    /* vertices at the sides of boxes: points */
    struct lookup numbers; /* numbers of spots */
    struct spot *spot;
    size_t spots, spot_room;
    struct task task;
    struct fault *fault;
};

/* ---- labels ---- */

static enum err read_labels(struct making *m, const struct surface_source *source,
                            struct watch *watch)
{
    const uint32_t *size = source->size;
    size_t row = 0;
    size_t voxels = 0;
    if (!size_multiply(size[0], size[1], &row) || !size_multiply(row, size[2], &voxels))
        return fault_memory(m->fault, "a surface");
    m->size = size;
    m->label = mem_array(voxels + 1, 1);
    if (!m->label)
        return fault_memory(m->fault, "a surface");
    struct task task = task_begin(watch, "looking at labels", voxels);
    for (uint32_t z = 0; z < size[2]; z++)
        for (uint32_t y = 0; y < size[1] && task_advance(&task, size[0]); y++) {
            uint8_t *label = m->label + z * row + (size_t)y * size[0];
            source->row(source->context, y, z, label);
            for (uint32_t x = 0; x < size[0]; x++) {
                label[x] = m->choice->wanted[label[x]] ? label[x] : 0;
                struct extent *e = &m->extent[label[x]];
                const int32_t at[3] = {(int32_t)x, (int32_t)y, (int32_t)z};
                for (int a = 0; a < 3 && label[x]; a++) {
                    e->first[a] = !m->voxels[label[x]] || at[a] < e->first[a] ? at[a] : e->first[a];
                    e->end[a] = at[a] >= e->end[a] ? at[a] + 1 : e->end[a];
                }
                m->voxels[label[x]]++;
            }
        }
    return watch_fault(watch, m->fault);
}

/* The labels of a row of voxels; NULL outside the scene. */
static const uint8_t *row_at(const struct making *m, int32_t y, int32_t z)
{
    const bool is_row = y >= 0 && z >= 0 && (uint32_t)y < m->size[1] && (uint32_t)z < m->size[2];
    return is_row ? m->label + ((size_t)z * m->size[1] + (size_t)y) * m->size[0] : NULL;
}

static void net_row(void *context, int32_t x, int32_t y, int32_t z, uint32_t count, uint16_t *voxel)
{
    const struct making *m = context;
    const uint8_t *label = row_at(m, y, z);
    for (uint32_t i = 0; i < count; i++, x++) {
        const bool is_in = label && x >= 0 && (uint32_t)x < m->size[0];
        voxel[i] = !is_in ? NET_CLOSED : !m->of || label[x] == m->of ? label[x] : 0;
    }
}

/* Number of a cube, counted from one before the scene. */
static uint64_t cube_number(const struct making *m, const int32_t cube[3])
{
    uint64_t number = 0;
    for (int a = 2; a >= 0; a--)
        number = number * (m->size[a] + 2) + (uint64_t)(cube[a] + 1);
    return number;
}

/* ---- spots ---- */

/* Crossings of a cube between corners of `part` and others of `object`: one bit for each edge, 4 *
 * axis and so on. */
static unsigned crossings_of(unsigned part, unsigned object)
{
    unsigned crossings = 0, bit = 0;
    for (unsigned a = 0; a < 3; a++)
        for (unsigned c = 0; c < CORNERS; c++) {
            const unsigned other = c | 1u << a;
            if (other == c)
                continue;
            const bool crosses =
                (part >> c & 1 && object >> other & 1) || (part >> other & 1 && object >> c & 1);
            crossings |= (unsigned)crosses << bit++;
        }
    return crossings;
}

/* Add all crossings that share a position with the given ones, in a cube of these labels. */
static unsigned share_place(unsigned crossings, const uint8_t label[CORNERS])
{
    for (unsigned before = 0; before != crossings;) {
        before = crossings;
        for (unsigned c = 0; c < CORNERS; c++) {
            /* The nets with vertices here: of each label; and of all, whose object is everything
             * but air. */
            unsigned set = 0;
            for (unsigned k = 0; k < CORNERS; k++)
                set |= (unsigned)(label[k] == label[c]) << k;
            const unsigned object = label[c] ? set : ~set & 0xff;
            const struct net_cube *cube = &net_cubes()[~object & 0xff];
            for (unsigned p = 0; p < cube->count; p++) {
                const unsigned of = crossings_of(cube->part[p].air, object);
                crossings |= of & crossings ? of : 0;
            }
        }
    }
    return crossings;
}

/* Number of the spot of a vertex of the current net; NO_SPOT without memory. */
static uint32_t spot_of(struct making *m, const struct net_vertex *vertex)
{
    const uint64_t cube = cube_number(m, vertex->cube);
    uint8_t label[CORNERS];
    unsigned object = 0;
    bool is_alone = true;
    for (unsigned c = 0; c < CORNERS; c++) {
        const int32_t x = vertex->cube[0] + (int32_t)(c & 1);
        const uint8_t *row =
            row_at(m, vertex->cube[1] + (int32_t)(c >> 1 & 1), vertex->cube[2] + (int32_t)(c >> 2));
        label[c] = row && x >= 0 && (uint32_t)x < m->size[0] ? row[x] : 0;
        object |= (unsigned)(m->of ? label[c] == m->of : label[c] != 0) << c;
    }
    for (unsigned c = 0, one = 0; c < CORNERS; c++) {
        is_alone &= !label[c] || !one || label[c] == one;
        one = label[c] ? label[c] : one;
    }
    unsigned crossings = crossings_of(vertex->air, object);
    if (!is_alone)
        crossings = share_place(crossings, label);
    uint32_t *number = lookup_at(&m->numbers, cube << 12 | crossings);
    if (!number)
        return NO_SPOT;
    if (*number == LOOKUP_NEW) {
        if (!mem_grow(&m->spot, &m->spot_room, m->spots + 1, sizeof *m->spot))
            return NO_SPOT;
        m->spot[m->spots] = (struct spot){.cube = cube};
        *number = (uint32_t)m->spots++;
    }
    return *number;
}

/* Air defines the position of a spot, the first part of several; without air all labels do. */
static void add_to_spot(struct spot *spot, const struct net_vertex *vertex, bool is_air)
{
    if (!is_air && spot->air)
        return;
    if (is_air) {
        if (spot->air && spot->air <= vertex->air)
            return;
        spot->air = vertex->air;
        memset(spot->sum, 0, sizeof spot->sum);
        spot->count = 0;
    }
    for (int a = 0; a < 3; a++)
        spot->sum[a] += vertex->at[a];
    spot->count++;
}

/* ---- points and quads ---- */

/* Add the point of a vertex; UINT32_MAX without memory. */
static uint32_t add_point(struct making *m, const struct net_vertex *vertex,
                          const struct extent *box)
{
    struct surface *s = m->surface;
    const size_t points = s->points;
    uint32_t *sewn = NULL;
    bool is_at_side = false;
    for (int i = 0; i < 3; i++)
        is_at_side |= vertex->cube[i] < box->first[i] || vertex->cube[i] + 1 >= box->end[i];
    if (is_at_side) {
        sewn = lookup_at(&m->sewn, cube_number(m, vertex->cube) << 8 | vertex->air);
        if (!sewn || *sewn != LOOKUP_NEW)
            return sewn ? *sewn : UINT32_MAX;
    }
    if (!mem_grow(&s->point, &m->point_room, points + 1, sizeof *s->point))
        return UINT32_MAX;
    for (int a = 0; a < 3; a++)
        s->point[points].at[a] = (uint32_t)((vertex->cube[a] + 1) * SURFACE_ONE + vertex->at[a]);
    if (m->has_spots) {
        if (!mem_grow(&m->spot_of, &m->spot_of_room, points + 1, sizeof *m->spot_of))
            return UINT32_MAX;
        m->spot_of[points] = m->box_has_spots ? spot_of(m, vertex) : NO_SPOT;
        if (m->box_has_spots && m->spot_of[points] == NO_SPOT)
            return UINT32_MAX;
        if (m->box_has_spots)
            add_to_spot(&m->spot[m->spot_of[points]], vertex, false);
    }
    if (sewn)
        *sewn = (uint32_t)points;
    s->points++;
    return (uint32_t)points;
}

static bool add_net(struct making *m, const struct net *net, const struct extent *box)
{
    OWNED(mem_release) uint32_t *point = mem_array(net->vertices + (size_t)1, sizeof *point);
    bool fits = point && mem_grow(&m->quad, &m->quad_room, m->quads + net->quads, sizeof *m->quad);
    for (uint32_t v = 0; fits && v < net->vertices; v++) {
        point[v] = add_point(m, &net->vertex[v], box);
        fits = point[v] != UINT32_MAX;
    }
    for (uint32_t q = 0; fits && q < net->quads; q++) {
        const struct net_quad *from = &net->quad[q];
        struct quad *to = &m->quad[m->quads++];
        to->face = from->face;
        to->voxel = (uint32_t)from->voxel[0] +
                    m->size[0] * ((uint32_t)from->voxel[1] + m->size[1] * (uint32_t)from->voxel[2]);
        for (int k = 0; k < 4; k++)
            to->corner[k] = point[from->corner[k]];
    }
    return fits;
}

/* Add the positions of all labels together next to air, as in pictures. */
static bool add_outside(struct making *m, const struct net *net)
{
    for (uint32_t v = 0; v < net->vertices; v++) {
        const uint32_t spot = spot_of(m, &net->vertex[v]);
        if (spot == NO_SPOT)
            return false;
        add_to_spot(&m->spot[spot], &net->vertex[v], true);
    }
    return true;
}

/* True if several labels are in a box or near enough to move vertices in it; if not, the net of one
 * is that of all together. */
static bool holds_several(const struct making *m, const struct extent *box)
{
    struct extent near;
    uint8_t one = 0;
    for (int a = 0; a < 3; a++) {
        const int32_t first = box->first[a] - NET_MARGIN, end = box->end[a] + NET_MARGIN;
        near.first[a] = first > 0 ? first : 0;
        near.end[a] = end < (int32_t)m->size[a] ? end : (int32_t)m->size[a];
    }
    for (int32_t z = near.first[2]; z < near.end[2]; z++)
        for (int32_t y = near.first[1]; y < near.end[1]; y++) {
            const uint8_t *row = row_at(m, y, z);
            for (int32_t x = near.first[0]; x < near.end[0]; x++) {
                if (row[x] && one && row[x] != one)
                    return true;
                one = row[x] ? row[x] : one;
            }
        }
    return false;
}

/* Compute the nets of the boxes of an extent: of the label m->of, or of all together; either for
 * spots next to air, or for points and quads. */
static enum err add_nets(struct making *m, const struct extent *extent, bool adds_spots)
{
    static const uint32_t any_scale = 1 << 12;
    const struct net_source source = {net_row,
                                      m,
                                      {any_scale, any_scale, any_scale},
                                      .is_cubes = m->choice->is_cubes,
                                      .scratch = m->scratch};
    int32_t side[3];
    struct extent box;
    lookup_clear(&m->sewn);
    for (int a = 0; a < 3; a++) {
        const int32_t length = extent->end[a] - extent->first[a];
        const int32_t boxes = (length + BOX - 1) / BOX;
        side[a] = (length + boxes - 1) / boxes;
    }
    for (box.first[2] = extent->first[2]; box.first[2] < extent->end[2]; box.first[2] += side[2])
        for (box.first[1] = extent->first[1]; box.first[1] < extent->end[1];
             box.first[1] += side[1])
            for (box.first[0] = extent->first[0]; box.first[0] < extent->end[0];
                 box.first[0] += side[0]) {
                OWNED(net_release) struct net net = {0};
                uint32_t size[3];
                size_t voxels = 1;
                for (int a = 0; a < 3; a++) {
                    const int32_t end = box.first[a] + side[a];
                    box.end[a] = end < extent->end[a] ? end : extent->end[a];
                    size[a] = (uint32_t)(box.end[a] - box.first[a]);
                    voxels *= size[a];
                }
                if (!task_advance(&m->task, voxels))
                    return watch_fault(m->task.watch, m->fault);
                m->box_has_spots = m->has_spots && holds_several(m, &box);
                if (adds_spots && !m->box_has_spots)
                    continue;
                TRY(net_make(&net, &source, box.first, size, m->fault));
                if (adds_spots ? !add_outside(m, &net) : !add_net(m, &net, &box))
                    return fault_memory(m->fault, "a surface");
                if (m->surface->points > POINTS_MOST)
                    return fault_set(m->fault, ERR_LIMIT,
                                     "the surface has more than 2147483647 points; save labels one "
                                     "by one (label=)");
            }
    return OK;
}

/* ---- sheets that touch ---- */

/* The quads around each point of a part: corner 4 * quad + k at its point. */
struct around {
    uint32_t *first; /* [points + 1] */
    uint32_t *corner;
};

static bool find_around(struct around *around, const struct making *m, size_t points,
                        size_t first_point, size_t first_quad)
{
    const size_t quads = m->quads - first_quad;
    around->first = mem_array(points + 2, sizeof *around->first);
    around->corner = mem_array(4 * quads + 1, sizeof *around->corner);
    if (!around->first || !around->corner)
        return false;
    memset(around->first, 0, (points + 2) * sizeof *around->first);
    for (size_t i = 0; i < 4 * quads; i++)
        around->first[m->quad[first_quad + i / 4].corner[i % 4] - first_point + 2]++;
    for (size_t p = 0; p < points; p++)
        around->first[p + 2] += around->first[p + 1];
    for (size_t i = 0; i < 4 * quads; i++)
        around
            ->corner[around->first[m->quad[first_quad + i / 4].corner[i % 4] - first_point + 1]++] =
            (uint32_t)i;
    return true;
}

/* The next corner around a point: its quad is the other one at the edge that leaves the point
 * there; of four, the one of the same voxel. */
static unsigned next_around(const struct quad *quad, const uint32_t *corner, unsigned count,
                            unsigned at)
{
    const struct quad *of = &quad[corner[at] / 4];
    const uint32_t end = of->corner[(corner[at] + 1) % 4];
    unsigned next = at;
    for (unsigned i = 0; i < count; i++) {
        const struct quad *other = &quad[corner[i] / 4];
        if (other->corner[(corner[i] + 3) % 4] == end && (next == at || other->voxel == of->voxel))
            next = i;
    }
    return next;
}

/* Split a point of several fans into several. */
static enum err split_fans(struct making *m, const struct surface_part *part, size_t first_quad)
{
    struct surface *s = m->surface;
    const size_t points = s->points - part->point;
    struct around around = {NULL, NULL};
    struct quad *quad = m->quad + first_quad;
    bool fits = find_around(&around, m, points, part->point, first_quad);
    for (size_t p = 0; fits && p < points; p++) {
        const uint32_t *corner = around.corner + around.first[p];
        const unsigned count = around.first[p + 1] - around.first[p];
        unsigned left = (1u << count) - 1;
        if (count < 6) /* a fan has three or more */
            continue;
        for (unsigned at = 0; left & 1u << at; at = next_around(quad, corner, count, at))
            left &= ~(1u << at);
        for (unsigned start = 0; fits && start < count; start++) {
            if (!(left >> start & 1))
                continue;
            fits = mem_grow(&s->point, &m->point_room, s->points + 1, sizeof *s->point) &&
                   (!m->has_spots ||
                    mem_grow(&m->spot_of, &m->spot_of_room, s->points + 1, sizeof *m->spot_of));
            if (!fits)
                break;
            s->point[s->points] = s->point[part->point + p];
            if (m->has_spots)
                m->spot_of[s->points] = m->spot_of[part->point + p];
            unsigned fan = 0;
            for (unsigned at = start; !(fan >> at & 1); at = next_around(quad, corner, count, at))
                fan |= 1u << at;
            left &= ~fan;
            for (unsigned i = 0; i < count; i++)
                if (fan >> i & 1)
                    quad[corner[i] / 4].corner[corner[i] % 4] = (uint32_t)s->points;
            s->points++;
        }
    }
    free(around.first);
    free(around.corner);
    return fits ? OK : fault_memory(m->fault, "a surface");
}

/* ---- parts ---- */

static enum err add_part(struct making *m, const struct extent *extent, uint64_t voxels)
{
    struct surface *s = m->surface;
    const size_t first_quad = m->quads;
    struct surface_part *part = &s->part[s->parts++];
    *part = (struct surface_part){
        .label = m->of ? m->of : 1, .point = s->points, .triangle = 2 * m->quads, .voxels = voxels};
    enum err err = add_nets(m, extent, false);
    if (!err)
        err = split_fans(m, part, first_quad);
    part->points = s->points - part->point;
    part->triangles = 2 * (m->quads - first_quad);
    return err;
}

static enum err add_parts(struct making *m, struct watch *watch)
{
    struct extent all = {.first = {INT32_MAX, INT32_MAX, INT32_MAX}};
    uint64_t voxels = 0, boxes = 0; /* voxels to process */
    unsigned labels = 0;
    for (unsigned l = 1; l < 256; l++) {
        const struct extent *e = &m->extent[l];
        uint64_t box = 1;
        if (!m->voxels[l])
            continue;
        for (int a = 0; a < 3; a++) {
            box *= (uint64_t)(e->end[a] - e->first[a]);
            all.first[a] = all.first[a] < e->first[a] ? all.first[a] : e->first[a];
            all.end[a] = all.end[a] > e->end[a] ? all.end[a] : e->end[a];
        }
        boxes += box;
        voxels += m->voxels[l];
        labels++;
    }
    m->task = task_begin(watch, "surface", boxes);
    if (!labels)
        return OK;
    if (m->choice->joins)
        return add_part(m, &all, voxels);
    m->has_spots = labels > 1;
    TRY(m->has_spots ? add_nets(m, &all, true) : OK);
    for (unsigned l = 1; l < 256; l++) {
        m->of = (uint8_t)l;
        if (m->voxels[l])
            TRY(add_part(m, &m->extent[l], m->voxels[l]));
    }
    return OK;
}

/* Move points to their spots if there are several labels. */
static void place_points(struct making *m)
{
    struct surface *s = m->surface;
    for (size_t p = 0; m->has_spots && p < s->points; p++) {
        if (m->spot_of[p] == NO_SPOT)
            continue;
        const struct spot *spot = &m->spot[m->spot_of[p]];
        uint64_t cube = spot->cube;
        for (int a = 0; a < 3; a++) {
            s->point[p].at[a] = (uint32_t)((int64_t)(cube % (m->size[a] + 2)) * SURFACE_ONE +
                                           spot->sum[a] / spot->count);
            cube /= m->size[a] + 2;
        }
    }
}

/* Release all but points and quads. */
static void release_making(struct making *m)
{
    net_scratch_free(m->scratch);
    free(m->label);
    free(m->spot_of);
    free(m->spot);
    lookup_release(&m->sewn);
    lookup_release(&m->numbers);
    m->scratch = NULL;
    m->label = NULL;
    m->spot_of = NULL;
    m->spot = NULL;
}

enum err surface_new(struct surface **surface, const struct surface_source *source,
                     const struct surface_choice *choice, struct watch *watch, struct fault *fault)
{
    struct making *m = mem_new(sizeof *m);
    *surface = mem_new(sizeof **surface);
    enum err err = m && *surface ? OK : fault_memory(fault, "a surface");
    if (!err) {
        m->surface = *surface;
        m->choice = choice;
        m->scratch = net_scratch_new();
        m->fault = fault;
        err = m->scratch ? read_labels(m, source, watch) : fault_memory(fault, "a surface");
    }
    if (!err)
        err = add_parts(m, watch);
    if (!err) {
        place_points(m);
        release_making(m);
        struct surface *s = m->surface;
        s->triangles = 2 * m->quads;
        s->triangle = mem_array(s->triangles + 1, sizeof *s->triangle);
        for (size_t q = 0; s->triangle && q < m->quads; q++) {
            const struct quad *quad = &m->quad[q];
            int32_t at[4][3];
            for (int k = 0; k < 4; k++)
                for (int a = 0; a < 3; a++)
                    at[k][a] = (int32_t)s->point[quad->corner[k]].at[a];
            const unsigned d = net_diagonal(at, quad->face);
            for (unsigned k = 0; k < 6; k++)
                s->triangle[2 * q + k / 3].point[k % 3] =
                    quad->corner[(d + k - (k > 2 ? 1 : 0)) % 4];
        }
        err = s->triangle ? OK : fault_memory(fault, "a surface");
    }
    if (m) {
        release_making(m);
        free(m->quad);
    }
    free(m);
    if (err) {
        surface_free(*surface);
        *surface = NULL;
    }
    return err;
}

void surface_free(struct surface *surface)
{
    if (surface) {
        free(surface->point);
        free(surface->triangle);
    }
    free(surface);
}
