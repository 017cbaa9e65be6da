/* SPDX-License-Identifier: MIT */
/* Watching a journal: steps that are shown in any order have the same digests, bit for bit; a step
 * is drawn before it is carried out; and the verdict of the replay. */
#include "base/file.h"
#include "engine/forest.h"
#include "program/programs.h"
#include "tests/folder_main.h"
#include "tests/interpreting.h"
#include "tests/stopping.h"

static struct interpreter interp;
static struct watched watched;
static struct buf words;

/* ---- journals ---- */

/* Write a journal of these commands. Returns static storage. */
static const char *journal_of(const char *name, const char *lines)
{
    static char path[FOLDER_LENGTH + 40];
    OWNED(interpreter_release) struct interpreter maker = {0};
    snprintf(path, sizeof path, "%s/%s", folder, name);
    begin_interpreter(&maker);
    CHECK(interpreter_create_journal(&maker, path, &fault) == OK);
    must(&maker, lines);
    return path;
}

static void begin_watching(const char *path)
{
    begin_interpreter(&interp);
    CHECK_WITH(watched_begin(&watched, &interp, path, &fault) == OK, "%s: %s", path, fault.text);
}

static void end_watching(void)
{
    watched_release(&watched);
    interpreter_release(&interp);
}
#define WATCHED_STORY(told) STORY_WITHIN(told, (void)0, end_watching())

static void show(enum err (*how)(struct watched *, size_t, struct fault *), size_t step)
{
    CHECK_WITH(how(&watched, step, &fault) == OK, "step %zu: %s", step, fault.text);
}

static const char *said(void (*say)(struct buf *, const struct watched *))
{
    buf_clear(&words);
    say(&words, &watched);
    return buf_text(&words);
}

struct digests {
    uint64_t keys, labels;
    size_t seeds, waits;
};

static struct digests digests_now(void)
{
    const struct forest *forest = interp.session->forest;
    return (struct digests){forest_digest(forest), forest_label_digest(forest),
                            forest_seeds(forest), session_pendings(interp.session)};
}

static bool are_same(struct digests a, struct digests b)
{
    return a.keys == b.keys && a.labels == b.labels && a.seeds == b.seeds && a.waits == b.waits;
}

/* ---- steps ---- */

#define OPEN "open synth:geom:60x60x30; auto on; "

/* Check the steps in their order: the title of each ends with these words. */
static void check_titles(const char *path, const char *const *title)
{
    size_t count = 0;
    begin_watching(path);
    for (; title[count]; count++) {
        show(watched_carry_out, count + 1);
        const char *is = said(watched_title);
        const size_t end = strlen(is), length = strlen(title[count]);
        if (!CHECK(end >= length && strcmp(is + end - length, title[count]) == 0))
            printf("#   %s, not %s\n", is, title[count]);
    }
    CHECK_INT(watched.count, count);
    end_watching();
}

STORY(steps_are_states_and_say_whether_the_last_one_comes_from_them)
{
    static const char *const title[] = {"step 1 of 5, record 3: seed 30,30,15 1 radius=2",
                                        "step 2 of 5, record 5: seed 2,2,2 0",
                                        "step 3 of 5, record 6: seed 9,9,9 2  (undone later)",
                                        "step 4 of 5, record 9: seed 50,9,9 2  (on another branch)",
                                        "step 5 of 5, record 11: remove 2,2,2",
                                        NULL};
    /* Steps: four seeds, the third undone, the fourth on another branch, and `remove`. */
    check_titles(journal_of("stand.iftty",
                            OPEN "seed 30,30,15 1 radius=2; turn 15; seed 2,2,2 0; seed 9,9,9 2; "
                                 "undo; branch other; seed 50,9,9 2; goto main; remove 2,2,2"),
                 title);
}

