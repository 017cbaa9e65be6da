/* SPDX-License-Identifier: MIT */
/* Margins: by hand, and against the best path of each label in turn, by a plain slow search. */
#include "tests/check_main.h"

#include "engine/margin.h"
#include "engine/roi.h"
#include "tests/scarce_memory.h"
#include "tests/world.h"

static struct world w;

/* ---- by hand ---- */

STORY(a_margin_is_what_the_other_label_would_have_to_pay_more)
{
    static const uint16_t weight[] = {1, 1, 5, 1, 1, 9, 2, 2, 65535};
    /* From voxel 0 label 1 pays 1 up to the 5; from voxel 7, label 2 pays 2 up to the 9. */
    static const uint16_t expected[] = {9, 8, 4, 4, 4, 0, 7, 9, MARGIN_NONE};
    OWNED(mem_release) uint16_t *margin = NULL;
    w = world_new(9, 1, 1, 6);
    const uint32_t first = grid_cell(&w.scene->grid, 0, 0, 0);
    for (uint32_t x = 0; x < 9; x++)
        w.scene->cell[first + x].weight = weight[x];
    world_plant(&w, first, 1);
    world_plant(&w, first + 7, 2);
    CHECK(margin_new(&margin, w.forest, NULL) == OK);
    for (uint32_t x = 0; x < 9; x++)
        CHECK_INT(margin[first + x], expected[x]);
    world_free(&w);
}

STORY(where_one_label_is_alone_there_is_no_margin)
{
    uint16_t *margin;
    w = world_new(4, 3, 2, 26);
    CHECK(margin_new(&margin, w.forest, NULL) == OK);
    for (size_t c = 0; c < w.scene->grid.cells; c++)
        CHECK_INT(margin[c], MARGIN_NONE);
    free(margin);
    world_plant(&w, grid_cell(&w.scene->grid, 1, 1, 1), 3);
    world_plant(&w, grid_cell(&w.scene->grid, 3, 2, 0), 3);
    CHECK(margin_new(&margin, w.forest, NULL) == OK);
    for (size_t c = 0; c < w.scene->grid.cells; c++)
        CHECK_INT(margin[c], MARGIN_NONE);
    free(margin);
    world_free(&w);
}

/* The seed at 2,0 is only offered the 9 that label 1 pays in 1,0: that the seed at 0,0 would pay 1
 * there is of no use to it, as they have the same label. */
STORY(a_cost_beyond_a_reach_is_passed_on_within_a_label_alone)
{
    OWNED(mem_release) uint16_t *margin = NULL;
    const struct reach exact = {.radius = REACH_EXACT};
    uint16_t reach;
    w = world_new(3, 3, 1, 6);
    const struct grid *grid = &w.scene->grid;
    for (uint32_t x = 0; x < 3; x++)
        for (uint32_t y = 0; y < 3; y++)
            w.scene->cell[grid_cell(grid, x, y, 0)].weight = y ? 9 : 1;
    CHECK(forest_add_reach(w.forest, &exact, &reach, NULL) == OK);
    const struct edit seed[] = {{grid_cell(grid, 0, 0, 0), 2, reach},
                                {grid_cell(grid, 2, 0, 0), 2, reach},
                                {grid_cell(grid, 1, 2, 0), 1, 0}};
    CHECK(forest_edit(w.forest, seed, 3, NULL) == OK);
    CHECK(margin_new(&margin, w.forest, NULL) == OK);
    CHECK_INT(margin[grid_cell(grid, 1, 0, 0)], 0);
    CHECK_INT(margin[grid_cell(grid, 2, 0, 0)], 9);
    world_free(&w);
}

/* Voxel 1 costs label 1 5, and the label of the exact seed would pay 0 there: so the cost of a path
 * from there is below that of the tree of label 1. */
STORY(a_cost_beyond_a_reach_may_be_below_the_one_in_the_forest)
{
    static const uint16_t weight[] = {5, 0, 5, 1, 0, 1}, expected[] = {5, 0, 0, 4, 5, 5};
    OWNED(mem_release) uint16_t *margin = NULL;
    const struct reach exact = {.radius = REACH_EXACT};
    uint16_t reach;
    w = world_new(6, 1, 1, 6);
    const uint32_t first = grid_cell(&w.scene->grid, 0, 0, 0);
    for (uint32_t x = 0; x < 6; x++)
        w.scene->cell[first + x].weight = weight[x];
    CHECK(forest_add_reach(w.forest, &exact, &reach, NULL) == OK);
    const struct edit seed[] = {{first, 3, reach}, {first + 5, 1, 0}};
    CHECK(forest_edit(w.forest, seed, 2, NULL) == OK);
    CHECK(margin_new(&margin, w.forest, NULL) == OK);
    for (uint32_t x = 0; x < 6; x++)
        CHECK_INT(margin[first + x], expected[x]);
    world_free(&w);
}

STORY(arcs_that_depend_on_the_label_are_refused)
{
    const struct arc_rule arcs = {.kind = ARC_POLARITY};
    struct fault fault = {0};
    uint16_t *margin;
    w = world_new(4, 3, 2, 6);
    forest_set_arcs(w.forest, &arcs);
    struct rival rival;
    CHECK_INT(rival_find(&rival, w.forest, grid_cell(&w.scene->grid, 1, 1, 1), &fault), OK);
    CHECK(!rival.exists);
    CHECK_INT(margin_new(&margin, w.forest, &fault), ERR_USAGE);
    CHECK_HAS(fault.text, "weight polarity");
    CHECK(margin == NULL);
    world_free(&w);
}

