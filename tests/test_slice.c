/* SPDX-License-Identifier: MIT */
/* Slices in every orientation of the scene, with pixels worked out by hand. */
#include "tests/check_main.h"
#include "scarce_memory.h"

#include "render/slice.h"
#include "render/notes.h"

/* The body: sizes and spacings along the patient's right, anterior, superior; intensity and label
 * of each place. */
static const uint32_t body_size[3] = {4, 3, 2};
static const uint32_t body_spacing[3] = {1000000, 1500000, 3000000};

static const int8_t orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2},
                                    {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};

/* The body as a scene in one of 48 orientations: axis a is patient axis order[a], reversed if bit a
 * of the number is set. Orientation 0 is the world's. */
static struct scene *body_scene(unsigned orientation)
{
    const int8_t *order = orders[orientation / 8];
    struct scene *scene = NULL;
    uint32_t size[3], v[3];
    for (int a = 0; a < 3; a++)
        size[a] = body_size[order[a]];
    CHECK(scene_new(&scene, size, NULL, NULL, NULL) == OK);
    for (int a = 0; a < 3; a++) {
        scene->world_axis[a] = order[a];
        scene->world_sign[a] = orientation >> a & 1 ? -1 : 1;
        scene->spacing_nm[a] = body_spacing[order[a]];
    }
    for (v[2] = 0; v[2] < size[2]; v[2]++)
        for (v[1] = 0; v[1] < size[1]; v[1]++)
            for (v[0] = 0; v[0] < size[0]; v[0]++) {
                uint32_t at[3], c = grid_cell(&scene->grid, v[0], v[1], v[2]);
                for (int a = 0; a < 3; a++)
                    at[order[a]] = orientation >> a & 1 ? size[a] - 1 - v[a] : v[a];
                scene->cell[c].intensity = (uint16_t)(10 * (at[0] + 4 * (at[1] + 3 * at[2])));
                scene->cell[c].label = at[0] >= 2 ? (uint8_t)(1 + (at[1] == 2)) : 0;
            }
    return scene;
}

static struct scene *plain_body(void)
{
    return body_scene(0);
}

/* Define a story about a scene that this function makes. */
#define SCENE_STORY(make, told)                                                                    \
    static void told_##told(struct scene *scene);                                                  \
    STORY(told)                                                                                    \
    {                                                                                              \
        struct scene *scene = make();                                                              \
        told_##told(scene);                                                                        \
        scene_free(scene);                                                                         \
    }                                                                                              \
    static void told_##told(struct scene *scene)

static const uint64_t MM = 1000000000; /* picometres */

/* ---- drawing ---- */

static struct palette palette;
static bool visible[256];

static struct slice_style style_of(int32_t low, int32_t high, enum slice_overlay overlay)
{
    struct slice_style style = {
        .overlay = overlay, .palette = &palette, .visible = visible, .least = "", .most = ""};
    memset(&palette, 0, sizeof palette);
    memcpy(palette.rgb[1], "\x50\x60\x70", 3);
    memcpy(palette.rgb[2], "\xff\x00\x01", 3);
    memset(visible, 1, sizeof visible);
    slice_window(style.grey, low, high);
    return style;
}

/* The slice through the patient's place 1, 2, 1. */
static struct slice_choice through(const struct scene *scene, enum slice_plane plane,
                                   uint64_t pixel_pm)
{
    struct slice_choice choice = {.plane = plane, .pixel_pm = pixel_pm};
    slice_move(scene, SLICE_SAGITTAL, 1, choice.place);
    slice_move(scene, SLICE_CORONAL, 2, choice.place);
    slice_move(scene, SLICE_AXIAL, 1, choice.place);
    return choice;
}

/* The slice with a number. */
static struct slice_choice slice_number(const struct scene *scene, enum slice_plane plane,
                                        uint32_t index, uint64_t pixel_pm)
{
    struct slice_choice choice = {.plane = plane, .pixel_pm = pixel_pm};
    slice_move(scene, plane, index, choice.place);
    CHECK_INT(slice_index(scene, plane, choice.place), index);
    return choice;
}

static struct canvas take(const struct scene *scene, const struct slice_choice *choice,
                          const struct slice_style *style, uint32_t width, uint32_t height)
{
    struct canvas canvas;
    CHECK(canvas_init(&canvas, width, height, CANVAS_CELLS, NULL) == OK);
    CHECK(slice_draw(&canvas, scene, choice, style, NULL) == OK);
    return canvas;
}

static bool is_rgb(const struct canvas *s, uint32_t x, uint32_t y, int r, int g, int b)
{
    const uint8_t *p = canvas_pixel(s, x, y);
    return p[0] == r && p[1] == g && p[2] == b && p[3] == 255;
}
static int grey_at(const struct canvas *s, uint32_t x, uint32_t y)
{
    const uint8_t *p = canvas_pixel(s, x, y);
    return p[0] == p[1] && p[1] == p[2] ? p[0] : -1;
}

/* Check pixels: {x, y, grey}..., and {x, y, red, green, blue}... */
static void shows(const struct canvas *canvas, const int (*pixel)[5], size_t count, bool greys)
{
    for (size_t i = 0; i < count; i++) {
        const int *p = pixel[i], green = greys ? p[2] : p[3], blue = greys ? p[2] : p[4];
        if (!CHECK(is_rgb(canvas, (uint32_t)p[0], (uint32_t)p[1], p[2], green, blue)))
            printf("#   at %d,%d\n", p[0], p[1]);
    }
}
#define PIXELS(canvas, greys, ...)                                                                 \
    do {                                                                                           \
        static const int pixel[][5] = {__VA_ARGS__};                                               \
        shows(canvas, pixel, sizeof pixel / sizeof *pixel, greys);                                 \
    } while (0)
#define GREYS(canvas, ...)   PIXELS(canvas, true, __VA_ARGS__)
#define COLOURS(canvas, ...) PIXELS(canvas, false, __VA_ARGS__)
/* The same for a canvas that is used once. */
#define DRAWN(greys, scene, choice, style, width, height, ...)                                     \
    do {                                                                                           \
        struct canvas drawn = take(scene, choice, style, width, height);                           \
        PIXELS(&drawn, greys, __VA_ARGS__);                                                        \
        canvas_release(&drawn);                                                                    \
    } while (0)
#define DRAWN_GREYS(...)   DRAWN(true, __VA_ARGS__)
#define DRAWN_COLOURS(...) DRAWN(false, __VA_ARGS__)

