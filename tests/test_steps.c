/* SPDX-License-Identifier: MIT */
/*
 * Steps of a journal: which there are and what stands, a walk through them to and fro that ends
 * where it began, bit for bit, and a learner's own turn.
 */
#include <stdlib.h>

#include "base/clock.h"
#include "base/file.h"
#include "engine/forest.h"
#include "steps/own_turn.h"
#include "steps/step_pages.h"
#include "steps/step_words.h"
#include "tests/folder.h"
#include "tests/interpreting.h"
#include "tests/stopping.h"

static char folder[FOLDER_LENGTH];
static struct interpreter interp;
static struct walkthrough walk;
static struct buf words;

/* ---- journals ---- */

/* The journal of these commands, a line each; comments too. Static storage. */
static const char *journal_of(const char *name, const char *lines)
{
    static char path[FOLDER_LENGTH + 40];
    struct interpreter maker;
    struct buf script = {0};
    snprintf(path, sizeof path, "%s/%s", folder, name);
    begin_interpreter(&maker);
    CHECK(interpreter_create_journal(&maker, path, &fault) == OK);
    for (const char *at = lines; *at;) {
        const size_t n = strcspn(at, "\n");
        buf_clear(&script);
        buf_add(&script, at, n);
        must(&maker, buf_text(&script));
        at += n + (at[n] == '\n');
    }
    interpreter_release(&maker);
    buf_release(&script);
    return path;
}

static void begin_walk(const char *path)
{
    begin_interpreter(&interp);
    if (!CHECK(walkthrough_begin(&walk, &interp, path, &fault) == OK))
        printf("#   %s: %s\n", path, fault.text);
}

static void end_walk(void)
{
    walkthrough_release(&walk);
    interpreter_release(&interp);
}

static void show(size_t step, enum step_phase phase)
{
    if (!CHECK(walkthrough_show(&walk, step, phase, &fault) == OK))
        printf("#   step %zu: %s\n", step, fault.text);
}

static const char *said(void (*say)(struct buf *, const struct walkthrough *, size_t), size_t step)
{
    buf_clear(&words);
    say(&words, &walk, step);
    return buf_text(&words);
}

static const char *verdict(void)
{
    buf_clear(&words);
    step_words_verdict(&words, &walk);
    return buf_text(&words);
}

struct digests {
    uint64_t keys, labels;
    size_t seeds, waits;
};

static struct digests digests_now(void)
{
    const struct forest *forest = session_forest(interp.session);
    return (struct digests){forest_digest(forest), forest_label_digest(forest),
                            forest_seeds(forest), session_pendings(interp.session)};
}

static bool are_same(struct digests a, struct digests b)
{
    return a.keys == b.keys && a.labels == b.labels && a.seeds == b.seeds && a.waits == b.waits;
}

/* ---- which steps there are ---- */

#define OPEN "open synth:geom:60x60x30\nauto on\n"

STORY(steps_are_the_gestures_and_say_whether_they_stand)
{
    const char *path = journal_of("stand.iftty", OPEN "seed 30,30,15 1 radius=2\n" /* 1 */
                                                      "turn 15\n"
                                                      "seed 2,2,2 0\n"   /* 2 */
                                                      "seed 9,9,9 2\n"   /* 3, undone */
                                                      "undo\n"           /* 4 */
                                                      "branch other\n"   /* 5 */
                                                      "seed 50,9,9 2\n"  /* 6, elsewhere */
                                                      "goto main\n"      /* 7 */
                                                      "remove 2,2,2\n"); /* 8 */
    static const enum step_fate fate[] = {STEP_STANDS, STEP_STANDS,    STEP_UNDONE, STEP_MOVES,
                                          STEP_MOVES,  STEP_ELSEWHERE, STEP_MOVES,  STEP_STANDS};
    begin_walk(path);
    CHECK_INT(walk.list.count, 8);
    for (size_t i = 0; i < 8 && i < walk.list.count; i++)
        CHECK_INT(walk.list.step[i].fate, fate[i]);
    CHECK_INT(step_list_find(&walk.list, walk.list.step[2].record), 3);
    CHECK_INT(step_list_find(&walk.list, 1), 0);
    show(8, STEP_AFTER);
    CHECK_HAS(said(step_words_title, 3), "seed 9,9,9 2  (undone later)");
    CHECK_HAS(said(step_words_title, 6), "(on another alternative)");
    CHECK_INT(walkthrough_seen(&walk, 4)->place[0], 9); /* an undo is where what it undoes was */
    CHECK_INT(walkthrough_seen(&walk, 8)->place[2], 2);
    end_walk();
}

