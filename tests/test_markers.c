/*
 * Markers against a plain model: carry out, in order, the commands whose markers are in the set,
 * each writing its label over what was there.
 */
#include <stdlib.h>

#include "base/mem.h"
#include "session/markers.h"
#include "tests/check.h"

enum { VOXELS = 40, MARKERS_MOST = 60 };

/* What the model knows of a marker: all it covers, and in which sets it is. */
struct plain {
    bool covers[VOXELS];
    int16_t label;
    bool stands, planted, planned;
};

static bool is_in(const struct plain *plain, enum marker_set set)
{
    return set == MARKERS_STANDING  ? plain->stands
           : set == MARKERS_PLANTED ? plain->planted
                                    : plain->planned;
}

static void replay(const struct plain *plain, size_t count, enum marker_set set,
                   int16_t seed[VOXELS], uint32_t number[VOXELS])
{
    for (size_t v = 0; v < VOXELS; v++) {
        seed[v] = EDIT_ERASE;
        number[v] = 0;
    }
    for (size_t i = 0; i < count; i++)
        for (size_t v = 0; v < VOXELS; v++)
            if (is_in(plain + i, set) && plain[i].covers[v]) {
                seed[v] = plain[i].label;
                number[v] = (uint32_t)i + 1;
            }
}

static void compare(const struct markers *markers, const struct plain *plain)
{
    int16_t seed[VOXELS], planned[VOXELS], forest[VOXELS];
    uint32_t number[VOXELS];
    struct edit *edit;
    size_t count;
    for (enum marker_set set = MARKERS_STANDING; set <= MARKERS_PLANNED; set++) {
        replay(plain, markers->count, set, seed, number);
        for (uint32_t v = 0; v < VOXELS; v++) {
            CHECK_INT(markers_at(markers, set, 1000 + v * 7), number[v]);
            CHECK_INT(markers_seed(markers, set, 1000 + v * 7), seed[v]);
        }
    }
    replay(plain, markers->count, MARKERS_PLANTED, forest, number);
    replay(plain, markers->count, MARKERS_PLANNED, planned, number);
    CHECK(markers_edits(markers, &edit, &count, NULL) == OK);
    for (size_t i = 0; i < count; i++) {
        int16_t *at = forest + (edit[i].cell - 1000) / 7;
        CHECK(*at != edit[i].label); /* each voxel once, and only where something changes */
        *at = edit[i].label;
    }
    CHECK(memcmp(forest, planned, sizeof forest) == 0);
    free(edit);
}

static void add(struct markers *markers, struct plain *plain, uint64_t *random)
{
    uint32_t cell[VOXELS];
    size_t count = 0;
    const uint32_t from = check_below(random, VOXELS), share = check_below(random, 4);
    *plain = (struct plain){.stands = true, .label = (int16_t)check_below(random, 4)};
    plain->label = plain->label == 3 ? EDIT_ERASE : plain->label;
    for (uint32_t v = from; v < VOXELS && v < from + 12; v++)
        if (check_below(random, 4) >= share) {
            plain->covers[v] = true;
            cell[count++] = 1000 + v * 7;
        }
    CHECK(markers_add(markers, plain->label, cell, count, NULL) == OK);
}

static void change(struct markers *markers, struct plain *plain, uint64_t *random)
{
    const size_t i = check_below(random, (uint32_t)markers->count);
    switch (check_below(random, 4)) {
    case 0:
    case 1:
        plain[i].stands = markers->marker[i].stands = !plain[i].stands;
        break;
    case 2:
        for (size_t k = 0; k < markers->count; k++)
            plain[k].planned = plain[k].stands;
        markers_plan_standing(markers);
        break;
    default:
        for (size_t k = 0; k < markers->count; k++)
            plain[k].planted = plain[k].planned;
        markers_plant(markers);
    }
}

STORY(any_set_of_markers_is_what_replaying_them_gives)
{
    uint64_t random = 14;
    static struct plain plain[MARKERS_MOST];
    for (int session = 0; session < 5000; session++) {
        struct markers markers = {0};
        for (int step = 0; step < 24; step++) {
            const uint32_t what = check_below(&random, 3);
            const struct marker *last = markers.marker + markers.count - 1;
            if (what == 0 || !markers.count)
                add(&markers, plain + markers.count, &random);
            else if (what == 1 && !last->planted && !last->planned)
                markers_drop(&markers);
            else
                change(&markers, plain, &random);
        }
        compare(&markers, plain);
        markers_release(&markers);
    }
}

static bool refuses(size_t bytes)
{
    (void)bytes;
    return false;
}

STORY(what_memory_cannot_hold_changes_nothing)
{
    struct markers markers = {0};
    uint32_t cell[300];
    for (uint32_t i = 0; i < 300; i++)
        cell[i] = i;
    CHECK(markers_add(&markers, 1, cell, 10, NULL) == OK);
    mem_allows = refuses;
    CHECK_INT(markers_add(&markers, 2, cell, 300, NULL), ERR_MEMORY);
    mem_allows = NULL;
    CHECK_INT(markers.count, 1);
    CHECK_INT(markers_at(&markers, MARKERS_STANDING, 3), 1);
    CHECK_INT(markers_at(&markers, MARKERS_STANDING, 10), 0);
    CHECK(markers_add(&markers, 2, cell, 300, NULL) == OK);
    CHECK_INT(markers_at(&markers, MARKERS_STANDING, 3), 2);
    CHECK_INT(markers_at(&markers, MARKERS_PLANTED, 3), 0);
    markers_release(&markers);
}

int main(void)
{
    return RUN_STORIES(TELL(any_set_of_markers_is_what_replaying_them_gives),
                       TELL(what_memory_cannot_hold_changes_nothing));
}
