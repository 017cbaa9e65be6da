/* SPDX-License-Identifier: MIT */
/* Which slices to outline next, against a plain choice from the sums of engine/doubt.h: random
 * seeds, outlines and steps of `finish`, asked again after undo, without memory, and as a command.
 */
#include "session/doubtful.h"
#include "tests/scarce_memory.h"
#include "tests/scene_main.h"

static struct interpreter interp;
DRAW_FROM(34)

/* ---- by the model ---- */

static struct outlined {
    unsigned axis, at, label;
} outlined[40];
static size_t outlined_count;

/* A rectangle of three voxels a side or more. */
static void add_outline(void)
{
    struct outlined *o = &outlined[outlined_count++];
    uint32_t low[3], high[3], corner[4][3];
    char line[200];
    o->axis = below(3);
    o->at = below(size[o->axis]);
    o->label = 1 + below(2);
    for (unsigned a = 0; a < 3; a++) {
        low[a] = a == o->axis ? o->at : below(size[a] - 2);
        high[a] = a == o->axis ? o->at : low[a] + 2 + below(size[a] - 2 - low[a]);
    }
    const unsigned u = (o->axis + 1) % 3;
    for (int i = 0; i < 4; i++) {
        memcpy(corner[i], i < 2 ? low : high, sizeof low);
        corner[i][u] = i == 0 || i == 3 ? low[u] : high[u];
    }
    snprintf(line, sizeof line, "outline %u,%u,%u %u to=%u,%u,%u to=%u,%u,%u to=%u,%u,%u",
             corner[0][0], corner[0][1], corner[0][2], o->label, corner[1][0], corner[1][1],
             corner[1][2], corner[2][0], corner[2][1], corner[2][2], corner[3][0], corner[3][1],
             corner[3][2]);
    must(&interp, line);
}

static bool is_left_out(unsigned axis, uint32_t at, unsigned label,
                        const struct doubtful_slice *chosen, size_t count)
{
    bool is_out = false;
    for (size_t i = 0; i < outlined_count; i++)
        is_out |= outlined[i].axis == axis && labs((long)outlined[i].at - (long)at) <= 1 &&
                  (label == FINISH_ALL_LABELS || label == outlined[i].label);
    for (size_t i = 0; i < count; i++)
        is_out |= chosen[i].axis == axis && labs((long)chosen[i].at - (long)at) < DOUBTFUL_APART;
    return is_out;
}

static size_t choose(struct doubtful_slice chosen[DOUBTFUL_MOST], unsigned label)
{
    struct session *session = interp.session;
    OWNED(doubt_release) struct doubt doubt = {0};
    size_t count = 0;
    CHECK(doubt_find(&doubt, &session->now.kept.finish, session->scene, NULL, label, NULL) == OK);
    for (bool found = true; found && count < DOUBTFUL_MOST; count += found) {
        struct doubtful_slice best = {.doubt = 0};
        for (unsigned axis = 0; axis < 3; axis++)
            for (uint32_t at = 0; at < size[axis]; at++)
                if (doubt.slice[axis][at] > best.doubt &&
                    !is_left_out(axis, at, label, chosen, count))
                    best = (struct doubtful_slice){axis, at, doubt.slice[axis][at]};
        found = best.doubt > 0;
        if (found)
            chosen[count] = best;
    }
    return count;
}

static bool has_label(const struct labels *labels, unsigned label, const uint32_t place[3])
{
    const uint8_t has =
        labels_at(labels, grid_cell(&labels->scene->grid, place[0], place[1], place[2]));
    return label == FINISH_ALL_LABELS ? has > 0 : has == label;
}

/* Whether the label has a voxel in a slice. */
static bool lies_in(const struct labels *labels, unsigned label, unsigned axis, uint32_t at)
{
    bool found = false;
    for (uint32_t z = 0; z < size[2]; z++)
        for (uint32_t y = 0; y < size[1]; y++)
            for (uint32_t x = 0; x < size[0]; x++) {
                const uint32_t place[3] = {x, y, z};
                found |= place[axis] == at && has_label(labels, label, place);
            }
    return found;
}

/* ---- the stories ---- */

