/* SPDX-License-Identifier: MIT */
/* Ambient occlusion: bricks equal a plain count, flat and convex surfaces are unchanged, a groove
 * is darker, and all ways of drawing agree. */
#include "tests/check_main.h"

#include <math.h>

#include "render/light.h"
#include "render/occlusion.h"
#include "tests/border_check.h"
#include "tests/scarce_memory.h"
#include "tests/stage.h"

/* ---- bricks ---- */

/* Return the number of shown voxels of a brick, scaled to 64; bricks are numbered from the scene's
 * first. */
static int64_t shown_in_brick(const struct stage *s, const struct bricks *bricks,
                              const int64_t number[3])
{
    const struct grid *grid = &s->scene->grid;
    int64_t first[3], count = 0, voxels = 1;
    for (int a = 0; a < 3; a++) {
        first[a] = number[a] * (1 << bricks->bits[a]);
        voxels <<= bricks->bits[a];
    }
    for (int64_t z = first[2]; z < first[2] + (1 << bricks->bits[2]); z++)
        for (int64_t y = first[1]; y < first[1] + (1 << bricks->bits[1]); y++)
            for (int64_t x = first[0]; x < first[0] + (1 << bricks->bits[0]); x++)
                count += grid_contains(grid, x, y, z) &&
                         border_should_show(&s->border,
                                            grid_cell(grid, (uint32_t)x, (uint32_t)y, (uint32_t)z));
    return count * 64 / voxels;
}

static int64_t smoothed(const struct stage *s, const struct bricks *bricks, const int64_t number[3])
{
    int64_t sum = 0;
    for (int k = -1; k <= 1; k++)
        for (int j = -1; j <= 1; j++)
            for (int i = -1; i <= 1; i++) {
                const int64_t near[3] = {number[0] + i, number[1] + j, number[2] + k};
                sum += shown_in_brick(s, bricks, near) * (2 - abs(i)) * (2 - abs(j)) * (2 - abs(k));
            }
    return sum;
}

/* Interpolate between the centres of eight bricks, in units of BRICK_FULL. */
static double expected_around(const struct stage *s, const struct bricks *bricks,
                              const int32_t point[3])
{
    int64_t first[3];
    double part[3], sum = 0;
    for (int a = 0; a < 3; a++) {
        const double side = 1 << bricks->bits[a];
        const double at = (point[a] / 256.0 - (side - 1) / 2) / side;
        first[a] = (int64_t)floor(at);
        part[a] = at - floor(at);
    }
    for (int i = 0; i < 8; i++) {
        const int64_t number[3] = {first[0] + (i & 1), first[1] + (i >> 1 & 1),
                                   first[2] + (i >> 2)};
        double share = BRICK_FULL / 4096;
        for (int a = 0; a < 3; a++)
            share *= i >> a & 1 ? part[a] : 1 - part[a];
        sum += share * (double)smoothed(s, bricks, number);
    }
    return sum;
}

/* Compare at points that are whole 256ths between the centres of bricks. */
static void compare_bricks(const struct stage *s, const struct bricks *bricks, uint64_t *random)
{
    for (int i = 0; i < 12; i++) {
        int32_t point[3];
        for (int a = 0; a < 3; a++)
            point[a] = 4 * (int32_t)check_below(random, 64 * (s->scene->grid.size[a] + 60)) - 7680;
        const double around = bricks_around(bricks, point);
        const double expected = expected_around(s, bricks, point);
        if (!CHECK(around <= expected + 0.01 && around > expected - 3))
            printf("# %d,%d,%d: %g for %g\n", point[0], point[1], point[2], around, expected);
    }
}

static void stage_at_random(struct stage *s, uint32_t least, uint32_t most, uint64_t *random)
{
    uint32_t size[3];
    for (int a = 0; a < 3; a++)
        size[a] = least + check_below(random, most - least + 1);
    CHECK(stage_init(s, size, 6, NULL) == OK);
    random_values(s->scene, 4000, random);
    s->scene->spacing_nm[check_below(random, 3)] = 100000 + check_below(random, 9000000);
    s->shader.window[1] = 4000;
}

