/* SPDX-License-Identifier: MIT */
/*
 * Numbers of labels (session/map.h): a session whose labels have large numbers in random order does
 * the same as one with small numbers, in every other respect.
 */

#include "engine/forest.h"
#include "image/exr.h"
#include "session/map.h"
#include "session/markers.h"
#include "tests/scene_main.h"

enum { LABELS = 6, ROUNDS = 25, STEPS = 30 };

static uint64_t seed;
static struct interpreter small, large;
static uint32_t number[LABELS]; /* of the labels 1..LABELS-1 of `small`, in `large` */

static uint8_t map[10][11][12];

static void small_row(void *context, uint32_t y, uint32_t z, void *values)
{
    (void)context;
    memcpy(values, map[z][y], size[0]);
}

static void large_row(void *context, uint32_t y, uint32_t z, void *values)
{
    uint32_t *at = values;
    (void)context;
    for (uint32_t x = 0; x < size[0]; x++)
        *at++ = number[map[z][y][x]];
}

/* Execute a line in both sessions, with the numbers of labels for each %. */
static void do_both(const char *line, unsigned one, unsigned other)
{
    char text[2][200];
    snprintf(text[0], sizeof text[0], line, one, other);
    snprintf(text[1], sizeof text[1], line, number[one], number[other]);
    const enum err err = execute(&small, text[0]);
    CHECK_WITH(execute(&large, text[1]) == err, "%s, %s: %s", text[0], text[1], fault.text);
}

static void do_random(void)
{
    static const char *const form[] = {"seed %s %%u radius=2",
                                       "seed %s %%u radius=1 within=0 over=%%u",
                                       "seed %s %%u",
                                       "seed %s %%u radius=1 within=0 keep=0,%%u",
                                       "remove %s",
                                       "undo",
                                       "redo",
                                       "run",
                                       "finish majority label=%u",
                                       "finish none",
                                       "box %s 5,5,5 %%u within=0",
                                       "seed %s %%u radius=2 over=0,%%u",
                                       "hide %u",
                                       "show %u",
                                       "label %%u part-%%u #%06x",
                                       "polarity %u 20",
                                       "seed %s %%u radius=3 within=5"};
    char at[40], line[120];
    const unsigned which = check_below(&seed, sizeof form / sizeof *form);
    const unsigned one = 1 + check_below(&seed, LABELS - 1), other = check_below(&seed, LABELS);
    snprintf(at, sizeof at, "%u,%u,%u", check_below(&seed, 12), check_below(&seed, 11),
             check_below(&seed, 10));
    if (strstr(form[which], "#%06x"))
        snprintf(line, sizeof line, "label %%u part-%u #%06x", one, check_below(&seed, 1 << 24));
    else if (strstr(form[which], "%s"))
        snprintf(line, sizeof line, form[which], at);
    else
        snprintf(line, sizeof line, "%s", form[which]);
    do_both(line, one, other);
}

/* The voxels have the same trees, and labels of the same regions. */
static void compare_both(void)
{
    const struct session *a = small.session, *b = large.session;
    const struct grid *grid = &a->scene->grid;
    unsigned wrong = 0;
    for (uint32_t z = 0; z < size[2]; z++)
        for (uint32_t y = 0; y < size[1]; y++) {
            const struct span row = grid_row(grid, y, z);
            for (uint32_t c = row.first; c < row.end; c++)
                wrong += a->scene->cell[c].key != b->scene->cell[c].key ||
                         number[a->scene->cell[c].label] !=
                             numbering_of(&b->now.kept, b->scene->cell[c].label);
        }
    CHECK_INT(wrong, 0);
    CHECK_INT(forest_seeds(a->forest), forest_seeds(b->forest));
}

/* The pictures are the same, but for the numbers in their planes of labels. */
static void draw_both(void)
{
    OWNED(picture_release) struct picture a = {0}, b = {0};
    must(&small, "render small.exr replace=yes");
    must(&large, "render large.exr replace=yes");
    if (!CHECK(exr_read(&a, place("small.exr"), &fault) == OK) ||
        !CHECK(exr_read(&b, place("large.exr"), &fault) == OK))
        return;
    const size_t pixels = (size_t)a.width * a.height;
    unsigned wrong = 0;
    for (size_t i = 0; i < pixels; i++)
        wrong += a.label[i] >= LABELS || number[a.label[i]] != b.label[i];
    CHECK_INT(wrong, 0);
    CHECK(memcmp(a.rgba, b.rgba, 4 * pixels) == 0);
    CHECK(memcmp(a.voxel, b.voxel, pixels * sizeof *a.voxel) == 0);
}

