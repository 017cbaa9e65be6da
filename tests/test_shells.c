/* SPDX-License-Identifier: MIT */
/* Shells, as commands: an object does not leave one, other objects are not cut by it, it is one
 * marker and one undo, and what makes no sense is refused. Which voxels they are, test_paint
 * proves. */
#include "tests/scene_main.h"

static struct interpreter interp;

static int label_at(uint32_t x, uint32_t y, uint32_t z)
{
    const struct scene *scene = interp.session->scene;
    return scene->cell[grid_cell(&scene->grid, x, y, z)].label;
}

/* The voxels of a label that are farther than the radius from 5,5,5. */
static size_t beyond(int label, int radius)
{
    size_t count = 0;
    for (int z = 0; z < (int)size[2]; z++)
        for (int y = 0; y < (int)size[1]; y++)
            for (int x = 0; x < (int)size[0]; x++) {
                const int far = (x - 5) * (x - 5) + (y - 5) * (y - 5) + (z - 5) * (z - 5);
                count += far > radius * radius &&
                         label_at((uint32_t)x, (uint32_t)y, (uint32_t)z) == label;
            }
    return count;
}

STORY(an_object_does_not_leave_its_shell)
{
    static const char *const adjacency[] = {"adjacency 6", "adjacency 26"};
    begin_with_journal(&interp, "inside.iftty");
    must(&interp, "auto on");
    for (int i = 0; i < 2; i++) {
        must(&interp, adjacency[i]);
        must(&interp, "seed 5,5,5 1");
        CHECK(beyond(1, 4) > 0);
        must(&interp, "seed 5,5,5 0 radius=4 shell=yes");
        CHECK_TEXT(buf_text(&reply.canonical), "seed 5,5,5 0 radius=4 shell=yes");
        CHECK_HAS(buf_text(&reply.words), "marker=");
        CHECK_INT(label_at(5, 5, 5), 1);
        CHECK_INT(beyond(1, 4), 0);
        must(&interp, "undo");
        CHECK(beyond(1, 4) > 0);
        must(&interp, "box 1,9,1 9,1,9 0 shell=yes");
        CHECK_INT(label_at(9, 9, 9), 0);
        CHECK_INT(label_at(11, 10, 9), 0);
        CHECK_INT(label_at(5, 5, 5), 1);
        must(&interp, "undo 2");
    }
    interpreter_release(&interp);
}

JOURNAL_STORY(a_shell_is_one_marker, "marker.iftty")
{
    MUST_RECORD(&interp, "auto on; seed 5,5,5 1; seed 5,5,5 0 shell=yes radius=3; remove 5,5,2",
                "removed=2");
    CHECK_INT(forest_seeds(interp.session->forest), 1);
    must(&interp, "undo");
    CHECK(forest_seeds(interp.session->forest) > 50);
    must(&interp, "box 0,0,0 11,10,9 0 shell=yes around=1");
    struct snapshot end;
    take_snapshot(&end, &interp);
    resume_journal(&interp, "marker.iftty");
    is_segmented_as(&end, &interp);
}

JOURNAL_STORY(a_shell_cuts_no_other_object, "others.iftty")
{
    must(&interp, "auto on; seed 5,5,5 1; box 5,5,8 5,5,9 2");
    CHECK_INT(label_at(5, 5, 9), 2);
    MUST_MENTION(&interp, "seed 5,5,5 0 radius=4 shell=yes", "left out, in another object: ");
    CHECK_INT(label_at(5, 5, 9), 2);
    must(&interp, "undo");
    must(&interp, "seed 5,5,5 0 radius=4 shell=yes around=2"); /* which cuts that one, and not 1 */
    CHECK_INT(label_at(5, 5, 9), 0);
    must(&interp, "undo");
    must(&interp, "seed 5,5,5 3 radius=4 shell=yes"); /* voxels around it may also have a label */
    CHECK(beyond(3, 4) > 0 && beyond(1, 4) == 0);
}

/* Digest of the forest after commands in a new session. */
static uint64_t forest_after(const char *first, const char *second, const char *third)
{
    interpreter_release(&interp);
    begin_with_journal(&interp, "order.iftty");
    must(&interp, "auto on");
    must(&interp, first);
    must(&interp, second);
    must(&interp, third);
    return forest_digest(interp.session->forest);
}