/* Hide labels or cut the scene. */
static void show_at_random(struct stage *s, uint64_t *random)
{
    const uint32_t a = check_below(random, 3);
    s->border.cut = cut_none();
    if (check_below(random, 2))
        s->border.cut.last[a] = check_below(random, s->scene->grid.size[a]);
    for (int label = 1; label < 4; label++)
        s->border.visible[label] = check_below(random, 3) > 0;
    border_recount(&s->border);
}

STORY(bricks_are_what_is_counted_and_follow_edits_cuts_and_what_is_hidden)
{
    for (unsigned number = 0; number < check_scaled(30) && check_failures == 0; number++) {
        uint64_t random = number;
        OWNED(stage_release) struct stage s;
        struct bricks bricks = {0};
        stage_at_random(&s, 1, number % 3 ? 40 : 90, &random);
        for (int i = 0; i < 12 && check_failures == 0; i++) {
            if (i % 4 == 3)
                show_at_random(&s, &random);
            else
                stage_seed_at_random(&s, &random);
            CHECK(bricks_update(&bricks, &s.border, NULL) == OK);
            compare_bricks(&s, &bricks, &random);
        }
        CHECK(bricks_bytes(&bricks) > 0);
        bricks_release(&bricks);
        CHECK_INT(bricks_bytes(&bricks), 0);
    }
}

/* Show all voxels further than `reach` steps from a voxel along an axis. */
static void show_beyond(struct stage *s, const uint32_t voxel[3], int reach)
{
    const struct grid *grid = &s->scene->grid;
    for (uint32_t z = 0; z < grid->size[2]; z++)
        for (uint32_t y = 0; y < grid->size[1]; y++)
            for (uint32_t x = 0; x < grid->size[0]; x++) {
                const uint32_t at[3] = {x, y, z};
                bool is_beyond = false;
                for (int a = 0; a < 3; a++)
                    is_beyond = is_beyond || abs((int)at[a] - (int)voxel[a]) > reach;
                s->scene->cell[grid_cell(grid, x, y, z)].label = is_beyond;
            }
    border_recount(&s->border);
}

/* Return the largest fullness at the points of any normal, around points in the cube of a voxel. */
static uint32_t most_around(const struct stage *s, const uint32_t voxel[3], uint64_t *random)
{
    OWNED(bricks_release) struct bricks bricks = {0};
    struct occluder occluder;
    uint32_t most = 0;
    CHECK(bricks_update(&bricks, &s->border, NULL) == OK);
    occluder_init(&occluder, &bricks, &s->camera, 100);
    for (int i = 0; i < 300; i++) {
        int64_t way[3];
        int16_t normal[3] = {0};
        for (int a = 0; a < 3; a++)
            way[a] = check_below(random, 4) ? (int)check_below(random, 2001) - 1000 : 0;
        normalise_one(normal, way);
        for (int k = 0; k < OCCLUSION_POINTS; k++) {
            int32_t at[3];
            for (int a = 0; a < 3; a++)
                at[a] = (int32_t)(256 * voxel[a] + check_below(random, 257)) - 128 +
                        (normal[a] * occluder.away[k][a] >> NORMAL_BITS);
            const uint32_t around = bricks_around(&bricks, at);
            most = around > most ? around : most;
        }
    }
    return most;
}

