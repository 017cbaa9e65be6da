/* SPDX-License-Identifier: MIT */
/*
 * Reaches of seeds, worked by hand. Random edits, with arcs of every kind, regions of interest and
 * reaches, against a run from scratch and an oracle that shares no code with the engine; edits that
 * do not go through; threads.
 */
#include "tests/check_main.h"

#include <stdlib.h>

#include "base/team.h"
#include "engine/forest.h"
#include "engine/roi.h"
#include "tests/plain_forest.h"
#include "tests/scarce_memory.h"
#include "tests/stopping.h"

enum { LABELS = 4 };

static unsigned plain_reaches; /* of the world */

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
    CHECK(forest_edit(w->forest, &edit, 1, NULL) == OK);
    CHECK(forest_check(w->forest, NULL));
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

static size_t refused(const struct world *w)
{
    size_t voxels = 99;
    CHECK(forest_count_refused(w->forest, &voxels, NULL) == OK);
    return voxels;
}

/* ---- by hand ---- */

STORY(a_tree_ends_where_its_seed_reaches)
{
    struct world w = world_new(10, 1, 1, 6);
    CHECK_INT(refused(&w), 0);
    plant_gives(&w, 4, 1, add_reach(&w, 4, 0, 0, 2), "..11111...");
    CHECK_INT(refused(&w), 5);
    CHECK_INT(forest_limited_seeds(w.forest), 1);
    plant_gives(&w, 9, 2, 0, "..11111222"); /* the tree in between shields it from what is behind */
    CHECK_INT(refused(&w), 2);
    plant_gives(&w, 4, EDIT_ERASE, 0, "2222222222");
    CHECK_INT(refused(&w), 0);
    CHECK_INT(forest_limited_seeds(w.forest), 0);
    world_free(&w);
}

STORY(a_reach_is_around_its_centre_and_not_around_the_seed)
{
    struct world w = world_new(10, 1, 1, 6);
    const uint16_t reach = add_reach(&w, 5, 0, 0, 3);
    plant(&w, 3, 1, reach);
    CHECK_INT(forest_reach(w.forest, grid_cell(&w.scene->grid, 3, 0, 0))->centre[0], 5);
    CHECK(!forest_reach(w.forest, grid_cell(&w.scene->grid, 4, 0, 0)));
    CHECK_TEXT(row(&w), "..1111111.");
    plant_gives(&w, 3, 1, add_reach(&w, 5, 0, 0, 3),
                "..1111111."); /* the same under another number */
    world_free(&w);
}

STORY(the_same_label_with_another_reach_is_another_seed)
{
    struct world w = world_new(10, 1, 1, 6);
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
    world_free(&w);
}

/* A voxel that changes to another root of the same level may have a child that this root must not
 * hold: the child must notice. */
