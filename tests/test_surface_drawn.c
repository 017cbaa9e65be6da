/* SPDX-License-Identifier: MIT */
/* Pictures of known shapes: the right size, no holes, the right depth, flat where cut. */
#include "tests/check_main.h"

#include <math.h>

#include "tests/stage.h"

static void begin_shape(struct stage *s, uint32_t side, stage_shape *holds)
{
    CHECK(stage_init(s, (uint32_t[]){side, side, side}, 6, NULL) == OK);
    stage_put(s, holds);
}

static void draw(struct stage *s, uint32_t zoom, const int32_t angle[2])
{
    const uint32_t side = s->scene->grid.size[0] * 7 / 4 * zoom / VIEW_ZOOM_ONE;
    rendition_release(&s->rendition);
    s->view = (struct view){.angle = {angle[0], angle[1]}, .zoom = zoom};
    s->view.width = s->view.height = side;
    stage_draw(s);
}

static size_t seen(const struct rendition *r)
{
    size_t count = 0;
    for (size_t i = 0; i < (size_t)r->width * r->height; i++)
        count += r->cell[i] != CELL_NONE;
    return count;
}

static const int32_t side[][2] = {{0, 0},          {45000, 0},      {45000, 35264}, {100000, 46000},
                                  {153000, 69000}, {204000, 92000}, {33000, 12000}, {90000, 90000}};
enum { SIDES = sizeof side / sizeof side[0] };

/* ---- shapes ---- */

static double radius, off[3], tilt[3]; /* parameters of the shape, relative to the middle of the
                                          scene */

static double distance_of(const double at[3])
{
    return sqrt(pow(at[0] - off[0], 2) + pow(at[1] - off[1], 2) + pow(at[2] - off[2], 2));
}
static bool is_ball(const double at[3])
{
    return distance_of(at) <= radius;
}
/* Return the distance along `tilt`, which has length 1. */
static double height_of(const double at[3])
{
    return (at[0] - off[0]) * tilt[0] + (at[1] - off[1]) * tilt[1] + (at[2] - off[2]) * tilt[2];
}
static bool is_rod(const double at[3])
{
    const double d = distance_of(at), h = height_of(at);
    return d * d - h * h <= radius * radius && fabs(h) <= 20;
}
static bool is_below_plane(const double at[3])
{
    return height_of(at) <= 0;
}
static bool is_block(const double at[3])
{
    return fabs(at[0]) <= 100;
}

/* Thin shapes: the name, and whether the voxel at this place is part of it. */
#define THIN_SHAPES(ROW)                                                                           \
    ROW(shell_of_1, distance_of(at) <= 16 && distance_of(at) > 15)                                 \
    ROW(shell_of_2, distance_of(at) <= 16 && distance_of(at) > 14)                                 \
    ROW(shell_of_3, distance_of(at) <= 16 && distance_of(at) > 13)                                 \
    ROW(voxel, at[0] == 0 && at[1] == 0 && at[2] == 0)                                             \
    ROW(pair, at[0] == at[1] && at[1] == at[2] && (at[0] == 0 || at[0] == 1))                      \
    ROW(cube_of_3, fabs(at[0]) <= 1 && fabs(at[1]) <= 1 && fabs(at[2]) <= 1)                       \
    ROW(line, at[1] == 0 && at[2] == 0 && fabs(at[0]) <= 15)                                       \
    ROW(oblique_line, at[1] == at[0] && at[2] == floor(at[0] / 3) && fabs(at[0]) <= 15)            \
    ROW(sheet, at[2] == 0)                                                                         \
    ROW(sheet_at_45_degrees, at[0] + at[1] == 0)                                                   \
    ROW(oblique_sheet, at[0] + at[1] + at[2] == 0)                                                 \
    ROW(gentle_sheet, at[2] == floor(at[0] / 4))                                                   \
    ROW(sheet_on_a_wall, at[0] < -8 || at[1] == 0)                                                 \
    ROW(line_on_a_wall, at[0] < -8 || (at[1] == 0 && at[2] == 0))                                  \
    ROW(voxel_before_a_wall, at[0] < -2 || is_voxel(at))                                           \
    ROW(crossed_sheets, at[0] == 0 || at[1] == 0 || at[2] == 2)                                    \
    ROW(sheets_side_by_side, fmod(at[1] + 100, 2) == 0)                                            \
    ROW(rod_of_3, fabs(at[1]) <= 1 && fabs(at[2]) <= 1)
