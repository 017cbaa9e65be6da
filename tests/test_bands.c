/* SPDX-License-Identifier: MIT */
/* Pictures of samples: drawn in bands by any number of threads, or repaired after an edit, they are
 * equal to the picture drawn at once. */
#include "interpreting.h"

#include <unistd.h>

#include "base/hash.h"
#include "render/bands.h"
#include "show/pictures.h"
#include "tests/check_main.h"
#include "tests/stage.h"

/* ---- by hand and at random ---- */

/* A scene of several objects, some of them cut open. */
static void stage_at_random(struct stage *s, uint64_t *random)
{
    uint32_t size[3];
    for (int a = 0; a < 3; a++)
        size[a] = 2 + check_below(random, 24);
    CHECK(stage_init(s, size, 6, NULL) == OK);
    random_values(s->scene, 4000, random);
    s->scene->spacing_nm[check_below(random, 3)] = 500000 + check_below(random, 2000000);
    s->shader.window[1] = 4000;
    if (check_below(random, 2))
        s->border.cut.last[0] = size[0] / 2;
    border_recount(&s->border);
    for (int i = 0; i < 5; i++)
        stage_seed_at_random(s, random);
}

/* Rows that are taken, as a picture. */
static void take_into(void *picture, const struct rendition *rows, uint32_t top)
{
    const struct rendition *out = picture;
    const size_t first = (size_t)top * out->width, pixels = (size_t)rows->width * rows->height;
    memcpy(out->depth + first, rows->depth, pixels * sizeof *out->depth);
    memcpy(out->cell + first, rows->cell, pixels * sizeof *out->cell);
    memcpy(out->label + first, rows->label, pixels);
    memcpy(out->rgba + 4 * first, rows->rgba, 4 * pixels);
    memcpy(out->normal + 4 * first, rows->normal, 4 * pixels * sizeof *out->normal);
}

static uint64_t sum_of_rows(const struct rendition *r)
{
    uint64_t sum = rendition_digest_begin(r->width, r->height);
    for (uint32_t top = 0; top < r->height; top += TILE) {
        const uint32_t rest = r->height - top;
        const struct rendition rows = rendition_rows(r, top, rest < TILE ? rest : TILE);
        sum += rendition_digest_rows(&rows, top);
    }
    return sum;
}

/* In bands of several heights, by several projections; stored, or taken as they come. */
static bool bands_agree(struct stage *s, const struct rendition *whole)
{
    static projection *const projections[] = {project_border, project_scene, project_rays};
    bool fine = true;
    for (uint32_t i = 0; fine && i < 5; i++) {
        OWNED(rendition_release) struct rendition out = {0};
        const struct bands bands = {.project = projections[i % 3],
                                    .camera = &s->camera,
                                    .mesh = &s->mesh,
                                    .palette = &s->palette,
                                    .look = &s->look,
                                    .shader = &s->shader,
                                    .rows = i * TILE,
                                    .take = i % 2 ? take_into : NULL,
                                    .context = &out};
        CHECK(rendition_init(&out, whole->width, whole->height, NULL) == OK);
        CHECK(bands_draw(i % 2 ? NULL : &out, &bands, NULL) == OK);
        fine = CHECK(stage_same_pixels(whole, &out, "bands"));
        CHECK_INT(sum_of_rows(&out), rendition_digest(whole));
    }
    return fine;
}

STORY(bands_of_any_height_are_the_whole_and_so_is_what_follows_edits)
{
    struct team *team[4] = {NULL};
    for (unsigned i = 2; i < 4; i++)
        CHECK(team_new(&team[i], i, NULL) == OK);
    for (unsigned number = 0; number < check_scaled(120) && check_failures == 0; number++) {
        uint64_t random = number;
        OWNED(stage_release) struct stage s;
        OWNED(rendition_release) struct rendition fine, out;
        stage_at_random(&s, &random);
        /* `samples` samples a pixel, both ways; camera and view are those of the samples. */
        stage_look_at_random(&s, &random);
        s.view.width = s.look.samples * (1 + check_below(&random, 30));
        s.view.height = s.look.samples * (1 + check_below(&random, 90));
        s.view.zoom = s.look.samples * (300 + check_below(&random, 10000));
        CHECK(camera_init(&s.camera, s.scene, &s.view, NULL) == OK);
        stage_samples_init(&s, &fine, &out);
        s.shader.team = team[number % 4];
        project_border(&fine, &s.camera, &s.mesh);
        stage_reduce(&s, &fine, &out);
        bool agree = bands_agree(&s, &out);
        for (int i = 0; agree && i < 4; i++) {
            const struct changes changes = stage_seed_at_random(&s, &random);
            stage_follow(&s, &fine, &changes);
            stage_reduce(&s, &fine, &out);
            agree = bands_agree(&s, &out);
        }
        if (!agree)
            printf("# number %u: mode %d edges %u samples %u\n", number, (int)s.look.mode,
                   s.look.edges, s.look.samples);
    }
    for (unsigned i = 0; i < 4; i++)
        team_free(team[i]);
}