STORY(nothing_counts_that_is_beyond_the_reach)
{
    static const uint32_t spacing[][3] = {{1, 1, 1}, {1, 1, 2}, {5, 1, 1}, {2, 3, 2}, {1, 6, 40}};
    for (unsigned number = 0; number < check_scaled(25) && check_failures == 0; number++) {
        uint64_t random = number;
        OWNED(stage_release) struct stage s;
        uint32_t voxel[3];
        CHECK(stage_init(&s, (uint32_t[]){80, 80, 80}, 6, NULL) == OK);
        for (int a = 0; a < 3; a++) {
            s.scene->spacing_nm[a] = spacing[number % 5][a] * 300000;
            voxel[a] = 38 + check_below(&random, 4);
        }
        CHECK(camera_init(&s.camera, s.scene, &s.view, NULL) == OK);
        const int reach = occlusion_reach(s.scene);
        show_beyond(&s, voxel, reach);
        CHECK_INT(most_around(&s, voxel, &random), 0);
        show_beyond(&s, voxel, reach - 7);
        CHECK(most_around(&s, voxel, &random) > 0 || reach > 40);
    }
}

/* ---- known shapes ---- */

/* The red of the stage's picture, without occlusion and with all of it. */
struct brightness {
    uint32_t width;
    uint8_t none[120 * 120], all[120 * 120];
};

static void draw(struct stage *s, uint32_t percent, uint8_t *red)
{
    rendition_release(&s->rendition);
    s->look.ao_percent = percent;
    stage_draw(s);
    for (size_t i = 0; i < (size_t)s->view.width * s->view.height; i++)
        red[i] = s->rendition.rgba[4 * i];
}

static void measure(struct brightness *b, struct stage *s)
{
    b->width = s->view.width = s->view.height = 120;
    s->look.cue_percent = 0;
    draw(s, 0, b->none);
    draw(s, 100, b->all);
}

/* Return the loss of a pixel, of 1000. */
static int lost_at(const struct brightness *b, uint32_t x, uint32_t y)
{
    const int none = b->none[y * b->width + x], all = b->all[y * b->width + x];
    return none ? (none - all) * 1000 / none : 0;
}

static int most_lost(const struct brightness *b)
{
    int most = 0;
    for (uint32_t i = 0; i < b->width * b->width; i++) {
        const int lost = lost_at(b, i % b->width, i / b->width);
        most = lost > most ? lost : most;
    }
    return most;
}

/* Scenes have 60 voxels a side. */
static int box_from[3], box_end[3];
static bool is_in_box(const double at[3])
{
    bool is_in = true;
    for (int a = 0; a < 3; a++)
        is_in = is_in && at[a] + 29.5 >= box_from[a] && at[a] + 29.5 < box_end[a];
    return is_in;
}
static bool is_in_ball(const double at[3])
{
    return pow(at[0] - 0.5, 2) + pow(at[1] - 0.5, 2) + pow(at[2] - 0.5, 2) <= 24 * 24;
}

/* A block, its front at y = 40, with a groove of 4 voxels across x = 30, 14 deep. */
static bool is_in_block(const double at[3])
{
    const double x = at[0] + 29.5, y = at[1] + 29.5, z = at[2] + 29.5;
    const bool is_in_groove = x >= 28 && x < 32 && y > 26;
    return y > 5 && y <= 40 && z > 5 && z < 55 && x > 2 && x < 58 && !is_in_groove;
}

/* Where voxels are long, smooth surfaces round off the corners of a box. */
STORY(what_is_flat_or_convex_stays_as_it_is)
{
    static const uint32_t spacing[][3] = {{1, 1, 1}, {1, 1, 3}, {5, 1, 1}, {2, 3, 2}, {1, 2, 4}};
    enum { SPACINGS = sizeof spacing / sizeof spacing[0] };
    for (unsigned number = 0; number < check_scaled(30) && check_failures == 0; number++) {
        uint64_t random = number;
        OWNED(stage_release) struct stage s;
        struct brightness b;
        CHECK(stage_init(&s, (uint32_t[]){60, 60, 60}, 6, NULL) == OK);
        const uint32_t *unit = spacing[number % SPACINGS];
        for (int a = 0; a < 3; a++) {
            s.scene->spacing_nm[a] = unit[a] * 500000;
            box_from[a] = (int)check_below(&random, 24);
            box_end[a] = box_from[a] + 12 + (int)check_below(&random, 24);
            s.view.angle[a] = (int32_t)check_below(&random, VIEW_TURN);
        }
        const bool is_smooth = number % SPACINGS == 0 && number % 2;
        s.look.mode = is_smooth ? SHADE_SURFACE : SHADE_CUBES;
        stage_put(&s, is_in_box);
        measure(&b, &s);
        const int of_box = most_lost(&b);
        stage_put(&s, is_in_ball);
        measure(&b, &s);
        const int of_ball = is_smooth ? most_lost(&b) : 0; /* cubes are stairs */
        if (!CHECK(of_box <= 10 && of_ball <= 10))
            printf("# number %u: %d and %d of 1000 are lost\n", number, of_box, of_ball);
    }
}

