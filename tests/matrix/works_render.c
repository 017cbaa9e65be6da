/* Renditions in every mode, look, view and cut; slices and mosaics with their words. */
#include "tests/matrix/works.h"

#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "render/cut.h"
#include "render/decoration.h"
#include "render/mip.h"
#include "render/mosaic.h"
#include "render/slice.h"
#include "render/text.h"
#include "tests/border_check.h"
#include "tests/stage.h"

enum { WIDTH = 90, HEIGHT = 70 };

static void stage_set(struct stage *s)
{
    static const struct weight_choice morph = {WEIGHT_MORPH, 1};
    struct weight_work work = {0};
    struct edit edit[WORKS_SEEDS];
    struct fault fault;
    must(stage_take(s, works_scene(), 6, &fault), &fault, "a forest and a border");
    must(weight_work_reserve(&work, &s->scene->grid, &morph, &fault), &fault, "room for weights");
    weight_compute(s->scene, forest_adjacency(s->forest), &morph, &work);
    weight_work_release(&work);
    works_edits(edit, s->scene, 3);
    must(forest_edit(s->forest, edit, WORKS_SEEDS, &fault), &fault, "the seeds");
    s->border.visible[1] = false;
    border_recount(&s->border);
    s->view.width = WIDTH;
    s->view.height = HEIGHT;
    s->view.zoom = 1300;
    s->shader.window[1] = 255;
    must(rendition_init(&s->rendition, WIDTH, HEIGHT, &fault), &fault, "a rendition");
}

static void look_from(struct stage *s)
{
    struct fault fault;
    must(camera_init(&s->camera, s->scene, &s->view, &fault), &fault, "a view");
}

static void colour(struct stage *s)
{
    struct fault fault;
    must(shade(&s->rendition, &s->camera, &s->border, &s->palette, &s->look, &s->shader, &fault),
         &fault, "shading");
}

/* The one digest that all ways of making the picture have. */
static void tell_picture(struct stage *s, const char *name, int number)
{
    static void (*const way[])(struct rendition *, const struct camera *,
                               const struct border *) = {splat_border, splat_scene, raycast};
    uint64_t digest[3];
    for (int i = 0; i < 3; i++) {
        shader_release(&s->shader);
        must(stage_fit_border(s), &(struct fault){0}, "a border");
        must(layers_take(&s->layers, &s->rendition, &s->border, &s->shader.seams, NULL),
             &(struct fault){0}, "layers");
        way[i](&s->rendition, &s->camera, &s->border);
        colour(s);
        digest[i] = rendition_digest(&s->rendition);
    }
    must_hold(digest[0] == digest[1] && digest[0] == digest[2], "one picture in every mode");
    tell(digest[0], "rendition/%s/%d", name, number);
}

static void views(struct stage *s)
{
    static const int32_t angle[][3] = {
        {0, 0, 0},          {90000, 0, 0},     {180000, 0, 0},
        {0, 90000, 0},      {45000, 45000, 0}, {30000, 15000, 200000},
        {123456, 65432, 1}, {359999, 1, 1},    {1, 270001, 89999}};
    for (size_t i = 0; i < sizeof angle / sizeof angle[0]; i++) {
        memcpy(s->view.angle, angle[i], sizeof angle[i]);
        s->view.zoom = 700 + 400 * (uint32_t)i;
        look_from(s);
        tell_picture(s, "view", (int)i);
    }
    s->view.zoom = 1300;
    for (uint32_t i = 0; i < 3; i++) {
        const uint32_t place[3] = {10 * i, 39 - i, 5 + 11 * i};
        view_focus_on(&s->view, s->scene, place);
        look_from(s);
        view_pan(&s->view, &s->camera, 3141 * (int64_t)i, -2718);
        look_from(s);
        tell_picture(s, "focus", (int)i);
    }
    s->view = view_default(s->scene);
    s->view.width = WIDTH;
    s->view.height = HEIGHT;
    s->view.angle[0] = 30000;
    s->view.angle[1] = 20000;
    look_from(s);
}

static void looks(struct stage *s)
{
    for (int i = 0; i < 48; i++) {
        s->look = look_default(i < 24 ? LOOK_FIRST : LOOK_PRESENT);
        s->look.mode = (enum shade_mode)(i % 24 % 4);
        s->look.edges = (uint32_t)i / 3 % 2;
        s->look.cue_percent = (uint32_t)(i % 24 * 4);
        s->look.light[0] = i * 14321;
        s->look.light[1] = i * 3456 - 40000;
        tell_picture(s, "look", i);
    }
    s->look = look_default(LOOK_PRESENT);
}

