/* SPDX-License-Identifier: MIT */
/* Layers of translucent objects: their number, their blending, and the layer that a pixel reports.
 * */
#include "tests/check_main.h"

#include <math.h>

#include "tests/ray_search.h"
#include "tests/stage.h"

static void set_label(struct stage *s, uint32_t x, uint32_t y, uint32_t z, uint8_t label)
{
    s->scene->cell[grid_cell(&s->scene->grid, x, y, z)].label = label;
}

static void draw(struct stage *s, uint32_t side)
{
    rendition_release(&s->rendition);
    s->view.width = s->view.height = side;
    border_recount(&s->border);
    stage_draw(s);
}

/* ---- which there are ---- */

/* Find the voxels on a ray, the nearest first, with the labels of visible ones. */
static size_t pass(struct passed *out, const struct stage *s, uint32_t column, uint32_t row)
{
    const size_t count = ray_search(out, &s->camera, column, row);
    for (size_t i = 0; i < count; i++) {
        const uint8_t label = s->scene->cell[out[i].cell].label;
        const bool shown =
            s->border.visible[label] && !cut_removes(&s->border.cut, &s->scene->grid, out[i].cell);
        out[i].label = shown ? label : 0;
    }
    return count;
}

/* Select the layers among them: entries into translucent objects, up to the first opaque one, which
 * *last is. */
static size_t pick_layers(struct passed *passed, size_t count, const struct stage *s,
                          struct passed *last)
{
    size_t layers = 0;
    uint8_t before = 0;
    *last = (struct passed){DEPTH_NONE, CELL_NONE, 0};
    for (size_t i = 0; i < count; i++) {
        const struct passed at = passed[i];
        const bool is_new = at.label && at.label != before;
        before = at.label;
        if (!is_new)
            continue;
        if (s->border.opacity[at.label] == BORDER_OPAQUE) {
            *last = at;
            break;
        }
        passed[layers++] = at;
    }
    return layers < LAYERS_MOST ? layers : LAYERS_MOST;
}

/* Depths must agree within a quarter of a pixel, where faces are not too steep. */
static bool is_at(int64_t depth, uint32_t cell, uint8_t label, const struct passed *expected)
{
    const int64_t apart = depth - expected->depth;
    return cell == expected->cell && label == expected->label &&
           (expected->cell == CELL_NONE || llabs(apart) < 1 << (CROSSING_PIXEL_BITS - 2));
}

static bool layers_are(const struct layers *l, size_t pixel, const struct passed *expected,
                       size_t count, const struct passed *last)
{
    bool same = is_at(l->last[pixel].depth, l->last[pixel].cell, l->last[pixel].label, last);
    for (unsigned k = 0; same && k < count; k++) {
        const struct layer layer = layers_at(l, pixel, k);
        same = is_at(layer.depth, layer.cell, layer.label, &expected[k]);
    }
    const struct layer end = layers_at(l, pixel, (unsigned)count);
    return same && (count == LAYERS_MOST || (end.cell == last->cell && end.label == last->label));
}

static void random_scene(struct stage *s, uint64_t *random)
{
    uint32_t size[3];
    for (int a = 0; a < 3; a++)
        size[a] = 1 + check_below(random, 9);
    CHECK(stage_init(s, size, 6, NULL) == OK);
    const uint32_t labels = 1 + check_below(random, 4), dense = 1 + check_below(random, 4);
    for (uint32_t v = 0; v < s->scene->grid.voxels; v++)
        set_label(s, v % size[0], v / size[0] % size[1], v / size[0] / size[1],
                  check_below(random, dense + 1) ? (uint8_t)(1 + check_below(random, labels)) : 0);
    for (int label = 1; label < 5; label++) {
        s->border.visible[label] = check_below(random, 5) != 0;
        s->border.opacity[label] = (uint8_t)(check_below(random, 3) ? 50 : 100);
    }
    for (int i = 0; i < 3; i++)
        s->view.angle[i] = (int32_t)(check_below(random, 2) ? check_below(random, 360000)
                                                            : check_below(random, 8) * 45000);
    s->view.zoom = 300 + check_below(random, 3000);
}

