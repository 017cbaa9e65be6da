/* SPDX-License-Identifier: MIT */
/* Finished labels while one works: pictures under `finished on`, rough labels right after an edit,
 * exact ones after it, with border and rendition that follow; compared with what is made from
 * nothing. */
#include "show/slicing.h"
#include "tests/scarce_memory.h"
#include "tests/scene_main.h"

DRAW_FROM(0)

static uint64_t picture_of(struct interpreter *interp, const char *line)
{
    must(interp, line);
    /* The picture's digest among the words of the last line's record. */
    const char *word = strstr(buf_text(&reply.words), "picture=");
    CHECK(word != NULL);
    return word ? strtoull(word + 8, NULL, 16) : 0;
}

static void begin_with_objects(struct interpreter *interp)
{
    begin_with_scene(interp);
    must(interp, "size 64 60; auto on; seed 2,2,2 0; seed 8,8,7 1 radius=1; "
                 "seed 3,8,3 2 radius=1");
}

/* ---- commands ---- */

BEGUN_STORY(pictures_are_finished_where_finished_is_on, begin_with_objects)
{
    static const char *const shown[] = {"render", "slice axial", "slice coronal", "mosaic"};
    char line[64];
    must(interp, "finish majority radius=2");
    for (size_t i = 0; i < sizeof shown / sizeof shown[0]; i++) {
        snprintf(line, sizeof line, "%s finished=yes", shown[i]);
        must(interp, "finished off");
        const uint64_t plain = picture_of(interp, shown[i]), asked = picture_of(interp, line);
        CHECK(plain != asked);
        must(interp, "finished on");
        CHECK(picture_of(interp, shown[i]) == asked);
        CHECK_HAS(buf_text(&reply.words), "finished=");
        CHECK(picture_of(interp, line) == asked);
        snprintf(line, sizeof line, "%s finished=no", shown[i]);
        CHECK(picture_of(interp, line) == plain && picture_of(interp, shown[i]) == asked);
    }
}

BEGUN_STORY(every_way_to_draw_finished_labels_gives_the_same, begin_with_objects)
{
    static const char *const mode[] = {"render mode=sp", "render mode=bp", "render mode=ii",
                                       "render mode=ray"};
    must(interp, "finish relax sweeps=20; finished on");
    const uint64_t first = picture_of(interp, "render");
    for (size_t i = 0; i < sizeof mode / sizeof mode[0]; i++)
        CHECK(picture_of(interp, mode[i]) == first);
    must(interp, "seed 8,9,8 2 radius=2");
    CHECK(picture_of(interp, "render mode=ii") != first);
    must(interp, "undo");
    CHECK(picture_of(interp, "render mode=ii") == first);
}

BEGUN_STORY(finished_says_what_pictures_show, begin_with_objects)
{
    MUST_MENTION(interp, "finished on", "the finish has no step yet; `finish relax` adds one");
    const uint64_t plain = picture_of(interp, "render");
    MUST_ANSWER(interp, "finish relax", "finish    relax sweeps=20 reach=2; pictures show it\n");
    CHECK(picture_of(interp, "render") != plain);
    MUST_MENTION(interp, "info", "finish    relax sweeps=20 reach=2; pictures show it\n");
    MUST_MENTION(interp, "save labels x.nii",
                 "`finished=yes` writes the labels shown in pictures\n");
    must(interp, "save labels x.nii finished=yes replace=yes");
    CHECK(!strstr(buf_text(&reply.text), "pictures show"));
    MUST_ANSWER(interp, "finished off", "pictures show the labels of the forest\n");
    CHECK(picture_of(interp, "render") == plain);
}

/* The pixels that a pick names are those of the picture that is shown. */
BEGUN_STORY(what_is_picked_is_what_is_shown, begin_with_objects)
{
    char line[64];
    unsigned others = 0;
    must(interp, "finish majority radius=2; finished on; render");
    const struct session *session = interp->session;
    for (uint32_t row = 0; row < 60; row++)
        for (uint32_t column = 0; column < 64; column++) {
            const struct rendition *frame = session_frame(session);
            const uint8_t label = frame->label[row * 64 + column];
            const uint32_t cell = frame->cell[row * 64 + column];
            snprintf(line, sizeof line, "pick %u %u", column, row);
            must(interp, line);
            const bool differs = cell != CELL_NONE && session->scene->cell[cell].label != label;
            CHECK(!strstr(buf_text(&reply.text), "finished: label") == !differs);
            others += differs;
        }
    CHECK(others > 0);
}

