/* SPDX-License-Identifier: MIT */
/* The number of voxels of each label: kept up to date through small and large edits that are
 * undone, and printed in a line after each edit. tests/test_history.c counts them after commands
 * that were stopped. */
#include "tests/random_commands.h"
#include "tests/scene_main.h"

#include <math.h>

#include "session/tally.h"

/* ---- volumes ---- */

static struct geometry spaced(uint32_t x_nm, uint32_t y_nm, uint32_t z_nm)
{
    struct geometry geometry = {.spacing_nm = {x_nm, y_nm, z_nm}};
    geometry_place_spaced(&geometry);
    return geometry;
}

static void is_told(uint32_t nm, uint64_t voxels, const char *expected)
{
    OWNED(buf_release) struct buf out = {0};
    const struct geometry geometry = spaced(nm, nm, nm);
    tally_write_volume(&out, &geometry, voxels);
    CHECK_TEXT(buf_text(&out), expected);
}

STORY(volumes_are_told_to_three_digits_in_a_unit_that_fits)
{
    is_told(1000000, 1, "1 mm3");
    is_told(1000000, 999, "999 mm3");
    is_told(1000000, 1000, "1 ml");
    is_told(1000000, 1240, "1.24 ml");
    is_told(1000000, 1245, "1.25 ml"); /* halves up */
    is_told(1000000, 1004, "1 ml");
    is_told(1000000, 1050, "1.05 ml");
    is_told(1000000, 1200, "1.2 ml");
    is_told(1000000, 9994, "9.99 ml");
    is_told(1000000, 9995, "10 ml");
    is_told(1000000, 99949, "99.9 ml");
    is_told(1000000, 99950, "100 ml");
    is_told(1000000, 999600, "1000 ml");
    is_told(1000000, 1000000, "1 l");
    is_told(1000000, 1244999, "1.24 l");
    is_told(500000, 1, "0.13 mm3"); /* an eighth, rounded */
    is_told(500000, 76, "9.5 mm3");
    is_told(10000, 1, "1000 um3");
    is_told(1000, 7, "7 um3");
    is_told(1, 499999999, "0 um3");
    is_told(1, 500000000, "1 um3");
    is_told(1000000, UINT32_MAX, "4295 l");
    is_told(UINT32_MAX, UINT64_MAX, "10000 l");
}

STORY(each_axis_has_a_spacing_of_its_own)
{
    OWNED(buf_release) struct buf out = {0};
    const struct geometry geometry = spaced(1000000, 1500000, 2000000);
    tally_write_volume(&out, &geometry, 500);
    CHECK_TEXT(buf_text(&out), "1.5 ml");
}

/* Sheared by 30 degrees: the cosine is 0.866. */
STORY(voxels_of_sheared_axes_take_less_than_boxes)
{
    OWNED(buf_release) struct buf out = {0};
    struct geometry geometry = spaced(1000000, 1000000, 2000000);
    geometry.to_mm[1][2] = 1;
    geometry.to_mm[2][2] = sqrt(3);
    tally_write_volume(&out, &geometry, 500);
    CHECK_TEXT(buf_text(&out), "866 mm3");
    CHECK(fabs(tally_voxel_mm3(&geometry) - sqrt(3)) < 1e-8);
}

/* ---- counts ---- */

static uint64_t seed = 1;

/* A tally that is not stale is used after each command; otherwise it would be counted again. */
static bool tally_is_right(struct session *session)
{
    const bool fresh = !session->tally.stale;
    const struct labels labels = labels_of_forest(session->scene);
    CHECK(tally_check(&session->tally, &labels) && session_count_labels(session, NULL) == OK);
    uint64_t sum = 0;
    for (unsigned label = 0; label < 256; label++)
        sum += session->tally.voxels[label];
    CHECK_INT(sum, session->scene->grid.voxels);
    return fresh;
}

/* One of the things that a session does to labels: with `all` any of them, otherwise one that edits
 * little. */
static void do_anything(struct interpreter *interp, bool all)
{
    static const char *const forms[] = {"remove X,Y,Z",        "seed X,Y,Z <5>",
                                        "seed X,Y,Z <5>",      "seed X,Y,Z <5>",
                                        "undo <1-3>",          "redo",
                                        "goto <4-63>",         "weight [morph|difference]",
                                        "range [none|20 300]", "adjacency [6|26]",
                                        "auto [on|off]",       "run"};
    char line[64];
    random_command(line, sizeof line, forms[check_below(&seed, all ? 12 : 4)],
                   (const uint32_t[]){40, 40, 30}, &seed);
    execute(interp, line);
}

static void begin_with_geom(struct interpreter *interp)
{
    begin_interpreter(interp);
    must(interp, "open synth:geom:40x40x30");
    CHECK(tally_is_right(interp->session));
    must(interp, "auto on");
}

/* Labels of before, and how many voxels have another one now. */
static uint8_t label_of[42 * 42 * 32];
static uint64_t differences(const struct session *session)
{
    uint64_t differ = 0;
    CHECK(session->scene->grid.cells <= sizeof label_of);
    for (uint32_t c = 0; c < session->scene->grid.cells; c++) {
        differ += session->scene->cell[c].label != label_of[c];
        label_of[c] = session->scene->cell[c].label;
    }
    return differ;
}

