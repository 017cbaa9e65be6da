/* Layers of translucent objects: which there are, what they come to, and what of them counts. */
#include "check.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "render/seams.h"
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

/* What a ray goes through, the nearest first, with the labels of what is shown. */
static size_t pass(struct passed *out, const struct stage *s, uint32_t column, uint32_t row)
{
    const size_t count = ray_search(out, &s->camera, column, row);
    for (size_t i = 0; i < count; i++) {
        const uint8_t label = s->scene->cell[out[i].cell].label;
        const bool shown =
            s->border.visible[label] && !cut_takes(&s->border.cut, &s->scene->grid, out[i].cell);
        out[i].label = shown ? label : 0;
    }
    return count;
}

/* Of what a ray passes, the layers: the translucent ones, and in *last the opaque one. */
static size_t pick_layers(struct passed *passed, size_t count, const struct stage *s,
                          struct passed *last)
{
    size_t layers = 0;
    struct passed *layer = mem_array(count + 1, sizeof *layer);
    *last = (struct passed){DEPTH_NONE, CELL_NONE, 0};
    for (size_t i = 0; i < count; i++) {
        bool is_new = passed[i].label != 0;
        for (size_t k = i > LAYERS_GAP ? i - LAYERS_GAP - 1 : 0; k < i; k++)
            is_new = is_new && passed[k].label != passed[i].label;
        if (!is_new)
            continue;
        if (s->border.opacity[passed[i].label] == BORDER_OPAQUE) {
            *last = passed[i];
            break;
        }
        layer[layers++] = passed[i];
    }
    memcpy(passed, layer, layers * sizeof *layer);
    free(layer);
    return layers < LAYERS_MOST ? layers : LAYERS_MOST;
}

static bool layers_are(const struct layers *l, size_t pixel, const struct passed *expected,
                       size_t count, const struct passed *last)
{
    bool same = l->last_depth[pixel] == last->depth && l->last_cell[pixel] == last->cell &&
                l->last_label[pixel] == last->label && l->count[pixel] >= count;
    for (size_t k = 0; same && k < count; k++) {
        const size_t at = pixel * LAYERS_MOST + k;
        same = l->depth[at] == expected[k].depth && l->cell[at] == expected[k].cell &&
               l->label[at] == expected[k].label;
    }
    for (size_t k = count; same && k < l->count[pixel]; k++)
        same = l->depth[pixel * LAYERS_MOST + k] > last->depth;
    return same;
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

STORY(each_pixel_has_the_layers_that_its_ray_passes)
{
    uint64_t random = 5;
    const char *factor = getenv("IFTTY_TEST_SCALE");
    const int scenes = 1500 * (factor ? atoi(factor) : 1);
    for (int i = 0; i < scenes && check_failures == 0; i++) {
        struct stage s;
        random_scene(&s, &random);
        s.border.opacity[1] = 30;
        s.border.visible[1] = true;
        draw(&s, 1 + check_below(&random, 12));
        struct passed *passed = mem_array(s.scene->grid.voxels, sizeof *passed), last;
        for (uint32_t y = 0; y < s.view.height; y++)
            for (uint32_t x = 0; x < s.view.width; x++) {
                const size_t count = pick_layers(passed, pass(passed, &s, x, y), &s, &last);
                if (!CHECK(
                        layers_are(&s.layers, (size_t)y * s.view.width + x, passed, count, &last)))
                    printf("# scene %d, pixel %u,%u of %zu layers\n", i, x, y, count);
            }
        free(passed);
        stage_release(&s);
    }
}

/* ---- what they come to ---- */

enum { SIDE = 21, MIDDLE = 10 };

/* Plates across the view from the front, the first one nearest, of labels 1, 2, ..., each far
 * enough behind the one before, and as they look in the middle of the picture. */
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

static uint8_t label_in_the_middle(const struct stage *s)
{
    return s->rendition.label[MIDDLE * SIDE + MIDDLE];
}

STORY(shares_of_squares_add_up_from_the_front)
{
    struct stage s = {0};
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
            /* The nearest level, but for the last bits of shares. */
            CHECK(twice - 200 * seen[k] <= 2 * square + 60 &&
                  2 * square - 60 <= twice + 200 * seen[k] + 100);
        }
    }
    seen = see_plates(&s, 3, (uint8_t[]){50, 50, 50});
    CHECK_INT(seen[3], 223); /* 7 of 8 */
    seen = see_plates(&s, 2, (uint8_t[]){90, 97});
    CHECK_INT(seen[3], 255); /* less than a 256th is left */
    stage_release(&s);
}

