/* SPDX-License-Identifier: MIT */
/* Reaches of seeds, worked by hand. Random edits, with arcs of every kind, regions of interest and
 * reaches, against a run from scratch and an oracle that shares no code with the engine; edits that
 * do not go through; threads. */
#include "tests/check_main.h"

#include "base/team.h"
#include "tests/plain_forest.h"
#include "tests/scarce_memory.h"

static uint16_t add_reach(struct world *w, uint32_t x, uint32_t y, uint32_t z, int64_t radius)
{
    const struct reach reach = {{x, y, z}, {1, 1, 1}, radius};
    uint16_t number = 0;
    CHECK(forest_add_reach(w->forest, &reach, &number, NULL) == OK);
    return number;
}

static void plant(struct world *w, uint32_t x, int label, uint16_t reach)
{
    const struct edit edit = {grid_cell(&w->scene->grid, x, 0, 0), (int16_t)label, reach};
    CHECK(forest_edit(w->forest, &edit, 1, NULL) == OK && forest_check(w->forest, NULL));
}

/* Labels of a row; '.' for a voxel without a tree. */
static const char *row(const struct world *w)
{
    static char text[64];
    const uint32_t n = w->scene->grid.size[0];
    for (uint32_t x = 0; x < n; x++) {
        const struct cell *cell = w->scene->cell + grid_cell(&w->scene->grid, x, 0, 0);
        text[x] = cell_is_reached(cell) ? (char)('0' + cell->label) : '.';
    }
    text[n] = '\0';
    return text;
}

static void plant_gives(struct world *w, uint32_t x, int label, uint16_t reach, const char *labels)
{
    plant(w, x, label, reach);
    CHECK_TEXT(row(w), labels);
}

/* ---- by hand ---- */

STORY(a_tree_ends_where_its_seed_reaches)
{
    OWNED(world_free) struct world w = world_new(10, 1, 1, 6);
    CHECK_INT(refused(&w), 0);
    plant_gives(&w, 4, 1, add_reach(&w, 4, 0, 0, 2), "..11111...");
    CHECK_INT(refused(&w), 5);
    CHECK_INT(forest_limited_seeds(w.forest), 1);
    plant_gives(&w, 9, 2, 0, "..11111222"); /* the tree in between shields it from what is behind */
    CHECK_INT(refused(&w), 2);
    plant_gives(&w, 4, EDIT_ERASE, 0, "2222222222");
    CHECK_INT(refused(&w), 0);
    CHECK_INT(forest_limited_seeds(w.forest), 0);
}

STORY(a_reach_is_around_its_centre_and_not_around_the_seed)
{
    OWNED(world_free) struct world w = world_new(10, 1, 1, 6);
    const uint16_t reach = add_reach(&w, 5, 0, 0, 3);
    plant(&w, 3, 1, reach);
    CHECK_INT(forest_reach(w.forest, grid_cell(&w.scene->grid, 3, 0, 0))->centre[0], 5);
    CHECK(!forest_reach(w.forest, grid_cell(&w.scene->grid, 4, 0, 0)));
    CHECK_TEXT(row(&w), "..1111111.");
    plant_gives(&w, 3, 1, add_reach(&w, 5, 0, 0, 3),
                "..1111111."); /* the same under another number */
}

STORY(the_same_label_with_another_reach_is_another_seed)
{
    OWNED(world_free) struct world w = world_new(10, 1, 1, 6);
    plant_gives(&w, 5, 1, add_reach(&w, 5, 0, 0, 4), ".111111111");
    plant_gives(&w, 5, 1, add_reach(&w, 5, 0, 0, 1), "....111...");
    const struct seed_changes changes = forest_seed_changes(w.forest);
    CHECK(changes.count == 1 && changes.before[0].reach != changes.after[0].reach);
    const struct edit before = changes.before[0];
    CHECK(forest_edit(w.forest, &before, 1, NULL) == OK);
    CHECK_TEXT(row(&w), ".111111111");
    plant_gives(&w, 5, 1, 0, "1111111111");
    plant_gives(&w, 5, 1, add_reach(&w, 0, 0, 0, 2),
                ".....1...."); /* the seed itself lies outside, and remains */
}

