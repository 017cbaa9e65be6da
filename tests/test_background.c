/* SPDX-License-Identifier: MIT */
/* Backgrounds: what is behind objects, wherever a rendition is shown or written. */

#include "image/exr.h"
#include "render/mosaic.h"
#include "show/decorating.h"
#include "show/export_picture.h"
#define RUN_IN_FOLDER
#include "tests/folder_main.h"
#include "tests/interpreting.h"

/* ---- by themselves ---- */

STORY(what_is_covered_whole_or_not_at_all_is_exact)
{
    for (unsigned level = 0; level < 256; level++) {
        const uint8_t behind[3] = {(uint8_t)level, (uint8_t)(255 - level), 7};
        const uint8_t clear[4] = {0, 0, 0, 0}, whole[4] = {(uint8_t)level, 3, 200, 255};
        uint8_t rgb[3];
        background_over(rgb, clear, behind);
        CHECK(memcmp(rgb, behind, 3) == 0);
        background_over(rgb, whole, behind);
        CHECK(memcmp(rgb, whole, 3) == 0);
        for (unsigned alpha = 0; alpha < 256; alpha++) { /* an area of one colour has no edge */
            const uint8_t same[4] = {behind[0], behind[1], behind[2], (uint8_t)alpha};
            background_over(rgb, same, behind);
            CHECK(memcmp(rgb, behind, 3) == 0);
        }
    }
}

/* Half of white over black is as light as half of a pixel's samples are, 188 by sRGB. */
STORY(light_adds_up_and_not_its_code)
{
    const uint8_t half[4] = {255, 255, 0, 128}, black[3] = {0, 0, 0}, white[3] = {255, 255, 255};
    uint8_t rgb[3];
    background_over(rgb, half, black);
    CHECK(rgb[0] >= 178 && rgb[0] <= 190 && rgb[2] == 0);
    background_over(rgb, half, white);
    CHECK(rgb[0] == 255 && rgb[2] >= 178 && rgb[2] <= 190);
    uint8_t former = 0;
    for (unsigned alpha = 0; alpha < 256; alpha++) {
        const uint8_t grey[4] = {200, 200, 200, (uint8_t)alpha};
        background_over(rgb, grey, black);
        CHECK(rgb[0] >= former);
        former = rgb[0];
    }
}

STORY(a_gradient_runs_from_the_top_to_a_darker_bottom)
{
    for (uint32_t height = 1; height < 2000; height = 2 * height + 1) {
        uint8_t former[3], rgb[3];
        background_at(former, BACKGROUND_GRADIENT, 0, height);
        const unsigned top = former[1];
        for (uint32_t row = 1; row < height; row++) {
            background_at(rgb, BACKGROUND_GRADIENT, row, height);
            for (int k = 0; k < 3; k++)
                CHECK(rgb[k] <= former[k]);
            memcpy(former, rgb, 3);
        }
        CHECK(height == 1 || (former[1] < top / 2 && former[1] > 0));
    }
}

STORY(what_is_clear_stays_as_it_is)
{
    uint8_t some[4][4] = {{1, 2, 3, 4}, {0, 0, 0, 0}, {9, 9, 9, 255}, {255, 0, 0, 128}}, all[4][4];
    memcpy(all, some, sizeof some);
    background_put(all[0], 2, 2, BACKGROUND_CLEAR);
    CHECK(memcmp(all, some, sizeof some) == 0);
}

/* ---- in a session ---- */

enum { WIDTH = 90, HEIGHT = 70, PIXELS = WIDTH * HEIGHT };

static void begin_with_object(struct interpreter *interp)
{
    begin_interpreter(interp);
    must(interp, "open synth:geom:40x40x20; seed 20,20,10 1 radius=3; seed 1,1,1 0; "
                 "size 90 70; samples 4; view 30 20 10; run");
}

static void has_background(struct interpreter *interp, const char *line, uint32_t background)
{
    must(interp, line);
    CHECK_INT(interp->session->now.outlook.background, background);
}

BEGUN_STORY(each_word_is_a_background_and_info_prints_it, begin_with_object)
{
    CHECK_INT(interp->session->now.outlook.background, BACKGROUND_GRADIENT);
    has_background(interp, "background black", BACKGROUND_PLAIN);
    has_background(interp, "background white", BACKGROUND_WHITE);
    has_background(interp, "background #E0a010", BACKGROUND_PLAIN | 0xe0a010);
    MUST_MENTION(interp, "info", ", background #e0a010, ");
    has_background(interp, "background transparent", BACKGROUND_CLEAR);
    MUST_MENTION(interp, "info", ", background transparent, ");
    has_background(interp, "background gradient", BACKGROUND_GRADIENT);
    CHECK_INT(execute(interp, "background grey"), ERR_USAGE);
    CHECK_HAS(fault.text, "black|white|gradient|transparent or #rrggbb");
}