static bool same_pixels(const struct canvas *a, const struct canvas *b)
{
    return a->width == b->width && a->height == b->height &&
           memcmp(a->rgba, b->rgba, (size_t)4 * a->width * a->height) == 0;
}

/* ---- placement ---- */

SCENE_STORY(plain_body, slices_lie_as_radiologists_look_at_them)
{
    const struct slice_style style = style_of(0, 255, SLICE_PLAIN);

    /* Right-anterior is top left; rows of 1.5 mm: 3 voxels in the middle of 5 pixels. */
    struct slice_choice choice = slice_number(scene, SLICE_AXIAL, 1, MM);
    DRAWN_GREYS(scene, &choice, &style, 4, 5, {0, 0, 230}, {3, 0, 200}, {0, 4, 150}, {3, 4, 120},
                {3, 1, 200}, {3, 2, 160}, {3, 3, 120});

    /* Right-superior is top left. */
    choice = slice_number(scene, SLICE_CORONAL, 0, MM);
    DRAWN_GREYS(scene, &choice, &style, 4, 6, {0, 0, 150}, {3, 2, 120}, {0, 3, 30}, {3, 5, 0});

    /* Anterior-superior is top left, and slice 3 is the patient's rightmost. */
    choice = slice_number(scene, SLICE_SAGITTAL, 3, MM);
    DRAWN_GREYS(scene, &choice, &style, 5, 6, {0, 0, 230}, {4, 0, 150}, {4, 5, 30});
}

SCENE_STORY(plain_body, a_slice_lies_in_the_middle_or_around_its_place)
{
    const struct slice_style style = style_of(0, 255, SLICE_PLAIN);
    struct slice_choice choice = slice_number(scene, SLICE_CORONAL, 0, MM);
    struct canvas s = take(scene, &choice, &style, 8, 10);
    GREYS(&s, {2, 2, 150}, {5, 7, 0}, {1, 2, 0});
    CHECK(s.cell[2 * 8 + 1] == CELL_NONE);
    CHECK(s.cell[1 * 8 + 2] == CELL_NONE && s.cell[8 * 8 + 5] == CELL_NONE);
    CHECK_INT(s.cell[2 * 8 + 2], grid_cell(&scene->grid, 3, 0, 1));
    CHECK_INT(s.cell[7 * 8 + 5], grid_cell(&scene->grid, 0, 0, 0));
    canvas_release(&s);

    /* Twelve of sixteen columns of a quarter are shown, at the patient's right end. */
    choice = slice_number(scene, SLICE_CORONAL, 0, MM / 4);
    choice.place[0] = 3;
    DRAWN_GREYS(scene, &choice, &style, 12, 24, {0, 0, 150}, {11, 0, 130});
    choice.place[0] = 0;
    DRAWN_GREYS(scene, &choice, &style, 12, 24, {0, 0, 140}, {11, 0, 120});
    choice.place[0] = 2; /* its four pixels in the middle of eight */
    DRAWN_GREYS(scene, &choice, &style, 8, 24, {1, 0, 150}, {2, 0, 140}, {5, 0, 140}, {6, 0, 130});
}

SCENE_STORY(plain_body, what_fits_is_as_large_as_can_be)
{
    CHECK_INT(slice_fitting_pixel(scene, SLICE_AXIAL, 8, 9), MM / 2);
    CHECK_INT(slice_fitting_pixel(scene, SLICE_AXIAL, 8, 3), 3 * MM / 2);
    CHECK_INT(slice_fitting_pixel(scene, SLICE_CORONAL, 1, 1000), 4 * MM);
    CHECK_INT(slice_fitting_pixel(scene, SLICE_SAGITTAL, 7, 100), (9 * MM / 2 + 6) / 7);
    CHECK_INT(slice_zoomed_pixel(scene, 1000), MM);
    CHECK_INT(slice_zoomed_pixel(scene, 64000), MM / 64);
    CHECK_INT(slice_zoomed_pixel(scene, 10), 100 * MM);
}

/* In each size every pixel has a cell of the slice, or none; at least one has a cell. */
STORY(slices_of_any_size_and_spacing_fit)
{
    static const uint32_t sizes[5][3] = {
        {65534, 1, 1}, {1, 65534, 2}, {3, 1, 65534}, {1, 1, 1}, {700, 500, 3}};
    static const uint32_t spacings[4][3] = {{1, 1, 1},
                                            {UINT32_MAX, UINT32_MAX, UINT32_MAX},
                                            {1000000, 1, UINT32_MAX},
                                            {999999, 1000003, 314159}};
    static const uint32_t pictures[4][2] = {{256, 256}, {1, 1}, {97, 2}, {31, 300}};
    struct slice_style style = style_of(0, 255, SLICE_CONTOUR);
    style.crosses = style.marks_seeds = true;
    for (unsigned i = 0; i < 5 * 4 * 4 * 3; i++) {
        const uint32_t *size = sizes[i / 48], *picture = pictures[i / 3 % 4];
        OWNED(scene_drop) struct scene *scene = NULL;
        if (!CHECK(scene_new(&scene, size, NULL, NULL, NULL) == OK))
            continue;
        memcpy(scene->spacing_nm, spacings[i / 12 % 4], sizeof scene->spacing_nm);
        struct slice_choice choice = {.plane = (enum slice_plane)(i % 3),
                                      .notes = SLICE_LETTERS | SLICE_SCALE | SLICE_COLOURS,
                                      .smooth = i % 2};
        for (int a = 0; a < 3; a++)
            choice.place[a] = size[a] / 2;
        const uint64_t pixels[3] = {0, slice_zoomed_pixel(scene, 10),
                                    slice_zoomed_pixel(scene, 64000)};
        for (int k = 0; k < 3; k++) {
            choice.pixel_pm = pixels[k];
            OWNED(canvas_release)
            struct canvas s = take(scene, &choice, &style, picture[0], picture[1]);
            size_t shown = 0;
            for (size_t p = 0; p < (size_t)s.width * s.height; p++)
                shown +=
                    s.cell[p] < scene->grid.cells && !(scene->cell[s.cell[p]].flags & CELL_RIM);
            CHECK(shown > 0);
        }
    }
}

/* Up to `most` voxels along each axis, in any direction; spacings of half a millimetre and up to
 * `more_nm` more. *choice gets a random plane, place and middle. */