/* Undo past the beginning of a branch stays on it, recorded by on=NAME. */
STORY(what_was_undone_on_ones_own_branch_is_on_no_other)
{
    static const char *const title[] = {"seed 30,30,15 1 radius=2  (on another branch)",
                                        "seed 50,9,9 2  (undone later)", "seed 2,2,2 0", NULL};
    check_titles(journal_of("on.iftty",
                            OPEN "seed 30,30,15 1 radius=2; branch other; seed 50,9,9 2; undo; "
                                 "undo; seed 2,2,2 0"),
                 title);
}

STORY(the_steps_begin_after_an_interpolation)
{
    static const char *const title[] = {"step 1 of 1, record 5: seed 2,2,2 2", NULL};
    check_titles(journal_of("scenes.iftty", OPEN "label 1 head; interpolate 2 2 1; seed 2,2,2 2"),
                 title);
}

/* ---- to and fro ---- */

WATCHED_STORY(a_step_is_drawn_before_it_is_carried_out)
{
    begin_watching(journal_of("drawn.iftty",
                              OPEN "seed 30,30,15 1 radius=2; box 2,2,2 4,6,2 0; remove 30,30,15"));
    show(watched_carry_out, 1);
    const struct digests before = digests_now();
    show(watched_draw, 2);
    const uint32_t *cross = interp.session->now.outlook.slices.cross;
    CHECK_INT(cross[0], 3); /* in the middle of the box */
    CHECK_INT(cross[1], 4);
    CHECK_TEXT(said(watched_describe), "drawn, but not run yet: at 3,4,2, label 0");
    struct digests drawn = digests_now();
    CHECK_INT(drawn.waits, 15);
    drawn.waits = 0;
    CHECK(are_same(drawn, before) && watched_former(&watched) == NULL);
    show(watched_carry_out, 2);
    CHECK(!are_same(digests_now(), before) && watched_former(&watched) != NULL);
    CHECK_HAS(said(watched_describe), "0 +");
    CHECK_HAS(said(watched_describe), ", 1 -");
    CHECK_HAS(said(watched_describe), " voxels changed");
    show(watched_draw, 3);
    CHECK_INT(edits_count(&interp.session->now.lists.eliminators), 1);
    show(watched_draw, 2);
    show(watched_carry_out, 1);
    CHECK(are_same(digests_now(), before));
    show(watched_draw, 0);
    CHECK_INT(digests_now().seeds, 0);
    CHECK_TEXT(said(watched_title), "the beginning, before step 1 of 3");
    CHECK_TEXT(said(watched_describe), "");
}

WATCHED_STORY(what_a_viewer_looks_at_changes_no_step)
{
    begin_watching(journal_of("looks.iftty",
                              OPEN "seed 30,30,15 1 radius=2; seed 2,2,2 0; turn 30; "
                                   "seed 50,50,20 2"));
    show(watched_carry_out, 1);
    CHECK(interpreter_look(&interp, "overlay tint", &reply, &fault) == OK);
    CHECK(interpreter_look(&interp, "cross 5,6,7", &reply, &fault) == OK);
    CHECK(interpreter_look(&interp, "stats", &reply, &fault) == OK);
    CHECK_HAS(buf_text(&reply.text), "label");
    CHECK(interpreter_look(&interp, "seed 1,1,1 3", &reply, &fault) == ERR_USAGE);
    CHECK(interpreter_look(&interp, "hide 1", &reply, &fault) == ERR_USAGE);
    CHECK_HAS(fault.text, "nothing has changed");
    CHECK(interpreter_look(&interp, "undo", &reply, &fault) == ERR_USAGE);
    CHECK(interpreter_look(&interp, "open synth:geom", &reply, &fault) == ERR_USAGE);
    show(watched_carry_out, 2); /* the overlay is kept */
    CHECK_INT(interp.session->now.outlook.slices.overlay, 1);
    CHECK_INT(interp.session->now.outlook.slices.cross[0], 2);
    show(watched_carry_out, 3); /* before it the journal changes its view */
    CHECK_INT(interp.session->now.outlook.slices.overlay, 2);
    CHECK_HAS(said(watched_verdict), "verified: ");
}

