/* SPDX-License-Identifier: MIT */
/* Mosaics: four panes that share a scale, and the rendition at half its size. */
#include "tests/check_main.h"
#include "scarce_memory.h"

#include "render/palette.h"
#include "render/mosaic.h"
#include "render/rendition.h"

static struct palette palette;
static bool visible[256];

static struct slice_style plain_style(void)
{
    struct slice_style style = {.palette = &palette, .visible = visible, .least = "", .most = ""};
    slice_window(style.grey, 0, 255);
    return style;
}

/* 14x10x6 voxels of 1x1.5x2 mm, all with different greys. */
static struct scene *graded_scene(void)
{
    static const uint32_t size[3] = {14, 10, 6};
    static const uint32_t spacing[3] = {1000000, 1500000, 2000000};
    struct scene *scene = NULL;
    uint16_t intensity[14 * 10 * 6];
    for (uint16_t i = 0; i < 14 * 10 * 6; i++)
        intensity[i] = (uint16_t)(i * 37 % 251);
    CHECK(scene_new(&scene, size, intensity, NULL, NULL) == OK);
    memcpy(scene->spacing_nm, spacing, sizeof spacing);
    return scene;
}

static struct rendition black_rendition(uint32_t width, uint32_t height)
{
    struct rendition r;
    CHECK(rendition_init(&r, width, height, NULL) == OK);
    memset(r.rgba, 0, (size_t)4 * width * height);
    return r;
}

/* A rendition of noise, in which one pixel of three shows nothing. */
static struct rendition noisy_rendition(uint32_t width, uint32_t height)
{
    struct rendition r = black_rendition(width, height);
    uint64_t seed = 5;
    for (size_t i = 0; i < (size_t)width * height; i++) {
        if (check_below(&seed, 3) == 0)
            continue;
        r.cell[i] = 1 + check_below(&seed, 1000);
        for (size_t k = 0; k < 3; k++)
            r.rgba[4 * i + k] = (uint8_t)check_below(&seed, 256);
        r.rgba[4 * i + 3] = 255;
    }
    return r;
}

static struct canvas take(const struct scene *scene, const struct rendition *r,
                          const struct mosaic_choice *choice, const struct slice_style *style)
{
    struct canvas canvas;
    CHECK(canvas_init(&canvas, r->width, r->height, CANVAS_CELLS, NULL) == OK);
    CHECK(mosaic_draw(&canvas, scene, r, choice, style, NULL) == OK);
    return canvas;
}

STORY(panes_share_the_picture_out)
{
    for (uint32_t width = MOSAIC_SIDE_LEAST; width < 140; width++)
        for (uint32_t height = MOSAIC_SIDE_LEAST; height < 140; height += 1 + width % 3) {
            const struct mosaic_box a = mosaic_box(width, height, MOSAIC_CORONAL),
                                    b = mosaic_box(width, height, MOSAIC_SAGITTAL),
                                    c = mosaic_box(width, height, MOSAIC_AXIAL),
                                    d = mosaic_box(width, height, MOSAIC_RENDITION);
            const uint32_t seam = b.left - a.width;
            CHECK(seam == (width < 128 || height < 128 ? 1 : 2));
            CHECK(a.left == 0 && a.top == 0 && b.top == 0 && c.left == 0);
            CHECK(d.left == b.left && d.top == c.top && c.top - a.height == seam);
            CHECK(b.left + b.width == width && d.top + d.height == height);
            CHECK(a.width == c.width && b.width == d.width && a.height == b.height &&
                  c.height == d.height);
            CHECK(d.width - a.width <= 1 && 2 * d.width <= width && 2 * d.height <= height);
        }
}

/* Each pane equals a slice alone at the largest scale at which all three fit. */
STORY(panes_are_slices_at_one_scale)
{
    static const enum mosaic_pane pane_of[3] = {MOSAIC_AXIAL, MOSAIC_CORONAL, MOSAIC_SAGITTAL};
    OWNED(scene_drop) struct scene *scene = graded_scene();
    struct slice_style style = plain_style();
    style.crosses = true;
    for (uint32_t side = 61; side < 200; side += 23) {
        const uint32_t width = side % 2 ? side : 2 * side, height = side % 2 ? 2 * side : side;
        OWNED(rendition_release) struct rendition r = noisy_rendition(width, height);
        const struct mosaic_choice choice = {.place = {3, 4, 5}};
        OWNED(canvas_release) struct canvas mosaic = take(scene, &r, &choice, &style);
        uint64_t pixel_pm = 0;
        for (int p = 0; p < 3; p++) {
            const struct mosaic_box box = mosaic_box(width, height, pane_of[p]);
            const uint64_t fits =
                slice_fitting_pixel(scene, (enum slice_plane)p, box.width, box.height);
            pixel_pm = fits > pixel_pm ? fits : pixel_pm;
        }
        for (int p = 0; p < 3; p++) {
            const struct mosaic_box box = mosaic_box(width, height, pane_of[p]);
            const struct slice_choice slice = {
                (enum slice_plane)p, {3, 4, 5}, pixel_pm, true, 0, NULL, false, {0}, 0};
            OWNED(canvas_release) struct canvas alone;
            CHECK(canvas_init(&alone, box.width, box.height, 0, NULL) == OK);
            CHECK(slice_draw(&alone, scene, &slice, &style, NULL) == OK);
            for (uint32_t y = 0; y < box.height; y++)
                CHECK(memcmp(canvas_pixel(&mosaic, box.left, box.top + y),
                             canvas_pixel(&alone, 0, y), 4 * (size_t)box.width) == 0);
        }
    }
}

