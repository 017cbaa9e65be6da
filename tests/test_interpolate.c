/* SPDX-License-Identifier: MIT */
/* Interpolation: by hand, and compared with a plain computation. tests/test_command.c and
 * tests/test_history.c show that it can be undone. */
#include "session/session_inside.h"
#include "session/session.h"
#include "tests/border_check.h"
#include "tests/check_main.h"

static struct scene *random_scene(uint64_t *random, uint32_t side_most, bool extreme)
{
    struct scene *scene;
    const uint32_t size[3] = {1 + check_below(random, side_most),
                              1 + check_below(random, side_most),
                              1 + check_below(random, side_most)};
    if (scene_new(&scene, size, NULL, NULL, NULL) != OK)
        abort();
    const struct grid *grid = &scene->grid;
    for (uint32_t z = 0; z < size[2]; z++)
        for (uint32_t y = 0; y < size[1]; y++)
            for (uint32_t x = 0; x < size[0]; x++)
                scene->cell[grid_cell(grid, x, y, z)].intensity =
                    (uint16_t)(extreme ? 65535 - check_below(random, 2)
                                       : check_below(random, 65536));
    for (int a = 0; a < 3; a++)
        scene->spacing_nm[a] = 1 + check_below(random, 2000000);
    return scene;
}

static uint16_t intensity_at(const struct scene *scene, uint32_t x, uint32_t y, uint32_t z)
{
    return scene->cell[grid_cell(&scene->grid, x, y, z)].intensity;
}

/* The mean of all base voxels less than one base step away along each axis, in half steps. */
static uint16_t plain_mean(const struct scene *base, const uint32_t at[3], unsigned doubled)
{
    uint64_t sum = 0, count = 0;
    for (uint32_t z = 0; z < base->grid.size[2]; z++)
        for (uint32_t y = 0; y < base->grid.size[1]; y++)
            for (uint32_t x = 0; x < base->grid.size[0]; x++) {
                const uint32_t p[3] = {x, y, z};
                bool near = true;
                for (unsigned a = 0; a < 3; a++) {
                    bool twice = doubled >> a & 1;
                    int64_t off = (int64_t)(twice ? 2 * p[a] : p[a]) - at[a];
                    near = near && (twice ? llabs(off) < 2 && (off == 0 || at[a] % 2) : off == 0);
                }
                sum += near ? intensity_at(base, x, y, z) : 0;
                count += near;
            }
    return (uint16_t)((2 * sum + count) / (2 * count));
}

STORY(between_two_voxels_comes_their_mean)
{
    static const uint16_t row[3] = {10, 13, 65535};
    for (unsigned a = 0; a < 3; a++) {
        uint32_t size[3] = {1, 1, 1};
        OWNED(scene_drop) struct scene *base = NULL, *scene = NULL;
        size[a] = 3;
        CHECK(scene_new(&base, size, row, NULL, NULL) == OK);
        base->spacing_nm[a] = 333;
        base->world_axis[a] = 2, base->world_sign[a] = -1;
        CHECK(scene_new_interpolated(&scene, base, 1U << a, NULL, NULL) == OK);
        CHECK_INT(scene->grid.size[a], 5);
        CHECK_INT(scene->grid.voxels, 5);
        CHECK_INT(scene->spacing_nm[a], 167);
        CHECK(scene->world_axis[a] == 2 && scene->world_sign[a] == -1);
        const uint16_t expected[5] = {10, 12, 13, 32774, 65535};
        for (uint32_t i = 0; i < 5; i++)
            CHECK_INT(intensity_at(scene, a == 0 ? i : 0, a == 1 ? i : 0, a == 2 ? i : 0),
                      expected[i]);
    }
}