static void samples(struct stage *s)
{
    for (uint32_t n = 2; n <= SHADE_SAMPLES_MOST; n += 2) {
        struct fault fault;
        struct rendition reduced;
        must(rendition_init(&reduced, WIDTH / n, HEIGHT / n, &fault), &fault, "a rendition");
        rendition_release(&s->rendition);
        s->view.width = WIDTH / n * n;
        s->view.height = HEIGHT / n * n;
        must(rendition_init(&s->rendition, s->view.width, s->view.height, &fault), &fault,
             "a rendition");
        look_from(s);
        s->look.samples = n;
        tell_picture(s, "fine", (int)n);
        rendition_reduce(&reduced, &s->rendition, n);
        tell(rendition_digest(&reduced), "rendition/reduced/%u", n);
        rendition_release(&reduced);
    }
    rendition_release(&s->rendition);
    s->view.width = WIDTH;
    s->view.height = HEIGHT;
    s->look = look_default(LOOK_PRESENT);
    must(rendition_init(&s->rendition, WIDTH, HEIGHT, NULL), &(struct fault){0}, "a rendition");
    look_from(s);
}

static void cuts(struct stage *s)
{
    static const int32_t ahead[][3] = {{1000, 0, 0}, {300, -500, 700}, {-1, 1, -1}};
    for (uint32_t i = 0; i < 9; i++) {
        struct cut cut = cut_none();
        const uint32_t place[3] = {20 + i, 19, 15 + i};
        if (i % 3 == 0) {
            cut.first[i / 3] = 7;
            cut.last[i / 3] = 22;
        } else if (i % 3 == 1) {
            cut.plane[cut.planes++] = cut_plane_through(s->scene, place, ahead[i / 3]);
        } else {
            cut.box[cut.boxes++] = (struct cut_box){{3, i, 0}, {30, 20 + i, 16}};
        }
        s->border.cut = cut;
        border_recount(&s->border);
        must_hold(border_check(&s->border, NULL), "the border");
        tell_picture(s, "cut", (int)i);
    }
    s->border.cut = cut_none();
    border_recount(&s->border);
}

/* Translucent objects, and the scene behind them. */
static void translucent(struct stage *s)
{
    struct mip mip = {0};
    uint8_t *opacity = s->border.opacity;
    for (uint32_t i = 0; i < 12; i++) {
        for (uint32_t label = 1; label < 8; label++)
            opacity[label] = (uint8_t)(100 - (label * 29 + i * 17) % 100);
        s->look.edges = i % 2;
        s->look.mode = (enum shade_mode)(i / 2 % 3);
        tell_picture(s, "translucent", (int)i);
    }
    memset(opacity, BORDER_OPAQUE, sizeof s->border.opacity);
    s->look = look_default(LOOK_PRESENT);
    for (int i = 0; i < 4; i++) {
        struct mip_source source = {s->scene, 0, {i * 40, 255 - i * 70}, cut_none()};
        uint64_t digest = 0;
        must(mip_draw(&mip, &source, &s->camera, NULL, NULL), &(struct fault){0}, "a projection");
        for (size_t pixel = 0; pixel < (size_t)WIDTH * HEIGHT; pixel++)
            digest += hash_mix_at(pixel, mip.brightness[pixel]);
        tell(digest, "mip/%d", i);
    }
    mip_release(&mip);
}

/* The picture follows edits, and stays what one from nothing would be. */
static void incremental(struct stage *s)
{
    struct edit edit[WORKS_SEEDS];
    struct fault fault;
    works_edits(edit, s->scene, 29);
    shader_release(&s->shader);
    must(stage_fit_border(s), &fault, "a border");
    splat_border(&s->rendition, &s->camera, &s->border);
    colour(s);
    for (int i = 0; i < 20; i++) {
        must(forest_edit(s->forest, &edit[i], 1, &fault), &fault, "an edit");
        const struct changes changes = forest_changes(s->forest);
        border_update(&s->border, &changes);
        incremental_image(&s->rendition, &s->camera, &s->border, &changes,
                          shade_reach(&s->look, &s->camera));
        colour(s);
        tell(rendition_digest(&s->rendition), "rendition/incremental/%d", i);
    }
    tell_picture(s, "incremental-whole", 19);
}

