/* SPDX-License-Identifier: MIT */
/* Picking a pixel: its voxel, label and position, and the distance from the border of its object,
 * against a search of the whole scene. */
#include "tests/check_main.h"
#include "interpreting.h"

#include <limits.h>
#include <math.h>

#include "command/command.h"
#include "command/interpreter.h"
#include "engine/measure.h"
#include "show/pictures.h"

/* ---- distances ---- */

static uint64_t squared_between(const struct scene *scene, struct place a, struct place b)
{
    const int64_t step[3] = {(int64_t)a.x - b.x, (int64_t)a.y - b.y, (int64_t)a.z - b.z};
    uint64_t squared = 0;
    for (int i = 0; i < 3; i++) {
        const uint64_t nm = (uint64_t)llabs(step[i]) * scene->spacing_nm[i];
        squared += nm * nm;
    }
    return squared;
}

static uint8_t label_of(const struct scene *scene, int64_t x, int64_t y, int64_t z)
{
    return grid_contains(&scene->grid, x, y, z)
               ? scene->cell[grid_cell(&scene->grid, (uint32_t)x, (uint32_t)y, (uint32_t)z)].label
               : 0;
}

/* The definition in measure.h, by a search of the whole scene. */
static struct border_distance slow_distance(const struct scene *scene, struct place from)
{
    static const int face[6][3] = {{1, 0, 0},  {-1, 0, 0}, {0, 1, 0},
                                   {0, -1, 0}, {0, 0, 1},  {0, 0, -1}};
    struct border_distance best = {.squared = UINT64_MAX};
    const uint8_t label = label_of(scene, from.x, from.y, from.z);
    for (uint32_t z = 0; z < scene->grid.size[2]; z++)
        for (uint32_t y = 0; y < scene->grid.size[1]; y++)
            for (uint32_t x = 0; x < scene->grid.size[0]; x++) {
                bool borders = false;
                for (int f = 0; f < 6; f++)
                    borders |= label_of(scene, (int64_t)x + face[f][0], (int64_t)y + face[f][1],
                                        (int64_t)z + face[f][2]) != label;
                const uint64_t squared = squared_between(scene, from, (struct place){x, y, z});
                if (label_of(scene, x, y, z) == label && borders && squared < best.squared)
                    best = (struct border_distance){.found = true,
                                                    .cell = grid_cell(&scene->grid, x, y, z),
                                                    .squared = squared};
            }
    return best;
}

STORY(distances_to_the_border_are_those_of_a_slow_search)
{
    uint64_t random = 5;
    unsigned deep = 0, none = 0;
    for (int round = 0; round < 400 && check_failures == 0; round++) {
        OWNED(scene_drop) struct scene *scene = NULL;
        uint32_t size[3];
        for (int a = 0; a < 3; a++)
            size[a] = 1 + check_below(&random, check_below(&random, 3) ? 20 : 3);
        CHECK(scene_new(&scene, size, NULL, NULL, NULL) == OK);
        for (int a = 0; a < 3; a++)
            scene->spacing_nm[a] =
                check_below(&random, 2) ? 1000000 : 1 + check_below(&random, 4000000);
        const uint8_t ground = (uint8_t)check_below(&random, 2);
        for (size_t c = 0; c < scene->grid.cells; c++)
            if (!(scene->cell[c].flags & CELL_RIM))
                scene->cell[c].label =
                    check_below(&random, 60) ? ground : (uint8_t)check_below(&random, 3);
        for (int i = 0; i < 20; i++) {
            const struct place p = {check_below(&random, size[0]), check_below(&random, size[1]),
                                    check_below(&random, size[2])};
            const struct border_distance slow = slow_distance(scene, p);
            const struct border_distance fast =
                measure_border_distance(scene, grid_cell(&scene->grid, p.x, p.y, p.z));
            CHECK(fast.found == slow.found && fast.reach_nm == UINT64_MAX);
            CHECK(!fast.found || (fast.squared == slow.squared && fast.cell == slow.cell));
            deep += fast.found && fast.squared > 0;
            none += !fast.found;
        }
    }
    CHECK(deep > 1000 && none > 100);
}

STORY(a_border_beyond_reach_is_not_searched_for)
{
    OWNED(scene_drop) struct scene *scene = NULL;
    CHECK(scene_new(&scene, (uint32_t[]){401, 3, 3}, NULL, NULL, NULL) == OK);
    const uint32_t middle = grid_cell(&scene->grid, 200, 1, 1);
    scene->cell[grid_cell(&scene->grid, 200 + 100, 1, 1)].label = 1;
    struct border_distance d = measure_border_distance(scene, middle);
    CHECK(d.found && d.squared == UINT64_C(99000000) * 99000000);
    CHECK_INT(d.reach_nm, 100000000);
    scene->cell[grid_cell(&scene->grid, 200 + 100, 1, 1)].label = 0;
    scene->cell[grid_cell(&scene->grid, 200 + 102, 1, 1)].label = 1;
    CHECK(!measure_border_distance(scene, middle).found);
    scene->spacing_nm[0] = UINT32_MAX; /* 4.3 m: no step is within reach */
    d = measure_border_distance(scene, middle);
    CHECK(!d.found && d.reach_nm == 0);
    scene->spacing_nm[0] = 10000;
    d = measure_border_distance(scene, middle);
    CHECK(!d.found && d.reach_nm == 1000000); /* 100 voxels */
}

