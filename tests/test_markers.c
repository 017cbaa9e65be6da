/* SPDX-License-Identifier: MIT */
/* Markers compared with a plain model, which carries out in order the commands of all active
 * markers. Each writes its label over the existing ones. A marker that yields does not write where
 * a later active marker of another label, with a voxel in its component, needs the voxel to be
 * free; it does write where its component continues next to such a voxel, inside the region of
 * interest of that moment. */
#include "session/markers.h"
#include "tests/check_main.h"
#include "tests/scarce_memory.h"

enum { VOXELS = 40, MARKERS_MOST = 40 };

/* What the model knows of a marker: all voxels that it covers. */
struct plain {
    bool covers[VOXELS], piece[VOXELS], wants[VOXELS], outside[VOXELS], is_valid, yields, is_exact;
    int16_t label;
};

static struct cell cells[1000 + (VOXELS + 1) * 7];

static uint32_t cell_of(uint32_t voxel)
{
    return 1000 + voxel * 7;
}

static bool gives_way(const struct plain *one, const struct plain *later)
{
    bool meet = false;
    for (size_t i = 0; i < VOXELS; i++)
        meet |= one->piece[i] && later->covers[i];
    return one->yields && later->is_valid && (later->is_exact || one->label != later->label) &&
           meet;
}

/* Whether the component continues in v, next to a voxel that the later marker needs. */
static bool goes_on(const struct plain *one, const struct plain *later, size_t v)
{
    const bool before = v > 0 && one->piece[v - 1] && later->wants[v - 1],
               after = v + 1 < VOXELS && one->piece[v + 1] && later->wants[v + 1];
    return one->piece[v] && !later->wants[v] && !later->outside[v] && (before || after);
}

static bool writes(const struct plain *plain, size_t count, size_t i, size_t v)
{
    bool covers = plain[i].covers[v], is_free = false;
    for (size_t later = i + 1; later < count; later++)
        if (gives_way(plain + i, plain + later)) {
            covers |= goes_on(plain + i, plain + later, v);
            is_free |= plain[later].wants[v];
        }
    return plain[i].is_valid && covers && !is_free;
}

static void compare(const struct markers *markers, const struct plain *plain)
{
    int16_t seed[VOXELS];
    uint32_t number[VOXELS] = {0};
    for (size_t v = 0; v < VOXELS; v++)
        seed[v] = EDIT_ERASE;
    for (size_t i = 0; i < markers->count; i++)
        for (size_t v = 0; v < VOXELS; v++)
            if (writes(plain, markers->count, i, v)) {
                seed[v] = plain[i].label;
                number[v] = (uint32_t)i + 1;
            }
    for (uint32_t v = 0; v < VOXELS; v++) {
        CHECK_INT(markers_at(markers, cell_of(v)), number[v]);
        CHECK_INT(markers_seed(markers, cell_of(v)), seed[v]);
    }
}

static void add(struct markers *markers, struct plain *plain, uint64_t *random)
{
    uint32_t cell[VOXELS];
    size_t count = 0;
    const uint32_t from = check_below(random, VOXELS), share = check_below(random, 4);
    *plain = (struct plain){.label = (int16_t)((int)check_below(random, 4) + EDIT_ERASE)};
    for (uint32_t v = from; v < VOXELS && v < from + 12; v++)
        if (check_below(random, 4) >= share) {
            plain->covers[v] = true;
            cell[count++] = cell_of(v);
        }
    CHECK(markers_add(markers, plain->label, cell, count, NULL, NULL) == OK);
}

/* A component with some voxels that are seeds. Its runs are left out if all of it is covered. */
static void yield(struct markers *markers, struct plain *plain, uint64_t *random)
{
    struct marker_run run[VOXELS];
    size_t runs = 0;
    bool is_covered = true;
    plain->yields = true;
    for (uint32_t v = 0; v < VOXELS; v++) {
        plain->piece[v] = plain->covers[v] || check_below(random, 6) == 0;
        is_covered &= plain->piece[v] == plain->covers[v];
        if (plain->piece[v])
            run[runs++] = (struct marker_run){cell_of(v), cell_of(v) + 1 + check_below(random, 7)};
    }
    CHECK(markers_yield(markers, run, is_covered ? 0 : runs, NULL) == OK);
}

