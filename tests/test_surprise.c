/* SPDX-License-Identifier: MIT */
/* Surprises: a command that took far more voxels than it planted reports this and the edge through
 * which it did. Commands with the expected effect, and replays, report nothing. */
#include "engine/way.h"
#include "image/volume.h"
#define RUN_IN_FOLDER
#include "tests/folder_main.h"
#include "tests/interpreting.h"

static struct interpreter interp;
/* ---- the edge, by hand ---- */

STORY(a_passage_is_the_strongest_edge_that_most_paths_share)
{
    /* A seed of label 1 at voxel 0 comes through the 5, and at last, in one voxel, the 9. */
    static const uint16_t weight[] = {1, 1, 1, 1, 5, 1, 1, 2, 1, 1, 1, 9, 1};
    enum { VOXELS = sizeof weight / sizeof *weight, REST = 400 }; /* which stays label 2's */
    OWNED(scene_drop) struct scene *scene = NULL;
    OWNED(forest_drop) struct forest *forest = NULL;
    uint32_t at = 0;
    CHECK(scene_new(&scene, (const uint32_t[]){VOXELS + REST, 1, 1}, NULL, NULL, NULL) == OK);
    CHECK(forest_new(&forest, scene, 6, NULL) == OK);
    const uint32_t first = grid_cell(&scene->grid, 0, 0, 0);
    for (uint32_t x = 0; x < VOXELS + REST; x++)
        scene->cell[first + x].weight = x < VOXELS ? weight[x] : 1;
    CHECK(forest_edit(forest, &(struct edit){first + VOXELS - 1, 2, 0}, 1, NULL) == OK);
    CHECK(!passage_find(&at, forest, 0)); /* what grew from nothing has no list */
    CHECK(forest_edit(forest, &(struct edit){first, 1, 0}, 1, NULL) == OK);
    CHECK_INT(scene->cell[first + 10].label, 1);
    CHECK(passage_find(&at, forest, 2));
    CHECK_INT(at, first + 4);
    CHECK(!passage_find(&at, forest, 1)); /* which lost nothing */
}

/* ---- commands ---- */

static bool is_surprised(const char *line)
{
    must(&interp, line);
    return strstr(buf_text(&reply.text), "; undo reverts it\n") != NULL;
}

static void begin(void)
{
    begin_interpreter(&interp);
    must(&interp, "open synth:geom:60x60x30; auto on");
}
#define GEOM_STORY(told) STORY_WITHIN(told, begin(), interpreter_release(&interp))

GEOM_STORY(a_seed_that_floods_an_object_says_so)
{
    CHECK(!is_surprised("seed 30,30,15 1")); /* the first seeds may take any number of voxels */
    CHECK(!is_surprised("seed 2,2,2 0") && is_surprised("seed 50,10,15 1"));
    CHECK_HAS(buf_text(&reply.text), " changed, label 1: ");
    CHECK_HAS(buf_text(&reply.text),
              "\nthis `seed` took 37.2 ml of label 0 through 55,9,13; undo ");
    CHECK(strstr(buf_text(&reply.words), "took") == NULL && !is_surprised("undo"));
    CHECK(!is_surprised("redo") && !is_surprised("undo"));
    CHECK(!is_surprised("seed 50,10,15 1 radius=7")); /* which is large itself */
    must(&interp, "undo");
    CHECK(!is_surprised("seed 20,20,10 1")); /* takes nothing */
    must(&interp, "undo");
    CHECK(is_surprised("seed 25,25,12 2")); /* also the first of its label, a fifth of label 1 */
    CHECK_HAS(buf_text(&reply.text), "\nthis `seed` took 6.38 ml of label 1 through ");
    must(&interp, "undo");
    CHECK(!is_surprised("seed 12,12,12 2")); /* a small object */
    CHECK(!is_surprised("weight difference"));
}

GEOM_STORY(so_do_boxes_eliminators_and_runs)
{
    must(&interp, "seed 30,30,15 1; seed 2,2,2 0");
    CHECK(is_surprised("box 50,10,15 50,11,15 1"));
    CHECK_HAS(buf_text(&reply.text), "\nthis `box` took ");
    CHECK(is_surprised("remove 50,10,15"));
    CHECK_HAS(buf_text(&reply.text), "\nthis `remove` took ");
    must(&interp, "auto off");
    CHECK(!is_surprised("seed 50,10,15 1") && is_surprised("run"));
    CHECK_HAS(buf_text(&reply.text), "\nthis `run` took 37.2 ml of label 0 through 55,9,13; ");
}

/* Two bright cubes of one size, a dark one, and a bright one that is larger. */
static const uint32_t wide[3] = {72, 48, 40};
static void cubes_row(void *context, uint32_t y, uint32_t z, void *values)
{
    static const struct {
        uint32_t x, y, side;
        uint8_t value;
    } cube[] = {{4, 4, 12, 200}, {24, 4, 12, 200}, {44, 4, 12, 20}, {24, 24, 18, 200}};
    uint8_t *row = values;
    (void)context;
    memset(row, 100, wide[0]);
    for (size_t i = 0; i < sizeof cube / sizeof *cube; i++)
        if (y - cube[i].y < cube[i].side && z - 8 < cube[i].side)
            memset(row + cube[i].x, cube[i].value, cube[i].side);
}

static void flat_row(void *context, uint32_t y, uint32_t z, void *values)
{
    (void)context, (void)y, (void)z;
    memset(values, 100, wide[0]);
}

STORY(the_second_of_a_pair_is_none)
{
    struct geometry geometry = {.slope = 1, .spacing_nm = {1000000, 1000000, 1000000}};
    geometry_place_plain(&geometry, (const double[]){1, 1, 1});
    struct volume_map map = {wide, &geometry, VOXEL_UINT8, "cubes", cubes_row,
                             NULL, NULL,      NULL,        NULL};
    CHECK(volume_write("cubes.nii", FILE_REPLACE, &map, NULL, NULL) == OK);
    begin_interpreter(&interp);
    must(&interp, "open cubes.nii; auto on; seed 2,2,2 0; seed 9,9,13 1");
    CHECK(!is_surprised("seed 29,9,13 1"));
    CHECK_HAS(buf_text(&reply.text), " ml (+1.");
    must(&interp, "undo");
    CHECK(is_surprised("seed 49,9,13 1")); /* as large, but not as bright */
    must(&interp, "undo");
    CHECK(is_surprised("seed 32,32,16 1")); /* as bright, but far larger */
    must(&interp, "undo");
    CHECK(!is_surprised("seed 49,9,13 2")); /* an object of its own */
    must(&interp, "undo");
    map.row = flat_row;
    CHECK(volume_write("flat.nii", FILE_REPLACE, &map, NULL, NULL) == OK);
    must(&interp, "channel flat.nii; show-channel 2"); /* the first channel decides */
    CHECK(is_surprised("seed 49,9,13 1"));
    must(&interp, "undo");
    CHECK(!is_surprised("seed 29,9,13 1"));
    interpreter_release(&interp);
}

GEOM_STORY(a_replay_says_nothing)
{
    must(&interp, "seed 30,30,15 1; seed 2,2,2 0");
    interp.mode = MODE_REPLAY;
    CHECK(!is_surprised("seed 50,10,15 1"));
    interp.mode = MODE_LIVE;
}
