/* SPDX-License-Identifier: MIT */
/* Hints: worked by hand, compared with a plain search of all pairs, and as commands. */
#include "engine/hints.h"
#include "engine/margin.h"
#include "engine/way.h"
#include "tests/scarce_memory.h"
#include "tests/scene_main.h"
#include "tests/world.h"

static struct world w;
static uint16_t *margin;
static uint8_t heat[4096];
static struct hint_list hints;

static void end_world(void)
{
    hints_release(&hints);
    free(margin);
    margin = NULL;
    world_free(&w);
}
#define WORLD_STORY(told) STORY_WITHIN(told, (void)0, end_world())

static void find(void)
{
    memset(heat, 0, sizeof heat);
    CHECK(margin_new(&margin, w.forest, NULL) == OK);
    CHECK(hints_find(&hints, w.forest, margin, heat, NULL) == OK);
}

/* ---- by hand ---- */

WORLD_STORY(a_border_without_an_edge_is_less_certain_than_one_on_an_edge)
{
    /* Three labels in a row: an edge of 9 between 1 and 2, none between 2 and 3. */
    w = world_new(16, 1, 1, 6);
    const uint32_t first = grid_cell(&w.scene->grid, 0, 0, 0);
    for (uint32_t x = 0; x < 16; x++)
        w.scene->cell[first + x].weight = x == 3 ? 9 : 1;
    world_plant(&w, first, 1);
    world_plant(&w, first + 5, 2);
    world_plant(&w, first + 15, 3);
    find();
    CHECK_INT(hints.border, 4);
    CHECK_INT(hints.count, 1);
    CHECK_INT(hints.item[0].voxels, 2);
    CHECK_INT(hints.item[0].certainty, 0);
    CHECK_INT(hints.item[0].edge, 1);
    CHECK(hints.item[0].label + hints.item[0].other == 5);
    CHECK_INT(heat[hints.item[0].cell], HINT_HEATS);
    CHECK(heat[first + 3] == 0 && heat[first] == 0);
}

WORLD_STORY(where_no_labels_meet_there_are_none)
{
    w = world_new(5, 4, 3, 26);
    find();
    CHECK_INT(hints.count, 0);
    free(margin);
    world_plant(&w, grid_cell(&w.scene->grid, 1, 1, 1), 1);
    find();
    CHECK(hints.count == 0 && hints.border == 0 && hints.weak == 0);
}

WORLD_STORY(a_way_leads_back_to_the_seed)
{
    static const uint16_t weight[] = {1, 1, 4, 2, 4, 7, 2, 2};
    OWNED(way_release) struct way way = {0};
    w = world_new(8, 1, 1, 6);
    const uint32_t first = grid_cell(&w.scene->grid, 0, 0, 0);
    for (uint32_t x = 0; x < 8; x++)
        w.scene->cell[first + x].weight = weight[x];
    world_plant(&w, first, 1);
    CHECK(way_find(&way, w.forest, first + 4, NULL) == OK);
    CHECK(way.count == 5 && way.cell[0] == first + 4 && way.cell[4] == first);
    CHECK_INT(way.edge, first + 2); /* the other 4 costs no more */
    CHECK(way_find(&way, w.forest, first + 7, NULL) == OK);
    CHECK_INT(way.edge, first + 5);
    CHECK(way_find(&way, w.forest, first, NULL) == OK && way.count == 1 && way.edge == CELL_NONE);
}

/* ---- the model ---- */

enum { CELLS_MOST = 4096 };

struct model_voxel {
    uint32_t cell;
    int64_t certainty;
    unsigned label, other;
    uint32_t place; /* the lowest cell of its component */
};

static uint32_t cost_of(uint32_t cell)
{
    return key_cost(w.scene->cell[cell].key);
}

static uint32_t step(uint32_t from, uint32_t to)
{
    return arc_weight_now(forest_arcs(w.forest), w.scene->cell + from, w.scene->cell + to);
}

