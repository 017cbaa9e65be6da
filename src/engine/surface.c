#include "engine/surface.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

enum {
    NODE_MARGIN = SURFACE_ONE / 16,
    ROUNDS = 8,         /* of setting the volume, at most */
    CLOSE_ENOUGH = 4096 /* the part of the volume that may be wrong */
};
static const size_t NODES_MOST = INT32_MAX;
static const uint32_t NO_NODE = UINT32_MAX;

/* ---- nodes: the points that the surfaces of all labels share ---- */

/* Between two voxels that are neighbours along an axis. */
struct surface_node {
    uint16_t low[3]; /* the first of them, counted from 1 voxel before the scene */
    uint8_t axis;
    uint8_t label[2]; /* of the first and the second one; they differ */
    uint16_t along;   /* how far from the first to the second, 1..SURFACE_ONE - 1 */
};

/* A corner of a triangle: 2 * node + 1 where the label of the surface is that of the second voxel,
 * else 2 * node. */
struct surface_corners {
    uint32_t corner[3];
};

struct surface_nodes {
    struct surface_node *node;
    struct surface_corners *triangle; /* of all labels, as the cubes come */
    uint32_t (*segment)[2];           /* pairs of nodes that are neighbours on a surface */
    size_t nodes, triangles, segments;
    size_t node_room, triangle_room, segment_room;
    uint64_t voxels[256];
};

/* Where a node is, along one axis. */
static uint32_t surface_node_at(const struct surface_node *node, unsigned axis)
{
    return node->low[axis] * (uint32_t)SURFACE_ONE + (axis == node->axis ? node->along : 0);
}

/* The label whose surface a triangle belongs to. */
static uint8_t surface_label_of(const struct surface_nodes *nodes,
                                const struct surface_corners *triangle)
{
    return nodes->node[triangle->corner[0] / 2].label[triangle->corner[0] % 2];
}

/* ---- the cases of a cube ---- */

/*
 * How a surface passes through a cube of eight voxel centres: one case for each set of them that is
 * inside.
 *
 * Corner c of the cube has bit 0, 1, 2 where it is at the upper end of x, y, z. Edge 4 a + 2 v + u
 * runs along axis a, with u and v saying on which side it is along axes a + 1 and a + 2 (mod 3).
 *
 * On each face of the cube a segment cuts off every run of corners that are inside. So where two
 * corners at a diagonal are inside, they are cut off one by one, and the cube on the other side of
 * the face does the same: nothing stays open. Segments make closed polygons of 3 to 7 corners. Each
 * is a fan of triangles around a corner from which no diagonal lies in a face of the cube, and
 * there always is one: so no other cube has an edge between the same two nodes.
 *
 * After Lorensen and Cline, "Marching cubes" (1987), with the table made at run time from these
 * rules, as they are shorter than it.
 */
enum { FACES = 6, EDGES = 12, NO_EDGE = 255 };

struct surface_case {
    uint8_t triangles, segments;
    uint8_t triangle[5][3]; /* edges of the cube, counter-clockwise seen from outside the label */
    uint8_t segment[6][2];  /* on the three faces at the lower ends: each once in all cubes */
};

/* Face 2 a + 1 is at the upper end of axis a, face 2 a at the lower one: its corners and edges
 * counter-clockwise as seen from outside; edge i leads from corner i to the next one. */
struct face {
    uint8_t corner[4], edge[4];
};

/* The corner at the lower end of an edge; the upper one is 1 << (edge / 4) further. */
static unsigned edge_corner(unsigned edge)
{
    const unsigned u = (edge / 4 + 1) % 3, v = (edge / 4 + 2) % 3;
    return (edge & 1) << u | (edge >> 1 & 1) << v;
}

static uint8_t edge_between(unsigned corner, unsigned other)
{
    const unsigned axis = (corner ^ other) / 2; /* 1, 2, 4: 0, 1, 2 */
    const unsigned u = (axis + 1) % 3, v = (axis + 2) % 3;
    return (uint8_t)(4 * axis + 2 * (corner >> v & 1) + (corner >> u & 1));
}

