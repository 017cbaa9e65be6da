/* SPDX-License-Identifier: MIT */
/* A scene whose cells are computed later differs only in time. */
#include "tests/scene_main.h"
#include "tests/stopping.h"

/* Commands after `open` of a scene from a file. */
static const char *const lines[] = {
    "info",
    "stats",
    "slice axial 3",
    "window 10 90",
    "pick 3 3",
    "weight sobel",
    "weight gauss 1.5",
    "adjacency 26",
    "range 40 210",
    "interpolate 2 1 1",
    "label 2 cerebellum",
    "auto off",
    "undo",
    "seed 3,4,5 1",
    "box 1,1,1 5,5,5 2",
    "mosaic axial",
    "render",
    "components",
    "why 3,4,5",
    "orient RAS",
    "measure 1,1,1 5,5,5",
    "save labels waiting.nii",
    "mask waiting.nii",
    "history",
    "hints",
};
enum { LINES = sizeof lines / sizeof lines[0] };

static void begin_waiting(struct interpreter *interp, uint64_t least)
{
    begin_interpreter(interp);
    session_let_wait(interp->session, least);
    open_scene(interp, "scene.nii");
}

/* Answers, words and saved files are equal. */
static void answers_are_equal(struct interpreter *a, struct interpreter *b, const char *line)
{
    OWNED(buf_release) struct buf text = {0}, words = {0};
    const enum err err = execute(a, line);
    unlink("waiting.nii");
    buf_add_text(&text, err ? fault.text : buf_text(&reply.text));
    buf_add_text(&words, buf_text(&reply.words));
    CHECK_INT(execute(b, line), err);
    CHECK_TEXT(err ? fault.text : buf_text(&reply.text), buf_text(&text));
    CHECK_TEXT(buf_text(&reply.words), buf_text(&words));
}

STORY(a_scene_that_waits_answers_as_any_other)
{
    for (unsigned i = 0; i < LINES; i++) {
        OWNED(interpreter_release) struct interpreter waiting, ready;
        OWNED(buf_release) struct buf words = {0};
        const unsigned failures = check_failures;
        begin_waiting(&waiting, 0);
        buf_add_text(&words, buf_text(&reply.words));
        CHECK(waiting.session->inside->waits && waiting.session->scene->plain);
        begin_waiting(&ready, UINT64_MAX);
        CHECK_TEXT(buf_text(&reply.words), buf_text(&words));
        CHECK(!ready.session->inside->waits && !ready.session->scene->plain);
        answers_are_equal(&waiting, &ready, lines[i]);
        answers_are_equal(&waiting, &ready, "seed 8,8,8 3 radius=2");
        must(&waiting, "run"); /* not compared: its answer has a time */
        must(&ready, "run");
        struct snapshot now;
        take_snapshot(&now, &ready);
        is_as_before(&now, &waiting, lines[i]);
        if (check_failures > failures)
            printf("#   after %s\n", lines[i]);
    }
}

/* Ctrl-C while cells are computed leaves the scene as after `open`, and the command can be
 * repeated. */
STORY(a_stop_leaves_it_waiting)
{
    int looks;
    struct watch watch = {.context = &looks, .poll = stop_after_looks, .step = 16};
    int stops = 0, waited = 0;
    OWNED(interpreter_release) struct interpreter ready;
    begin_waiting(&ready, UINT64_MAX);
    must(&ready, "seed 3,4,5 1");
    for (bool ends = false; !ends && check_failures == 0; stops++) {
        OWNED(interpreter_release) struct interpreter interp;
        begin_waiting(&interp, 0);
        interp.session->watch = &watch;
        looks = stops;
        const enum err err = execute(&interp, "seed 3,4,5 1");
        CHECK(err == OK || err == ERR_CANCELLED);
        ends = err == OK;
        waited += interp.session->inside->waits;
        looks = INT_MAX;
        if (err)
            must(&interp, "seed 3,4,5 1");
        CHECK(!interp.session->inside->waits);
        struct snapshot now;
        take_snapshot(&now, &ready);
        is_as_before(&now, &interp, "a stop");
    }
    CHECK(waited > 10);
}

/* A cancelled `open` leaves no scene. */
STORY(a_stop_while_it_is_opened_leaves_nothing)
{
    int looks;
    struct watch watch = {.context = &looks, .poll = stop_after_looks, .step = 16};
    char line[PATH_MAX + 8];
    int stops = 0;
    snprintf(line, sizeof line, "open %s", place("scene.nii"));
    for (bool ends = false; !ends && check_failures == 0; stops++) {
        OWNED(interpreter_release) struct interpreter interp;
        begin_interpreter(&interp);
        session_let_wait(interp.session, 0);
        interp.session->watch = &watch;
        looks = stops;
        ends = execute(&interp, line) == OK;
        CHECK(interp.session->has_scene == ends && interp.session->inside->waits == ends);
        looks = INT_MAX;
        if (!ends)
            must(&interp, line);
        must(&interp, "seed 3,4,5 1");
    }
    CHECK(stops > 10);
}