/* Cubes, whose faces are known. Where a ray passes an edge within a 256th of a pixel, the two may
 * differ. */
STORY(each_pixel_has_the_layers_that_its_ray_passes)
{
    uint64_t random = 5;
    const int scenes = (int)check_scaled(1500);
    size_t pixels = 0, others = 0, layers = 0;
    for (int i = 0; i < scenes; i++) {
        OWNED(stage_release) struct stage s;
        random_scene(&s, &random);
        s.look.mode = SHADE_CUBES;
        s.border.opacity[1] = 30;
        s.border.visible[1] = true;
        draw(&s, 1 + check_below(&random, 12));
        struct passed *passed = mem_array(s.scene->grid.voxels, sizeof *passed), last;
        for (uint32_t y = 0; y < s.view.height; y++)
            for (uint32_t x = 0; x < s.view.width; x++) {
                const size_t count = pick_layers(passed, pass(passed, &s, x, y), &s, &last);
                pixels++;
                layers += count;
                others +=
                    !layers_are(&s.layers, (size_t)y * s.view.width + x, passed, count, &last);
            }
        free(passed);
    }
    if (!CHECK(others * 50 < pixels && layers > pixels / 4))
        printf("# %zu of %zu pixels differ, of %zu layers\n", others, pixels, layers);
}

/* Few depths and voxels, so that many are equally near, and some are inserted twice. */
STORY(in_whatever_order_layers_are_put_they_are_the_same)
{
    enum { PUTS = 24 };
    uint64_t random = 2;
    OWNED(stage_release) struct stage s;
    OWNED(layers_release) struct layers one = {0}, other = {0};
    OWNED(rendition_release) struct rendition r;
    CHECK(stage_init(&s, (uint32_t[]){2, 2, 2}, 6, NULL) == OK);
    s.border.opacity[1] = 50;
    CHECK(rendition_init(&r, 8, 8, NULL) == OK && layers_attach(&one, &r, &s.border, NULL) == OK);
    CHECK(layers_attach(&other, &r, &s.border, NULL) == OK);
    for (int round = 0; round < 2000; round++) {
        struct layer put[PUTS];
        layers_put_none(&one, 0);
        layers_put_none(&other, 0);
        for (int i = 0; i < PUTS; i++) {
            const uint32_t depth = check_below(&random, 9), cell = check_below(&random, 4);
            put[i] = (struct layer){depth, cell, (uint8_t)(1 + cell % 3)};
            layers_put(&one, 0, put[i], put[i].label == 3);
        }
        for (int i = PUTS - 1; i >= 0; i--)
            layers_put(&other, 0, put[i], put[i].label == 3);
        CHECK(one.count[0] == other.count[0] && one.last->cell == other.last->cell);
        for (unsigned k = 0; k < one.count[0]; k++) {
            const struct layer p = layers_at(&one, 0, k), q = layers_at(&other, 0, k);
            const struct layer next = layers_at(&one, 0, k + 1);
            CHECK(p.depth == q.depth && p.cell == q.cell);
            CHECK(next.depth > p.depth || (next.depth == p.depth && next.cell > p.cell));
        }
    }
}

/* ---- what they come to ---- */

enum { SIDE = 21, MIDDLE = 10 };

/* Draw plates across the view from the front, the first one nearest, of labels 1, 2, ..., each far
 * behind the one before, and return the pixel in the middle of the picture. */
static const uint8_t *see_plates(struct stage *s, int plates, const uint8_t *opacity)
{
    stage_release(s);
    CHECK(stage_init(s, (uint32_t[]){SIDE, 100, SIDE}, 6, NULL) == OK);
    s->look.cue_percent = 0;
    for (uint32_t i = 0; i < SIDE * SIDE; i++)
        for (int plate = 0; plate < plates; plate++)
            set_label(s, i % SIDE, 99 - 9 * (uint32_t)plate, i / SIDE, (uint8_t)(plate + 1));
    for (int plate = 0; plate < plates; plate++)
        s->border.opacity[plate + 1] = opacity[plate];
    s->view.zoom = VIEW_ZOOM_ONE;
    draw(s, SIDE);
    return s->rendition.rgba + 4 * (MIDDLE * SIDE + MIDDLE);
}

