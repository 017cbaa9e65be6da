/* SPDX-License-Identifier: MIT */
/* The history: undo and redo restore states exactly, branches stay separate, and a resumed session
 * equals the one that was left, whether its commands are carried out or only skimmed. */
#include <pthread.h>

#include "journal/record.h"
#include "session/state.h"
#include "show/slicing.h"
#include "tests/random_commands.h"
#include "tests/scarce_memory.h"
#include "tests/small_scene.h"

DRAW_FROM(7)

/* The render after two edits runs those that wait. */
static const char deeds[] =
    "seed 1,1,1 1; seed 10,9,8 2 radius=1; run; seed 5,5,5 3; remove 5,5,5; remove 1,1,1; run; "
    "seed-file seeds.csv; run; remove 0,0,0; render mode=bp; hide 1; show 1; "
    "label 3 liver #102030; adjacency 26; weight sobel; weight weights.nii; adjacency 6; "
    "weight heavier.nii; weight polarity; polarity 2 50; polarity 2 0; weight gauss 1.5; "
    "weight heavier.nii; seed 10,1,1 4; seed 6,1,1 4; run; remove 6,1,1; run; "
    "mask regions.nii regions=1-2; range 0 290.5; mask regions.nii regions=0-2; range none; "
    "seed 5,2,2 1; run; remove 5,2,2; mask none; weight morph radius=2; clip axial 1-8; "
    "plane 6,4,3; cut 0,0,0 5,5,5; clip none; plane none";
enum { DEEDS = 43 };

/* Undoes and redoes a command: both states must be as they were. */
static void goes_back_and_forth(struct interpreter *interp, const char *line)
{
    struct snapshot before, after;
    const unsigned failures = check_failures;
    take_snapshot(&before, interp);
    must(interp, line);
    take_snapshot(&after, interp);
    if (after.points == before.points)
        return; /* it changed nothing of the segmentation */
    must(interp, "undo");
    is_segmented_as(&before, interp);
    must(interp, "redo");
    is_segmented_as(&after, interp);
    if (check_failures > failures)
        printf("#   %s\n", line);
}

STORY(every_kind_of_command_is_undone_and_done_again)
{
    for (int by_itself = 0; by_itself < 2; by_itself++) {
        OWNED(interpreter_release) struct interpreter interp;
        struct snapshot first;
        begin_with_scene(&interp);
        must(&interp, "size 24 24");
        must(&interp, by_itself ? "auto on" : "auto off");
        take_snapshot(&first, &interp);
        OWNED(buf_release) struct buf deed = {0};
        for (const char *at = deeds; next_line(&deed, &at);)
            goes_back_and_forth(&interp, buf_text(&deed));
        CHECK(interp.history.points > DEEDS - 5);
        while (execute(&interp, "undo") == OK)
            continue;
        CHECK_HAS(fault.text, "there is nothing to undo since the scene was opened");
        must(&interp, "redo 2"); /* the two labels of the beginning */
        is_segmented_as(&first, &interp);
        must(&interp, "redo 20; redo 1000"); /* as many as there are */
        CHECK_HAS(buf_text(&reply.text), "commands could be done again, not 1000\n");
        CHECK(execute(&interp, "redo 2") == ERR_INPUT);
        MUST_MENTION(&interp, "undo 1000", "commands could be undone, not 1000\n");
        CHECK(execute(&interp, "undo") == ERR_INPUT);
    }
}

SCENE_STORY(where_one_looks_from_is_not_undone)
{
    must(interp, "seed 1,1,1 1; view left; cross 3,3,3; shade cubes");
    MUST_ANSWER(interp, "undo", "undone: 4 seed 1,1,1 1\nafter 3 label 0 background\n");
    CHECK_HAS(buf_text(&reply.words), "at=3 on=main forest=");
    CHECK_INT(session_pendings(interp->session), 0);
    CHECK_INT(interp->session->now.outlook.slices.cross[0], 3);
    CHECK(interp->session->now.outlook.look.mode != look_default().mode);
    CHECK(interp->session->now.outlook.view.angle[0] != 0);
}

