/* SPDX-License-Identifier: MIT */
/* The forest: small scenes worked by hand, then random edits against runs from scratch.
 * tests/test_within.c has random edits with arcs of every kind and regions of interest. */
#include "tests/check_main.h"

#include "engine/weight.h"
#include "tests/plain_forest.h"
#include "tests/scarce_memory.h"

/* Undoes the last successful edit by an edit of its own. */
static enum err revert(struct forest *forest, struct fault *fault)
{
    const struct seed_changes seeds = forest_seed_changes(forest);
    return forest_edit(forest, seeds.before, seeds.count, fault);
}

static struct cell *voxel(struct world *w, uint32_t x, uint32_t y, uint32_t z)
{
    return w->scene->cell + grid_cell(&w->scene->grid, x, y, z);
}

static void plant_at(struct world *w, uint32_t x, uint32_t y, uint32_t z, int label)
{
    world_plant(w, grid_cell(&w->scene->grid, x, y, z), label);
}

static void set_row_weights(struct world *w, const char *digits)
{
    for (uint32_t x = 0; digits[x]; x++)
        voxel(w, x, 0, 0)->weight = (uint16_t)(digits[x] - '0');
}

static const char *row_labels(struct world *w)
{
    static char text[128];
    uint32_t n = w->scene->grid.size[0];
    for (uint32_t x = 0; x < n; x++)
        text[x] = (char)('0' + voxel(w, x, 0, 0)->label);
    text[n] = '\0';
    return text;
}

STORY(two_seeds_meet_at_the_ridge)
{
    OWNED(world_free) struct world w = world_new(9, 1, 1, 6);
    set_row_weights(&w, "110130111");
    plant_at(&w, 0, 0, 0, 1);
    plant_at(&w, 8, 0, 0, 2);
    /* The ridge of weight 3 at x = 4 costs 3 from either side, and is entered in no hops from
     * either: the smaller root decides. Beyond it the right seed is cheaper. */
    CHECK_TEXT(row_labels(&w), "111112222");
    CHECK_INT(key_cost(voxel(&w, 4, 0, 0)->key), 3);
}

STORY(on_a_plateau_hops_decide_and_then_the_smaller_root)
{
    OWNED(world_free) struct world w = world_new(7, 1, 1, 6);
    plant_at(&w, 6, 0, 0, 2);
    plant_at(&w, 0, 0, 0, 1);
    CHECK_TEXT(row_labels(&w), "1111222");
}

STORY(erasing_a_seed_gives_its_tree_to_the_neighbours)
{
    OWNED(world_free) struct world w = world_new(7, 1, 1, 6);
    plant_at(&w, 0, 0, 0, 1);
    uint64_t before = forest_digest(w.forest);
    plant_at(&w, 6, 0, 0, 2);
    plant_at(&w, 6, 0, 0, EDIT_ERASE);
    CHECK_TEXT(row_labels(&w), "1111111");
    CHECK(forest_digest(w.forest) == before);
    plant_at(&w, 0, 0, 0, EDIT_ERASE);
    CHECK_TEXT(row_labels(&w), "0000000");
    CHECK(forest_digest(w.forest) == 0 && forest_seeds(w.forest) == 0);
}

STORY(the_last_edit_of_a_voxel_in_a_batch_wins)
{
    OWNED(world_free) struct world w = world_new(3, 1, 1, 6);
    uint32_t at = grid_cell(&w.scene->grid, 1, 0, 0);
    struct edit batch[] = {{at, 4, 0}, {at, EDIT_ERASE, 0}, {at, 5, 0}};
    CHECK(forest_edit(w.forest, batch, 3, NULL) == OK);
    CHECK_TEXT(row_labels(&w), "555");
    CHECK(revert(w.forest, NULL) == OK);
    CHECK_TEXT(row_labels(&w), "000");
}

/* ---- arcs and regions of interest, by hand ---- */

static void set_row_intensities(struct world *w, const uint16_t *intensity)
{
    for (uint32_t x = 0; x < w->scene->grid.size[0]; x++)
        voxel(w, x, 0, 0)->intensity = intensity[x];
}

static void set_arcs(struct world *w, enum arc_kind kind, int of_1, int of_2)
{
    struct arc_rule rule = {.kind = kind};
    rule.polarity[1] = (int8_t)of_1;
    rule.polarity[2] = (int8_t)of_2;
    forest_set_arcs(w->forest, &rule);
    CHECK(forest_rebuild(w->forest, NULL) == OK && forest_check(w->forest, NULL));
}

