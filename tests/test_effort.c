/* SPDX-License-Identifier: MIT */
/* Stories of the robots that count gestures (tests/bench): what they do on tiny objects, and what
 * is counted. Their figures are no test. */
#include <limits.h>
#include <math.h>
#include <stdlib.h>

#include "engine/overlap.h"
#include "tests/bench/effort_report.h"
#include "tests/bench/growcut.h"
#include "tests/check.h"
#include "tests/folder.h"

enum { WIDE = 40, HIGH = 30, DEEP = 28, VOXELS = WIDE * HIGH * DEEP };

static char folder[FOLDER_LENGTH];
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

/* A bright box of 16 x 7 x 7 voxels; labels are right. */
static const uint32_t low[3] = {14, 12, 11}, high[3] = {29, 18, 17};
static void begin(struct effort_robot *robot, enum effort_robot_kind kind)
{
    memset(truth, 0, VOXELS);
    fill(truth, low, high, 1);
    for (size_t i = 0; i < VOXELS; i++)
        image[i] = truth[i] ? 200 : 50;
    memcpy(label, truth, VOXELS);
    CHECK(effort_robot_init(robot, kind, &object, NULL) == OK);
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
    struct effort_robot robot;
    struct effort_gesture gesture;
    begin(&robot, ROBOT_CAREFUL);
    CHECK(effort_robot_object(&robot, &gesture, NULL) == OK);
    CHECK_INT(gesture.shape, SHAPE_BALL);
    CHECK_INT(gesture.label, 1);
    is_at(gesture.at, 17, 15, 14); /* the first of those with a depth of 4 */
    CHECK_INT(gesture.radius, 3);
    truth[at(17, 15, 13)] = 0; /* now that is 5 voxels from one that is not the object's */
    CHECK(effort_robot_object(&robot, &gesture, NULL) == OK);
    is_at(gesture.at, 21, 15, 14);
    effort_robot_release(&robot);
}

STORY(the_background_begins_outside_and_near)
{
    struct effort_robot robot;
    struct effort_gesture gesture;
    struct voxels voxels = {0};
    begin(&robot, ROBOT_CAREFUL);
    CHECK(effort_robot_background(&robot, SHAPE_BALL, &gesture, NULL) == OK);
    CHECK_INT(gesture.label, 0);
    CHECK(effort_gesture_voxels(&voxels, &gesture, &robot.grid, NULL) == OK);
    CHECK(voxels.count > 0);
    for (size_t i = 0; i < voxels.count; i++) {
        const struct place p = grid_place(&robot.grid, voxels.cell[i]);
        const uint32_t place[3] = {p.x, p.y, p.z};
        int64_t squared = 0;
        for (int a = 0; a < 3; a++) {
            const int64_t d = place[a] < low[a]    ? low[a] - place[a]
                              : place[a] > high[a] ? place[a] - high[a]
                                                   : 0;
            squared += d * d;
        }
        CHECK(squared > 4 && squared <= 100);
    }
    voxels_release(&voxels);
    effort_robot_release(&robot);
}

STORY(spheres_and_boxes_enclose_the_object)
{
    struct effort_robot robot;
    struct effort_gesture sphere, box, again;
    begin(&robot, ROBOT_CAREFUL);
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
    CHECK_INT(farthest, 8 * 8 + 3 * 3 + 3 * 3); /* from the middle: the least there is */
    CHECK(sphere.radius >= 10 + 2 && sphere.radius <= 10 + 5);
    CHECK(effort_robot_background(&robot, SHAPE_BOX, &box, NULL) == OK);
    for (int a = 0; a < 3; a++) {
        CHECK(box.at[a] + 3 <= low[a] && (box.at[a] + 12 >= low[a] || box.at[a] == 0));
        CHECK(box.to[a] >= high[a] + 3 && box.to[a] <= high[a] + 12);
        CHECK(box.to[a] < robot.grid.size[a]);
    }
    effort_robot_release(&robot);
    begin(&robot, ROBOT_SLOPPY); /* the stream is the object's */
    CHECK(effort_robot_background(&robot, SHAPE_SPHERE, &again, NULL) == OK);
    CHECK(memcmp(&sphere, &again, sizeof again) == 0);
    effort_robot_release(&robot);
}