SCENE_STORY(an_edit_after_undo_begins_an_alternative)
{
    /* records 1 to 3 */
    must(interp, "auto on; seed 1,1,1 1; seed 10,9,8 2; undo; seed 9,2,2 3");
    MUST_FAIL(interp, "redo", ERR_INPUT, "there is nothing to do again");
    must(interp, "goto 6"); /* what was undone is not lost */
    CHECK_HAS(buf_text(&reply.words), "at=6 ");
    must(interp, "goto 7"); /* as the undo left it */
    CHECK_HAS(buf_text(&reply.words), "at=5 ");
    MUST_FAIL(interp, "goto 0", ERR_INPUT, "expected a record 1..10, or a branch, not 0");
    CHECK(execute(interp, "goto 11") == ERR_INPUT);
    MUST_FAIL(interp, "goto somewhere", ERR_INPUT, "there is no branch somewhere");
}

/* Each edit after an undo starts from the state there and keeps no list of it. */
SCENE_STORY(an_edit_after_undo_costs_what_it_changes)
{
    enum { MARKERS = 1100, TIMES = 200, EACH = 1000 };
    must(interp, "auto on");
    for (int i = 0; i < MARKERS; i++)
        must(interp, "seed 5,5,5 3");
    const size_t before = history_memory(&interp->history);
    for (int i = 0; i < TIMES; i++) {
        must(interp, "undo; seed 5,5,5 3");
    }
    const size_t more = (history_memory(&interp->history) - before) / TIMES;
    CHECK_WITH(more < EACH, "%zu bytes each", more);
}

SCENE_STORY(names_of_many_labels_cost_what_they_change)
{
    enum { LABELS = 250, EACH = 1400 };
    char line[64];
    const size_t before = history_memory(&interp->history);
    for (int i = 1; i <= LABELS; i++) {
        snprintf(line, sizeof line, "label %d part-%d code=SCT:%d", i, i, i);
        must(interp, line);
    }
    const size_t more = (history_memory(&interp->history) - before) / LABELS;
    CHECK_WITH(more < EACH, "%zu bytes each", more);
}

SCENE_STORY(looking_back_moves_no_branch)
{
    /* records 1 to 3 */
    must(interp, "auto on; seed 1,1,1 1; seed 10,9,8 2; seed 9,2,2 3");
    MUST_MENTION(interp, "goto 5", "main stays at record 7: `goto main` leads back\n");
    must(interp, "undo"); /* one looks further back */
    must_leave_seeds(interp, "redo 2", 2);
    must_leave_seeds(interp, "goto main", 3);
    must(interp, "undo"); /* from the tip: that is a change */
    must_leave_seeds(interp, "goto 4; goto main", 2);
    must(interp, "goto 5; seed 3,3,3 1"); /* and so is a command */
    must_leave_seeds(interp, "goto 7; goto main", 2);
    CHECK(interp->session->scene->cell[grid_cell(&interp->session->scene->grid, 3, 3, 3)].flags &
          CELL_SEED);
}

SCENE_STORY(branches_have_names_and_are_left_and_found_again)
{
    must(interp, "auto on; seed 1,1,1 1; hide 1; undo; branch other");
    CHECK_TEXT(buf_text(&reply.words), "branch=other");
    must_leave_seeds(interp, "seed 10,9,8 2; seed 9,9,8 2; goto main", 1);
    must(interp, "redo"); /* along the branch one is on */
    CHECK(!interp->session->now.kept.visible[1]);
    must_leave_seeds(interp, "goto other", 3);
    MUST_ANSWER(interp, "history 3",
                "  6 hide 1   [main]\n"
                "  9 seed 10,9,8 2   (from 5)\n"
                "* 10 seed 9,9,8 2   [other]\n");
    MUST_FAIL(interp, "branch main", ERR_USAGE, "there is a branch main already");
    MUST_FAIL(interp, "branch 7up", ERR_USAGE, "begins with a letter, not 7up");
}