static struct face face_of(unsigned number)
{
    const unsigned axis = number / 2, upper = number & 1;
    const unsigned u = 1u << (axis + 1) % 3, v = 1u << (axis + 2) % 3;
    const unsigned round[4] = {0, u, u | v, v};
    struct face face;
    for (unsigned i = 0; i < 4; i++)
        face.corner[i] = (uint8_t)(round[upper ? i : 3 - i] | upper << axis);
    for (unsigned i = 0; i < 4; i++)
        face.edge[i] = edge_between(face.corner[i], face.corner[(i + 1) % 4]);
    return face;
}

static bool share_face(unsigned edge, unsigned other)
{
    for (unsigned f = 0; f < FACES; f++) {
        const struct face face = face_of(f);
        unsigned found = 0;
        for (unsigned i = 0; i < 4; i++)
            found += face.edge[i] == edge || face.edge[i] == other;
        if (found == 2)
            return true;
    }
    return false;
}

static void make_case(struct surface_case *out, unsigned set)
{
    uint8_t next[EDGES], polygon[EDGES];
    *out = (struct surface_case){0};
    for (unsigned e = 0; e < EDGES; e++)
        next[e] = NO_EDGE;
    for (unsigned f = 0; f < FACES; f++) {
        /* The segments of a face: next[] leads from the edge where the inside ends to where it
         * began, so that polygons run clockwise as seen from outside the label. */
        const struct face face = face_of(f);
        for (unsigned i = 0; i < 4; i++) {
            unsigned first = i; /* of the run of corners inside that ends with corner i */
            if (!(set >> face.corner[i] & 1) || set >> face.corner[(i + 1) % 4] & 1)
                continue;
            while (set >> face.corner[(first + 3) % 4] & 1)
                first = (first + 3) % 4;
            const uint8_t from = face.edge[i], to = face.edge[(first + 3) % 4];
            next[from] = to;
            if (f % 2 == 0) {
                out->segment[out->segments][0] = from;
                out->segment[out->segments++][1] = to;
            }
        }
    }
    for (unsigned e = 0; e < EDGES; e++) {
        unsigned count = 0;
        for (uint8_t at = (uint8_t)e; next[at] != NO_EDGE;) {
            const uint8_t to = next[at];
            next[at] = NO_EDGE;
            polygon[count++] = at;
            at = to;
        }
        if (count) {
            /* The corner of the polygon that can be the middle of the fan. */
            unsigned middle = 0;
            for (bool fits = false; !fits; middle += !fits) {
                fits = true;
                for (unsigned i = 2; i + 1 < count && fits; i++)
                    fits = !share_face(polygon[middle], polygon[(middle + i) % count]);
            }
            for (unsigned i = 1; i + 1 < count; i++) {
                uint8_t *triangle = out->triangle[out->triangles++];
                triangle[0] = polygon[middle];
                triangle[1] = polygon[(middle + i + 1) % count];
                triangle[2] = polygon[(middle + i) % count];
            }
        }
    }
}

/* Two planes of labels with a rim of 0, and which nodes begin there: nodes[a] along axis a. */
struct plane {
    uint8_t *label;
    uint32_t *node[3];
};

struct sweep {
    const struct surface_source *source;
    struct surface_nodes *nodes;
    struct surface_case cases[256];
    size_t width, cells;   /* of a plane with its rim */
    struct plane plane[2]; /* the lower and the upper one of the cubes at hand */
    uint32_t z;            /* of the lower one, counted from 1 before the scene */
    struct fault *fault;
};

/* ---- planes ---- */

static enum err plane_init(struct plane *plane, size_t cells, struct fault *fault)
{
    plane->label = mem_new(cells);
    for (int a = 0; a < 3; a++)
        plane->node[a] = mem_array(cells, sizeof *plane->node[a]);
    return plane->label && plane->node[0] && plane->node[1] && plane->node[2]
               ? OK
               : fault_memory(fault, "a surface");
}

