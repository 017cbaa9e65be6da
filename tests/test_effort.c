/* SPDX-License-Identifier: MIT */
/* The robot that counts gestures (tests/bench): its gestures on tiny objects, and the counts.
 * Figures are not checked. */
#include "engine/labels.h"
#include "tests/bench/effort_run.h"
#include "tests/folder_main.h"

enum { WIDE = 40, HIGH = 30, DEEP = 28, VOXELS = WIDE * HIGH * DEEP };

static uint8_t image[VOXELS], truth[VOXELS], label[VOXELS];
static const struct effort_object object = {
    .name = "box", .size = {WIDE, HIGH, DEEP}, .voxels = VOXELS, .image = image, .truth = truth};

static size_t at(uint32_t x, uint32_t y, uint32_t z)
{
    return ((size_t)z * HIGH + y) * WIDE + x;
}

static void fill(uint8_t *map, const uint32_t first[3], const uint32_t last[3], uint8_t value)
{
    for (uint32_t z = first[2]; z <= last[2]; z++)
        for (uint32_t y = first[1]; y <= last[1]; y++)
            memset(map + at(first[0], y, z), value, last[0] - first[0] + 1);
}

/* A bright box of 16 x 7 x 7 voxels, with correct labels. */
static const uint32_t low[3] = {14, 12, 11}, high[3] = {29, 18, 17};
static void begin(struct effort_robot *robot)
{
    memset(truth, 0, VOXELS);
    fill(truth, low, high, 1);
    for (size_t i = 0; i < VOXELS; i++)
        image[i] = truth[i] ? 200 : 50;
    memcpy(label, truth, VOXELS);
    CHECK(effort_robot_init(robot, &object, NULL) == OK);
}

static void is_at(const uint32_t place[3], uint32_t x, uint32_t y, uint32_t z)
{
    CHECK_INT(place[0], x);
    CHECK_INT(place[1], y);
    CHECK_INT(place[2], z);
}

/* ---- the first two gestures ---- */

STORY(the_first_ball_is_at_the_deepest_voxel)
{
    OWNED(effort_robot_release) struct effort_robot robot;
    struct effort_gesture gesture;
    begin(&robot);
    CHECK(effort_robot_object(&robot, &gesture, NULL) == OK);
    CHECK_INT(gesture.shape, SHAPE_BALL);
    CHECK_INT(gesture.label, 1);
    is_at(gesture.at, 17, 15, 14); /* the first one with a depth of 4 */
    CHECK_INT(gesture.radius, 3);
    truth[at(17, 15, 13)] = 0; /* now that is 5 voxels from the background */
    CHECK(effort_robot_object(&robot, &gesture, NULL) == OK);
    is_at(gesture.at, 21, 15, 14);
}

STORY(the_first_background_ball_is_outside_and_near)
{
    OWNED(effort_robot_release) struct effort_robot robot;
    struct effort_gesture gesture;
    begin(&robot);
    CHECK(effort_robot_background(&robot, SHAPE_BALL, &gesture, NULL) == OK);
    CHECK_INT(gesture.label, 0);
    int64_t squared = 0;
    for (int a = 0; a < 3; a++) {
        const int64_t at = gesture.at[a];
        const int64_t d = at < low[a] ? low[a] - at : at > high[a] ? at - high[a] : 0;
        squared += d * d;
    }
    const int64_t radius = gesture.radius; /* the ball is more than 2 and at most 10 away */
    CHECK(squared > (radius + 2) * (radius + 2) && squared <= (10 - radius) * (10 - radius));
}