#define THIN_FUNCTION(name, holds)                                                                 \
    static bool is_##name(const double at[3])                                                      \
    {                                                                                              \
        return holds;                                                                              \
    }
#define THIN_ROW(name, holds) {#name, is_##name},

THIN_SHAPES(THIN_FUNCTION)

static const struct thing {
    const char *name;
    stage_shape *holds;
} thing[] = {THIN_SHAPES(THIN_ROW)};
enum { THINGS = sizeof thing / sizeof thing[0] };

/* ---- sizes ---- */

static double radius_seen(const struct stage *s, uint32_t zoom)
{
    return sqrt((double)seen(&s->rendition) / M_PI) * VIEW_ZOOM_ONE / zoom;
}

STORY(the_silhouette_of_a_ball_is_as_large_as_the_ball)
{
    OWNED(stage_release) struct stage s;
    radius = 40;
    begin_shape(&s, 85, is_ball);
    for (int i = 0; i < SIDES; i++)
        for (uint32_t zoom = 1000; zoom <= 4000; zoom *= 2) {
            draw(&s, zoom, side[i]);
            const double shown = radius_seen(&s, zoom);
            CHECK_WITH(fabs(shown - 40) < 0.1, "view %d zoom %u: radius %.3f", i, zoom, shown);
        }
    s.look.mode = SHADE_CUBES;
    draw(&s, 4000, side[3]);
    CHECK(radius_seen(&s, 4000) > 40.3);
}

static void place_at_random(uint64_t *random)
{
    double squares = 0;
    for (int a = 0; a < 3; a++) {
        off[a] = check_below(random, 1001) / 1000.0 - 0.5;
        tilt[a] = check_below(random, 2001) / 1000.0 - 1;
        squares += tilt[a] * tilt[a];
    }
    for (int a = 0; a < 3; a++)
        tilt[a] /= sqrt(squares);
}

/* Return the mean radius of balls at random places. */
static double mean_ball(double of, uint64_t *random)
{
    double sum = 0;
    for (int ball = 0; ball < 12; ball++) {
        OWNED(stage_release) struct stage s;
        place_at_random(random);
        radius = of;
        begin_shape(&s, 2 * (uint32_t)of + 9, is_ball);
        for (int i = 0; i < 3; i++) {
            draw(&s, 8000, side[(ball * 3 + i) % SIDES]);
            sum += radius_seen(&s, 8000) / 36;
        }
    }
    memset(off, 0, sizeof off);
    return sum;
}

/* Return the mean radius of rods of 40 voxels, seen from the side: half of their covered width. */
static double mean_rod(double of, uint64_t *random)
{
    enum { RODS = 8 };
    double sum = 0;
    for (int rod = 0; rod < RODS; rod++) {
        OWNED(stage_release) struct stage s;
        place_at_random(random);
        const double turn = 2 * M_PI * rod / RODS + check_below(random, 1000) / 1000.0;
        tilt[0] = cos(turn), tilt[1] = 0, tilt[2] = sin(turn); /* across the view from the front */
        radius = of;
        begin_shape(&s, 55, is_rod);
        draw(&s, 4000, side[0]);
        sum += (double)seen(&s.rendition) / 16 / 41 / 2 / RODS;
    }
    memset(off, 0, sizeof off);
    return sum;
}

/* Objects that are 10 % larger must look larger. */
STORY(small_balls_and_rods_keep_their_sizes_and_their_order)
{
    static const double of[] = {1.47, 1.97, 2.37, 2.7, 3.19, 3.6, 4.06, 5.09, 7};
    uint64_t random = 3;
    double ball = 0, rod = 0;
    for (size_t i = 0; i < sizeof of / sizeof of[0]; i++) {
        const double next = mean_ball(of[i], &random);
        const double next_rod = of[i] < 5 ? mean_rod(of[i], &random) : rod + 1;
        if (!CHECK(next > ball && fabs(next / of[i] - 1) < 0.06))
            printf("# a ball of %.2f has a mean radius of %.3f\n", of[i], next);
        if (of[i] < 5 && !CHECK(next_rod > rod && fabs(next_rod / of[i] - 1) < 0.05))
            printf("# a rod of %.2f has a mean radius of %.3f\n", of[i], next_rod);
        ball = next, rod = next_rod;
    }
}

