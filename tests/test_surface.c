/* SPDX-License-Identifier: MIT */
/* Surfaces of labels: closed for any labels, equal to the nets of pictures point by point, with the
 * volume of their voxels, facing outwards. */
#include <errno.h>
#include <math.h>

#include "image/surface_file.h"
#include "tests/folder_main.h"
#include "tests/interpreting.h"
#include "tests/scarce_memory.h"
#include "tests/stopping.h"
#include "tests/surface_check.h"

/* ---- boxes of labels ---- */

struct box {
    uint32_t size[3];
    uint8_t label[1 << 20];
};

static struct box box;

static void box_row(void *context, uint32_t y, uint32_t z, uint8_t *label)
{
    const struct box *b = context;
    memcpy(label, b->label + ((size_t)z * b->size[1] + y) * b->size[0], b->size[0]);
}

static void box_init(uint32_t x, uint32_t y, uint32_t z)
{
    const uint32_t sides[3] = {x, y, z};
    memcpy(box.size, sides, sizeof sides);
    memset(box.label, 0, sizeof box.label);
}

static uint8_t *box_at(int64_t x, int64_t y, int64_t z)
{
    return &box.label[(size_t)((z * box.size[1] + y) * box.size[0] + x)];
}

/* Return the label, 0 outside. */
static uint8_t box_label(int64_t x, int64_t y, int64_t z)
{
    const bool inside =
        x >= 0 && y >= 0 && z >= 0 && x < box.size[0] && y < box.size[1] && z < box.size[2];
    return inside ? *box_at(x, y, z) : 0;
}

enum kind { NET, CUBES, JOINED };

static enum err make_surface(struct surface **surface, enum kind kind, struct watch *watch,
                             struct fault *why)
{
    const struct surface_source source = {box.size, box_row, &box};
    struct surface_choice choice = {.joins = kind == JOINED, .is_cubes = kind == CUBES};
    memset(choice.wanted, true, sizeof choice.wanted);
    *surface = NULL;
    return surface_new(surface, &source, &choice, watch, why);
}

static struct surface *surface_of_box(enum kind kind)
{
    struct surface *surface;
    CHECK(make_surface(&surface, kind, NULL, NULL) == OK);
    return surface;
}

/* Fill the box with a ball of label 1, of a radius in millimetres. */
static void box_of_ball(int32_t radius, const double size_mm[3])
{
    int64_t half[3];
    for (int a = 0; a < 3; a++)
        half[a] = (int64_t)ceil(radius / size_mm[a]) + 1;
    box_init((uint32_t)(2 * half[0] + 1), (uint32_t)(2 * half[1] + 1), (uint32_t)(2 * half[2] + 1));
    for (int64_t z = -half[2]; z <= half[2]; z++)
        for (int64_t y = -half[1]; y <= half[1]; y++)
            for (int64_t x = -half[0]; x <= half[0]; x++) {
                const double mm[3] = {(double)x * size_mm[0], (double)y * size_mm[1],
                                      (double)z * size_mm[2]};
                *box_at(x + half[0], y + half[1], z + half[2]) =
                    mm[0] * mm[0] + mm[1] * mm[1] + mm[2] * mm[2] <= (double)radius * radius;
            }
}

static void box_of_noise(uint64_t *random)
{
    const unsigned labels = 1 + check_below(random, 4);
    box_init(1 + check_below(random, 9), 1 + check_below(random, 9), 1 + check_below(random, 9));
    for (uint32_t i = 0; i < box.size[0] * box.size[1] * box.size[2]; i++)
        box.label[i] = (uint8_t)check_below(random, labels + 1);
}

/* ---- what holds of a surface ---- */

static double volume_of(const struct surface *s, unsigned part)
{
    return (double)surface_volume(s, &s->part[part]) / 6 / (1 << 30);
}

/* Return points - edges + triangles, where each edge has two triangles. */
static int64_t euler_number(const struct surface_part *part)
{
    return (int64_t)part->points - (int64_t)part->triangles / 2;
}

/* ---- triangles by the places of their points ---- */

struct places {
    struct surface_point point[3]; /* the least first */
};

struct triangles {
    struct places *item;
    size_t count;
};

static int places_order(const void *a, const void *b)
{
    return memcmp(a, b, sizeof(struct places));
}