/* A voxel that changes to another root of the same level may have a child that this root must not
 * hold: the child must notice. */
STORY(a_refused_child_hears_of_it)
{
    OWNED(world_free) struct world w = world_new(7, 1, 1, 6);
    plant(&w, 6, 1, 0);
    plant_gives(&w, 3, 2, add_reach(&w, 3, 0, 0, 1),
                "..22211"); /* 0 and 1 had their tree through 2 */
    plant_gives(&w, 3, EDIT_ERASE, 0, "1111111");
    plant_gives(&w, 0, 2, add_reach(&w, 0, 0, 0, 3), "2222111");
    plant_gives(&w, 6, EDIT_ERASE, 0, "2222...");
    plant_gives(&w, 1, 3, 0, "2333333");
    plant_gives(&w, 1, 3, add_reach(&w, 1, 0, 0, 1),
                "233...."); /* 2 cannot pass through voxels held by 3 */
    plant_gives(&w, 1, EDIT_ERASE, 0, "2222...");
}

STORY(distances_are_in_whole_units_and_the_ball_is_closed)
{
    const struct reach unit = {{10, 10, 10}, {1, 1, 1}, 5},
                       mm = {{0, 0, 0}, {700000, 1000000, 2500000}, 5000000},
                       wide = {{65533, 65533, 0}, {UINT32_MAX, UINT32_MAX, 1}, 1000000000};
    CHECK(reach_holds(&unit, 13, 14, 10) && reach_holds(&unit, 5, 10, 10));
    CHECK(!reach_holds(&unit, 13, 14, 11) && !reach_holds(&unit, 4, 10, 10));
    CHECK(reach_holds(&mm, 7, 0, 0) && !reach_holds(&mm, 8, 0, 0));
    CHECK(reach_holds(&mm, 0, 3, 1) && reach_holds(&mm, 0, 0, 2) && !reach_holds(&mm, 1, 0, 2));
    CHECK(reach_holds(&wide, 65533, 65533, 65533) && !reach_holds(&wide, 0, 0, 0));
}

/* ---- random edits ---- */

STORY(random_edits_equal_the_oracle_and_a_run_from_scratch)
{
    for (unsigned i = 0; i < check_scaled(1400) && check_failures == 0; i++)
        random_session(i, 16, true, NULL);
    CHECK(holes_seen > 1000);
}

STORY(threads_change_nothing)
{
    OWNED(team_drop) struct team *team;
    if (!CHECK(team_new(&team, 3, NULL) == OK))
        return;
    for (unsigned i = 0; i < check_scaled(40) && check_failures == 0; i++)
        random_session(100000 + i, 12, true, team);
}

/* ---- what is refused ---- */

STORY(without_memory_nothing_has_changed)
{
    OWNED(world_free) struct world w = world_new(10, 1, 1, 6);
    const struct reach reach = {{4, 0, 0}, {1, 1, 1}, 2};
    uint16_t number = 0;
    allow_allocations(0);
    CHECK_INT(forest_add_reach(w.forest, &reach, &number, NULL), ERR_MEMORY);
    mem_allows = NULL;
    plant_gives(&w, 4, 1, 0, "1111111111");
    CHECK(forest_add_reach(w.forest, &reach, &number, NULL) == OK);
    plant(&w, 4, 1, number);
    size_t voxels;
    allow_allocations(0);
    CHECK_INT(forest_count_refused(w.forest, &voxels, NULL), ERR_MEMORY);
    mem_allows = NULL;
    CHECK_INT(refused(&w), 5);
}

STORY(there_are_no_more_than_65535_reaches)
{
    OWNED(world_free) struct world w = world_new(4, 1, 1, 6);
    struct fault fault = {0};
    for (int i = 0; i < UINT16_MAX; i++)
        add_reach(&w, 0, 0, 0, i);
    CHECK_INT(forest_add_reach(w.forest, &(struct reach){.radius = 1}, &(uint16_t){0}, &fault),
              ERR_LIMIT);
    CHECK_HAS(fault.text, "65535");
}