/* In a dark scene only the cross-hair is bright: its column and row continue across the seam. */
STORY(the_lines_of_the_cross_hair_run_on)
{
    static const uint32_t size[3] = {14, 10, 6};
    OWNED(scene_drop) struct scene *scene = NULL;
    struct slice_style style = plain_style();
    const struct mosaic_choice choice = {.place = {3, 4, 5}};
    OWNED(rendition_release) struct rendition r = noisy_rendition(100, 100);
    uint32_t columns[2] = {0}, rows[2] = {0};
    CHECK(scene_new(&scene, size, NULL, NULL, NULL) == OK);
    style.crosses = true;
    OWNED(canvas_release) struct canvas mosaic = take(scene, &r, &choice, &style);
    for (uint32_t i = 0; i < 49; i++) {
        columns[0] += canvas_pixel(&mosaic, i, 0)[0] ? i : 0;
        columns[1] += canvas_pixel(&mosaic, i, 99)[0] ? i : 0;
        rows[0] += canvas_pixel(&mosaic, 0, i)[0] ? i : 0;
        rows[1] += canvas_pixel(&mosaic, 99, i)[0] ? i : 0;
    }
    CHECK(columns[0] > 24 && columns[0] == columns[1]); /* left of the middle of the patient */
    CHECK(rows[0] > 0 && rows[0] < 24 && rows[0] == rows[1]);
}

/* A pane with a rendition at half its size equals 2x2 samples of it. */
STORY(a_pixel_of_the_pane_is_what_samples_come_to)
{
    static const uint8_t white[3] = {255, 255, 255};
    OWNED(scene_drop) struct scene *scene = graded_scene();
    const struct slice_style style = plain_style();
    const struct mosaic_choice choice = {.background = BACKGROUND_WHITE};
    OWNED(rendition_release)
    struct rendition r = noisy_rendition(21, 21), fine = black_rendition(20, 20), reduced = {0};
    uint64_t seed = 3;
    for (uint32_t y = 0; y < 20; y++)
        for (uint32_t x = 0; x < 20; x++) {
            const size_t from = y * 21 + x, to = y * 20 + x;
            if (r.cell[from] == CELL_NONE)
                continue;
            r.depth[from] = fine.depth[to] = 1000 + check_below(&seed, 1000000);
            fine.cell[to] = r.cell[from];
            memcpy(fine.rgba + 4 * to, r.rgba + 4 * from, 4);
        }
    memset(fine.label, 1, 20 * 20);
    memset(fine.normal, 0, 20 * 20 * 4 * sizeof *fine.normal);
    CHECK(rendition_init(&reduced, 10, 10, NULL) == OK);
    rendition_reduce(&reduced, &fine, 2, NULL);
    OWNED(canvas_release) struct canvas mosaic = take(scene, &r, &choice, &style);
    for (uint32_t y = 0; y < 10; y++)
        for (uint32_t x = 0; x < 10; x++) {
            uint8_t expected[3];
            background_over(expected, reduced.rgba + 4 * (y * 10 + x), white);
            CHECK(memcmp(canvas_pixel(&mosaic, 11 + x, 11 + y), expected, 3) == 0);
            CHECK_INT(mosaic.cell[(11 + y) * 21 + 11 + x], reduced.cell[y * 10 + x]);
            CHECK_INT(mosaic_cell_at(scene, 21, 21, &r, &choice, 11 + x, 11 + y),
                      reduced.cell[y * 10 + x]);
        }
}

/* If the seam removes a pixel of the pane, the rendition loses one on either side. */
STORY(the_rendition_lies_in_the_middle_of_its_pane)
{
    OWNED(scene_drop) struct scene *scene = graded_scene();
    const struct slice_style style = plain_style();
    const struct mosaic_choice choice = {.place = {0, 0, 0}};
    OWNED(rendition_release)
    struct rendition r = black_rendition(130, 131); /* the pane has 64x65 */
    r.cell[0] = 5;
    r.cell[1] = 6;
    r.cell[130 * 130 + 128] = 7;
    r.cell[130 * 130 + 129] = 8;
    OWNED(canvas_release) struct canvas mosaic = take(scene, &r, &choice, &style);
    CHECK_INT(mosaic.cell[66 * 130 + 66], 6);
    CHECK_INT(mosaic.cell[66 * 130 + 67], CELL_NONE);
    CHECK_INT(mosaic.cell[130 * 130 + 129], CELL_NONE); /* the last row has no other */
    r.cell[129 * 130 + 128] = 9;
    r.depth[129 * 130 + 128] = 0;
    CHECK_INT(mosaic_cell_at(scene, r.width, r.height, &r, &choice, 129, 130), 9);
}

