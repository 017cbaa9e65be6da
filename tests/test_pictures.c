/* SPDX-License-Identifier: MIT */
/* Pictures of commands: their content, and how they are written to the disk. */
#include <math.h>

#include "journal/journal.h"
#include "base/file.h"
#include "base/version.h"
#include "image/exr.h"
#include "image/picture_writer.h"
#include "show/export_picture.h"
#include "tests/interpreting.h"
#define RUN_IN_FOLDER
#include "tests/folder_main.h"
#include "tests/stopping.h"

static void is_refused(struct interpreter *interp, const char *line, enum err code,
                       const char *words)
{
    CHECK_INT(execute(interp, line), code);
    CHECK_HAS(fault.text, words);
}

static void begin_with_object(struct interpreter *interp)
{
    begin_interpreter(interp);
    must(interp, "open synth:geom:40x40x20; seed 20,20,10 1 radius=3; seed 1,1,1 0; "
                 "size 90 70; run; render");
}

/* ---- content ---- */

BEGUN_STORY(an_exr_in_tiles_holds_what_one_in_lines_holds, begin_with_object)
{
    OWNED(picture_release) struct picture lines, tiles;
    must(interp, "render lines.exr; render same.exr layout=lines; "
                 "render tiles.exr layout=tiled");
    CHECK_INT(exr_read(&lines, "lines.exr", NULL), OK);
    CHECK_INT(exr_read(&tiles, "tiles.exr", NULL), OK);
    CHECK(!lines.tiled && tiles.tiled);
    const size_t bytes = (size_t)4 * 90 * 70;
    CHECK(memcmp(lines.rgba, tiles.rgba, bytes) == 0);
    CHECK(memcmp(lines.depth_mm, tiles.depth_mm, bytes) == 0);
    CHECK(memcmp(lines.label, tiles.label, bytes) == 0);
    CHECK(memcmp(lines.voxel, tiles.voxel, bytes) == 0);
    CHECK(memcmp(lines.normal, tiles.normal, 3 * bytes) == 0);
    is_refused(interp, "render a.png layout=tiled", ERR_USAGE, "only an .exr has lines or tiles");
    is_refused(interp, "render layout=tiled", ERR_USAGE, "only an .exr has lines or tiles");
    CHECK(!file_exists("a.png"));
}

