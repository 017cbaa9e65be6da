/* Slices: the right way round under every orientation of the scene, worked by hand. */
#include "check.h"

#include "render/slice.h"

/* The anatomy: sizes and spacings along the patient's right, anterior, superior, and what is at
 * each place of it. */
static const uint32_t body_size[3] = {4, 3, 2};
static const uint32_t body_spacing[3] = {1000000, 1500000, 3000000};

static uint16_t body_intensity(const uint32_t at[3])
{
    return (uint16_t)(10 * (at[0] + 4 * (at[1] + 3 * at[2])));
}
static uint8_t body_label(const uint32_t at[3])
{
    return at[0] >= 2 ? (uint8_t)(1 + (at[1] == 2)) : 0;
}

/* The anatomy as voxels whose axis a runs along patient axis order[a], backwards where bit a of
 * `flips` is set; `cross` becomes the cell of the patient's place 1, 2, 1. */
static struct scene *body_scene(const int8_t order[3], unsigned flips, uint32_t *cross)
{
    struct scene *scene = NULL;
    uint32_t size[3], v[3];
    for (int a = 0; a < 3; a++)
        size[a] = body_size[order[a]];
    CHECK(scene_new(&scene, size, NULL) == OK);
    for (int a = 0; a < 3; a++) {
        scene->world_axis[a] = order[a];
        scene->world_sign[a] = flips >> a & 1 ? -1 : 1;
        scene->spacing_nm[a] = body_spacing[order[a]];
    }
    for (v[2] = 0; v[2] < size[2]; v[2]++)
        for (v[1] = 0; v[1] < size[1]; v[1]++)
            for (v[0] = 0; v[0] < size[0]; v[0]++) {
                uint32_t at[3], c = grid_cell(&scene->grid, v[0], v[1], v[2]);
                for (int a = 0; a < 3; a++)
                    at[order[a]] = flips >> a & 1 ? size[a] - 1 - v[a] : v[a];
                scene->cell[c].intensity = body_intensity(at);
                scene->cell[c].label = body_label(at);
                if (at[0] == 1 && at[1] == 2 && at[2] == 1)
                    *cross = c;
            }
    return scene;
}

static const int8_t world_order[3] = {0, 1, 2};

static struct slice take(const struct scene *scene, struct slice_choice choice)
{
    struct slice slice;
    struct palette palette = {{{0}}};
    memcpy(palette.rgb[1], "\x50\x60\x70", 3);
    memcpy(palette.rgb[2], "\xff\x00\x01", 3);
    CHECK(slice_init(&slice, scene, &choice, &palette, NULL) == OK);
    return slice;
}

static bool is_rgb(const struct slice *s, uint32_t x, uint32_t y, int r, int g, int b)
{
    const uint8_t *p = s->rgb + 3 * ((size_t)y * s->width + x);
    return p[0] == r && p[1] == g && p[2] == b;
}
static int grey_at(const struct slice *s, uint32_t x, uint32_t y)
{
    const uint8_t *p = s->rgb + 3 * ((size_t)y * s->width + x);
    return p[0] == p[1] && p[1] == p[2] ? p[0] : -1;
}