/* Cancel sooner and later until the step succeeds. Returns the number of cancels. */
static unsigned show_in_spite(int *looks, size_t step, struct digests shown)
{
    unsigned stopped = 0;
    for (int after = 0;; after += after / 2 + 1) {
        *looks = after;
        const enum err err = watched_draw(&watched, step, &fault);
        *looks = INT_MAX;
        if (!err)
            return stopped;
        stopped++;
        if (!CHECK(err == ERR_CANCELLED) || !CHECK(are_same(digests_now(), shown)))
            return stopped;
        CHECK(watched.at != step);
    }
}

WATCHED_STORY(what_is_cancelled_is_shown_as_it_was_and_can_be_gone_on_with)
{
    int looks = INT_MAX;
    struct watch watch = {.context = &looks, .poll = stop_after_looks, .step = 1};
    const char *path =
        journal_of("stop.iftty", OPEN "seed 30,30,15 1 radius=2; seed 2,2,2 0; seed 50,50,20 2; "
                                      "seed 10,50,20 2");
    begin_watching(path);
    session_set_watch(interp.session, &watch);
    show(watched_carry_out, 1);
    const struct digests one = digests_now();
    CHECK(show_in_spite(&looks, 4, one) > 5);
    const struct digests three = digests_now();
    show(watched_carry_out, 1);
    looks = 0;
    CHECK(watched_carry_out(&watched, 4, &fault) == ERR_CANCELLED);
    looks = INT_MAX;
    CHECK(are_same(digests_now(), one));
    show(watched_draw, 4);
    CHECK(are_same(digests_now(), three) && show_in_spite(&looks, 2, three) > 2);
    show(watched_carry_out, 1);
    CHECK(are_same(digests_now(), one));
    end_watching();
    begin_interpreter(&interp);
    looks = 40;
    session_set_watch(interp.session, &watch);
    CHECK(watched_begin(&watched, &interp, path, &fault) == ERR_CANCELLED);
}

/* Show the steps to the end and back, about eight of a long journal. */
static void walk_both_ways(const char *path)
{
    struct digests after[600];
    begin_watching(path);
    const size_t count = watched.count < 600 ? watched.count : 600;
    const struct digests end = digests_now();
    CHECK_HAS(said(watched_verdict), "verified: ");
    show(watched_draw, 0);
    const struct digests first = digests_now();
    const size_t by = 1 + count / 8;
    for (size_t step = count % by ? count % by : by; step <= count; step += by) {
        if (step % 8 == 1)
            show(watched_draw, step);
        show(watched_carry_out, step);
        after[step - 1] = digests_now();
    }
    show(watched_carry_out, watched.end);
    CHECK(are_same(digests_now(), end)); /* as after the replay */
    for (size_t step = count; step > 0; step -= step < by ? step : by) {
        show(watched_carry_out, step);
        CHECK_WITH(are_same(digests_now(), after[step - 1]), "%s: step %zu", path, step);
    }
    show(watched_draw, 0);
    CHECK(are_same(digests_now(), first));
    for (size_t i = 0; i < 2 && count > 5; i++) { /* in another order */
        const size_t step = count - i * 7919 % (count / by) * by;
        show(watched_carry_out, step);
        CHECK(are_same(digests_now(), after[step - 1]));
    }
    end_watching();
}

STORY(examples_are_walked_to_their_ends_and_back)
{
    static const char *const name[] = {"brain", "looks", "shells", "sulci"};
    for (size_t i = 0; i < sizeof name / sizeof *name; i++) {
        char path[64];
        snprintf(path, sizeof path, "examples/%s.iftty", name[i]);
        walk_both_ways(path);
    }
}