STORY(a_refused_child_hears_of_it)
{
    struct world w = world_new(7, 1, 1, 6);
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
    world_free(&w);
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

/* ---- against the oracle ---- */

/* Voxels without a key next to one that has a key, or next to such a voxel. */
static size_t plain_refused(const struct world *w, const struct plain *key)
{
    static bool out[CELLS_MOST];
    const struct adjacency *adjacency = forest_adjacency(w->forest);
    const struct grid *g = &w->scene->grid;
    size_t count = 0;
    memset(out, 0, sizeof out);
    for (bool changes = true; changes;) {
        changes = false;
        for (size_t c = 0; c < g->cells; c++) {
            if (out[c] || key[c].cost != UINT32_MAX ||
                w->scene->cell[c].flags & (CELL_RIM | CELL_OUTSIDE))
                continue;
            bool beside = false;
            for (unsigned i = 0; i < adjacency->count; i++) {
                const size_t n = c + (size_t)adjacency->offset[i];
                beside |= out[n] || key[n].cost != UINT32_MAX;
            }
            changes |= out[c] = beside;
            count += beside;
        }
    }
    return count;
}

static bool equals_oracle(const struct world *w, const struct planted *planted)
{
    static struct plain key[CELLS_MOST];
    const bool same = equals_plain(w, planted, key);
    return same && refused(w) == (forest_limited_seeds(w->forest) ? plain_refused(w, key) : 0);
}

/* ---- random edits ---- */

enum texture { FLAT, NOISY, STEEP, TEXTURES };

static void random_arcs(struct world *w, uint64_t *random)
{
    struct arc_rule rule = {.kind = check_below(random, 2) ? ARC_TARGET : check_below(random, 3)};
    for (int label = 0; label < LABELS; label++)
        rule.polarity[label] = (int8_t)((int)check_below(random, 201) - 100);
    forest_set_arcs(w->forest, &rule);
}

/* In a third of the worlds no seed has a reach. */
static struct world random_world(uint64_t *random)
{
    struct world w = world_new(1 + check_below(random, 9), 1 + check_below(random, 7),
                               1 + check_below(random, 4), check_below(random, 3) ? 6 : 26);
    const struct grid *g = &w.scene->grid;
    const enum texture texture = (enum texture)check_below(random, TEXTURES);
    const uint32_t levels = check_below(random, 3) ? 5 : 65536;
    const unsigned reaches = check_below(random, 3) ? REACHES : 0;
    for (size_t i = 0; i < g->cells; i++) {
        struct cell *cell = w.scene->cell + i;
        const uint32_t value = check_below(random, texture == STEEP ? 60000 : 4);
        if (cell->flags & CELL_RIM)
            continue;
        cell->weight = (uint16_t)(texture == FLAT ? 0 : value);
        cell->intensity = (uint16_t)check_below(random, levels);
    }
    random_arcs(&w, random);
    for (plain_reaches = 0; plain_reaches < reaches; plain_reaches++) {
        struct reach *reach = &plain_reach[plain_reaches];
        *reach = (struct reach){.radius = check_below(random, 7)};
        if (plain_reaches == 0 && check_below(random, 3) == 0)
            reach->radius = REACH_EXACT;
        for (int a = 0; a < 3; a++) {
            reach->centre[a] = check_below(random, g->size[a]);
            reach->unit[a] = 1 + (check_below(random, 4) == 0);
        }
        uint16_t number;
        CHECK(forest_add_reach(w.forest, reach, &number, NULL) == OK);
    }
    return w;
}

/* A ball or a few voxels of one marker, erasures, or seeds planted again with another reach. */
static size_t random_batch(const struct world *w, const struct planted *planted, struct edit *batch,
                           uint64_t *random)
{
    const struct grid *g = &w->scene->grid;
    size_t count = 0;
    if (check_below(random, 30) == 0) {
        for (uint32_t c = 0; c < g->cells; c++)
            if (planted->label[c] != EDIT_ERASE)
                batch[count++] = (struct edit){c, EDIT_ERASE, 0};
        return count;
    }
    for (uint32_t n = 1 + check_below(random, 4); n > 0; n--) {
        uint32_t at = random_voxel(g, random);
        const struct cell *cell = w->scene->cell + at;
        int16_t label = (int16_t)check_below(random, LABELS);
        const uint32_t what = check_below(random, 6);
        if (what < 3 && cell_is_reached(cell)) { /* the seed whose tree holds the voxel */
            at = key_root(cell->key);
            label = what == 0 ? w->scene->cell[at].label : EDIT_ERASE;
        }
        if (w->scene->cell[at].flags & CELL_OUTSIDE)
            continue;
        const bool has_reach = plain_reaches && check_below(random, 3);
        const uint16_t reach = (uint16_t)(has_reach ? 1 + check_below(random, plain_reaches) : 0);
        batch[count++] = (struct edit){at, label, label == EDIT_ERASE ? 0 : reach};
    }
    return count;
}

static void note(struct planted *planted, const struct edit *edit, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        planted->label[edit[i].cell] = edit[i].label;
        planted->reach[edit[i].cell] = edit[i].reach;
    }
}

/* A region of interest of few voxels, most or all, by a mask, a range or both; seeds outside it
 * are removed first. */
static void random_roi(struct world *w, struct planted *planted, uint64_t *random)
{
    static struct edit batch[CELLS_MOST];
    static uint64_t bits[CELLS_MOST / 64 + 1];
    const uint32_t part = 1 + check_below(random, 10);
    struct roi roi = roi_none();
    size_t count = 0;
    roi.mask = check_below(random, 3) ? bits : NULL;
    memset(bits, 0, sizeof bits);
    for (uint32_t c = 0; c < w->scene->grid.cells; c++)
        bits[c >> 6] |= (uint64_t)(check_below(random, 11) < part) << (c & 63);
    if (check_below(random, 3) == 0) {
        roi.low = w->scene->cell[random_voxel(&w->scene->grid, random)].intensity;
        roi.high = w->scene->cell[random_voxel(&w->scene->grid, random)].intensity;
    }
    for (uint32_t c = 0; c < w->scene->grid.cells; c++)
        if (planted->label[c] != EDIT_ERASE && !roi_holds(&roi, w->scene, c))
            batch[count++] = (struct edit){c, EDIT_ERASE, 0};
    CHECK_INT(roi_tally(&roi, w->scene).seeds_outside, count);
    CHECK(forest_edit(w->forest, batch, count, NULL) == OK);
    note(planted, batch, count);
    roi_apply(&roi, w->scene);
    CHECK(forest_rebuild(w->forest, NULL) == OK);
}