STORY(slices_lie_as_radiologists_look_at_them)
{
    uint32_t cross;
    struct scene *scene = body_scene(world_order, 0, &cross);
    struct slice_choice choice = {SLICE_AXIAL, 1, 1, 0, 255, SLICE_PLAIN, CELL_NONE};

    /* Right-anterior is top left; rows of 1.5 mm: 3 voxels on 5 pixels, 4.5 rounded up. */
    struct slice s = take(scene, choice);
    CHECK(s.width == 4 && s.height == 5);
    CHECK_INT(grey_at(&s, 0, 0), 230);
    CHECK_INT(grey_at(&s, 3, 0), 200);
    CHECK_INT(grey_at(&s, 0, 4), 150);
    CHECK_INT(grey_at(&s, 3, 4), 120);
    CHECK_INT(grey_at(&s, 3, 1), 200);
    CHECK_INT(grey_at(&s, 3, 2), 160);
    CHECK_INT(grey_at(&s, 3, 3), 120);
    slice_release(&s);

    /* Right-superior is top left. */
    choice.plane = SLICE_CORONAL;
    choice.index = 0;
    s = take(scene, choice);
    CHECK(s.width == 4 && s.height == 6);
    CHECK_INT(grey_at(&s, 0, 0), 150);
    CHECK_INT(grey_at(&s, 3, 2), 120);
    CHECK_INT(grey_at(&s, 0, 3), 30);
    CHECK_INT(grey_at(&s, 3, 5), 0);
    slice_release(&s);

    /* Anterior-superior is top left, and slice 3 is the patient's rightmost. */
    choice.plane = SLICE_SAGITTAL;
    choice.index = 3;
    s = take(scene, choice);
    CHECK(s.width == 5 && s.height == 6);
    CHECK_INT(grey_at(&s, 0, 0), 230);
    CHECK_INT(grey_at(&s, 4, 0), 150);
    CHECK_INT(grey_at(&s, 4, 5), 30);
    slice_release(&s);
    scene_free(scene);
}

STORY(a_window_ramps_from_black_to_white)
{
    uint32_t cross;
    struct scene *scene = body_scene(world_order, 0, &cross);
    struct slice s =
        take(scene, (struct slice_choice){SLICE_AXIAL, 0, 2, 10, 30, SLICE_PLAIN, CELL_NONE});
    CHECK(s.width == 8 && s.height == 9);
    CHECK_INT(grey_at(&s, 7, 8), 0);   /* 0 */
    CHECK_INT(grey_at(&s, 5, 8), 0);   /* 10 */
    CHECK_INT(grey_at(&s, 3, 8), 128); /* 20: 127.5 */
    CHECK_INT(grey_at(&s, 2, 8), 128);
    CHECK_INT(grey_at(&s, 1, 8), 255); /* 30 */
    CHECK_INT(grey_at(&s, 0, 0), 255);
    slice_release(&s);
    scene_free(scene);
}

STORY(labels_tint_or_are_outlined)
{
    uint32_t cross;
    struct scene *scene = body_scene(world_order, 0, &cross);
    struct slice_choice choice = {SLICE_AXIAL, 0, 2, 0, 255, SLICE_TINT, CELL_NONE};
    struct slice s = take(scene, choice);
    CHECK(is_rgb(&s, 0, 8, 43, 47, 51));  /* 30 with 80, 96, 112: 42.5, 46.5, 50.5 */
    CHECK(is_rgb(&s, 0, 0, 146, 83, 83)); /* 110 with 255, 0, 1: 146.25, 82.5, 82.75 */
    CHECK_INT(grey_at(&s, 7, 8), 0);
    slice_release(&s);

    /* Label 2 fills columns 0-3 of rows 0-2, label 1 those of rows 3-8. */
    choice.overlay = SLICE_CONTOUR;
    s = take(scene, choice);
    CHECK_INT(grey_at(&s, 0, 0), 110); /* the picture's edge is no contour */
    CHECK_INT(grey_at(&s, 0, 1), 110);
    CHECK(is_rgb(&s, 0, 2, 255, 0, 1));
    CHECK(is_rgb(&s, 0, 3, 0x50, 0x60, 0x70));
    CHECK_INT(grey_at(&s, 2, 8), 20);
    CHECK(is_rgb(&s, 3, 8, 0x50, 0x60, 0x70));
    CHECK_INT(grey_at(&s, 4, 8), 10); /* the background has none */
    slice_release(&s);

    /* From the side, label 2 fills columns 0-2, label 1 columns 3-8. */
    choice.plane = SLICE_SAGITTAL;
    choice.index = 3;
    s = take(scene, choice);
    CHECK(is_rgb(&s, 2, 0, 255, 0, 1));
    CHECK(is_rgb(&s, 3, 0, 0x50, 0x60, 0x70));
    CHECK_INT(grey_at(&s, 4, 0), 190);
    slice_release(&s);
    scene_free(scene);
}

