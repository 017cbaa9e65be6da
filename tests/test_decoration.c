/* SPDX-License-Identifier: MIT */
/* Decorations: letters are never wrong, the bar has the length it states, hidden seeds have no
 * marks, and only colours change, in every way of drawing. */
#include "render/decoration.h"
#include "show/decorating.h"
#include "show/slicing.h"
#include "tests/folder_main.h"
#include "tests/interpreting.h"
#include "tests/stage.h"

/* ---- by themselves ---- */

enum { SIDE = 41 };

static void begin(struct stage *s, uint64_t *random)
{
    CHECK(stage_init(s, (uint32_t[]){SIDE, SIDE, SIDE}, 6, NULL) == OK);
    stage_turn(s, check_below(random, 6), check_below(random, 8));
    for (int a = 0; a < 3; a++) {
        s->view.angle[a] = (int32_t)check_below(random, check_below(random, 2) ? 360000 : 4);
        s->view.angle[a] *= s->view.angle[a] < 4 ? 90000 : 1;
    }
    s->view.width = s->view.height = 128;
    CHECK(camera_init(&s->camera, s->scene, &s->view, NULL) == OK);
}

/* Return the voxel ten steps from the middle towards a side of the patient: R L A P S I. */
static uint32_t towards(const struct stage *s, char side)
{
    uint32_t at[3] = {SIDE / 2, SIDE / 2, SIDE / 2};
    const int n = (int)(strchr("RLAPSI", side) - "RLAPSI");
    for (int a = 0; a < 3; a++)
        if (s->scene->world_axis[a] == n / 2)
            at[a] += (uint32_t)((n % 2 ? -10 : 10) * s->scene->world_sign[a]);
    return grid_cell(&s->scene->grid, at[0], at[1], at[2]);
}

/* Return the offset of a voxel from the middle, to the right and down, in pixels. */
static void from_middle(const struct stage *s, uint32_t cell, double along[2])
{
    const struct grid *grid = &s->scene->grid;
    const uint32_t middle = grid_cell(grid, SIDE / 2, SIDE / 2, SIDE / 2);
    int64_t from[3], to[3];
    project_place(&s->camera, grid_place(grid, middle), from);
    project_place(&s->camera, grid_place(grid, cell), to);
    for (int i = 0; i < 2; i++)
        along[i] = (double)(to[i] - from[i]) / (1 << 30);
}

/* Every named side is at its edge, further than the sides named after it, and every side further
 * than 3.9 of ten pixels is named. */
STORY(letters_name_the_sides_that_lie_there)
{
    uint64_t random = 5;
    for (int round = 0; round < 400; round++) {
        OWNED(stage_release) struct stage s;
        char word[4][DECORATION_WORD];
        begin(&s, &random);
        decoration_sides(word, &s.camera);
        for (int edge = 0; edge < 4; edge++) {
            double former = 11;
            for (const char *side = "RLAPSI"; *side; side++) {
                double along[2];
                from_middle(&s, towards(&s, *side), along);
                const double there = edge % 2 ? along[edge / 2] : -along[edge / 2];
                CHECK(there < 3.9 || strchr(word[edge], *side));
                CHECK(there > 3.7 || !strchr(word[edge], *side));
            }
            for (const char *side = word[edge]; *side; side++) {
                double along[2];
                from_middle(&s, towards(&s, *side), along);
                const double there = edge % 2 ? along[edge / 2] : -along[edge / 2];
                CHECK(there <= former + 0.01);
                former = there;
            }
        }
    }
}

STORY(of_unknown_orientation_the_axes_are_named)
{
    uint64_t random = 1;
    OWNED(stage_release) struct stage s;
    char word[4][DECORATION_WORD];
    begin(&s, &random);
    s.scene->sides_unknown = true;
    memset(s.view.angle, 0, sizeof s.view.angle);
    CHECK(camera_init(&s.camera, s.scene, &s.view, NULL) == OK);
    decoration_sides(word, &s.camera);
    CHECK_TEXT(word[0], "+x");
    CHECK_TEXT(word[1], "-x");
    CHECK_TEXT(word[2], "+z");
    CHECK_TEXT(word[3], "-z");
}

