/* SPDX-License-Identifier: MIT */
/* Shading: normals of known shapes, and the effects of a look. */
#include "tests/check_main.h"

#include <math.h>

#include "render/light.h"
#include "tests/stage.h"

static void stage_cube(struct stage *s, uint32_t side)
{
    CHECK(stage_init(s, (uint32_t[]){side, side, side}, 6, NULL) == OK);
}

static void put(struct stage *s, int x, int y, int z, uint8_t label)
{
    s->scene->cell[grid_cell(&s->scene->grid, (uint32_t)x, (uint32_t)y, (uint32_t)z)].label = label;
}

/* A ball in the middle of the scene. */
static double ball_radius;
static bool is_ball(const double at[3])
{
    return at[0] * at[0] + at[1] * at[1] + at[2] * at[2] <= ball_radius * ball_radius;
}
static void put_ball(struct stage *s, double radius)
{
    ball_radius = radius;
    stage_put(s, is_ball);
}

static void draw(struct stage *s, uint32_t side, uint32_t zoom, int32_t yaw, int32_t pitch)
{
    rendition_release(&s->rendition);
    s->view.width = s->view.height = side;
    s->view.zoom = zoom;
    s->view.angle[0] = yaw, s->view.angle[1] = pitch;
    stage_draw(s);
}

/* ---- known shapes ---- */

/* Angles in degrees between normals and radii, for pixels of one or several pictures. */
static struct angles {
    double of[800000];
    size_t count, away; /* away: number of normals that face away from the viewer */
} angles;

/* A ray may enter a shell between two voxels, and show it from inside. */
static void add_angle(const struct stage *s, size_t pixel)
{
    const int16_t *n = s->rendition.normal + 4 * pixel;
    double point[3], along = 0, length = 0, size = 0, toward = 0;
    stage_point(s, pixel, point);
    for (int a = 0; a < 3; a++) {
        along += point[a] * n[a];
        length += point[a] * point[a];
        size += (double)n[a] * n[a];
        toward -= (double)n[a] * s->camera.ahead[a];
    }
    CHECK(fabs(sqrt(size) - 16384) < 4);
    angles.away += toward < 0;
    angles.of[angles.count++] =
        acos(fmin(1, fabs(along) / sqrt(length * size))) * 180 / 3.14159265358979;
}

static void add_angles(const struct stage *s)
{
    for (size_t pixel = 0; pixel < (size_t)s->view.width * s->view.height; pixel++)
        if (s->rendition.cell[pixel] != CELL_NONE)
            add_angle(s, pixel);
    qsort(angles.of, angles.count, sizeof *angles.of, stage_by_size);
}

/* Return the largest angle between a normal and the radius of a ball in the middle, and the mean.
 * */
static double worst_angle(const struct stage *s, double *mean)
{
    angles.count = angles.away = 0;
    add_angles(s);
    *mean = 0;
    for (size_t i = 0; i < angles.count; i++)
        *mean += angles.of[i] / (double)angles.count;
    return angles.of[angles.count - 1];
}

STORY(a_ball_is_round_from_every_side)
{
    OWNED(stage_release) struct stage s;
    double mean;
    stage_cube(&s, 61);
    put_ball(&s, 25);
    for (int i = 0; i < 8; i++) {
        draw(&s, 128, 1000 + 300 * (uint32_t)i, i * 41000, i * 27000);
        const double worst = worst_angle(&s, &mean);
        if (!CHECK(worst < 13 && mean < 2.1))
            printf("# view %d: worst %.1f mean %.2f degrees\n", i, worst, mean);
    }
}

/* ---- a torus ---- */

enum { RING = 14, TUBE = 4 }; /* radii, in voxels */
static double torus_axis[3];

/* Return the signed distance of a point from the torus; `outward` gets its gradient, or is NULL. */
static double from_torus(const double at[3], double outward[3])
{
    double high = 0, wide = 0, in_plane[3];
    for (int a = 0; a < 3; a++)
        high += at[a] * torus_axis[a];
    for (int a = 0; a < 3; a++) {
        in_plane[a] = at[a] - high * torus_axis[a];
        wide = hypot(wide, in_plane[a]);
    }
    const double from_ring = hypot(wide - RING, high);
    for (int a = 0; outward && a < 3; a++)
        outward[a] = (in_plane[a] * (wide - RING) / wide + high * torus_axis[a]) / from_ring;
    return from_ring - TUBE;
}

static bool is_in_torus(const double at[3])
{
    return from_torus(at, NULL) <= 0;
}