STORY(a_cross_leaves_its_voxel_free)
{
    uint32_t cross = 0;
    struct scene *scene = body_scene(world_order, 0, &cross);
    struct slice s =
        take(scene, (struct slice_choice){SLICE_AXIAL, 0, 2, 0, 255, SLICE_PLAIN, cross});
    /* Voxel 1, 2 has columns 4 and 5, rows 0 to 2. */
    CHECK_INT(grey_at(&s, 5, 1), 90);
    CHECK_INT(grey_at(&s, 5, 0), 90);
    CHECK_INT(grey_at(&s, 5, 2), 90);
    CHECK_INT(grey_at(&s, 4, 1), 90);
    CHECK(is_rgb(&s, 3, 1, 255, 220, 0) && is_rgb(&s, 6, 1, 255, 220, 0));
    CHECK(is_rgb(&s, 5, 3, 255, 220, 0) && is_rgb(&s, 5, 8, 255, 220, 0));
    CHECK(is_rgb(&s, 0, 1, 255, 220, 0) && is_rgb(&s, 7, 1, 255, 220, 0));
    CHECK_INT(grey_at(&s, 4, 3), 50);
    slice_release(&s);
    scene_free(scene);
}

STORY(all_48_orientations_give_the_same_pictures)
{
    static const int8_t order[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2},
                                       {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    static const enum slice_plane planes[3] = {SLICE_AXIAL, SLICE_CORONAL, SLICE_SAGITTAL};
    uint32_t plain_cross = 0, cross = 0;
    struct scene *plain = body_scene(world_order, 0, &plain_cross);
    for (unsigned o = 0; o < 48; o++) {
        struct scene *scene = body_scene(order[o / 8], o % 8, &cross);
        for (unsigned i = 0; i < 3 * 3 * 3; i++) {
            struct slice_choice choice = {
                planes[i % 3], 0, 1 + i / 9, 20, 200, (enum slice_overlay)(i / 3 % 3), CELL_NONE};
            CHECK_INT(slice_count(scene, choice.plane), body_size[2 - i % 3]);
            for (; choice.index < body_size[2 - i % 3]; choice.index++) {
                choice.cross = choice.index % 2 ? plain_cross : CELL_NONE;
                struct slice expected = take(plain, choice);
                choice.cross = choice.index % 2 ? cross : CELL_NONE;
                struct slice actual = take(scene, choice);
                bool same = actual.width == expected.width && actual.height == expected.height;
                CHECK(same && memcmp(actual.rgb, expected.rgb,
                                     (size_t)3 * expected.width * expected.height) == 0);
                slice_release(&expected);
                slice_release(&actual);
            }
        }
        scene_free(scene);
    }
    scene_free(plain);
}

STORY(what_is_out_of_range_is_refused)
{
    uint32_t cross;
    struct scene *scene = body_scene(world_order, 0, &cross);
    static const struct slice_choice good = {SLICE_AXIAL, 1, 1, 0, 255, SLICE_PLAIN, CELL_NONE};
    struct slice_choice bad[4] = {good, good, good, good};
    struct palette palette = {{{0}}};
    struct slice slice;
    struct fault fault;
    bad[0].index = 2;
    bad[1].zoom = 0;
    bad[2].zoom = SLICE_ZOOM_MOST + 1;
    bad[3].high = 0;
    for (int i = 0; i < 4; i++)
        CHECK(slice_init(&slice, scene, &bad[i], &palette, &fault) == ERR_USAGE && !slice.rgb);
    scene->spacing_nm[1] = 4000000000;
    CHECK(slice_init(&slice, scene, &good, &palette, &fault) == ERR_LIMIT && !slice.rgb);
    CHECK_HAS(fault.text, "12000 pixels");
    scene_free(scene);
}

int main(void)
{
    return RUN_STORIES(
        TELL(slices_lie_as_radiologists_look_at_them), TELL(a_window_ramps_from_black_to_white),
        TELL(labels_tint_or_are_outlined), TELL(a_cross_leaves_its_voxel_free),
        TELL(all_48_orientations_give_the_same_pictures), TELL(what_is_out_of_range_is_refused));
}