BEGUN_STORY(normals_are_unit_vectors_that_face_the_viewer, begin_with_object)
{
    static const struct {
        const char *view;
        int axis, sign;
    } side[] = {{"view front", 1, 1}, {"view left", 0, -1}, {"view top", 2, 1}};
    struct picture p;
    for (size_t k = 0; k < 3; k++) {
        double towards = 0;
        size_t seen = 0, odd = 0;
        must(interp, side[k].view);
        must(interp, "render normals.exr replace=yes");
        CHECK_INT(exr_read(&p, "normals.exr", NULL), OK);
        for (size_t i = 0; i < (size_t)p.width * p.height; i++) {
            const float *n = p.normal + 3 * i;
            const double square = (double)(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
            const bool shows = p.label[i] != 0;
            odd += shows ? square < 0.998 || square > 1.002 : square > 0;
            seen += shows;
            towards += (double)n[side[k].axis] * side[k].sign;
        }
        CHECK(seen > 100);
        CHECK_INT(odd, 0);
        CHECK(towards > 0.5 * (double)seen);
        picture_release(&p);
    }
}

BEGUN_STORY(a_picture_says_what_it_is_of, begin_interpreter)
{
    OWNED(picture_release) struct picture p;
    CHECK_INT(interpreter_create_journal(interp, "notes.iftty", &fault), OK);
    must(interp, "open synth:geom:40x40x20; view 30 20 10");
    char chain[64], scene[32];
    snprintf(chain, sizeof chain, "%s", journal_chain(interp->journal));
    snprintf(scene, sizeof scene, "%016llx", (unsigned long long)interp->session->scene_digest);
    must(interp, "render notes.exr");
    CHECK_INT(exr_read(&p, "notes.exr", NULL), OK);
    const struct {
        const char *name, *value;
    } note[] = {{"Software", "iftty " PROGRAM_VERSION},
                {"iftty:scene-name", "synth:geom:40x40x20"},
                {"iftty:scene", scene},
                {"iftty:journal", "notes.iftty"},
                {"iftty:chain", chain}};
    for (size_t i = 0; i < sizeof note / sizeof note[0]; i++) {
        const char *value = picture_find(&p, note[i].name);
        CHECK_TEXT(value ? value : note[i].name, note[i].value);
    }
    const char *view = picture_find(&p, "iftty:view");
    CHECK_HAS(view ? view : "", "yaw 30 pitch 20 roll 10 degrees, zoom ");
    const char *look = picture_find(&p, "iftty:look");
    CHECK_HAS(look ? look : "", "shade surface, light -25 30, cue 30, ");
}

/* Visible labels, with their names and colours; and the scale. */
BEGUN_STORY(a_picture_says_which_labels_it_shows, begin_with_object)
{
    OWNED(picture_release) struct picture p;
    must(interp, "label 1 core #102030; label 2 unseen; zoom 2; render labels.exr");
    CHECK_INT(exr_read(&p, "labels.exr", NULL), OK);
    CHECK_TEXT(picture_find(&p, "iftty:labels"),
               "{\"1\": {\"name\": \"core\", \"colour\": \"#102030\"}}");
    CHECK_TEXT(picture_find(&p, "iftty:mm-per-pixel"), "0.5");
    CHECK(p.is_associated);
}

/* ---- where it was seen from ---- */

static void by_matrix(double out[3], const double point[3], const float matrix[4][4])
{
    for (int i = 0; i < 3; i++) {
        out[i] = (double)matrix[3][i];
        for (int w = 0; w < 3; w++)
            out[i] += point[w] * (double)matrix[w][i];
    }
}

/* Check that the voxel of each pixel is at the position of the pixel and its depth: its middle
 * within a voxel and a half, since surfaces are smoothed; a few are further away (MESH_BEYOND).
 * Returns the number of pixels. */
static size_t check_places(const struct picture *p, const struct session *session)
{
    const struct grid *grid = &session->scene->grid;
    const double scale = 1 / (seen_mm_per_pixel(session));
    size_t seen = 0, further = 0;
    for (size_t i = 0; i < (size_t)p->width * p->height; i++) {
        if (p->voxel[i] == UINT32_MAX)
            continue;
        const uint32_t v = p->voxel[i];
        const uint32_t place[3] = {v % grid->size[0], v / grid->size[0] % grid->size[1],
                                   v / grid->size[0] / grid->size[1]};
        double point[3], camera[3], ndc[3];
        geometry_point(&session->geometry, place, point);
        by_matrix(camera, point, p->space.to_camera);
        by_matrix(ndc, point, p->space.to_ndc);
        const double depth = (double)p->depth_mm[i] + p->space.eye_mm;
        const double right = fabs(ndc[0] * p->width - (double)(i % p->width) - 0.5) / scale;
        const double down = fabs(ndc[1] * p->height - (double)(i / p->width) - 0.5) / scale;
        const double behind = fabs(camera[2] - depth);
        CHECK(depth > 0 && behind < 2.2 && right < 2.2 && down < 2.2);
        further += behind > 1.5 || right > 1.5 || down > 1.5;
        seen++;
    }
    CHECK(further * 200 < seen);
    return seen;
}

/* Read `length` bytes after a mark in a file; false without the mark. */
static bool after_mark(const char *path, const char *mark, size_t length, size_t skipped, void *out,
                       size_t bytes)
{
    OWNED(buf_release) struct buf file = {0};
    bool fine = file_read(&file, path, 1 << 24, NULL) == OK;
    const char *at = fine ? memmem(buf_text(&file), file.length, mark, length) : NULL;
    fine = at && at + length + skipped + bytes <= buf_text(&file) + file.length;
    if (fine)
        memcpy(out, at + length + skipped, bytes);
    return fine;
}

/* The camera of Blender and Nuke is a rotation, and a place: a pixel is where x to the right, y up
 * and Z ahead, against the third axis, lead from there. */
BEGUN_STORY(an_exr_has_a_camera_that_is_a_rotation, begin_with_object)
{
    static const char mark[] = "iftty:cameraToWorld\0m44f";
    OWNED(picture_release) struct picture p;
    float m[16];
    must(interp, "view 77 -31 140; render camera.exr");
    CHECK_INT(export_picture(&p, interp->session, PICTURE_BUT_NORMAL, NULL), OK);
    CHECK(after_mark("camera.exr", mark, sizeof mark, 4, m, sizeof m));
    const double a = (double)m[0], b = (double)m[1], c = (double)m[2], d = (double)m[4],
                 e = (double)m[5], f = (double)m[6], g = (double)m[8], h = (double)m[9],
                 i = (double)m[10];
    const double determinant = a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g);
    CHECK(fabs(determinant - 1) < 1e-5);
    const double mm = seen_mm_per_pixel(interp->session);
    const struct picture_space *space = &((const struct picture *)&p)->space;
    for (uint32_t y = 5; y < p.height; y += 20)
        for (uint32_t x = 5; x < p.width; x += 20) {
            const double z = 3 + x, from[3] = {(x + 0.5 - p.width / 2.0) * mm,
                                               (p.height / 2.0 - y - 0.5) * mm, -z};
            double world[3], ndc[3], camera[3];
            for (int w = 0; w < 3; w++)
                world[w] = from[0] * (double)m[w] + from[1] * (double)m[4 + w] +
                           from[2] * (double)m[8 + w] + (double)m[12 + w];
            by_matrix(ndc, world, space->to_ndc);
            by_matrix(camera, world, space->to_camera);
            CHECK(fabs(ndc[0] * p.width - x - 0.5) < 0.01);
            CHECK(fabs(ndc[1] * p.height - y - 0.5) < 0.01 && fabs(camera[2] - z) < 0.01);
        }
}