/* From the front, with samples, for voxels of 0.7 mm. */
STORY(the_bar_is_as_long_as_it_says)
{
    OWNED(stage_release) struct stage s;
    uint64_t random = 1;
    begin(&s, &random);
    memset(s.view.angle, 0, sizeof s.view.angle);
    for (uint32_t zoom = 100; zoom <= 16000; zoom = zoom * 5 / 3)
        for (uint32_t samples = 1; samples <= 4; samples *= 2)
            for (int unknown = 0; unknown < 2; unknown++) {
                char words[32] = "";
                char *end;
                for (int a = 0; a < 3; a++)
                    s.scene->spacing_nm[a] = 700000;
                s.scene->spacing_unknown = unknown;
                s.view.zoom = zoom * samples;
                s.view.width = s.view.height = 300 * samples;
                CHECK(camera_init(&s.camera, s.scene, &s.view, NULL) == OK);
                const int64_t pixels = decoration_scale(words, &s.camera, samples, 300);
                const double length = strtod(words, &end);
                const double voxels = unknown ? length : length / 0.7;
                CHECK(pixels > 25 && pixels <= 76);
                CHECK(llabs(pixels - (int64_t)(voxels * zoom / 1000 + 0.5)) <= 1);
                CHECK_TEXT(end, !unknown ? " mm" : length == 1 ? " voxel" : " voxels");
            }
    s.scene->spacing_nm[1] = 900000; /* unknown and anisotropic: no bar */
    CHECK(camera_init(&s.camera, s.scene, &s.view, NULL) == OK);
    char words[32];
    CHECK_INT(decoration_scale(words, &s.camera, 1, 300), 0);
}

/* Pictures of any size, with any number of labels. */
STORY(every_size_has_what_fits)
{
    static const uint32_t side[] = {1, 47, 48, 128, 191, 512, 2048};
    struct legend_line line[255];
    OWNED(stage_release) struct stage s;
    uint64_t random = 9;
    begin(&s, &random);
    for (int i = 0; i < 255; i++) {
        line[i].label = (uint8_t)(i + 1);
        snprintf(line[i].name, sizeof line[i].name, "a name of thirty letters.....%d", i % 10);
        snprintf(line[i].amount, sizeof line[i].amount, "12.3 ml");
    }
    for (size_t i = 0; i < sizeof side / sizeof *side; i++)
        for (size_t lines = 0; lines <= 255; lines += 51) {
            OWNED(canvas_release) struct canvas canvas;
            s.view.width = side[i], s.view.height = side[sizeof side / sizeof *side - 1 - i];
            CHECK(camera_init(&s.camera, s.scene, &s.view, NULL) == OK);
            rendition_release(&s.rendition);
            CHECK(rendition_init(&s.rendition, s.view.width, s.view.height, NULL) == OK);
            rendition_clear(&s.rendition);
            CHECK(canvas_init(&canvas, s.view.width, s.view.height, 0, NULL) == OK);
            memset(canvas.rgba, 0, (size_t)4 * canvas.width * canvas.height);
            const struct decoration d = {.parts = DECORATE_ALL,
                                         .frame = &s.rendition,
                                         .camera = &s.camera,
                                         .samples = 1,
                                         .palette = &s.palette,
                                         .line = line,
                                         .lines = lines,
                                         .cross = grid_cell(&s.scene->grid, 1, 2, 3),
                                         .is_bright = lines % 2};
            CHECK(decoration_draw(&canvas, &d, NULL) == OK);
            size_t drawn = 0;
            for (size_t p = 0; p < (size_t)canvas.width * canvas.height; p++) {
                const uint8_t *rgba = canvas.rgba + 4 * p;
                CHECK(rgba[3] || (!rgba[0] && !rgba[1] && !rgba[2]));
                drawn += rgba[3] > 0;
            }
            CHECK(drawn > 0 || canvas.width < 48 || canvas.height < 48);
        }
}

/* ---- in a session ---- */

static void begin_with_object(struct interpreter *interp)
{
    begin_interpreter(interp);
    must(interp, "open synth:geom:40x40x20; seed 20,20,10 1 radius=3; seed 1,1,1 0; "
                 "label 1 ball; size 140 130; zoom 3; run");
}

/* Return `picture=` of a rendition. */
static uint64_t digest_of(struct interpreter *interp, const char *line)
{
    must(interp, line);
    const char *word = strstr(buf_text(&reply.words), "picture=");
    CHECK(word != NULL);
    return word ? strtoull(word + 8, NULL, 16) : 0;
}