static struct scene *random_scene(uint64_t *seed, uint32_t most, uint32_t more_nm,
                                  struct slice_choice *choice)
{
    struct scene *scene = NULL;
    uint32_t size[3];
    *choice = (struct slice_choice){.plane = (enum slice_plane)check_below(seed, 3)};
    for (int a = 0; a < 3; a++) {
        size[a] = 1 + check_below(seed, most);
        choice->place[a] = check_below(seed, size[a]);
        choice->middle[a] = check_below(seed, size[a]);
    }
    CHECK(scene_new(&scene, size, NULL, NULL, NULL) == OK);
    for (int a = 0; a < 3; a++) {
        scene->world_sign[a] = check_below(seed, 2) ? 1 : -1;
        scene->spacing_nm[a] = 500000 + check_below(seed, more_nm);
    }
    return scene;
}

/* In random slices a query returns the voxel drawn at the pixel, and a voxel of a pixel or more is
 * shown at the pixel of its centre. */
STORY(a_pixel_knows_its_voxel)
{
    uint64_t seed = 7;
    struct slice_style style = style_of(0, 255, SLICE_PLAIN);
    for (unsigned i = 0; i < 400; i++) {
        struct slice_choice choice;
        OWNED(scene_drop) struct scene *scene = random_scene(&seed, 12, 2000000, &choice);
        uint32_t wrong = 0;
        choice.smooth = check_below(&seed, 2);
        choice.pixel_pm = check_below(&seed, 3) ? 1 + check_random(&seed) % (2 * MM) : 0;
        OWNED(canvas_release)
        struct canvas s =
            take(scene, &choice, &style, 1 + check_below(&seed, 40), 1 + check_below(&seed, 40));
        for (uint32_t p = 0; p < s.width * s.height; p++)
            wrong += s.cell[p] !=
                     slice_cell_at(scene, &choice, s.width, s.height, p % s.width, p / s.width);
        struct slice_plan plan;
        slice_plan_init(&plan, scene, &choice, s.width, s.height);
        for (int k = 0; k < 2; k++)
            for (int64_t v = 0; v < plan.side[k].voxels; v++) {
                const int64_t p = slice_side_pixel(&plan.side[k], v);
                if (plan.side[k].spacing_pm >= plan.side[k].pixel_pm)
                    wrong += slice_side_voxel(&plan.side[k], p) != v;
            }
        CHECK_INT(wrong, 0);
    }
}

/* ---- magnified ---- */

/* One side of a picture, computed in reverse: from each voxel to its pixels. */
struct inverse {
    int64_t voxels, spacing_pm, pixels, pixel_pm;
    int64_t place, middle; /* counted from the begin of the picture's side */
    int64_t voxel[64];     /* by pixel, -1: none */
};

/* The first pixel whose centre is not before a point, which is doubled like `begin2`. */
static int64_t first_pixel(const struct inverse *side, int64_t begin2, int64_t point2)
{
    int64_t pixel = 0;
    while (pixel < side->pixels && begin2 + (2 * pixel + 1) * side->pixel_pm < point2)
        pixel++;
    return pixel;
}

/* The begin of the picture: a slice that fits is centred; otherwise it is as near to the wanted
 * middle as a full picture, and then the place, allow. */
static int64_t begin2_of(const struct inverse *side)
{
    const int64_t scene2 = 2 * side->voxels * side->spacing_pm;
    const int64_t picture2 = 2 * side->pixels * side->pixel_pm;
    if (scene2 <= picture2)
        return -((picture2 - scene2) / 2);
    int64_t begin2 = (2 * side->middle + 1) * side->spacing_pm - picture2 / 2;
    const int64_t place2 = (2 * side->place + 1) * side->spacing_pm;
    if (place2 - begin2 < picture2 / 8)
        begin2 = place2 - picture2 / 8;
    if (begin2 + picture2 - place2 < picture2 / 8)
        begin2 = place2 + picture2 / 8 - picture2;
    begin2 = begin2 < 0 ? 0 : begin2;
    return begin2 + picture2 > scene2 ? scene2 - picture2 : begin2;
}

static void invert(struct inverse *side)
{
    const int64_t begin2 = begin2_of(side);
    for (int64_t p = 0; p < side->pixels; p++)
        side->voxel[p] = -1;
    for (int64_t v = 0; v < side->voxels; v++) {
        const int64_t end = first_pixel(side, begin2, 2 * (v + 1) * side->spacing_pm);
        for (int64_t p = first_pixel(side, begin2, 2 * v * side->spacing_pm); p < end; p++)
            side->voxel[p] = v;
    }
}

/* The patient's axes of columns and rows, and across; and the conversion of a count from the
 * patient's right, front or top to an index of the scene. */
static const int8_t patient_axis[3][3] = {{0, 1, 2}, {0, 2, 1}, {1, 2, 0}};

static uint32_t index_of(const struct scene *scene, int axis, int64_t counted)
{
    return (uint32_t)(scene->world_sign[axis] > 0 ? scene->grid.size[axis] - 1 - counted : counted);
}

STORY(each_pixel_of_a_magnified_slice_shows_the_voxel_that_lies_there)
{
    uint64_t seed = 29;
    const struct slice_style style = style_of(0, 255, SLICE_PLAIN);
    for (unsigned i = 0; i < 3000; i++) {
        struct slice_choice choice;
        OWNED(scene_drop) struct scene *scene = random_scene(&seed, 30, 2000000, &choice);
        const unsigned order = check_below(&seed, 3);
        const uint32_t *size = scene->grid.size;
        uint32_t wrong = 0;
        choice.has_middle = check_below(&seed, 3);
        int axis_of[3]; /* axis of the scene along each of the patient's */
        for (int a = 0; a < 3; a++) {
            scene->world_axis[a] = (int8_t)(((unsigned)a + order) % 3);
            axis_of[scene->world_axis[a]] = a;
        }
        const uint32_t width = 8 + check_below(&seed, 56), height = 8 + check_below(&seed, 56);
        slice_magnify(&choice, scene, slice_fitting_pixel(scene, choice.plane, width, height),
                      SLICE_TIMES_ONE + check_below(&seed, 9) * check_below(&seed, 2000));
        OWNED(canvas_release) struct canvas s = take(scene, &choice, &style, width, height);
        struct inverse side[2];
        for (int k = 0; k < 2; k++) {
            const int a = axis_of[patient_axis[choice.plane][k]];
            side[k] = (struct inverse){.voxels = size[a],
                                       .spacing_pm = (int64_t)scene->spacing_nm[a] * 1000,
                                       .pixels = k == 0 ? width : height,
                                       .pixel_pm = (int64_t)choice.pixel_pm,
                                       .place = index_of(scene, a, choice.place[a])};
            side[k].middle =
                choice.has_middle ? index_of(scene, a, choice.middle[a]) : side[k].place;
            if (side[k].spacing_pm * side[k].voxels < side[k].pixel_pm)
                wrong = UINT32_MAX; /* thinner than a pixel: tested elsewhere */
            else
                invert(&side[k]);
        }
        for (uint32_t p = 0; wrong != UINT32_MAX && p < width * height; p++) {
            const int64_t column = side[0].voxel[p % width], row = side[1].voxel[p / width];
            uint32_t at[3], expected = CELL_NONE;
            memcpy(at, choice.place, sizeof at);
            for (int k = 0; k < 2; k++) {
                const int a = axis_of[patient_axis[choice.plane][k]];
                at[a] = index_of(scene, a, k == 0 ? column : row);
            }
            if (column >= 0 && row >= 0)
                expected = grid_cell(&scene->grid, at[0], at[1], at[2]);
            wrong += s.cell[p] != expected;
            wrong += slice_cell_at(scene, &choice, width, height, p % width, p / width) != expected;
        }
        CHECK(wrong == 0 || wrong == UINT32_MAX);
    }
}