static bool look(struct model_voxel *v, uint32_t at)
{
    struct adjacency faces;
    uint32_t least = UINT32_MAX, beside = 0, back = at;
    adjacency_init(&faces, 6, &w.scene->grid);
    for (unsigned i = 0; i < 6 && cell_is_reached(w.scene->cell + at); i++) {
        const uint32_t from = at + (uint32_t)faces.offset[i];
        if (!cell_is_reached(w.scene->cell + from) ||
            w.scene->cell[from].label == w.scene->cell[at].label)
            continue;
        const uint32_t offer = step(from, at) > cost_of(from) ? step(from, at) : cost_of(from);
        beside = offer < least ? from : beside;
        least = offer < least ? offer : least;
    }
    if (least == UINT32_MAX || margin[at] == MARGIN_NONE)
        return false;
    for (int i = 0; i < HINT_BACK && forest_predecessor(w.forest, back) != CELL_NONE; i++)
        back = forest_predecessor(w.forest, back);
    const uint32_t to = step(beside, at), from = step(at, beside);
    *v = (struct model_voxel){at, (int64_t)margin[at] + (to > from ? to : from) - cost_of(back),
                              w.scene->cell[at].label, w.scene->cell[beside].label, at};
    return true;
}

static bool hangs_together(const struct model_voxel *a, const struct model_voxel *b)
{
    const struct place p = grid_place(&w.scene->grid, a->cell),
                       q = grid_place(&w.scene->grid, b->cell);
    const int64_t x = (int64_t)p.x - q.x, y = (int64_t)p.y - q.y, z = (int64_t)p.z - q.z;
    return x * x <= 1 && y * y <= 1 && z * z <= 1 && p.x / HINT_BLOCK == q.x / HINT_BLOCK &&
           p.y / HINT_BLOCK == q.y / HINT_BLOCK && p.z / HINT_BLOCK == q.z / HINT_BLOCK &&
           (a->label < a->other ? a->label * 256 + a->other : a->other * 256 + a->label) ==
               (b->label < b->other ? b->label * 256 + b->other : b->other * 256 + b->label);
}

/* Return the least certainty not exceeded by at least a tenth of the voxels. */
static int64_t limit_of(const struct model_voxel *v, size_t count)
{
    for (int64_t limit = -65535;; limit++) {
        size_t below = 0;
        for (size_t i = 0; i < count; i++)
            below += v[i].certainty <= limit;
        if (below * HINT_SHARE >= count)
            return limit;
    }
}

static void check_place(const struct model_voxel *v, size_t count, const struct hint *hint,
                        int64_t limit)
{
    uint64_t doubt = 0;
    size_t voxels = 0, own = count;
    for (size_t i = 0; i < count; i++)
        own = v[i].cell == hint->cell ? i : own;
    if (!CHECK(own < count))
        return;
    for (size_t i = 0; i < count; i++) {
        if (v[i].place != v[own].place)
            continue;
        voxels++;
        doubt += (uint64_t)(limit + 1 - v[i].certainty);
        CHECK(v[i].certainty >= v[own].certainty);
    }
    CHECK(hint->voxels == voxels && hint->doubt == doubt && hint->certainty == v[own].certainty);
    CHECK(hint->label == v[own].label && hint->other == v[own].other);
}

static void check_against_model(void)
{
    static struct model_voxel v[CELLS_MOST];
    size_t count = 0, weak = 0, places = 0;
    find();
    for (uint32_t c = 0; c < w.scene->grid.cells; c++)
        count += look(v + count, c);
    CHECK_INT(hints.border, count);
    const int64_t limit = count ? limit_of(v, count) : 0;
    CHECK_INT(hints.limit, limit);
    for (size_t i = 0; i < count; i++)
        if (v[i].certainty <= limit)
            v[weak++] = v[i];
    CHECK_INT(hints.weak, weak);
    for (size_t i = 0; i < weak; i++)
        CHECK_INT(heat[v[i].cell], HINT_HEATS);
    for (bool changed = true; changed;) {
        changed = false;
        for (size_t i = 0; i < weak; i++)
            for (size_t j = 0; j < weak; j++)
                if (v[j].place < v[i].place && hangs_together(v + i, v + j)) {
                    v[i].place = v[j].place;
                    changed = true;
                }
    }
    for (size_t i = 0; i < weak; i++)
        places += v[i].place == v[i].cell;
    CHECK_INT(hints.count, places < HINTS_MOST ? places : HINTS_MOST);
    for (size_t i = 0; i < hints.count; i++) {
        check_place(v, weak, hints.item + i, limit);
        CHECK(i == 0 || hints.item[i - 1].doubt > hints.item[i].doubt ||
              (hints.item[i - 1].doubt == hints.item[i].doubt &&
               hints.item[i - 1].cell < hints.item[i].cell));
    }
    free(margin);
    margin = NULL;
}

