/* SPDX-License-Identifier: MIT */
/* Renditions in every mode, look, view and cut, fitted, translucent and with what is behind them;
 * slices and mosaics with their words. */
#include "tests/matrix/works.h"

#include "base/hash.h"
#include "render/palette.h"
#include "render/cut.h"
#include "render/decoration.h"
#include "render/fit.h"
#include "render/mip.h"
#include "render/mosaic.h"
#include "render/slice.h"
#include "render/notes.h"
#include "tests/border_check.h"
#include "tests/stage.h"

enum { WIDTH = 90, HEIGHT = 70 };

static void stage_set(struct stage *s)
{
    static const struct weight_choice morph = {WEIGHT_MORPH, 1};
    OWNED(weight_work_release) struct weight_work work = {0};
    struct edit edit[WORKS_SEEDS];
    struct fault fault;
    must(stage_take(s, works_scene(), 6, &fault), &fault, "a forest and a border");
    must(weight_work_reserve(&work, &s->scene->grid, &morph, &fault), &fault, "room for weights");
    weight_compute(s->scene, forest_adjacency(s->forest), &morph, &work);
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
    must(shade(&s->rendition, &s->camera, &s->mesh, &s->palette, &s->look, &s->shader, &fault),
         &fault, "shading");
    stage_fill(&s->rendition);
}

/* Nothing kept of other pictures, and layers where something is translucent. */
static void begin_picture(struct stage *s)
{
    shader_release(&s->shader);
    mesh_release(&s->mesh);
    must(mesh_update(&s->mesh, &s->border, shade_kind(&s->look), NULL, NULL, NULL),
         &(struct fault){0}, "a mesh");
    must(layers_attach(&s->layers, &s->rendition, &s->border, NULL), &(struct fault){0}, "layers");
}

