/* SPDX-License-Identifier: MIT */
/* The rendition: four ways to draw it, equal pixel for pixel. */
#include "tests/check_main.h"

#include "tests/stage.h"

/* Compare the layers of each pixel, up to the opaque one. */
static bool same_layers(const struct rendition *r, const struct layers *a, const struct layers *b)
{
    for (size_t pixel = 0; r->layers && pixel < (size_t)r->width * r->height; pixel++)
        for (unsigned k = 0; k <= LAYERS_MOST; k++) {
            const struct layer p = layers_at(a, pixel, k), q = layers_at(b, pixel, k);
            if (p.depth != q.depth || p.cell != q.cell || p.label != q.label)
                return false;
            if (p.depth == a->last[pixel].depth)
                break;
        }
    return true;
}

/* Check that every visible voxel is shown, with the label of the pixel. */
static bool shows_voxels(const struct stage *s, const struct rendition *r)
{
    for (size_t i = 0; i < (size_t)r->width * r->height; i++) {
        const uint32_t cell = r->cell[i];
        const uint8_t label = cell == CELL_NONE ? 0 : labels_at(&s->border.labels, cell);
        if ((cell != CELL_NONE && !border_shows(&s->border, cell)) || r->label[i] != label)
            return false;
    }
    return true;
}

/* `kept` has been updated incrementally through all edits, with its shader; the others are drawn
 * from scratch. */
static bool modes_agree(struct stage *s, struct rendition *kept)
{
    OWNED(rendition_release) struct rendition bp = {0}, other = {0};
    struct shader keeper = s->shader;
    struct layers layers = s->layers;
    struct mesh mesh = s->mesh;
    s->mesh = (struct mesh){0};
    s->shader = (struct shader){0};
    s->layers = (struct layers){0};
    CHECK(rendition_init(&bp, s->view.width, s->view.height, NULL) == OK);
    CHECK(rendition_init(&other, s->view.width, s->view.height, NULL) == OK);
    stage_render(s, &bp, project_border);
    CHECK(shows_voxels(s, &bp));
    bool same = CHECK(same_layers(&bp, &layers, &s->layers));
    stage_render(s, &other, project_scene);
    same = CHECK(stage_same_pixels(&bp, &other, "scene projection")) && same;
    same = CHECK(same_layers(&other, &layers, &s->layers)) && same;
    stage_render(s, &other, project_rays);
    same = CHECK(stage_same_pixels(&bp, &other, "ray walk")) && same;
    same = CHECK(same_layers(&other, &layers, &s->layers)) && same;
    same = CHECK(stage_same_pixels(&bp, kept, "incremental image")) && same;
    shader_release(&s->shader);
    layers_release(&s->layers);
    mesh_release(&s->mesh);
    s->mesh = mesh;
    s->shader = keeper;
    s->layers = layers;
    return same;
}

static int32_t random_angle(uint64_t *random)
{
    uint32_t kind = check_below(random, 4);
    if (kind == 0)
        return (int32_t)check_below(random, 8) * 45000;
    if (kind == 1)
        return (int32_t)((check_below(random, 8) * 45000 + check_below(random, 3) + 359999) %
                         360000);
    return (int32_t)check_below(random, 360000);
}

static void random_view(struct stage *s, uint64_t *random)
{
    for (int i = 0; i < 3; i++)
        s->view.angle[i] = random_angle(random);
    s->view.width = 1 + check_below(random, 80);
    s->view.height = 1 + check_below(random, 80);
    s->view.zoom = check_below(random, 3) ? 500 + check_below(random, 5000) : 1000;
    CHECK(camera_init(&s->camera, s->scene, &s->view, NULL) == OK);
    const struct view centred = s->view;
    uint32_t place[3];
    if (check_below(random, 2)) { /* any focus, even outside the scene */
        random_place(&s->scene->grid, random, place);
        view_focus_on(&s->view, s->scene, place);
        view_pan(&s->view, &s->camera, check_below(random, 20001) - (int64_t)10000,
                 check_below(random, 20001) - (int64_t)10000);
    }
    if (camera_init(&s->camera, s->scene, &s->view, NULL) != OK) {
        s->view = centred;
        CHECK(camera_init(&s->camera, s->scene, &s->view, NULL) == OK);
    }
}