/* One goes back past the beginning of an alternative and stays on it: on=NAME says so. */
STORY(what_was_undone_on_ones_own_alternative_lies_on_no_other)
{
    const char *path = journal_of("on.iftty", OPEN "seed 30,30,15 1 radius=2\n" /* 1, on main */
                                                   "branch other\n"             /* 2 */
                                                   "seed 50,9,9 2\n"            /* 3, undone */
                                                   "undo\n"                     /* 4 */
                                                   "undo\n"                     /* 5 */
                                                   "seed 2,2,2 0\n");           /* 6 */
    static const enum step_fate fate[] = {STEP_ELSEWHERE, STEP_MOVES, STEP_UNDONE,
                                          STEP_MOVES,     STEP_MOVES, STEP_STANDS};
    begin_walk(path);
    CHECK_INT(walk.list.count, 6);
    for (size_t i = 0; i < 6 && i < walk.list.count; i++)
        CHECK_INT(walk.list.step[i].fate, fate[i]);
    end_walk();
}

/* ---- to and fro ---- */

STORY(a_step_is_drawn_before_it_is_carried_out)
{
    begin_walk(journal_of("drawn.iftty", OPEN "seed 30,30,15 1 radius=2\n"
                                              "box 2,2,2 4,6,2 0\n"
                                              "remove 30,30,15\n"));
    show(2, STEP_BEFORE);
    const struct digests before = digests_now();
    const uint32_t *cross = session_outlook(interp.session)->slices.cross;
    CHECK_INT(cross[0], 3); /* in the middle of the box */
    CHECK_INT(cross[1], 4);
    show(2, STEP_DRAWN);
    struct digests drawn = digests_now();
    CHECK_INT(drawn.waits, 15);
    drawn.waits = 0;
    CHECK(are_same(drawn, before));
    CHECK(walkthrough_former(&walk) == NULL);
    show(2, STEP_AFTER);
    CHECK(!are_same(digests_now(), before));
    CHECK(walkthrough_former(&walk) != NULL);
    CHECK_HAS(said(step_words_change, 2), "0 +");
    CHECK_HAS(said(step_words_change, 2), ", 1 -");
    CHECK_HAS(said(step_words_change, 2), " voxels changed");
    show(3, STEP_DRAWN);
    CHECK_INT(edits_count(&session_state(interp.session)->lists.eliminators), 1);
    show(2, STEP_HIDDEN);
    CHECK(are_same(digests_now(), before));
    end_walk();
}

STORY(what_a_learner_looks_at_changes_no_step)
{
    begin_walk(journal_of("looks.iftty", OPEN "seed 30,30,15 1 radius=2\n"
                                              "seed 2,2,2 0\n"
                                              "turn 30\n"
                                              "seed 50,50,20 2\n"));
    show(1, STEP_AFTER);
    CHECK(interpreter_look(&interp, "overlay tint", &reply, &fault) == OK);
    CHECK(interpreter_look(&interp, "cross 5,6,7", &reply, &fault) == OK);
    CHECK(interpreter_look(&interp, "stats", &reply, &fault) == OK);
    CHECK_HAS(buf_text(&reply.text), "label");
    CHECK(interpreter_look(&interp, "seed 1,1,1 3", &reply, &fault) == ERR_USAGE);
    CHECK(interpreter_look(&interp, "hide 1", &reply, &fault) == ERR_USAGE);
    CHECK_HAS(fault.text, "nothing has changed");
    CHECK(interpreter_look(&interp, "undo", &reply, &fault) == ERR_USAGE);
    CHECK(interpreter_look(&interp, "open synth:geom", &reply, &fault) == ERR_USAGE);
    show(2, STEP_AFTER); /* whose overlay stays */
    CHECK_INT(session_outlook(interp.session)->slices.overlay, 1);
    CHECK_INT(session_outlook(interp.session)->slices.cross[0], 2);
    show(3, STEP_AFTER); /* before it the journal looks from elsewhere */
    CHECK_INT(session_outlook(interp.session)->slices.overlay, 2);
    CHECK(walkthrough_finish(&walk, &fault) == OK);
    CHECK_HAS(verdict(), "verified: ");
    end_walk();
}