STORY(every_voxel_is_the_mean_of_those_around_it)
{
    uint64_t random = 7;
    for (int i = 0; i < 200; i++) {
        OWNED(scene_drop) struct scene *base = random_scene(&random, 5, i % 4 == 0), *scene = NULL;
        unsigned doubled = check_below(&random, 8);
        if (!CHECK(scene_new_interpolated(&scene, base, doubled, NULL, NULL) == OK))
            return;
        const uint32_t *size = scene->grid.size;
        size_t wrong = 0;
        for (uint32_t z = 0; z < size[2]; z++)
            for (uint32_t y = 0; y < size[1]; y++)
                for (uint32_t x = 0; x < size[0]; x++)
                    wrong += intensity_at(scene, x, y, z) !=
                             plain_mean(base, (uint32_t[]){x, y, z}, doubled);
        CHECK_INT(wrong, 0);
        for (unsigned a = 0; a < 3; a++) {
            bool twice = doubled >> a & 1;
            CHECK_INT(size[a], twice ? 2 * base->grid.size[a] - 1 : base->grid.size[a]);
            CHECK_INT(scene->spacing_nm[a],
                      twice ? (base->spacing_nm[a] + 1) / 2 : base->spacing_nm[a]);
        }
        if (doubled == 0)
            CHECK(scene_digest(scene) == scene_digest(base));
    }
}

/* ---- in a session ---- */

static void begin(struct session **begun)
{
    CHECK(session_new(begun, NULL) == OK);
    struct session *session = *begun;
    CHECK(session_open(session, "synth:geom", NULL, NULL) == OK);
    session_mark(session);
}

STORY(geom_interpolated_is_what_opening_it_so_gives)
{
    static const char *const name[] = {"synth:geom:211", "synth:geom:121", "synth:geom:112"};
    static const unsigned doubled[] = {1, 2, 4};
    for (int i = 0; i < 3; i++) {
        OWNED(session_drop) struct session *opened = NULL, *session = NULL;
        CHECK(session_new(&opened, NULL) == OK && session_open(opened, name[i], NULL, NULL) == OK);
        begin(&session);
        CHECK(session_interpolate(session, doubled[i], NULL) == OK);
        CHECK(session->scene_digest == opened->scene_digest);
        CHECK(session->weight_digest == opened->weight_digest);
        CHECK(memcmp(&session->now.outlook.view, &opened->now.outlook.view, sizeof(struct view)) ==
              0);
        CHECK(memcmp(session->geometry.to_mm, opened->geometry.to_mm,
                     sizeof opened->geometry.to_mm) == 0);
        session_settle(session);
        CHECK_INT(session_memory(session), session_memory(opened));
    }
}

STORY(voxels_stay_where_they_are_in_the_world)
{
    OWNED(session_drop) struct session *session;
    begin(&session);
    const double placed[3][4] = {{0, -2, 0.25, 10}, {1.5, 0, 0, -20}, {0.5, 0, 3, 7}};
    CHECK(geometry_place(&session->said, placed, ORIENTATION_SFORM));
    CHECK(session_interpolate(session, 5, NULL) == OK);
    const uint32_t twice[3] = {2, 1, 2};
    for (int w = 0; w < 3; w++) {
        double before = placed[w][3], now = session->geometry.to_mm[w][3];
        for (int a = 0; a < 3; a++) {
            before += placed[w][a] * (a + 3);
            now += session->geometry.to_mm[w][a] * (a + 3) * twice[a];
        }
        CHECK(before == now);
    }
    CHECK_INT(session->geometry.spacing_nm[0], 500000);
    CHECK_INT(session->geometry.spacing_nm[1], 1000000);
    CHECK_INT(session->geometry.spacing_nm[2], 500000);
}