STORY(so_is_one_with_undo_alternatives_weights_and_masks)
{
    walk_both_ways(journal_of("ways.iftty",
                              OPEN "seed 30,30,15 1 radius=2; seed 2,2,2 0 radius=1; weight sobel; "
                                   "undo 2; redo; branch other; auto off; "
                                   "fill 10,10,9 2 to=20,10,9 to=15,20,9; "
                                   "seed 40,40,9 3 to=45,40,9; run; "
                                   "outline 30,10,9 2 to=35,10,9 to=35,20,9; "
                                   "outline 30,10,9 2 to=36,10,9 to=35,20,9 instead=6; run; "
                                   "range 0 40000; goto main; adjacency 26; goto other; "
                                   "remove 15,13,9; run"));
}

/* ---- verdict of the replay ---- */

/* Replace one part of a journal by another. */
static const char *changed(const char *path, const char *what, const char *to)
{
    OWNED(buf_release) struct buf bytes = {0}, out = {0};
    CHECK(file_read(&bytes, path, 1 << 20, NULL) == OK);
    const char *at = strstr(buf_text(&bytes), what);
    if (CHECK(at != NULL)) {
        buf_add(&out, bytes.data, (size_t)(at - bytes.data));
        buf_add_text(&out, to);
        buf_add_text(&out, at + strlen(what));
        CHECK(file_write(path, out.data, out.length, FILE_REPLACE, &fault) == OK);
    }
    return path;
}

WATCHED_STORY(a_step_that_gives_something_else_is_not_shown_and_that_is_said)
{
    const char *path =
        journal_of("other.iftty", OPEN "seed 30,30,15 1 radius=2; seed 2,2,2 0; seed 9,9,9 2");
    begin_watching(changed(path, "seed 2,2,2 0", "seed 2,2,3 0"));
    CHECK_INT(watched.count, 1);
    CHECK_INT(watched.ended, ERR_CHECK);
    CHECK_HAS(said(watched_verdict), "NOT verified: ");
    CHECK_HAS(said(watched_verdict), "seed 2,2,3 0");
    show(watched_draw, 1);
    show(watched_carry_out, 1);
}

/* The steps before it belong to a history that was dropped. */
WATCHED_STORY(an_interpolation_that_differs_leaves_no_step)
{
    const char *path =
        journal_of("rest.iftty", OPEN "label 1 head; interpolate 2 2 1; seed 9,9,9 2");
    begin_interpreter(&interp);
    changed(path, "interpolate 2 2 1", "interpolate 2 1 1");
    CHECK(watched_begin(&watched, &interp, path, &fault) == ERR_CHECK);
    CHECK_INT(watched.count, 0);
    CHECK_HAS(fault.text, "record 4");
}

WATCHED_STORY(an_edited_comment_is_shown_and_the_journal_is_not_verified)
{
    const char *path = journal_of("edited.iftty", OPEN "seed 30,30,15 1 radius=2; seed 2,2,2 0");
    begin_watching(changed(path, "seed 2,2,2 0", "# \033]0;evil\007 look\nseed 2,2,2 0"));
    CHECK_INT(watched.count, 2);
    CHECK_INT(watched.ended, ERR_CHECK);
    CHECK_HAS(said(watched_verdict), "NOT verified: the journal was edited");
    show(watched_carry_out, 2);
    CHECK_HAS(said(watched_comments), "evil");
    CHECK(strchr(said(watched_comments), '\033') == NULL); /* it is escaped */
}

WATCHED_STORY(what_is_no_journal_of_steps_is_refused_in_words)
{
    begin_interpreter(&interp);
    const char *path = journal_of("none.iftty", OPEN "turn 15");
    CHECK(watched_begin(&watched, &interp, path, &fault) == ERR_INPUT);
    CHECK_HAS(fault.text, "no step");
    end_watching();
    begin_interpreter(&interp);
    CHECK(file_write(path, "open synth:geom\n", 16, FILE_REPLACE, NULL) == OK);
    CHECK(watched_begin(&watched, &interp, path, &fault) == ERR_INPUT);
    CHECK_HAS(fault.text, "this is a script");
}
