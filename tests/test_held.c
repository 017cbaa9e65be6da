/* SPDX-License-Identifier: MIT */
/* What an eliminator would remove, found without visiting the whole scene: compared with a visit of
 * every voxel, and with the effect of `remove`. */
#include "engine/way.h"
#include "session/session.h"
#include "tests/scene_main.h"

DRAW_FROM(5)

static void plant_somewhere(struct interpreter *interp)
{
    char line[96];
    snprintf(line, sizeof line, "seed %u,%u,%u %u radius=%u", below(size[0]), below(size[1]),
             below(size[2]), below(4), below(4));
    must(interp, line);
}

static void begin(struct interpreter *interp, unsigned markers)
{
    begin_with_scene(interp);
    must(interp, below(2) ? "adjacency 26" : "adjacency 6");
    for (unsigned i = 0; i < markers; i++)
        plant_somewhere(interp);
}

/* ---- trees ---- */

STORY(a_tree_has_the_voxels_that_name_its_root)
{
    for (unsigned round = 0; round < 20; round++) {
        OWNED(interpreter_release) struct interpreter interp;
        begin(&interp, 5);
        must(&interp, "run");
        const struct session *session = interp.session;
        const struct scene *scene = session->scene;
        OWNED(mem_release) uint32_t *voxels = calloc(scene->grid.cells, sizeof *voxels);
        for (uint32_t c = 0; c < scene->grid.cells; c++)
            if (cell_is_reached(scene->cell + c))
                voxels[key_root(scene->cell[c].key)]++;
        for (uint32_t c = 0; c < scene->grid.cells; c++) {
            const size_t all = voxels[c];
            if (!(scene->cell[c].flags & CELL_SEED))
                continue;
            CHECK_INT(tree_voxels(session->forest, c, SIZE_MAX - 1), all);
            CHECK_INT(tree_voxels(session->forest, c, all), all);
            CHECK_INT(tree_voxels(session->forest, c, all - 1), all);
            if (all > 3)
                CHECK_INT(tree_voxels(session->forest, c, 2), 3);
        }
    }
}

/* ---- markers ---- */

/* The marker that `remove` would take from a voxel; 0 for none. */
static uint32_t marker_of(const struct session *session, uint32_t cell)
{
    OWNED(mem_release) uint32_t *number = NULL;
    size_t numbers;
    const enum err err = session_find_markers(session, &cell, 1, &number, &numbers, NULL);
    const uint32_t found = err == OK ? *number : 0;
    return found;
}

/* By a look at every voxel. */
static void is_as_counted(const struct session *session, const struct held *held)
{
    const struct scene *scene = session->scene;
    size_t trees = 0, waits = 0, voxels = 0;
    for (uint32_t c = 0; c < scene->grid.cells; c++) {
        const struct cell *cell = scene->cell + c;
        if (cell->flags & CELL_RIM)
            continue;
        const bool decides = markers_at(&session->markers, c) == held->marker;
        trees += decides && cell->flags & CELL_SEED;
        waits += decides && !(cell->flags & CELL_SEED);
        const bool in_tree = cell_is_reached(cell) &&
                             markers_at(&session->markers, key_root(cell->key)) == held->marker;
        voxels += in_tree;
        CHECK(session_is_held(session, held, c) == (in_tree || decides));
    }
    CHECK(!held->has_more);
    CHECK_INT(held->trees, trees);
    CHECK_INT(held->waits, waits);
    CHECK_INT(held->voxels, voxels);
}

static void ask(struct interpreter *interp)
{
    const struct session *session = interp->session;
    const uint32_t cell =
        grid_cell(&session->scene->grid, below(size[0]), below(size[1]), below(size[2]));
    const uint32_t marker = marker_of(session, cell);
    const struct place p = grid_place(&session->scene->grid, cell);
    struct held held;
    char line[64], answer[64];
    const enum err err = session_find_held(&held, session, cell, false, &fault);
    CHECK(err == (marker ? OK : ERR_INPUT));
    if (err)
        return;
    CHECK_INT(held.marker, marker);
    is_as_counted(session, &held);
    snprintf(line, sizeof line, "remove %u,%u,%u", p.x, p.y, p.z);
    snprintf(answer, sizeof answer, "marker %u removed", marker);
    MUST_MENTION(interp, line, answer);
}

STORY(what_is_held_is_what_is_removed_then)
{
    for (unsigned round = 0; round < 60; round++) {
        OWNED(interpreter_release) struct interpreter interp;
        begin(&interp, 2 + below(6));
        for (unsigned i = 0; i < 6; i++) {
            if (below(3))
                must(&interp, "run");
            ask(&interp);
            plant_somewhere(&interp);
        }
    }
}

SCENE_STORY(a_single_tree_is_held_by_itself)
{
    struct held held;
    const struct session *session = interp->session;
    const uint32_t cell = grid_cell(&session->scene->grid, 3, 3, 3);
    CHECK(session_find_held(&held, session, cell, true, &fault) == ERR_INPUT);
    must(interp, "seed 3,3,3 2 radius=1");
    CHECK(session_find_held(&held, session, cell, true, &fault) == OK);
    CHECK(held.marker == 0 && held.seed == cell && held.waits == 1 && held.trees == 0);
    must(interp, "run");
    CHECK(session_find_held(&held, session, cell, true, &fault) == OK);
    CHECK(held.marker == 0 && held.waits == 0 && held.trees == 1 && held.label == 2);
    CHECK(session_is_held(session, &held, cell) && !session_is_held(session, &held, cell + 1));
    CHECK(session_find_held(&held, session, cell, false, &fault) == OK);
    CHECK_INT(held.trees, 7);
    CHECK_INT(held.voxels, session->scene->grid.voxels);
    CHECK(session_is_held(session, &held, cell + 1));
}

SCENE_STORY(an_outline_holds_what_its_label_has_and_goes_by_its_ring_too)
{
    struct held held;
    const struct session *session = interp->session;
    const struct grid *grid = &session->scene->grid;
    must(interp, "outline 4,4,5 2 to=6,4,5 to=6,6,5 to=4,6,5 ring=1; run");
    CHECK(session_find_held(&held, session, grid_cell(grid, 3, 5, 5), false, &fault) == OK);
    CHECK(held.marker == 1 && held.label == 2 && held.trees == 9 && !held.has_more);
    uint64_t voxels = 0;
    for (uint32_t cell = 0; cell < grid->cells; cell++)
        voxels += session->scene->cell[cell].label == 2;
    CHECK_INT(held.voxels, voxels);
}