/* Return the least distance of the ray through a shown point from the torus. */
static double nearest_on_ray(const struct stage *s, const double at[3])
{
    double least = 100;
    for (double t = -6; t <= 6; t += 0.05) {
        double on_ray[3];
        for (int a = 0; a < 3; a++)
            on_ray[a] = at[a] + t * s->camera.ahead[a] / (1 << 30);
        least = fmin(least, from_torus(on_ray, NULL));
    }
    return least;
}

/* Mean errors over all views: the silhouette within a pixel, normals within four degrees, points
 * within 0.3 voxels. */
STORY(a_torus_has_its_silhouette_normals_and_depths)
{
    enum { ZOOM = 8 };
    uint64_t random = 5;
    double edge = 0, angle = 0, depth = 0;
    size_t edges = 0, points = 0;
    for (int i = 0; i < 4; i++) {
        OWNED(stage_release) struct stage s;
        double length = 0;
        for (int a = 0; a < 3; a++) {
            torus_axis[a] = (double)(check_random(&random) % 2001) - 1000;
            length = hypot(length, torus_axis[a]);
        }
        for (int a = 0; a < 3; a++)
            torus_axis[a] /= length;
        stage_cube(&s, 48);
        stage_put(&s, is_in_torus);
        draw(&s, 400, ZOOM * 1000, (int32_t)(check_random(&random) % 360000),
             (int32_t)(check_random(&random) % 360000));
        const struct rendition *r = &s.rendition;
        for (size_t p = r->width; p + r->width < (size_t)r->width * r->height; p++) {
            double at[3], outward[3], along = 0;
            if (r->cell[p] == CELL_NONE)
                continue;
            stage_point(&s, p, at);
            depth += fabs(from_torus(at, outward));
            for (int a = 0; a < 3; a++)
                along += outward[a] * r->normal[4 * p + (size_t)a] / 16384;
            angle += acos(fmax(-1, fmin(1, along))) * 180 / 3.14159265358979;
            points++;
            if (r->cell[p - 1] != CELL_NONE && r->cell[p + 1] != CELL_NONE &&
                r->cell[p - r->width] != CELL_NONE && r->cell[p + r->width] != CELL_NONE)
                continue;
            edge += fabs(nearest_on_ray(&s, at)) * ZOOM;
            edges++;
        }
    }
    edge /= (double)edges, angle /= (double)points, depth /= (double)points;
    if (!CHECK(edges > 1000 && edge < 1 && angle < 4 && depth < 0.3))
        printf("# %zu edges off by %.3f pixels, normals by %.2f degrees, points by %.3f voxels\n",
               edges, edge, angle, depth);
}

/* ---- shells ---- */

enum { SHELL_RADIUS = 40 }; /* millimetres */

/* Limits of the errors of normals of shells, in degrees. */
static const struct shell {
    double thickness, spacing; /* in millimetres, spacing along z */
    double median, most_of_95_percent;
} shell[] = {
    {40, 1, 1.2, 3}, {1, 1, 3, 8},    {2, 1, 2, 4},
    {3, 1, 1.4, 3},  {40, 2, 1.3, 6}, {2.5, 2, 1.8, 10.5},
};

static const struct shell *current;
static bool is_in_shell(const double at[3])
{
    const double r = sqrt(at[0] * at[0] + at[1] * at[1] + pow(at[2] * current->spacing, 2));
    return r <= SHELL_RADIUS && r > SHELL_RADIUS - current->thickness;
}

STORY(normals_of_thin_shells_are_as_true_as_those_of_solid_balls)
{
    static const int32_t side[6][2] = {{0, 0},          {45000, 35264},  {102000, 46000},
                                       {153000, 69000}, {204000, 92000}, {255000, 115000}};
    for (size_t i = 0; i < sizeof shell / sizeof *shell; i++) {
        const uint32_t across = (uint32_t)(2 * SHELL_RADIUS / shell[i].spacing) + 11;
        OWNED(stage_release) struct stage s;
        CHECK(stage_init(&s, (uint32_t[]){91, 91, across}, 6, NULL) == OK);
        s.scene->spacing_nm[2] = (uint32_t)(1e6 * shell[i].spacing);
        current = &shell[i];
        stage_put(&s, is_in_shell);
        angles.count = angles.away = 0;
        for (uint32_t v = 0; v < 12; v++) {
            const uint32_t zoom = v < 6 ? 1000 : 3000;
            draw(&s, 90 * zoom / 1000, zoom, side[v % 6][0], side[v % 6][1]);
            add_angles(&s);
        }
        const double median = angles.of[angles.count / 2],
                     most = angles.of[angles.count * 95 / 100];
        size_t above_30 = angles.count;
        while (above_30 > 0 && angles.of[above_30 - 1] > 30)
            above_30--;
        const bool is_right = median < shell[i].median && most < shell[i].most_of_95_percent &&
                              (angles.count - above_30) * 1000 < angles.count && angles.away == 0;
        if (!CHECK(is_right))
            printf("# thickness %.1f spacing %.1f: median %.2f, 95 %% %.2f degrees; %zu of %zu "
                   "above 30 degrees, %zu facing away\n",
                   shell[i].thickness, shell[i].spacing, median, most, angles.count - above_30,
                   angles.count, angles.away);
    }
}