static struct places places_of(const struct surface_point point[3], bool is_turned)
{
    unsigned least = 0;
    struct places to;
    for (unsigned k = 1; k < 3; k++)
        least = memcmp(&point[k], &point[least], sizeof *point) < 0 ? k : least;
    for (unsigned k = 0; k < 3; k++)
        to.point[k] = point[(least + (is_turned ? 3 - k : k)) % 3];
    return to;
}

static struct triangles triangles_of(const struct surface *s, bool is_turned)
{
    struct triangles all = {calloc(s->triangles + 1, sizeof *all.item), s->triangles};
    for (size_t t = 0; t < s->triangles; t++) {
        struct surface_point point[3];
        for (int k = 0; k < 3; k++)
            point[k] = s->point[s->triangle[t].point[k]];
        all.item[t] = places_of(point, is_turned);
    }
    qsort(all.item, all.count, sizeof *all.item, places_order);
    return all;
}

static void net_row_of_box(void *context, int32_t x, int32_t y, int32_t z, uint32_t count,
                           uint16_t *voxel)
{
    (void)context;
    for (uint32_t i = 0; i < count; i++, x++) {
        const bool is_inside = x >= 0 && y >= 0 && z >= 0 && (uint32_t)x < box.size[0] &&
                               (uint32_t)y < box.size[1] && (uint32_t)z < box.size[2];
        voxel[i] = is_inside ? box_label(x, y, z) : NET_CLOSED;
    }
}

/* Make the triangles of the net of all labelled voxels, in one piece. */
static struct triangles triangles_of_net(bool is_cubes)
{
    const struct net_source source = {net_row_of_box, NULL, {4096, 4096, 4096}, is_cubes, NULL};
    OWNED(net_release) struct net net;
    CHECK(net_make(&net, &source, (const int32_t[]){0, 0, 0}, box.size, NULL) == OK);
    struct triangles all = {calloc(2 * net.quads + 1, sizeof *all.item), 2 * net.quads};
    for (uint32_t q = 0; q < net.quads; q++) {
        int32_t at[4][3];
        struct surface_point corner[4];
        for (int i = 0; i < 12; i++) {
            const struct net_vertex *v = &net.vertex[net.quad[q].corner[i / 3]];
            at[i / 3][i % 3] = (v->cube[i % 3] + 1) * NET_ONE + v->at[i % 3];
            corner[i / 3].at[i % 3] = (uint32_t)at[i / 3][i % 3];
        }
        const unsigned d = net_diagonal(at, net.quad[q].face);
        for (unsigned half = 0; half < 2; half++)
            all.item[2 * q + half] = places_of(
                (struct surface_point[]){corner[(d + 2 * half) % 4], corner[(d + 2 * half + 1) % 4],
                                         corner[(d + 2 * half + 2) % 4]},
                false);
    }
    qsort(all.item, all.count, sizeof *all.item, places_order);
    return all;
}

/* ---- stories ---- */

static void check_surface_of_box(enum kind kind)
{
    OWNED(surface_drop) struct surface *s = surface_of_box(kind);
    CHECK(surface_check(s));
    for (unsigned p = 0; p < s->parts && kind == CUBES; p++)
        CHECK_INT(surface_volume(s, &s->part[p]), (int64_t)(6 * s->part[p].voxels) << 30);
}

STORY(each_set_of_eight_voxels_and_labels_of_any_kind_have_closed_surfaces)
{
    for (unsigned set = 1; set < 256; set++) {
        box_init(2, 2, 2);
        for (unsigned c = 0; c < 8; c++)
            box.label[c] = set >> c & 1;
        check_surface_of_box(NET);
        check_surface_of_box(CUBES);
    }
    uint64_t random = 7;
    for (int round = 0; round < 200 && check_failures == 0; round++) {
        box_of_noise(&random);
        check_surface_of_box(round % 3 == 0 ? CUBES : round % 3 == 1 ? NET : JOINED);
    }
}