STORY(what_has_the_largest_share_is_what_a_pixel_shows)
{
    struct stage s = {0};
    static const struct {
        uint8_t opacity[3], label;
    } seen[] = {{{30, 100, 100}, 2}, {{50, 100, 100}, 1}, {{30, 30, 100}, 3}, {{30, 50, 90}, 2},
                {{10, 10, 10}, 1},   {{20, 20, 60}, 3},   {{100, 1, 1}, 1}};
    for (size_t i = 0; i < sizeof seen / sizeof *seen; i++) {
        see_plates(&s, 3, seen[i].opacity);
        CHECK_INT(label_in_the_middle(&s), seen[i].label);
        const size_t pixel = MIDDLE * SIDE + MIDDLE;
        CHECK_INT(s.scene->cell[s.rendition.cell[pixel]].label, seen[i].label);
        const int16_t *n = s.rendition.normal + 4 * pixel; /* towards the viewer: +y */
        CHECK(abs(n[0]) < 200 && n[1] > 16000 && abs(n[2]) < 200);
    }
    stage_release(&s);
}

STORY(an_opaque_object_is_seen_however_many_are_before_it)
{
    struct stage s = {0};
    uint8_t opacity[11];
    memset(opacity, 10, sizeof opacity);
    opacity[10] = 100;
    see_plates(&s, 11, opacity);
    const size_t pixel = MIDDLE * SIDE + MIDDLE;
    CHECK_INT(s.layers.count[pixel], LAYERS_MOST);
    for (size_t k = 0; k < LAYERS_MOST; k++)
        CHECK_INT(s.layers.label[pixel * LAYERS_MOST + k], k + 1);
    CHECK_INT(s.rendition.rgba[4 * pixel + 3], 255);
    CHECK_INT(s.layers.last_label[pixel], 11);
    stage_release(&s);
}

/* A ball of this radius in the middle of a scene of 61x61x61. */
static void put_ball(struct stage *s, int radius, uint8_t label)
{
    for (int z = -30; z <= 30; z++)
        for (int y = -30; y <= 30; y++)
            for (int x = -30; x <= 30; x++)
                if (x * x + y * y + z * z <= radius * radius)
                    set_label(s, (uint32_t)(x + 30), (uint32_t)(y + 30), (uint32_t)(z + 30), label);
}

/* A tumour in a brain in a head, as cubes and with smooth surfaces. A ray through the brain comes
 * into the head a second time. */
STORY(each_of_three_balls_within_each_other_is_seen)
{
    struct stage s;
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
    stage_release(&s);
}

/* ---- refined ---- */

/* As wide as a disc of as many pixels, in voxels. */
static double radius_seen(const struct stage *s, uint32_t times)
{
    size_t pixels = 0;
    for (size_t i = 0; i < (size_t)s->view.width * s->view.height; i++)
        pixels += s->rendition.rgba[4 * i + 3] > 0;
    return sqrt((double)pixels / M_PI) / times;
}

STORY(a_translucent_ball_is_as_wide_as_its_surface)
{
    struct stage s;
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
    stage_release(&s);
}

/* Two plates of one label: as far apart as a ray along a rough surface leaves it, they are one. */
STORY(what_lies_close_behind_the_same_object_is_the_same_layer)
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
            if (!CHECK(s.rendition.rgba[4 * pixel + 3] == (gap > LAYERS_GAP ? 191 : 128)))
                printf("# %u pixels to a voxel, %u voxels between\n", times, gap);
            stage_release(&s);
        }
}

/* ---- seams ---- */

static bool are_same_seams(const struct seams *a, const struct seams *b)
{
    bool same = memcmp(a->edge, b->edge, a->words * sizeof *a->edge) == 0;
    for (int axis = 0; axis < 3; axis++)
        same = same &&
               memcmp(a->between[axis], b->between[axis], a->words * sizeof *a->between[axis]) == 0;
    return same && memcmp(a->label, b->label, a->border->scene->grid.cells) == 0;
}

/* What was near an edge before is so until a recount. */
static bool are_near(const struct seams *kept, const struct seams *counted)
{
    bool are = kept->has_near && counted->has_near;
    for (size_t w = 0; w < counted->words; w++)
        are = are && !(counted->near[w] & ~kept->near[w]);
    return are;
}