/* Pixels per metre of the scene, the same in both directions, and perceptual intent for colours. An
 * unknown scale is omitted. */
BEGUN_STORY(a_png_says_how_large_it_is_and_what_its_colours_are, begin_with_object)
{
    uint8_t scale[9], intent[1];
    must(interp, "zoom 2; render scale.png");
    CHECK(after_mark("scale.png", "pHYs", 4, 0, scale, sizeof scale));
    CHECK(memcmp(scale, "\0\0\x07\xd0\0\0\x07\xd0\1", 9) == 0);
    CHECK(after_mark("scale.png", "sRGB", 4, 0, intent, 1) && intent[0] == 0);
    interp->session->geometry.spacing_unknown = true;
    must(interp, "render scale.png replace=yes");
    CHECK(!after_mark("scale.png", "pHYs", 4, 0, scale, sizeof scale));
}

/* An oblique scene: turned by 30 degrees about z, then 20 about x. */
static const double oblique[3][4] = {{0.866025404, -0.5, 0, 17},
                                     {0.469846310, 0.813797681, -0.342020143, -40},
                                     {0.171010072, 0.296198133, 0.939692621, 900}};

BEGUN_STORY(matrices_lead_from_the_world_to_the_pixel, begin_with_object)
{
    static const char *const view[] = {"view front", "view 77 -31 140", "view bottom"};
    OWNED(picture_release) struct picture p;
    must(interp, "clip axial 3-11");
    for (int turned = 0; turned < 2; turned++) {
        if (turned)
            CHECK(geometry_place(&interp->session->geometry, oblique, ORIENTATION_SFORM));
        for (size_t i = 0; i < sizeof view / sizeof view[0]; i++) {
            must(interp, view[i]);
            must(interp, "zoom 1.7 at=15,22,4; render");
            CHECK_INT(export_picture(&p, interp->session, PICTURE_BUT_NORMAL, NULL), OK);
            CHECK(p.space.has_world && check_places(&p, interp->session) > 500);
            picture_release(&p);
        }
    }
    interp->session->geometry.orientation = ORIENTATION_TOLD; /* axes, and no place */
    CHECK_INT(export_picture(&p, interp->session, PICTURE_BUT_NORMAL, NULL), OK);
    CHECK(!p.space.has_world && p.space.eye_mm > 0);
}