/* ---- corrections ---- */

STORY(the_largest_error_is_corrected_at_its_deepest_voxel)
{
    struct effort_robot robot;
    struct effort_gesture gesture;
    bool found = true;
    begin(&robot, ROBOT_CAREFUL);
    CHECK(effort_robot_next(&robot, label, &gesture, &found, NULL) == OK);
    CHECK(!found);
    fill(label, (uint32_t[]){1, 1, 1}, (uint32_t[]){5, 5, 5}, 1);
    fill(label, (uint32_t[]){24, 12, 11}, (uint32_t[]){29, 18, 17}, 0);
    CHECK(effort_robot_next(&robot, label, &gesture, &found, NULL) == OK);
    CHECK(found);
    CHECK_INT(gesture.label, 1); /* 294 voxels that should be the object's, against 125 */
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
    effort_robot_release(&robot);
}

STORY(a_sloppy_robot_is_half_right_and_always_the_same)
{
    enum { TURNS = 64 };
    struct effort_robot robot;
    struct effort_gesture gesture[2][TURNS];
    unsigned second = 0, others = 0;
    for (int round = 0; round < 2; round++) {
        begin(&robot, ROBOT_SLOPPY);
        fill(label, (uint32_t[]){1, 1, 1}, (uint32_t[]){5, 5, 5}, 1);
        fill(label, (uint32_t[]){24, 12, 11}, (uint32_t[]){29, 18, 17}, 0);
        for (int turn = 0; turn < TURNS; turn++) {
            bool found;
            CHECK(effort_robot_next(&robot, label, &gesture[round][turn], &found, NULL) == OK);
            CHECK(found);
        }
        effort_robot_release(&robot);
    }
    CHECK(memcmp(gesture[0], gesture[1], sizeof gesture[0]) == 0);
    for (int turn = 0; turn < TURNS; turn++) {
        const struct effort_gesture *g = &gesture[0][turn];
        second += g->label == 0;
        others += memcmp(g->at, gesture[0][0].at, sizeof g->at) != 0;
        CHECK(g->radius <= 2);
        for (int a = 0; a < 3 && g->label == 0; a++) /* of a depth of 3: 2 voxels at least */
            CHECK(g->at[a] >= 2 && g->at[a] <= 4);
    }
    CHECK(second > TURNS / 8 && second < TURNS / 2);
    CHECK(others > TURNS / 2);
}

STORY(a_stroke_follows_the_main_axis_inside)
{
    struct effort_robot robot;
    struct effort_gesture gesture;
    struct voxels voxels = {0};
    bool found;
    begin(&robot, ROBOT_STROKE);
    memset(label, 0, VOXELS);
    CHECK(effort_robot_next(&robot, label, &gesture, &found, NULL) == OK);
    CHECK_INT(gesture.shape, SHAPE_STROKE);
    CHECK_INT(gesture.radius, 3);
    const bool forth = gesture.at[0] < gesture.to[0];
    is_at(forth ? gesture.at : gesture.to, 17, 15, 14);
    is_at(forth ? gesture.to : gesture.at, 26, 15, 14);
    CHECK(effort_gesture_voxels(&voxels, &gesture, &robot.grid, NULL) == OK);
    for (size_t i = 0; i < voxels.count; i++)
        CHECK(truth[grid_voxel(&robot.grid, voxels.cell[i])] == 1);
    CHECK(voxels.count > 300);
    voxels_release(&voxels);
    effort_robot_release(&robot);
}

/* ---- outlines ---- */

enum { ACROSS = 60 };
static uint8_t flat[ACROSS * ACROSS];
static const struct hand_slice slice = {{ACROSS, ACROSS}, flat};

static void draw_disc(int64_t radius)
{
    for (int64_t i = 0; i < ACROSS * ACROSS; i++) {
        const int64_t x = i % ACROSS - ACROSS / 2, y = i / ACROSS - ACROSS / 2;
        flat[i] = x * x + y * y <= radius * radius;
    }
}