STORY(once_seeds_are_there_it_is_refused)
{
    OWNED(session_drop) struct session *session = NULL;
    struct fault fault = {0};
    begin(&session);
    const uint64_t digest = session->scene_digest;
    CHECK(session_plant(session, (uint32_t[]){grid_cell(&session->scene->grid, 5, 5, 5)}, 1, 1, 0,
                        NULL) == OK);
    CHECK(session_interpolate(session, 7, &fault) == ERR_USAGE);
    CHECK_HAS(fault.text, "this one has 0 seeds and 1 pending edit;");
    CHECK(session_run(session, NULL) == OK && session_interpolate(session, 7, &fault) == ERR_USAGE);
    CHECK_HAS(fault.text, "before its first seed, and this one has 1 seed and 0 pending edits;");
    CHECK(session->scene_digest == digest && session->inside->former_scene.scene == NULL);
    CHECK(session_erase_trees(session, (uint32_t[]){grid_cell(&session->scene->grid, 5, 5, 5)}, 1,
                              NULL) == OK);
    CHECK(session_run(session, NULL) == OK && session_interpolate(session, 1, &fault) == OK);
}

STORY(a_range_holds_on_and_files_of_the_grid_refuse)
{
    struct session *session;
    struct fault fault = {0};
    begin(&session);
    const struct decimal range[] = {{1, 2, 1}, {24, 1, 1}};
    CHECK(session_set_range(session, 0, range, NULL) == OK);
    const struct roi_tally tally = session->roi_tally;
    CHECK(session_interpolate(session, 4, NULL) == OK);
    const struct roi_tally finer = roi_tally(&session->roi, session->scene);
    CHECK(finer.inside > tally.inside && finer.inside == session->roi_tally.inside);
    const uint32_t dark = grid_cell(&session->scene->grid, 0, 0, 0);
    CHECK(session_plant(session, (uint32_t[]){grid_cell(&session->scene->grid, 66, 110, 100)}, 1, 1,
                        0, NULL) == OK);
    CHECK(session_run(session, NULL) == OK);
    CHECK(session->scene->cell[dark].label == 0 && forest_check(session->forest, NULL));
    session_mark(session);
    CHECK(session_erase_trees(session, (uint32_t[]){grid_cell(&session->scene->grid, 66, 110, 100)},
                              1, NULL) == OK);
    CHECK(session_run(session, NULL) == OK);
    session_free(session);

    begin(&session);
    const size_t bytes = mask_bytes(&session->scene->grid);
    uint64_t *mask = malloc(bytes);
    if (CHECK(mask != NULL)) {
        memset(mask, 255, bytes);
        CHECK(session_set_mask(session, mask, "mask.nii", (const uint32_t[]){1, 1}, NULL, NULL) ==
              OK);
        CHECK(session_interpolate(session, 1, &fault) == ERR_USAGE);
        CHECK_HAS(fault.text,
                  "a mask, a channel or weights from a file belong to the present grid");
    }
    free(mask);
    session_free(session);

    begin(&session);
    OWNED(mem_release) uint16_t *weight = calloc(session->scene->grid.voxels, sizeof *weight);
    if (CHECK(weight != NULL))
        CHECK(session_set_weight_map(session, "weight.nii", weight, NULL) == OK);
    CHECK(session_interpolate(session, 1, &fault) == ERR_USAGE);
    CHECK_HAS(fault.text, "a mask, a channel or weights from a file belong to the present grid");
    session_free(session);
}

STORY(an_axis_of_one_voxel_stays)
{
    static const uint32_t flat[3] = {4, 1, 1};
    OWNED(session_drop) struct session *session;
    begin(&session);
    border_release(&session->border); /* a scene of one row in place of geom */
    forest_free(session->forest);
    scene_free(session->scene);
    CHECK(scene_new(&session->scene, flat, NULL, NULL, NULL) == OK);
    CHECK(forest_new(&session->forest, session->scene, 6, NULL) == OK);
    CHECK(border_init(&session->border, session->scene, NULL) == OK);
    CHECK(session_interpolate(session, 6, NULL) == OK);
    CHECK(session->inside->former_scene.scene == NULL);
    CHECK(session_interpolate(session, 7, NULL) == OK);
    CHECK_INT(session->scene->grid.size[0], 7);
    CHECK_INT(session->scene->grid.voxels, 7);
    CHECK_INT(session->geometry.spacing_nm[1], 1000000);
}