/* ---- random walks ---- */

static void random_line(char *line, size_t room)
{
    static const char forms[] =
        "undo [1|<1-6>]; redo <1-3>; goto <1-200>; "
        "[remove X,Y,Z radius=<2>|remove X,Y,Z radius=<2> of=tree|branch b<5>|goto b<5>]; "
        "seed X,Y,Z <4> radius=[0|0|0|<2>]; seed X,Y,Z <4> radius=[0|0|0|<2>]; "
        "seed X,Y,Z <4> radius=[0|0|0|<2>]";
    static const char settings[] =
        "run; auto [on|off]; auto [on|off]; [hide 1|show 1|hide 2]; [hide 1|show 1|hide 2]; "
        "adjacency [6|26]; adjacency [6|26]; weight [morph|weights.nii|sobel|polarity]; "
        "weight [morph|weights.nii|sobel|polarity]; weight [morph|weights.nii|sobel|polarity]; "
        "polarity 1 [30|-30]; mask [none|regions.nii regions=0-2|regions.nii]; "
        "mask [none|regions.nii regions=0-2|regions.nii]; range [0 200|none]; range [0 200|none]; "
        "clip [axial 2-7|none]; render; turn 10 5; label 1 [a|b #ff00ff]; slice axial 3";
    const char *form = below(9) < 2 ? random_form(settings, &seed) : random_form(forms, &seed);
    random_command(line, room, form, size, &seed);
}

/* Every state that a record left, to be compared with whenever it comes back. */
static struct snapshot state_at[400];

static void walk_about(struct interpreter *interp, unsigned steps)
{
    char line[100];
    for (unsigned i = 0; i < steps && check_failures < 5; i++) {
        struct snapshot now;
        random_line(line, sizeof line);
        if (session_pendings(interp->session) > 40)
            snprintf(line, sizeof line, "run");
        const size_t points = interp->history.points;
        if (execute(interp, line) != OK || interp->history.records >= 400)
            continue;
        const unsigned failures = check_failures;
        take_snapshot(&now, interp);
        const struct point *present = interp->history.point + interp->history.present;
        if (interp->history.points > points)
            state_at[present->record] = now;
        is_same_segmentation(&state_at[present->record], &now);
        if (check_failures > failures)
            printf("#   after %s\n", line);
    }
}

/* The scene alone, with a journal where one is named. */
static void begin_at_root(struct interpreter *interp, const char *journal)
{
    begin_interpreter(interp);
    if (journal)
        CHECK(interpreter_create_journal(interp, journal, &fault) == OK);
    open_scene(interp, "scene.nii");
    must(interp, "size 24 24");
}

/* Carries out the commands on the way from the root to a point, in a session that runs nothing by
 * itself. */
static void walk_straight_to(struct interpreter *interp, const struct history *history, uint32_t at)
{
    const struct point *point = history->point + at;
    if (point->parent == POINT_NONE)
        return;
    walk_straight_to(interp, history, point->parent);
    must(interp, point->command);
    if (point->seeds)
        must(interp, "run");
}

static void a_straight_way_leads_there_too(const struct interpreter *interp, uint32_t at)
{
    OWNED(interpreter_release) struct interpreter straight;
    begin_at_root(&straight, NULL);
    walk_straight_to(&straight, &interp->history, at);
    is_segmented_as(&state_at[interp->history.point[at].record], &straight);
}

STORY(random_walks_come_back_to_the_very_same_states)
{
    for (unsigned round = 0; round < 6; round++) {
        OWNED(interpreter_release) struct interpreter interp;
        begin_at_root(&interp, NULL);
        take_snapshot(&state_at[1], &interp);
        walk_about(&interp, 300);
        CHECK(interp.history.points > 60);
        for (unsigned i = 0; i < 8; i++)
            a_straight_way_leads_there_too(&interp, below((uint32_t)interp.history.points));
    }
}