STORY(normals_of_an_oblique_scene_are_turned_with_it)
{
    static const int16_t normal[4][4] = {
        {16384, 0, 0, 0}, {0, -16384, 0, 0}, {9459, 9459, 9459, 0}, {0, 0, 0, 0}};
    struct geometry geometry = {.slope = 1};
    float out[4][3];
    CHECK(geometry_place(&geometry, oblique, ORIENTATION_SFORM));
    seen_normals(out[0], normal[0], 4, &geometry);
    for (int w = 0; w < 3; w++) {
        CHECK(fabs((double)out[0][w] - oblique[w][0]) < 1e-6);
        CHECK(fabs((double)out[1][w] + oblique[w][1]) < 1e-6);
        const double sum = (oblique[w][0] + oblique[w][1] + oblique[w][2]) / sqrt(3);
        CHECK(fabs((double)out[2][w] - sum) < 1e-6 && out[3][w] == 0);
    }
}

/* On sheared axes a normal is still at right angles to its face. */
STORY(normals_of_a_sheared_scene_stay_at_right_angles)
{
    static const double sheared[3][4] = {{2, 0.5, 0, 0}, {0, 1, 0.3, 0}, {0, 0, 3, 0}};
    static const int16_t normal[4] = {16384, 0, 0, 0};
    struct geometry geometry = {.slope = 1};
    float n[3];
    CHECK(geometry_place(&geometry, sheared, ORIENTATION_SFORM));
    seen_normals(n, normal, 1, &geometry);
    for (int a = 1; a < 3; a++) { /* the face is that of the other two axes */
        double along = 0;
        for (int w = 0; w < 3; w++)
            along += (double)n[w] * sheared[w][a];
        CHECK(fabs(along) < 1e-6);
    }
    CHECK(n[0] > 0);
}

/* ---- the turntable ---- */

BEGUN_STORY(a_turntable_shows_what_turning_shows, begin_with_object)
{
    static const char *const turned[] = {"view 350 20", "view 80 20", "view 170 20", "view 260 20"};
    struct picture p, q;
    char line[64];
    must(interp, "view 350 20; render");
    const uint64_t before = rendition_digest(session_frame(interp->session));
    MUST_ANSWER(interp, "spin 4 turn%02d.exr", "wrote turn00.exr to turn03.exr\n");
    CHECK_HAS(buf_text(&reply.words), "spin=");
    CHECK(session_rendered(interp->session) &&
          interp->session->now.outlook.view.angle[0] == 350000);
    CHECK(rendition_digest(session_frame(interp->session)) == before);
    for (unsigned i = 0; i < 4; i++) {
        must(interp, turned[i]);
        must(interp, "render one.exr replace=yes");
        snprintf(line, sizeof line, "turn%02u.exr", i);
        CHECK_INT(exr_read(&p, line, NULL), OK);
        CHECK_INT(exr_read(&q, "one.exr", NULL), OK);
        CHECK(p.rgba && q.rgba && memcmp(p.rgba, q.rgba, (size_t)4 * 90 * 70) == 0);
        CHECK_TEXT(picture_find(&p, "iftty:view"), picture_find(&q, "iftty:view"));
        picture_release(&p);
        picture_release(&q);
    }
    CHECK_INT(count_names(".", "turn"), 4);
}

/* Pictures with colours alone, and with all planes, have the same bytes as when they are written
 * one by one, with their notes; and the record has all of them. */