/* A printed surface is the visible one, even if it is assembled from several boxes. */
STORY(a_surface_has_the_triangles_of_the_net)
{
    uint64_t random = 3;
    for (int round = 0; round < 40 && check_failures == 0; round++) {
        box_of_noise(&random);
        if (round % 8 == 0) {
            uint32_t size[3] = {4, 5, 3};
            size[round / 8 % 3] = 129 + check_below(&random, 150);
            box_init(size[0], size[1], size[2]);
            for (uint32_t i = 0; i < size[0] * size[1] * size[2]; i++)
                box.label[i] = (uint8_t)(check_below(&random, 5) > 1 ? 1 + round % 2 : 0);
        }
        OWNED(surface_drop) struct surface *s = surface_of_box(JOINED);
        struct triangles of = triangles_of(s, false), net = triangles_of_net(false);
        CHECK_INT(of.count, net.count);
        CHECK(of.count == net.count && memcmp(of.item, net.item, of.count * sizeof *of.item) == 0);
        free(of.item);
        free(net.item);
    }
}

STORY(a_surface_has_the_volume_of_its_voxels)
{
    static const double size_mm[][3] = {{1, 1, 1}, {0.5, 1, 2}, {0.9, 0.9, 5}};
    for (unsigned i = 0; i < 3; i++)
        for (int32_t radius = 3; radius <= 40; radius += radius < 8 ? 1 : 8) {
            if (2 * size_mm[i][2] > radius)
                continue;
            box_of_ball(radius, size_mm[i]);
            OWNED(surface_drop) struct surface *s = surface_of_box(NET);
            CHECK_INT(s->parts, 1);
            CHECK(fabs(volume_of(s, 0) / (double)s->part[0].voxels - 1) < 0.02);
            CHECK_INT(euler_number(&s->part[0]), 2);
        }
}

/* Every point of a ball's surface is near the sphere: steps are smoothed, the size is kept. */
STORY(a_net_leaves_a_ball_round)
{
    box_of_ball(30, (const double[]){1, 1, 1});
    double worst[2] = {0};
    for (unsigned i = 0; i < 2; i++) {
        OWNED(surface_drop) struct surface *s = surface_of_box(i ? NET : CUBES);
        for (size_t k = 0; k < s->points; k++) {
            double squared = 0;
            for (int a = 0; a < 3; a++)
                squared += pow((double)s->point[k].at[a] / SURFACE_ONE - 32, 2);
            worst[i] = fmax(worst[i], fabs(sqrt(squared) - 30));
        }
    }
    CHECK(worst[1] < 0.45 && worst[0] > 0.8);
}

STORY(a_ring_and_a_hollow_ball_have_their_euler_numbers)
{
    box_init(5, 5, 3);
    for (int64_t y = 1; y < 4; y++)
        for (int64_t x = 1; x < 4; x++)
            *box_at(x, y, 1) = x != 2 || y != 2;
    struct surface *s = surface_of_box(NET);
    CHECK_INT(euler_number(&s->part[0]), 0); /* a torus */
    surface_free(s);
    box_init(5, 5, 5);
    memset(box.label, 3, 125);
    *box_at(2, 2, 2) = 0;
    s = surface_of_box(NET);
    CHECK_INT(euler_number(&s->part[0]), 4); /* two spheres */
    CHECK(surface_check(s) && fabs(volume_of(s, 0) - 124) < 0.5);
    surface_free(s);
    box_init(2, 2, 2); /* diagonal corners are separate */
    *box_at(0, 0, 0) = *box_at(1, 1, 1) = *box_at(0, 1, 1) = 1;
    s = surface_of_box(NET);
    CHECK_INT(euler_number(&s->part[0]), 4);
    surface_free(s);
}

/* Walls have the same triangles from both sides, and the outer surface of all labels is that of
 * their union. */