/* ---- out of memory, cancelled, not recorded ---- */

/* A watch that stops after a number of looks and may have each run shown as often as possible. */
struct stopping {
    struct watch watch;
    struct session *session;
    unsigned left, shows;
};

static bool not_now(void *context, const char *what, uint64_t done, uint64_t all)
{
    struct stopping *stopping = context;
    (void)what, (void)done, (void)all;
    stopping->watch.wants_show = true;
    return stopping->left-- == 0;
}

static void draw_all(void *context)
{
    struct stopping *stopping = context;
    struct canvas canvas;
    session_count_labels(stopping->session, NULL);
    if (slicing_draw(&canvas, stopping->session, SLICE_KIND_MOSAIC, NULL, true, NULL) == OK)
        canvas_release(&canvas);
    stopping->shows++;
}

static void show_all(void *context)
{
    struct stopping *stopping = context;
    session_show(stopping->session, draw_all, stopping);
}

static void begin_with_history(struct interpreter *interp)
{
    begin_with_scene(interp);
    must(interp, "size 24 24; seed 1,1,1 1; seed 10,9,8 2; run; weight heavier.nii; "
                 "seed 5,5,5 3; remove 1,1,1; mask regions.nii regions=0-2; run; adjacency 26; "
                 "weight sobel; hide 2; render; undo 4");
}

static const char *const travels[] = {"undo",   "undo 2", "undo 4", "redo",   "redo 2",
                                      "redo 4", "goto 4", "goto 8", "goto 16"};
enum { TRAVELS = sizeof travels / sizeof travels[0] };

/* Carries a command out with ever more memory until there is enough, and goes `back` after each
 * time that it succeeds (NULL: it stays). Returns how often it failed. */
static unsigned starve_everywhere(struct interpreter *interp, const char *line, const char *back)
{
    struct snapshot before;
    unsigned refused = 0;
    take_snapshot(&before, interp);
    unsigned few = 0;
    for (; few < 80; few++) {
        fail_allocation(few);
        const enum err err = execute(interp, line);
        mem_allows = NULL;
        const bool sufficed = allocations_left <= few; /* else it wrapped when it refused */
        if (err == OK && back) {
            must(interp, back);
            take_snapshot(&before, interp);
        }
        if (err == OK && (sufficed || !back))
            break;
        if (err == OK)
            continue; /* for example without the memory for counting changes */
        CHECK(err == ERR_MEMORY);
        refused++;
        is_as_before(&before, interp, line);
    }
    CHECK(few < 80);
    return refused;
}

/* Of two threads that allocate memory of their own. */
STORY(without_memory_one_stays_where_one_is)
{
    struct interpreter interp;
    unsigned refused = 0;
    const char *threads = getenv("IFTTY_THREADS");
    OWNED(mem_release) char *kept = strdup(threads ? threads : "0");
    setenv("IFTTY_THREADS", "2", 1);
    begin_with_history(&interp);
    for (size_t i = 0; i < TRAVELS; i++)
        refused += starve_everywhere(&interp, travels[i], "goto 17");
    CHECK(refused > 3 * TRAVELS);
    interpreter_release(&interp);
    setenv("IFTTY_THREADS", kept, 1);
}

SCENE_STORY(without_memory_a_marker_stands_as_it_did)
{
    static const char *const lines[] = {"seed 5,5,5 3 radius=1", "remove 1,1,1", "remove 5,5,5",
                                        "remove 9,9,8 of=tree", "run"};
    unsigned refused = 0;
    must(interp, "seed 1,1,1 1 radius=2; seed 9,9,8 2 radius=2; run");
    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++)
        refused += starve_everywhere(interp, lines[i], NULL);
    CHECK(refused > 10);
    CHECK_INT(session_pendings(interp->session), 0);
}