static void row_costs_are(struct world *w, const uint32_t *expected)
{
    for (uint32_t x = 0; x < w->scene->grid.size[0]; x++)
        CHECK_INT(key_cost(voxel(w, x, 0, 0)->key), expected[x]);
}

STORY(a_difference_is_the_same_both_ways)
{
    OWNED(world_free) struct world w = world_new(6, 1, 1, 6);
    set_row_intensities(&w, (const uint16_t[]){10, 12, 50, 50, 20, 65535});
    plant_at(&w, 0, 0, 0, 1);
    set_arcs(&w, ARC_DIFFERENCE, 0, 0);
    row_costs_are(&w, (const uint32_t[]){0, 2, 38, 38, 38, 65515});
    plant_at(&w, 5, 0, 0, 2);
    CHECK_TEXT(row_labels(&w), "111112"); /* 20 costs 65515 from the right */
    plant_at(&w, 0, 0, 0, EDIT_ERASE);
    row_costs_are(&w, (const uint32_t[]){65515, 65515, 65515, 65515, 65515, 0});
}

STORY(polarity_makes_one_way_over_an_edge_dearer)
{
    OWNED(world_free) struct world w = world_new(6, 1, 1, 6);
    set_row_intensities(&w, (const uint16_t[]){100, 100, 55, 55, 100, 60000});
    plant_at(&w, 0, 0, 0, 1);
    set_arcs(&w, ARC_POLARITY, 0, 0);
    row_costs_are(&w, (const uint32_t[]){0, 0, 45, 45, 45, 59900});
    set_arcs(&w, ARC_POLARITY, 50, 0); /* down 45 * 1.5 = 67.5, up 45 * 0.5 = 22.5 */
    row_costs_are(&w, (const uint32_t[]){0, 0, 67, 67, 67, 29950});
    set_arcs(&w, ARC_POLARITY, -50, 0);
    row_costs_are(&w, (const uint32_t[]){0, 0, 22, 22, 67, 65535}); /* 89850 does not fit */
    set_arcs(&w, ARC_POLARITY, 100, 0);
    row_costs_are(&w, (const uint32_t[]){0, 0, 90, 90, 90, 90});
    set_arcs(&w, ARC_POLARITY, -100, 0);
    row_costs_are(&w, (const uint32_t[]){0, 0, 0, 0, 90, 65535});
}

STORY(polarity_goes_by_the_label_of_the_root)
{
    OWNED(world_free) struct world w = world_new(5, 1, 1, 6);
    set_row_intensities(&w, (const uint16_t[]){90, 90, 50, 10, 10});
    plant_at(&w, 0, 0, 0, 1);
    plant_at(&w, 4, 0, 0, 2);
    set_arcs(&w, ARC_POLARITY, 0, 0); /* 40 from both sides, in no hops: the smaller root */
    CHECK_TEXT(row_labels(&w), "11122");
    set_arcs(&w, ARC_POLARITY, 10, 0); /* 44 from the bright side */
    CHECK_TEXT(row_labels(&w), "11222");
    set_arcs(&w, ARC_POLARITY, 10, -11); /* 44 from both, the second time by rounding down */
    CHECK_TEXT(row_labels(&w), "11122");
    plant_at(&w, 4, 0, 0, 3); /* whose polarity is 0 */
    CHECK_TEXT(row_labels(&w), "11333");
    CHECK(forest_check(w.forest, NULL));
}

/* Puts a region of interest up where the forest has its seeds inside. */
static void put_up(struct world *w, const struct roi *roi)
{
    CHECK_INT(roi_tally(roi, w->scene).seeds_outside, 0);
    roi_apply(roi, w->scene);
    CHECK(forest_rebuild(w->forest, NULL) == OK && forest_check(w->forest, NULL));
}