/* At zoom 8 the points of a round silhouette are at nearly the same distance from the middle; those
 * of cubes differ by up to a voxel. */
STORY(a_silhouette_is_curved)
{
    OWNED(stage_release) struct stage s;
    radius = 40;
    begin_shape(&s, 85, is_ball);
    for (int i = 0; i < SIDES; i++) {
        double least = 100, most = 0;
        draw(&s, 8000, side[i]);
        const struct rendition *r = &s.rendition;
        for (uint32_t y = 1; y + 1 < r->height; y++)
            for (uint32_t x = 1; x + 1 < r->width; x++) {
                const size_t p = (size_t)y * r->width + x;
                const bool is_edge =
                    r->cell[p] != CELL_NONE &&
                    (r->cell[p - 1] == CELL_NONE || r->cell[p + 1] == CELL_NONE ||
                     r->cell[p - r->width] == CELL_NONE || r->cell[p + r->width] == CELL_NONE);
                const double d = hypot(x - (r->width - 1) / 2.0, y - (r->height - 1) / 2.0) / 8;
                if (is_edge && d < least)
                    least = d;
                if (is_edge && d > most)
                    most = d;
            }
        CHECK_WITH(most - least < 0.75, "view %d: radii from %.2f to %.2f", i, least, most);
    }
}

/* ---- what is thin ---- */

/* Return true if all pixels up to `reach` around one show something. */
static bool is_within(const struct rendition *r, uint32_t x, uint32_t y, uint32_t reach)
{
    if (x < reach || y < reach || x + reach >= r->width || y + reach >= r->height)
        return false;
    for (uint32_t j = y - reach; j <= y + reach; j++)
        for (uint32_t i = x - reach; i <= x + reach; i++)
            if (r->cell[(size_t)j * r->width + i] == CELL_NONE)
                return false;
    return true;
}

/* Count the empty pixels at least `reach` inside the silhouette of cubes. */
static size_t holes_of(const struct rendition *r, const struct rendition *cubes, uint32_t reach)
{
    size_t holes = 0;
    for (uint32_t y = 0; y < cubes->height; y++)
        for (uint32_t x = 0; x < cubes->width; x++)
            holes +=
                r->cell[(size_t)y * cubes->width + x] == CELL_NONE && is_within(cubes, x, y, reach);
    return holes;
}

/* Corners and lines are rounded: within the rim of a silhouette anything is allowed, but no shape
 * becomes much smaller or larger than its cubes. */
STORY(what_is_thin_has_no_holes_and_does_not_vanish)
{
    for (int t = 0; t < THINGS; t++) {
        OWNED(stage_release) struct stage s;
        OWNED(mesh_release) struct mesh mesh = {0};
        begin_shape(&s, 35, thing[t].holds);
        CHECK(mesh_update(&mesh, &s.border, MESH_CUBES, NULL, NULL, NULL) == OK);
        for (int i = 0; i < SIDES; i++)
            for (uint32_t zoom = 1000; zoom <= 8000; zoom *= zoom < 2000 ? 2 : 4) {
                OWNED(rendition_release) struct rendition cubes;
                draw(&s, zoom, side[i]);
                CHECK(rendition_init(&cubes, s.view.width, s.view.height, NULL) == OK);
                project_border(&cubes, &s.camera, &mesh);
                const uint32_t rim = (uint32_t)ceil(1.5 * zoom / VIEW_ZOOM_ONE);
                const size_t holes = holes_of(&s.rendition, &cubes, rim);
                const double share = (double)seen(&s.rendition) / (double)seen(&cubes);
                if (!CHECK(holes == 0 && share > (zoom == 1000 ? 0.4 : 0.6) &&
                           share < (zoom == 1000 ? 2 : 1.5)))
                    printf("# %s, view %d, zoom %u: %zu holes, %.2f of its cubes\n", thing[t].name,
                           i, zoom, holes, share);
            }
    }
}

