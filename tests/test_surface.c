/* Surfaces of labels: closed for any labels, as large as their voxels, outside out. */
#include <errno.h>
#include <math.h>

#include "image/surface_file.h"
#include "tests/check.h"
#include "tests/folder.h"
#include "tests/interpreting.h"
#include "tests/scarce_memory.h"
#include "tests/stopping.h"
#include "tests/surface_check.h"

static char folder[FOLDER_LENGTH];

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

/* 0 outside. */
static uint8_t box_label(int64_t x, int64_t y, int64_t z)
{
    const bool inside =
        x >= 0 && y >= 0 && z >= 0 && x < box.size[0] && y < box.size[1] && z < box.size[2];
    return inside ? *box_at(x, y, z) : 0;
}

static struct surface *surface_of_box(unsigned passes)
{
    struct surface *surface = NULL;
    bool wanted[256];
    memset(wanted, true, sizeof wanted);
    CHECK(surface_new(&surface, &(struct surface_source){box.size, box_row, &box}, wanted, passes,
                      NULL, NULL) == OK);
    return surface;
}

/* A ball of label 1, of a radius in millimetres. */
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
    return (double)surface_volume(s, &s->part[part]) / 6 / 16777216;
}

/* Points less edges plus triangles, where each edge has two triangles. */
static int64_t euler_number(const struct surface_part *part)
{
    return (int64_t)part->points - (int64_t)part->triangles / 2;
}

/* How often a part goes around the centre of a voxel, by the triangles that a slanted ray meets. */
static int times_around(const struct surface *s, const struct surface_part *part, int64_t x,
                        int64_t y, int64_t z)
{
    static const double ray[3] = {1, 0.0137153, 0.0093177};
    const double from[3] = {(double)x + 1, (double)y + 1, (double)z + 1};
    int times = 0;
    for (size_t i = part->triangle; i < part->triangle + part->triangles; i++) {
        double at[3][3], volume[3], sum = 0, ahead = 0;
        for (int k = 0; k < 3; k++)
            for (int a = 0; a < 3; a++)
                at[k][a] = s->point[s->triangle[i].point[k]].at[a] / 65536.0 - from[a];
        for (int k = 0; k < 3; k++) {
            const double *u = at[k], *v = at[(k + 1) % 3];
            volume[k] = ray[0] * (u[1] * v[2] - u[2] * v[1]) +
                        ray[1] * (u[2] * v[0] - u[0] * v[2]) + ray[2] * (u[0] * v[1] - u[1] * v[0]);
        }
        const bool out = volume[0] > 0 && volume[1] > 0 && volume[2] > 0;
        const bool in = volume[0] < 0 && volume[1] < 0 && volume[2] < 0;
        for (int k = 0; k < 3; k++) {
            sum += volume[k];
            ahead += volume[k] * at[(k + 2) % 3][0];
        }
        if ((out || in) && ahead / sum > 0)
            times += out ? 1 : -1;
    }
    return times;
}

/* U3: centres are inside where the label is theirs, and nowhere else. */
static bool holds_its_voxels(const struct surface *s)
{
    bool holds = true;
    for (unsigned p = 0; p < s->parts; p++)
        for (int64_t z = -1; z <= box.size[2]; z++)
            for (int64_t y = -1; y <= box.size[1]; y++)
                for (int64_t x = -1; x <= box.size[0]; x++)
                    holds &= times_around(s, &s->part[p], x, y, z) ==
                             (box_label(x, y, z) == s->part[p].label);
    return holds;
}

/* ---- stories ---- */

STORY(each_set_of_eight_voxels_has_a_closed_surface)
{
    for (unsigned set = 1; set < 256; set++) {
        box_init(2, 2, 2);
        for (unsigned c = 0; c < 8; c++)
            box.label[c] = set >> c & 1;
        for (unsigned passes = 0; passes < 3; passes += 2) {
            struct surface *s = surface_of_box(passes);
            CHECK(surface_check(s));
            CHECK(holds_its_voxels(s));
            surface_free(s);
        }
    }
}