STORY(an_exact_hand_draws_a_piece_as_it_is)
{
    struct hand_outline outline = {0};
    uint64_t random = 1;
    memset(flat, 0, sizeof flat);
    for (uint32_t y = 10; y < 20; y++)
        memset(flat + y * ACROSS + 5, 1, 30);
    CHECK(hand_draw(&outline, &slice, 0, &random, NULL) == OK);
    CHECK_INT(outline.line.count, 4);
    CHECK_INT(outline.clicks, 4);
    CHECK_INT(outline.path, 2 * (29 + 9));
    for (uint32_t y = 11; y < 20; y++)
        memset(flat + y * ACROSS + 5, 0, 30);
    CHECK(hand_draw(&outline, &slice, 0, &random, NULL) == OK);
    CHECK_INT(outline.line.count, 2); /* there and back */
    memset(flat + 10 * ACROSS + 6, 0, 29);
    CHECK(hand_draw(&outline, &slice, 0, &random, NULL) == OK);
    CHECK_INT(outline.line.count, 1);
    CHECK_INT(outline.line.corner[0][0], 5);
    CHECK_INT(outline.line.corner[0][1], 10);
    hand_outline_release(&outline);
}

STORY(a_hand_is_off_by_what_it_says_and_always_the_same)
{
    enum { RADIUS = 24, TURNS = 40 };
    struct hand_outline outline = {0}, again = {0};
    uint64_t random = 1, other = 1;
    double squares = 0, sum = 0;
    size_t count = 0;
    draw_disc(RADIUS);
    for (int turn = 0; turn < TURNS; turn++) {
        CHECK(hand_draw(&outline, &slice, 20, &random, NULL) == OK);
        CHECK(hand_draw(&again, &slice, 20, &other, NULL) == OK);
        CHECK_INT(again.line.count, outline.line.count);
        CHECK(memcmp(again.line.corner, outline.line.corner,
                     again.line.count * sizeof *again.line.corner) == 0);
        CHECK(outline.clicks < outline.line.count);
        for (size_t i = 0; i < outline.count; i++, count++) {
            const double x = outline.place[i].at[0] - ACROSS / 2.0,
                         y = outline.place[i].at[1] - ACROSS / 2.0,
                         off = sqrt(x * x + y * y) - RADIUS;
            squares += off * off;
            sum += x + y;
        }
    }
    CHECK(squares / (double)count > 1.7 * 1.7 && squares / (double)count < 2.5 * 2.5);
    CHECK(fabs(sum / (double)count) < 0.4); /* to no side more than to another */
    hand_outline_release(&outline);
    hand_outline_release(&again);
}

static void draw_next(struct effort_outliner *o, const struct doubt *doubt,
                      struct effort_gesture *gesture, bool expected)
{
    bool found = !expected;
    CHECK(effort_outline_next(o, label, doubt, gesture, &found, NULL) == OK);
    CHECK_INT(found, expected);
}

STORY(the_slice_with_most_wrong_voxels_is_outlined)
{
    struct effort_robot robot;
    struct effort_outliner o;
    struct effort_gesture gesture;
    unsigned dice;
    begin(&robot, ROBOT_CAREFUL);
    CHECK(effort_outliner_init(&o, &object, NEXT_WRONG, 0, NULL) == OK);
    draw_next(&o, NULL, &gesture, false);
    fill(label, low, (uint32_t[]){high[0], high[1], 13}, 0); /* 3 of 7 planes: 16 x 7 each */
    draw_next(&o, NULL, &gesture, true);
    CHECK_INT(gesture.shape, SHAPE_OUTLINE);
    CHECK_INT(gesture.label, 1);
    CHECK_INT(gesture.ring, 3);
    CHECK_INT(gesture.corners, 4);
    CHECK_INT(gesture.path, 2 * (15 + 6));
    is_at(gesture.corner[0], low[0], low[1], 11);
    draw_next(&o, NULL, &gesture, true);
    is_at(gesture.corner[0], low[0], low[1], 12);
    memcpy(label, truth, VOXELS);
    fill(label, (uint32_t[]){1, 1, 1}, (uint32_t[]){6, 6, 1}, 1); /* far from the object */
    draw_next(&o, NULL, &gesture, true);
    is_at(gesture.corner[0], 1, 1, 1);
    CHECK_INT(gesture.label, 0);
    CHECK_INT(gesture.ring, 0);
    CHECK(effort_outline_most(&dice, &object, 0, NULL) == OK);
    CHECK_INT(dice, DICE_ONE);
    CHECK(effort_outline_most(&dice, &object, 7, NULL) == OK);
    CHECK(dice < DICE_ONE && dice > 8000);
    effort_outliner_release(&o);
    effort_robot_release(&robot);
}