STORY(a_sphere_encloses_the_object)
{
    struct effort_robot robot;
    struct effort_gesture sphere, again;
    begin(&robot);
    CHECK(effort_robot_background(&robot, SHAPE_SPHERE, &sphere, NULL) == OK);
    CHECK_INT(sphere.label, 0);
    uint32_t farthest = 0;
    for (int corner = 0; corner < 8; corner++) {
        uint32_t squared = 0;
        for (int a = 0; a < 3; a++) {
            const uint32_t to = corner >> a & 1 ? high[a] : low[a];
            const uint32_t d = to > sphere.at[a] ? to - sphere.at[a] : sphere.at[a] - to;
            squared += d * d;
        }
        farthest = squared > farthest ? squared : farthest;
    }
    CHECK_INT(farthest, 8 * 8 + 3 * 3 + 3 * 3); /* from the middle: the least radius */
    CHECK(sphere.radius >= 10 + 2 && sphere.radius <= 10 + 5);
    effort_robot_release(&robot);
    begin(&robot); /* random numbers depend on the object */
    CHECK(effort_robot_background(&robot, SHAPE_SPHERE, &again, NULL) == OK);
    CHECK(memcmp(&sphere, &again, sizeof again) == 0);
    effort_robot_release(&robot);
}

/* ---- corrections ---- */

STORY(the_largest_error_is_corrected_at_its_deepest_voxel)
{
    OWNED(effort_robot_release) struct effort_robot robot;
    struct effort_gesture gesture;
    bool found = true;
    begin(&robot);
    CHECK(effort_robot_next(&robot, label, &gesture, &found, NULL) == OK && !found);
    fill(label, (uint32_t[]){1, 1, 1}, (uint32_t[]){5, 5, 5}, 1);
    fill(label, (uint32_t[]){24, 12, 11}, (uint32_t[]){29, 18, 17}, 0);
    CHECK(effort_robot_next(&robot, label, &gesture, &found, NULL) == OK && found);
    CHECK_INT(gesture.label, 1); /* 294 missing voxels, against 125 superfluous ones */
    is_at(gesture.at, 26, 14, 13);
    CHECK_INT(gesture.radius, 2);
    fill(label, (uint32_t[]){24, 12, 11}, (uint32_t[]){29, 18, 17}, 1);
    CHECK(effort_robot_next(&robot, label, &gesture, &found, NULL) == OK);
    CHECK_INT(gesture.label, 0);
    is_at(gesture.at, 3, 3, 3);
    CHECK_INT(gesture.radius, 2);
    memcpy(label, truth, VOXELS);
    label[at(0, 0, 0)] = 1; /* at the edge, one voxel */
    CHECK(effort_robot_next(&robot, label, &gesture, &found, NULL) == OK);
    is_at(gesture.at, 0, 0, 0);
    CHECK_INT(gesture.radius, 0);
}

/* ---- counts ---- */

STORY(counts_of_a_curve)
{
    struct effort_run run = {.object = 0};
    struct effort_count count = {0};
    for (unsigned k = 0; k < CURVE; k++)
        run.dice[k] = 5000 + 100 * k;
    effort_count(&count, &run);
    CHECK_INT(count.gestures[0], NOT_REACHED);
    CHECK_INT(count.after[0], 5500);
    run.dice[3] = 8000;
    run.dice[10] = 9500;
    run.dice[15] = 6000; /* a drop of 0.04 is no collapse */
    effort_count(&count, &run);
    CHECK_INT(count.runs, 2);
    CHECK_INT(count.gestures[0], NOT_REACHED + 5);
    CHECK_INT(count.reached[0], 1);
    CHECK_INT(count.gestures[1], NOT_REACHED + 12);
    CHECK_INT(count.reached[1], 1);
    CHECK_INT(count.after[1], 6000 + 9500);
    CHECK_INT(count.after[2], 2 * 7000);
    CHECK_INT(count.collapses, 2);
    CHECK_INT(count.largest, 9500 - 6100);
}

STORY(a_gesture_is_a_command)
{
    OWNED(buf_release) struct buf line = {0};
    struct effort_gesture gesture = {
        .shape = SHAPE_BALL, .at = {1, 2, 3}, .label = 1, .within = 12};
    effort_write_command(&line, &gesture, false);
    CHECK_TEXT(buf_text(&line), "seed 1,2,3 1");
    effort_write_command(&line, &gesture, true);
    CHECK_TEXT(buf_text(&line), "seed 1,2,3 1 within=12");
    gesture.radius = 3;
    gesture.label = 0;
    gesture.shape = SHAPE_SPHERE;
    effort_write_command(&line, &gesture, true);
    CHECK_TEXT(buf_text(&line), "seed 1,2,3 0 radius=3 shell=yes around=1");
}