STORY(shares_of_squares_add_up_from_the_front)
{
    OWNED(stage_release) struct stage s = {0};
    uint8_t front[4], back[4];
    memcpy(front, see_plates(&s, 1, (uint8_t[]){100}), 4);
    s.palette.rgb[1][0] = 0;
    memcpy(back, s.palette.rgb[2], 3);
    const uint8_t *seen = see_plates(&s, 1, (uint8_t[]){50});
    CHECK(memcmp(seen, front, 3) == 0); /* not multiplied by alpha */
    CHECK_INT(seen[3], 128);
    seen = see_plates(&s, 2, (uint8_t[]){100, 100});
    CHECK(memcmp(seen, front, 4) == 0);
    s.border.opacity[1] = 0;
    s.border.visible[1] = false;
    draw(&s, SIDE);
    memcpy(back, s.rendition.rgba + 4 * (MIDDLE * SIDE + MIDDLE), 4);
    for (int percent = 1; percent < 100; percent++) {
        seen = see_plates(&s, 2, (uint8_t[]){(uint8_t)percent, 100});
        CHECK_INT(seen[3], 255);
        for (int k = 0; k < 3; k++) {
            const int square =
                (percent * front[k] * front[k] + (100 - percent) * back[k] * back[k]);
            const int twice = 200 * seen[k] * seen[k];
            /* The nearest level, except for the last bits of shares. */
            CHECK(twice - 200 * seen[k] <= 2 * square + 60 &&
                  2 * square - 60 <= twice + 200 * seen[k] + 100);
        }
    }
    seen = see_plates(&s, 3, (uint8_t[]){50, 50, 50});
    CHECK_INT(seen[3], 223); /* 7 of 8 */
    seen = see_plates(&s, 2, (uint8_t[]){90, 97});
    CHECK_INT(seen[3], 255); /* less than a 256th is left */
}

STORY(what_has_the_largest_share_is_what_a_pixel_shows)
{
    OWNED(stage_release) struct stage s = {0};
    static const struct {
        uint8_t opacity[3], label;
    } seen[] = {{{30, 100, 100}, 2}, {{50, 100, 100}, 1}, {{30, 30, 100}, 3}, {{30, 50, 90}, 2},
                {{10, 10, 10}, 1},   {{20, 20, 60}, 3},   {{100, 1, 1}, 1}};
    for (size_t i = 0; i < sizeof seen / sizeof *seen; i++) {
        see_plates(&s, 3, seen[i].opacity);
        CHECK_INT(s.rendition.label[MIDDLE * SIDE + MIDDLE], seen[i].label);
        const size_t pixel = MIDDLE * SIDE + MIDDLE;
        CHECK_INT(s.scene->cell[s.rendition.cell[pixel]].label, seen[i].label);
        const int16_t *n = s.rendition.normal + 4 * pixel; /* towards the viewer: +y */
        CHECK(abs(n[0]) < 200 && n[1] > 16000 && abs(n[2]) < 200);
    }
}

STORY(an_opaque_object_is_seen_however_many_are_before_it)
{
    OWNED(stage_release) struct stage s = {0};
    uint8_t opacity[11];
    memset(opacity, 10, sizeof opacity);
    opacity[10] = 100;
    see_plates(&s, 11, opacity);
    const size_t pixel = MIDDLE * SIDE + MIDDLE;
    CHECK_INT(s.layers.count[pixel], LAYERS_MOST);
    for (unsigned k = 0; k < LAYERS_MOST; k++)
        CHECK_INT(layers_at(&s.layers, pixel, k).label, k + 1);
    CHECK_INT(s.rendition.rgba[4 * pixel + 3], 255);
    CHECK_INT(s.layers.last[pixel].label, 11);
}