/* If pixels are finer than voxels, that pixel shows the voxel. */
STORY(the_pixel_of_a_voxel_is_where_its_centre_lies)
{
    uint64_t seed = 37;
    unsigned shown = 0, wrong = 0;
    for (unsigned i = 0; i < 3000; i++) {
        struct slice_choice choice;
        OWNED(scene_drop) struct scene *scene = random_scene(&seed, 12, 1000000, &choice);
        const uint32_t width = 64 + check_below(&seed, 90), height = 64 + check_below(&seed, 90);
        const uint32_t *size = scene->grid.size;
        uint32_t pixel[2];
        slice_magnify(&choice, scene, slice_fitting_pixel(scene, choice.plane, width, height),
                      SLICE_TIMES_ONE + check_below(&seed, 3000));
        wrong += !slice_pixel_of(scene, &choice, width, height, choice.place, pixel);
        const int across = slice_axis(scene, choice.plane);
        for (uint32_t cell = 0; cell < scene->grid.voxels; cell++) {
            const uint32_t place[3] = {cell % size[0], cell / size[0] % size[1],
                                       cell / size[0] / size[1]};
            const bool is_there = slice_pixel_of(scene, &choice, width, height, place, pixel);
            shown += is_there;
            wrong += is_there && place[across] != choice.place[across];
            wrong += is_there && slice_cell_at(scene, &choice, width, height, pixel[0], pixel[1]) !=
                                     grid_cell(&scene->grid, place[0], place[1], place[2]);
        }
    }
    CHECK_INT(wrong, 0);
    CHECK(shown > 30000);
}

/* Any slice moves by at least a voxel, or to the end, and the place stays in the picture. */
STORY(a_magnified_slice_goes_on_and_takes_its_place_along)
{
    uint64_t seed = 31;
    unsigned moved = 0, ended = 0, wrong = 0;
    for (unsigned i = 0; i < 20000; i++) {
        struct slice_choice choice;
        OWNED(scene_drop) struct scene *scene = random_scene(&seed, 12, 2000000, &choice);
        const uint32_t width = 8 + check_below(&seed, 90), height = 8 + check_below(&seed, 90);
        const int by[2] = {(int)check_below(&seed, 9) - 4, (int)check_below(&seed, 9) - 4};
        uint32_t middle[3], place[3];
        struct slice_plan before, after;
        choice.has_middle = check_below(&seed, 2);
        slice_magnify(&choice, scene, slice_fitting_pixel(scene, choice.plane, width, height),
                      SLICE_TIMES_ONE + check_below(&seed, 20000));
        slice_plan_init(&before, scene, &choice, width, height);
        const bool goes = slice_pan(scene, &choice, width, height, by, middle, place);
        moved += goes;
        ended += !goes;
        choice.has_middle = true;
        for (int a = 0; a < 3; a++) {
            wrong += middle[a] >= scene->grid.size[a] || place[a] >= scene->grid.size[a];
            choice.middle[a] = middle[a];
            choice.place[a] = place[a];
        }
        slice_plan_init(&after, scene, &choice, width, height);
        for (int k = 0; k < 2; k++) {
            const struct slice_side *from = &before.side[k], *to = &after.side[k];
            const int64_t on = to->origin2 - from->origin2;
            const int64_t at = slice_side_pixel(to, slice_side_counted(to, place));
            const bool is_larger = to->voxels * to->spacing_pm > to->pixels * to->pixel_pm;
            wrong += at < 0 || at >= to->pixels;
            wrong += goes && (by[k] > 0 ? on < 0 : by[k] < 0 ? on > 0 : false);
            wrong += !goes && by[k] && is_larger && from->origin2 > 0 &&
                     from->origin2 + 2 * from->pixels * from->pixel_pm <
                         2 * from->voxels * from->spacing_pm - 2 * from->spacing_pm &&
                     from->origin2 > 2 * from->spacing_pm;
        }
        wrong += place[before.across] != choice.place[before.across];
    }
    CHECK_INT(wrong, 0);
    CHECK(moved > 1000 && ended > 100);
}

/* Voxels with fewer than four pixels along the smallest spacing are smoothed. */
SCENE_STORY(plain_body, what_is_magnified_enough_shows_voxels_as_they_are)
{
    struct slice_choice choice = {.plane = SLICE_AXIAL};
    slice_magnify(&choice, scene, MM, 1000);
    CHECK(choice.pixel_pm == MM && choice.smooth);
    slice_magnify(&choice, scene, MM, 3999);
    CHECK(choice.smooth);
    slice_magnify(&choice, scene, MM, 4000);
    CHECK(choice.pixel_pm == MM / 4 && !choice.smooth);
    slice_magnify(&choice, scene, MM / 8, 1000); /* a whole slice is always smoothed */
    CHECK(choice.smooth);
    slice_magnify(&choice, scene, 1, SLICE_TIMES_MOST);
    CHECK_INT(choice.pixel_pm, 1);
}

/* ---- grey ---- */