static void slices(struct stage *s)
{
    static struct slice_style style;
    static const char *const title[3] = {"axial 12", "coronal 7", "sagittal ~!"};
    struct canvas canvas;
    struct fault fault;
    style = (struct slice_style){.palette = &s->palette,
                                 .visible = s->border.visible,
                                 .crosses = true,
                                 .marks_seeds = true,
                                 .least = "-12.5",
                                 .most = "1040"};
    slice_window(style.grey, 210, 5);
    must(canvas_init(&canvas, WIDTH, HEIGHT, true, &fault), &fault, "a canvas");
    for (int i = 0; i < 18; i++) {
        const struct slice_choice choice = {.plane = (enum slice_plane)(i % 3),
                                            .place = {23, 11, 17},
                                            .pixel_pm = i % 2 ? 0 : UINT64_C(333333333),
                                            .smooth = i % 4 < 2,
                                            .notes = SLICE_LETTERS | SLICE_SCALE | SLICE_COLOURS,
                                            .title = title[i % 3]};
        style.overlay = (enum slice_overlay)(i / 3 % 3);
        style.marks_rims = i >= 9;
        must(slice_draw(&canvas, s->scene, &choice, &style, &fault), &fault, "a slice");
        tell(canvas_digest(&canvas), "slice/%d", i);
    }
    const struct mosaic_choice mosaic = {
        .place = {5, 30, 20}, .title = {title[0], title[1], title[2]}, .notes = true};
    must(mosaic_draw(&canvas, s->scene, &s->rendition, &mosaic, &style, &fault), &fault,
         "a mosaic");
    tell(canvas_digest(&canvas), "mosaic");
    struct mosaic_choice bright = mosaic;
    bright.background = BACKGROUND_WHITE;
    must(mosaic_draw(&canvas, s->scene, &s->rendition, &bright, &style, &fault), &fault,
         "a mosaic");
    tell(canvas_digest(&canvas), "mosaic/white");
    text_draw(&canvas, -3, 5, 2, "The quick brown fox\n0123 {|}~ \x7f", (uint8_t[]){9, 200, 30});
    tell(canvas_digest(&canvas), "text");
    canvas_release(&canvas);
}

/* What is drawn over a picture of four times the size, from some sides. */
static void decorations(struct stage *s)
{
    static const struct legend_line line[] = {{2, "brain", "1.43 l"}, {3, "a label", "202 ml"}};
    const uint32_t middle = grid_cell(&s->scene->grid, 20, 19, 15);
    struct canvas canvas;
    struct fault fault;
    rendition_release(&s->rendition);
    s->view.width = 4 * WIDTH;
    s->view.height = 4 * HEIGHT;
    s->view.zoom *= 4;
    must(rendition_init(&s->rendition, s->view.width, s->view.height, &fault), &fault,
         "a rendition");
    must(canvas_init(&canvas, s->view.width, s->view.height, false, &fault), &fault, "a canvas");
    for (int i = 0; i < 8; i++) {
        s->view.angle[0] = i * 51000;
        s->view.angle[1] = i * 13000;
        look_from(s);
        must(stage_fit_border(s), &fault, "a border");
        splat_border(&s->rendition, &s->camera, &s->border);
        colour(s);
        memcpy(canvas.rgba, s->rendition.rgba, (size_t)4 * canvas.width * canvas.height);
        const uint32_t seen =
            s->rendition.cell[canvas.width * (canvas.height / 2) + canvas.width / 2];
        const struct decoration d = {.parts = DECORATE_ALL,
                                     .frame = &s->rendition,
                                     .camera = &s->camera,
                                     .samples = 1,
                                     .palette = &s->palette,
                                     .is_bright = i % 2,
                                     .line = line,
                                     .lines = 2,
                                     .eliminator = &seen,
                                     .eliminators = seen != CELL_NONE,
                                     .cross = seen == CELL_NONE ? middle : seen};
        must(decoration_draw(&canvas, &d, &fault), &fault, "decorations");
        tell(canvas_digest(&canvas), "decorated/%d", i);
    }
    canvas_release(&canvas);
}

void works_render(void)
{
    struct stage stage;
    stage_set(&stage);
    views(&stage);
    looks(&stage);
    samples(&stage);
    cuts(&stage);
    translucent(&stage);
    incremental(&stage);
    slices(&stage);
    decorations(&stage);
    stage_release(&stage);
}