STORY(no_tree_passes_a_roi)
{
    OWNED(world_free) struct world w = world_new(7, 1, 1, 6);
    struct roi range = {NULL, 5, 9, 0}, none = roi_none(), mask = {NULL, 0, 9, 0};
    set_row_intensities(&w, (const uint16_t[]){5, 9, 7, 4, 10, 5, 5});
    CHECK_INT(roi_tally(&range, w.scene).inside, 5);
    CHECK(roi_tally(&range, w.scene).digest != 0 && roi_tally(&none, w.scene).digest == 0);
    put_up(&w, &range); /* before there is a seed */
    plant_at(&w, 1, 0, 0, 1);
    CHECK_TEXT(row_labels(&w), "1110000");
    CHECK(!cell_is_reached(voxel(&w, 4, 0, 0)) && !cell_is_reached(voxel(&w, 5, 0, 0)));
    const uint64_t before = forest_digest(w.forest);
    put_up(&w, &none);
    CHECK_TEXT(row_labels(&w), "1111111");
    OWNED(mem_release) uint64_t *bits = mem_new(mask_bytes(&w.scene->grid));
    mask.mask = bits;
    for (uint32_t x = 0; bits && x < 5; x++) {
        const uint32_t c = grid_cell(&w.scene->grid, x, 0, 0);
        bits[c >> 6] |= UINT64_C(1) << (c & 63);
    }
    put_up(&w, &mask); /* the mask ends before 5, the range before 4 */
    CHECK_TEXT(row_labels(&w), "1111000");
    put_up(&w, &range);
    CHECK(forest_digest(w.forest) == before);
    plant_at(&w, 1, 0, 0, EDIT_ERASE);
    put_up(&w, &none);
    CHECK_TEXT(row_labels(&w), "0000000");
    CHECK(voxel(&w, 3, 0, 0)->key == KEY_NONE && voxel(&w, 3, 0, 0)->flags == 0);
    CHECK_INT(roi_tally(&mask, w.scene).seeds_outside, 0);
    plant_at(&w, 4, 0, 0, 1);
    CHECK_INT(roi_tally(&mask, w.scene).seeds_outside, 1);
}

STORY(changes_name_each_voxel_that_got_another_label_once)
{
    OWNED(world_free) struct world w = world_new(64, 1, 1, 6);
    plant_at(&w, 0, 0, 0, 1);
    CHECK(forest_changes(w.forest).everything);
    CHECK_INT(forest_stats(w.forest).touched, 64);
    plant_at(&w, 63, 0, 0, 2);
    CHECK(forest_changes(w.forest).everything); /* 32 of 64 */
    CHECK_INT(forest_stats(w.forest).touched, 32);
    plant_at(&w, 31, 0, 0, 1);
    CHECK_INT(forest_stats(w.forest).touched, 32); /* 16..31 keep their label, 32..47 do not */
    plant_at(&w, 63, 0, 0, 4);
    plant_at(&w, 62, 0, 0, 3);
    plant_at(&w, 63, 0, 0, 5); /* only a tree of one voxel is left of it */
    struct changes changes = forest_changes(w.forest);
    CHECK(!changes.everything);
    CHECK_INT(changes.count, 1);
    CHECK_INT(changes.item[0].former_label, 4);
    CHECK_INT(changes.item[0].label, 5);
    CHECK(forest_check(w.forest, NULL));
}

STORY(a_plateau_longer_than_hops_can_count_is_refused_and_undone)
{
    struct fault fault = {0};
    struct world w = world_new(65534, 1, 1, 6);
    plant_at(&w, 0, 0, 0, 1); /* 65533 steps: it just fits */
    CHECK_INT(key_hops(voxel(&w, 65533, 0, 0)->key), 65533);
    CHECK(forest_check(w.forest, NULL));
    world_free(&w);

    /* A winding corridor of weight 1 between walls of weight 9: 3 x 40000 steps. */
    w = world_new(40000, 5, 1, 6);
    for (uint32_t x = 0; x < 40000; x++) {
        voxel(&w, x, 1, 0)->weight = x < 39999 ? 9 : 1;
        voxel(&w, x, 3, 0)->weight = x > 0 ? 9 : 1;
        for (uint32_t y = 0; y < 5; y += 2)
            voxel(&w, x, y, 0)->weight = 1;
    }
    plant_at(&w, 20000, 2, 0, 1); /* from the middle no way is longer than 60002 steps */
    uint64_t before = forest_digest(w.forest);
    CHECK(forest_check(w.forest, NULL));
    struct edit far[] = {{grid_cell(&w.scene->grid, 20000, 2, 0), EDIT_ERASE, 0},
                         {grid_cell(&w.scene->grid, 0, 0, 0), 2, 0}};
    CHECK_INT(forest_edit(w.forest, far, 2, &fault), ERR_LIMIT);
    CHECK_HAS(fault.text, "plateau");
    CHECK(forest_digest(w.forest) == before && forest_check(w.forest, NULL));
    CHECK_INT(voxel(&w, 0, 0, 0)->label, 1);
    world_free(&w);
}

/* ---- random edits ---- */