static void want_free(struct markers *markers, struct plain *plain, uint64_t *random)
{
    uint32_t cell[VOXELS];
    size_t count = 0;
    plain->is_exact = plain->label != EDIT_ERASE && check_below(random, 2);
    markers->marker[markers->count - 1].is_exact = plain->is_exact;
    for (uint32_t v = 0; v < VOXELS; v++) {
        plain->wants[v] = plain->is_exact ? plain->covers[v] : check_below(random, 2);
        if (plain->wants[v])
            cell[count++] = cell_of(v);
        plain->outside[v] = check_below(random, 4) == 0;
        cells[cell_of(v)].flags = plain->outside[v] ? CELL_OUTSIDE : 0;
    }
    const struct adjacency around = {.count = 2, .offset = {-7, 7}};
    CHECK(markers_free(markers, cells, &around, cell, count, NULL, NULL) == OK);
}

STORY(any_set_of_markers_is_what_carrying_them_out_in_order_gives)
{
    uint64_t random = 14;
    struct plain plain[MARKERS_MOST];
    for (int round = 0; round < 5000; round++) {
        OWNED(markers_release) struct markers markers = {0};
        for (int step = 0; step < 40; step++) {
            const uint32_t what = check_below(&random, 8), count = (uint32_t)markers.count;
            if (what < 3 || !count) {
                add(&markers, plain + count, &random);
                if (round % 2 && what == 0 && plain[count].label != EDIT_ERASE)
                    yield(&markers, plain + count, &random);
                else if (round % 2 && what == 1)
                    want_free(&markers, plain + count, &random);
            } else if (what == 3) {
                markers_drop(&markers, check_below(&random, count), NULL);
            } else {
                const size_t i = check_below(&random, count);
                plain[i].is_valid = markers.marker[i].is_valid = !plain[i].is_valid;
            }
        }
        compare(&markers, plain);
    }
}

STORY(an_exact_marker_frees_its_own_label_and_needs_no_covers_for_its_voxels)
{
    const struct adjacency around = {.count = 2, .offset = {-7, 7}};
    const struct marker_run run[] = {{cell_of(0), cell_of(9) + 1}};
    const uint32_t ends[] = {cell_of(0), cell_of(9)},
                   inner[] = {cell_of(3), cell_of(4), cell_of(5), cell_of(6)};
    OWNED(markers_release) struct markers markers = {0};
    memset(cells, 0, sizeof cells);
    CHECK(markers_add(&markers, 1, ends, 2, NULL, NULL) == OK);
    CHECK(markers_yield(&markers, run, 1, NULL) == OK);
    CHECK(markers_add(&markers, 1, inner, 4, NULL, NULL) == OK);
    markers.marker[0].is_valid = markers.marker[1].is_valid = true;
    CHECK(markers_free(&markers, cells, &around, inner, 4, NULL, NULL) == OK);
    CHECK_INT(markers.covers, 6); /* one that grows frees only other labels */
    markers.marker[1].is_exact = true;
    CHECK(markers_free(&markers, cells, &around, inner, 4, NULL, NULL) == OK);
    CHECK_INT(markers.covers, 8); /* 2 and 7 have seeds of the piece */
    CHECK_INT(markers_at(&markers, cell_of(2)), 1);
    CHECK_INT(markers_at(&markers, cell_of(5)), 2);
    CHECK_INT(markers_at(&markers, cell_of(7)), 1);
    CHECK_INT(markers_seed(&markers, cell_of(8)), EDIT_ERASE);
}

STORY(what_memory_cannot_hold_changes_nothing)
{
    OWNED(markers_release) struct markers markers = {0};
    uint32_t cell[300];
    for (uint32_t i = 0; i < 300; i++)
        cell[i] = i;
    CHECK(markers_add(&markers, 1, cell, 10, NULL, NULL) == OK);
    markers.marker[0].is_valid = true;
    allow_allocations(0);
    CHECK_INT(markers_add(&markers, 2, cell, 300, NULL, NULL), ERR_MEMORY);
    mem_allows = NULL;
    CHECK_INT(markers.count, 1);
    CHECK_INT(markers_at(&markers, 3), 1);
    CHECK_INT(markers_at(&markers, 10), 0);
    CHECK(markers_add(&markers, 2, cell, 300, NULL, NULL) == OK);
    CHECK_INT(markers_at(&markers, 3), 1);
    markers.marker[1].is_valid = true;
    CHECK_INT(markers_at(&markers, 3), 2);
}
