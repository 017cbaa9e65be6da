/* SPDX-License-Identifier: MIT */
/* Surface nets: a function of the labels around, closed, as large as their voxels, symmetric. */
#include <math.h>

#include "base/hash.h"
#include "engine/net.h"
#include "tests/check_main.h"
#include "tests/scarce_memory.h"

/* ---- scenes ---- */

enum { SIDE = 44 };

/* Closed outside. `turn` says which axis of the scene each axis of the net's source is, `flip` the
 * axes that run backward. */
static struct {
    int32_t side;
    uint16_t voxel[SIDE * SIDE * SIDE];
    int turn[3], flip[3];
} scene;

static uint16_t *scene_at(int32_t x, int32_t y, int32_t z)
{
    return &scene.voxel[((size_t)z * SIDE + (size_t)y) * SIDE + (size_t)x];
}

static void scene_init(int32_t side)
{
    memset(&scene, 0, sizeof scene);
    scene.side = side;
    for (int a = 0; a < 3; a++)
        scene.turn[a] = a;
}

static uint16_t scene_voxel(const int32_t p[3])
{
    int32_t q[3] = {0};
    for (int a = 0; a < 3; a++) {
        if (p[a] < 0 || p[a] >= scene.side)
            return NET_CLOSED;
        q[scene.turn[a]] = scene.flip[a] ? scene.side - 1 - p[a] : p[a];
    }
    return *scene_at(q[0], q[1], q[2]);
}

static void scene_row(void *context, int32_t x, int32_t y, int32_t z, uint32_t count,
                      uint16_t *voxel)
{
    (void)context;
    for (uint32_t k = 0; k < count; k++) {
        const int32_t at[3] = {x + (int32_t)k, y, z};
        voxel[k] = scene_voxel(at);
    }
}

/* Probabilities in 1024ths: that a voxel is of the object, with labels 1 to `labels`, and that it
 * is closed. */
static void scene_random(uint64_t seed, uint32_t inside, uint32_t labels, uint32_t closed)
{
    for (int32_t z = 0; z < scene.side; z++)
        for (int32_t y = 0; y < scene.side; y++)
            for (int32_t x = 0; x < scene.side; x++) {
                const uint64_t r = hash_mix_at(seed, (uint64_t)((z * SIDE + y) * SIDE + x));
                const uint16_t label = (uint16_t)(1 + (r >> 40) % labels);
                *scene_at(x, y, z) = r % 1024 < inside           ? label
                                     : (r >> 10) % 1024 < closed ? NET_CLOSED
                                                                 : 0;
            }
}

/* Random labels that hang together: each voxel is what most of those around it are. */
static void scene_blobs(uint64_t seed, uint32_t labels)
{
    static uint16_t next[SIDE * SIDE * SIDE];
    scene_random(seed, 560, labels, 0);
    for (int pass = 0; pass < 2; pass++) {
        memset(next, 0, sizeof next);
        for (int32_t z = 1; z + 1 < scene.side; z++)
            for (int32_t y = 1; y + 1 < scene.side; y++)
                for (int32_t x = 1; x + 1 < scene.side; x++) {
                    int count = 0;
                    uint16_t label = *scene_at(x, y, z);
                    for (int k = 0; k < 27; k++) {
                        const uint16_t is =
                            *scene_at(x - 1 + k % 3, y - 1 + k / 3 % 3, z - 1 + k / 9);
                        count += is != 0;
                        label = is ? is : label;
                    }
                    next[scene_at(x, y, z) - scene.voxel] = count > 14 ? label : 0;
                }
        memcpy(scene.voxel, next, sizeof next);
    }
}

static void scene_ball(double x, double y, double z, double radius, uint16_t label)
{
    for (int32_t k = 0; k < scene.side * scene.side * scene.side; k++) {
        const int32_t p[3] = {k % scene.side, k / scene.side % scene.side,
                              k / scene.side / scene.side};
        if (pow(p[0] - x, 2) + pow(p[1] - y, 2) + pow(p[2] - z, 2) < radius * radius)
            *scene_at(p[0], p[1], p[2]) = label;
    }
}