STORY(a_groove_is_darker_than_its_rim_and_no_darker_than_the_look_says)
{
    OWNED(stage_release) struct stage s;
    struct brightness b;
    CHECK(stage_init(&s, (uint32_t[]){60, 60, 60}, 6, NULL) == OK);
    CHECK(view_by_name("front", s.view.angle));
    s.view.zoom = 2000;
    stage_put(&s, is_in_block);
    measure(&b, &s);
    const int floor = lost_at(&b, 60, 60), rim = lost_at(&b, 67, 60), flat = lost_at(&b, 90, 60);
    printf("# of 1000: %d on the floor of a groove, %d on its rim, %d aside\n", floor, rim, flat);
    CHECK(floor > 600 && rim < floor / 8 && flat == 0);
    draw(&s, 40, b.all);
    CHECK(lost_at(&b, 60, 60) > 200 && lost_at(&b, 60, 60) <= 400);
}

/* ---- ways to a picture ---- */

static void colour(struct stage *s, struct rendition *r, struct shader *shader)
{
    CHECK(shade(r, &s->camera, &s->mesh, &s->palette, &s->look, shader, NULL) == OK);
    stage_fill(r);
}

/* Compare with pictures drawn from scratch in three ways, by an empty shader. */
static bool agrees(struct stage *s, const struct rendition *kept)
{
    static projection *const ways[] = {project_border, project_scene, project_rays};
    bool fine = true;
    for (int i = 0; i < 3; i++) {
        OWNED(rendition_release) struct rendition other;
        OWNED(shader_release) struct shader shader = {.window = {0, 4000}};
        CHECK(rendition_init(&other, s->view.width, s->view.height, NULL) == OK);
        ways[i](&other, &s->camera, &s->mesh);
        colour(s, &other, &shader);
        fine = CHECK(stage_same_pixels(&other, kept, "another way")) && fine;
    }
    return fine;
}

/* Each label is one half of the scene and the seeds planted in it, so that edits change little. */
static void begin_halves(struct stage *s)
{
    const struct grid *g = &s->scene->grid;
    const struct edit halves[2] = {
        {grid_cell(g, 0, 0, 0), 0, 0},
        {grid_cell(g, g->size[0] - 1, g->size[1] - 1, g->size[2] - 1), 1, 0}};
    CHECK(forest_edit(s->forest, halves, 2, NULL) == OK);
    const struct changes changes = forest_changes(s->forest);
    border_update(&s->border, &changes);
}

/* Scenes are larger than the reach of an edit, and weights high along some planes, so that objects
 * have sides there. */