/* Set a ball of this radius in the middle of a scene of 61x61x61. */
static void put_ball(struct stage *s, int radius, uint8_t label)
{
    for (int z = -30; z <= 30; z++)
        for (int y = -30; y <= 30; y++)
            for (int x = -30; x <= 30; x++)
                if (x * x + y * y + z * z <= radius * radius)
                    set_label(s, (uint32_t)(x + 30), (uint32_t)(y + 30), (uint32_t)(z + 30), label);
}

/* A tumour in a brain in a head, as cubes and with smooth surfaces. A ray through the brain enters
 * the head a second time. */
STORY(each_of_three_balls_within_each_other_is_seen)
{
    OWNED(stage_release) struct stage s;
    CHECK(stage_init(&s, (uint32_t[]){61, 61, 61}, 6, NULL) == OK);
    put_ball(&s, 28, 1);
    put_ball(&s, 18, 2);
    put_ball(&s, 8, 3);
    s.border.opacity[1] = 20, s.border.opacity[2] = 40;
    static const struct {
        uint32_t column;
        uint8_t label, alpha;
    } seen[] = {{30, 3, 255}, {44, 2, 157}, {53, 1, 51}, {60, 0, 0}};
    for (uint32_t times = 1; times <= 10; times += 3) {
        s.view.zoom = times * VIEW_ZOOM_ONE;
        draw(&s, 61 * times);
        for (size_t i = 0; i < sizeof seen / sizeof *seen; i++) {
            const size_t pixel = ((size_t)30 * 61 * times + seen[i].column) * times;
            CHECK_INT(s.rendition.label[pixel], seen[i].label);
            CHECK_INT(s.rendition.rgba[4 * pixel + 3], seen[i].alpha);
        }
    }
}

/* ---- smooth ---- */

/* Return the radius of a disc with the same number of pixels, in voxels. */
static double radius_seen(const struct stage *s, uint32_t times)
{
    size_t pixels = 0;
    for (size_t i = 0; i < (size_t)s->view.width * s->view.height; i++)
        pixels += s->rendition.rgba[4 * i + 3] > 0;
    return sqrt((double)pixels / M_PI) / times;
}

STORY(a_translucent_ball_is_as_wide_as_its_surface)
{
    OWNED(stage_release) struct stage s;
    CHECK(stage_init(&s, (uint32_t[]){61, 61, 61}, 6, NULL) == OK);
    put_ball(&s, 25, 1);
    s.border.opacity[1] = 50;
    for (int turn = 0; turn < 3; turn++) {
        s.view.angle[0] = turn * 31000, s.view.angle[1] = turn * 17000;
        for (uint32_t times = 4; times <= 8; times += 4) {
            s.view.zoom = times * VIEW_ZOOM_ONE;
            draw(&s, 61 * times);
            const double radius = radius_seen(&s, times);
            if (!CHECK(radius > 24.85 && radius < 25.1))
                printf("# %u pixels to a voxel, turn %d: %.3f\n", times, turn, radius);
        }
    }
    s.look.mode = SHADE_CUBES;
    draw(&s, 61 * 8);
    CHECK(radius_seen(&s, 8) > 25.3);
}

/* Two plates of one label are two layers, however close: each has its own front. */
STORY(each_front_of_an_object_is_a_layer)
{
    struct stage s;
    for (uint32_t times = 1; times <= 8; times += 7)
        for (uint32_t gap = 1; gap <= 9; gap++) {
            CHECK(stage_init(&s, (uint32_t[]){SIDE, 40, SIDE}, 6, NULL) == OK);
            for (uint32_t i = 0; i < SIDE * SIDE; i++)
                for (uint32_t y = 0; y < 3; y++) {
                    set_label(&s, i % SIDE, 30 - y, i / SIDE, 1);
                    set_label(&s, i % SIDE, 27 - gap - y, i / SIDE, 1);
                }
            s.border.opacity[1] = 50;
            s.view.zoom = times * VIEW_ZOOM_ONE;
            draw(&s, SIDE * times);
            const size_t pixel = ((size_t)SIDE * times / 2) * SIDE * times + SIDE * times / 2;
            if (!CHECK(s.rendition.rgba[4 * pixel + 3] == 191))
                printf("# %u pixels to a voxel, %u voxels between\n", times, gap);
            stage_release(&s);
        }
}
