/* SPDX-License-Identifier: MIT */
/* The maximum intensity projection, against a search of every voxel; and its look. */
#include "tests/check_main.h"

#include <math.h>

#include "render/mip.h"
#include "tests/ray_search.h"
#include "tests/stage.h"

/* A small scene with intensities below 1000, perhaps cut. */
static void stage_at_random(struct stage *s, uint64_t *random)
{
    uint32_t size[3];
    for (int a = 0; a < 3; a++)
        size[a] = 1 + check_below(random, check_below(random, 4) ? 9 : 30);
    CHECK(stage_init(s, size, 6, NULL) == OK);
    for (size_t c = 0; c < s->scene->grid.cells; c++)
        if (!(s->scene->cell[c].flags & CELL_RIM))
            s->scene->cell[c].intensity = (uint16_t)check_below(random, 1000);
    if (check_below(random, 2)) {
        s->border.cut.last[0] = size[0] / 2;
        s->border.cut.boxes = 1;
        for (int a = 0; a < 3; a++)
            s->border.cut.box[0].last[a] = check_below(random, size[a]);
    }
}

static void look_at_random(struct stage *s, uint64_t *random)
{
    for (int i = 0; i < 3; i++)
        s->view.angle[i] = (int32_t)(check_below(random, 2) ? check_below(random, 360000)
                                                            : check_below(random, 8) * 45000);
    s->view.width = 1 + check_below(random, 12);
    s->view.height = 1 + check_below(random, 12);
    s->view.zoom = 300 + check_below(random, 3000);
    CHECK(camera_init(&s->camera, s->scene, &s->view, NULL) == OK);
}

/* Return the brightest voxel within the window; if white is the smaller intensity, the lowest one.
 * */
static int search(const struct stage *s, const struct mip_source *of, struct passed *room,
                  uint32_t x, uint32_t y)
{
    const size_t count = ray_search(room, &s->camera, x, y);
    int most = 0;
    for (size_t i = 0; i < count; i++) {
        if (cut_removes(&of->cut, &s->scene->grid, room[i].cell))
            continue;
        const int above = s->scene->cell[room[i].cell].intensity - of->window[0];
        const int grey = above * 255 / (of->window[1] - of->window[0]);
        most = grey > most ? grey : most;
    }
    return most > 255 ? 255 : most;
}

STORY(a_pixel_is_as_bright_as_the_brightest_voxel_on_its_ray)
{
    uint64_t random = 3;
    struct team *team[4] = {NULL};
    for (unsigned i = 2; i < 4; i++)
        CHECK(team_new(&team[i], i, NULL) == OK);
    for (unsigned i = 0; i < check_scaled(400) && check_failures == 0; i++) {
        OWNED(stage_release) struct stage s;
        OWNED(mip_release) struct mip mip = {0};
        stage_at_random(&s, &random);
        for (int look = 0; look < 3 && check_failures == 0; look++) {
            struct mip_source of = {.scene = s.scene, .cut = s.border.cut};
            of.window[0] = (int32_t)check_below(&random, 1000);
            of.window[1] = of.window[0] + 1 + (int32_t)check_below(&random, 500);
            if (check_below(&random, 3) == 0)
                of.window[1] = of.window[0] - 1 - (int32_t)check_below(&random, 500);
            look_at_random(&s, &random);
            CHECK(mip_draw(&mip, &of, &s.camera, team[i % 4], NULL) == OK);
            OWNED(mem_release) struct passed *room = mem_array(s.scene->grid.voxels, sizeof *room);
            for (uint32_t y = 0; y < s.view.height; y++)
                for (uint32_t x = 0; x < s.view.width; x++)
                    CHECK_INT(mip.brightness[(size_t)y * s.view.width + x],
                              search(&s, &of, room, x, y));
            s.border.cut = cut_none(); /* change cut and view, but not the scene */
        }
    }
    for (unsigned i = 2; i < 4; i++)
        team_free(team[i]);
}

STORY(it_lies_behind_objects_and_over_black_it_is_its_brightness)
{
    for (int b = 0; b < 256; b++) {
        const uint8_t brightness = (uint8_t)b, opaque[4] = {9, 8, 7, 255};
        uint8_t out[4];
        mip_put_behind(out, opaque, &brightness, 1);
        CHECK(memcmp(out, opaque, 4) == 0);
        mip_put_behind(out, (const uint8_t[4]){0}, &brightness, 1);
        CHECK(out[0] == out[1] && out[1] == out[2]);
        const int over_black = (int)(sqrt(out[3] / 255.0) * out[0] + 0.5);
        CHECK(abs(over_black - b) <= 1);
        CHECK_INT(out[3], b < 64 ? 4 * b : 255);
        mip_put_behind(out, (const uint8_t[4]){200, 100, 0, 128}, &brightness, 1);
        CHECK(out[3] >= 128 && (b < 64 || out[3] == 255));
        if (b == 255)
            CHECK(abs(out[0] - 229) <= 1 && abs(out[2] - 180) <= 1);
    }
}
