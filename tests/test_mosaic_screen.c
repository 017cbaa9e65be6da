/* SPDX-License-Identifier: MIT */
/* The panes of a screen: nothing overlaps, nothing is cut, and most of the screen is in use. */
#include "tests/check_main.h"

#include "render/mosaic.h"
#include "render/rendition.h"

static struct scene *scene_of(uint32_t x, uint32_t y, uint32_t z)
{
    struct scene *scene = NULL;
    CHECK(scene_new(&scene, (uint32_t[]){x, y, z}, NULL, NULL, NULL) == OK);
    return scene;
}

static struct mosaic_screen screen_of(uint32_t columns, uint32_t rows, uint32_t cell_width,
                                      uint32_t cell_height)
{
    return (struct mosaic_screen){
        columns * cell_width, rows * cell_height, cell_width, cell_height, true, MOSAIC_AXIAL};
}

/* Count the panes that show a pixel. */
static unsigned panes_at(const struct mosaic_layout *layout, uint32_t x, uint32_t y)
{
    unsigned panes = 0;
    for (int i = 0; i < MOSAIC_PANES; i++) {
        const struct mosaic_box *box = &layout->box[i];
        panes += x - box->left < box->width && y - box->top < box->height;
    }
    return panes;
}

/* Panes take all of the screen, but for seams between them. */
static bool is_taken(const struct mosaic_layout *layout, uint32_t x, uint32_t y)
{
    for (uint32_t i = 0; i < 9; i++)
        if (panes_at(layout, x - (x < i % 3 ? x : i % 3), y - (y < i / 3 ? y : i / 3)))
            return true;
    return false;
}

static void lies_well(const struct mosaic_layout *layout, const struct mosaic_screen *screen)
{
    for (int i = 0; i < MOSAIC_PANES; i++) {
        const struct mosaic_box *box = &layout->box[i];
        CHECK(box->width > 0 && box->height > 0);
        CHECK(box->left + box->width <= screen->width && box->top + box->height <= screen->height);
        CHECK(box->left % screen->cell_width == 0 && box->top % screen->cell_height == 0);
        CHECK(box->width >= screen->cell_width && box->height >= screen->cell_height);
    }
    for (uint32_t y = 0; y < screen->height; y += 1 + screen->height / 50)
        for (uint32_t x = 0; x < screen->width; x += 1 + screen->width / 50)
            CHECK(panes_at(layout, x, y) <= 1 && is_taken(layout, x, y));
}

static const uint32_t cell[][2] = {{1, 2}, {2, 4}, {6, 12}, {8, 16}, {9, 20}};

STORY(panes_lie_beside_each_other_on_any_screen_and_scene)
{
    uint64_t seed = 3;
    for (unsigned i = 0; i < 400; i++) {
        OWNED(scene_drop)
        struct scene *scene = scene_of(1 + check_below(&seed, 60), 1 + check_below(&seed, 60),
                                       1 + check_below(&seed, 60));
        const uint32_t *size = cell[i % 5];
        const struct mosaic_screen screen =
            screen_of(20 + check_below(&seed, 200), 8 + check_below(&seed, 60), size[0], size[1]);
        struct mosaic_layout layout;
        for (int a = 0; a < 3; a++)
            scene->spacing_nm[a] = 100000 + check_below(&seed, 4000000);
        mosaic_lay_out(&layout, scene, &screen);
        lies_well(&layout, &screen);
    }
}

STORY(panes_lie_beside_each_other_in_the_least_of_screens)
{
    OWNED(scene_drop) struct scene *scene = scene_of(7, 7, 60);
    for (uint32_t columns = 1; columns < 24; columns++)
        for (uint32_t rows = 1; rows < 12; rows++) {
            const struct mosaic_screen screen = screen_of(columns, rows, 8, 16);
            struct mosaic_layout layout;
            CHECK(mosaic_fits(&screen) == (columns >= 8 && rows >= 4));
            if (!mosaic_fits(&screen))
                continue;
            mosaic_lay_out(&layout, scene, &screen);
            lies_well(&layout, &screen);
        }
}