/* ---- panels ---- */

static void draw_panel(struct interpreter *interp)
{
    struct slicing_panel panel = {.screen = {320, 320, 8, 16, true, MOSAIC_AXIAL}};
    struct canvas canvas = {0};
    if (CHECK(slicing_draw_panel(&canvas, interp->session, &panel, &fault) == OK))
        canvas_release(&canvas);
}

enum { CELLS = 14 * 13 * 12 };

/* Rough labels: the forest's where those have changed, else as they were; or the forest's. */
static bool are_rough(const struct session *session, const uint8_t forest[CELLS],
                      const uint8_t shown[CELLS])
{
    bool follows = true, is_forest = true;
    for (uint32_t c = 0; c < CELLS; c++) {
        const uint8_t label = session->scene->cell[c].label, now = session->pictures->live.label[c];
        follows = follows && now == (label != forest[c] ? label : shown[c]);
        is_forest = is_forest && now == label;
    }
    return follows || is_forest;
}

/* What is shown is what is made from nothing. */
static void is_exact(struct interpreter *interp)
{
    struct session *session = interp->session;
    uint8_t *label;
    CHECK(!session_is_rough(session));
    CHECK(finish_make(&label, &session->now.kept.finish, session->scene, NULL, NULL, NULL) == OK);
    CHECK(memcmp(label, session->pictures->live.label, CELLS) == 0);
    mem_pages_free(label, CELLS);
    CHECK(border_check(&session->pictures->live.border, NULL));
    draw_panel(interp);
    CHECK_INT(session_rendered(session), RENDERED_FINISHED);
    const uint64_t shown = rendition_digest(&session->pictures->rendition);
    session->inside->follower->forget(session->pictures);
    draw_panel(interp);
    CHECK(rendition_digest(&session->pictures->rendition) == shown);
}

static int looks_left;
static bool stop_after(void *context, const char *what, uint64_t done, uint64_t total)
{
    (void)context, (void)what, (void)done, (void)total;
    return looks_left-- <= 0;
}

/* Interrupted again and again, it changes nothing, and gets there in the end. */
static void refine(struct interpreter *interp)
{
    struct session *session = interp->session;
    uint8_t before[CELLS];
    enum err err = ERR_CANCELLED;
    for (looks_left = (int)below(6); err == ERR_CANCELLED;) {
        struct watch watch = {.poll = stop_after, .step = 1 + below(3000)};
        const int looks = looks_left;
        memcpy(before, session->pictures->live.label, CELLS);
        err = session_refine(session, &watch, NULL);
        CHECK(err == OK || memcmp(before, session->pictures->live.label, CELLS) == 0);
        CHECK(err == OK || session_is_rough(session));
        looks_left = 2 * looks + 1;
    }
    CHECK_INT(err, OK);
}

static void write_line(char line[96])
{
    const uint32_t x = below(size[0]), y = below(size[1]), z = below(size[2]);
    switch (below(14)) {
    case 0:
        snprintf(line, 96, "remove %u,%u,%u", x, y, z);
        break;
    case 1:
        snprintf(line, 96, "%s %u", below(2) ? "undo" : "redo", 1 + below(3));
        break;
    case 2:
        snprintf(line, 96, "%s %u", below(2) ? "hide" : "show", 1 + below(3));
        break;
    case 3:
        snprintf(line, 96, below(2) ? "clip axial 1-7" : "clip none");
        break;
    case 4:
        snprintf(line, 96, "turn %u %u", below(90), below(40));
        break;
    case 5:
        snprintf(line, 96, below(2) ? "finish relax sweeps=%u" : "finish majority", 1 + below(30));
        break;
    case 6:
        snprintf(line, 96, below(3) ? "range 5 %u" : "range none", 100 + below(60));
        break;
    case 7:
        snprintf(line, 96, below(3) ? "render" : "finished off");
        break;
    default:
        snprintf(line, 96, "seed %u,%u,%u %u radius=%u", x, y, z, below(4), below(3));
        break;
    }
}

/* Volumes are of the labels that are shown, and before an edit of those that were shown then. */
static void are_counted(struct session *session, const uint64_t *was)
{
    const uint64_t *before, *voxels = session_shown_voxels(session, &before);
    const struct labels *labels = &session->pictures->live.border.labels;
    struct label_sums sums;
    CHECK(labels->finished == session->pictures->live.label && labels->finished != NULL);
    if (!CHECK(voxels != NULL))
        return;
    CHECK(!session->pictures->live.tally.stale &&
          tally_check(&session->pictures->live.tally, labels));
    for (unsigned label = 1; label < 4; label++) {
        CHECK(session_sum_shown(session, label, &sums, NULL) == OK);
        CHECK_INT(sums.voxels, voxels[label]);
    }
    if (was)
        CHECK(before && memcmp(before, was, 256 * sizeof *was) == 0);
}