static void sitting(unsigned number, struct team *team)
{
    uint64_t random = number;
    OWNED(stage_release) struct stage s;
    size_t repaired = 0, tiles = 0;
    stage_at_random(&s, 30, 80, &random);
    begin_halves(&s);
    for (int i = 0; i < 12; i++)
        stage_seed_at_random(&s, &random);
    for (int look = 0; look < 3 && check_failures == 0; look++) {
        rendition_release(&s.rendition);
        show_at_random(&s, &random);
        stage_look_at_random(&s, &random);
        memset(s.border.opacity, BORDER_OPAQUE, sizeof s.border.opacity);
        s.look.ao_percent = 100;
        s.view.width = 20 + check_below(&random, 120);
        s.view.height = 20 + check_below(&random, 120);
        s.view.zoom = 500 + check_below(&random, 4000);
        s.shader.team = team;
        stage_draw(&s);
        for (int i = 0; i < 5 && agrees(&s, &s.rendition); i++) {
            const struct changes changes = stage_seed_at_random(&s, &random);
            stage_follow(&s, &s.rendition, &changes);
            repaired += rendition_count(&s.rendition, TILE_STALE);
            tiles += (size_t)s.rendition.tiles_x * s.rendition.tiles_y;
            colour(&s, &s.rendition, &s.shader);
        }
        if (check_failures)
            printf("# number %u look %d: mode %d, %zu of %zu tiles were repaired\n", number, look,
                   (int)s.look.mode, repaired, tiles);
    }
}

STORY(four_ways_agree_and_the_incremental_image_follows_edits)
{
    OWNED(team_drop) struct team *team = NULL;
    CHECK(team_new(&team, 3, NULL) == OK);
    for (unsigned number = 0; number < check_scaled(12) && check_failures == 0; number++)
        sitting(number, number % 2 ? team : NULL);
}

STORY(translucent_objects_let_the_light_in)
{
    OWNED(stage_release) struct stage s;
    uint8_t none[60 * 60], all[60 * 60];
    CHECK(stage_init(&s, (uint32_t[]){60, 60, 60}, 6, NULL) == OK);
    CHECK(view_by_name("front", s.view.angle));
    s.view.width = s.view.height = 60;
    stage_put(&s, is_in_block);
    s.border.opacity[2] = 50;
    draw(&s, 0, none);
    const size_t bytes = shader_bytes(&s.shader);
    draw(&s, 100, all);
    CHECK(memcmp(none, all, sizeof none) == 0);
    CHECK_INT(shader_bytes(&s.shader), bytes);
    s.border.opacity[2] = 100;
    draw(&s, 0, none);
    const size_t without = shader_bytes(&s.shader);
    draw(&s, 100, all);
    CHECK(memcmp(none, all, sizeof none) != 0 && shader_bytes(&s.shader) > without);
}

STORY(memory_that_runs_out_is_an_error_and_the_next_picture_is_right)
{
    OWNED(stage_release) struct stage s;
    size_t failed = 0;
    CHECK(stage_init(&s, (uint32_t[]){60, 60, 60}, 6, NULL) == OK);
    s.view.width = s.view.height = 60;
    stage_put(&s, is_in_block);
    s.look.ao_percent = 100;
    s.look.creases = 1;
    stage_draw(&s);
    const uint64_t expected = rendition_digest(&s.rendition);
    OWNED(shader_release) struct shader counted = {.window = {0, 4000}};
    memset(s.rendition.stale, TILE_STALE, (size_t)s.rendition.tiles_x * s.rendition.tiles_y);
    count_allocations();
    CHECK(shade(&s.rendition, &s.camera, &s.mesh, &s.palette, &s.look, &counted, NULL) == OK);
    mem_allows = NULL;
    for (size_t left = 0; check_failures == 0; left++) {
        OWNED(shader_release) struct shader shader = {.window = {0, 4000}};
        struct fault fault = {0};
        memset(s.rendition.stale, TILE_STALE, (size_t)s.rendition.tiles_x * s.rendition.tiles_y);
        allow_allocations(left);
        const enum err err =
            shade(&s.rendition, &s.camera, &s.mesh, &s.palette, &s.look, &shader, &fault);
        mem_allows = NULL;
        CHECK(err == OK || err == ERR_MEMORY);
        if (err)
            failed++;
        colour(&s, &s.rendition, &shader);
        CHECK(rendition_digest(&s.rendition) == expected);
        if (!err)
            break;
    }
    CHECK_INT(failed, allocations_made);
}