BEGUN_STORY(files_of_a_turntable_are_those_that_turning_writes, begin_with_object)
{
    static const struct {
        const char *setting, *ending;
    } row[] = {{"samples 4", "png"},          {"decorate letters scale legend", "png"},
               {"background white", "jpg"},   {"decorate none", "bmp"},
               {"samples 1", "png"},          {"decorate letters legend", "tif"},
               {"decorate all", "png"},       {"edges on", "png"},
               {"samples 2", "tif"},          {"background transparent", "png"},
               {"decorate scale", "tif"},     {"context mip", "png"},
               {"decorate none", "png"},      {"context none", "jpg"},
               {"opacity 1 40", "png"},       {"samples 4", "exr"},
               {"decorate letters", "exr"},   {"edges off", "exr"},
               {"context mip", "exr"},        {"context none", "exr"},
               {"samples 1", "exr"},          {"shade cubes", "png"},
               {"cut 0,0,0 20,20,10", "exr"}, {"shade cubes", "png"},
               {"opacity 1 100", "png"}};
    char line[80], name[2][32], whole[256];
    must(interp, "label 1 core; size 150 140; zoom 3");
    for (size_t i = 0; i < sizeof row / sizeof row[0]; i++) {
        must(interp, row[i].setting);
        must(interp, "spin 3 whole%d.exr replace=yes");
        snprintf(whole, sizeof whole, "%s", buf_text(&reply.words));
        snprintf(line, sizeof line, "spin 3 file%%d.%s", row[i].ending);
        must(interp, line);
        CHECK_TEXT(buf_text(&reply.words), whole);
        for (unsigned turn = 0; turn < 3; turn++) {
            snprintf(name[0], sizeof name[0], "file%u.%s", turn, row[i].ending);
            snprintf(name[1], sizeof name[1], "alone.%s", row[i].ending);
            snprintf(line, sizeof line, "render %s", name[1]);
            must(interp, line);
            CHECK_WITH(file_holds_same(name[0], name[1]), "%s after %s", name[0], row[i].setting);
            unlink(name[0]);
            unlink(name[1]);
            must(interp, "turn 120 0");
        }
    }
}

BEGUN_STORY(parts_of_a_turn_are_whole_thousandths, begin_with_object)
{
    static const char *const angle[] = {"yaw 0 ",       "yaw 51.429 ",  "yaw 102.857 ",
                                        "yaw 154.286 ", "yaw 205.714 ", "yaw 257.143 ",
                                        "yaw 308.571 "};
    struct picture p;
    char name[32];
    must(interp, "size 9 7; spin 7 part%d.exr");
    for (unsigned i = 0; i < 7; i++) {
        snprintf(name, sizeof name, "part%u.exr", i);
        CHECK_INT(exr_read(&p, name, NULL), OK);
        const char *view = picture_find(&p, "iftty:view");
        CHECK(view && strncmp(view, angle[i], strlen(angle[i])) == 0);
        picture_release(&p);
    }
}

BEGUN_STORY(an_animated_picture_has_every_frame, begin_with_object)
{
    struct image_facts facts;
    OWNED(picture_release) struct picture p, q;
    MUST_ANSWER(interp, "spin 5 round.gif delay=80", "wrote round.gif, 5 pictures\n");
    must(interp, "spin 5 round.tif");
    CHECK_INT(image_helper_about(interp->helper, "round.gif", &facts, NULL), OK);
    CHECK_INT(facts.frames, 5);
    image_facts_release(&facts);
    CHECK_INT(image_helper_about(interp->helper, "round.tif", &facts, NULL), OK);
    CHECK_INT(facts.frames, 5);
    image_facts_release(&facts);
    must(interp, "render round.png");
    CHECK_INT(image_helper_read(interp->helper, "round.tif", &p, NULL), OK);
    CHECK_INT(image_helper_read(interp->helper, "round.png", &q, NULL), OK);
    CHECK(p.rgba && q.rgba && memcmp(p.rgba, q.rgba, (size_t)4 * 90 * 70) == 0);
}