/* All that looks at the scene, or at as many voxels as it may have; the first one on a forest that
 * grows by what changes. */
static const char works[] =
    "seed 6,5,5 3 radius=4; seed 1,1,1 1 radius=2 to=10,9,8; remove 6,5,5 radius=3; "
    "remove 6,5,5 of=tree; run; undo 2; redo; goto 4; weight morph radius=2; weight sobel; "
    "weight gauss 0.5; weight difference; weight polarity; polarity 2 40; seed 3,3,3 4 radius=1; "
    "weight weights.nii; adjacency 26; range 0 120; seed 2,2,2 5 radius=2; range none; "
    "mask regions.nii regions=0-2; mask none; seed-file regions.nii label=1 erode=1; "
    "seed-file seeds.csv; render mode=sp; render mode=ray; hide 1; clip axial 2-7; render; "
    "plane 6,4,3; stats; clip none; save labels labels.nii; save root root.nii.gz";

/* Carries a command out as often as it looks at the watch, each time stopped one look later, or
 * some later where it looks as `often` as it can; and at last lets it be. How often it was
 * stopped. */
static unsigned stop_everywhere(struct interpreter *interp, const char *line, bool shows,
                                bool often)
{
    struct snapshot before;
    unsigned stopped = 0;
    struct stopping stopping = {.watch = {.context = &stopping,
                                          .poll = not_now,
                                          .show = shows ? show_all : NULL,
                                          .step = often},
                                .session = interp->session};
    take_snapshot(&before, interp);
    for (unsigned looks = 0;; looks += often ? 1 + looks / (shows ? 6 : 16) : 1, stopped++) {
        stopping.left = looks;
        interp->session->watch = &stopping.watch;
        const enum err err = execute(interp, line);
        interp->session->watch = NULL;
        if (err == OK)
            break;
        CHECK_WITH(err == ERR_CANCELLED, "%s, after %u looks: %s", line, looks, fault.text);
        if (check_failures > 20)
            return stopped;
        is_as_before(&before, interp, line);
    }
    if (interp->session->has_scene)
        interp->session->scene->watch = NULL;
    return stopped;
}

BEGUN_STORY(who_is_stopped_on_the_way_is_where_he_was, begin_with_history)
{
    unsigned stopped = 0;
    for (size_t i = 0; i < TRAVELS; i++) {
        stopped += stop_everywhere(interp, travels[i], false, false);
        must(interp, "goto 17");
    }
    CHECK(stopped > 2 * TRAVELS);
}

STORY(whatever_looks_at_the_scene_is_stopped_there_and_leaves_all_as_it_was)
{
    struct interpreter interp;
    for (int by_itself = 0; by_itself < 2; by_itself++) {
        begin_with_scene(&interp);
        must(&interp, "size 24 24");
        must(&interp, by_itself ? "auto on" : "auto off");
        must(&interp, "seed 1,1,1 1; seed 10,9,8 2 radius=1; render");
        OWNED(buf_release) struct buf work = {0};
        for (const char *at = works; next_line(&work, &at);)
            if (!CHECK(stop_everywhere(&interp, buf_text(&work), by_itself, true) > 1))
                printf("#   %s\n", buf_text(&work));
        CHECK(unlink(place("labels.nii")) == 0 && unlink(place("root.nii.gz")) == 0);
        interpreter_release(&interp);
    }
}