SCENE_STORY(plain_body, a_window_ramps_from_black_to_white)
{
    static uint8_t grey[UINT16_MAX + 1];
    slice_window(grey, 10, 30);
    CHECK(grey[0] == 0 && grey[10] == 0 && grey[11] == 13);
    CHECK(grey[20] == 128 && grey[30] == 255 && grey[UINT16_MAX] == 255);
    slice_window(grey, 30, 10); /* values fall as intensities rise */
    CHECK(grey[0] == 255 && grey[10] == 255 && grey[20] == 128 && grey[30] == 0);
    slice_window(grey, -(1 << 30), 1 << 30);
    CHECK(grey[0] == 128 && grey[UINT16_MAX] == 128);
    slice_window(grey, 70000, 70001);
    CHECK(grey[UINT16_MAX] == 0);

    const struct slice_style style = style_of(10, 30, SLICE_PLAIN);
    const struct slice_choice choice = slice_number(scene, SLICE_AXIAL, 0, MM / 2);
    /* Intensities 0, 10, 20 (127.5), 20, 30; and more. */
    DRAWN_GREYS(scene, &choice, &style, 8, 9, {7, 8, 0}, {5, 8, 0}, {3, 8, 128}, {2, 8, 128},
                {1, 8, 255}, {0, 0, 255});
}

STORY(smooth_grey_lies_between_the_four_voxels_around)
{
    static const uint32_t size[3] = {2, 2, 1};
    static const int along[8] = {0, 0, 13, 38, 63, 88, 100, 100}; /* 12.5, 37.5, 62.5, 87.5 */
    OWNED(scene_drop) struct scene *scene = NULL;
    CHECK(scene_new(&scene, size, (const uint16_t[]){0, 100, 100, 200}, NULL, NULL) == OK);
    for (int i = 0; i < 2; i++)
        scene->world_sign[i] = -1;
    const struct slice_style style = style_of(0, 255, SLICE_PLAIN);
    struct slice_choice choice = {.plane = SLICE_AXIAL, .pixel_pm = MM / 4, .smooth = true};
    OWNED(canvas_release) struct canvas s = take(scene, &choice, &style, 8, 8);
    for (uint32_t i = 0; i < 8; i++) {
        CHECK_INT(grey_at(&s, i, 0), along[i]);
        CHECK_INT(grey_at(&s, 0, i), along[i]);
        CHECK_INT(grey_at(&s, i, 7), 100 + along[i]);
    }
    CHECK_INT(grey_at(&s, 3, 3), 75); /* 37.5 each way */
    CHECK_INT(grey_at(&s, 4, 3), 100);
    CHECK_INT(s.cell[3 * 8 + 3], grid_cell(&scene->grid, 0, 0, 0));
    CHECK_INT(s.cell[3 * 8 + 4], grid_cell(&scene->grid, 1, 0, 0));
    for (uint32_t i = 0; i < 4; i++) /* no sum overflows */
        scene->cell[grid_cell(&scene->grid, i % 2, i / 2, 0)].intensity = 65535;
    DRAWN_GREYS(scene, &choice, &style, 8, 8, {3, 4, 255});
}

/* ---- labels ---- */

SCENE_STORY(plain_body, labels_tint_or_are_outlined)
{
    struct slice_choice choice = slice_number(scene, SLICE_AXIAL, 0, MM / 2);
    struct slice_style style = style_of(0, 255, SLICE_TINT);
    /* Twice 30 with 80, 96, 112: 46.7, 52, 57.3; twice 110 with 255, 0, 1: 158.3, 73.3, 73.7. */
    DRAWN_COLOURS(scene, &choice, &style, 8, 9, {0, 8, 47, 52, 57}, {0, 0, 158, 73, 74},
                  {7, 8, 0, 0, 0});

    /* Label 2 fills columns 0-3 of rows 0-2, label 1 those of rows 3-8. No contour at the picture's
     * edge; a hairline in the background, a quarter of 10, and nothing beyond. */
    style.overlay = SLICE_CONTOUR;
    DRAWN_COLOURS(scene, &choice, &style, 8, 9, {0, 0, 110, 110, 110}, {0, 1, 110, 110, 110},
                  {0, 2, 255, 0, 1}, {0, 3, 0x50, 0x60, 0x70}, {2, 8, 20, 20, 20},
                  {3, 8, 0x50, 0x60, 0x70}, {4, 8, 2, 2, 2}, {5, 8, 10, 10, 10});

    /* Outside the scene there is background. */
    DRAWN_COLOURS(scene, &choice, &style, 10, 11, {1, 1, 255, 0, 1}, {1, 9, 0x50, 0x60, 0x70},
                  {0, 1, 0, 0, 0});

    /* A hidden label is background. */
    visible[1] = false;
    DRAWN_COLOURS(scene, &choice, &style, 8, 9, {0, 2, 255, 0, 1}, {0, 3, 17, 17, 17},
                  {3, 8, 20, 20, 20});
    style.overlay = SLICE_TINT;
    DRAWN_COLOURS(scene, &choice, &style, 8, 9, {0, 8, 30, 30, 30}, {0, 0, 158, 73, 74});
    visible[1] = true;

    /* From the side, label 2 fills columns 0-2, label 1 columns 3-8. */
    style.overlay = SLICE_CONTOUR;
    choice = slice_number(scene, SLICE_SAGITTAL, 3, MM / 2);
    DRAWN_COLOURS(scene, &choice, &style, 9, 12, {2, 0, 255, 0, 1}, {3, 0, 0x50, 0x60, 0x70},
                  {4, 0, 190, 190, 190});
}

SCENE_STORY(plain_body, contours_are_thicker_in_larger_pictures)
{
    const struct slice_style style = style_of(0, 255, SLICE_CONTOUR);
    const struct slice_choice choice = slice_number(scene, SLICE_AXIAL, 0, 0);
    /* 100 columns, 150 rows a voxel; a hairline inside, if there is room. */
    DRAWN_COLOURS(scene, &choice, &style, 400, 450, {0, 149, 255, 0, 1}, {0, 148, 255, 0, 1},
                  {0, 147, 27, 27, 27}, {0, 146, 110, 110, 110}, {199, 449, 0x50, 0x60, 0x70},
                  {198, 449, 0x50, 0x60, 0x70}, {197, 449, 5, 5, 5}, {196, 449, 20, 20, 20});
}

static uint8_t label_under(const struct scene *scene, const struct canvas *s, size_t pixel)
{
    return s->cell[pixel] == CELL_NONE ? 0 : scene->cell[s->cell[pixel]].label;
}

