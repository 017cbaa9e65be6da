/* Patches: pictures with them beside those in which each pixel is refined by itself. */
#include "check.h"

#include <stdlib.h>

#include "render/patch.h"
#include "tests/stage.h"

enum { SIDE = 40, OBJECTS = 4 };

/* Balls of several objects that touch and overlap; some thin, as shells. */
static void stage_balls(struct stage *s, uint64_t *random)
{
    CHECK(stage_init(s, (uint32_t[]){SIDE, SIDE, SIDE}, 6, NULL) == OK);
    const struct grid *grid = &s->scene->grid;
    for (int i = 0; i < OBJECTS; i++) {
        const int middle[3] = {8 + (int)check_below(random, 24), 8 + (int)check_below(random, 24),
                               8 + (int)check_below(random, 24)};
        const int radius = 4 + (int)check_below(random, 10);
        const int hollow = check_below(random, 2) ? radius - 1 : 0;
        for (uint32_t cell = 0; cell < SIDE * SIDE * SIDE; cell++) {
            const uint32_t x = cell % SIDE, y = cell / SIDE % SIDE, z = cell / SIDE / SIDE;
            const int dx = (int)x - middle[0], dy = (int)y - middle[1], dz = (int)z - middle[2];
            const int square = dx * dx + dy * dy + dz * dz;
            if (square <= radius * radius && square >= hollow * hollow)
                s->scene->cell[grid_cell(grid, x, y, z)].label = (uint8_t)(1 + i);
        }
    }
    border_recount(&s->border);
}

static void look_at_random(struct stage *s, uint64_t *random)
{
    s->view = (struct view){.width = 256, .height = 200, .zoom = 4000};
    s->view.zoom <<= check_below(random, 4);
    for (int i = 0; i < 3; i++)
        s->view.angle[i] = (int32_t)check_below(random, VIEW_TURN);
    for (int a = 0; a < 3; a++)
        s->view.focus[a] = ((int64_t)check_below(random, 20) - 10) * (1 << VIEW_FOCUS_BITS);
}

/* With patches, or without: lines at edges depend on pixels around, and change none but colours. */
static void draw(struct stage *s, bool has_patches)
{
    rendition_release(&s->rendition);
    s->look.edges = !has_patches;
    stage_draw(s);
}

/* How two pictures differ, counted in pixels. */
struct difference {
    size_t shown, silhouette, depth, label, normal, length;
};

static int64_t apart(int64_t one, int64_t other)
{
    return one < other ? other - one : one - other;
}

static int32_t product(const int16_t *one, const int16_t *other)
{
    int32_t sum = 0;
    for (int a = 0; a < 3; a++)
        sum += one[a] * other[a];
    return sum;
}

static void compare(struct difference *d, const struct rendition *one,
                    const struct rendition *other, int64_t voxel)
{
    for (size_t i = 0; i < (size_t)one->width * one->height; i++) {
        const bool shows[2] = {one->cell[i] != CELL_NONE, other->cell[i] != CELL_NONE};
        d->shown += shows[0];
        d->silhouette += shows[0] != shows[1];
        if (!shows[0] || !shows[1])
            continue;
        d->depth += apart(one->depth[i], other->depth[i]) > voxel / 4;
        d->label += one->label[i] != other->label[i];
        const int16_t *normal = one->normal + 4 * i;
        d->normal += product(normal, other->normal + 4 * i) < 0.95 * (1 << 28);
        d->length += apart(product(normal, normal), 1 << 28) > (1 << 28) / 100;
    }
}

STORY(patches_look_as_pixels_by_themselves_do)
{
    uint64_t random = 7;
    struct difference d = {0};
    for (int i = 0; i < 60; i++) {
        struct stage s;
        struct rendition single;
        stage_balls(&s, &random);
        look_at_random(&s, &random);
        draw(&s, false);
        single = s.rendition;
        s.rendition = (struct rendition){0};
        draw(&s, true);
        compare(&d, &s.rendition, &single, normal_stride(&s.camera) << 26);
        rendition_release(&single);
        stage_release(&s);
    }
    if (!CHECK(d.shown > 500000 && d.silhouette * 2000 < d.shown && d.depth * 500 < d.shown &&
               d.label * 1000 < d.shown && d.normal * 500 < d.shown && d.length == 0))
        printf("# of %zu pixels differ: %zu in silhouette, %zu in depth, %zu in label, %zu in "
               "normal, %zu in its length\n",
               d.shown, d.silhouette, d.depth, d.label, d.normal, d.length);
}

/* A picture of several samples a pixel, which the caller releases. */
static struct rendition draw_reduced(struct stage *s, uint32_t number)
{
    struct rendition out;
    const uint32_t samples = s->look.samples;
    s->look.number = number;
    draw(s, true);
    CHECK(rendition_init(&out, s->view.width / samples, s->view.height / samples, NULL) == OK);
    rendition_reduce(&out, &s->rendition, samples, NULL);
    return out;
}

/* Pixels in which two pictures differ: in how much is covered, in label, and by so much in colour
 * that one sees it. */
static void compare_reduced(struct difference *d, const struct rendition *one,
                            const struct rendition *other)
{
    for (size_t i = 0; i < (size_t)one->width * one->height; i++) {
        const uint8_t *of[2] = {one->rgba + 4 * i, other->rgba + 4 * i};
        d->shown += of[0][3] > 0;
        d->silhouette += apart(of[0][3], of[1][3]) > 255 / 16;
        d->label += one->label[i] != other->label[i];
        d->normal += apart(of[0][1], of[1][1]) > 12;
    }
}