/* An object with a seed outside, or in the shell, is not enclosed: it is not cut. */
STORY(a_shell_around_two_objects_may_come_first_or_last)
{
    static const char *const object[] = {"seed 4,5,5 1 radius=1", "box 6,5,5 7,6,5 2"},
                             *const background[] = {"seed 5,5,5 0 radius=4 shell=yes",
                                                    "seed 5,5,5 0 radius=4 shell=yes around=2",
                                                    "seed 5,5,5 0 radius=4mm shell=yes",
                                                    "box 1,1,2 9,9,8 0 shell=yes"};
    begin_with_journal(&interp, "order.iftty");
    for (size_t i = 0; i < sizeof background / sizeof *background; i++) {
        const uint64_t first = forest_after(background[i], object[0], object[1]);
        CHECK(forest_after(object[0], background[i], object[1]) == first);
        CHECK(forest_after(object[0], object[1], background[i]) == first);
        CHECK(!strstr(buf_text(&reply.text), "left out"));
    }
    must(&interp, "undo; seed 11,10,9 2");
    MUST_MENTION(&interp, background[0], "left out, in another object: ");
    must(&interp, "undo 2; seed 5,5,1 1; seed 1,5,5 2");
    MUST_MENTION(&interp, background[0], "left out, in another object: ");
    must(&interp, "undo 3; seed 5,7,5 0"); /* in the middle between both */
    must(&interp, background[0]);
    CHECK_INT(beyond(1, 4) + beyond(2, 4), 0);
    interpreter_release(&interp);
}

STORY(a_new_session_leads_to_a_sphere_and_then_to_an_outline)
{
    static const struct {
        const char *commands;
        enum proposal proposal;
    } step[] = {{"auto on", PROPOSE_NOTHING},
                {"seed 5,5,5 1 radius=1", PROPOSE_SPHERE},
                {"seed 5,5,6 1", PROPOSE_SPHERE},
                {"undo; seed 5,5,5 0 radius=4 shell=yes", PROPOSE_OUTLINE},
                {"seed 2,2,2 0", PROPOSE_NOTHING},
                {"undo 3; outline 2,2,5 1 to=6,2,5 to=6,6,5", PROPOSE_OUTLINE}, /* with its ring */
                {"seed 9,9,9 2", PROPOSE_NOTHING},
                {"undo 2; seed 5,5,5 0", PROPOSE_NOTHING},
                {"undo; seed 5,5,5 1; remove 5,5,5", PROPOSE_NOTHING}};
    begin_with_journal(&interp, "next.iftty");
    CHECK(session_find_proposal(interp.session) == PROPOSE_NOTHING);
    for (size_t i = 0; i < sizeof step / sizeof *step; i++) {
        must(&interp, step[i].commands);
        CHECK_INT(session_find_proposal(interp.session), step[i].proposal);
    }
    interpreter_release(&interp);
}

/* Voxels are 1 x 1.5 x 2 mm: a ball of the world goes through the voxel, and no farther. */
JOURNAL_STORY(a_shell_may_be_given_by_a_voxel_that_it_goes_through, "through.iftty")
{
    must(&interp, "seed 5,5,5 1; seed 5,5,5 0 shell=yes through=9,5,5; run");
    CHECK(label_at(9, 5, 5) == 0 && label_at(5, 5, 5) == 1);
    const struct scene *scene = interp.session->scene;
    const struct cell *cell = scene->cell;
    CHECK(cell[grid_cell(&scene->grid, 9, 5, 5)].flags & CELL_SEED);
    CHECK(!(cell[grid_cell(&scene->grid, 10, 5, 5)].flags & CELL_SEED));
    CHECK(cell[grid_cell(&scene->grid, 5, 7, 5)].flags & CELL_SEED);
    CHECK(!(cell[grid_cell(&scene->grid, 5, 8, 5)].flags & CELL_SEED));
    CHECK(cell[grid_cell(&scene->grid, 5, 5, 7)].flags & CELL_SEED);
    CHECK(!(cell[grid_cell(&scene->grid, 5, 5, 8)].flags & CELL_SEED));
}