/* Stopped sooner and later, until it comes to its end; how often that was. */
static unsigned show_in_spite(int *looks, size_t step, struct digests shown)
{
    unsigned stopped = 0;
    for (int after = 0;; after += after / 2 + 1) {
        *looks = after;
        const enum err err = walkthrough_show(&walk, step, STEP_AFTER, &fault);
        *looks = INT_MAX;
        if (!err)
            return stopped;
        stopped++;
        if (!CHECK(err == ERR_CANCELLED) || !CHECK(are_same(digests_now(), shown)))
            return stopped;
        CHECK(walk.at != step);
    }
}

STORY(what_is_cancelled_is_shown_as_it_was_and_can_be_gone_on_with)
{
    int looks = INT_MAX;
    struct watch watch = {.context = &looks, .poll = stop_after_looks, .step = 1};
    const char *path = journal_of("stop.iftty", OPEN "seed 30,30,15 1 radius=2\n"
                                                     "seed 2,2,2 0\n"
                                                     "seed 50,50,20 2\n");
    begin_walk(path);
    session_set_watch(interp.session, &watch);
    show(1, STEP_AFTER);
    const struct digests one = digests_now();
    CHECK(show_in_spite(&looks, 3, one) > 5);
    const struct digests three = digests_now();
    CHECK(show_in_spite(&looks, 1, three) > 2);
    CHECK(are_same(digests_now(), one));
    CHECK_HAS(verdict(), "not verified yet: ");
    CHECK(walkthrough_finish(&walk, &fault) == OK);
    CHECK_HAS(verdict(), "verified: 5 commands");
    CHECK(are_same(digests_now(), one));
    end_walk();
}

/* To its end and back to its beginning. */
static void walk_both_ways(const char *path)
{
    struct digests after[600];
    uint64_t slowest_ns = 0;
    size_t slowest = 0, over = 0;
    begin_walk(path);
    const size_t count = walk.list.count < 600 ? walk.list.count : 600;
    show(1, STEP_BEFORE);
    const struct digests first = digests_now();
    for (size_t step = 1; step <= count; step++) {
        if (step % 8 == 1)
            show(step, STEP_DRAWN);
        show(step, STEP_AFTER);
        after[step - 1] = digests_now();
    }
    CHECK(walkthrough_finish(&walk, &fault) == OK);
    CHECK_HAS(verdict(), "verified: ");
    CHECK(are_same(digests_now(), after[count - 1]));
    for (size_t step = count; step > 0; step--) {
        const uint64_t begin = clock_ns();
        show(step, STEP_AFTER);
        const uint64_t took = clock_ns() - begin;
        over += took > 100000000;
        if (took > slowest_ns) {
            slowest_ns = took;
            slowest = step;
        }
        if (!CHECK(are_same(digests_now(), after[step - 1])))
            printf("#   %s: step %zu\n", path, step);
    }
    show(0, STEP_BEFORE);
    CHECK(are_same(digests_now(), first));
    for (size_t i = 0; i < 5 && count > 5; i++) { /* here and there */
        const size_t step = 1 + i * 7919 % count;
        show(step, STEP_AFTER);
        CHECK(are_same(digests_now(), after[step - 1]));
    }
    if (getenv("IFTTY_TEST_BUSY"))
        printf("# %s: %zu steps; slowest back %.1f ms, to step %zu; %zu above 100 ms\n", path,
               count, (double)slowest_ns / 1e6, slowest, over);
    end_walk();
}