STORY(labels_of_any_kind_have_closed_surfaces_around_their_voxels)
{
    uint64_t random = 7;
    for (int round = 0; round < 300 && check_failures == 0; round++) {
        box_of_noise(&random);
        struct surface *s = surface_of_box(check_below(&random, 30));
        CHECK(surface_check(s));
        if (round < 60)
            CHECK(holds_its_voxels(s));
        surface_free(s);
    }
}

STORY(a_surface_has_the_volume_of_its_voxels)
{
    static const double size_mm[][3] = {{1, 1, 1}, {0.5, 1, 2}, {0.9, 0.9, 5}};
    for (unsigned i = 0; i < 3; i++)
        for (int32_t radius = 3; radius <= 40; radius += radius < 8 ? 1 : 8) {
            if (size_mm[i][2] > radius)
                continue;
            box_of_ball(radius, size_mm[i]);
            for (unsigned passes = 0; passes <= 40; passes += 20) {
                struct surface *s = surface_of_box(passes);
                const double voxels = (double)s->part[0].voxels;
                CHECK_INT(s->parts, 1);
                CHECK(fabs(volume_of(s, 0) / voxels - 1) < 0.003);
                CHECK_INT(euler_number(&s->part[0]), 2);
                surface_free(s);
            }
        }
}

/* Every point of a ball's surface is near the sphere: steps are smoothed away, the ball is not. */
STORY(smoothing_leaves_a_ball_round)
{
    box_of_ball(30, (const double[]){1, 1, 1});
    double worst[2] = {0};
    for (unsigned i = 0; i < 2; i++) {
        struct surface *s = surface_of_box(i ? 20 : 0);
        for (size_t k = 0; k < s->points; k++) {
            double squared = 0;
            for (int a = 0; a < 3; a++)
                squared += pow(s->point[k].at[a] / 65536.0 - 32, 2);
            worst[i] = fmax(worst[i], fabs(sqrt(squared) - 30));
        }
        surface_free(s);
    }
    CHECK(worst[1] < 0.35 && worst[0] > 0.4);
}

STORY(a_ring_and_a_hollow_ball_have_their_euler_numbers)
{
    box_init(5, 5, 3);
    for (int64_t y = 1; y < 4; y++)
        for (int64_t x = 1; x < 4; x++)
            *box_at(x, y, 1) = x != 2 || y != 2;
    struct surface *s = surface_of_box(20);
    CHECK_INT(euler_number(&s->part[0]), 0); /* a torus */
    surface_free(s);
    box_init(5, 5, 5);
    memset(box.label, 3, 125);
    *box_at(2, 2, 2) = 0;
    s = surface_of_box(20);
    CHECK_INT(euler_number(&s->part[0]), 4); /* two spheres */
    CHECK(surface_check(s) && fabs(volume_of(s, 0) - 124) < 0.5);
    surface_free(s);
    box_init(2, 2, 2); /* the corners at a diagonal are apart */
    *box_at(0, 0, 0) = *box_at(1, 1, 1) = *box_at(0, 1, 1) = 1;
    s = surface_of_box(0);
    CHECK_INT(euler_number(&s->part[0]), 4);
    surface_free(s);
}

STORY(surfaces_of_labels_that_touch_have_the_same_points)
{
    box_init(8, 6, 6);
    for (int64_t z = 1; z < 5; z++)
        for (int64_t y = 1; y < 5; y++)
            for (int64_t x = 1; x < 7; x++)
                *box_at(x, y, z) = x + y < 7 ? 5 : 9;
    struct surface *both = surface_of_box(20), *one = NULL;
    CHECK_INT(both->parts, 2);
    CHECK_INT(both->part[0].label, 5);
    CHECK_INT(both->part[1].label, 9);
    size_t shared = 0;
    for (size_t i = 0; i < both->part[0].points; i++)
        for (size_t k = both->part[1].point; k < both->points; k++)
            shared += memcmp(&both->point[i], &both->point[k], sizeof both->point[i]) == 0;
    size_t faces = 0;
    for (int64_t z = 0; z < 6; z++)
        for (int64_t y = 0; y < 6; y++)
            for (int64_t x = 0; x < 8; x++)
                if (box_label(x, y, z) == 5)
                    faces += (size_t)(box_label(x + 1, y, z) == 9) + (box_label(x, y + 1, z) == 9);
    CHECK_INT(shared, faces);
    bool wanted[256] = {[9] = true};
    CHECK(surface_new(&one, &(struct surface_source){box.size, box_row, &box}, wanted, 20, NULL,
                      NULL) == OK);
    CHECK_INT(one->points, both->part[1].points);
    CHECK(memcmp(one->point, both->point + both->part[1].point, one->points * sizeof *one->point) ==
          0);
    surface_free(one);
    surface_free(both);
}