BEGUN_STORY(a_pattern_is_one_number_in_the_name, begin_with_object)
{
    static const char *const bad[] = {"a.png",    "a%d%d.png", "a%5d.png", "a%s.png",
                                      "a%%.png",  "a%d/x.png", "a%",       "a%0d.png",
                                      "%n%d.png", "a%03i.png"};
    char line[64];
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        snprintf(line, sizeof line, "spin 3 %s", bad[i]);
        is_refused(interp, line, ERR_USAGE, "expected one %d or %0Nd in its name");
        CHECK_HAS(fault.text, bad[i]);
    }
    is_refused(interp, "spin 1 a%d.png", ERR_USAGE, "expected a number 2..1000");
    is_refused(interp, "spin 3 none/a%d.png", ERR_IO, "there is no folder none");
    is_refused(interp, "spin 3 a%d.xyz", ERR_INPUT, "no known format");
    CHECK_INT(count_names(".", "a"), 0);
    must(interp, "spin 11 n%09d.ppm");
    CHECK(file_exists("n000000010.ppm"));
}

BEGUN_STORY(a_turntable_is_all_or_nothing, begin_with_object)
{
    OWNED(buf_release) struct buf kept = {0};
    CHECK_INT(file_write("all2.png", "mine", 4, FILE_KEEP, NULL), OK);
    is_refused(interp, "spin 4 all%d.png", ERR_IO, "all2.png exists already and was left alone");
    CHECK_INT(count_names(".", "all"), 1);
    CHECK(session_rendered(interp->session) && interp->session->now.outlook.view.angle[0] == 0);
    must(interp, "spin 4 all%d.png replace=yes");
    CHECK_INT(count_names(".", "all"), 4);
    CHECK_INT(file_read(&kept, "all2.png", 1 << 20, NULL), OK);
    CHECK(kept.length > 100);
    CHECK_INT(count_names(".", ".iftty-"), 0);
}

BEGUN_STORY(a_turntable_that_is_cancelled_leaves_nothing, begin_with_object)
{
    int looks = INT_MAX;
    struct watch watch = {.context = &looks, .poll = stop_after_looks};
    static const char *const line[] = {"spin 6 gone%d.png", "spin 6 gone.gif",
                                       "spin 6 all%d.png replace=yes"};
    OWNED(buf_release) struct buf before = {0}, after = {0};
    must(interp, "spin 6 all%d.png replace=yes");
    CHECK_INT(file_read(&before, "all1.png", 1 << 20, NULL), OK);
    const uint64_t digest = rendition_digest(session_frame(interp->session));
    interp->session->watch = &watch;
    must(interp, "view front");
    for (size_t i = 0; i < 3; i++)
        for (int most = 1; most < 12; most += 5) {
            looks = most;
            enum err err = execute(interp, line[i]);
            looks = INT_MAX;
            if (!CHECK(err == ERR_CANCELLED))
                continue;
            CHECK_INT(count_names(".", "gone") + count_names(".", ".iftty-"), 0);
            CHECK(interp->session->now.outlook.view.angle[0] == 0);
        }
    must(interp, "render");
    CHECK(rendition_digest(session_frame(interp->session)) == digest);
    CHECK_INT(file_read(&after, "all1.png", 1 << 20, NULL), OK);
    CHECK(after.length == before.length && memcmp(after.data, before.data, after.length) == 0);
}