/* An edit, or a look, and what is shown at once; then, mostly, what is exact. */
static bool goes_on(struct interpreter *interp)
{
    struct session *session = interp->session;
    uint8_t forest[CELLS], shown[CELLS];
    const uint64_t *before;
    uint64_t was[256];
    char line[96];
    draw_panel(interp);
    memcpy(was, session_shown_voxels(session, &before), sizeof was);
    CHECK_INT(session->scene->grid.cells, CELLS);
    for (uint32_t c = 0; c < CELLS; c++)
        forest[c] = session->scene->cell[c].label;
    memcpy(shown, session->pictures->live.label, CELLS);
    write_line(line);
    execute(interp, line); /* there may be nothing to undo, or to remove */
    if (!session_shows_finished(session))
        return false;
    draw_panel(interp);
    const bool is_rough = session_is_rough(session);
    const bool edited = session->has_edited || session->has_regrown;
    are_counted(session, edited ? was : NULL);
    CHECK(border_check(&session->pictures->live.border, NULL));
    CHECK_WITH(!is_rough || are_rough(session, forest, shown), "%s", line);
    if (below(3)) {
        refine(interp);
        is_exact(interp);
        are_counted(session, edited ? was : NULL);
        must(interp, "cross 3,3,3");
        are_counted(session, edited ? was : NULL);
    }
    return is_rough;
}

BEGUN_STORY(what_is_shown_follows_each_edit_and_is_exact_in_the_end, begin_with_objects)
{
    enum { ROUNDS = 250 };
    unsigned roughs = 0;
    for (unsigned round = 0; round < ROUNDS; round++) {
        seed = round;
        if (interp->session->now.kept.finish.count > 4)
            must(interp, "finish none");
        if (interp->session->now.kept.finish.count == 0)
            must(interp, "finish relax sweeps=7");
        if (!interp->session->now.outlook.shows_finished)
            must(interp, "finished on");
        roughs += goes_on(interp);
    }
    CHECK(roughs > ROUNDS / 3);
}

BEGUN_STORY(labels_of_an_object_that_fills_the_scene_are_exact_at_once, begin_with_scene)
{
    must(interp, "size 64 60; auto on; finish relax sweeps=7; finish open radius=3; finish holes; "
                 "finish majority; finish close; finish components voxels=9; finished on");
    must(interp, "seed 2,2,2 1");
    draw_panel(interp);
    is_exact(interp); /* nothing was finished */
    CHECK(!session_finished(interp->session));
    must(interp, "seed 8,8,7 0 radius=1");
    draw_panel(interp);
    CHECK(session_is_rough(interp->session));
    must(interp, "undo");
    draw_panel(interp);
    is_exact(interp);
}

BEGUN_STORY(labels_finished_before_are_there_at_once_after_undo_and_redo, begin_with_objects)
{
    static const char *const lines[] = {"undo", "redo", "undo"};
    must(interp, "finish relax sweeps=7; finished on");
    draw_panel(interp);
    refine(interp);
    must(interp, "seed 8,9,8 2 radius=2");
    draw_panel(interp);
    CHECK(session_is_rough(interp->session));
    refine(interp);
    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++) {
        must(interp, lines[i]);
        draw_panel(interp);
        is_exact(interp);
    }
}

BEGUN_STORY(memory_that_runs_out_leaves_what_is_shown, begin_with_objects)
{
    struct slicing_panel panel = {.screen = {320, 320, 8, 16, true, MOSAIC_AXIAL}};
    size_t refused = 0;
    enum err err = ERR_MEMORY;
    must(interp, "finish relax sweeps=5; finished on");
    for (size_t n = 0; err == ERR_MEMORY && n < 1000; n++, refused++) {
        OWNED(canvas_release) struct canvas canvas = {0};
        allow_allocations(n);
        err = slicing_draw_panel(&canvas, interp->session, &panel, &fault);
        if (!err)
            err = session_refine(interp->session, NULL, &fault);
        mem_allows = NULL;
    }
    CHECK(err == OK && refused > 15);
    is_exact(interp);
}