STORY(doubt_leads_and_neighbours_of_what_is_drawn_wait)
{
    uint64_t slice_x[WIDE] = {0}, slice_y[HIGH] = {0}, slice_z[DEEP] = {0};
    const struct doubt doubt = {.size = {WIDE, HIGH, DEEP}, .slice = {slice_x, slice_y, slice_z}};
    struct effort_robot robot;
    struct effort_outliner o;
    struct effort_gesture gesture;
    begin(&robot, ROBOT_CAREFUL);
    memset(label, 0, VOXELS);
    CHECK(effort_outliner_init(&o, &object, NEXT_DOUBT, 0, NULL) == OK);
    slice_x[20] = 9, slice_x[21] = 8, slice_y[15] = 7, slice_z[0] = 10; /* that one has nothing */
    draw_next(&o, &doubt, &gesture, true);
    is_at(gesture.corner[0], 20, low[1], low[2]);
    draw_next(&o, &doubt, &gesture, true);
    is_at(gesture.corner[0], low[0], 15, low[2]);
    draw_next(&o, &doubt, &gesture, false);
    effort_outliner_release(&o);
    CHECK(effort_outliner_init(&o, &object, NEXT_CHANCE, 0, NULL) == OK);
    for (int slices = 0; slices < 16 + 7 + 7; slices++)
        draw_next(&o, NULL, &gesture, true);
    draw_next(&o, NULL, &gesture, false);
    effort_outliner_release(&o);
    effort_robot_release(&robot);
}

/* ---- counts ---- */

STORY(what_is_counted_of_a_curve)
{
    struct effort_run run = {.object = 0};
    struct effort_count count = {0};
    for (unsigned k = 0; k < CURVE; k++)
        run.dice[k] = 5000 + 100 * k, run.path[k] = k, run.clicks[k] = 2 * k;
    run.warnings = (struct effort_warnings){3, 2, 10, 1};
    effort_count(&count, &run);
    CHECK_INT(count.gestures[0], NOT_REACHED);
    CHECK_INT(count.after[0], 5500);
    CHECK_INT(count.path, 20);
    CHECK_INT(count.clicks, 40); /* all, since no goal is reached */
    run.dice[3] = 8000;
    run.dice[10] = 9500;
    run.dice[15] = 6000; /* 0.04 less, which is none */
    effort_count(&count, &run);
    CHECK_INT(count.runs, 2);
    CHECK_INT(count.gestures[0], NOT_REACHED + 5);
    CHECK_INT(count.reached[0], 1);
    CHECK_INT(count.gestures[1], NOT_REACHED + 12);
    CHECK_INT(count.reached[1], 1);
    CHECK_INT(count.after[1], 6000 + 9500);
    CHECK_INT(count.after[2], 2 * 7000);
    CHECK_INT(count.path, 20 + 3);
    CHECK_INT(count.clicks, 40 + 6);
    CHECK_INT(count.warnings.leaks, 6);
    CHECK_INT(count.warnings.found, 4);
    CHECK_INT(count.warnings.right, 20);
    CHECK_INT(count.warnings.called, 2);
    CHECK_INT(count.collapses, 2);
    CHECK_INT(count.largest, 9500 - 6100);
}