STORY(surfaces_of_labels_fit_one_another_and_the_whole)
{
    uint64_t random = 5;
    for (int round = 0; round < 30 && check_failures == 0; round++) {
        const bool is_ball = round == 1, is_long = round == 2;
        if (is_ball) {
            box_of_ball(9, (const double[]){1, 1, 1});
            for (uint32_t i = 0; i < box.size[0] * box.size[1] * box.size[2]; i++)
                box.label[i] *= (uint8_t)(1 + (i % box.size[0] > 11) + (i % 361 > 200));
        } else if (is_long) { /* its ends are boxes of one label */
            box_init(250, 7, 6);
            for (uint32_t i = 0; i < 250 * 7 * 6; i++)
                box.label[i] = (uint8_t)(check_below(&random, 5) ? 1 + (i % 250 > 120) : 0);
        } else {
            box_of_noise(&random);
        }
        OWNED(surface_drop) struct surface *s = surface_of_box(round % 4 ? NET : CUBES);
        const struct triangles ahead = triangles_of(s, false), back = triangles_of(s, true);
        const struct triangles net = triangles_of_net(round % 4 == 0);
        size_t walls = 0, found = 0, i = 0, outside = 0;
        for (int64_t z = 0; z < box.size[2]; z++)
            for (int64_t y = 0; y < box.size[1]; y++)
                for (int64_t x = 0; x < box.size[0]; x++)
                    for (int a = 0; a < 3; a++) {
                        const unsigned one = box_label(x, y, z),
                                       other = box_label(x + (a == 0), y + (a == 1), z + (a == 2));
                        walls += one && other && one != other;
                    }
        for (size_t k = 0; k < ahead.count; k++)
            found += bsearch(&ahead.item[k], back.item, back.count, sizeof *back.item,
                             places_order) != NULL;
        CHECK(found >= 4 * walls);
        for (size_t k = 0; k < net.count; k++) {
            while (i < ahead.count && places_order(&ahead.item[i], &net.item[k]) < 0)
                i++;
            if (i < ahead.count && places_order(&ahead.item[i], &net.item[k]) == 0) {
                outside++;
                i++;
            }
        }
        CHECK(ahead.count == net.count + 4 * walls);
        /* In noise, some cubes have one vertex of a label for two parts of air. */
        CHECK(outside == net.count ||
              (round % 4 && !is_ball && outside * 100 > net.count * (is_long ? 99 : 70)));
        free(ahead.item);
        free(back.item);
        free(net.item);
    }
}

STORY(a_label_alone_has_a_net_of_its_own)
{
    OWNED(surface_drop) struct surface *one = NULL;
    uint64_t random = 9;
    box_of_noise(&random);
    struct surface_choice choice = {.wanted = {[1] = true}};
    CHECK(surface_new(&one, &(struct surface_source){box.size, box_row, &box}, &choice, NULL,
                      NULL) == OK);
    CHECK_INT(one->parts, 1);
    for (uint32_t i = 0; i < box.size[0] * box.size[1] * box.size[2]; i++)
        box.label[i] = box.label[i] == 1;
    struct triangles of = triangles_of(one, false), net = triangles_of_net(false);
    CHECK(of.count == net.count && memcmp(of.item, net.item, of.count * sizeof *of.item) == 0);
    free(of.item);
    free(net.item);
}

/* ---- files ---- */

/* Labels without names. */
static const struct volume_label *nameless(void)
{
    static struct volume_label label[256];
    for (int l = 0; l < 256; l++)
        label[l].name = "";
    return label;
}

/* Read an STL file, identifying points by their coordinates. */
static struct surface *read_stl(const char *path)
{
    OWNED(buf_release) struct buf bytes = {0};
    struct surface *s = calloc(1, sizeof *s);
    CHECK(file_read(&bytes, path, 1 << 28, NULL) == OK);
    uint32_t triangles;
    memcpy(&triangles, bytes.data + 80, 4);
    CHECK_INT(bytes.length, 84 + 50 * (size_t)triangles);
    OWNED(mem_release) struct surface_point *sorted = calloc(3 * triangles + 1, sizeof *sorted);
    s->triangles = triangles;
    s->triangle = calloc(triangles + 1, sizeof *s->triangle);
    s->point = calloc(3 * triangles + 1, sizeof *s->point);
    for (uint32_t i = 0; i < 3 * triangles; i++)
        memcpy(&sorted[i], bytes.data + 84 + 50 * (i / 3) + 12 + 12 * (i % 3), sizeof *sorted);
    qsort(sorted, 3 * triangles, sizeof *sorted, surface_place_order);
    for (uint32_t i = 0; i < 3 * triangles; i++)
        if (i == 0 || surface_place_order(&sorted[i], &sorted[i - 1]))
            s->point[s->points++] = sorted[i];
    for (uint32_t i = 0; i < 3 * triangles; i++) {
        const struct surface_point *found =
            bsearch(bytes.data + 84 + 50 * (i / 3) + 12 + 12 * (i % 3), s->point, s->points,
                    sizeof *s->point, surface_place_order);
        s->triangle[i / 3].point[i % 3] = (uint32_t)(found - s->point);
    }
    return s;
}