static void plane_release(struct plane *plane)
{
    free(plane->label);
    for (int a = 0; a < 3; a++)
        free(plane->node[a]);
}

/* The plane `z`, counted from 1 before the scene, becomes the upper one. */
static void take_plane(struct sweep *s, uint32_t z)
{
    const uint32_t *size = s->source->size;
    const struct plane former = s->plane[0];
    s->plane[0] = s->plane[1];
    s->plane[1] = former;
    for (int a = 0; a < 3; a++)
        memset(former.node[a], 0xff, s->cells * sizeof *former.node[a]); /* NO_NODE */
    if (z > size[2]) {
        memset(former.label, 0, s->cells);
        return;
    }
    for (uint32_t y = 0; y < size[1]; y++) {
        uint8_t *row = former.label + (y + 1) * s->width + 1;
        s->source->row(s->source->context, y, z - 1, row);
        for (uint32_t x = 0; x < size[0]; x++)
            s->nodes->voxels[row[x]]++;
    }
}

/* ---- a cube ---- */

static uint32_t new_node(struct sweep *s, size_t at, unsigned corner, unsigned axis,
                         const uint8_t label[8])
{
    struct surface_nodes *n = s->nodes;
    if (!mem_grow(&n->node, &n->node_room, n->nodes + 1, sizeof *n->node))
        return NO_NODE;
    n->node[n->nodes] = (struct surface_node){{(uint16_t)(at % s->width + (corner & 1)),
                                               (uint16_t)(at / s->width + (corner >> 1 & 1)),
                                               (uint16_t)(s->z + (corner >> 2))},
                                              (uint8_t)axis,
                                              {label[corner], label[corner | 1u << axis]},
                                              SURFACE_ONE / 2};
    return (uint32_t)n->nodes++;
}

/* The node on an edge of the cube, which is made where it is new; NO_NODE where that fails. */
static uint32_t node_on(struct sweep *s, size_t at, unsigned edge, const uint8_t label[8])
{
    const unsigned corner = edge_corner(edge), axis = edge / 4;
    uint32_t *node =
        &s->plane[corner >> 2].node[axis][at + (corner & 1) + (corner >> 1 & 1) * s->width];
    if (*node == NO_NODE)
        *node = new_node(s, at, corner, axis, label);
    return *node;
}

static bool add_triangle(struct surface_nodes *n, const uint32_t node[3], uint8_t label)
{
    if (!mem_grow(&n->triangle, &n->triangle_room, n->triangles + 1, sizeof *n->triangle))
        return false;
    for (int i = 0; i < 3; i++)
        n->triangle[n->triangles].corner[i] =
            2 * node[i] + (n->node[node[i]].label[1] == label ? 1 : 0);
    n->triangles++;
    return true;
}

static bool add_segment(struct surface_nodes *n, uint32_t from, uint32_t to)
{
    if (!mem_grow(&n->segment, &n->segment_room, n->segments + 1, sizeof *n->segment))
        return false;
    n->segment[n->segments][0] = from;
    n->segment[n->segments++][1] = to;
    return true;
}

/* The surface of one label in a cube. */
static bool join_nodes(struct sweep *s, size_t at, const uint8_t label[8], uint8_t of)
{
    unsigned set = 0;
    for (unsigned c = 0; c < 8; c++)
        set |= (unsigned)(label[c] == of) << c;
    const struct surface_case *now = &s->cases[set];
    uint32_t node[3];
    for (unsigned t = 0; t < now->triangles; t++) {
        for (unsigned i = 0; i < 3; i++) {
            node[i] = node_on(s, at, now->triangle[t][i], label);
            if (node[i] == NO_NODE)
                return false;
        }
        if (!add_triangle(s->nodes, node, of))
            return false;
    }
    for (unsigned i = 0; i < now->segments; i++)
        if (!add_segment(s->nodes, node_on(s, at, now->segment[i][0], label),
                         node_on(s, at, now->segment[i][1], label)))
            return false;
    return true;
}