STORY(the_truth_says_what_a_leak_is)
{
    static uint8_t former[VOXELS];
    struct effort_warnings w = {0};
    struct effort_robot robot;
    begin(&robot, ROBOT_CAREFUL); /* 784 voxels: a leak is 79 that are worse */
    memcpy(former, truth, VOXELS);
    fill(label, (uint32_t[]){0, 0, 0}, (uint32_t[]){77, 0, 0}, 1);
    effort_judge(&w, &object, former, label, true);
    CHECK_INT(w.leaks + w.found + w.right + w.called, 0);
    fill(label, (uint32_t[]){0, 0, 0}, (uint32_t[]){78, 0, 0}, 1);
    effort_judge(&w, &object, former, label, false);
    CHECK_INT(w.leaks, 1);
    effort_judge(&w, &object, former, label, true);
    CHECK_INT(w.leaks, 2);
    CHECK_INT(w.found, 1);
    memcpy(former, label, VOXELS);
    memcpy(label, truth, VOXELS); /* taken back */
    effort_judge(&w, &object, former, label, true);
    effort_judge(&w, &object, former, label, false);
    CHECK_INT(w.leaks, 2);
    CHECK_INT(w.found, 1);
    CHECK_INT(w.right, 2);
    CHECK_INT(w.called, 1);
    effort_robot_release(&robot);
}

STORY(reports_have_every_run_and_fit_a_line)
{
    static const struct effort_method method[2] = {{.name = "one", .charted = true},
                                                   {.name = "two <&>", .charted = true}};
    struct effort_run run[3] = {
        {.object = 0, .method = 0}, {.object = 1, .method = 0}, {.object = 0, .method = 1}};
    struct effort_report report = {.method = method, .methods = 2, .run = run, .runs = 3};
    struct buf text = {0};
    char plots[PATH_MAX];
    run[0].most = 8700;
    run[1].warnings = (struct effort_warnings){4, 2, 30, 9};
    for (unsigned k = 0; k < CURVE; k++)
        run[0].dice[k] = run[1].dice[k] = run[2].dice[k] = 400 * k;
    effort_report_tables(&text, &report);
    CHECK_HAS(buf_text(&text), "careful robot, 2 objects: tuned");
    CHECK_HAS(buf_text(&text), "two <&> *"); /* one object less */
    CHECK_HAS(buf_text(&text), "\nputamen            0.87   thalamus           0.00\n");
    CHECK_HAS(buf_text(&text),
              "\ntuned, careful                     4        2       30        9\n");
    for (const char *line = buf_text(&text); *line;) {
        const size_t n = strcspn(line, "\n");
        CHECK(n <= 100);
        line += n + (line[n] == '\n');
    }
    buf_clear(&text);
    effort_report_json(&text, &report);
    CHECK_HAS(buf_text(&text), "\"dice_after_20\": 0.8");
    snprintf(plots, sizeof plots, "%s/plots", folder);
    CHECK(effort_report_plots(&report, plots, NULL) == OK);
    CHECK(effort_report_plots(&report, plots, NULL) == ERR_IO); /* nothing is overwritten */
    buf_release(&text);
}

/* ---- tools ---- */

STORY(growcut_takes_the_strongest_way)
{
    static const uint8_t grey[7] = {10, 10, 10, 90, 90, 100, 100};
    uint8_t marker[7] = {2, 0, 0, 0, 0, 0, 1}, out[7];
    const uint32_t size[3] = {7, 1, 1};
    CHECK(growcut(out, grey, marker, size, NULL) == OK);
    CHECK(memcmp(out, (uint8_t[]){1, 1, 1, 0, 0, 0, 0}, 7) == 0);
    marker[6] = 0;
    CHECK(growcut(out, grey, marker, size, NULL) == OK);
    CHECK(memcmp(out, (uint8_t[]){1, 1, 1, 1, 1, 1, 1}, 7) == 0);
}