static double volume_of_file(const struct surface *s)
{
    double sum = 0;
    for (size_t t = 0; t < s->triangles; t++) {
        float p[3][3];
        for (int k = 0; k < 3; k++)
            memcpy(p[k], &s->point[s->triangle[t].point[k]], sizeof p[k]);
        sum += (double)(p[1][0] - p[0][0]) * (double)(p[2][1] - p[0][1]) *
                   (double)(p[0][2] + p[1][2] + p[2][2]) -
               (double)(p[1][1] - p[0][1]) * (double)(p[2][0] - p[0][0]) *
                   (double)(p[0][2] + p[1][2] + p[2][2]);
    }
    return sum / 6;
}

/* Readers of STL identify points by coordinates: no two points of a surface may have the same. */
STORY(files_without_numbers_of_points_are_closed_too)
{
    struct geometry geometry = {.spacing_nm = {700000, 1000000, 1500000}};
    uint64_t random = 21;
    geometry_place_plain(&geometry, (const double[]){0.7, 1, 1.5});
    for (int round = 0; round < 40 && check_failures == 0; round++) {
        const bool is_ball = round < 4;
        if (is_ball)
            box_of_ball(5 + 4 * round, (const double[]){0.7, 1, 1.5});
        else
            box_of_noise(&random);
        struct surface *s = surface_of_box(JOINED);
        if (!is_ball && round % 2) {
            surface_free(s);
            for (uint32_t i = 0; i < box.size[0] * box.size[1] * box.size[2]; i++)
                box.label[i] = box.label[i] != 0;
            s = surface_of_box(CUBES);
        }
        const struct surface_document document = {s, &geometry, nameless(), ""};
        const char *path = file_in(folder, "read.stl");
        CHECK(surface_write(path, FILE_REPLACE, &document, NULL, &fault) == OK);
        OWNED(surface_drop) struct surface *read = read_stl(path);
        CHECK_INT(read->points, s->points);
        CHECK_INT(read->triangles, s->triangles);
        CHECK(surface_check(read));
        if (is_ball) {
            const double voxel_mm3 = 0.7 * 1.5, volume = volume_of_file(read) / voxel_mm3;
            CHECK(fabs(volume / volume_of(s, 0) - 1) < 1e-4);
            CHECK(fabs(volume / (double)s->part[0].voxels - 1) < 0.02);
        }
        surface_free(s);
    }
}

STORY(fewer_triangles_are_closed_too)
{
    uint64_t random = 11;
    for (int round = 0; round < 200 && check_failures == 0; round++) {
        box_of_noise(&random);
        OWNED(surface_drop) struct surface *s = surface_of_box(round % 2 ? NET : CUBES);
        const size_t was = s->triangles, most = was / (1 + check_below(&random, 8));
        CHECK(surface_reduce(s, most, NULL, NULL) == OK && surface_check(s) && s->triangles <= was);
    }
    box_of_ball(20, (const double[]){1, 1, 1});
    OWNED(surface_drop) struct surface *s = surface_of_box(NET);
    const double voxels = (double)s->part[0].voxels;
    const size_t most = s->triangles / 10;
    CHECK(surface_reduce(s, most, NULL, NULL) == OK);
    CHECK(s->triangles == most || s->triangles + 1 == most);
    CHECK(surface_check(s) && fabs(volume_of(s, 0) / voxels - 1) < 0.01);
    CHECK_INT(euler_number(&s->part[0]), 2);
    CHECK(surface_reduce(s, 0, NULL, NULL) == OK); /* down to a tetrahedron at most */
    CHECK_INT(s->triangles, 4);
    CHECK(surface_check(s));
}

/* ---- what goes wrong ---- */

STORY(it_is_stopped_anywhere)
{
    int looks;
    struct watch watch = {.context = &looks, .poll = stop_after_looks, .step = 64};
    int stops = 0;
    box_of_ball(9, (const double[]){1, 1, 1});
    for (;; stops++) {
        OWNED(surface_drop) struct surface *s = NULL;
        watch_begin(&watch);
        looks = stops;
        enum err err = make_surface(&s, NET, &watch, NULL);
        if (!err)
            err = surface_reduce(s, 100, &watch, NULL);
        CHECK(err == OK || err == ERR_CANCELLED);
        if (!err)
            break;
    }
    CHECK(stops > 100);
}

STORY(without_memory_it_says_so)
{
    box_of_ball(4, (const double[]){1, 1, 1});
    for (size_t n = 0;; n++) {
        OWNED(surface_drop) struct surface *s = NULL;
        allow_allocations(n);
        enum err err = make_surface(&s, NET, NULL, &fault);
        if (!err)
            err = surface_reduce(s, 100, NULL, &fault);
        mem_allows = NULL;
        CHECK(err == OK || err == ERR_MEMORY);
        if (!err)
            break;
    }
}