static void random_look(struct stage *s, uint64_t *random)
{
    s->look.mode = check_below(random, 4) == 1 ? SHADE_CUBES : SHADE_SURFACE;
    s->look.light[0] = (int32_t)check_below(random, 360001) - 180000;
    s->look.light[1] = (int32_t)check_below(random, 180001) - 90000;
    s->look.cue_percent = check_below(random, 101);
    s->look.ao_percent = stage_occlusion(random);
    s->look.creases = check_below(random, 2);
    s->look.edges = check_below(random, 2);
    s->look.samples = 1u << check_below(random, 3); /* width of edges */
    stage_opacities(s, random);
}

static void random_sitting(uint64_t seed)
{
    uint64_t random = seed;
    OWNED(stage_release) struct stage s;
    struct rendition kept;
    uint32_t size[3];
    for (int a = 0; a < 3; a++)
        size[a] = 1 + check_below(&random, check_below(&random, 3) ? 30 : 4);
    CHECK(stage_init(&s, size, check_below(&random, 2) ? 26 : 6, NULL) == OK);
    const uint32_t brightest = 1 + check_below(&random, UINT16_MAX);
    random_values(s.scene, brightest, &random);
    stage_turn_at_random(&s, &random);
    for (int i = 0; i < 4; i++)
        stage_edit_at_random(&s, &random);
    for (int look = 0; look < 3 && check_failures == 0; look++) {
        random_view(&s, &random);
        random_look(&s, &random);
        CHECK(rendition_init(&kept, s.view.width, s.view.height, NULL) == OK);
        stage_render(&s, &kept, project_border);
        for (int step = 0; step < 4 && check_failures == 0; step++) {
            const struct changes changes = stage_edit_at_random(&s, &random);
            stage_follow(&s, &kept, &changes);
            stage_shade(&s, &kept);
            if (!modes_agree(&s, &kept))
                printf("# seed %" PRIu64 " look %d step %d size %ux%ux%u angles %d %d %d zoom %u\n",
                       seed, look, step, size[0], size[1], size[2], s.view.angle[0],
                       s.view.angle[1], s.view.angle[2], s.view.zoom);
        }
        rendition_release(&kept);
    }
}

STORY(the_four_modes_agree_in_every_pixel)
{
    const unsigned sittings = check_scaled(80);
    for (unsigned i = 0; i < sittings && check_failures == 0; i++)
        random_sitting(i);
}

STORY(sines_are_right_and_symmetric)
{
    CHECK_INT(view_sine(0), 0);
    CHECK_INT(view_sine(90000), 1 << 30);
    CHECK_INT(view_sine(180000), 0);
    CHECK_INT(view_sine(270000), -(1 << 30));
    CHECK(labs((long)view_sine(30000) - (1 << 29)) <= 4);
    CHECK(labs((long)view_sine(45000) - 759250125) <= 4);
    for (int32_t a = 1; a < 90000; a += 7) {
        int64_t s = view_sine(a), c = view_sine(90000 - a);
        CHECK(llabs(s * s + c * c - (INT64_C(1) << 60)) < INT64_C(1) << 34);
        CHECK(view_sine(180000 - a) == s && view_sine(-a) == -s);
    }
}

/* One object voxel at each end of each axis, in a scene whose axes are the world's. */
static uint8_t label_at(const struct rendition *r, uint32_t x, uint32_t y)
{
    return r->label[(size_t)y * r->width + x];
}

STORY(a_scene_of_very_thick_slices_has_a_view)
{
    OWNED(stage_release) struct stage s;
    CHECK(stage_init(&s, (uint32_t[]){10, 10, 1}, 6, NULL) == OK);
    for (uint32_t thick = 1; thick < 25000; thick = thick * 3 / 2 + 1) {
        s.scene->spacing_nm[0] = s.scene->spacing_nm[1] = 100000;
        s.scene->spacing_nm[2] = thick * 100000;
        s.view = view_default(s.scene);
        CHECK(camera_init(&s.camera, s.scene, &s.view, NULL) == OK);
        s.view.zoom = view_fitting_zoom(s.scene, 512, 512, 1);
        CHECK(camera_init(&s.camera, s.scene, &s.view, NULL) == OK);
    }
}