STORY(every_example_is_walked_to_its_end_and_back)
{
    static const char *const name[] = {"atlas",  "brain", "context", "geom",   "head",
                                       "layers", "looks", "print",   "shells", "sulci"};
    for (size_t i = 0; i < sizeof name / sizeof *name; i++) {
        char path[64];
        snprintf(path, sizeof path, "examples/%s.iftty", name[i]);
        walk_both_ways(path);
    }
}

STORY(so_is_one_with_undo_alternatives_weights_and_masks)
{
    walk_both_ways(journal_of("ways.iftty", OPEN "seed 30,30,15 1 radius=2\n"
                                                 "seed 2,2,2 0 radius=1\n"
                                                 "weight sobel\n"
                                                 "undo 2\n"
                                                 "redo\n"
                                                 "branch other\n"
                                                 "auto off\n"
                                                 "fill 10,10,9 2 to=20,10,9 to=15,20,9\n"
                                                 "seed 40,40,9 3 to=45,40,9\n"
                                                 "run\n"
                                                 "outline 30,10,9 2 to=35,10,9 to=35,20,9\n"
                                                 "outline 30,10,9 2 to=36,10,9 to=35,20,9 "
                                                 "instead=6\n"
                                                 "run\n"
                                                 "range 0 40000\n"
                                                 "goto main\n"
                                                 "adjacency 26\n"
                                                 "goto other\n"
                                                 "remove 15,13,9\n"
                                                 "run\n"));
}

/* ---- what the replay comes to ---- */

/* The journal with one piece of its bytes in place of another. */
static const char *changed(const char *path, const char *what, const char *to)
{
    struct buf bytes = {0}, out = {0};
    CHECK(file_read(&bytes, path, 1 << 20, NULL) == OK);
    const char *at = strstr(buf_text(&bytes), what);
    if (CHECK(at != NULL)) {
        buf_add(&out, bytes.data, (size_t)(at - bytes.data));
        buf_add_text(&out, to);
        buf_add_text(&out, at + strlen(what));
        CHECK(file_write(path, out.data, out.length, FILE_REPLACE, &fault) == OK);
    }
    buf_release(&bytes);
    buf_release(&out);
    return path;
}

STORY(a_step_that_gives_something_else_is_the_end_and_says_so)
{
    const char *path = journal_of("other.iftty", OPEN "seed 30,30,15 1 radius=2\n"
                                                      "seed 2,2,2 0\n"
                                                      "seed 9,9,9 2\n");
    begin_walk(changed(path, "seed 2,2,2 0", "seed 2,2,3 0"));
    show(1, STEP_AFTER);
    const struct digests one = digests_now();
    CHECK(walkthrough_show(&walk, 3, STEP_AFTER, &fault) == ERR_CHECK);
    CHECK_INT(walk.at, 1); /* what was shown is shown still */
    CHECK(are_same(digests_now(), one));
    CHECK_HAS(verdict(), "NOT verified: ");
    CHECK_HAS(verdict(), "seed 2,2,3 0");
    CHECK(walkthrough_finish(&walk, &fault) == ERR_CHECK);
    end_walk();
}

STORY(an_edited_comment_is_walked_through_and_not_verified)
{
    const char *path = journal_of("edited.iftty", OPEN "seed 30,30,15 1 radius=2\n"
                                                       "seed 2,2,2 0\n");
    begin_walk(changed(path, "seed 2,2,2 0", "# \033]0;evil\007 look\nseed 2,2,2 0"));
    CHECK(walkthrough_finish(&walk, &fault) == ERR_CHECK);
    CHECK_INT(walk.done, 2);
    CHECK_HAS(verdict(), "NOT verified: the journal was edited");
    show(2, STEP_AFTER);
    CHECK_HAS(said(step_words_comments, 2), "evil");
    CHECK(strchr(said(step_words_comments, 2), '\033') == NULL); /* no terminal obeys it */
    end_walk();
}