static struct net net_of(const int32_t first[3], const uint32_t size[3], bool is_cubes)
{
    static struct net_scratch *scratch; /* shared: nothing of one remains in the next */
    struct net net = {.vertices = 0};
    if (!scratch)
        scratch = net_scratch_new();
    const struct net_source source = {
        .row = scene_row, .scale = {4096, 4096, 4096}, .is_cubes = is_cubes, .scratch = scratch};
    CHECK(net_make(&net, &source, first, size, NULL) == OK);
    return net;
}

static struct net net_of_scene(bool is_cubes)
{
    const uint32_t side = (uint32_t)scene.side;
    return net_of((const int32_t[]){0, 0, 0}, (const uint32_t[]){side, side, side}, is_cubes);
}

/* ---- figures ---- */

static double place_of(const struct net_vertex *v, int axis)
{
    return v->cube[axis] + v->at[axis] / (double)NET_ONE;
}

/* Of the volume that the quads enclose, as the mean of both ways to split each quad. */
static double volume_of(const struct net *net)
{
    static const int split[4][3] = {{0, 1, 2}, {0, 2, 3}, {0, 1, 3}, {1, 2, 3}};
    double sum = 0;
    for (uint32_t q = 0; q < net->quads; q++)
        for (int t = 0; t < 4; t++) {
            double p[3][3];
            for (int k = 0; k < 9; k++)
                p[k / 3][k % 3] =
                    place_of(&net->vertex[net->quad[q].corner[split[t][k / 3]]], k % 3);
            for (int k = 0; k < 3; k++)
                sum += p[0][k] * (p[1][(k + 1) % 3] * p[2][(k + 2) % 3] -
                                  p[1][(k + 2) % 3] * p[2][(k + 1) % 3]);
        }
    return sum / 12;
}