STORY(fewer_triangles_are_closed_too)
{
    uint64_t random = 11;
    for (int round = 0; round < 200 && check_failures == 0; round++) {
        box_of_noise(&random);
        struct surface *s = surface_of_box(check_below(&random, 20));
        const size_t was = s->triangles, most = was / (1 + check_below(&random, 8));
        CHECK(surface_reduce(s, most, NULL, NULL) == OK);
        CHECK(surface_check(s));
        CHECK(s->triangles <= was);
        surface_free(s);
    }
    box_of_ball(20, (const double[]){1, 1, 1});
    struct surface *s = surface_of_box(20);
    const double voxels = (double)s->part[0].voxels;
    const size_t most = s->triangles / 10;
    CHECK(surface_reduce(s, most, NULL, NULL) == OK);
    CHECK(s->triangles == most || s->triangles + 1 == most);
    CHECK(surface_check(s) && fabs(volume_of(s, 0) / voxels - 1) < 0.01);
    CHECK_INT(euler_number(&s->part[0]), 2);
    CHECK(surface_reduce(s, 0, NULL, NULL) == OK); /* no further than a tetrahedron */
    CHECK_INT(s->triangles, 4);
    CHECK(surface_check(s));
    surface_free(s);
}

/* ---- what goes wrong ---- */

STORY(it_is_stopped_anywhere)
{
    int looks;
    struct watch watch = {.context = &looks, .poll = stop_after_looks, .step = 64};
    const struct surface_source source = {box.size, box_row, &box};
    bool wanted[256];
    int stops = 0;
    memset(wanted, true, sizeof wanted);
    box_of_ball(9, (const double[]){1, 1, 1});
    for (;; stops++) {
        struct surface *s = NULL;
        watch_begin(&watch);
        looks = stops;
        enum err err = surface_new(&s, &source, wanted, 3, &watch, NULL);
        if (!err)
            err = surface_reduce(s, 100, &watch, NULL);
        surface_free(s);
        CHECK(err == OK || err == ERR_CANCELLED);
        if (!err)
            break;
    }
    CHECK(stops > 100);
}