/* At zoom 1 and above every pixel within the outline shows the ball, and neighbours on the lit side
 * have nearly the same colour. */
STORY(a_ball_has_no_hole_no_speckle_and_no_staircase)
{
    OWNED(stage_release) struct stage s;
    stage_cube(&s, 81);
    put_ball(&s, 36);
    for (uint32_t zoom = 1000; zoom <= 5000; zoom += 1000) {
        draw(&s, 100 * zoom / 1000, zoom, 33000, 21000);
        const struct rendition *r = &s.rendition;
        const double middle = (r->width - 1) / 2.0, radius = 36.0 * zoom / 1000;
        int jump = 0;
        for (uint32_t y = 1; y < r->height; y++)
            for (uint32_t x = 1; x < r->width; x++) {
                const double d = sqrt(pow(x - middle, 2) + pow(y - middle, 2));
                if (d > 0.9 * radius)
                    continue;
                const size_t i = (size_t)y * r->width + x;
                CHECK(r->cell[i] != CELL_NONE);
                const int left = abs(r->rgba[4 * i] - r->rgba[4 * (i - 1)]);
                const int above = abs(r->rgba[4 * i] - r->rgba[4 * (i - r->width)]);
                jump = left > jump ? left : jump;
                jump = above > jump ? above : jump;
            }
        if (!CHECK(jump <= (zoom == 1000 ? 24 : 12)))
            printf("# zoom %u: neighbours differ by %d\n", zoom, jump);
    }
}

/* A quad may change with a voxel NET_MARGIN steps away, and extends beyond its own voxel by less
 * than a voxel and a half. */
STORY(an_edit_makes_no_more_than_its_surroundings_stale)
{
    OWNED(stage_release) struct stage s;
    stage_cube(&s, 81);
    put_ball(&s, 36);
    for (int mode = SHADE_SURFACE; mode <= SHADE_CUBES; mode++) {
        s.look.mode = (enum shade_mode)mode;
        s.look.edges = true;
        draw(&s, 512, 2000, 0, 0);
        /* Remove a voxel on the front side. */
        const struct grid *grid = &s.scene->grid;
        struct change change = {grid_cell(grid, 40, 76, 40), 1, 0};
        const struct changes changes = {.item = &change, .count = 1};
        s.scene->cell[change.cell].label = 0;
        border_update(&s.border, &changes);
        const struct shade_reach reach = shade_reach(&s.look, &s.camera);
        stage_follow(&s, &s.rendition, &changes);
        size_t stale = 0;
        for (size_t i = 0; i < (size_t)s.rendition.tiles_x * s.rendition.tiles_y; i++)
            stale += s.rendition.stale[i] == TILE_STALE;
        const int voxels = NET_MARGIN + 2;
        const size_t across = (size_t)(2 * (2 * voxels + 1 + reach.pixels) + TILE) / TILE + 1;
        if (!CHECK(stale > 0 && stale <= across * across))
            printf("# mode %d: %zu tiles, at most %zu\n", mode, stale, across * across);
        s.scene->cell[change.cell].label = 1;
        border_recount(&s.border);
    }
}

/* ---- looks ---- */

static int red_at(const struct stage *s, uint32_t x, uint32_t y)
{
    return s->rendition.rgba[4 * ((size_t)y * s->rendition.width + x)];
}