DRAW_FROM(1)

STORY(hints_are_those_of_a_plain_search)
{
    for (int round = 0; round < 60; round++) {
        const uint32_t sides[3] = {2 + below(20), 1 + below(9), 1 + below(7)};
        const unsigned weights = 2 + below(20), labels = 2 + below(3);
        w = world_new(sides[0], sides[1], sides[2], round % 2 ? 26 : 6);
        for (uint32_t z = 0; z < sides[2]; z++)
            for (uint32_t y = 0; y < sides[1]; y++)
                for (uint32_t x = 0; x < sides[0]; x++)
                    w.scene->cell[grid_cell(&w.scene->grid, x, y, z)].weight =
                        (uint16_t)below(weights);
        for (int seeds = 0; seeds < 5; seeds++) {
            world_plant(
                &w, grid_cell(&w.scene->grid, below(sides[0]), below(sides[1]), below(sides[2])),
                (int16_t)below(labels));
            check_against_model();
        }
        end_world();
    }
}

WORLD_STORY(memory_that_runs_out_is_an_error)
{
    struct fault why = {0};
    w = world_new(6, 5, 4, 6);
    world_plant(&w, grid_cell(&w.scene->grid, 1, 1, 1), 3);
    world_plant(&w, grid_cell(&w.scene->grid, 4, 3, 2), 4);
    CHECK(margin_new(&margin, w.forest, NULL) == OK);
    enum err err = ERR_MEMORY;
    for (size_t n = 0; n < 40 && err; n++) {
        allow_allocations(n);
        err = hints_find(&hints, w.forest, margin, NULL, &why);
        mem_allows = NULL;
        CHECK(err == OK || (err == ERR_MEMORY && hints.count == 0));
    }
    CHECK_INT(err, OK);
    CHECK(hints.count > 0);
}

/* ---- commands ---- */

static void begin(struct interpreter *interp)
{
    begin_with_scene(interp);
    must(interp, "auto on");
}

BEGUN_STORY(a_hint_is_recorded_as_the_cross_that_it_comes_to, begin)
{
    uint32_t at[3];
    MUST_ANSWER(interp, "hints", "no labels meet: there is no border to be uncertain of\n");
    is_refused(interp, "hint 1", "no labels meet");
    must(interp, "seed 1,1,1 1; seed 10,9,8 2; hints 2");
    CHECK_TEXT(buf_text(&reply.words), "");
    CHECK_HAS(buf_text(&reply.text), "1  at ");
    CHECK_HAS(buf_text(&reply.text), " an edge of ");
    CHECK(sscanf(buf_text(&reply.text), "1  at %u,%u,%u", &at[0], &at[1], &at[2]) == 3);
    must(interp, "hint 1");
    CHECK(memcmp(interp->session->now.outlook.slices.cross, at, sizeof at) == 0);
    char cross[64];
    snprintf(cross, sizeof cross, "cross %u,%u,%u", at[0], at[1], at[2]);
    CHECK_TEXT(buf_text(&reply.canonical), cross);
    is_refused(interp, "hint 999", "expected one of the ");
    MUST_ANSWER(interp, "hints label=3", "none at the border of that label\n");
    must(interp, "undo"); /* undoes the seeds: hints follow */
    is_refused(interp, "hint 1", "no labels meet");
    must(interp, "redo; hint 1");
    CHECK_TEXT(buf_text(&reply.canonical), cross);
    must(interp, "weight polarity");
    is_refused(interp, "hint 1", "under `weight polarity`");
}

BEGUN_STORY(a_report_has_all_of_them, begin)
{
    OWNED(buf_release) struct buf text = {0};
    must(interp, "seed 1,1,1 1; seed 10,9,8 2");
    is_refused(interp, "hints report=h.csv", "expected a name that ends in .json");
    MUST_MENTION(interp, "hints 1 report=h.json", "wrote ");
    CHECK(file_read(&text, "h.json", 1 << 20, NULL) == OK);
    CHECK_HAS(buf_text(&text), "{\"number\": 1, \"place\": \"");
    CHECK_HAS(buf_text(&text), "\"volume_mm3\": ");
    CHECK_HAS(buf_text(&text), "\"certainty_most\": ");
}