STORY(tens_of_thousands_of_random_edits_each_equal_a_run_from_scratch)
{
    for (unsigned i = 0; i < check_scaled(6000) && check_failures == 0; i++)
        random_session(i, i % 200 ? 5 : 40, false, NULL);
}

/* The same seeds planted at once into an empty forest. */
static bool equals_scratch(const struct world *w)
{
    return world_equals_scratch(w, NULL, NULL, 0);
}

/* ---- edits that do not go through ---- */

/* All that describes a forest: if these are unchanged and every invariant holds, so is the
 * forest. */
struct state {
    uint64_t keys, labels;
    size_t seeds;
};

static struct state state_of(const struct world *w)
{
    return (struct state){forest_digest(w->forest), forest_label_digest(w->forest),
                          forest_seeds(w->forest)};
}

static bool is_as_before(struct world *w, struct state before)
{
    struct state now = state_of(w);
    struct fault fault = {0};
    bool same =
        CHECK(now.keys == before.keys && now.labels == before.labels && now.seeds == before.seeds);
    return CHECK(forest_check(w->forest, &fault)) && same;
}

/* At most 14 voxels a side, less `smaller`. */
static struct world planted_world(uint64_t *random, unsigned seeds, unsigned smaller)
{
    const uint32_t most[3] = {14 - smaller, 12 - smaller, 10 - smaller};
    struct world w = random_world(random, most, false);
    for (unsigned i = 0; i < seeds; i++)
        world_plant(&w, random_voxel(&w.scene->grid, random), (int)(i % 3));
    return w;
}

static bool stop_and_starve(void *context, const char *what, uint64_t done, uint64_t total)
{
    allow_allocations(0);
    return stop_after_looks(context, what, done, total);
}

/* Most of a scene of more than 200 000 voxels is removed, so the forest is rebuilt. At last memory
 * runs out while that is undone. */
STORY(a_large_tree_that_falls_is_as_if_it_had_never_been)
{
    struct fault fault = {0};
    uint64_t random = 3;
    OWNED(world_free) struct world w = world_new(64, 60, 56, 6);
    paint(&w, NOISY, 65536, &random);
    plant_at(&w, 30, 30, 30, 1);
    plant_at(&w, 2, 2, 2, 2);
    const struct state before = state_of(&w);
    const struct edit edit[] = {{grid_cell(&w.scene->grid, 30, 30, 30), EDIT_ERASE, 0},
                                {grid_cell(&w.scene->grid, 50, 8, 9), 3, 0}};
    enum err err = ERR_CANCELLED;
    unsigned looks = 0;
    for (; err && check_failures == 0; looks += 1 + looks / 6) {
        int left = (int)looks;
        struct watch watch = {.context = &left, .poll = stop_after_looks, .step = 1 << 13};
        w.scene->watch = &watch;
        err = forest_edit(w.forest, edit, 2, &fault);
        w.scene->watch = NULL;
        if (err)
            is_as_before(&w, before);
    }
    CHECK(looks > 5 && forest_changes(w.forest).everything);
    CHECK_INT(forest_stats(w.forest).cleared, 0);
    CHECK(forest_check(w.forest, NULL) && equals_scratch(&w) && revert(w.forest, NULL) == OK);
    is_as_before(&w, before);
    int none = 0;
    w.scene->watch = &(struct watch){.context = &none, .poll = stop_and_starve};
    CHECK_INT(forest_edit(w.forest, edit, 2, &fault), ERR_MEMORY);
    mem_allows = NULL;
    w.scene->watch = NULL;
    CHECK_HAS(fault.text, "the seeds are as before");
    CHECK(forest_is_suspended(w.forest) && forest_catch_up(w.forest, NULL) == OK);
    is_as_before(&w, before);
}

/* Half of an even scene loses its tree, or a third: the latter is more than the number at which
 * the loss is estimated, and is repaired all the same. */
STORY(a_large_tree_is_repaired_or_rebuilt_by_its_share)
{
    for (int round = 0; round < 4; round++) {
        const bool is_third = round % 2, is_replaced = round / 2;
        uint64_t random = 3;
        OWNED(world_free) struct world w = world_new(64, 60, 56, 6);
        paint(&w, FLAT, 65536, &random);
        plant_at(&w, 8, 30, 28, 1);
        plant_at(&w, is_third ? 35 : 55, 30, 28, 2);
        const struct edit edit = {grid_cell(&w.scene->grid, 8, 30, 28),
                                  is_replaced ? 3 : EDIT_ERASE, 0};
        CHECK_INT(forest_edit(w.forest, &edit, 1, NULL), OK);
        CHECK_INT(forest_stats(w.forest).cleared > 0, is_third);
        CHECK(forest_check(w.forest, NULL) && equals_scratch(&w));
    }
}