BEGUN_STORY(every_way_of_drawing_has_the_same_and_none_takes_all_away, begin_with_object)
{
    static const char *const mode[] = {"render mode=sp", "render mode=bp", "render mode=ray",
                                       "render mode=ii", "render"};
    for (int samples = 1; samples <= 4; samples *= 4) {
        must(interp, samples == 1 ? "samples 1" : "samples 4");
        const uint64_t plain = digest_of(interp, "render");
        must(interp, "decorate all");
        const uint64_t decorated = digest_of(interp, "render");
        CHECK(decorated != plain);
        for (size_t i = 0; i < sizeof mode / sizeof *mode; i++)
            CHECK(digest_of(interp, mode[i]) == decorated);
        must(interp, "seed 30,20,10 1 radius=2"); /* nothing must be drawn twice */
        const uint64_t after = digest_of(interp, "render");
        CHECK(digest_of(interp, "render mode=bp") == after);
        must(interp, "undo");
        CHECK(digest_of(interp, "render") == decorated);
        must(interp, "decorate none");
        CHECK(digest_of(interp, "render") == plain);
    }
}

BEGUN_STORY(what_is_below_stays_what_it_is, begin_with_object)
{
    must(interp, "render");
    const struct rendition *frame = session_frame(interp->session);
    const uint64_t before = rendition_digest(frame);
    must(interp, "decorate all; render");
    const struct rendition shown = session_picture(interp->session);
    CHECK(rendition_digest(session_frame(interp->session)) == before);
    CHECK(shown.cell == frame->cell && shown.depth == frame->depth && shown.rgba != frame->rgba);
    MUST_MENTION(interp, "info", ", decorate letters scale legend seeds cross, ");
    MUST_MENTION(interp, "decorate scale letters; info", ", decorate letters scale, ");
}

/* Seeds and cross-hair are inside, until the object is cut open in front of them. */
BEGUN_STORY(what_no_pixel_shows_has_no_mark, begin_with_object)
{
    static const char *const part[] = {"decorate seeds", "decorate cross"};
    must(interp, "view top; cross 20,20,10");
    for (int i = 0; i < 2; i++) {
        must(interp, "decorate none");
        const uint64_t plain = digest_of(interp, "render");
        must(interp, part[i]);
        CHECK(digest_of(interp, "render") == plain);
        must(interp, "clip axial 0-10");
        const uint64_t marked = digest_of(interp, "render");
        must(interp, "decorate none");
        CHECK(digest_of(interp, "render") != marked);
        must(interp, "clip none");
    }
}

/* Only the seeds of a piece of a file are visible: marks would surround its silhouette, and in
 * slices its contour. */
STORY(seeds_of_a_files_pieces_have_no_marks_and_those_that_are_placed_do)
{
    char save[FILE_LENGTH + 16], labels[FILE_LENGTH + 16];
    OWNED(interpreter_release) struct interpreter interp;
    snprintf(save, sizeof save, "save labels %s", file_in(folder, "map.nii"));
    snprintf(labels, sizeof labels, "labels %s", file_in(folder, "map.nii"));
    begin_with_object(&interp);
    must(&interp, save);
    interpreter_release(&interp);
    begin_interpreter(&interp);
    must(&interp, "open synth:geom:40x40x20; size 140 130; zoom 3; view 40 30");
    must(&interp, labels);
    must(&interp, "run");
    for (int placed = 0; placed < 2; placed++) {
        must(&interp, "decorate none; overlay marks=off");
        const uint64_t plain = digest_of(&interp, "render");
        const uint64_t slice = digest_of(&interp, "slice axial 10");
        must(&interp, "decorate seeds; overlay marks=on");
        CHECK((digest_of(&interp, "render") != plain) == placed);
        CHECK((digest_of(&interp, "slice axial 10") != slice) == placed);
        const uint32_t at = grid_cell(&interp.session->scene->grid, 20, 20, 10);
        CHECK(!(interp.session->scene->cell[at].flags & CELL_SEED) == !placed);
        must(&interp, "seed 20,20,10 1 radius=12"); /* reaches the surface */
        must(&interp, "run");
    }
}

BEGUN_STORY(mosaics_are_not_decorated_and_what_is_no_part_is_refused, begin_with_object)
{
    const uint64_t plain = digest_of(interp, "mosaic");
    must(interp, "decorate all; render");
    CHECK(digest_of(interp, "mosaic") == plain);
    must(interp, "decorate scale");
    CHECK(execute(interp, "decorate none letters") == ERR_USAGE);
    CHECK(execute(interp, "decorate") == ERR_USAGE);
    CHECK(execute(interp, "decorate cube") == ERR_USAGE);
    CHECK_INT(interp->session->now.outlook.decorations, DECORATE_SCALE);
    must(interp, "decorate cross seeds legend scale letters");
    CHECK_INT(interp->session->now.outlook.decorations, DECORATE_ALL);
}