static enum err fill_cube(struct sweep *s, size_t at)
{
    uint8_t label[8];
    for (unsigned c = 0; c < 8; c++)
        label[c] = s->plane[c >> 2].label[at + (c & 1) + (c >> 1 & 1) * s->width];
    for (unsigned c = 0; c < 8; c++) {
        bool is_first = label[c] != 0;
        for (unsigned former = 0; former < c; former++)
            is_first &= label[former] != label[c];
        if (is_first && !join_nodes(s, at, label, label[c]))
            return fault_memory(s->fault, "a surface");
    }
    if (s->nodes->nodes > NODES_MOST)
        return fault_set(s->fault, ERR_LIMIT,
                         "the labels have more than %zu faces in common; no surface is made of so "
                         "many",
                         NODES_MOST);
    return OK;
}

/* Whether no label changes in the eight cubes from here on: most of a scene is passed by that. */
static bool is_plain(const struct sweep *s, size_t at)
{
    uint64_t first, word;
    memcpy(&first, s->plane[0].label + at, sizeof first);
    for (unsigned i = 0; i < 8; i++) {
        memcpy(&word, s->plane[i >> 2].label + at + (i & 1) + (i >> 1 & 1) * s->width, sizeof word);
        if (word != first)
            return false;
    }
    return true;
}

/* ---- all of them ---- */

static enum err fill_plane(struct sweep *s, struct task *task)
{
    const size_t rows = s->source->size[1] + 1, cubes = s->source->size[0] + 1;
    for (size_t y = 0; y < rows && task_advance(task, cubes); y++)
        for (size_t x = 0; x < cubes; x++) {
            const size_t at = y * s->width + x;
            if (x + 8 <= cubes && is_plain(s, at)) {
                x += 7;
                continue;
            }
            const enum err err = fill_cube(s, at);
            if (err)
                return err;
        }
    return OK;
}

static enum err sweep(struct sweep *s, struct watch *watch)
{
    const uint32_t *size = s->source->size;
    struct task task =
        task_begin(watch, "surfaces",
                   ((uint64_t)size[0] + 1) * ((uint64_t)size[1] + 1) * ((uint64_t)size[2] + 1));
    take_plane(s, size[2] + 1); /* the rim before the scene */
    enum err err = OK;
    for (s->z = 0; s->z <= size[2] && !err && !watch_stops(watch); s->z++) {
        take_plane(s, s->z + 1);
        err = fill_plane(s, &task);
    }
    return err ? err : watch_fault(watch, s->fault);
}

static enum err make_nodes(struct surface_nodes *nodes, const struct surface_source *source,
                           struct watch *watch, struct fault *fault)
{
    struct sweep *s = mem_new(sizeof *s);
    if (!s)
        return fault_memory(fault, "a surface");
    s->source = source;
    s->nodes = nodes;
    s->fault = fault;
    s->width = (size_t)source->size[0] + 2;
    s->cells = s->width * ((size_t)source->size[1] + 2);
    for (unsigned set = 0; set < 256; set++)
        make_case(&s->cases[set], set);
    enum err err = plane_init(&s->plane[0], s->cells, fault);
    if (!err)
        err = plane_init(&s->plane[1], s->cells, fault);
    if (!err)
        err = sweep(s, watch);
    plane_release(&s->plane[0]);
    plane_release(&s->plane[1]);
    free(s);
    return err;
}

/* ---- smoothing: passes ---- */

static uint16_t within_line(int64_t along)
{
    const int64_t most = SURFACE_ONE - NODE_MARGIN;
    return (uint16_t)(along < NODE_MARGIN ? NODE_MARGIN : along > most ? most : along);
}

struct neighbours {
    int32_t sum; /* of where they are along the node's axis, from where the node's line begins */
    uint32_t count;
};

static void look_at(struct neighbours *all, const struct surface_node *node, uint32_t of,
                    uint32_t neighbour)
{
    const struct surface_node *n = &node[of];
    all[of].sum += (int32_t)(surface_node_at(&node[neighbour], n->axis) -
                             n->low[n->axis] * (uint32_t)SURFACE_ONE);
    all[of].count++;
}