/* The usual colours of labels differ. */
static void name_both(void)
{
    for (unsigned l = 1; l < LABELS; l++) {
        char line[40];
        snprintf(line, sizeof line, "label %%u part-%u #%06x", l, 1000000 * l);
        do_both(line, l, 0);
    }
}

static void begin_both(void)
{
    for (unsigned l = 1; l < LABELS; l++)
        number[l] = 256 + 800000000 * l + check_below(&seed, 800000000 - 256);
    for (unsigned l = LABELS - 1; l > 1; l--) {
        const unsigned other = 1 + check_below(&seed, l);
        const uint32_t is = number[l];
        number[l] = number[other];
        number[other] = is;
    }
    /* Random boxes. */
    memset(map, 0, sizeof map);
    for (unsigned l = 1; l < LABELS; l++) {
        const uint32_t x = check_below(&seed, 8), y = check_below(&seed, 7),
                       z = check_below(&seed, 6);
        for (uint32_t k = 0; k < 64; k++)
            map[z + k / 16][y + k / 4 % 4][x + k % 4] = (uint8_t)l;
    }
    write_map("small.nii", size, VOXEL_UINT8, small_row, NULL);
    write_map("large.nii", size, VOXEL_UINT32, large_row, NULL);
    begin_with_journal(&small, "small.iftty");
    begin_with_journal(&large, "large.iftty");
    must(&small, "labels small.nii");
    must(&large, "labels large.nii");
    name_both();
}

STORY(large_numbers_in_any_order_change_nothing_else)
{
    for (int round = 0; round < ROUNDS; round++) {
        struct snapshot before;
        seed = (uint64_t)round;
        begin_both();
        for (int step = 0; step < STEPS; step++)
            do_random();
        name_both();
        do_both("run", 0, 0);
        compare_both();
        draw_both();
        take_snapshot(&before, &large);
        resume_journal(&large, "large.iftty");
        is_segmented_as(&before, &large);
        interpreter_release(&small);
        interpreter_release(&large);
        verify_journal("large.iftty");
    }
}

static void begin_with_numbers(struct interpreter *interp)
{
    begin_with_scene(interp);
    must(interp, "label 300 left; label 4000000001 right; seed 1,1,1 300; seed 9,9,9 right");
}
#define NUMBER_STORY(told) BEGUN_STORY(told, begin_with_numbers)

NUMBER_STORY(a_command_has_the_numbers_of_its_labels)
{
    must(interp, "seed 3,3,3 left");
    CHECK_TEXT(buf_text(&reply.canonical), "seed 3,3,3 300");
    must(interp, "box 1,1,1 2,2,2 right within=0 over=0-300");
    CHECK_TEXT(buf_text(&reply.canonical), "box 1,1,1 2,2,2 4000000001 within=0 over=0,2,300");
    must(interp, "seed 5,5,5 300 radius=1 within=0 keep=cerebellum,4000000001");
    CHECK_TEXT(buf_text(&reply.canonical), "seed 5,5,5 300 radius=1 within=0 keep=2,4000000001");
    MUST_MENTION(interp, "run; why 9,9,9", "4000000001 right");
    MUST_MENTION(interp, "info", "numbers   3 labels, 2 to 4000000001, of 255");
}

NUMBER_STORY(an_unknown_number_is_refused_with_the_nearest)
{
    is_refused(interp, "seed 1,1,1 299",
               "LABEL: there is no label 299; the nearest is 300 left; `label 299 NAME` makes it");
    is_refused(interp, "seed 1,1,1 4294967295", "the nearest is 4000000001 right");
    is_refused(interp, "hide 1", "there is no label 1; the nearest is 2 cerebellum");
    is_refused(interp, "seed 3,3,3 2 radius=1 within=0 over=3-299", "over: there is no label 3");
    is_refused(interp, "seed 1,1,1 4294967296", "the number or the name of a label");
    is_refused(interp, "label 1 left", "label 300 is already called left");
    is_refused(interp, "label 300 left number=2", "number: there is a label 2 already");
    is_refused(interp, "label 0 none number=7", "number: label 0 is 0 in every file");
}

NUMBER_STORY(labels_end_at_255)
{
    char line[40];
    for (unsigned n = 1000; n < 1252; n++) {
        snprintf(line, sizeof line, "label %u part-%u", n, n);
        must(interp, line);
    }
    is_refused(interp, "label 2000 more", "LABEL: 255 labels exist, and no more fit");
    must(interp, "label 1000 more number=2000; seed 2,2,2 2000; undo 3; label 1 one");
}