STORY(the_light_comes_from_where_it_is_said_to)
{
    static const struct {
        int32_t light[2];
        uint32_t bright[2], dark[2];
    } lit[] = {{{90000, 0}, {75, 50}, {25, 50}},
               {{-90000, 0}, {25, 50}, {75, 50}},
               {{0, 90000}, {50, 25}, {50, 75}},
               {{0, -90000}, {50, 75}, {50, 25}}};
    OWNED(stage_release) struct stage s;
    stage_cube(&s, 81);
    put_ball(&s, 36);
    for (size_t i = 0; i < sizeof lit / sizeof lit[0]; i++)
        for (int view = 0; view < 4; view++) {
            s.look.light[0] = lit[i].light[0], s.look.light[1] = lit[i].light[1];
            draw(&s, 101, 1000, view * 95000, view * 33000);
            CHECK(red_at(&s, lit[i].bright[0], lit[i].bright[1]) >
                  3 * red_at(&s, lit[i].dark[0], lit[i].dark[1]));
        }
}

STORY(what_lies_far_is_darker_as_the_cue_says)
{
    OWNED(stage_release) struct stage s;
    stage_cube(&s, 81);
    for (int y = 0; y < 81; y++) /* two plates, one far behind the other */
        for (int x = 0; x < 81; x++)
            put(&s, x, x < 40 ? 75 : 5, y, 1);
    border_recount(&s.border);
    s.look.light[0] = s.look.light[1] = 0;
    int near[3], far[3];
    for (uint32_t i = 0; i < 3; i++) {
        s.look.cue_percent = i * 50;
        draw(&s, 81, 1000, 0, 0);
        near[i] = red_at(&s, 60, 40), far[i] = red_at(&s, 20, 40);
    }
    CHECK_INT(near[0], far[0]);
    CHECK(near[1] > far[1] && far[1] > 0 && far[1] < far[0] && far[2] < far[1] && far[2] < 30);
}

STORY(edges_are_drawn_on_the_nearer_object)
{
    OWNED(stage_release) struct stage s;
    stage_cube(&s, 41);
    memset(s.palette.rgb[2], 200, 3);
    for (int z = 0; z < 41; z++)
        for (int x = 0; x < 41; x++) {
            put(&s, x, 10, z, 1);
            for (int y = 21; x < 20 && y <= 30; y++)
                put(&s, x, y, z, 2);
        }
    border_recount(&s.border);
    draw(&s, 41, 1000, 0, 0);
    const int before[2] = {red_at(&s, 20, 20),
                           red_at(&s, 21, 20)}; /* x 20 and 19, from the front */
    CHECK_INT(s.rendition.label[20 * 41 + 20], 1);
    CHECK_INT(s.rendition.label[20 * 41 + 21], 2);
    s.look.edges = true;
    draw(&s, 41, 1000, 0, 0);
    CHECK_INT(red_at(&s, 20, 20), before[0]);
    CHECK(red_at(&s, 21, 20) < before[1] / 2);
}

/* ---- arithmetic ---- */

STORY(the_inverse_root_is_right_to_18_bits)
{
    for (uint64_t v = UINT64_C(1) << 28; v < UINT64_C(1) << 32; v += 65537) {
        const double exact = 35184372088832.0 / sqrt((double)v);
        if (!CHECK(fabs((double)inverse_root(v) / exact - 1) < 0x1p-18))
            break;
    }
}

STORY(samples_become_their_mean_and_the_nearest_of_them)
{
    OWNED(rendition_release) struct rendition fine, out;
    CHECK(rendition_init(&fine, 4, 2, NULL) == OK && rendition_init(&out, 2, 1, NULL) == OK);
    memset(fine.rgba, 0, 4 * 8), memset(fine.normal, 0, 8 * 8), memset(fine.label, 0, 8);
    /* The left pixel: three samples, two of them 100 and one 200; the right one: nothing. */
    const struct {
        size_t at;
        uint8_t red;
        int64_t depth;
    } sample[] = {{0, 100, 7}, {1, 200, 5}, {4, 100, 9}};
    for (int i = 0; i < 3; i++) {
        fine.rgba[4 * sample[i].at] = sample[i].red, fine.rgba[4 * sample[i].at + 3] = 255;
        fine.depth[sample[i].at] = sample[i].depth;
        fine.cell[sample[i].at] = 10 + (uint32_t)i;
        fine.label[sample[i].at] = (uint8_t)(i + 1);
        fine.normal[4 * sample[i].at] = (int16_t)(i + 1);
    }
    rendition_reduce(&out, &fine, 2, NULL);
    CHECK_INT(out.rgba[0], 141); /* the root of 20000 */
    CHECK_INT(out.rgba[3], 191);
    CHECK_INT(out.depth[0], 5);
    CHECK_INT(out.cell[0], 11);
    CHECK_INT(out.label[0], 2);
    CHECK_INT(out.normal[0], 2);
    CHECK(out.cell[1] == CELL_NONE && out.depth[1] == DEPTH_NONE && out.rgba[7] == 0);
}