/* Return the area of the squares of all slices, and of the rendition's pane, which its content
 * fills. */
static double used(const struct mosaic_layout *layout, const struct scene *scene,
                   const struct mosaic_screen *screen)
{
    const uint32_t *n = scene->grid.size;
    const struct mosaic_choice choice = {.layout = layout};
    const struct slice_choice slice =
        mosaic_slice(scene, &choice, screen->width, screen->height, SLICE_AXIAL);
    const double voxel = 1e9 / (double)slice.pixel_pm; /* pixels */
    const struct mosaic_box *box = &layout->box[MOSAIC_RENDITION];
    return (voxel * voxel * (n[0] * n[1] + n[0] * n[2] + n[1] * n[2]) +
            (double)box->width * box->height) /
           ((double)screen->width * screen->height);
}

/* A head on screens of all shapes. */
STORY(most_of_the_screen_is_in_use)
{
    static const struct {
        uint32_t columns, rows;
        double least;
    } screens[] = {{80, 24, 0.7},    {80, 40, 0.9},   {20, 10, 0.85}, {200, 50, 0.8},
                   {120, 50, 0.85},  {200, 24, 0.88}, {40, 60, 0.7},  {60, 100, 0.8},
                   {300, 100, 0.75}, {40, 12, 0.65}};
    OWNED(scene_drop) struct scene *scene = scene_of(181, 217, 181);
    for (size_t i = 0; i < sizeof screens / sizeof screens[0]; i++)
        for (int c = 3; c < 5; c++) {
            const struct mosaic_screen screen =
                screen_of(screens[i].columns, screens[i].rows, cell[c][0], cell[c][1]);
            struct mosaic_layout layout;
            mosaic_lay_out(&layout, scene, &screen);
            const double share = used(&layout, scene, &screen);
            if (!CHECK(share >= screens[i].least))
                printf("# %ux%u: %.2f\n", screens[i].columns, screens[i].rows, share);
        }
}

/* Slices are as wide as in each other's pane, so that the lines of the cross-hair run on. */
STORY(slices_line_up)
{
    OWNED(scene_drop) struct scene *scene = scene_of(181, 217, 181);
    const struct mosaic_screen narrow = screen_of(80, 40, 8, 16), wide = screen_of(200, 24, 8, 16);
    struct mosaic_layout layout;
    mosaic_lay_out(&layout, scene, &narrow);
    const struct mosaic_box *box = layout.box;
    CHECK(box[MOSAIC_CORONAL].left == box[MOSAIC_AXIAL].left &&
          box[MOSAIC_CORONAL].width == box[MOSAIC_AXIAL].width);
    CHECK(box[MOSAIC_CORONAL].top == box[MOSAIC_SAGITTAL].top &&
          box[MOSAIC_CORONAL].height == box[MOSAIC_SAGITTAL].height);
    CHECK(box[MOSAIC_SAGITTAL].left == box[MOSAIC_RENDITION].left);
    CHECK(box[MOSAIC_SAGITTAL].left == 288); /* 640 * 181 / 398, in whole cells */
    const struct mosaic_screen large = screen_of(120, 48, 9, 18);
    mosaic_lay_out(&layout, scene, &large);
    const struct mosaic_choice choice = {.layout = &layout};
    CHECK(box[MOSAIC_CORONAL].height < 400 && box[MOSAIC_AXIAL].height > 400);
    for (int p = 0; p < 3; p++) /* notes as large in all of them */
        CHECK_INT(mosaic_slice(scene, &choice, large.width, large.height, (enum slice_plane)p).size,
                  box[MOSAIC_AXIAL].height);
    mosaic_lay_out(&layout, scene, &wide); /* all in a row */
    CHECK(box[MOSAIC_AXIAL].top == 0 && box[MOSAIC_AXIAL].height == wide.height);
    CHECK(box[MOSAIC_RENDITION].left + box[MOSAIC_RENDITION].width == wide.width);
}