STORY(a_plain_object_is_found_at_once_and_runs_agree)
{
    static const struct effort_method method[] = {
        {.name = "morph", .weight = "morph", .background = SHAPE_SPHERE},
        {.name = "relax", .weight = "gauss 1", .background = SHAPE_SPHERE, .reach = 16},
        {.name = "within", .weight = "morph", .background = SHAPE_BALL, .limits = true}};
    struct effort_robot robot;
    begin(&robot);
    effort_robot_release(&robot);
    CHECK(effort_prepare(&object, folder, NULL) == OK);
    for (size_t m = 0; m < sizeof method / sizeof *method; m++) {
        struct effort_run run = {0}, again = {0};
        struct fault fault = {0};
        CHECK_WITH(effort_run(&run, &method[m], &object, folder, &fault) == OK, "%s", fault.text);
        CHECK(effort_run(&again, &method[m], &object, folder, NULL) == OK);
        CHECK(memcmp(run.dice, again.dice, sizeof run.dice) == 0 && run.dice[0] > 8000);
        CHECK(run.dice[CURVE - 1] > 9900 || method[m].limits); /* they correct only locally */
    }
}

STORY(an_outline_follows_the_largest_piece_of_a_slice)
{
    OWNED(effort_robot_release) struct effort_robot robot;
    OWNED(buf_release) struct buf line = {0};
    struct effort_gesture gesture;
    begin(&robot);
    fill(truth, (uint32_t[]){3, 3, 12}, (uint32_t[]){8, 8, 12}, 1); /* another piece, smaller */
    effort_robot_outline(&robot, label, &gesture);
    CHECK_INT(gesture.at[2], 12);
    CHECK_INT(gesture.corners, 2 * (16 + 7) - 4); /* of the border */
    effort_write_command(&line, &gesture, false);
    CHECK(strncmp(buf_text(&line), "outline 14,12,12 1 to=15,12,12 to=16,", 36) == 0);
}

STORY(exact_corrections_repair_defects_and_nothing_else)
{
    static const struct effort_method method[] = {
        {.name = "exact", .weight = "morph", .corrects = CORRECTS_EXACTLY},
        {.name = "over", .weight = "morph", .corrects = CORRECTS_OVER},
        {.name = "row", .weight = "morph", .background = SHAPE_SPHERE, .outlines = true}};
    struct effort_robot robot;
    begin(&robot);
    effort_robot_release(&robot);
    CHECK(effort_prepare(&object, folder, NULL) == OK);
    for (size_t m = 0; m < sizeof method / sizeof *method; m++) {
        struct effort_run run = {0};
        struct fault fault = {0};
        CHECK_WITH(effort_run(&run, &method[m], &object, folder, &fault) == OK, "%s", fault.text);
        CHECK(run.beyond == 0 || method[m].corrects != CORRECTS_EXACTLY);
        CHECK(run.repaired > 0 || !method[m].corrects);
        CHECK(run.dice[CURVE - 1] > run.dice[0] || run.dice[0] == DICE_ONE);
    }
}

STORY(phantoms_are_unchanged)
{
    enum { SIDE = PHANTOM_SIDE, ALL = SIDE * SIDE * SIDE };
    static uint16_t grey[ALL];
    static uint8_t inside[ALL];
    static const uint64_t voxels[PHANTOMS] = {7050, 30343, 57777, 11513, 23635, 22407};
    static const uint64_t greys[PHANTOMS] = {1798550711, 2607458636, 1958994304,
                                             1649137763, 1656465631, 11975125485};
    for (int p = 0; p < PHANTOMS; p++) {
        unsigned count = 0;
        uint64_t sum = 0;
        phantom_fill((enum phantom)p, 1, grey, inside);
        for (size_t i = 0; i < ALL; i++)
            count += inside[i], sum += grey[i] * (i % 97);
        CHECK_INT(count, voxels[p]);
        CHECK_INT(sum, greys[p]);
    }
}