/* An edit that is stopped after some looks, if it is not done by then. */
static bool edit_stopped(struct world *w, const struct edit *edit, size_t count, int looks)
{
    struct watch watch = {.context = &looks, .poll = stop_after_looks, .step = 1};
    w->scene->watch = &watch;
    const enum err err = forest_edit(w->forest, edit, count, NULL);
    w->scene->watch = NULL;
    CHECK(err == OK || err == ERR_CANCELLED);
    return err != OK;
}

/* One edit, either undone, or stopped and rolled back, or followed by a rebuild. */
static void random_edit(struct world *w, struct planted *planted, uint64_t *random)
{
    static struct edit batch[CELLS_MOST];
    static bool was_stopped; /* the edit before: then it has changed nothing that could be undone */
    const struct seed_changes last =
        was_stopped ? (struct seed_changes){0} : forest_seed_changes(w->forest);
    size_t count = random_batch(w, planted, batch, random);
    const uint32_t what = check_below(random, 24);
    was_stopped = false;
    if (what < 5 && last.count > 0 && last.count < CELLS_MOST) {
        count = 0;
        for (size_t i = 0; i < last.count; i++)
            if (!(w->scene->cell[last.before[i].cell].flags & CELL_OUTSIDE))
                batch[count++] = last.before[i];
    } else if (what < 9) {
        was_stopped = edit_stopped(w, batch, count, (int)check_below(random, 12));
        if (was_stopped)
            return;
        note(planted, batch, count);
        return;
    } else if (what == 9) {
        random_roi(w, planted, random);
        return;
    } else if (what == 10) {
        random_arcs(w, random);
        CHECK(forest_rebuild(w->forest, NULL) == OK);
    } else if (what == 11) {
        forest_suspend(w->forest);
        CHECK(forest_edit(w->forest, batch, count, NULL) == OK);
        CHECK(forest_catch_up(w->forest, NULL) == OK);
        note(planted, batch, count);
        return;
    }
    CHECK(forest_edit(w->forest, batch, count, NULL) == OK);
    note(planted, batch, count);
}

/* The number of voxels that had to do without a tree, over all. */
static size_t holes_seen;

static void random_session(uint64_t seed, unsigned steps, struct team *team)
{
    static struct planted planted;
    uint64_t random = seed;
    struct world w = random_world(&random);
    struct fault fault = {0};
    CHECK(forest_set_team(w.forest, team, NULL) == OK);
    for (size_t c = 0; c < CELLS_MOST; c++) {
        planted.label[c] = EDIT_ERASE;
        planted.reach[c] = 0;
    }
    for (unsigned step = 0; step < steps; step++) {
        random_edit(&w, &planted, &random);
        if (!CHECK(equals_oracle(&w, &planted)) ||
            !CHECK(world_equals_scratch(&w, team, plain_reach, plain_reaches)) ||
            !CHECK(forest_check(w.forest, &fault))) {
            printf("# seed %" PRIu64 " step %u %s\n", seed, step, fault.text);
            break;
        }
        holes_seen += refused(&w);
    }
    world_free(&w);
}

STORY(random_edits_equal_the_oracle_and_a_run_from_scratch)
{
    for (unsigned i = 0; i < check_scaled(1400) && check_failures == 0; i++)
        random_session(i, 16, NULL);
    CHECK(holes_seen > 1000);
}

STORY(threads_change_nothing)
{
    struct team *team;
    if (!CHECK(team_new(&team, 3, NULL) == OK))
        return;
    for (unsigned i = 0; i < check_scaled(40) && check_failures == 0; i++)
        random_session(100000 + i, 12, team);
    team_free(team);
}

/* ---- what is refused ---- */

STORY(without_memory_nothing_has_changed)
{
    struct world w = world_new(10, 1, 1, 6);
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
    world_free(&w);
}

STORY(there_are_no_more_than_65535_reaches)
{
    struct world w = world_new(4, 1, 1, 6);
    struct fault fault = {0};
    for (int i = 0; i < UINT16_MAX; i++)
        add_reach(&w, 0, 0, 0, i);
    CHECK_INT(forest_add_reach(w.forest, &(struct reach){.radius = 1}, &(uint16_t){0}, &fault),
              ERR_LIMIT);
    CHECK_HAS(fault.text, "65535");
    world_free(&w);
}