/* Sheets of any direction, one voxel thick, whose voxels are connected by faces, as in slices of a
 * wall. */
static bool is_sheet_of_faces(const double at[3])
{
    const double h = height_of(at), most = fabs(tilt[0]) + fabs(tilt[1]) + fabs(tilt[2]);
    return fabs(h) <= most / 2;
}

STORY(a_sheet_of_one_voxel_has_no_hole_from_any_side)
{
    uint64_t random = 9;
    size_t looked_at = 0;
    for (int i = 0; i < 25; i++) {
        OWNED(stage_release) struct stage s;
        place_at_random(&random);
        begin_shape(&s, 31, is_sheet_of_faces);
        for (int view = 0; view < 3; view++) {
            const int32_t angle[2] = {(int32_t)check_below(&random, 360000),
                                      (int32_t)check_below(&random, 360000)};
            draw(&s, view % 2 ? 1000 : 4000, angle);
            /* Find pixels whose ray meets the sheet, well inside the scene. */
            const struct rendition *r = &s.rendition;
            const double scale = (double)s.view.zoom / VIEW_ZOOM_ONE;
            size_t holes = 0;
            for (uint32_t p = 0; p < r->width * r->height; p++) {
                double from[3], along = 0, ahead = 0;
                for (int a = 0; a < 3; a++) {
                    const double right = (p % r->width - (r->width - 1) / 2.0) / scale;
                    const double up = ((r->height - 1) / 2.0 - p / r->width) / scale;
                    from[a] = (right * s.camera.right[a] + up * s.camera.up[a]) / (1 << 30);
                    ahead += tilt[a] * s.camera.ahead[a] / (1 << 30);
                }
                along = fabs(ahead) > 0.2 ? -height_of(from) / ahead : 1000;
                bool is_inside = true;
                for (int a = 0; a < 3; a++)
                    is_inside =
                        is_inside && fabs(from[a] + along * s.camera.ahead[a] / (1 << 30)) < 12;
                looked_at += is_inside;
                holes += is_inside && r->cell[p] == CELL_NONE;
            }
            CHECK_WITH(holes == 0, "sheet %d: %zu holes", i, holes);
        }
    }
    CHECK(looked_at > 20000);
    memset(off, 0, sizeof off);
}

/* Count the visible voxels of a layer of separate voxels; none hides another. */
static size_t voxels_seen(struct stage *s, uint32_t z, uint32_t zoom, const int32_t angle[2])
{
    size_t count = 0;
    draw(s, zoom, angle);
    for (uint32_t i = 0; i < 11 * 11; i++) {
        const uint32_t cell = grid_cell(&s->scene->grid, 3 + i % 11 * 6, 3 + i / 11 * 6, z);
        bool is_seen = false;
        for (size_t p = 0; p < (size_t)s->view.width * s->view.height; p++)
            is_seen = is_seen || s->rendition.cell[p] == cell;
        count += is_seen;
    }
    return count;
}

/* A ball with the volume of a voxel covers a pixel from zoom 1.15 on, wherever it is. Below that
 * some fall between pixels, as some cubes do. */
STORY(a_single_voxel_does_not_vanish)
{
    uint64_t random = 4;
    OWNED(stage_release) struct stage s;
    size_t small = 0, all = 0;
    CHECK(stage_init(&s, (uint32_t[]){64, 64, 64}, 6, NULL) == OK);
    for (uint32_t i = 0; i < 11 * 11; i++)
        s.scene->cell[grid_cell(&s.scene->grid, 3 + i % 11 * 6, 3 + i / 11 * 6, 30)].label = 1;
    border_recount(&s.border);
    for (uint32_t i = 0; i < 16; i++) {
        const int32_t angle[2] = {(int32_t)check_below(&random, 360000),
                                  60000 + (int32_t)check_below(&random, 60000)};
        const size_t count = voxels_seen(&s, 30, i < 8 ? 1000 : 1200 + 100 * i, angle);
        CHECK(i < 8 || count == 11 * 11);
        small += i < 8 ? count : 0;
        all += i < 8 ? 11 * 11 : 0;
    }
    CHECK_WITH(small * 100 >= all * 90, "%zu of %zu voxels are seen at zoom 1", small, all);
}