static struct picture read_back(struct interpreter *interp, const char *name)
{
    struct picture p = {0};
    CHECK_WITH(image_helper_read(interp->helper, name, &p, &fault) == OK, "%s", fault.text);
    return p;
}

/* A file of colours shows what the terminal shows: the frame over the background. */
BEGUN_STORY(files_and_the_screen_show_the_same, begin_with_object)
{
    static const char *const line[] = {"background gradient", "background white",
                                       "background #305070", "background black"};
    for (size_t i = 0; i < sizeof line / sizeof line[0]; i++) {
        OWNED(canvas_release) struct canvas canvas;
        must(interp, line[i]);
        must(interp, "render a.png replace=yes");
        CHECK_INT(session_show_frame(&canvas, interp->session, NULL), OK);
        OWNED(picture_release) struct picture p = read_back(interp, "a.png");
        CHECK(p.rgba && memcmp(p.rgba, canvas.rgba, (size_t)4 * PIXELS) == 0);
        uint8_t corner[3];
        background_at(corner, interp->session->now.outlook.background, 0, HEIGHT);
        CHECK(p.rgba && memcmp(p.rgba, corner, 3) == 0);
    }
}

BEGUN_STORY(a_clear_picture_has_its_alpha, begin_with_object)
{
    must(interp, "background transparent; render clear.png; render clear.tif; "
                 "render clear.bmp; render clear.exr");
    OWNED(picture_release)
    struct picture png = read_back(interp, "clear.png"), tif = read_back(interp, "clear.tif");
    OWNED(picture_release) struct picture bmp = read_back(interp, "clear.bmp"), exr;
    CHECK_INT(exr_read(&exr, "clear.exr", NULL), OK);
    CHECK(memcmp(png.rgba, exr.rgba, (size_t)4 * PIXELS) == 0);
    CHECK(memcmp(tif.rgba, exr.rgba, (size_t)4 * PIXELS) == 0);
    unsigned partly = 0;
    for (size_t i = 0; i < PIXELS; i++) {
        const uint8_t *c = exr.rgba + 4 * i;
        partly += c[3] > 0 && c[3] < 255;
        CHECK_INT(bmp.rgba[4 * i], (c[0] * c[3] + 127) / 255);
    }
    CHECK(partly > 50);
}

BEGUN_STORY(an_exr_holds_the_objects_alone_whatever_is_behind, begin_with_object)
{
    OWNED(picture_release) struct picture gradient, white;
    must(interp, "render gradient.exr");
    const uint64_t digest = rendition_digest(session_frame(interp->session));
    must(interp, "background white");
    CHECK(session_rendered(interp->session)); /* nothing is drawn again */
    must(interp, "render white.exr");
    CHECK(rendition_digest(session_frame(interp->session)) == digest);
    CHECK_INT(exr_read(&gradient, "gradient.exr", NULL), OK);
    CHECK_INT(exr_read(&white, "white.exr", NULL), OK);
    CHECK(memcmp(gradient.rgba, white.rgba, (size_t)4 * PIXELS) == 0 && gradient.rgba[3] == 0);
}

/* All of the pane, including the area next to the rendition, and only the pane. */
BEGUN_STORY(the_pane_of_a_mosaic_has_it_too, begin_with_object)
{
    must(interp, "samples 1; background black; mosaic black.png; background white; "
                 "mosaic white.png");
    OWNED(picture_release)
    struct picture black = read_back(interp, "black.png"), white = read_back(interp, "white.png");
    const struct mosaic_box box = mosaic_box(WIDTH, HEIGHT, MOSAIC_RENDITION);
    unsigned differ = 0;
    for (uint32_t y = 0; y < HEIGHT; y++)
        for (uint32_t x = 0; x < WIDTH; x++) {
            const uint8_t *b = black.rgba + 4 * (y * WIDTH + x);
            const uint8_t *w = white.rgba + 4 * (y * WIDTH + x);
            const bool is_in_pane = x - box.left < box.width && y - box.top < box.height;
            CHECK(is_in_pane || memcmp(b, w, 4) == 0);
            differ += memcmp(b, w, 4) != 0;
            CHECK(w[0] >= b[0]);
        }
    CHECK(differ > box.width * box.height / 4);
}
