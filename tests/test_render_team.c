/* SPDX-License-Identifier: MIT */
/* Renditions by a team: any number of threads draws the same bits. Also run under ThreadSanitizer
 * (test_render_team_racing). */
#include "tests/check_main.h"
#include "stopping.h"

#include "render/bands.h"
#include "tests/stage.h"

enum { THREADS_MOST = 3 };

/* ThreadSanitizer takes ten times as long, so it has fewer scenes, and its own. */
#ifdef __SANITIZE_THREAD__
enum { FIRST = 101, SCENES = 4, STOPS = 14 };
#else
enum { FIRST = 0, SCENES = 10, STOPS = 40 };
#endif

/* A few objects of any shape and view, large enough for the work to be shared. */
static void stage_at_random(struct stage *s, uint64_t *random)
{
    const uint32_t size[3] = {20 + check_below(random, 30), 20 + check_below(random, 30),
                              20 + check_below(random, 30)};
    CHECK(stage_init(s, size, 6, NULL) == OK);
    random_values(s->scene, 4000, random);
    for (int i = 0; i < 8; i++) {
        const struct edit seed = {random_voxel(&s->scene->grid, random), (int16_t)(i % 4), 0};
        CHECK(forest_edit(s->forest, &seed, 1, NULL) == OK);
    }
    s->shader.window[1] = 4000;
    s->border.cut.last[2] = size[2] - check_below(random, 10);
    border_recount(&s->border);
    stage_look_at_random(s, random);
    s->view.width = s->look.samples * (60 + check_below(random, 60));
    s->view.height = s->look.samples * (60 + check_below(random, 60));
    s->view.zoom = s->look.samples * (1000 + check_below(random, 2000));
    CHECK(camera_init(&s->camera, s->scene, &s->view, NULL) == OK);
}

/* Compute the digests of the picture, and of the one after an edit that removes a ball. */
static void draw(struct stage *s, struct team *team, uint64_t digest[3])
{
    OWNED(rendition_release) struct rendition fine, out;
    const struct bands bands = {.project = project_border,
                                .camera = &s->camera,
                                .mesh = &s->mesh,
                                .palette = &s->palette,
                                .look = &s->look,
                                .shader = &s->shader,
                                .rows = TILE};
    stage_samples_init(s, &fine, &out);
    s->shader.team = team;
    project_border_shared(&fine, &s->camera, &s->mesh, team);
    stage_reduce(s, &fine, &out);
    digest[0] = rendition_digest(&out);
    for (int y = 0; y < (int)out.height; y++)
        for (int x = 0; x < (int)out.width; x++)
            for (int k = 0; k < 4; k++)
                digest[0] = digest[0] * 31 + (uint16_t)out.normal[4 * (y * (int)out.width + x) + k];
    CHECK(bands_draw(&out, &bands, NULL) == OK);
    digest[1] = rendition_digest(&out);
    const uint32_t *size = s->scene->grid.size;
    const struct edit seed = {grid_cell(&s->scene->grid, size[0] / 2, size[1] / 2, size[2] / 2), 0,
                              0};
    const struct changes changes = stage_edit(s, &seed, 1);
    stage_follow(s, &fine, &changes);
    stage_reduce(s, &fine, &out);
    digest[2] = rendition_digest(&out);
}

STORY(one_to_three_threads_draw_the_same_picture)
{
    struct team *team[THREADS_MOST + 1] = {NULL};
    for (unsigned threads = 2; threads <= THREADS_MOST; threads++)
        CHECK(team_new(&team[threads], threads, NULL) == OK);
    for (unsigned number = FIRST; number < FIRST + check_scaled(SCENES) && check_failures == 0;
         number++) {
        uint64_t digest[THREADS_MOST + 1][3];
        for (unsigned threads = 1; threads <= THREADS_MOST; threads++) {
            uint64_t random = number;
            OWNED(stage_release) struct stage s;
            stage_at_random(&s, &random);
            draw(&s, team[threads], digest[threads]);
            for (int i = 0; i < 3; i++)
                CHECK_INT(digest[threads][i], digest[1][i]);
        }
        if (check_failures)
            printf("# number %u\n", number);
    }
    for (unsigned threads = 2; threads <= THREADS_MOST; threads++)
        team_free(team[threads]);
}

/* As for forests: every thread ends whenever it is stopped. */
STORY(a_picture_may_be_stopped_at_any_time)
{
    OWNED(team_drop) struct team *team = NULL;
    uint64_t random = 5;
    OWNED(stage_release) struct stage s;
    OWNED(rendition_release) struct rendition fine;
    CHECK(team_new(&team, THREADS_MOST, NULL) == OK);
    stage_at_random(&s, &random);
    s.border.opacity[1] = 50;
    CHECK(rendition_init(&fine, s.view.width, s.view.height, NULL) == OK);
    stage_fit(&s, &fine);
    s.shader.team = team;
    for (int stop = 0; stop < STOPS; stop++) {
        const int looks = stop * 40 / STOPS;
        int left = looks;
        struct watch watch = {.context = &left, .poll = stop_after_looks, .step = 1000};
        s.scene->watch = &watch;
        project_border_shared(&fine, &s.camera, &s.mesh, team);
        const enum err err = shade(&fine, &s.camera, &s.mesh, &s.palette, &s.look, &s.shader, NULL);
        CHECK(err == OK || err == ERR_CANCELLED);
        s.scene->watch = NULL;
    }
}