STORY(named_views_show_the_patient_from_the_side_they_name)
{
    OWNED(stage_release) struct stage s;
    OWNED(rendition_release) struct rendition r;
    CHECK(stage_init(&s, (uint32_t[]){21, 21, 21}, 6, NULL) == OK);
    for (size_t i = 0; i < s.scene->grid.cells; i++)
        if (!(s.scene->cell[i].flags & CELL_RIM))
            s.scene->cell[i].weight = 9;
    /* Only single voxels have labels: 1 right, 2 left, 3 front, 4 back, 5 top, 6 bottom. */
    static const int end[6][3] = {{20, 10, 10}, {0, 10, 10},  {10, 20, 10},
                                  {10, 0, 10},  {10, 10, 20}, {10, 10, 0}};
    for (size_t i = 0; i < s.scene->grid.cells; i++)
        s.scene->cell[i].label = 0;
    for (int i = 0; i < 6; i++)
        s.scene
            ->cell[grid_cell(&s.scene->grid, (uint32_t)end[i][0], (uint32_t)end[i][1],
                             (uint32_t)end[i][2])]
            .label = (uint8_t)(i + 1);
    border_recount(&s.border);
    static const struct {
        const char *name;
        uint8_t centre, left, right, above, below;
    } expected[] = {
        {"front", 3, 1, 2, 5, 6}, {"back", 4, 2, 1, 5, 6}, {"left", 2, 3, 4, 5, 6},
        {"right", 1, 4, 3, 5, 6}, {"top", 5, 2, 1, 3, 4},  {"bottom", 6, 1, 2, 3, 4},
    };
    s.view.width = s.view.height = 41;
    s.view.zoom = 1000;
    CHECK(rendition_init(&r, 41, 41, NULL) == OK);
    for (size_t i = 0; i < sizeof expected / sizeof expected[0]; i++) {
        CHECK(view_by_name(expected[i].name, s.view.angle));
        CHECK_TEXT(view_name(s.view.angle), expected[i].name);
        CHECK(camera_init(&s.camera, s.scene, &s.view, NULL) == OK);
        stage_render(&s, &r, project_border);
        CHECK_INT(label_at(&r, 20, 20), expected[i].centre);
        CHECK_INT(label_at(&r, 10, 20), expected[i].left);
        CHECK_INT(label_at(&r, 30, 20), expected[i].right);
        CHECK_INT(label_at(&r, 20, 10), expected[i].above);
        CHECK_INT(label_at(&r, 20, 30), expected[i].below);
    }
}

/* Rounding errors of one voxel must not add up over a long row. */
STORY(a_long_row_of_voxels_is_seen_whole)
{
    static const uint32_t zoom[] = {10, 97, 999};
    static const uint32_t length[] = {65534, 40000, 8000};
    for (int i = 0; i < 3; i++) {
        OWNED(stage_release) struct stage s;
        struct rendition splatted, walked;
        CHECK(stage_init(&s, (uint32_t[]){length[i], 1, 1}, 6, NULL) == OK);
        struct edit seed = {grid_cell(&s.scene->grid, length[i] / 2, 0, 0), 1, 0};
        CHECK(forest_edit(s.forest, &seed, 1, NULL) == OK);
        border_recount(&s.border);
        s.view.zoom = zoom[i];
        for (int side = 0; side < 2; side++) {
            s.view.angle[2] = side * 90000;
            s.view.width = side ? 3 : 8192;
            s.view.height = side ? 8192 : 3;
            CHECK(camera_init(&s.camera, s.scene, &s.view, NULL) == OK);
            CHECK(rendition_init(&splatted, s.view.width, s.view.height, NULL) == OK);
            CHECK(rendition_init(&walked, s.view.width, s.view.height, NULL) == OK);
            stage_render(&s, &splatted, project_border);
            stage_render(&s, &walked, project_rays);
            CHECK(stage_same_pixels(&splatted, &walked, "ray walk"));
            rendition_release(&splatted);
            rendition_release(&walked);
        }
    }
}

/* A voxel of a wall gets another label: nothing moves, and the lines around it are in neighbouring
 * tiles. */