static int by_edge(const void *a, const void *b)
{
    const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

/* Edges that run one way more often than the other. */
static size_t lonely_edges(const struct net *net)
{
    size_t count = 0, lonely = 0;
    OWNED(mem_release) uint64_t *edge = calloc((size_t)net->quads * 4 + 1, sizeof *edge);
    for (uint32_t q = 0; q < net->quads; q++)
        for (int k = 0; k < 4; k++) {
            const uint64_t a = net->quad[q].corner[k], b = net->quad[q].corner[(k + 1) % 4];
            edge[count++] = (a < b ? a << 32 | b : b << 32 | a) << 1 | (a < b);
        }
    qsort(edge, count, sizeof *edge, by_edge);
    for (size_t k = 0; k < count;) {
        int64_t balance = 0;
        const uint64_t of = edge[k] >> 1;
        for (; k < count && edge[k] >> 1 == of; k++)
            balance += edge[k] & 1 ? 1 : -1;
        lonely += balance != 0;
    }
    return lonely;
}

/* ---- N1 ---- */

/* By place, then by a number. */
static int by_both(const int32_t x[3], unsigned of_x, const int32_t y[3], unsigned of_y)
{
    for (int k = 2; k >= 0; k--)
        if (x[k] != y[k])
            return x[k] < y[k] ? -1 : 1;
    return (of_x > of_y) - (of_x < of_y);
}

static int by_quad(const void *a, const void *b)
{
    const struct net_quad *x = a, *y = b;
    return by_both(x->voxel, x->face, y->voxel, y->face);
}

static bool is_same_vertex(const struct net_vertex *a, const struct net_vertex *b)
{
    return memcmp(a->cube, b->cube, sizeof a->cube) == 0 &&
           memcmp(a->at, b->at, sizeof a->at) == 0 &&
           memcmp(a->normal, b->normal, sizeof a->normal) == 0 && a->air == b->air;
}

/* Voxels of the object with others on all sides take the next label. */
static void relabel_hidden(void)
{
    for (int32_t i = 0; i < scene.side * scene.side * scene.side; i++) {
        const int32_t p[3] = {i % scene.side, i / scene.side % scene.side,
                              i / scene.side / scene.side};
        uint16_t *voxel = scene_at(p[0], p[1], p[2]);
        bool is_hidden = *voxel > 0 && *voxel < NET_CLOSED;
        for (int face = 0; face < 6; face++) {
            int32_t q[3] = {p[0], p[1], p[2]};
            q[face / 2] += face & 1 ? 1 : -1;
            const uint16_t beside = scene_voxel(q);
            is_hidden &= beside > 0 && beside < NET_CLOSED;
        }
        *voxel = is_hidden ? (uint16_t)(*voxel % 255 + 1) : *voxel;
    }
}

static void check_parts(bool is_cubes, uint64_t seed)
{
    OWNED(net_release) struct net whole = net_of_scene(is_cubes);
    relabel_hidden(); /* which counts for nothing */
    for (uint64_t trial = 0; trial < 12; trial++) {
        int32_t first[3];
        uint32_t size[3], quads = 0;
        for (uint64_t a = 0; a < 3; a++) {
            const uint64_t r = hash_mix_at(seed, 3 * trial + a);
            size[a] = 1 + (uint32_t)(r % 13);
            first[a] = (int32_t)((r >> 20) % (uint64_t)(scene.side + 2)) - 1;
        }
        OWNED(net_release) struct net part = net_of(first, size, is_cubes);
        bool same = true;
        for (uint32_t q = 0; q < whole.quads; q++) {
            const struct net_quad *is = &whole.quad[q];
            bool inside = true;
            for (int a = 0; a < 3; a++)
                inside &= is->voxel[a] >= first[a] && is->voxel[a] < first[a] + (int32_t)size[a];
            if (!inside)
                continue;
            const struct net_quad *got = quads < part.quads ? &part.quad[quads] : NULL;
            quads++;
            same &= got && by_quad(is, got) == 0 && is->label == got->label &&
                    is->is_closed == got->is_closed;
            for (int k = 0; k < 4 && same; k++)
                same &= is_same_vertex(&whole.vertex[is->corner[k]], &part.vertex[got->corner[k]]);
        }
        CHECK(same);
        CHECK_INT(part.quads, quads);
    }
}

STORY(a_box_has_the_same_net_as_a_part_of_a_larger_one)
{
    static const struct {
        uint32_t inside, labels, closed;
    } kinds[] = {{20, 1, 0}, {300, 3, 100}, {512, 200, 0}, {900, 2, 512}, {1000, 1, 0}};
    for (uint64_t k = 0; k < sizeof kinds / sizeof *kinds; k++)
        for (int is_cubes = 0; is_cubes < 2; is_cubes++) {
            scene_init(30 + (int32_t)k);
            scene_random(7 + k, kinds[k].inside, kinds[k].labels, kinds[k].closed);
            check_parts(is_cubes, 100 * k);
        }
    for (uint64_t k = 0; k < 3; k++) {
        scene_init(SIDE);
        scene_blobs(20 + k, 3);
        check_parts(false, 1000 * k);
    }
}

/* ---- N2 ---- */

STORY(every_edge_has_its_partner)
{
    for (uint64_t k = 0; k < 6; k++) {
        scene_init(24);
        scene_random(k, 100 + 150 * (uint32_t)k, 4, k & 1 ? 300 : 0);
        OWNED(net_release) struct net net = net_of_scene(false);
        CHECK_INT(lonely_edges(&net), 0);
    }
    scene_init(5); /* all of a scene */
    scene_random(1, 1024, 1, 0);
    OWNED(net_release) struct net net = net_of_scene(false);
    CHECK_INT(lonely_edges(&net), 0);
    CHECK_INT(net.quads, 6 * 25);
    CHECK_INT(net.vertices, 6 * 6 * 6 - 4 * 4 * 4);
    CHECK(fabs(volume_of(&net) - 125) < 1e-9);
}

/* ---- symmetry ---- */

static int by_place(const void *a, const void *b)
{
    const struct net_vertex *x = a, *y = b;
    return by_both(x->cube, x->air, y->cube, y->air);
}

STORY(turned_and_mirrored_labels_have_the_turned_and_mirrored_net)
{
    scene_init(22);
    scene_blobs(5, 3);
    *scene_at(3, 4, 5) = *scene_at(9, 20, 7) = NET_CLOSED;
    OWNED(net_release) struct net plain = net_of_scene(false);
    qsort(plain.vertex, plain.vertices, sizeof *plain.vertex, by_place);
    for (int t = 0; t < 48; t++) {
        static const int turn[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2},
                                       {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
        for (int a = 0; a < 3; a++) {
            scene.turn[a] = turn[t / 8][a];
            scene.flip[a] = t >> a & 1;
        }
        OWNED(net_release) struct net net = net_of_scene(false);
        for (uint32_t v = 0; v < net.vertices; v++) {
            struct net_vertex from = net.vertex[v], to = from;
            to.air = 0;
            for (int a = 0; a < 3; a++) {
                const int b = scene.turn[a];
                to.cube[b] = scene.flip[a] ? scene.side - 2 - from.cube[a] : from.cube[a];
                to.at[b] = (int16_t)(scene.flip[a] ? NET_ONE - from.at[a] : from.at[a]);
                to.normal[b] = (int16_t)(scene.flip[a] ? -from.normal[a] : from.normal[a]);
            }
            for (int c = 0; c < 8; c++) {
                int d = 0;
                for (int a = 0; a < 3; a++)
                    d |= ((c >> a & 1) ^ scene.flip[a]) << scene.turn[a];
                to.air |= (uint8_t)((from.air >> c & 1) << d);
            }
            net.vertex[v] = to;
        }
        qsort(net.vertex, net.vertices, sizeof *net.vertex, by_place);
        bool same = net.vertices == plain.vertices;
        for (uint32_t v = 0; v < plain.vertices && same; v++)
            same &= is_same_vertex(&net.vertex[v], &plain.vertex[v]);
        CHECK(same);
    }
}

/* ---- small and thin things ---- */

/* The volume of the net of the scene's voxels over how many they are. */
static double kept(void)
{
    double voxels = 0;
    for (size_t k = 0; k < sizeof scene.voxel / sizeof *scene.voxel; k++)
        voxels += scene.voxel[k] != 0 && scene.voxel[k] != NET_CLOSED;
    OWNED(net_release) struct net net = net_of_scene(false);
    const double volume = volume_of(&net);
    return volume / voxels;
}

#define CHECK_NEAR(actual, expected, most)                                                         \
    do {                                                                                           \
        const double near_a = (actual), near_e = (expected);                                       \
        if (!CHECK(fabs(near_a - near_e) <= (most)))                                               \
            printf("#   is %.4f, expected %.4f\n", near_a, near_e);                                \
    } while (0)

STORY(small_and_thin_things_keep_their_volume)
{
    scene_init(20);
    *scene_at(10, 10, 10) = 1;
    CHECK_NEAR(kept(), 1, 0.03);
    *scene_at(11, 10, 10) = 1;
    CHECK_NEAR(kept(), 1, 0.03);
    for (int kind = 0; kind < 3; kind++) { /* by faces, edges and corners */
        scene_init(20);
        for (int32_t k = 0; k < 10; k++)
            *scene_at(5 + k, kind > 0 ? 5 + k : 5, kind > 1 ? 5 + k : 5) = 1;
        CHECK_NEAR(kept(), 1, 0.03);
    }
    scene_init(30); /* a sheet of one voxel, a pinhole in a wall, and one in a block */
    for (int32_t k = 0; k < 400; k++)
        *scene_at(5 + k % 20, 5 + k / 20, 15) = 1;
    CHECK_NEAR(kept(), 1, 0.02);
    *scene_at(14, 15, 15) = 0;
    CHECK_NEAR(kept(), 1, 0.02);
    for (double r = 2; r < 9; r += 1.3) {
        scene_init(30);
        scene_ball(14.8, 15.1, 14.6, r, 1);
        CHECK_NEAR(kept(), 1, 0.02);
    }
}

/* A block of label 1, from 5,5,5 on. */
static void scene_block(int32_t tall)
{
    scene_init(30);
    for (int32_t k = 0; k < 20 * 20 * tall; k++)
        *scene_at(5 + k % 20, 5 + k / 20 % 20, 5 + k / 400) = 1;
}

/* The labels of the quads around each vertex that face upward; the caller frees them. */
static uint8_t *labels_on_top(const struct net *net)
{
    uint8_t *labels = calloc(net->vertices, 1);
    for (uint32_t q = 0; q < net->quads; q++)
        for (int k = 0; k < 4 && net->quad[q].face == 5; k++)
            labels[net->quad[q].corner[k]] |= net->quad[q].label;
    return labels;
}

/* A vertex of the top of a block belongs to a border where quads around it have both labels. */
STORY(a_border_between_labels_is_smooth_along_the_surface)
{
    double least_y = 100, most_y = 0, least_z = 100, most_z = 0;
    scene_init(30);
    for (int32_t k = 0; k < 20 * 20 * 20; k++) {
        const int32_t p[3] = {5 + k % 20, 5 + k / 20 % 20, 5 + k / 400};
        *scene_at(p[0], p[1], p[2]) = p[1] < 14 + p[0] % 2 ? 1 : 2;
    }
    OWNED(net_release) struct net net = net_of_scene(false);
    OWNED(mem_release) uint8_t *labels = labels_on_top(&net);
    for (uint32_t v = 0; v < net.vertices; v++) {
        const double y = place_of(&net.vertex[v], 1), z = place_of(&net.vertex[v], 2);
        if (labels[v] != 3 || net.vertex[v].cube[0] < 10 || net.vertex[v].cube[0] > 18)
            continue;
        least_y = fmin(least_y, y);
        most_y = fmax(most_y, y);
        least_z = fmin(least_z, z);
        most_z = fmax(most_z, z);
    }
    CHECK(most_y > 0 && most_y - least_y < 0.4); /* 1 in voxels */
    CHECK(most_z - least_z < 0.01);
    CHECK_NEAR(volume_of(&net) / 8000, 1, 0.002);
}

/* The top of a block, with label 1 below a line that rises by 1 in `run`, otherwise 2: the width of
 * the strip along the line that the vertices of the border fill. */
static double off_the_line(int32_t run)
{
    double least = 100, most = -100;
    scene_init(SIDE);
    for (int32_t k = 0; k < 38 * 38 * 12; k++) {
        const int32_t p[3] = {3 + k % 38, 3 + k / 38 % 38, 3 + k / (38 * 38)};
        *scene_at(p[0], p[1], p[2]) = run * (p[1] - 20) < p[0] - 20 ? 1 : 2;
    }
    OWNED(net_release) struct net net = net_of_scene(false);
    OWNED(mem_release) uint8_t *labels = labels_on_top(&net);
    for (uint32_t v = 0; v < net.vertices; v++) {
        const double x = place_of(&net.vertex[v], 0), y = place_of(&net.vertex[v], 1);
        if (labels[v] != 3 || x < 12 || x > 32)
            continue;
        least = fmin(least, y - x / run);
        most = fmax(most, y - x / run);
    }
    return most - least;
}

/* Voxels differ by 1. */
STORY(lines_between_objects_are_no_stairs)
{
    CHECK_NEAR(off_the_line(4), 0, 0.2);
    CHECK_NEAR(off_the_line(8), 0, 0.15);
    CHECK_NEAR(off_the_line(12), 0, 0.4);
    CHECK_NEAR(off_the_line(20), 0, 0.65);
}

/* Of quads of label 2 on the top of a block of label 1. */
static double area_on_top(int32_t side)
{
    double sum = 0;
    scene_block(8);
    for (int32_t k = 0; k < side * side; k++)
        *scene_at(12 + k % side, 12 + k / side, 12) = 2;
    OWNED(net_release) struct net net = net_of_scene(false);
    for (uint32_t q = 0; q < net.quads; q++)
        for (int k = 0; k < 4 && net.quad[q].label == 2 && net.quad[q].face == 5; k++) {
            const struct net_vertex *a = &net.vertex[net.quad[q].corner[k]];
            const struct net_vertex *b = &net.vertex[net.quad[q].corner[(k + 1) % 4]];
            sum += (place_of(a, 0) * place_of(b, 1) - place_of(a, 1) * place_of(b, 0)) / 2;
        }
    return sum;
}

STORY(small_patches_keep_their_area)
{
    for (int32_t side = 1; side < 9; side++)
        CHECK_NEAR(area_on_top(side) / (side * side), 1, side == 2 ? 0.065 : 0.015);
}

/* Below a plane that rises by 1 in `run`, whatever along the other axis; the most that a normal is
 * off, in degrees. */
static double normals_off(double run)
{
    const double length = sqrt(1 + 1 / run / run), truth[3] = {-1 / run / length, 0, 1 / length};
    double most = 0;
    scene_init(SIDE);
    for (int32_t k = 0; k < SIDE * SIDE * SIDE; k++)
        scene.voxel[k] = k / (SIDE * SIDE) < 20 + k % SIDE / run;
    OWNED(net_release) struct net net = net_of_scene(false);
    for (uint32_t v = 0; v < net.vertices; v++) {
        const struct net_vertex *is = &net.vertex[v];
        double cosine = 0;
        for (int a = 0; a < 3; a++)
            cosine += is->normal[a] * truth[a] / NET_ONE;
        if (is->cube[0] > 12 && is->cube[0] < 31 && is->cube[1] > 12 && is->cube[1] < 31 &&
            is->cube[2] > 10)
            most = fmax(most, acos(fmin(1, cosine)) * 180 / 3.14159265358979);
    }
    return most;
}

STORY(normals_of_gentle_slopes_hardly_ripple_and_those_of_a_box_stay)
{
    CHECK_NEAR(normals_off(4), 0, 1);
    CHECK_NEAR(normals_off(8), 0, 4);
    CHECK_NEAR(normals_off(12), 0, 6.3);
    CHECK_NEAR(normals_off(20), 0, 8.2);
    scene_block(20);
    OWNED(net_release) struct net net = net_of_scene(false);
    for (uint32_t v = 0; v < net.vertices; v++) {
        const struct net_vertex *is = &net.vertex[v];
        if (is->cube[1] != 14 || is->cube[2] != 24 || is->cube[0] < 14)
            continue;
        const double slant = atan2(is->normal[0], is->normal[2]) * 180 / 3.14159265358979;
        static const double most[] = {46, 25, 11, 6, 2.5, 1};
        CHECK(slant < (is->cube[0] > 18 ? most[24 - is->cube[0]] : 0.2));
    }
}

STORY(cuts_and_cubes_lie_on_faces_of_voxels)
{
    scene_init(24);
    scene_blobs(3, 2);
    for (int32_t k = 0; k < 24 * 24 * 24; k++)
        if (k / 24 % 24 > 13)
            *scene_at(k % 24, k / 24 % 24, k / 576) = NET_CLOSED;
    for (int is_cubes = 0; is_cubes < 2; is_cubes++) {
        OWNED(net_release) struct net net = net_of_scene(is_cubes);
        bool flat = true, whole = true;
        uint32_t closed = 0;
        for (uint32_t q = 0; q < net.quads; q++)
            for (int k = 0; k < 4 && net.quad[q].is_closed; k++, closed++)
                flat &= net.vertex[net.quad[q].corner[k]].at[net.quad[q].face / 2] == NET_ONE / 2;
        for (uint32_t v = 0; v < net.vertices; v++)
            for (int a = 0; a < 3; a++)
                whole &= net.vertex[v].at[a] == NET_ONE / 2;
        CHECK(closed > 100 && flat && whole == is_cubes);
    }
}

STORY(memory_that_runs_out_leaves_things_as_they_were)
{
    struct net net = {.vertices = 77};
    const struct net_source source = {.row = scene_row, .scale = {4096, 4096, 4096}};
    const uint32_t side[3] = {24, 24, 24}, large[3] = {32000, 32000, 32000};
    enum err err = ERR_MEMORY;
    scene_init(24);
    scene_random(1, 300, 3, 200);
    for (size_t n = 0; err == ERR_MEMORY && n < 100; n++) {
        CHECK_INT(net.vertices, 77);
        allow_allocations(n);
        err = net_make(&net, &source, (const int32_t[]){0, 0, 0}, side, NULL);
        mem_allows = NULL;
    }
    CHECK(err == OK);
    net_release(&net);
    CHECK(net_make(&net, &source, (const int32_t[]){0, 0, 0}, large, NULL) == ERR_MEMORY);
}