/* The nodes go half the way to the means of their neighbours. */
static void pass(struct surface_nodes *nodes, struct neighbours *all, struct task *task)
{
    memset(all, 0, nodes->nodes * sizeof *all);
    for (size_t i = 0; i < nodes->segments && task_advance(task, 1); i++) {
        look_at(all, nodes->node, nodes->segment[i][0], nodes->segment[i][1]);
        look_at(all, nodes->node, nodes->segment[i][1], nodes->segment[i][0]);
    }
    if (watch_stops(task->watch))
        return;
    for (size_t i = 0; i < nodes->nodes; i++) {
        struct surface_node *node = &nodes->node[i];
        const int64_t count = all[i].count, way = all[i].sum - count * node->along;
        node->along = within_line(node->along + way / (2 * count));
    }
}

/* ---- smoothing: volumes ---- */

/* By labels, six times as much, in 2^-24 voxels; sums mod 2^64, which hold what they come to. */
struct volumes {
    uint64_t is[256];
    int64_t grows[256]; /* by each 1/256 voxel that all its nodes go outwards */
};

static void add_volume(struct volumes *volumes, const struct surface_nodes *nodes,
                       const struct surface_corners *triangle)
{
    const struct surface_node *node[3];
    int64_t at[3][3];
    const uint8_t label = surface_label_of(nodes, triangle);
    for (int i = 0; i < 3; i++) {
        node[i] = &nodes->node[triangle->corner[i] / 2];
        for (unsigned a = 0; a < 3; a++)
            at[i][a] = surface_node_at(node[i], a) >> 8;
    }
    int64_t normal[3];
    for (int a = 0; a < 3; a++) {
        const int u = (a + 1) % 3, v = (a + 2) % 3;
        normal[a] = (at[1][u] - at[0][u]) * (at[2][v] - at[0][v]) -
                    (at[1][v] - at[0][v]) * (at[2][u] - at[0][u]);
    }
    volumes->is[label] += (uint64_t)(normal[2] * (at[0][2] + at[1][2] + at[2][2]));
    for (int i = 0; i < 3; i++)
        volumes->grows[label] +=
            triangle->corner[i] % 2 ? -normal[node[i]->axis] : normal[node[i]->axis];
}

/* How far the nodes of each label are to go outwards, in SURFACE_ONE; false where no label has to
 * go any further. */
static bool find_growth(int64_t outward[256], const struct surface_nodes *nodes,
                        struct volumes *volumes, struct task *task)
{
    bool grows = false;
    memset(volumes, 0, sizeof *volumes);
    for (size_t i = 0; i < nodes->triangles && task_advance(task, 1); i++)
        add_volume(volumes, nodes, &nodes->triangle[i]);
    for (unsigned label = 1; label < 256; label++) {
        const int64_t wanted = (int64_t)(nodes->voxels[label] * 6) << 24;
        const int64_t lacks = wanted - (int64_t)volumes->is[label];
        const int64_t each = volumes->grows[label] > 0 ? volumes->grows[label] : 1;
        const int64_t way = lacks / each < -64 ? -64 : lacks / each > 64 ? 64 : lacks / each;
        outward[label] = way * 256 + (way > -64 && way < 64 ? lacks % each * 256 / each : 0);
        grows |= lacks > wanted / CLOSE_ENOUGH || -lacks > wanted / CLOSE_ENOUGH;
    }
    return grows;
}

/*
 * In each pass, every node goes half the way to the mean of its neighbours, along its line and no
 * further than to NODE_MARGIN before its ends. Then every label grows or shrinks, each node by as
 * much, until it encloses what its voxels do.
 */