STORY(a_pane_alone_has_the_whole_screen)
{
    OWNED(scene_drop) struct scene *scene = scene_of(18, 21, 18);
    struct mosaic_screen screen = screen_of(80, 22, 8, 16);
    screen.shows_all = false;
    for (int pane = 0; pane < MOSAIC_PANES; pane++) {
        struct mosaic_layout layout;
        screen.alone = (enum mosaic_pane)pane;
        mosaic_lay_out(&layout, scene, &screen);
        for (int i = 0; i < MOSAIC_PANES; i++)
            CHECK(layout.box[i].width == (i == pane ? screen.width : 0));
        CHECK(layout.box[pane].height == screen.height);
    }
}

/* Each pane shows, pixel by pixel, the same as the slice alone, and the same voxels. */
STORY(panes_show_what_slices_alone_would_however_magnified)
{
    struct slice_style style = {.least = "", .most = "", .crosses = true};
    static struct palette palette;
    static bool visible[256];
    OWNED(scene_drop) struct scene *scene = scene_of(30, 36, 20);
    OWNED(rendition_release) struct rendition r;
    uint64_t seed = 8;
    style.palette = &palette;
    style.visible = visible;
    slice_window(style.grey, 0, 255);
    for (size_t i = 0; i < (size_t)scene->grid.step[2] * 20; i++)
        scene->cell[i].intensity = (uint16_t)check_below(&seed, 256);
    CHECK(rendition_init(&r, 64, 64, NULL) == OK);
    memset(r.rgba, 0, (size_t)4 * 64 * 64);
    for (unsigned i = 0; i < 60; i++) {
        struct mosaic_screen screen =
            screen_of(20 + check_below(&seed, 40), 10 + check_below(&seed, 20), cell[i % 4][0],
                      cell[i % 4][1]);
        struct mosaic_layout layout;
        struct mosaic_choice choice = {.layout = &layout, .times = 1000 + check_below(&seed, 9000)};
        OWNED(canvas_release) struct canvas canvas;
        uint32_t wrong = 0;
        screen.shows_all = i % 3;
        screen.alone = (enum mosaic_pane)check_below(&seed, 4);
        choice.has_middle = check_below(&seed, 2);
        for (int a = 0; a < 3; a++) {
            choice.place[a] = check_below(&seed, scene->grid.size[a]);
            choice.middle[a] = check_below(&seed, scene->grid.size[a]);
        }
        mosaic_lay_out(&layout, scene, &screen);
        CHECK(canvas_init(&canvas, screen.width, screen.height, CANVAS_CELLS, NULL) == OK);
        CHECK(mosaic_draw(&canvas, scene, &r, &choice, &style, NULL) == OK);
        for (uint32_t p = 0; p < screen.width * screen.height; p++)
            wrong += canvas.cell[p] != mosaic_cell_at(scene, screen.width, screen.height, &r,
                                                      &choice, p % screen.width, p / screen.width);
        for (int plane = 0; plane < 3; plane++) {
            const struct mosaic_box *box = &layout.box[plane];
            const struct slice_choice slice =
                mosaic_slice(scene, &choice, screen.width, screen.height, (enum slice_plane)plane);
            OWNED(canvas_release) struct canvas alone = {0};
            if (box->width == 0)
                continue;
            CHECK(canvas_init(&alone, box->width, box->height, CANVAS_CELLS, NULL) == OK);
            CHECK(slice_draw(&alone, scene, &slice, &style, NULL) == OK);
            for (uint32_t y = 0; y < box->height; y++) {
                const size_t at = (size_t)(box->top + y) * canvas.stride + box->left;
                wrong += memcmp(canvas.rgba + 4 * at, canvas_pixel(&alone, 0, y),
                                4 * (size_t)box->width) != 0;
                wrong += memcmp(canvas.cell + at, alone.cell + y * alone.stride,
                                sizeof *alone.cell * box->width) != 0;
            }
        }
        CHECK_INT(wrong, 0);
    }
}