/* After every level, and in every third round within each loop too, at more and more voxels. Most
 * scenes are small: an edit is stopped at each of its levels. */
STORY(an_edit_cancelled_anywhere_leaves_the_forest_as_it_was)
{
    struct fault fault = {0};
    uint64_t random = 5;
    for (unsigned round = 0; round < check_scaled(150) && check_failures == 0; round++) {
        OWNED(world_free) struct world w = planted_world(&random, 6, round % 10 ? 6 : 0);
        struct edit *batch = malloc((w.scene->grid.voxels + 4) * sizeof *batch);
        size_t count = random_batch(&w, batch, &random);
        const struct state before = state_of(&w);
        enum err err = ERR_CANCELLED;
        const bool within = round % 3 == 0;
        for (int looks = 0; err && check_failures == 0; looks += within ? 1 + looks / 8 : 1) {
            int left = looks;
            struct watch watch = {.context = &left, .poll = stop_after_looks, .step = within};
            w.scene->watch = &watch;
            err = forest_edit(w.forest, batch, count, &fault);
            w.scene->watch = NULL;
            if (err) {
                CHECK_INT(err, ERR_CANCELLED);
                CHECK_HAS(fault.text, "nothing has changed");
                is_as_before(&w, before);
            }
        }
        CHECK(equals_scratch(&w) && revert(w.forest, NULL) == OK);
        is_as_before(&w, before);
        free(batch);
    }
}

/* Everything that allocates, once; true when it went through. */
static bool live_once(uint64_t seed)
{
    uint64_t random = seed;
    OWNED(world_free) struct world w = {0};
    OWNED(border_release) struct border border = {0};
    struct fault fault = {0};
    uint32_t size[3] = {1 + check_below(&random, 9), 7, 5};
    struct edit batch[40];
    bool done = false;
    if (scene_new(&w.scene, size, NULL, NULL, &fault) ||
        forest_new(&w.forest, w.scene, 6, &fault) || border_init(&border, w.scene, &fault))
        goto end;
    for (int step = 0; step < 6; step++) {
        const struct state before = state_of(&w);
        for (int i = 0; i < 40; i++)
            batch[i] =
                (struct edit){random_voxel(&w.scene->grid, &random), (int16_t)(i % 4 - 1), 0};
        if (forest_edit(w.forest, batch, 40, &fault)) {
            CHECK_INT(fault.code, ERR_MEMORY);
            is_as_before(&w, before);
            goto end;
        }
    }
    done = true;
end:
    if (!done)
        CHECK_HAS(fault.text, "out of memory");
    return done;
}

STORY(an_allocation_that_fails_leaves_the_forest_as_it_was)
{
    for (uint64_t seed = 0; seed < check_scaled(40) && check_failures == 0; seed++) {
        bool done = false;
        for (size_t n = 0; !done && n < 1000 && check_failures == 0; n++) {
            fail_allocation(n);
            done = live_once(seed);
        }
        mem_allows = NULL;
        CHECK(done);
    }
}

STORY(both_adjacencies_hold_each_direction_and_its_opposite)
{
    for (unsigned count = 6; count <= 26; count += 20) {
        OWNED(world_free) struct world w = world_new(4, 4, 4, count);
        const struct adjacency *a = forest_adjacency(w.forest);
        CHECK_INT(a->count, count);
        for (unsigned i = 0; i < count; i++)
            CHECK_INT(a->offset[i], -a->offset[count - 1 - i]);
    }
}

STORY(the_synthetic_scene_is_the_same_everywhere)
{
    struct scene *scene;
    CHECK(scene_new_geom(&scene, 0, NULL, NULL) == OK);
    CHECK_INT(scene->grid.voxels, 4000000);
    struct adjacency six;
    adjacency_init(&six, 6, &scene->grid);
    weight_compute(scene, &six, &(const struct weight_choice){WEIGHT_MORPH, 1},
                   &(struct weight_work){0});
    printf("# geom %016" PRIx64 " morph %016" PRIx64 "\n", scene_digest(scene),
           weight_digest(scene, &(struct arc_rule){0}, NULL));
    scene_free(scene);
    CHECK(scene_new_geom(&scene, 7, NULL, NULL) == OK);
    CHECK_INT(scene->grid.voxels, 31680999);
    scene_free(scene);
}