STORY(lines_around_what_changes_are_drawn_anew)
{
    OWNED(stage_release) struct stage s;
    OWNED(rendition_release) struct rendition kept;
    CHECK(stage_init(&s, (uint32_t[]){24, 4, 24}, 6, NULL) == OK);
    for (uint32_t v = 0; v < s.scene->grid.voxels; v++)
        s.scene->cell[grid_cell(&s.scene->grid, v % 24, v / 24 % 4, v / 96)].label = 1;
    border_recount(&s.border);
    s.look.edges = 1;
    s.look.samples = 4;
    s.view.width = s.view.height = 96;
    s.view.zoom = 3300;
    CHECK(camera_init(&s.camera, s.scene, &s.view, NULL) == OK);
    CHECK(rendition_init(&kept, 96, 96, NULL) == OK);
    stage_render(&s, &kept, project_border);
    for (uint32_t i = 0; i < 40 && check_failures == 0; i++) {
        const uint32_t cell = grid_cell(&s.scene->grid, 4 + i * 7 % 16, 3, 4 + i * 5 % 16);
        struct change change = {cell, s.scene->cell[cell].label, 1 + i % 2};
        const struct changes changes = {.item = &change, .count = 1, .listed = 1, .voxels = 1};
        s.scene->cell[cell].label = change.label;
        border_update(&s.border, &changes);
        stage_follow(&s, &kept, &changes);
        stage_shade(&s, &kept);
        modes_agree(&s, &kept);
    }
}

/* Anything that a camera accepts: voxels far smaller than a pixel or as large as the picture, long
 * rows, and very different spacings. */
STORY(the_four_modes_agree_however_large_or_long_voxels_are)
{
    unsigned drawn = 0;
    for (unsigned i = 0; i < 200 && check_failures == 0; i++) {
        uint64_t random = 7000 + i;
        OWNED(stage_release) struct stage s;
        struct rendition kept;
        const bool is_long = i % 10 == 0;
        uint32_t size[3];
        for (int a = 0; a < 3; a++)
            size[a] = 1 + check_below(&random, is_long ? 2 : 9);
        if (is_long)
            size[check_below(&random, 3)] = i % 40 ? 500 + check_below(&random, 5000) : 65534;
        CHECK(stage_init(&s, size, 6, NULL) == OK);
        for (int a = 0; a < 3; a++) {
            const uint32_t bits = check_below(&random, i % 3 ? 4 : 20);
            s.scene->spacing_nm[a] = 1 + (uint32_t)(check_random(&random) >> (44 - bits));
            s.scene->world_sign[a] = check_below(&random, 2) ? 1 : -1;
        }
        for (int edit = 0; edit < 3; edit++)
            stage_edit_at_random(&s, &random);
        random_look(&s, &random);
        for (int k = 0; k < 3; k++)
            s.view.angle[k] = random_angle(&random);
        s.view.width = 1 + check_below(&random, 60);
        s.view.height = 1 + check_below(&random, 60);
        s.view.zoom = (uint32_t)(10 << check_below(&random, 13)) + check_below(&random, 10);
        s.view.zoom = s.view.zoom < VIEW_ZOOM_MOST ? s.view.zoom : VIEW_ZOOM_MOST;
        if (check_below(&random, 2)) {
            uint32_t place[3];
            random_place(&s.scene->grid, &random, place);
            view_focus_on(&s.view, s.scene, place);
        }
        if (camera_init(&s.camera, s.scene, &s.view, NULL) == OK) {
            drawn++;
            CHECK(rendition_init(&kept, s.view.width, s.view.height, NULL) == OK);
            stage_render(&s, &kept, project_border);
            const struct changes changes = stage_edit_at_random(&s, &random);
            stage_follow(&s, &kept, &changes);
            stage_shade(&s, &kept);
            if (!modes_agree(&s, &kept))
                printf("# number %u: size %ux%ux%u spacing %u %u %u zoom %u\n", i, size[0], size[1],
                       size[2], s.scene->spacing_nm[0], s.scene->spacing_nm[1],
                       s.scene->spacing_nm[2], s.view.zoom);
            rendition_release(&kept);
        }
    }
    CHECK(drawn > 120);
}

STORY(absurd_views_are_refused_in_words)
{
    OWNED(stage_release) struct stage s;
    struct fault fault;
    CHECK(stage_init(&s, (uint32_t[]){2, 2, 60000}, 6, NULL) == OK);
    s.scene->spacing_nm[0] = 1;
    s.scene->spacing_nm[2] = 4000000000u;
    CHECK_INT(camera_init(&s.camera, s.scene, &s.view, &fault), ERR_LIMIT);
    CHECK_HAS(fault.text, "unchanged");
    s.scene->spacing_nm[2] = 1;
    s.scene->spacing_nm[1] = 1;
    s.view.zoom = VIEW_ZOOM_MOST;
    CHECK_INT(camera_init(&s.camera, s.scene, &s.view, &fault), ERR_LIMIT);
}