static int steps_left;
static int fails_later(enum file_step step, const char *path)
{
    (void)step, (void)path;
    return steps_left-- == 0 ? ENOSPC : 0;
}

/* D2: a failed write leaves the former file. */
STORY(a_disk_that_is_full_leaves_the_former_file)
{
    struct geometry geometry = {.spacing_nm = {1000000, 1000000, 1000000}};
    OWNED(buf_release) struct buf now = {0};
    char path[FOLDER_LENGTH + 16];
    geometry_place_plain(&geometry, (const double[]){1, 1, 1});
    box_of_ball(3, (const double[]){1, 1, 1});
    OWNED(surface_drop) struct surface *s = surface_of_box(NET);
    const struct surface_document document = {s, &geometry, nameless(), ""};
    snprintf(path, sizeof path, "%s", file_in(folder, "full.ply"));
    CHECK(file_write(path, "former", 6, FILE_REPLACE, NULL) == OK);
    enum err err = ERR_IO;
    for (int steps = 0; err; steps++) {
        steps_left = steps;
        file_step_hook = fails_later;
        err = surface_write(path, FILE_REPLACE, &document, NULL, &fault);
        file_step_hook = NULL;
        CHECK((err == OK || err == ERR_IO) && file_read(&now, path, 1 << 20, NULL) == OK);
        CHECK(err == OK || now.length == 6 || steps > 4); /* the last step syncs its folder */
    }
    CHECK(now.length > 1000);
}

STORY(a_scene_too_far_from_the_origin_is_refused)
{
    const double to_mm[3][4] = {{0.001, 0, 0, 1e6}, {0, 0.001, 0, 0}, {0, 0, 0.001, 0}};
    struct geometry geometry = {.spacing_nm = {1000, 1000, 1000}};
    CHECK(geometry_place(&geometry, to_mm, ORIENTATION_SFORM));
    box_of_ball(3, (const double[]){1, 1, 1});
    OWNED(surface_drop) struct surface *s = surface_of_box(NET);
    const struct surface_document document = {s, &geometry, nameless(), ""};
    CHECK_INT(surface_write(file_in(folder, "far.stl"), FILE_KEEP, &document, NULL, &fault),
              ERR_LIMIT);
    CHECK_HAS(fault.text, "too far for voxels of 0.001 mm in the single precision of such files");
}

BEGUN_STORY(commands_say_what_they_wrote_and_what_is_wrong, begin_interpreter)
{
    char line[FOLDER_LENGTH + 64];
    must(interp, "open synth:geom:40x30x20");
    MUST_FAIL(interp, "save surface x.nii", ERR_USAGE,
              "x.nii: expected the name of a surface, .stl, .ply, .obj or .vtp");
    snprintf(line, sizeof line, "save surface %s", file_in(folder, "a.ply"));
    MUST_FAIL(interp, line, ERR_INPUT, "no voxel has a label above 0: plant a `seed` first");
    must(interp, "seed 20,15,10 1; seed 2,2,2 2");
    MUST_MENTION(interp, line, "wrote ");
    CHECK_HAS(buf_text(&reply.text), "label 1: ");
    CHECK_HAS(buf_text(&reply.text), " triangles around ");
    CHECK_HAS(buf_text(&reply.text), "label 2: ");
    CHECK_HAS(buf_text(&reply.words), "labels=");
    MUST_FAIL(interp, line, ERR_IO, "exists already");
    strcat(line, " replace=yes label=1 smooth=0 triangles=500");
    must(interp, line);
    CHECK(strstr(buf_text(&reply.text), "label 2") == NULL);
    snprintf(line, sizeof line, "save surface %s", file_in(folder, "a.stl"));
    MUST_MENTION(interp, line, "all labels: ");
    strcat(line, " label=7"); /* reported before the existing file */
    MUST_FAIL(interp, line, ERR_INPUT, "no voxel has label 7; nothing was written");
    MUST_FAIL(interp, "save labels x.nii label=1", ERR_USAGE,
              "are for `save surface`, not for labels");
    CHECK_INT(execute(interp, "save surface x.ply label=0"), ERR_USAGE);
}