/* Distance along rows and columns to the nearest other label; 0 if none is within `reach`. */
static int64_t edge_by_search(const struct scene *scene, const struct canvas *s, int64_t x,
                              int64_t y, int64_t reach)
{
    static const int64_t way[4][2] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}};
    const uint8_t own = label_under(scene, s, (size_t)(y * s->width + x));
    for (int64_t d = 1; d <= reach; d++)
        for (int i = 0; i < 4; i++) {
            const int64_t at[2] = {x + d * way[i][0], y + d * way[i][1]};
            if (at[0] >= 0 && at[1] >= 0 && at[0] < s->width && at[1] < s->height &&
                label_under(scene, s, (size_t)(at[1] * s->width + at[0])) != own)
                return d;
        }
    return 0;
}

/* Random blocks of labels and background, in pictures with and without margins: lines of one pixel
 * have a hairline outside, those of two pixels inside as well. */
STORY(contours_and_hairlines_are_those_of_a_plain_search)
{
    static const uint32_t size[3] = {40, 30, 20};
    static const uint32_t pictures[4][2] = {{90, 70}, {400, 410}, {33, 50}, {120, 40}};
    struct slice_style style = style_of(0, 255, SLICE_CONTOUR);
    OWNED(scene_drop) struct scene *scene = NULL;
    uint64_t seed = 3;
    CHECK(scene_new(&scene, size, NULL, NULL, NULL) == OK);
    for (uint32_t c = 0; c < scene->grid.cells; c++)
        if (!(scene->cell[c].flags & CELL_RIM)) {
            scene->cell[c].intensity = 200;
            const unsigned label = check_below(&seed, 40) < 30 ? 1 : 2;
            scene->cell[c].label = (uint8_t)(c / 160 % 3 ? label : 0);
        }
    for (unsigned i = 0; i < 24; i++) {
        const uint32_t *picture = pictures[i % 4];
        const struct slice_choice choice = {.plane = (enum slice_plane)(i / 8),
                                            .place = {20, 15, 10},
                                            .pixel_pm = i % 8 < 4 ? 0 : MM / 3,
                                            .smooth = i % 2};
        OWNED(canvas_release)
        struct canvas s = take(scene, &choice, &style, picture[0], picture[1]);
        const int64_t line = picture[0] >= 400 ? 2 : 1;
        uint32_t wrong = 0, hairs = 0;
        for (uint32_t p = 0; p < s.width * s.height; p++) {
            const uint32_t x = p % s.width, y = p / s.width;
            const uint8_t own = label_under(scene, &s, p);
            const int64_t edge = edge_by_search(scene, &s, x, y, line + 1);
            const bool is_hair = own ? line > 1 && edge == line + 1 : edge == 1;
            const int grey = s.cell[p] == CELL_NONE ? 0 : is_hair ? 50 : 200;
            wrong += own && edge && edge <= line
                         ? memcmp(canvas_pixel(&s, x, y), style.palette->rgb[own], 3) != 0
                         : !is_rgb(&s, x, y, grey, grey, grey);
            hairs += is_hair && grey;
        }
        CHECK_INT(wrong, 0);
        CHECK(hairs > 0);
    }
}

/* ---- marks ---- */

SCENE_STORY(plain_body, a_cross_leaves_its_voxel_free)
{
    struct slice_style style = style_of(0, 255, SLICE_PLAIN);
    const struct slice_choice choice = through(scene, SLICE_AXIAL, MM / 8);
    style.crosses = true;
    /* Voxel 1, 2 has columns 16 to 23, rows 0 to 11; the lines are column 20 and row 6, and leave
     * half a voxel and one pixel free. */
    /* Column 12: a third of 220. */
    DRAWN_COLOURS(scene, &choice, &style, 32, 36, {20, 6, 210, 210, 210}, {13, 6, 220, 220, 220},
                  {12, 6, 243, 220, 73}, {0, 6, 247, 223, 77}, {27, 6, 200, 200, 200},
                  {28, 6, 237, 213, 67}, {20, 13, 170, 170, 170}, {20, 14, 227, 203, 57},
                  {20, 35, 213, 190, 43}, {21, 35, 130, 130, 130}, {0, 7, 230, 230, 230});
}

/* A black scene of 41 mm a side. */
static struct scene *dark_scene(void)
{
    static const uint32_t size[3] = {41, 41, 41};
    struct scene *scene = NULL;
    CHECK(scene_new(&scene, size, NULL, NULL, NULL) == OK);
    for (int a = 0; a < 3; a++)
        scene->world_sign[a] = -1; /* so that columns and rows are indices in axial slices */
    return scene;
}

SCENE_STORY(dark_scene, seeds_are_dots_and_eliminators_crosses)
{
    struct slice_style style = style_of(0, 255, SLICE_PLAIN);
    struct slice_choice choice = {.plane = SLICE_AXIAL, .place = {0, 0, 20}, .pixel_pm = MM};
    struct cell *planted = scene->cell + grid_cell(&scene->grid, 5, 6, 20);
    planted->flags = CELL_SEED;
    planted->label = 2;
    scene->cell[grid_cell(&scene->grid, 30, 30, 21)].flags = CELL_SEED; /* another slice */
    scene->cell[grid_cell(&scene->grid, 6, 30, 20)].flags = CELL_SEED;  /* the background's */
    const struct slice_mark mark[] = {{grid_cell(&scene->grid, 20, 6, 20), 1, false, true},
                                      {grid_cell(&scene->grid, 20, 20, 20), 0, true, false},
                                      {grid_cell(&scene->grid, 30, 20, 20), 0, true, true},
                                      {grid_cell(&scene->grid, 34, 34, 19), 1, false, true}};
    OWNED(canvas_release) struct canvas plain = take(scene, &choice, &style, 41, 41);
    style.marks_seeds = true;
    style.mark = mark;
    style.marks = 4;
    DRAWN_COLOURS(
        scene, &choice, &style, 41, 41, {5, 6, 255, 0, 1}, {4, 6, 255, 0, 1}, {5, 7, 255, 0, 1},
        {5, 4, 0, 0, 0}, {6, 30, 225, 225, 225}, {20, 6, 0x50, 0x60, 0x70}, {18, 6, 255, 255, 255},
        {20, 20, 255, 72, 56}, {22, 18, 255, 72, 56}, {18, 18, 255, 72, 56}, {22, 20, 0, 0, 0},
        {32, 22, 255, 72, 56}, {31, 20, 255, 255, 255}, {30, 30, 0, 0, 0}, {34, 34, 0, 0, 0});
    style.marks_seeds = false;
    OWNED(canvas_release) struct canvas s = take(scene, &choice, &style, 41, 41);
    CHECK(same_pixels(&s, &plain));
}