/* Each sample is in a patch of look 3, or refined. */
STORY(one_sample_stands_for_a_pixel_only_where_all_look_alike)
{
    uint64_t random = 11;
    struct difference d = {0};
    for (int i = 0; i < 40; i++) {
        struct stage s;
        stage_balls(&s, &random);
        look_at_random(&s, &random);
        s.look.samples = 2u << i % 2;
        s.view.width *= 2, s.view.height *= 2;
        struct rendition one = draw_reduced(&s, LOOK_PRESENT);
        struct rendition other = draw_reduced(&s, LOOK_THIRD);
        compare_reduced(&d, &one, &other);
        rendition_release(&one);
        rendition_release(&other);
        stage_release(&s);
    }
    if (!CHECK(d.shown > 100000 && d.silhouette * 2000 < d.shown && d.label * 1000 < d.shown &&
               d.normal * 500 < d.shown))
        printf("# of %zu pixels differ: %zu in silhouette, %zu in label, %zu in colour\n", d.shown,
               d.silhouette, d.label, d.normal);
}

/* Whole blocks are patches where a voxel is as wide. */
STORY(blocks_of_tiles_are_patches_where_voxels_are_wide)
{
    struct stage s;
    uint64_t random = 3;
    stage_balls(&s, &random);
    s.look.samples = 4;
    s.view = (struct view){.width = 1024, .height = 1024, .zoom = 32000};
    draw(&s, true);
    size_t standing = 0, shown = 0;
    for (size_t i = 0; i < 128 * 128; i++) {
        standing += s.rendition.stale[i] == TILE_STANDS;
        shown += s.rendition.stale[i] != TILE_EMPTY;
    }
    CHECK(standing * 10 > shown * 7);
    stage_release(&s);
}

/* What a patch may not be: over a hole, over a silhouette, or wider than a voxel. */
STORY(most_pixels_of_a_smooth_surface_are_in_patches)
{
    static const uint32_t zoom[] = {2000, 4000, 8000, 16000};
    static const double least[] = {0, 0.4, 0.4, 0.6};
    struct stage s;
    uint64_t random = 3;
    stage_balls(&s, &random);
    for (int i = 0; i < 4; i++) {
        s.view = (struct view){.width = 512, .height = 512, .zoom = zoom[i]};
        draw(&s, true);
        struct field shown_field;
        struct refiner refiner;
        struct normals normals;
        size_t shown = 0, between = 0;
        CHECK(field_init(&shown_field, &s.border, FIELD_SURFACE, 1, NULL) == OK);
        refiner_init(&refiner, &s.camera, &s.border);
        refiner.shown = &(struct field_reader){.field = &shown_field};
        normals_init(&normals, &s.camera, SHADE_SURFACE, true, &shown_field, NULL);
        for (uint32_t y = 0; y < 512; y += TILE)
            for (uint32_t x = 0; x < 512; x += TILE) {
                struct patches patches = {.r = &s.rendition,
                                          .refiner = &refiner,
                                          .normals = &normals,
                                          .left = x,
                                          .top = y,
                                          .side = TILE,
                                          .samples = 1};
                patches_refine_tile(&patches, 0, 0);
                between += (size_t)__builtin_popcountll(patches.tile[0][0].has_normal);
            }
        for (size_t p = 0; p < 512 * 512; p++)
            shown += s.rendition.cell[p] != CELL_NONE;
        const double share = (double)between / (double)shown;
        if (!CHECK(share >= least[i] && share <= 1))
            printf("# zoom %u: %.3f of %zu pixels\n", zoom[i], share, shown);
        field_release(&shown_field);
    }
    stage_release(&s);
}

/* Whether a pixel is brighter than all four beside it, or darker. */
static bool is_dot(const struct rendition *r, size_t pixel)
{
    const size_t beside[4] = {pixel - 1, pixel + 1, pixel - r->width, pixel + r->width};
    const int own = r->rgba[4 * pixel + 1];
    int above = 0, below = 0;
    for (int i = 0; i < 4; i++) {
        above += own > r->rgba[4 * beside[i] + 1];
        below += own < r->rgba[4 * beside[i] + 1];
    }
    return above == 4 || below == 4;
}

/* What is refined by itself in the middle of a patch does not stand out. */
STORY(no_pixel_of_a_patch_is_a_dot)
{
    struct stage s;
    uint64_t random = 3;
    size_t dots = 0, middles = 0;
    stage_balls(&s, &random);
    s.view = (struct view){.width = 512, .height = 512, .zoom = 8000};
    draw(&s, LOOK_PRESENT);
    for (uint32_t y = 1; y < 511; y++)
        for (uint32_t x = 1; x < 511; x++)
            if (is_dot(&s.rendition, (size_t)y * 512 + x)) {
                dots++;
                middles += x % TILE == TILE / 2 && y % TILE == TILE / 2;
            }
    if (!CHECK(middles * 8 < dots))
        printf("# %zu dots, %zu of them in the middle of tiles\n", dots, middles);
    stage_release(&s);
}

int main(void)
{
    return RUN_STORIES(TELL(patches_look_as_pixels_by_themselves_do),
                       TELL(one_sample_stands_for_a_pixel_only_where_all_look_alike),
                       TELL(blocks_of_tiles_are_patches_where_voxels_are_wide),
                       TELL(most_pixels_of_a_smooth_surface_are_in_patches),
                       TELL(no_pixel_of_a_patch_is_a_dot));
}