/* ---- where they lie ---- */

static double apart[400000];

/* Return the 95th percentile of the distances of a picture's points from a shape, except near the
 * scene's edge. `mean` is signed. */
static double most_apart(const struct stage *s, double (*distance)(const double at[3]),
                         double *mean)
{
    size_t count = 0;
    double sum = 0;
    for (size_t p = 0; p < (size_t)s->view.width * s->view.height; p++) {
        double at[3];
        if (s->rendition.cell[p] == CELL_NONE)
            continue;
        stage_point(s, p, at);
        const double most = (s->scene->grid.size[0] - 1) / 2.0 - 8;
        if (fabs(at[0]) > most || fabs(at[1]) > most || fabs(at[2]) > most)
            continue;
        sum += distance(at);
        apart[count++] = fabs(distance(at));
    }
    CHECK(count > 500);
    qsort(apart, count, sizeof *apart, stage_by_size);
    *mean = sum / (double)count;
    return apart[count * 95 / 100];
}

static double above_ball(const double at[3])
{
    return distance_of(at) - radius;
}

/* The choice of voxels makes a plane uncertain by some tenths, but not its mean. */
STORY(depths_are_those_of_planes_and_balls)
{
    uint64_t random = 8;
    double ripple = 0;
    for (int i = 0; i < 12; i++) {
        OWNED(stage_release) struct stage s;
        double mean;
        place_at_random(&random);
        begin_shape(&s, 61, is_below_plane);
        /* Look at the front side of the plane, approximately. */
        const int32_t yaw = (int32_t)(atan2(tilt[0], tilt[1]) * 180000 / M_PI);
        const int32_t pitch = (int32_t)(asin(tilt[2]) * 180000 / M_PI);
        double most = 100;
        for (int sign = -1; sign <= 1; sign += 2) {
            draw(&s, 2000,
                 (const int32_t[]){(sign * yaw + 360000) % 360000, (pitch + 360000) % 360000});
            double facing = 0;
            for (int a = 0; a < 3; a++)
                facing -= tilt[a] * s.camera.ahead[a] / (1 << 30);
            if (facing < 0.8)
                continue;
            most = most_apart(&s, height_of, &mean);
        }
        ripple = most < 100 && most > ripple ? most : ripple;
        if (most < 100 && !CHECK(most < 0.3 && fabs(mean) < 0.1))
            printf("# plane %.2f %.2f %.2f: mean %.3f, 95 %% %.3f voxels\n", tilt[0], tilt[1],
                   tilt[2], mean, most);
    }
    CHECK(ripple > 0);
    for (int i = 0; i < SIDES; i++) {
        OWNED(stage_release) struct stage s;
        double mean;
        place_at_random(&random);
        radius = 20;
        begin_shape(&s, 61, is_ball);
        draw(&s, 3000, side[i]);
        const double most = most_apart(&s, above_ball, &mean);
        if (!CHECK(most < 0.3 && fabs(mean) < 0.1))
            printf("# ball, view %d: mean %.3f, 95 %% %.3f voxels\n", i, mean, most);
    }
    memset(off, 0, sizeof off);
}

/* A scene shows its objects from outside, whatever the order and direction of its axes. */
STORY(what_is_seen_is_the_side_towards_us_in_scenes_of_any_orientation)
{
    for (int i = 0; i < 48; i++) {
        OWNED(stage_release) struct stage s;
        radius = 12;
        begin_shape(&s, 31, is_ball);
        stage_turn(&s, (unsigned)i / 8, (unsigned)i);
        draw(&s, 2000, side[i % SIDES]);
        CHECK(fabs(radius_seen(&s, 2000) - 12) < 0.2);
        for (size_t p = 0; p < (size_t)s.view.width * s.view.height; p++) {
            double at[3], behind = 0;
            if (s.rendition.cell[p] == CELL_NONE)
                continue;
            stage_point(&s, p, at);
            for (int a = 0; a < 3; a++)
                behind += at[a] * s.camera.ahead[a] / (1 << 30);
            CHECK(behind < 1.1 && fabs(above_ball(at)) < 1);
        }
    }
}