STORY(without_memory_it_says_so)
{
    const struct surface_source source = {box.size, box_row, &box};
    bool wanted[256];
    memset(wanted, true, sizeof wanted);
    box_of_ball(4, (const double[]){1, 1, 1});
    for (size_t n = 0;; n++) {
        struct surface *s = NULL;
        allow_allocations(n);
        enum err err = surface_new(&s, &source, wanted, 3, NULL, &fault);
        if (!err)
            err = surface_reduce(s, 100, NULL, &fault);
        mem_allows = NULL;
        surface_free(s);
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

/* D2: a step of writing that fails leaves the file that was there. */
STORY(a_disk_that_is_full_leaves_the_former_file)
{
    struct volume_label label[256] = {{.name = ""}};
    struct geometry geometry = {.spacing_nm = {1000000, 1000000, 1000000}};
    struct buf now = {0};
    char path[FOLDER_LENGTH + 16];
    for (int l = 0; l < 256; l++)
        label[l].name = "";
    geometry_place_plain(&geometry, (const double[]){1, 1, 1});
    box_of_ball(3, (const double[]){1, 1, 1});
    struct surface *s = surface_of_box(1);
    const struct surface_document document = {s, &geometry, label, ""};
    snprintf(path, sizeof path, "%s", file_in(folder, "full.ply"));
    CHECK(file_write(path, "former", 6, FILE_REPLACE, NULL) == OK);
    enum err err = ERR_IO;
    for (int steps = 0; err; steps++) {
        steps_left = steps;
        file_step_hook = fails_later;
        err = surface_write(path, FILE_REPLACE, &document, NULL, &fault);
        file_step_hook = NULL;
        CHECK(err == OK || err == ERR_IO);
        CHECK(file_read(&now, path, 1 << 20, NULL) == OK);
        CHECK(err == OK || now.length == 6 || steps > 4); /* the last is to sync its folder */
    }
    CHECK(now.length > 1000);
    buf_release(&now);
    surface_free(s);
}

STORY(a_scene_too_far_from_the_origin_is_refused)
{
    const double to_mm[3][4] = {{0.001, 0, 0, 1e6}, {0, 0.001, 0, 0}, {0, 0, 0.001, 0}};
    struct geometry geometry = {.spacing_nm = {1000, 1000, 1000}};
    struct volume_label label[256] = {{.name = ""}};
    CHECK(geometry_place(&geometry, to_mm, ORIENTATION_SFORM));
    box_of_ball(3, (const double[]){1, 1, 1});
    struct surface *s = surface_of_box(1);
    const struct surface_document document = {s, &geometry, label, ""};
    CHECK_INT(surface_write(file_in(folder, "far.stl"), FILE_KEEP, &document, NULL, &fault),
              ERR_LIMIT);
    CHECK_HAS(fault.text, "too far for voxels of 0.001 mm in the single precision of such files");
    surface_free(s);
}

STORY(commands_say_what_they_wrote_and_what_is_wrong)
{
    struct interpreter interp;
    char line[FOLDER_LENGTH + 64];
    begin_interpreter(&interp);
    must(&interp, "open synth:geom:40x30x20");
    CHECK_INT(execute(&interp, "save surface x.nii"), ERR_USAGE);
    CHECK_HAS(fault.text, "x.nii: expected the name of a surface, .stl, .ply, .obj or .vtp");
    snprintf(line, sizeof line, "save surface %s", file_in(folder, "a.ply"));
    CHECK_INT(execute(&interp, line), ERR_INPUT);
    CHECK_HAS(fault.text, "no voxel has a label above 0: plant a `seed` first");
    must(&interp, "seed 20,15,10 1");
    must(&interp, "seed 2,2,2 2");
    must(&interp, line);
    CHECK_HAS(buf_text(&reply.text), "wrote ");
    CHECK_HAS(buf_text(&reply.text), "label 1: ");
    CHECK_HAS(buf_text(&reply.text), " triangles around ");
    CHECK_HAS(buf_text(&reply.text), "label 2: ");
    CHECK_HAS(buf_text(&reply.words), "labels=");
    CHECK_INT(execute(&interp, line), ERR_IO);
    CHECK_HAS(fault.text, "exists already");
    strcat(line, " replace=yes label=1 smooth=0 triangles=500");
    must(&interp, line);
    CHECK(strstr(buf_text(&reply.text), "label 2") == NULL);
    snprintf(line, sizeof line, "save surface %s", file_in(folder, "a.stl"));
    must(&interp, line);
    CHECK_HAS(buf_text(&reply.text), "all labels: ");
    strcat(line, " label=7"); /* said before what keeps the file */
    CHECK_INT(execute(&interp, line), ERR_INPUT);
    CHECK_HAS(fault.text, "no voxel has label 7; nothing was written");
    CHECK_INT(execute(&interp, "save labels x.nii label=1"), ERR_USAGE);
    CHECK_HAS(fault.text, "are for `save surface`, not for labels");
    CHECK_INT(execute(&interp, "save surface x.ply label=0"), ERR_USAGE);
    interpreter_release(&interp);
}

int main(void)
{
    if (!make_folder(folder, "surface"))
        return 1;
    int status = RUN_STORIES(
        TELL(each_set_of_eight_voxels_has_a_closed_surface),
        TELL(labels_of_any_kind_have_closed_surfaces_around_their_voxels),
        TELL(a_surface_has_the_volume_of_its_voxels), TELL(smoothing_leaves_a_ball_round),
        TELL(a_ring_and_a_hollow_ball_have_their_euler_numbers),
        TELL(surfaces_of_labels_that_touch_have_the_same_points),
        TELL(fewer_triangles_are_closed_too), TELL(it_is_stopped_anywhere),
        TELL(without_memory_it_says_so), TELL(a_disk_that_is_full_leaves_the_former_file),
        TELL(a_scene_too_far_from_the_origin_is_refused),
        TELL(commands_say_what_they_wrote_and_what_is_wrong));
    reply_release(&reply);
    return status | remove_folder(folder);
}