/* The one digest that all ways of making the picture have. */
static void tell_picture(struct stage *s, const char *name, int number)
{
    static projection *const way[] = {project_border, project_scene, project_rays};
    uint64_t digest[3];
    for (int i = 0; i < 3; i++) {
        begin_picture(s);
        way[i](&s->rendition, &s->camera, &s->mesh);
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
    for (int i = 0; i < 24; i++) {
        s->look = look_default();
        s->look.mode = i % 4 == 1 ? SHADE_CUBES : SHADE_SURFACE;
        s->look.edges = (uint32_t)i / 3 % 2;
        s->look.cue_percent = (uint32_t)(i * 4);
        s->look.light[0] = i * 14321;
        s->look.light[1] = i * 3456 - 40000;
        tell_picture(s, "look", i);
        s->look.ao_percent = (uint32_t)(100 - 3 * i);
        s->look.creases = 1;
        tell_picture(s, "occluded", i);
    }
    s->look = look_default();
}

/* Another number of pixels, with the same view otherwise. */
static void resize(struct stage *s, uint32_t width, uint32_t height)
{
    struct fault fault;
    rendition_release(&s->rendition);
    s->view.width = width;
    s->view.height = height;
    must(rendition_init(&s->rendition, width, height, &fault), &fault, "a rendition");
    look_from(s);
}

/* The picture, of n x n samples a pixel. */
static void sample(struct stage *s, struct rendition *reduced, const char *name, uint32_t n)
{
    struct fault fault;
    must(rendition_init(reduced, WIDTH / n, HEIGHT / n, &fault), &fault, "a rendition");
    resize(s, WIDTH / n * n, HEIGHT / n * n);
    s->look.samples = n;
    tell_picture(s, name, (int)n);
    rendition_reduce(reduced, &s->rendition, n, NULL);
    tell(rendition_digest(reduced), "rendition/%s/reduced/%u", name, n);
}

static void samples(struct stage *s)
{
    for (uint32_t n = 2; n <= SHADE_SAMPLES_MOST; n += 2) {
        OWNED(rendition_release) struct rendition reduced;
        sample(s, &reduced, "fine", n);
    }
    s->look = look_default();
    resize(s, WIDTH, HEIGHT);
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
            cut.plane[cut.planes++] = stage_plane_through(s->scene, place, ahead[i / 3]);
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
    OWNED(mip_release) struct mip mip = {0};
    uint8_t *opacity = s->border.opacity;
    const uint32_t zoom = s->view.zoom;
    for (uint32_t i = 0; i < 12; i++) {
        s->view.zoom = i % 4 < 2 ? zoom : 5 * VIEW_ZOOM_ONE; /* voxels are small, or large */
        look_from(s);
        for (uint32_t label = 1; label < 8; label++)
            opacity[label] = (uint8_t)(100 - (label * 29 + i * 17) % 100);
        s->look.edges = i % 2;
        s->look.mode = i / 2 % 3 == 1 ? SHADE_CUBES : SHADE_SURFACE;
        tell_picture(s, "translucent", (int)i);
    }
    s->view.zoom = zoom;
    look_from(s);
    memset(opacity, BORDER_OPAQUE, sizeof s->border.opacity);
    s->look = look_default();
    for (int i = 0; i < 4; i++) {
        struct mip_source source = {s->scene, 0, {i * 40, 255 - i * 70}, cut_none()};
        uint64_t digest = 0;
        must(mip_draw(&mip, &source, &s->camera, NULL, NULL), &(struct fault){0}, "a projection");
        for (size_t pixel = 0; pixel < (size_t)WIDTH * HEIGHT; pixel++)
            digest += hash_mix_at(pixel, mip.brightness[pixel]);
        tell(digest, "mip/%d", i);
    }
}

/* The scene behind objects that are translucent, or cover pixels in part. */
static void put_mip_behind(struct stage *s, struct rendition *picture)
{
    const struct mip_source source = {s->scene, 0, {30, 200}, cut_none()};
    const struct view fine = s->view;
    const size_t pixels = (size_t)picture->width * picture->height;
    uint8_t objects[WIDTH * HEIGHT][4];
    OWNED(mip_release) struct mip mip = {0};
    struct fault fault;
    s->view.width = picture->width;
    s->view.height = picture->height;
    s->view.zoom /= fine.width / picture->width;
    look_from(s);
    must(mip_draw(&mip, &source, &s->camera, NULL, &fault), &fault, "a projection");
    memcpy(objects, picture->rgba, 4 * pixels);
    mip_put_behind(picture->rgba, objects[0], mip.brightness, pixels);
    tell(rendition_digest(picture), "context/%u", picture->width);
    s->view = fine;
}

static void put_backgrounds(const struct rendition *picture, const char *name)
{
    static const uint32_t background[] = {BACKGROUND_PLAIN, BACKGROUND_WHITE,
                                          BACKGROUND_PLAIN | 0x3080c0, BACKGROUND_CLEAR,
                                          BACKGROUND_GRADIENT};
    uint8_t rgba[WIDTH * HEIGHT][4];
    const size_t bytes = (size_t)4 * picture->width * picture->height;
    for (size_t i = 0; i < sizeof background / sizeof background[0]; i++) {
        memcpy(rgba, picture->rgba, bytes);
        background_put(rgba[0], picture->width, picture->height, background[i]);
        tell(bytes_digest(rgba, bytes), "background/%s/%u/%zu", name, picture->width, i);
    }
}

/* Backgrounds behind objects, each with and without the context of the scene. */
static void behind(struct stage *s)
{
    s->border.opacity[2] = 40;
    s->border.opacity[3] = 75;
    for (uint32_t n = 2; n <= SHADE_SAMPLES_MOST; n += 2) {
        OWNED(rendition_release) struct rendition reduced;
        sample(s, &reduced, "behind", n);
        put_backgrounds(&reduced, "objects");
        put_mip_behind(s, &reduced);
        put_backgrounds(&reduced, "context");
    }
    memset(s->border.opacity, BORDER_OPAQUE, sizeof s->border.opacity);
    s->look = look_default();
    resize(s, WIDTH, HEIGHT);
}

/* Zoom and place at which the shown objects fit; some labels, a part of them, and none. */
static void fits(struct stage *s)
{
    const struct view former = s->view;
    for (uint32_t i = 0; i < 12; i++) {
        struct fit fit;
        struct fault fault;
        uint32_t place[3];
        for (uint32_t label = 2; label < 6; label++)
            s->border.visible[label] = i < 11 && (i % 4 == 3 || label == 2 + i % 4);
        s->border.cut.last[2] = i % 3 ? UINT32_MAX : 14;
        border_recount(&s->border);
        s->view.angle[0] = (int32_t)i * 39000;
        s->view.angle[1] = (int32_t)i * 17000;
        s->view.angle[2] = (int32_t)i * 5000;
        must(fit_init(&fit, &s->border, &fault), &fault, "what is to fit");
        fit_place(&fit, &s->view, place);
        s->view.zoom = fit_zoom(&fit, &s->view, place, 1 + i % 4);
        fit_release(&fit);
        view_focus_on(&s->view, s->scene, place);
        look_from(s);
        tell(s->view.zoom, "fit/zoom/%u", i);
        tell(grid_cell(&s->scene->grid, place[0], place[1], place[2]), "fit/place/%u", i);
        tell_picture(s, "fit", (int)i);
    }
    for (uint32_t label = 2; label < 6; label++)
        s->border.visible[label] = true;
    s->border.cut = cut_none();
    border_recount(&s->border);
    s->view = former;
    look_from(s);
}

/* The picture follows edits, and always equals one drawn from scratch. */
static void incremental(struct stage *s)
{
    struct edit edit[WORKS_SEEDS];
    struct fault fault;
    works_edits(edit, s->scene, 29);
    begin_picture(s);
    project_border(&s->rendition, &s->camera, &s->mesh);
    colour(s);
    for (int i = 0; i < 20; i++) {
        must(forest_edit(s->forest, &edit[i], 1, &fault), &fault, "an edit");
        const struct changes changes = forest_changes(s->forest);
        border_update(&s->border, &changes);
        stage_follow(s, &s->rendition, &changes);
        colour(s);
        tell(rendition_digest(&s->rendition), "rendition/incremental/%d", i);
    }
    const uint64_t followed = rendition_digest(&s->rendition);
    tell_picture(s, "incremental-whole", 19);
    must_hold(rendition_digest(&s->rendition) == followed, "a picture that followed edits");
}

static void slices(struct stage *s)
{
    static struct slice_style style;
    static const char *const title[3] = {"axial 12", "coronal 7", "sagittal ~!"};
    OWNED(canvas_release) struct canvas canvas = {0};
    struct fault fault;
    style = (struct slice_style){.palette = &s->palette,
                                 .visible = s->border.visible,
                                 .crosses = true,
                                 .marks_seeds = true,
                                 .least = "-12.5",
                                 .most = "1040"};
    slice_window(style.grey, 210, 5);
    must(canvas_init(&canvas, WIDTH, HEIGHT, CANVAS_CELLS, &fault), &fault, "a canvas");
    for (int i = 0; i < 18; i++) {
        const struct slice_choice choice = {.plane = (enum slice_plane)(i % 3),
                                            .place = {23, 11, 17},
                                            .pixel_pm = i % 2 ? 0 : UINT64_C(333333333),
                                            .smooth = i % 4 < 2,
                                            .notes = SLICE_LETTERS | SLICE_SCALE | SLICE_COLOURS,
                                            .title = title[i % 3]};
        style.overlay = (enum slice_overlay)(i / 3 % 3);
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
    for (uint32_t tall = 7; tall <= 61; tall += 6)
        text_draw(&canvas, -3, tall, tall, "The quick br\xc3\xb6wn \xcf\x83ox\n0123 {|}~ \x7f\xff",
                  &(struct ink){{9, 200, 30}, {200, 9, 90}});
    tell(canvas_digest(&canvas), "text");
}

/* Decorations of a picture of four times the size, from some sides. */
static void decorations(struct stage *s)
{
    static const struct legend_line line[] = {{2, "brain", "1.43 l"}, {3, "a label", "202 ml"}};
    const uint32_t middle = grid_cell(&s->scene->grid, 20, 19, 15);
    OWNED(canvas_release) struct canvas canvas = {0};
    struct fault fault;
    s->view.zoom *= 4;
    resize(s, 4 * WIDTH, 4 * HEIGHT);
    must(canvas_init(&canvas, s->view.width, s->view.height, 0, &fault), &fault, "a canvas");
    for (int i = 0; i < 8; i++) {
        s->view.angle[0] = i * 51000;
        s->view.angle[1] = i * 13000;
        look_from(s);
        begin_picture(s);
        project_border(&s->rendition, &s->camera, &s->mesh);
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
}

void works_render(void)
{
    OWNED(stage_release) struct stage stage;
    stage_set(&stage);
    views(&stage);
    looks(&stage);
    samples(&stage);
    cuts(&stage);
    translucent(&stage);
    behind(&stage);
    fits(&stage);
    incremental(&stage);
    slices(&stage);
    decorations(&stage);
}