STORY(a_gesture_is_a_command)
{
    struct buf line = {0};
    struct effort_gesture gesture = {
        .shape = SHAPE_BALL, .at = {1, 2, 3}, .to = {4, 5, 6}, .label = 1, .within = 12};
    effort_write_command(&line, &gesture, false);
    CHECK_TEXT(buf_text(&line), "seed 1,2,3 1");
    effort_write_command(&line, &gesture, true);
    CHECK_TEXT(buf_text(&line), "seed 1,2,3 1 within=12");
    gesture.radius = 3;
    gesture.shape = SHAPE_STROKE;
    effort_write_command(&line, &gesture, true);
    CHECK_TEXT(buf_text(&line), "seed 1,2,3 1 radius=3 to=4,5,6");
    gesture.label = 0;
    gesture.shape = SHAPE_SPHERE;
    effort_write_command(&line, &gesture, true);
    CHECK_TEXT(buf_text(&line), "seed 1,2,3 0 radius=3 shell=yes around=1");
    gesture.shape = SHAPE_BOX;
    effort_write_command(&line, &gesture, true);
    CHECK_TEXT(buf_text(&line), "box 1,2,3 4,5,6 0 shell=yes around=1");
    const uint32_t corner[3][3] = {{1, 2, 3}, {9, 2, 3}, {9, 8, 3}};
    gesture = (struct effort_gesture){
        .shape = SHAPE_OUTLINE, .label = 1, .corner = corner, .corners = 3, .ring = 3};
    effort_write_command(&line, &gesture, true);
    CHECK_TEXT(buf_text(&line), "outline 1,2,3 1 to=9,2,3 to=9,8,3 ring=3");
    gesture.corners = 2;
    gesture.ring = 0;
    effort_write_command(&line, &gesture, true);
    CHECK_TEXT(buf_text(&line), "fill 1,2,3 1 to=9,2,3 to=1,2,3"); /* has no inside */
    gesture.corners = 1;
    effort_write_command(&line, &gesture, true);
    CHECK_TEXT(buf_text(&line), "seed 1,2,3 1");
    buf_release(&line);
}

STORY(a_plain_object_is_found_at_once_and_runs_agree)
{
    static const struct effort_method method[] = {
        {.name = "morph", .weight = "morph", .background = SHAPE_SPHERE},
        {.name = "relax", .weight = "gauss 1", .background = SHAPE_SPHERE, .reach = 16},
        {.name = "box", .weight = "morph", .background = SHAPE_BOX},
        {.name = "GrowCut", .by = BY_GROWCUT, .background = SHAPE_BALL},
        {.name = "within", .weight = "morph", .background = SHAPE_BALL, .limits = true},
        {.name = "outline", .weight = "morph", .background = SHAPE_SPHERE, .next = NEXT_WRONG},
        {.name = "doubt", .weight = "morph", .background = SHAPE_SPHERE, .next = NEXT_DOUBT}};
    struct effort_robot robot;
    begin(&robot, ROBOT_CAREFUL);
    effort_robot_release(&robot);
    CHECK(effort_tool_prepare(&object, folder, NULL) == OK);
    for (size_t m = 0; m < sizeof method / sizeof *method; m++) {
        struct effort_run run = {0}, again = {0};
        struct fault fault = {0};
        if (!CHECK(effort_run(&run, &method[m], &object, folder, &fault) == OK))
            printf("#   %s\n", fault.text);
        CHECK(effort_run(&again, &method[m], &object, folder, NULL) == OK);
        CHECK(memcmp(run.dice, again.dice, sizeof run.dice) == 0);
        CHECK(run.dice[method[m].background == SHAPE_BOX] > 8000);
        CHECK(run.dice[CURVE - 1] > 9900 || method[m].limits); /* those correct near by alone */
    }
}

STORY(phantoms_are_what_they_were)
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

int main(void)
{
    if (!make_folder(folder, "effort"))
        return 1;
    const int status = RUN_STORIES(
        TELL(the_first_ball_is_at_the_deepest_voxel), TELL(the_background_begins_outside_and_near),
        TELL(spheres_and_boxes_enclose_the_object),
        TELL(the_largest_error_is_corrected_at_its_deepest_voxel),
        TELL(a_sloppy_robot_is_half_right_and_always_the_same),
        TELL(a_stroke_follows_the_main_axis_inside), TELL(an_exact_hand_draws_a_piece_as_it_is),
        TELL(a_hand_is_off_by_what_it_says_and_always_the_same),
        TELL(the_slice_with_most_wrong_voxels_is_outlined),
        TELL(doubt_leads_and_neighbours_of_what_is_drawn_wait), TELL(what_is_counted_of_a_curve),
        TELL(the_truth_says_what_a_leak_is), TELL(reports_have_every_run_and_fit_a_line),
        TELL(growcut_takes_the_strongest_way), TELL(a_gesture_is_a_command),
        TELL(a_plain_object_is_found_at_once_and_runs_agree), TELL(phantoms_are_what_they_were));
    return status | remove_folder(folder);
}