JOURNAL_STORY(why_names_the_strongest_edge_and_the_label_that_would_come_next, "why.iftty")
{
    must(&interp, "label 2 \"left hemi\"; seed 1,1,1 1; run");
    MUST_MENTION(&interp, "why 9,1,1", ": its strongest edge\n");
    CHECK(!strstr(buf_text(&reply.text), "next is label"));
    must(&interp, "seed 10,1,1 2; run");
    MUST_MENTION(&interp, "why 9,1,1", "label 2 left hemi, of the seed at 10,1,1");
    CHECK_HAS(buf_text(&reply.text), "next is label 1, at a cost of ");
    MUST_MENTION(&interp, "why 1,1,1", "next is label 2 left hemi, at a cost of ");
    must(&interp, "weight polarity; why 9,1,1");
    CHECK(!strstr(buf_text(&reply.text), "next is label"));
}

JOURNAL_STORY(the_first_gesture_may_be_a_shell, "first.iftty")
{
    must(&interp, "seed 5,5,5 0 radius=4 shell=yes; seed 5,5,5 1; run");
    CHECK_INT(label_at(5, 5, 5), 1);
    CHECK_INT(beyond(1, 4), 0);
}

/* No tree holds a middle outside the region of interest, and so no object of label 0 either. */
JOURNAL_STORY(the_middle_of_a_shell_may_lie_outside_the_region, "outside.iftty")
{
    MUST_MENTION(&interp, "range 60 255; seed 5,5,5 0 radius=4 shell=yes",
                 "left out, outside the region of interest: ");
    must(&interp, "seed 9,9,9 1; run");
    CHECK(beyond(1, 4) > 0);
}

JOURNAL_STORY(what_is_no_shell_is_refused, "refused.iftty")
{
    must(&interp, "auto on; seed 5,5,5 1");
    static const char *const refused[][2] = {
        {"seed 5,5,5 0 shell=yes", "a ball of radius 0 has nothing inside"},
        {"seed 5,5,5 0 radius=0 shell=yes", "a ball of radius 0 has nothing inside"},
        {"seed 5,5,5 0 radius=100 shell=yes", "no voxel of it is in the scene"},
        {"seed 5,5,5 0 radius=513 shell=yes", "radius: expected a number 0..512"},
        {"seed 5,5,5 0 radius=900mm shell=yes", "it reaches 900 voxels along x; at most 512"},
        {"seed 5,5,5 0 radius=129", "it reaches 129 voxels along x; at most 128"},
        {"seed 15,5,5 0 radius=3 shell=yes", "15"},
        {"seed 5,5,5 1 radius=3 shell=yes", "label 1 is also the label of the object inside"},
        {"seed 5,5,5 1 radius=3 shell=yes around=1", "also the label of the object inside"},
        {"seed 5,5,5 0 radius=3 shell=yes to=6,6,6", "not for strokes"},
        {"seed 5,5,5 1 radius=3 shell=yes joined=yes", "not for strokes"},
        {"seed 5,5,5 0 through=6,6,6", "through: only with shell=yes"},
        {"seed 5,5,5 0 radius=3 through=6,6,6 shell=yes", "`radius` or `through`, not both"},
        {"seed 5,5,5 0 through=5,5,5 shell=yes", "a ball of radius 0 has nothing inside"},
        {"seed 5,5,5 0 radius=3 around=1", "around: only with shell=yes"},
        {"box 1,1,1 5,5,5 0 around=1", "around: only with shell=yes"},
        {"box 1,1,1 5,2,5 0 shell=yes", "less than 3 voxels thick has nothing inside"},
        {"box 5,5,5 5,5,5 0 shell=yes", "less than 3 voxels thick has nothing inside"},
        {"seed 9,5,5 0 radius=2 shell=yes around=2", "is in objects other than the one"},
    };
    for (size_t i = 0; i < sizeof refused / sizeof *refused; i++)
        is_refused(&interp, refused[i][0], refused[i][1]);
    must(&interp, "seed 0,0,0 2 radius=2 shell=yes");
}