/* Showing progress changes neither what is computed nor what is drawn later. */
STORY(what_is_shown_on_the_way_changes_nothing)
{
    OWNED(interpreter_release) struct interpreter interp, plain;
    struct snapshot shown, expected;
    begin_with_scene(&interp);
    struct stopping stopping = {.watch = {.context = &stopping, .poll = not_now, .show = show_all},
                                .session = interp.session};
    begin_with_scene(&plain);
    must(&interp, "size 24 24");
    must(&plain, "size 24 24");
    OWNED(buf_release) struct buf deed = {0};
    const char *at = deeds;
    for (size_t i = 0; i < 2 * DEEDS; i++) {
        if (i % 2 == 0)
            CHECK(next_line(&deed, &at));
        const char *line = i % 2 ? "render" : buf_text(&deed);
        const unsigned failures = check_failures;
        stopping.left = UINT_MAX;
        interp.session->watch = &stopping.watch;
        must(&interp, line);
        interp.session->watch = interp.session->scene->watch = NULL;
        must(&plain, line);
        take_snapshot(&shown, &interp);
        take_snapshot(&expected, &plain);
        is_same_segmentation(&expected, &shown);
        CHECK(interp.session->tally.stale || plain.session->tally.stale ||
              memcmp(interp.session->tally.voxels, plain.session->tally.voxels,
                     sizeof plain.session->tally.voxels) == 0);
        if (i % 2)
            CHECK(shown.picture == expected.picture);
        if (check_failures > failures)
            printf("#   %s\n", line);
    }
    CHECK(!*at && stopping.shows > 100);
}

STORY(a_scene_is_opened_and_interpolated_or_is_not)
{
    static const char *const scenes[] = {"scene.nii", "synth:geom:5x4x3"};
    for (size_t i = 0; i < sizeof scenes / sizeof *scenes; i++) {
        OWNED(interpreter_release) struct interpreter interp;
        char line[64];
        begin_interpreter(&interp);
        snprintf(line, sizeof line, "open %s", scenes[i]);
        CHECK(stop_everywhere(&interp, line, false, true) > 20);
        CHECK(stop_everywhere(&interp, "interpolate 2 1 2", true, true) > 20);
        CHECK(starve_everywhere(&interp, "interpolate 1 2 1", NULL) > 4);
    }
}

/* ---- resuming ---- */

static enum err resume(struct interpreter *interp, const char *path, bool slowly)
{
    begin_interpreter(interp);
    interp->is_read_only = true;
    interp->resumes_in_full = slowly;
    fault = (struct fault){.text = ""};
    return interpreter_resume_journal(interp, path, NULL, &fault);
}

static void has_same_history(const struct history *a, const struct history *b)
{
    if (!CHECK(a->points == b->points && a->ats == b->ats && a->branches == b->branches))
        return;
    CHECK(a->present == b->present && a->on == b->on && a->records == b->records);
    CHECK(memcmp(a->at, b->at, a->ats * sizeof *a->at) == 0);
    CHECK(memcmp(a->branch, b->branch, a->branches * sizeof *a->branch) == 0);
    for (size_t i = 0; i < a->points; i++) {
        CHECK_TEXT(a->point[i].command, b->point[i].command);
        CHECK(a->point[i].parent == b->point[i].parent && a->point[i].latest == b->point[i].latest);
        CHECK(a->point[i].seeds == b->point[i].seeds);
    }
}

/* A copy of a journal whose eliminators record `taken` under a key of what they removed, or nothing
 * if it is NULL. */
static void forge_taken(const char *from, const char *to, const char *key, const char *taken)
{
    OWNED(buf_release) struct buf bytes = {0}, out = {0}, words = {0}, header = {0};
    OWNED(walk_release) struct walk walk;
    struct record record;
    struct record_chain chain = record_chain_zero;
    CHECK(file_read(&bytes, from, JOURNAL_BYTES_MAX, NULL) == OK);
    CHECK(walk_begin(&walk, bytes.data, bytes.length, NULL) == OK);
    buf_add(&out, bytes.data, walk.header_length);
    buf_add(&header, bytes.data, walk.header_length);
    while (walk_next_sound(&walk, &record) == WALK_RECORD) {
        struct record_word word;
        buf_clear(&words);
        const char *at = record.result, *end = at + strlen(at);
        while (record_word_next(&at, end, &word)) {
            const bool took =
                key ? record_key_is(&word, key, strlen(key))
                    : record_key_is(&word, "took", 4) || record_key_is(&word, "removed", 7);
            if (took && !taken)
                continue;
            buf_printf(&words, "%s%.*s=", words.length ? " " : "", (int)word.key_length, word.key);
            buf_printf(&words, "%.*s", took ? (int)strlen(taken) : (int)word.value_length,
                       took ? taken : word.value);
        }
        const struct record anew = {
            .number = record.number, .command = record.command, .result = buf_text(&words)};
        CHECK(record_encode(&out, &chain, record.number == 1 ? buf_text(&header) : "", "", &anew,
                            NULL) == OK);
    }
    CHECK(file_write(to, out.data, out.length, FILE_REPLACE, NULL) == OK);
}