/* Two labels side by side, 9x9 each, and a smaller block that waits in one of them. */
static size_t plant_blocks(struct scene *scene, struct slice_mark waiting[25])
{
    size_t count = 0;
    for (uint32_t y = 10; y < 19; y++)
        for (uint32_t x = 10; x < 28; x++) {
            const uint32_t c = grid_cell(&scene->grid, x, y, 20);
            scene->cell[c].flags = CELL_SEED;
            scene->cell[c].label = x < 19 ? 1 : 2;
            if (x >= 12 && x < 17 && y >= 12 && y < 17)
                waiting[count++] = (struct slice_mark){c, 1, false, true};
        }
    return count;
}

SCENE_STORY(dark_scene, of_a_run_of_seeds_the_rim_is_marked)
{
    struct slice_style style = style_of(0, 255, SLICE_PLAIN);
    const struct slice_choice choice = {
        .plane = SLICE_AXIAL, .place = {0, 0, 20}, .pixel_pm = MM / 10};
    struct slice_mark waiting[25];
    style.marks_seeds = true;
    style.mark = waiting;
    style.marks = plant_blocks(scene, waiting);
    OWNED(canvas_release) struct canvas s = take(scene, &choice, &style, 410, 410);
    for (uint32_t y = 10; y < 19; y++)
        for (uint32_t x = 10; x < 28; x++) {
            const bool edge = y == 10 || y == 18 || x == 10 || x == 18 || x == 19 || x == 27;
            const bool in = x >= 12 && x < 17 && y >= 12 && y < 17;
            const bool touches = !in && x >= 11 && x < 18 && y >= 11 && y < 18 &&
                                 ((x >= 12 && x < 17) || (y >= 12 && y < 17));
            const bool rim = in ? x == 12 || x == 16 || y == 12 || y == 16 : edge || touches;
            CHECK_INT(is_rgb(&s, 10 * x + 5, 10 * y + 5, 0, 0, 0), !rim);
        }
}

/* The block at a pixel: 0 for none, 3 waits. */
static int block_at(int64_t x, int64_t y)
{
    const bool waits = x >= 120 && x < 170 && y >= 120 && y < 170;
    return y < 100 || y >= 190 || x < 100 || x >= 280 ? 0 : waits ? 3 : x < 190 ? 1 : 2;
}

static int block_near(int64_t x, int64_t y, int64_t reach)
{
    const int own = block_at(x, y);
    for (int64_t d = 1; d <= reach; d++)
        for (int i = 0; i < 4; i++) {
            const int64_t by = i % 2 ? d : -d;
            const int other = block_at(x + (i < 2 ? by : 0), y + (i < 2 ? 0 : by));
            if (other != own)
                return other;
        }
    return own;
}

static bool fills(const void *of, uint32_t cell)
{
    const struct scene *scene = of;
    return scene->cell[cell].label == 2;
}

/* On a screen: a line inside the rim, a hairline outside, a tint in the object under the
 * cross-hair; a single seed is a dot, but not one that continues a line obliquely. */
SCENE_STORY(dark_scene, thin_marks_leave_what_they_mark_to_be_seen)
{
    struct slice_style style = style_of(0, 255, SLICE_PLAIN);
    const struct slice_choice choice = {
        .plane = SLICE_AXIAL, .place = {0, 0, 20}, .pixel_pm = MM / 10};
    struct slice_mark waiting[25];
    struct cell *alone = scene->cell + grid_cell(&scene->grid, 34, 5, 20);
    for (size_t i = 0; i < scene->grid.cells; i++)
        scene->cell[i].intensity = 100;
    style.marks_seeds = style.thin = true;
    style.filled = (struct mark_choice){fills, scene};
    style.mark = waiting;
    style.marks = plant_blocks(scene, waiting);
    alone->flags = CELL_SEED;
    alone->label = 1;
    for (uint32_t i = 0; i < 3; i++) {
        struct cell *oblique = scene->cell + grid_cell(&scene->grid, 5 + i, 34 + i, 20);
        oblique->flags = CELL_SEED;
        oblique->label = 1;
    }
    OWNED(canvas_release) struct canvas s = take(scene, &choice, &style, 410, 410);
    for (uint32_t y = 90; y < 200; y++)
        for (uint32_t x = 90; x < 290; x++) {
            const int own = block_at(x, y), other = block_near(x, y, own ? 2 : 1);
            CHECK(other == own && own == 2 ? is_rgb(&s, x, y, 152, 67, 67)
                  : other == own           ? grey_at(&s, x, y) == 100
                  : own == 2               ? is_rgb(&s, x, y, 255, 0, 1)
                  : own                    ? is_rgb(&s, x, y, 0x50, 0x60, 0x70)
                                           : grey_at(&s, x, y) == 25);
        }
    CHECK(is_rgb(&s, 345, 55, 0x50, 0x60, 0x70) && is_rgb(&s, 345, 58, 0, 0, 0) &&
          is_rgb(&s, 340, 55, 0x50, 0x60, 0x70) && grey_at(&s, 345, 61) == 100);
    for (uint32_t i = 0; i < 3; i++)
        CHECK(grey_at(&s, 55 + 10 * i, 345 + 10 * i) == 100 &&
              is_rgb(&s, 50 + 10 * i, 345 + 10 * i, 0x50, 0x60, 0x70));
}

/* The letter in the middle of an edge (0 left, 1 right, 2 top, 3 bottom) of a picture of 100x100
 * that is black there; '?' for none. */
static char letter_at(const struct canvas *s, int edge)
{
    static const uint32_t corner[4][2] = {{0, 40}, {85, 40}, {40, 0}, {40, 80}};
    for (const char *letter = "RLAPSI"; *letter; letter++) {
        const char word[2] = {*letter, '\0'}, *const sides[4] = {word, word, word, word};
        OWNED(canvas_release) struct canvas expected = {0};
        bool same = true;
        CHECK(canvas_init(&expected, 100, 100, 0, NULL) == OK);
        notes_draw_sides(&expected, 100, sides, &notes_light);
        for (uint32_t y = 0; y < 20; y++)
            same &= memcmp(canvas_pixel(&expected, corner[edge][0], corner[edge][1] + y),
                           canvas_pixel(s, corner[edge][0], corner[edge][1] + y), 15 * 4) == 0;
        if (same)
            return *letter;
    }
    return '?';
}