STORY(a_turntable_is_the_same_when_replayed)
{
    OWNED(interpreter_release) struct interpreter interp;
    OWNED(buf_release) struct buf told = {0};
    begin_interpreter(&interp);
    CHECK_INT(interpreter_create_journal(&interp, "spun.iftty", &fault), OK);
    must(&interp, "open synth:geom:40x40x20; seed 20,20,10 1 radius=3; run; spin 3 spun%d.png; "
                  "spin 4 spun.gif; render");
    interpreter_release(&interp);
    unlink("spun.gif");
    begin_interpreter(&interp);
    if (!CHECK(interpreter_resume_journal(&interp, "spun.iftty", &told, &fault) == OK))
        printf("#   %s\n", fault.text);
    CHECK_INT(journal_count(interp.journal), 6);
    CHECK(!file_exists("spun.gif")); /* replaying writes nothing */
}

/* ---- in the background ---- */

static const char *news_of(struct interpreter *interp)
{
    static struct buf text;
    buf_clear(&text);
    picture_writer_wait(interp->writer, NULL);
    picture_writer_news(interp->writer, &text);
    return buf_text(&text);
}

static void begin_beside(struct interpreter *interp)
{
    begin_with_object(interp);
    CHECK_INT(picture_writer_new(&interp->writer, helper_program()), OK);
}

BEGUN_STORY(at_a_prompt_a_picture_is_written_beside_the_session, begin_beside)
{
    MUST_ANSWER(interp, "render beside.png", "writing beside.png\n");
    CHECK_TEXT(news_of(interp), "wrote beside.png\n");
    CHECK(file_exists("beside.png"));
    must(interp, "render beside.exr");
    must(interp, "seed 1,1,3 2"); /* continues meanwhile, without an effect on the file */
    must(interp, "run");
    CHECK_TEXT(news_of(interp), "wrote beside.exr\n");
}

BEGUN_STORY(what_is_there_is_left_alone_at_once, begin_beside)
{
    must(interp, "render twice.png");
    is_refused(interp, "render twice.png", ERR_IO,
               "twice.png exists already and was left alone; replace=yes overwrites it");
    must(interp, "render twice.png replace=yes");
    is_refused(interp, "render none/a.png", ERR_IO, "there is no folder none");
    is_refused(interp, "render odd.xyz", ERR_INPUT, "no known format writes .xyz");
    must(interp, "render odd.sgi"); /* not known that well: written before the prompt is back */
    CHECK_TEXT(buf_text(&reply.text), "wrote odd.sgi\n");
    CHECK_TEXT(news_of(interp), "wrote twice.png\nwrote twice.png\n");
}

static int journal_fails(enum file_step step, const char *path)
{
    return step == FILE_STEP_SYNC && strstr(path, "beside.iftty") ? 28 /* ENOSPC */ : 0;
}

BEGUN_STORY(what_is_not_recorded_is_not_written, begin_beside)
{
    CHECK_INT(interpreter_create_journal(interp, "beside.iftty", &fault), OK);
    file_step_hook = journal_fails;
    is_refused(interp, "render lost.png", ERR_IO, "could not be recorded");
    file_step_hook = NULL;
    CHECK_TEXT(news_of(interp), "");
    CHECK(!file_exists("lost.png"));
    must(interp, "render found.png");
    CHECK_TEXT(news_of(interp), "wrote found.png\n");
}

BEGUN_STORY(a_picture_that_fails_later_changes_nothing_else, begin_beside)
{
    CHECK_INT(file_make_folder("going", NULL), OK);
    picture_writer_free(interp->writer);
    CHECK_INT(picture_writer_new(&interp->writer, "/nonexistent/iftty-image"), OK);
    must(interp, "render going/a.tif");
    CHECK_HAS(news_of(interp), "error: cannot start the image helper /nonexistent/iftty-image");
    CHECK(session_rendered(interp->session) && !file_exists("going/a.tif"));
    must(interp, "pick 45 35");
}

STORY(releasing_an_interpreter_waits_for_its_pictures)
{
    struct interpreter interp;
    begin_beside(&interp);
    must(&interp, "render last1.png; render last2.png; spin 3 last.gif"); /* waits for its own */
    CHECK(file_exists("last.gif"));
    interpreter_release(&interp);
    CHECK(file_exists("last1.png") && file_exists("last2.png"));
}