static void resumes_as(const char *path, struct interpreter *interp, bool slowly)
{
    struct snapshot expected;
    struct interpreter again;
    if (!CHECK(resume(&again, path, slowly) == OK)) {
        printf("#   %s\n", fault.text);
        interpreter_release(&again);
        return;
    }
    take_snapshot(&expected, interp);
    is_segmented_as(&expected, &again);
    CHECK(outlook_equals(&expected.outlook, &again.session->now.outlook));
    has_same_history(&interp->history, &again.history);
    for (unsigned i = 0; i < 12; i++) { /* wherever one goes from there */
        const uint32_t at = below((uint32_t)again.history.points);
        char line[40];
        snprintf(line, sizeof line, "goto %zu", again.history.point[at].record);
        const unsigned failures = check_failures;
        must(&again, line);
        is_segmented_as(&state_at[again.history.point[at].record], &again);
        if (check_failures > failures)
            printf("#   %s of %s, %s\n", line, path, slowly ? "carried out" : "skimmed");
    }
    interpreter_release(&again);
}

STORY(what_is_skimmed_is_what_was_carried_out)
{
    for (unsigned round = 0; round < 4; round++) {
        OWNED(interpreter_release) struct interpreter interp;
        char path[PATH_MAX + 8], bare[PATH_MAX + 8];
        snprintf(path, sizeof path, "%s-%u", place("walk.iftty"), round);
        snprintf(bare, sizeof bare, "%s-%u", place("bare.iftty"), round);
        begin_at_root(&interp, path);
        take_snapshot(&state_at[1], &interp);
        walk_about(&interp, 200);
        must(&interp,
             round & 1 ? "turn 3" : "run"); /* with and without the forest's word at the end */
        take_snapshot(&state_at[interp.history.point[interp.history.present].record], &interp);
        journal_close(interp.journal);
        interp.journal = NULL;
        resumes_as(path, &interp, true);
        resumes_as(path, &interp, false);
        forge_taken(path, bare, NULL, NULL);
        resumes_as(bare, &interp, false);
    }
}

static void lies_are_found(const char *before, const char *line, const char *key, const char *truth,
                           const char *const *lie, size_t lies)
{
    struct interpreter interp, again;
    char path[PATH_MAX], forged[PATH_MAX], found[80];
    snprintf(path, sizeof path, "%s", place("lies.iftty"));
    snprintf(forged, sizeof forged, "%s", place("forged.iftty"));
    unlink(path);
    begin_at_root(&interp, path);
    must(&interp, "auto on; seed 1,1,1 1; seed 10,9,8 2; seed 10,9,9 2 joined=yes");
    must(&interp, before);
    MUST_RECORD(&interp, line, truth);
    interpreter_release(&interp);
    snprintf(found, sizeof found, "record 8 (line 16) diverges: %s is %s", key, truth);
    for (size_t i = 0; i < lies; i++) {
        forge_taken(path, forged, key, lie[i]);
        CHECK(resume(&again, forged, false) == ERR_CHECK);
        CHECK_HAS(fault.text, found);
        interpreter_release(&again);
    }
    forge_taken(path, forged, key, truth);
    CHECK(resume(&again, forged, false) == OK);
    interpreter_release(&again);
}