/* Those drawn, and those returned by slice_letters. */
static void letters_are(const struct scene *scene, enum slice_plane plane, const char *expected)
{
    char letter[5] = "";
    const struct slice_style style = style_of(0, 255, SLICE_PLAIN);
    const struct slice_choice choice = {
        .plane = plane, .pixel_pm = 10 * MM, .notes = SLICE_LETTERS};
    OWNED(canvas_release) struct canvas s = take(scene, &choice, &style, 100, 100);
    for (int edge = 0; edge < 4; edge++)
        CHECK_INT(letter_at(&s, edge), expected[edge]);
    slice_letters(scene, plane, letter);
    CHECK_TEXT(letter, expected);
}

STORY(letters_say_where_the_patients_sides_are)
{
    for (unsigned o = 0; o < 48; o++) {
        OWNED(scene_drop) struct scene *scene = body_scene(o);
        letters_are(scene, SLICE_AXIAL, "RLAP");
        letters_are(scene, SLICE_CORONAL, "RLSI");
        letters_are(scene, SLICE_SAGITTAL, "APSI");
    }
}

STORY(lengths_of_bars_are_round)
{
    static const uint64_t length[] = {1, 2, 4, 5, 9, 10, 19, 20, 49, 50, 99, 100, 4999, UINT64_MAX};
    static const uint64_t expected[] = {1,  2,  2,  5,  5,   10,   10,
                                        20, 20, 50, 50, 100, 2000, 10000000000000000000u};
    for (size_t i = 0; i < sizeof length / sizeof length[0]; i++)
        CHECK_INT(slice_round_length(length[i]), expected[i]);
}

/* In a black picture of 200 pixels of 1 mm: 50 mm bottom left, greys bottom right. */
SCENE_STORY(dark_scene, bars_tell_lengths_and_greys)
{
    struct slice_style style = style_of(0, 255, SLICE_PLAIN);
    struct slice_choice choice = {.plane = SLICE_AXIAL, .pixel_pm = MM, .notes = SLICE_SCALE};
    struct canvas s = take(scene, &choice, &style, 200, 200), words;
    GREYS(&s, {4, 195, 232}, {53, 195, 232}, {3, 195, 0}, {54, 195, 0}, {4, 193, 232}, {5, 193, 0});
    CHECK(canvas_init(&words, 200, 200, 0, NULL) == OK);
    text_draw(&words, 4, 180, 8, "50 mm", &notes_light);
    for (uint32_t y = 175; y < 190; y++)
        CHECK(memcmp(canvas_pixel(&s, 0, y), canvas_pixel(&words, 0, y), 60 * 4) == 0);
    canvas_release(&s);
    canvas_release(&words);

    choice.notes = SLICE_COLOURS;
    style.least = "-12.5";
    style.most = "300";
    s = take(scene, &choice, &style, 200, 200);
    GREYS(&s, {190, 194, 0}, {190, 145, 255}, {190, 170, 124}, {189, 170, 232}, {195, 170, 232});
    CHECK(canvas_init(&words, 200, 200, 0, NULL) == OK);
    text_draw(&words, 185 - text_width("300", 8), 145, 8, "300", &notes_light);
    text_draw(&words, 185 - text_width("-12.5", 8), 187, 8, "-12.5", &notes_light);
    for (uint32_t y = 140; y < 200; y++)
        CHECK(memcmp(canvas_pixel(&s, 150, y), canvas_pixel(&words, 150, y), 38 * 4) == 0);
    canvas_release(&s);
    canvas_release(&words);
}

/* ---- every orientation ---- */

static struct canvas take_noted(const struct scene *scene, unsigned i)
{
    static const uint64_t pixels[3] = {0, 1000000000, 300000000};
    struct slice_style style = style_of(20, 200, (enum slice_overlay)(i / 3 % 3));
    struct slice_choice choice = through(scene, (enum slice_plane)(i % 3), pixels[i / 9 % 3]);
    const uint32_t *at = choice.place;
    const struct slice_mark mark = {grid_cell(&scene->grid, at[0], at[1], at[2]), 2, i / 27 % 2,
                                    true};
    choice.smooth = i / 27 % 2;
    choice.notes = SLICE_LETTERS | SLICE_SCALE | SLICE_COLOURS;
    style.crosses = style.marks_seeds = true;
    style.mark = &mark;
    style.marks = 1;
    return take(scene, &choice, &style, 130, 131);
}

SCENE_STORY(plain_body, all_48_orientations_give_the_same_pictures)
{
    for (unsigned o = 0; o < 48; o++) {
        OWNED(scene_drop) struct scene *turned = body_scene(o);
        for (unsigned i = 0; i < 54; i++) {
            CHECK_INT(slice_count(turned, (enum slice_plane)(i % 3)), body_size[2 - i % 3]);
            OWNED(canvas_release) struct canvas expected = take_noted(scene, i);
            OWNED(canvas_release) struct canvas actual = take_noted(turned, i);
            CHECK(same_pixels(&actual, &expected));
        }
    }
}

/* ---- without memory ---- */

SCENE_STORY(dark_scene, without_memory_there_is_no_slice)
{
    struct slice_style style = style_of(0, 255, SLICE_CONTOUR);
    const struct slice_choice choice = {.plane = SLICE_AXIAL};
    struct canvas canvas;
    struct fault fault;
    unsigned refused = 0;
    enum err err = ERR_MEMORY;
    scene->cell[grid_cell(&scene->grid, 3, 3, 0)].flags = CELL_SEED;
    style.marks_seeds = true;
    CHECK(canvas_init(&canvas, 20, 20, CANVAS_CELLS, NULL) == OK);
    count_allocations();
    CHECK(slice_draw(&canvas, scene, &choice, &style, &fault) == OK);
    for (unsigned n = 0; err == ERR_MEMORY && n < 100; n++) {
        allow_allocations(n);
        err = slice_draw(&canvas, scene, &choice, &style, &fault);
        mem_allows = NULL;
        refused += err == ERR_MEMORY;
    }
    CHECK_INT(err, OK);
    CHECK_INT(refused, allocations_made);
    CHECK_HAS(fault.text, "a slice");
    canvas_release(&canvas);
    allow_allocations(0);
    CHECK(canvas_init(&canvas, 20, 20, CANVAS_CELLS, &fault) == ERR_MEMORY && !canvas.rgba);
    mem_allows = NULL;
}