/* ---- cuts and the scene's edge ---- */

/* Where a ball is cut open, 12.5 voxels above its middle, the scene appears in a circle, as wide as
 * the middle of the last layer of voxels, and flat. */
STORY(a_face_that_is_cut_open_is_flat_and_ends_where_the_surface_does)
{
    OWNED(stage_release) struct stage s;
    size_t open = 0;
    radius = 40;
    begin_shape(&s, 85, is_ball);
    for (size_t i = 0; i < s.scene->grid.cells; i++)
        s.scene->cell[i].intensity = 77;
    s.border.cut.last[2] = 54;
    border_recount(&s.border);
    s.shader.window[0] = 0, s.shader.window[1] = 255;
    s.look.cue_percent = 0;
    draw(&s, 4000, (const int32_t[]){0, 90000});
    const struct rendition *r = &s.rendition;
    for (size_t i = 0; i < (size_t)r->width * r->height; i++) {
        double at[3];
        if (r->cell[i] == CELL_NONE || r->normal[4 * i] || r->normal[4 * i + 1])
            continue;
        stage_point(&s, i, at);
        open++;
        CHECK(fabs(at[2] - 12.5) < 0.001 && r->normal[4 * i + 2] > 16380);
        CHECK_INT(r->rgba[4 * i], (3 * 77 + s.palette.rgb[1][0] + 2) / 4);
    }
    const double shown = sqrt((double)open / M_PI) / 4;
    CHECK_WITH(fabs(shown - sqrt(1600 - 12 * 12)) < 0.15, "radius %.3f", shown);
}

/* Return the first row of a column that shows something. */
static uint32_t top_of(const struct rendition *r, uint32_t x)
{
    uint32_t y = 0;
    while (y < r->height && r->cell[(size_t)y * r->width + x] == CELL_NONE)
        y++;
    return y;
}

/* Count the columns whose top is more than a pixel off the mean of its neighbours. */
static unsigned count_teeth(const struct rendition *r)
{
    unsigned teeth = 0;
    for (uint32_t x = r->width / 4; x < r->width * 3 / 4; x++) {
        const int64_t across = 2 * (int64_t)top_of(r, x) - top_of(r, x - 1) - top_of(r, x + 1);
        teeth += across > 1 || across < -1;
    }
    return teeth;
}

/* A ball without its upper half, from all sides. */
STORY(the_rim_of_a_cut_is_a_line)
{
    OWNED(stage_release) struct stage s;
    radius = 40;
    begin_shape(&s, 85, is_ball);
    s.border.cut.last[2] = 42;
    border_recount(&s.border);
    for (int32_t pitch = -70000; pitch <= 70000; pitch += 20000) {
        draw(&s, 8000, (const int32_t[]){20000, pitch});
        if (!CHECK(count_teeth(&s.rendition) <= 2))
            printf("# pitch %d: %u teeth\n", pitch, count_teeth(&s.rendition));
    }
}

/* A scene that is one object is a box with sharp edges, without cut faces. */
STORY(the_edge_of_the_scene_is_flat)
{
    static const int32_t angle[][2] = {{0, 0}, {90000, 0}, {0, 90000}, {180000, 0}, {0, 270000}};
    OWNED(stage_release) struct stage s;
    begin_shape(&s, 21, is_block);
    for (size_t i = 0; i < sizeof angle / sizeof angle[0]; i++) {
        draw(&s, 4000, angle[i]);
        CHECK_INT(seen(&s.rendition), 84 * 84);
        const struct rendition *r = &s.rendition;
        const size_t middle = (size_t)(r->height / 2) * r->width + r->width / 2;
        for (size_t p = 0; p < (size_t)r->width * r->height; p++)
            if (r->cell[p] != CELL_NONE) {
                CHECK(memcmp(r->normal + 4 * p, r->normal + 4 * middle, 8) == 0);
                CHECK(memcmp(r->rgba + 4 * p, r->rgba + 4 * middle, 4) == 0);
                CHECK(r->depth[p] >> NUMBER_BITS == r->depth[middle] >> NUMBER_BITS);
            }
    }
}