BEGUN_STORY(counts_follow_whatever_is_done, begin_with_geom)
{
    unsigned fresh = 0, counted = 0;
    differences(interp->session);
    for (int i = 0; i < 400 && check_failures < 5; i++) {
        do_anything(interp, true);
        fresh += tally_is_right(interp->session);
        const uint64_t changed = differences(interp->session);
        if (!interp->session->has_edited && !interp->session->has_regrown)
            continue;
        CHECK_INT(forest_changes(interp->session->forest).voxels, changed);
        counted++;
    }
    CHECK(counted > 100 && fresh > 100);
    must(interp, "auto on; range none");
    for (int i = 0; i < 60; i++)
        do_anything(interp, false);
    const struct tally before = interp->session->tally;
    session_mark(interp->session);
    CHECK(session_count_before(interp->session, NULL) == OK);
    for (uint32_t i = 0; i < 5; i++)
        CHECK(session_plant(interp->session,
                            (uint32_t[]){grid_cell(&interp->session->scene->grid, 3 + i, 7, 9)}, 1,
                            9, 0, NULL) == OK);
    CHECK(session_run(interp->session, NULL) == OK);
    tally_is_right(interp->session);
    CHECK(interp->session->tally.voxels[9] >= 5);
    CHECK_INT(interp->session->former_tally.voxels[9], 0);
    session_rollback(interp->session);
    CHECK(tally_is_right(interp->session) &&
          memcmp(&before, &interp->session->tally, sizeof before) == 0);
}

/* In some sessions asked for after each command, in others now and then, so that several edits are
 * followed at once; in scenes as opened and interpolated, where a step is two voxels along an axis;
 * by one thread and by three. */
STORY(measures_follow_whatever_is_done)
{
    for (unsigned round = 0; round < 8 && check_failures < 5; round++) {
        OWNED(interpreter_release) struct interpreter interp;
        setenv("IFTTY_THREADS", round & 1 ? "3" : "1", 1);
        begin_with_geom(&interp);
        measures_stand(interp.session);
        if (round & 2)
            must(&interp, round & 4 ? "interpolate 2 1 1" : "interpolate 1 2 1");
        for (int i = 0; i < (int)check_scaled(60) && check_failures < 5; i++) {
            do_anything(&interp, check_below(&seed, 3) == 0);
            if (check_below(&seed, round & 4 ? 8 : 1) == 0)
                measures_stand(interp.session);
        }
    }
    unsetenv("IFTTY_THREADS");
}

STORY(a_journal_that_is_resumed_is_counted_when_somebody_asks)
{
    struct interpreter interp;
    OWNED(buf_release) struct buf told = {0};
    begin_with_geom(&interp);
    interpreter_release(&interp);
    begin_interpreter(&interp);
    CHECK(interpreter_create_journal(&interp, place("tally.iftty"), NULL) == OK);
    must(&interp, "open synth:geom:40x40x30; seed 20,20,15 3; seed 2,2,2 0; run");
    const uint64_t voxels = interp.session->tally.voxels[3];
    CHECK(voxels > 0 && voxels < 48000);
    interpreter_release(&interp);
    begin_interpreter(&interp);
    CHECK(interpreter_resume_journal(&interp, place("tally.iftty"), &told, NULL) == OK);
    tally_is_right(interp.session);
    CHECK_INT(interp.session->tally.voxels[3], voxels);
    interpreter_release(&interp);
}

/* ---- what is printed ---- */

/* What the last command printed, without the time at its end. */
static const char *answer(void)
{
    static char text[512];
    snprintf(text, sizeof text, "%s", buf_text(&reply.text));
    char *line = strstr(text, "voxels changed");
    char *time = line ? strrchr(line, ',') : NULL;
    if (time)
        *time = '\0';
    return text;
}

SCENE_STORY(an_edit_is_answered_with_what_it_changed)
{
    must(interp, "auto on; seed 9,9,8 1"); /* 12 x 11 x 10 voxels of 1 x 1.5 x 2 mm, sheared */
    CHECK_TEXT(answer(), "1320 voxels changed, label 1: 3.91 ml");
    must(interp, "seed 1,1,1 2");
    const uint64_t one = interp->session->tally.voxels[1];
    const uint64_t two = interp->session->tally.voxels[2];
    CHECK_INT(one + two, 1320);
    CHECK_HAS(answer(),
              one > two ? " voxels changed, label 1: " : " voxels changed, label 2 cerebellum: ");
    CHECK_HAS(answer(), ", label 2 cerebellum: ");
    CHECK_HAS(buf_text(&reply.text), " ms\n");
    must(interp, "remove 1,1,1");
    CHECK_HAS(answer(), ", label 1: 3.91 ml (+");
    must(interp, "undo");
    CHECK_HAS(answer(), ", label 2 cerebellum: ");
    must(interp, "seed 1,1,1 2"); /* is there already */
    CHECK(strstr(answer(), "cerebellum") == NULL);
    MUST_ANSWER(interp, "hide 2", "");
}

SCENE_STORY(of_many_labels_the_largest_are_told)
{
    char line[64];
    for (int label = 1; label <= 9; label++) {
        snprintf(line, sizeof line, "seed %d,5,5 %d", label, label);
        must(interp, line);
    }
    must(interp, "run");
    CHECK_HAS(answer(), ", 3 more labels");
}