/* ---- commands ---- */

STORY(every_pixel_tells_the_voxel_it_shows)
{
    OWNED(interpreter_release) struct interpreter interp;
    char line[64], words[128];
    CHECK(interpreter_init(&interp, NULL) == OK);
    must(&interp, "open synth:geom:40x30x20; size 40 30; label 1 torus; seed 20,15,10 1; "
                  "seed 2,2,2 2; view 20 30; cut 30,20,19 10,10,5");
    CHECK_INT(execute(&interp, "pick 3 3"), ERR_USAGE);
    CHECK_HAS(fault.text, "the rendition is not up to date; `render` first");
    must(&interp, "render");
    const struct session *session = interp.session;
    unsigned objects = 0;
    for (uint32_t y = 0; y < 30; y++)
        for (uint32_t x = 0; x < 40; x++) {
            const uint32_t cell = session->pictures->rendition.cell[y * 40 + x];
            snprintf(line, sizeof line, "pick %u %u", x, y);
            must(&interp, line);
            if (cell == CELL_NONE) {
                snprintf(words, sizeof words, "pixel %u,%u shows no object\n", x, y);
                CHECK_TEXT(buf_text(&reply.text), words);
                continue;
            }
            const struct place p = grid_place(&session->scene->grid, cell);
            const struct cell *at = session->scene->cell + cell;
            snprintf(words, sizeof words, "voxel %u,%u,%u at %.1f,%.1f,%.1f mm: intensity %u,", p.x,
                     p.y, p.z, (double)p.x, (double)p.y, (double)p.z, at->intensity);
            CHECK_HAS(buf_text(&reply.text), words);
            CHECK_HAS(buf_text(&reply.text), at->label == 1
                                                 ? " label 1 torus, of the seed at 20,15,10\n"
                                                 : " label 2, of the seed at 2,2,2\n");
            const struct border_distance d = slow_distance(session->scene, p);
            snprintf(words, sizeof words,
                     d.squared ? "%.2f mm from the border of label " : "on the border of label ",
                     sqrt((double)d.squared) / 1e6);
            CHECK_HAS(buf_text(&reply.text), words);
            objects++;
        }
    CHECK(objects > 200);
    CHECK_INT(execute(&interp, "pick 40 0"), ERR_INPUT);
    CHECK_HAS(fault.text, "pixel 40,0 is outside the picture of 40x30");
    CHECK_INT(execute(&interp, "pick 0 30"), ERR_INPUT);
    CHECK_INT(execute(&interp, "pick -1 0"), ERR_USAGE);
    CHECK_INT(execute(&interp, "pick 8193 0"), ERR_USAGE);
    CHECK_INT(execute(&interp, "pick 1"), ERR_USAGE);
    CHECK_HAS(fault.text, "missing: ROW");
}

STORY(a_cut_shows_how_deep_a_voxel_lies)
{
    OWNED(interpreter_release) struct interpreter interp;
    CHECK(interpreter_init(&interp, NULL) == OK);
    must(&interp, "open synth:geom:41x41x41; size 41 41; zoom 1; seed 20,20,20 1");
    must(&interp, "plane 20,20,20"); /* from the front; the whole scene is label 1 */
    MUST_MENTION(&interp, "render; pick 20 20", "voxel 20,20,20 ");
    CHECK_HAS(buf_text(&reply.text), "20.00 mm from the border of label 1, at 20,20,0\n");
    must(&interp, "pick 17 20"); /* from the front, the right side is on the left */
    CHECK_HAS(buf_text(&reply.text), "voxel 23,20,20 ");
    CHECK_HAS(buf_text(&reply.text), "17.00 mm from the border of label 1, at 40,20,20\n");
}

STORY(info_tells_how_the_patient_lies_in_the_picture)
{
    static const struct {
        const char *view, *words;
    } row[] = {
        {"view front", "the patient's front towards you, his left on the right, his head up\n"},
        {"view back", "the patient's back towards you, his right on the right, his head up\n"},
        {"view left", "the patient's left towards you, his back on the right, his head up\n"},
        {"view right", "the patient's right towards you, his front on the right, his head up\n"},
        {"view top", "the patient's head towards you, his right on the right, his front up\n"},
        {"view bottom", "the patient's feet towards you, his left on the right, his front up\n"},
        {"view 45", "the patient's front and left towards you, his back and left on the right, "},
        {"view 0 45", "the patient's front and head towards you, his left on the right, his back "
                      "and head up\n"},
        {"view 0 0 90", "the patient's front towards you, his feet on the right, his left up\n"},
        {"view 10 -10", "the patient's front towards you, his left on the right, his head up\n"},
    };
    OWNED(interpreter_release) struct interpreter interp;
    CHECK(interpreter_init(&interp, NULL) == OK);
    must(&interp, "open synth:geom:40x30x20");
    for (size_t i = 0; i < sizeof row / sizeof row[0]; i++) {
        must(&interp, row[i].view);
        MUST_MENTION(&interp, "info", row[i].words);
    }
    CHECK_HAS(buf_text(&reply.text), "pixels, 19.5,14.5,9.5 in the middle\n");
    MUST_MENTION(&interp, "focus 3,4,5; info", "pixels, 3,4,5 in the middle\n");
    CHECK_HAS(command_find("view")->detail,
              "the patient's left is on the right of the picture in the front view");
}