/* In mosaics of the rendition's size, and in others that it is fitted into. */
STORY(a_pixel_of_a_mosaic_knows_its_voxel)
{
    OWNED(scene_drop) struct scene *scene = graded_scene();
    const struct slice_style style = plain_style();
    uint64_t seed = 9;
    for (int i = 0; i < 90; i++) {
        const struct mosaic_choice choice = {
            .place = {check_below(&seed, 14), check_below(&seed, 10), check_below(&seed, 6)}};
        OWNED(rendition_release)
        struct rendition r = noisy_rendition(MOSAIC_SIDE_LEAST + check_below(&seed, 130),
                                             MOSAIC_SIDE_LEAST + check_below(&seed, 130));
        const bool is_fitted = i % 3 > 0;
        const uint32_t width = is_fitted ? MOSAIC_SIDE_LEAST + check_below(&seed, 200) : r.width;
        const uint32_t height = is_fitted ? MOSAIC_SIDE_LEAST + check_below(&seed, 200) : r.height;
        OWNED(canvas_release) struct canvas mosaic;
        CHECK(canvas_init(&mosaic, width, height, CANVAS_CELLS, NULL) == OK);
        CHECK(mosaic_draw(&mosaic, scene, &r, &choice, &style, NULL) == OK);
        uint32_t wrong = 0, shown = 0;
        for (uint32_t p = 0; p < width * height; p++) {
            wrong += mosaic.cell[p] !=
                     mosaic_cell_at(scene, width, height, &r, &choice, p % width, p / width);
            shown += mosaic.cell[p] != CELL_NONE;
        }
        CHECK_INT(wrong, 0);
        CHECK(shown > 0);
    }
}

/* One colour is not mixed at any size; renditions far larger or smaller still fit. */
STORY(a_rendition_of_another_size_is_fitted_in)
{
    static const uint32_t side[][2] = {{16, 16}, {17, 300}, {300, 20}, {512, 512}, {64, 48}};
    OWNED(scene_drop) struct scene *scene = graded_scene();
    const struct slice_style style = plain_style();
    const struct mosaic_choice choice = {.place = {0, 0, 0}};
    for (size_t i = 0; i < sizeof side / sizeof side[0]; i++) {
        OWNED(rendition_release) struct rendition r = noisy_rendition(side[i][0], side[i][1]);
        const struct mosaic_box box = mosaic_box(200, 160, MOSAIC_RENDITION);
        OWNED(canvas_release) struct canvas mosaic;
        uint32_t seen = 0, wrong = 0;
        for (size_t p = 0; p < (size_t)r.width * r.height; p++)
            memcpy(r.rgba + 4 * p, (uint8_t[]){10, 200, 90, 255}, 4);
        CHECK(canvas_init(&mosaic, 200, 160, CANVAS_CELLS, NULL) == OK);
        CHECK(mosaic_draw(&mosaic, scene, &r, &choice, &style, NULL) == OK);
        for (uint32_t y = 0; y < box.height; y++)
            for (uint32_t x = 0; x < box.width; x++) {
                const uint8_t *p = canvas_pixel(&mosaic, box.left + x, box.top + y);
                seen += p[1] == 200;
                wrong += !(p[0] == 10 && p[1] == 200 && p[2] == 90) && p[0] + p[1] + p[2] > 0;
            }
        CHECK_INT(wrong, 0);
        const uint32_t wide = box.width * side[i][1], high = box.height * side[i][0];
        const uint32_t least =
            wide < high ? wide / side[i][0] * box.width : high / side[i][1] * box.height;
        CHECK(seen * 4 >=
              least - least / 8); /* enlarged by whole numbers: a quarter at the least */
    }
}

STORY(without_memory_there_is_no_mosaic)
{
    OWNED(scene_drop) struct scene *scene = graded_scene();
    const struct slice_style style = plain_style();
    const struct mosaic_choice choice = {.place = {0, 0, 0}, .notes = true};
    OWNED(rendition_release) struct rendition r = noisy_rendition(40, 40);
    OWNED(canvas_release) struct canvas canvas;
    unsigned refused = 0;
    enum err err = ERR_MEMORY;
    CHECK(canvas_init(&canvas, 40, 40, 0, NULL) == OK);
    count_allocations();
    CHECK(mosaic_draw(&canvas, scene, &r, &choice, &style, NULL) == OK);
    for (unsigned n = 0; err == ERR_MEMORY && n < 100; n++) {
        allow_allocations(n);
        err = mosaic_draw(&canvas, scene, &r, &choice, &style, NULL);
        mem_allows = NULL;
        refused += err == ERR_MEMORY;
    }
    CHECK_INT(err, OK);
    CHECK_INT(refused, allocations_made);
}