static enum err smooth(struct surface_nodes *nodes, unsigned passes, struct watch *watch,
                       struct fault *fault)
{
    struct neighbours *all = mem_array(nodes->nodes + 1, sizeof *all);
    if (!all)
        return fault_memory(fault, "a surface");
    struct task task =
        task_begin(watch, "smoothing",
                   (uint64_t)passes * nodes->segments + ROUNDS * (uint64_t)nodes->triangles);
    for (unsigned i = 0; i < passes && !watch_stops(watch); i++)
        pass(nodes, all, &task);
    int64_t outward[256] = {0};
    struct volumes volumes;
    for (int round = 0; round < ROUNDS && find_growth(outward, nodes, &volumes, &task); round++)
        for (size_t i = 0; i < nodes->nodes; i++) {
            struct surface_node *node = &nodes->node[i];
            node->along =
                within_line(node->along + outward[node->label[0]] - outward[node->label[1]]);
        }
    free(all);
    return watch_fault(watch, fault);
}

/* ---- parts ---- */

static void count_parts(struct surface *surface, const struct surface_nodes *nodes,
                        const bool wanted[256])
{
    size_t points[256] = {0}, triangles[256] = {0};
    for (size_t i = 0; i < nodes->nodes; i++)
        for (int side = 0; side < 2; side++)
            points[nodes->node[i].label[side]]++;
    for (size_t i = 0; i < nodes->triangles; i++)
        triangles[surface_label_of(nodes, &nodes->triangle[i])]++;
    for (unsigned label = 1; label < 256; label++) {
        if (!wanted[label] || !triangles[label])
            continue;
        surface->part[surface->parts++] = (struct surface_part){
            .label = (uint8_t)label,
            .point = surface->points,
            .points = points[label],
            .triangle = surface->triangles,
            .triangles = triangles[label],
            .voxels = nodes->voxels[label],
        };
        surface->points += points[label];
        surface->triangles += triangles[label];
    }
}

/* Puts points and triangles of each part together, in the order of nodes and of cubes. `number` has
 * room for two numbers for each node. */
static void fill_parts(struct surface *surface, const struct surface_nodes *nodes, uint32_t *number)
{
    size_t point[256], triangle[256];
    bool is_part[256] = {false};
    for (unsigned p = 0; p < surface->parts; p++) {
        const struct surface_part *part = &surface->part[p];
        is_part[part->label] = true;
        point[part->label] = part->point;
        triangle[part->label] = part->triangle;
    }
    for (size_t i = 0; i < 2 * nodes->nodes; i++) {
        const struct surface_node *node = &nodes->node[i / 2];
        const uint8_t label = node->label[i % 2];
        if (!is_part[label])
            continue;
        for (unsigned a = 0; a < 3; a++)
            surface->point[point[label]].at[a] = surface_node_at(node, a);
        number[i] = (uint32_t)point[label]++;
    }
    for (size_t i = 0; i < nodes->triangles; i++) {
        const uint8_t label = surface_label_of(nodes, &nodes->triangle[i]);
        for (int k = 0; is_part[label] && k < 3; k++)
            surface->triangle[triangle[label]].point[k] = number[nodes->triangle[i].corner[k]];
        triangle[label] += is_part[label];
    }
}

enum err surface_new(struct surface **surface, const struct surface_source *source,
                     const bool wanted[256], unsigned passes, struct watch *watch,
                     struct fault *fault)
{
    struct surface_nodes nodes = {0};
    enum err err = make_nodes(&nodes, source, watch, fault);
    *surface = err ? NULL : mem_new(sizeof **surface);
    if (!err && !*surface)
        err = fault_memory(fault, "a surface");
    if (!err)
        err = smooth(&nodes, passes, watch, fault);
    if (!err) {
        struct surface *made = *surface;
        count_parts(made, &nodes, wanted);
        uint32_t *number = mem_array(2 * nodes.nodes + 1, sizeof *number);
        made->point = mem_array(made->points + 1, sizeof *made->point);
        made->triangle = mem_array(made->triangles + 1, sizeof *made->triangle);
        const bool fits = number && made->point && made->triangle;
        if (fits)
            fill_parts(made, &nodes, number);
        free(number);
        err = fits ? OK : fault_memory(fault, "a surface");
    }
    if (err) {
        surface_free(*surface);
        *surface = NULL;
    }
    free(nodes.node);
    free(nodes.triangle);
    free(nodes.segment);
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