static bool all_near(const struct seams *seams, const struct grid *grid, struct place p)
{
    enum { AROUND = 2 * SEAMS_NEAR + 1 };
    bool all = true;
    for (int i = 0; i < AROUND * AROUND * AROUND; i++) {
        const int64_t x = (int64_t)p.x + i % AROUND - SEAMS_NEAR;
        const int64_t y = (int64_t)p.y + i / AROUND % AROUND - SEAMS_NEAR;
        const int64_t z = (int64_t)p.z + i / AROUND / AROUND - SEAMS_NEAR;
        all = all && (!grid_contains(grid, x, y, z) ||
                      seams_is_near(seams, grid_cell(grid, (uint32_t)x, (uint32_t)y, (uint32_t)z)));
    }
    return all;
}

/* Around each edge. */
static bool is_near_as_seen(const struct seams *seams, const struct grid *grid)
{
    bool same = true;
    for (uint32_t v = 0; v < grid->voxels; v++) {
        const struct place p = {v % grid->size[0], v / grid->size[0] % grid->size[1],
                                v / grid->size[0] / grid->size[1]};
        const bool is_edge = seams_is_edge(seams, grid_cell(grid, p.x, p.y, p.z));
        same = same && (!is_edge || all_near(seams, grid, p));
    }
    return same;
}

STORY(seams_that_follow_edits_are_as_counted_ones)
{
    uint64_t random = 11;
    for (int i = 0; i < 40 && check_failures == 0; i++) {
        struct stage s;
        struct seams kept = {0};
        const uint32_t side = 2 + check_below(&random, 24);
        CHECK(stage_init(&s, (uint32_t[]){side, side, side}, 6, NULL) == OK);
        s.border.visible[3] = false;
        border_recount(&s.border);
        CHECK(seams_count(&kept, &s.border, NULL) == OK);
        seams_find_near(&kept);
        for (int step = 0; step < 8; step++) {
            struct seams counted = {0};
            const struct edit edit = {grid_cell(&s.scene->grid, check_below(&random, side),
                                                check_below(&random, side),
                                                check_below(&random, side)),
                                      (int16_t)check_below(&random, 4), 0};
            CHECK(forest_edit(s.forest, &edit, 1, NULL) == OK);
            const struct changes changes = forest_changes(s.forest);
            border_update(&s.border, &changes);
            CHECK(seams_follow(&kept, &s.border, &changes, NULL) == OK);
            CHECK(seams_count(&counted, &s.border, NULL) == OK);
            seams_find_near(&kept); /* which an edit of everything has taken away */
            seams_find_near(&counted);
            CHECK(are_same_seams(&kept, &counted));
            CHECK(are_near(&kept, &counted));
            CHECK(step > 0 || is_near_as_seen(&counted, &s.scene->grid));
            seams_release(&counted);
        }
        seams_release(&kept);
        stage_release(&s);
    }
}

STORY(around_a_voxel_that_changes_all_is_near)
{
    struct stage s;
    struct seams kept = {0}, counted = {0};
    CHECK(stage_init(&s, (uint32_t[]){40, 40, 40}, 6, NULL) == OK);
    for (uint32_t v = 0; v < s.scene->grid.voxels; v++)
        set_label(&s, v % 40, v / 40 % 40, v / 1600, 1);
    border_recount(&s.border);
    CHECK(seams_count(&kept, &s.border, NULL) == OK);
    seams_find_near(&kept);
    const struct change change = {grid_cell(&s.scene->grid, 20, 20, 20), 1, 2};
    const struct changes changes = {.count = 1, .item = &change, .listed = 1, .voxels = 1};
    CHECK(!seams_is_near(&kept, change.cell));
    set_label(&s, 20, 20, 20, 2);
    border_update(&s.border, &changes);
    CHECK(seams_follow(&kept, &s.border, &changes, NULL) == OK);
    CHECK(seams_count(&counted, &s.border, NULL) == OK);
    seams_find_near(&counted);
    CHECK(are_near(&kept, &counted) && is_near_as_seen(&kept, &s.scene->grid));
    CHECK(!seams_is_near(&kept, grid_cell(&s.scene->grid, 20, 20, 10)));
    seams_release(&kept);
    seams_release(&counted);
    stage_release(&s);
}

int main(void)
{
    return RUN_STORIES(TELL(each_pixel_has_the_layers_that_its_ray_passes),
                       TELL(shares_of_squares_add_up_from_the_front),
                       TELL(what_has_the_largest_share_is_what_a_pixel_shows),
                       TELL(an_opaque_object_is_seen_however_many_are_before_it),
                       TELL(each_of_three_balls_within_each_other_is_seen),
                       TELL(a_translucent_ball_is_as_wide_as_its_surface),
                       TELL(what_lies_close_behind_the_same_object_is_the_same_layer),
                       TELL(seams_that_follow_edits_are_as_counted_ones),
                       TELL(around_a_voxel_that_changes_all_is_near));
}