STORY(what_is_no_journal_of_steps_is_refused_in_words)
{
    begin_interpreter(&interp);
    const char *path = journal_of("none.iftty", OPEN "turn 15\n");
    CHECK(walkthrough_begin(&walk, &interp, path, &fault) == ERR_INPUT);
    CHECK_HAS(fault.text, "no step");
    end_walk();
    begin_interpreter(&interp);
    CHECK(file_write(path, "open synth:geom\n", 16, FILE_REPLACE, NULL) == OK);
    CHECK(walkthrough_begin(&walk, &interp, path, &fault) == ERR_INPUT);
    CHECK_HAS(fault.text, "this is a script");
    end_walk();
}

/* ---- one's own turn ---- */

STORY(an_own_gesture_is_compared_and_taken_back)
{
    struct own_turn turn;
    struct own_turns turns = {0};
    begin_walk(journal_of("turn.iftty", OPEN "seed 30,30,15 1 radius=2\n"
                                             "seed 2,2,2 0\n"
                                             "weight sobel\n"
                                             "seed 50,10,15 2\n"));
    CHECK(own_turn_can_be_asked(&walk, 1));
    show(3, STEP_AFTER);
    CHECK(!own_turn_can_be_asked(&walk, 3)); /* weights are nowhere */
    show(4, STEP_HIDDEN);
    const struct digests before = digests_now();
    CHECK(own_turn_take(&turn, &walk, 4, "seed 50,10,15 2", &fault) == OK);
    CHECK(are_same(digests_now(), before));
    CHECK(turn.apart_mm == 0 && turn.label == turn.wanted);
    CHECK(turn.own > 0 && turn.own == turn.theirs && turn.both == turn.own);
    CHECK(own_turn_overlap(&turn) == 1);
    CHECK(own_turns_add(&turns, &turn, NULL) == OK);
    CHECK(own_turn_take(&turn, &walk, 4, "seed 47,14,15 1", &fault) == OK);
    CHECK(are_same(digests_now(), before));
    CHECK(turn.apart_mm > 4.9 && turn.apart_mm < 5.1); /* 3, 4, 5 */
    CHECK(turn.both == 0);
    buf_clear(&words);
    own_turn_words(&words, &walk, &turn);
    CHECK_HAS(buf_text(&words), "5.0 mm away, label 1, not 2, overlap 0.00: ");
    CHECK(own_turns_add(&turns, &turn, NULL) == OK);
    turns.passed = 1;
    buf_clear(&words);
    own_turns_words(&words, &turns);
    CHECK_HAS(buf_text(&words), "2 of 3 gestures tried: labels right 1, median distance 5.0 mm, ");
    CHECK_HAS(buf_text(&words), "mean overlap 0.50");
    CHECK(own_turn_take(&turn, &walk, 4, "seed 99,10,15 2", &fault) != OK);
    CHECK(own_turn_take(&turn, &walk, 4, "weight morph", &fault) == ERR_USAGE);
    show(4, STEP_AFTER);
    CHECK(walkthrough_finish(&walk, &fault) == OK);
    CHECK_HAS(verdict(), "verified: ");
    own_turns_release(&turns);
    end_walk();
}

int main(void)
{
    if (!make_folder(folder, "steps"))
        return 1;
    const int status =
        RUN_STORIES(TELL(steps_are_the_gestures_and_say_whether_they_stand),
                    TELL(what_was_undone_on_ones_own_alternative_lies_on_no_other),
                    TELL(a_step_is_drawn_before_it_is_carried_out),
                    TELL(what_a_learner_looks_at_changes_no_step),
                    TELL(what_is_cancelled_is_shown_as_it_was_and_can_be_gone_on_with),
                    TELL(so_is_one_with_undo_alternatives_weights_and_masks),
                    TELL(every_example_is_walked_to_its_end_and_back),
                    TELL(a_step_that_gives_something_else_is_the_end_and_says_so),
                    TELL(an_edited_comment_is_walked_through_and_not_verified),
                    TELL(what_is_no_journal_of_steps_is_refused_in_words),
                    TELL(an_own_gesture_is_compared_and_taken_back));
    buf_release(&words);
    reply_release(&reply);
    return status + remove_folder(folder);
}