STORY(memory_that_runs_out_is_an_error)
{
    OWNED(mem_release) uint16_t *margin = NULL;
    struct fault fault = {0};
    w = world_new(4, 3, 2, 6);
    world_plant(&w, grid_cell(&w.scene->grid, 1, 1, 1), 3);
    world_plant(&w, grid_cell(&w.scene->grid, 2, 1, 1), 4);
    enum err err = ERR_MEMORY;
    for (size_t n = 0; n < 9 && err; n++) {
        allow_allocations(n);
        err = margin_new(&margin, w.forest, &fault);
        mem_allows = NULL;
        CHECK(err == OK || (err == ERR_MEMORY && margin == NULL));
    }
    CHECK_INT(err, OK);
    world_free(&w);
}

/* ---- the oracle ---- */

/* Costs of the best paths from the seeds of one label, by rounds over all voxels until nothing
 * changes. */
static void search(uint32_t *cost, uint8_t label)
{
    const struct adjacency *adjacency = forest_adjacency(w.forest);
    const size_t cells = w.scene->grid.cells;
    for (size_t c = 0; c < cells; c++) {
        const struct cell *cell = w.scene->cell + c;
        cost[c] = cell->flags & CELL_SEED && cell->label == label ? 0 : MARGIN_NONE;
    }
    for (bool changed = true; changed;) {
        changed = false;
        for (size_t c = 0; c < cells; c++) {
            const bool is_inside = !(w.scene->cell[c].flags & (CELL_RIM | CELL_OUTSIDE));
            for (unsigned i = 0; is_inside && i < adjacency->count; i++) {
                const size_t from = c + (size_t)adjacency->offset[i];
                const uint32_t step =
                    arc_weight_now(forest_arcs(w.forest), w.scene->cell + from, w.scene->cell + c);
                const uint32_t offered = step > cost[from] ? step : cost[from];
                changed |= offered < cost[c];
                cost[c] = offered < cost[c] ? offered : cost[c];
            }
        }
    }
}

enum { LABELS = 4, CELLS_MOST = 8 * 8 * 8 };

/* Its label is one that pays no more. */
static void check_rival(uint32_t cell, uint32_t expected, uint32_t cost[LABELS][CELLS_MOST])
{
    struct rival rival;
    CHECK(rival_find(&rival, w.forest, cell, NULL) == OK);
    CHECK(rival.exists == (expected != MARGIN_NONE));
    if (rival.exists) {
        CHECK_INT(rival.cost, expected);
        CHECK(rival.label != w.scene->cell[cell].label && cost[rival.label][cell] == expected);
    }
}

static void check_against_search(void)
{
    static uint32_t cost[LABELS][CELLS_MOST];
    OWNED(mem_release) uint16_t *margin;
    CHECK(margin_new(&margin, w.forest, NULL) == OK);
    for (uint8_t l = 0; l < LABELS; l++)
        search(cost[l], l);
    for (size_t c = 0; c < w.scene->grid.cells; c++) {
        const struct cell *cell = w.scene->cell + c;
        uint32_t other = MARGIN_NONE;
        for (uint8_t l = 0; l < LABELS && cell_is_reached(cell); l++)
            if (l != cell->label && cost[l][c] < other)
                other = cost[l][c];
        const uint32_t expected = other == MARGIN_NONE ? MARGIN_NONE : other - key_cost(cell->key);
        CHECK_INT(margin[c], expected);
        if (cell_is_reached(cell))
            check_rival((uint32_t)c, other, cost);
    }
}

DRAW_FROM(1)

STORY(margins_are_those_of_a_search_for_each_label)
{
    for (int round = 0; round < 400; round++) {
        const uint32_t size[3] = {1 + below(6), 1 + below(6), 1 + below(6)};
        const struct arc_rule arcs = {.kind = below(2) ? ARC_TARGET : ARC_DIFFERENCE};
        const uint32_t steepest = round % 3 ? 6 : 65536;
        w = world_new(size[0], size[1], size[2], below(2) ? 6 : 26);
        forest_set_arcs(w.forest, &arcs);
        for (size_t c = 0; c < w.scene->grid.cells; c++)
            if (!(w.scene->cell[c].flags & CELL_RIM)) {
                w.scene->cell[c].weight = (uint16_t)below(steepest);
                w.scene->cell[c].intensity = (uint16_t)below(steepest);
            }
        const struct roi roi = {NULL, 0, (uint16_t)(below(3) ? 65535 : steepest / 2), 0};
        roi_apply(&roi, w.scene);
        for (uint32_t seeds = below(8); seeds > 0; seeds--) {
            const uint32_t at =
                grid_cell(&w.scene->grid, below(size[0]), below(size[1]), below(size[2]));
            if (!(w.scene->cell[at].flags & CELL_OUTSIDE))
                world_plant(&w, at, (int16_t)below(LABELS));
        }
        check_against_search();
        world_free(&w);
    }
}