static void is_as_chosen(unsigned label)
{
    const struct labels labels = labels_of_forest(interp.session->scene);
    struct doubtful_slice found[DOUBTFUL_MOST], wanted[DOUBTFUL_MOST];
    size_t count;
    CHECK(doubtful_find(found, &count, interp.session, label, NULL) == OK);
    CHECK_INT(count, choose(wanted, label));
    for (size_t i = 0; i < count && check_failures == 0; i++) {
        uint32_t at[3];
        CHECK(found[i].axis == wanted[i].axis && found[i].at == wanted[i].at &&
              found[i].doubt == wanted[i].doubt);
        CHECK(doubtful_place(at, &labels, label, &found[i]));
        CHECK_INT(at[found[i].axis], found[i].at);
        CHECK(has_label(&labels, label, at) == lies_in(&labels, label, found[i].axis, found[i].at));
    }
}

STORY(slices_are_chosen_by_their_doubt_and_not_where_an_outline_lies)
{
    static const char *const steps[] = {"finish relax", "finish majority", "finish none"};
    size_t undone = 0;
    for (int round = 0; round < 12 && check_failures == 0; round++) {
        char line[80];
        begin_with_scene(&interp);
        must(&interp, "auto on");
        outlined_count = 0;
        for (int n = 0; n < 8 && check_failures == 0; n++) {
            const uint32_t what = below(6);
            snprintf(line, sizeof line, "seed %u,%u,%u %u radius=%u", below(size[0]),
                     below(size[1]), below(size[2]), below(3), below(3));
            if (n < 3 || what < 2)
                must(&interp, line);
            else if (what < 4)
                add_outline();
            else
                must(&interp, steps[below(3)]);
            is_as_chosen(1);
            is_as_chosen(1 + below(2));
            is_as_chosen(FINISH_ALL_LABELS);
            if (what == 3 && n >= 3) { /* its slice is offered again */
                must(&interp, "undo");
                outlined_count--;
                undone++;
                is_as_chosen(1 + below(2));
            }
        }
        interpreter_release(&interp);
    }
    CHECK(undone > 5);
}

STORY(a_stroke_is_no_outline)
{
    unsigned axis;
    uint32_t at;
    begin_with_scene(&interp);
    must(&interp, "seed 2,2,2 1 to=9,9,2; seed 5,5,5 1 radius=2; "
                  "outline 2,5,2 1 to=5,5,2 to=5,5,4 to=2,5,4");
    const struct grid *grid = &interp.session->scene->grid;
    CHECK(!contour_is_area(&axis, &at, grid, &interp.session->markers, 1));
    CHECK(!contour_is_area(&axis, &at, grid, &interp.session->markers, 2));
    CHECK(contour_is_area(&axis, &at, grid, &interp.session->markers, 3) && axis == 1 && at == 5);
    interpreter_release(&interp);
}

STORY(slices_are_told_with_the_volume_that_is_in_doubt)
{
    begin_with_scene(&interp);
    MUST_MENTION(&interp, "hints slice", "no slice: ");
    must(&interp, "seed 3,3,3 1 radius=1; seed 9,9,8 0 radius=1");
    must(&interp, "hints slice label=1"); /* which applies them first */
    CHECK_HAS(buf_text(&reply.text), "1  ");
    CHECK_HAS(buf_text(&reply.text), " mm3 in doubt, at ");
    MUST_MENTION(&interp, "hints 2", "a cost of");
    is_refused(&interp, "hints slice label=0", "label: expected an object");
    is_refused(&interp, "hints slice report=x.json", "report: only for places");
    is_refused(&interp, "hints slices", "COUNT: expected");
    interpreter_release(&interp);
}

STORY(without_memory_it_says_so_and_with_it_goes_on)
{
    struct doubtful_slice found[DOUBTFUL_MOST];
    unsigned failed = 0;
    size_t count;
    begin_with_scene(&interp);
    must(&interp, "auto on; seed 3,3,3 1 radius=1; seed 9,9,8 0 radius=1");
    outlined_count = 0;
    for (size_t most = 0; most < 400000; most += most / 4 + 100) {
        doubting_release(&interp.session->inside->doubting);
        allow_bytes(most);
        const enum err err = doubtful_find(found, &count, interp.session, 1, NULL);
        mem_allows = NULL;
        CHECK(err == OK || (err == ERR_MEMORY && count == 0));
        failed += err != OK;
    }
    CHECK(failed > 3);
    is_as_chosen(1);
    interpreter_release(&interp);
}