/* ---- in a session ---- */

/* Of the picture after a line. */
static uint64_t digest_after(struct interpreter *interp, const char *line)
{
    must(interp, line);
    return rendition_digest(session_frame(interp->session));
}

BEGUN_STORY(a_picture_may_be_of_more_samples_than_pixels_are_allowed_and_follows_edits,
            begin_interpreter)
{
    must(interp, "open synth:geom:40x40x40; seed 10,10,10 1 radius=3; run; size 8192 70; "
                 "samples 4");
    const uint64_t first = digest_after(interp, "render mode=bp");
    CHECK(!interp->session->pictures->rendition.depth);
    CHECK(session_memory(interp->session) < 64u << 20);
    CHECK_INT(digest_after(interp, "render mode=ray"), first);
    must(interp, "remove 10,10,10; run");
    CHECK(digest_after(interp, "render") != first);
    must(interp, "undo 2");
    CHECK_INT(digest_after(interp, "render"), first);
}

/* A picture that no edit follows stores no samples, of whatever size. */
BEGUN_STORY(a_turntable_is_drawn_in_bands_and_shows_what_renditions_show, begin_interpreter)
{
    uint64_t sum = 0;
    char expected[40];
    interp->mode = MODE_REPLAY; /* writes no file */
    must(interp, "open synth:geom:40x40x40; seed 20,20,20 1 radius=3; size 60 50; samples 4");
    for (uint64_t i = 0; i < 4; i++) {
        sum += hash_mix_at(i, digest_after(interp, "render"));
        CHECK(interp->session->pictures->rendition.depth);
        must(interp, "turn 90 0");
    }
    snprintf(expected, sizeof expected, "spin=%016" PRIx64, sum);
    must(interp, "view front; spin 4 turn.gif");
    CHECK_HAS(buf_text(&reply.words), expected);
    CHECK(!interp->session->pictures->rendition.depth);
}

static size_t most_bytes; /* that an array may have */

static bool takes_small_arrays(size_t bytes)
{
    return bytes < most_bytes;
}

/* Room for the samples of a band, but not for a map of all pixels, not even of a byte each. */
static enum err spin_without_maps(struct interpreter *interp, const char *line)
{
    most_bytes = (size_t)256 * 8192;
    mem_allows = takes_small_arrays;
    const enum err err = execute(interp, line);
    mem_allows = NULL;
    return err;
}

BEGUN_STORY(a_turntable_stores_no_map_of_its_pictures, begin_interpreter)
{
    OWNED(reply_release) struct reply told = {0};
    interp->mode = MODE_REPLAY; /* writes no file */
    must(interp, "open synth:geom:20x20x20; seed 10,10,10 1 radius=3; run; "
                 "decorate letters scale legend");
    for (int samples = 1; samples <= 4; samples *= 2) {
        must(interp, samples == 1 ? "samples 1" : samples == 2 ? "samples 2" : "samples 4");
        must(interp, "size 256 8192");
        CHECK_INT(spin_without_maps(interp, "spin 2 turn%d.png"), OK);
        buf_add(&told.words, buf_text(&reply.words), reply.words.length);
        CHECK_INT(spin_without_maps(interp, "spin 2 turn%d.exr"), OK); /* shows the same */
        CHECK_TEXT(buf_text(&reply.words), buf_text(&told.words));
        buf_clear(&told.words);
        must(interp, "size 100 100"); /* lets go of it */
    }
}

/* A picture of that many pixels is not stored in its file: no array has a byte for each of them. */
BEGUN_STORY(a_large_picture_goes_right_into_its_file, begin_interpreter)
{
    must(interp, "open synth:geom:20x20x20; seed 10,10,10 1 radius=3; run; "
                 "decorate letters scale legend; size 3000 2900; zoom 64");
    most_bytes = (size_t)2900 * 3000;
    mem_allows = takes_small_arrays;
    CHECK_INT(execute(interp, "render large.png replace=yes"), OK);
    CHECK_INT(execute(interp, "render large.exr replace=yes"), OK);
    CHECK_INT(execute(interp, "render"), ERR_MEMORY); /* stored, for whoever looks at it */
    mem_allows = NULL;
    CHECK(!interp->session->pictures->rendition.depth);
    CHECK(unlink("large.png") == 0 && unlink("large.exr") == 0);
}