STORY(a_journal_that_lies_is_not_resumed)
{
    static const char *const of_seeds[] = {"10,9,8",  "3,3,3",  "1,1", "99,1,1",
                                           "1,1,1;;", "-1,0,0", "x"};
    static const char *const of_markers[] = {"2",   "1-2", "3",  "4", "5",   "0",
                                             "1,1", "2-1", "1-", "x", "1,,1"};
    lies_are_found("auto on", "remove 1,2,1 of=tree", "took", "1,1,1", of_seeds,
                   sizeof of_seeds / sizeof *of_seeds);
    lies_are_found("remove 10,9,9 of=tree", "remove 1,2,1", "removed", "1", of_markers,
                   sizeof of_markers / sizeof *of_markers); /* 3 is joined, 4 erases */
}

/* ---- what is stored ---- */

STORY(what_is_put_away_comes_back)
{
    enum { BYTES = 100000 };
    static unsigned char bytes[BYTES], back[BYTES];
    for (size_t length = 0; length <= BYTES; length = length * 5 + 1) {
        for (size_t i = 0; i < length; i++)
            bytes[i] = (unsigned char)(i % 7 ? below(4) : below(256));
        struct packed *packed;
        CHECK(packed_new(&packed, bytes, length, NULL, NULL) == OK);
        packed_release(&(struct packed *){packed_hold(packed)});
        memset(back, 0, sizeof back);
        CHECK(packed_take_out(packed, back, NULL, NULL) == OK && memcmp(bytes, back, length) == 0);
        packed_release(&packed);
    }
    for (unsigned few = 0; few < 2; few++) {
        struct packed *packed;
        fail_allocation(few);
        CHECK(packed_new(&packed, bytes, 10, NULL, NULL) == ERR_MEMORY && !packed);
        mem_allows = NULL;
    }
}

/* ---- what waits to be synced ---- */

static pthread_t own;
static unsigned syncs; /* by this thread, not by the one that syncs what waits */

static int count_syncs(enum file_step step, const char *path)
{
    (void)path;
    syncs += step == FILE_STEP_SYNC && pthread_equal(pthread_self(), own);
    return 0;
}

static unsigned syncs_of(struct interpreter *interp, const char *line)
{
    syncs = 0;
    file_step_hook = count_syncs;
    must(interp, line);
    file_step_hook = NULL;
    return syncs;
}

BEGUN_STORY(only_what_changes_how_one_looks_waits_to_be_synced, begin_interpreter)
{
    static const char *const looks[] = {"turn 3",      "cross 2,2,2", "zoom 2",     "window 1 90",
                                        "shade cubes", "auto off",    "size 20 20", "view left"};
    static const char *const others[] = {
        "label 1 head", "hide 1",   "seed 1,1,1 1",   "run",    "weight sobel",        "undo",
        "goto 2",       "branch b", "clip axial 1-5", "render", "remove 1,1,1 of=tree"};
    own = pthread_self();
    CHECK(interpreter_create_journal(interp, place("syncs.iftty"), &fault) == OK);
    must(interp, "open scene.nii; seed 5,5,5 2; seed 1,1,1 1; run");
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
        const char *look = looks[i % (sizeof looks / sizeof *looks)];
        CHECK_WITH(syncs_of(interp, look) == 0, "%s", look);
        CHECK_WITH(syncs_of(interp, others[i]) >= 1, "%s", others[i]);
    }
    CHECK_INT(syncs_of(interp, "turn 4"), 0);
    CHECK(syncs_of(interp, "save labels labels.nii empty=yes") >= 1);
}

int main(void)
{
    if (!begin_folder())
        return 1;
    make_scene();
    make_weights("weights.nii", 0);
    make_weights("heavier.nii", 3);
    make_regions("regions.nii", size[0], 0);
    write_text("seeds.csv", "1,1,1,1\n10,9,8,2\n");
    int status = check_run();
    return status | end_folder();
}
