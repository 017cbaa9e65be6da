/* SPDX-License-Identifier: MIT */
/* Slices and mosaics by command: real files in every orientation, real values, pending edits, and
 * journals that show the same again. */
#include <math.h>

#include "command/golden_files.h"
#include "base/file.h"
#include "base/hash.h"
#include "image/exr.h"
#include "image/image_helper.h"
#include "image/volume.h"
#include "render/notes.h"
#include "program/panes.h"
#include "show/pictures.h"
#include "show/slicing.h"
#include "tests/interpreting.h"
#include "tests/folder.h"
#include "tests/scarce_memory.h"

static char folder[FOLDER_LENGTH];
static struct interpreter interp;

static void begin_anew(void)
{
    interpreter_release(&interp);
    begin_interpreter(&interp);
}

static void refused(const char *line, const char *words)
{
    CHECK(execute(&interp, line) != OK);
    CHECK_HAS(fault.text, words);
    CHECK(!interp.shows_picture);
}

/* ---- heads in every orientation ---- */

enum { SIDE = 20 };

/* Which voxels a head has: all are dark but those within three of one of the patient's sides, and
 * the way from voxels to the patient (Right, Anterior, Superior from 0 on). */
struct head {
    double to_patient[3][4];
    int bright_axis;
    bool bright_at_end;
};

static void head_row(void *context, uint32_t y, uint32_t z, void *values)
{
    const struct head *head = context;
    const double *row = head->to_patient[head->bright_axis];
    uint8_t *at = values;
    for (uint32_t x = 0; x < SIDE; x++) {
        const double place = row[0] * x + row[1] * y + row[2] * z + row[3];
        *at++ = (head->bright_at_end ? place > SIDE - 4 : place < 3) ? 200 : 1;
    }
}

/* The signed permutation number 0..47: voxel axis a runs along patient axis order[a]. */
static void orient(double to_patient[3][4], unsigned number)
{
    static const int order[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2},
                                    {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    memset(to_patient, 0, 12 * sizeof(double));
    for (int a = 0; a < 3; a++) {
        const int axis = order[number / 8][a];
        const bool against = number >> a & 1;
        to_patient[axis][a] = against ? -1 : 1;
        to_patient[axis][3] = against ? SIDE - 1 : 0;
    }
}

static void write_head(const char *name, struct head *head, double to_mm[3][4])
{
    static const uint32_t size[3] = {SIDE, SIDE, SIDE};
    struct geometry geometry = {.slope = 1, .spacing_nm = {1000000, 1000000, 1000000}};
    CHECK(geometry_place(&geometry, (const double(*)[4])to_mm, ORIENTATION_SFORM));
    CHECK(volume_write(name, FILE_REPLACE,
                       &(struct volume_map){size, &geometry, VOXEL_UINT8, "test", head_row, head,
                                            NULL, NULL, NULL},
                       NULL, NULL) == OK);
}

/* Replace bytes of a file's header. */
static void patch(const char *name, size_t at, const void *bytes, size_t length)
{
    OWNED(buf_release) struct buf file = {0};
    CHECK(file_read(&file, name, 1 << 20, NULL) == OK && file.length > 352);
    memcpy(file.data + at, bytes, length);
    CHECK(file_write(name, file.data, file.length, FILE_REPLACE, NULL) == OK);
}

/* Remove the sform and write a qform of the rotation b, c, d, with pixdim[0] = qfac. */
static void use_qform(const char *name, const float quaternion[3], float qfac)
{
    patch(name, 76, &qfac, 4);
    patch(name, 252, (const int16_t[]){1, 0}, 4); /* qform_code, sform_code */
    patch(name, 256, quaternion, 12);
    patch(name, 268, (const float[]){-5, 7, 11}, 12);
}

/* Return the letter in the middle of an edge of a picture of 100x100; 0 left, 1 right, 2 top, 3
 * bottom. The background is not always black: only pixels count that are equal on black and on
 * white. */
static char letter_at(const struct canvas *s, int edge)
{
    static const uint32_t corner[4][2] = {{0, 40}, {85, 40}, {40, 0}, {40, 80}};
    static const uint8_t white[3] = {255, 255, 255};
    for (const char *letter = "RLAPSI"; *letter; letter++) {
        const char word[2] = {*letter, '\0'}, *const sides[4] = {word, word, word, word};
        struct canvas on[2];
        bool same = true;
        for (int ground = 0; ground < 2; ground++) {
            CHECK(canvas_init(&on[ground], 100, 100, 0, NULL) == OK);
            if (ground)
                canvas_box(&on[ground], 0, 0, 100, 100, white);
            notes_draw_sides(&on[ground], 100, sides, &notes_light);
        }
        for (uint32_t y = corner[edge][1]; y < corner[edge][1] + 20; y++)
            for (uint32_t x = corner[edge][0]; x < corner[edge][0] + 15; x++) {
                const uint8_t *a = canvas_pixel(&on[0], x, y), *b = canvas_pixel(&on[1], x, y);
                same &= *a != *b || *canvas_pixel(s, x, y) == *a;
            }
        canvas_release(&on[0]);
        canvas_release(&on[1]);
        if (same)
            return *letter;
    }
    return '?';
}

/* The scene is bright on one of the patient's sides, `letter`: in both planes that have that side
 * on an edge, the bright edge is the one with the letter. */
static void bright_is(char letter)
{
    static const char *const plane[3] = {"slice axial", "slice coronal", "slice sagittal"};
    static const uint32_t inside[4][2] = {{5, 30}, {94, 30}, {30, 5}, {30, 94}};
    unsigned found = 0;
    for (int p = 0; p < 3; p++) {
        must(&interp, plane[p]);
        const struct canvas *s = &interp.shown;
        for (int edge = 0; edge < 4; edge++) {
            const uint8_t *pixel = canvas_pixel(s, inside[edge][0], inside[edge][1]);
            if (letter_at(s, edge) == letter) {
                CHECK(pixel[0] == 255);
                found++;
            } else if (strchr("RLAPSI", letter_at(s, edge))) {
                CHECK(pixel[0] == 0);
            } else {
                CHECK(letter_at(s, edge) == letter);
            }
        }
    }
    CHECK_INT(found, 2);
}

/* A head that is bright on each of the sides in turn. */
static void heads_are_bright_where_they_are(unsigned number, double to_mm[3][4],
                                            const float *quaternion, float qfac)
{
    struct head head;
    orient(head.to_patient, number);
    for (int side = 0; side < 6; side++) {
        head.bright_axis = side / 2;
        head.bright_at_end = side % 2;
        write_head("head.nii", &head, to_mm ? to_mm : head.to_patient);
        if (quaternion)
            use_qform("head.nii", quaternion, qfac);
        begin_anew();
        must(&interp, "open head.nii; size 100 100; window 2 150; overlay cross=off");
        bright_is("LRPAIS"[side]);
    }
}

STORY(letters_are_right_in_all_48_orientations_of_a_file)
{
    for (unsigned number = 0; number < 48 && check_failures < 10; number++)
        heads_are_bright_where_they_are(number, NULL, NULL, 1);
}

/* A slice has the number of its voxels, in any orientation of the scene. */
STORY(slices_have_the_numbers_of_their_voxels)
{
    for (unsigned number = 0; number < 48 && check_failures < 10; number++) {
        static const char *const plane[] = {"axial", "coronal", "sagittal"};
        struct head head = {.bright_axis = 0};
        char line[64], words[96];
        orient(head.to_patient, number);
        write_head("head.nii", &head, head.to_patient);
        begin_anew();
        must(&interp, "open head.nii");
        for (int p = 0; p < 3; p++) {
            const int axis = slice_axis(interp.session->scene, (enum slice_plane)p);
            uint32_t *cross = interp.session->now.outlook.slices.cross;
            snprintf(line, sizeof line, "slice %s %d", plane[p], 2 + p);
            must(&interp, line);
            CHECK_INT(cross[axis], 2 + p);
            snprintf(words, sizeof words, "%s %d", plane[p], 2 + p);
            CHECK_HAS(buf_text(&reply.text), words);
        }
    }
}

STORY(letters_are_right_where_the_sform_is_rotated)
{
    for (unsigned number = 0; number < 48 && check_failures < 10; number += 5) {
        double to_patient[3][4], to_mm[3][4] = {{0}};
        const double c = cos(0.4), s = sin(0.4); /* 23 degrees about two axes */
        const double turn[3][3] = {{c, -s, 0}, {s * c, c * c, -s}, {s * s, c * s, c}};
        orient(to_patient, number);
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 4; j++)
                for (int k = 0; k < 3; k++)
                    to_mm[i][j] += turn[i][k] * to_patient[k][j];
        heads_are_bright_where_they_are(number, to_mm, NULL, 1);
    }
}

STORY(letters_are_right_under_qforms_and_negative_pixdim)
{
    /* Rotations by quarter turns and halves, and which signed permutation each is. */
    static const struct {
        float quaternion[3], qfac;
        unsigned number;
    } row[] = {
        {{0, 0, 0}, 1, 0},                /* as the world */
        {{0, 0, 0}, -1, 4},               /* z against it */
        {{0, 0, 1}, 1, 3},                /* half a turn about z: x and y against */
        {{0, 0, 1}, -1, 7},               /* and z too */
        {{0, 1, 0}, 1, 5},                /* half a turn about y: x and z */
        {{0, 1, 0}, -1, 1},               /* z back again */
        {{0.70710678f, 0, 0}, 1, 8 + 4},  /* a quarter about x: y to z, z to -y */
        {{0.70710678f, 0, 0}, -1, 8},     /* z to y */
        {{0, 0, 0.70710678f}, 1, 16 + 2}, /* a quarter about z: x to y, y to -x */
        {{0, 0, 0.70710678f}, -1, 16 + 6},
    };
    for (size_t i = 0; i < sizeof row / sizeof row[0] && check_failures < 10; i++) {
        heads_are_bright_where_they_are(row[i].number, NULL, row[i].quaternion, row[i].qfac);
        if (check_failures)
            printf("#   at qform %zu\n", i);
    }
}

/* ---- a scene with real values ---- */

/* Values 0, 1, ... 999 along x, y, z, stored without scaling; real values are slope * i +
 * intercept. */
static void value_row(void *context, uint32_t y, uint32_t z, void *values)
{
    uint16_t *at = values;
    (void)context;
    for (uint32_t x = 0; x < 10; x++)
        *at++ = (uint16_t)(x + 10 * (y + 10 * z));
}

static void write_values(const char *name, float slope, float intercept)
{
    static const uint32_t size[3] = {10, 10, 10};
    const double spacing[3] = {1, 1, 1};
    struct geometry geometry = {.slope = 1, .spacing_nm = {1000000, 1000000, 1000000}};
    geometry_place_plain(&geometry, spacing);
    geometry.orientation = ORIENTATION_FILE;
    CHECK(volume_write(name, FILE_REPLACE,
                       &(struct volume_map){size, &geometry, VOXEL_UINT16, "test", value_row, NULL,
                                            NULL, NULL, NULL},
                       NULL, NULL) == OK);
    patch(name, 112, (const float[]){slope, intercept}, 8);
}

static void begin_values(float slope, float intercept)
{
    write_values("values.nii", slope, intercept);
    begin_anew();
    must(&interp, "open values.nii; size 10 10; overlay none cross=off marks=off words=off");
}
static void begin_plain(void)
{
    begin_values(1, 0);
}
EACH_STORY(begin_plain, NULL)

/* Execute lines, and check the greys of voxels x, y of the axial slice that they show: columns run
 * from the patient's right, rows from A. */
static void must_show(const char *lines, const int (*voxel)[3], size_t count)
{
    must(&interp, lines);
    for (size_t i = 0; i < count; i++) {
        const int *v = voxel[i];
        const int grey = *canvas_pixel(&interp.shown, 9 - (uint32_t)v[0], 9 - (uint32_t)v[1]);
        CHECK_WITH(grey == v[2], "%d, not %d, at %d,%d after %s", grey, v[2], v[0], v[1], lines);
    }
}
#define GREYS(lines, ...)                                                                          \
    do {                                                                                           \
        static const int voxel[][3] = {__VA_ARGS__};                                               \
        must_show(lines, voxel, sizeof voxel / sizeof *voxel);                                     \
    } while (0)

STORY(windows_are_in_real_values)
{
    begin_values(0.5f, -100);
    MUST_MENTION(&interp, "window -75 -50", "window -75 -50,"); /* intensities 50 and 100 */
    GREYS("slice axial 0", {0, 5, 0}, {1, 5, 5}, {5, 7, 128}, {9, 9, 250}); /* 75: 127.5 */
    GREYS("slice axial 1", {0, 0, 255});
    /* A window of less than an intensity is a step. */
    GREYS("window -75 -74.9; slice axial 0", {0, 5, 0}, {1, 5, 255});
    GREYS("window -1000000000 1000000000; slice axial 0", {0, 0, 128}, {9, 9, 128});

    begin_values(-2, 10); /* bright voxels have low intensities: the window is from 100 to 50 */
    GREYS("window -190 -90; slice axial 0", {0, 5, 255}, {9, 9, 5});
    GREYS("slice axial 1", {0, 0, 0});
    MUST_MENTION(&interp, "window auto", "window auto: -1978 -10,");
}

STORY(an_automatic_window_leaves_the_extremes_out)
{
    MUST_MENTION(&interp, "window auto", "window auto: 10 994,");
    GREYS("slice axial 0", {0, 1, 0}, {1, 2, 3}); /* 11 of 984, times 255: 2.85 */
    MUST_MENTION(&interp, "info", "slices    through 5,5,0: axial 0, coronal 5, sagittal 5;");
    must(&interp, "interpolate 2 1 1"); /* another scene, another window */
    CHECK(!interp.session->inside->knows_window);
    MUST_MENTION(&interp, "window auto", "through 10,5,0: axial 0, coronal 5, sagittal 10;");
    begin_values(1e-6f, 0);
    MUST_MENTION(&interp, "window auto", "window auto: 1e-05 0.000994,");
}

/* ---- views ---- */

/* Return true if the top left corner of the present picture contains exactly these words. */
static bool is_titled(const char *words)
{
    const uint32_t tall = notes_tall(200);
    OWNED(canvas_release) struct canvas expected;
    bool same = true;
    CHECK(canvas_init(&expected, 200, 200, 0, NULL) == OK);
    text_draw(&expected, 4, 4, tall, words, &notes_light);
    for (uint32_t y = 4; y < 4 + 2 * text_line(tall); y++)
        for (uint32_t x = 0; x < 90; x++)
            same &= (canvas_pixel(&expected, x, y)[0] == 232) ==
                    (canvas_pixel(&interp.shown, x, y)[0] == 232);
    return same;
}

STORY(titles_say_where_a_scene_is_however_far_that_is)
{
    static const struct {
        float mm;
        const char *axial, *sagittal;
    } row[] = {
        {-7.25f, "axial 5\nI 2.3 mm", "sagittal 5\nL 2.3 mm"},
        {1e6f, "axial 5\nS 1000005.0 mm", "sagittal 5\nR 1000005.0 mm"},
        {-4e18f, "axial 5\nI 4e+18 mm", "sagittal 5\nL 4e+18 mm"},
        {3e38f, "axial 5\nS 3e+38 mm", "sagittal 5\nR 3e+38 mm"},
    };
    for (size_t i = 0; i < sizeof row / sizeof row[0]; i++) {
        write_values("values.nii", 1, 0);
        for (size_t at = 292; at < 340; at += 16) /* the last column of the sform */
            patch("values.nii", at, &row[i].mm, 4);
        begin_anew();
        must(&interp, "open values.nii; size 200 200; window 60000 60001; overlay none "
                      "cross=off marks=off; slice axial 5");
        CHECK(is_titled(row[i].axial));
        must(&interp, "slice sagittal 5");
        CHECK(is_titled(row[i].sagittal));
    }
}

STORY(slices_move_the_cross_hair)
{
    CHECK_INT(interp.session->now.outlook.slices.cross[2], 5); /* the middle */
    must(&interp, "cross 1,2,3; slice axial");
    CHECK(interp.shows_picture && interp.shown.width == 10 && interp.shown.height == 10);
    must(&interp, "window 0 1000");
    CHECK(!interp.shows_picture && !interp.shown.rgba);
    GREYS("slice axial", {4, 0, 78}); /* 304 */
    must(&interp, "slice coronal 7");
    MUST_MENTION(&interp, "slice sagittal 8", "through 8,7,3: axial 3, coronal 7, sagittal 8;");
    CHECK_HAS(buf_text(&reply.words), "picture=");
    must(&interp, "cross 2.2,4,5mm");
    CHECK_TEXT(buf_text(&reply.canonical), "cross 2,4,5");
    refused("slice axial 10", "N: expected one of the axial slices 0..9, not 10");
    CHECK_INT(interp.session->now.outlook.slices.cross[2], 5);
    must(&interp, "render");
    CHECK(interp.shows_picture && !interp.shown.rgba); /* the session's rendition */
}

STORY(a_zoom_stays_until_it_fits_again)
{
    /* The voxel 2,2: 22; its neighbour: 21. */
    GREYS("window 0 1000; cross 2,2,0; slice axial zoom=5", {7, 5, 6}, {3, 3, 6}, {2, 3, 5});
    CHECK_TEXT(buf_text(&reply.canonical), "slice axial zoom=5");
    GREYS("slice axial", {7, 5, 6});
    GREYS("slice axial zoom=fit", {7, 5, 15}); /* 57 */
}

/* Slices and mosaics are magnified alike, until they are whole again. */
STORY(what_is_magnified_stays_so_and_keeps_the_cross_hair_in_sight)
{
    MUST_MENTION(&interp, "window 0 1000; cross 2,2,0; magnify 5", ", magnified 5, overlay ");
    CHECK_TEXT(buf_text(&reply.canonical), "magnify 5");
    CHECK(!interp.shows_picture);
    GREYS("slice axial", {7, 5, 6}, {2, 3, 5}); /* as under zoom=5, for this scene fits at 1 */
    /* As far as 2,2 stays off the edge. */
    MUST_MENTION(&interp, "magnify 5 at=3,4,9", "magnified 5, around 3,4,9, ");
    CHECK_TEXT(buf_text(&reply.canonical), "magnify 5 at=3,4,9");
    /* 2,2,0: 22; 3,3,0; 4,4,0. */
    GREYS("slice axial", {0, 0, 6}, {3, 3, 6}, {4, 4, 8}, {8, 8, 8}, {9, 9, 11});
    must(&interp, "slice axial zoom=5");
    CHECK_INT(interp.session->now.outlook.slices.times, 1000);
    CHECK(!interp.session->now.outlook.slices.has_middle);
    must(&interp, "magnify 1.25 at=1,2,3");
    CHECK_INT(interp.session->now.outlook.slices.zoom, 0);
    must(&interp, "magnify fit");
    CHECK(!interp.session->now.outlook.slices.has_middle);
    GREYS("slice axial", {7, 5, 15});
    refused("magnify 0.5", "TIMES: expected");
    refused("magnify 4096.001", "TIMES: expected");
    refused("magnify 2 at=10,0,0", "10,0,0 is outside the scene");
    refused("magnify fit at=1,1,1", "only for magnified slices");
    refused("magnify 1 at=1,1,1", "only for magnified slices");
}

static bool shows_colour(const struct canvas *s, int r, int g, int b)
{
    for (size_t i = 0; i < (size_t)s->width * s->height; i++)
        if (s->rgba[4 * i] == r && s->rgba[4 * i + 1] == g && s->rgba[4 * i + 2] == b)
            return true;
    return false;
}

static const int dot[3] = {1, 2, 253}, x_red[3] = {255, 72, 56}, rim[3] = {255, 255, 255};

/* Compare the marks in the axial slice after a command, as drawn in the pilot, which runs no edits:
 * a seed's dot, an x, the white rim of pending edits. */
static void marks_are(const char *lines, bool seed, bool eliminator, bool waiting)
{
    OWNED(canvas_release) struct canvas canvas = {0};
    must(&interp, lines);
    CHECK(slicing_draw(&canvas, interp.session, SLICE_KIND_AXIAL, NULL, false, &fault) == OK);
    CHECK(shows_colour(&canvas, dot[0], dot[1], dot[2]) == seed);
    CHECK(shows_colour(&canvas, x_red[0], x_red[1], x_red[2]) == eliminator);
    CHECK(shows_colour(&canvas, rim[0], rim[1], rim[2]) == waiting);
}

STORY(what_waits_and_what_was_eliminated_is_marked)
{
    marks_are("size 60 60; window 0 100000; label 3 thing #0102fd; overlay marks=on; cross 0,0,4",
              false, false, false);
    marks_are("seed 3,3,4 3", true, false, true);
    marks_are("run", true, false, false);
    marks_are("remove 7,7,4", true, true, true);
    marks_are("run", false, true, false);
    marks_are("run", false, true, false); /* nothing waits: the last run is still that one */
    marks_are("cross 0,0,5", false, false, false); /* marks are in their own slice */
    marks_are("cross 0,0,4; auto on; seed 2,2,4 3", true, false, false);
    marks_are("remove 5,5,4 radius=2", false, true, false);
    marks_are("overlay marks=off", false, false, false);
    must(&interp,
         "overlay marks=on; interpolate 2 2 1"); /* marks of the former scene are removed */
    CHECK_INT(edits_count(&interp.session->now.lists.eliminators), 0);
    marks_are("cross 0,0,4", false, false, false);
}

STORY(hidden_labels_are_not_overlaid)
{
    must(&interp, "label 3 thing #ff0000; seed 3,3,4 3; run; slice axial 4");
    const uint64_t plain = canvas_digest(&interp.shown);
    must(&interp, "overlay tint; slice axial");
    CHECK(canvas_digest(&interp.shown) != plain);
    must(&interp, "hide 3; slice axial");
    CHECK(canvas_digest(&interp.shown) == plain);
}

STORY(mosaics_have_the_size_of_the_view)
{
    static const char *const sizes[] = {"size 16 16", "size 17 300", "size 129 128", "size 333 57"};
    must(&interp, "overlay tint cross=on marks=on words=on; seed 3,3,4 3");
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        must(&interp, sizes[i]);
        must(&interp, "mosaic");
        CHECK(interp.shown.width == interp.session->now.outlook.view.width);
        CHECK(interp.shown.height == interp.session->now.outlook.view.height);
    }
    must(&interp, "size 1 1");
    refused("mosaic",
            "a mosaic needs 16x16 pixels or more, and the view has 1x1; enlarge it with `size`");
    must(&interp, "slice axial");
    CHECK(interp.shown.width == 1);
    must(&interp, "size 15 400");
    refused("mosaic", "the view has 15x400");
    refused("golden small of=mosaic", "the view has 15x400");
}

/* Execute lines. Return the panel's zoom in pixels of the view, which a large pane has more of for
 * the same. */
static uint32_t zoom_after(const char *lines)
{
    must(&interp, lines);
    struct slicing_panel panel = {.screen = {640, 640, 8, 16, true, MOSAIC_AXIAL}};
    OWNED(canvas_release) struct canvas canvas = {0};
    CHECK(slicing_draw_panel(&canvas, interp.session, &panel, &fault) == OK);
    const struct view *shown = &interp.session->pictures->camera.view;
    const uint32_t width = interp.session->now.outlook.view.width;
    return (shown->zoom * width + shown->width - 1) / shown->width;
}

/* A zoom of its own changes nothing that is recorded. */
STORY(a_panel_fits_the_rendition_in_until_somebody_chooses_a_zoom)
{
    const uint32_t fitting = view_fitting_zoom(interp.session->scene, 100, 100, 1);
    CHECK(fitting > VIEW_ZOOM_ONE);
    must(&interp, "size 100 100; seed 3,3,4 3; render");
    const uint64_t rendered = rendition_digest(session_frame(interp.session));
    CHECK_INT(zoom_after(""), fitting);
    CHECK(rendition_digest(session_frame(interp.session)) != rendered);
    CHECK_INT(interp.session->now.outlook.view.zoom, VIEW_ZOOM_ONE);
    must(&interp, "pick 50 50"); /* a pixel of the view, not of the panel */
    CHECK(rendition_digest(session_frame(interp.session)) == rendered);
    CHECK_INT(zoom_after(""), fitting);
    CHECK_INT(zoom_after("turn 20"), fitting); /* looks from elsewhere, and as near */
    must(&interp, "turn -20; mosaic; render");
    CHECK(rendition_digest(session_frame(interp.session)) == rendered);
    CHECK_INT(zoom_after("zoom 2"), 2 * VIEW_ZOOM_ONE);
    CHECK_INT(zoom_after("zoom 1"), fitting);
}

/* If the pane has more pixels than the view in both directions, the rendition has as many. */
STORY(a_large_pane_has_a_rendition_of_as_many_pixels)
{
    static const struct row {
        uint32_t width, height, shown_width, shown_height;
    } table[] = {{320, 320, 320, 320}, {100, 100, 320, 320}, {300, 150, 320, 160},
                 {150, 300, 160, 320}, {512, 100, 512, 100}, {100, 400, 100, 400}};
    struct slicing_panel panel = {.screen = {320, 320, 8, 16, false, MOSAIC_RENDITION}};
    must(&interp, "seed 3,3,4 3");
    for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
        const struct row *row = &table[i];
        char line[32];
        OWNED(canvas_release) struct canvas canvas = {0};
        snprintf(line, sizeof line, "size %u %u", row->width, row->height);
        must(&interp, line);
        CHECK(slicing_draw_panel(&canvas, interp.session, &panel, &fault) == OK);
        CHECK_INT(session_frame(interp.session)->width, row->shown_width);
        CHECK_INT(session_frame(interp.session)->height, row->shown_height);
    }
}

static bool same_canvas(const struct canvas *a, const struct canvas *b)
{
    const size_t pixels = (size_t)a->width * a->height;
    return a->width == b->width && a->height == b->height &&
           memcmp(a->rgba, b->rgba, 4 * pixels) == 0 &&
           memcmp(a->cell, b->cell, pixels * sizeof *a->cell) == 0 &&
           memcmp(a->words, b->words, pixels) == 0 && memcmp(a->below, b->below, pixels) == 0;
}

/* Panels of two layouts; the second one reuses the memory of the first. */
STORY(a_panel_has_nothing_of_the_one_before)
{
    struct slicing_panel before = {.screen = {320, 320, 8, 16, true, MOSAIC_AXIAL}, .words = true};
    struct slicing_panel after = {.screen = {320, 320, 8, 16, false, MOSAIC_AXIAL}};
    struct canvas again = {0}, anew = {0};
    must(&interp, "seed 3,3,4 3");
    CHECK(slicing_draw_panel(&again, interp.session, &before, &fault) == OK);
    const uint8_t *memory = again.rgba;
    CHECK(slicing_draw_panel(&again, interp.session, &after, &fault) == OK && again.rgba == memory);
    CHECK(slicing_draw_panel(&anew, interp.session, &after, &fault) == OK);
    CHECK(same_canvas(&again, &anew));
    memset(again.rgba, 1, (size_t)4 * 320 * 320);
    memset(again.words, 1, (size_t)320 * 320);
    memset(again.below, 1, (size_t)320 * 320);
    CHECK(canvas_renew(&again, 320, 320, &fault) == OK);
    canvas_release(&anew);
    CHECK(canvas_renew(&anew, 320, 320, &fault) == OK);
    CHECK(again.rgba == memory && same_canvas(&again, &anew));
    after.screen.width = 8;
    CHECK(slicing_draw_panel(&again, interp.session, &after, &fault) == ERR_LIMIT && !again.rgba);
    canvas_release(&anew);
}

/* The label in the middle of the panel's rendition. */
static int shown_in_middle(void)
{
    const struct rendition *frame = session_frame(interp.session);
    const uint32_t cell = frame->cell[frame->height / 2 * frame->width + frame->width / 2];
    return cell == CELL_NONE ? 0 : interp.session->scene->cell[cell].label;
}

/* Without a chosen zoom a panel shows the visible labels as large as they fit. */
STORY(a_panel_follows_what_is_shown)
{
    const struct scene *scene = interp.session->scene;
    const uint32_t fitting = view_fitting_zoom(scene, 100, 100, 1);
    const uint32_t *n = scene->grid.size, middle[3] = {n[0] / 2, n[1] / 2, n[2] / 2};
    char line[96];
    CHECK_INT(zoom_after("size 100 100; auto on; seed 0,0,0 0"), fitting); /* nothing is shown */
    snprintf(line, sizeof line, "seed %u,%u,%u 3 within=1", middle[0], middle[1], middle[2]);
    const uint32_t near = zoom_after(line);
    CHECK(near > fitting + fitting / 4);
    CHECK_INT(zoom_after("turn 30"), near);
    const uint32_t far = zoom_after("seed 1,1,1 2 within=1");
    CHECK(far < near);
    CHECK_INT(zoom_after("hide 2"), near);
    CHECK_INT(zoom_after("show 2"), far);
    /* A label in a corner moves to the middle, as large as elsewhere. */
    CHECK(zoom_after("hide 3") > far + far / 4);
    CHECK_INT(shown_in_middle(), 2);
    const struct view *view = &interp.session->now.outlook.view;
    CHECK_INT(view->zoom, VIEW_ZOOM_ONE);
    CHECK_INT(view->focus[0] | view->focus[1] | view->focus[2], 0);
    zoom_after("focus 1,1,1; show 3"); /* chosen: it stays there, as large as it was */
    CHECK_INT(shown_in_middle(), 2);
}

enum { AT_ONCE_NS = 50000000 };

/* Draws a panel, and says whether it did so in a hurry. */
static bool is_hasty(uint64_t within_ns, struct slicing_panel *panel, struct canvas *canvas)
{
    *panel = (struct slicing_panel){.screen = {640, 640, 8, 16, true, MOSAIC_AXIAL},
                                    .within_ns = within_ns};
    CHECK(slicing_draw_panel(canvas, interp.session, panel, &fault) == OK);
    return panel->is_hasty;
}

static void draw_during_a_command(void *context)
{
    struct slicing_panel panel;
    CHECK(is_hasty(0, &panel, context));
}

/* Count the pixels that differ in the rendition's pane, or in the other panes. */
static size_t differing(const struct canvas *a, const struct canvas *b,
                        const struct slicing_panel *panel, bool of_rendition)
{
    const struct mosaic_box *box = &panel->layout.box[MOSAIC_RENDITION];
    size_t count = 0;
    for (uint32_t y = 0; y < a->height; y++)
        for (uint32_t x = 0; x < a->width; x++) {
            const bool is_in = x - box->left < box->width && y - box->top < box->height;
            const size_t at = 4 * (y * a->stride + x);
            count += is_in == of_rendition && memcmp(a->rgba + at, b->rgba + at, 4) != 0;
        }
    return count;
}

/* In a hurry slices do not wait for a surface that has to be made, and an existing one is drawn in
 * coarse pixels if drawing it takes long; the next picture is the same as without hurry. */
STORY(in_a_hurry_slices_come_first_and_then_a_coarse_rendition)
{
    struct slicing_panel panel;
    OWNED(canvas_release) struct canvas hasty = {0}, fine = {0}, turned = {0}, during = {0};
    must(&interp, "seed 3,3,4 3; run");
    CHECK(is_hasty(AT_ONCE_NS, &panel, &hasty) && !is_hasty(0, &panel, &fine));
    CHECK_INT(differing(&hasty, &fine, &panel, false), 0);
    CHECK(differing(&hasty, &fine, &panel, true) > 1000);
    CHECK(!is_hasty(AT_ONCE_NS, &panel, &hasty)); /* it is there */
    CHECK_INT(differing(&hasty, &fine, &panel, true), 0);
    must(&interp, "seed 7,7,7 4 radius=3; run"); /* much changes: the former rendition stays */
    CHECK(is_hasty(AT_ONCE_NS, &panel, &hasty));
    CHECK_INT(differing(&hasty, &fine, &panel, true), 0);
    must(&interp, "undo");
    CHECK(!is_hasty(0, &panel, &hasty));
    CHECK_INT(differing(&hasty, &fine, &panel, true), 0);
    must(&interp, "turn 20");
    interp.session->pictures->coarse.took_ns = UINT64_MAX;
    CHECK(is_hasty(AT_ONCE_NS, &panel, &hasty));
    CHECK(!session_rendered(interp.session)); /* nothing but a screen shows it */
    session_show(interp.session, draw_during_a_command, &during); /* the same */
    CHECK_INT(differing(&hasty, &during, &panel, true), 0);
    CHECK(!is_hasty(0, &panel, &turned));
    const size_t off = differing(&hasty, &turned, &panel, true);
    /* Edges alone are off: half of the pixels of so small a thing. At another zoom, or in another
     * place, three fifths of them and more. */
    CHECK(off > 0 && off < differing(&fine, &turned, &panel, true) * 11 / 20);
    must(&interp, "turn -20");
    interp.session->pictures->coarse.took_ns = AT_ONCE_NS / 2;
    CHECK(is_hasty(AT_ONCE_NS / 2, &panel, &turned));
    CHECK(!is_hasty(AT_ONCE_NS, &panel, &hasty)); /* drawn as soon as anything coarser */
    CHECK_INT(differing(&hasty, &fine, &panel, true), 0);
}

/* Slices near the cross-hair that are sent ahead to a terminal: one name stands for one picture,
 * whatever was chosen meanwhile, and a slice seen again has the same name. */
STORY(a_name_of_a_slice_stands_for_its_pixels)
{
    static const char *const lines[] = {"cross 4,4,4",        "cross 5,4,4", "window 10 60",
                                        "cross 4,4,4",        "magnify 2",   "cross 4,5,4",
                                        "window auto",        "magnify 1",   "size 90 90",
                                        "magnify 3 at=2,2,2", "cross 4,4,4", "magnify 1"};
    enum { LINES = sizeof lines / sizeof lines[0], NUMBERS = 12 };
    uint64_t name[LINES * NUMBERS], pixels[LINES * NUMBERS];
    size_t count = 0, again = 0;
    OWNED(panes_release) struct panes panes = {.notes = 0};
    for (size_t l = 0; l < LINES; l++) {
        static const struct buf no_words[PANES_LINES];
        const struct pilot_wish wish = {
            .width = 320, .height = 320, .cell_width = 8, .cell_height = 16};
        must(&interp, lines[l]);
        CHECK(panes_draw(&panes, interp.session, &wish, no_words, &fault) == OK);
        for (unsigned i = 0; i < NUMBERS; i++) {
            const uint64_t new = panes_name_beyond(&panes, interp.session, PILOT_AXIAL, i);
            uint64_t sum = 0;
            CHECK_INT(panes_draw_beyond(&panes, interp.session, PILOT_AXIAL, i), new != 0);
            const struct canvas *c = &panes.beyond;
            for (size_t k = 0; new &&k < (size_t)c->width * c->height; k++)
                sum += hash_mix_at(k, c->below[k]);
            for (size_t k = 0; new &&k < count; k++) {
                CHECK(name[k] != new || pixels[k] == sum);
                again += name[k] == new;
            }
            name[count] = new;
            pixels[count] = sum;
            count += new != 0;
        }
    }
    CHECK(count > 100 && again > 20);
}

/* A scene of 10 voxels a side is shown as large as possible. */
STORY(slices_of_a_small_scene_fill_their_panes)
{
    struct slicing_panel panel = {.screen = {1600, 1000, 8, 16, true, MOSAIC_AXIAL}};
    OWNED(canvas_release) struct canvas canvas = {0};
    CHECK(slicing_draw_panel(&canvas, interp.session, &panel, &fault) == OK);
    for (int pane = MOSAIC_AXIAL; pane <= MOSAIC_SAGITTAL; pane++) {
        const struct mosaic_box *box = &panel.layout.box[pane];
        const size_t side = box->width < box->height ? box->width : box->height;
        size_t shown = 0;
        for (uint32_t y = 0; y < box->height; y++)
            for (uint32_t x = 0; x < box->width; x++)
                shown += canvas.cell[(box->top + y) * canvas.stride + box->left + x] != CELL_NONE;
        CHECK(side > 300 && shown * 10 > side * side * 9);
    }
}

STORY(without_memory_nothing_is_shown)
{
    must(&interp, "seed 3,3,4 3; size 50 50; overlay marks=on");
    for (unsigned left = 0; left < 200; left++) {
        allow_allocations(left);
        const enum err err = execute(&interp, "mosaic");
        mem_allows = NULL;
        if (!err)
            break;
        CHECK_INT(err, ERR_MEMORY);
        CHECK(!interp.shown.rgba && !interp.shows_picture);
    }
    CHECK(interp.shown.rgba);
}

/* ---- voxels under pixels ---- */

static void picks(const char *line, const char *words)
{
    MUST_MENTION(&interp, line, words);
}

STORY(a_pixel_of_a_slice_tells_its_voxel)
{
    must(&interp, "seed 3,3,4 3; cross 1,2,3");
    picks("pick 0 0 of=axial", "voxel 9,9,3 at 9.0,9.0,3.0 mm: intensity 399,");
    picks("pick 9 9 of=axial", "voxel 0,0,3 ");
    CHECK_HAS(buf_text(&reply.text), "no seed reaches it\n");
    picks("pick 9 0 of=coronal", "voxel 0,2,9 ");
    picks("pick 0 9 of=sagittal", "voxel 1,9,0 ");
    CHECK_INT(session_pendings(interp.session), 1); /* asking runs nothing */
    picks("run; pick 9 9 of=axial", "on the border of label 3\n");
    picks("slice axial zoom=5; pick 9 9 of=axial", "voxel 0,1,3 "); /* 2x2 voxels around 1,2 */
    picks("slice axial zoom=fit; size 22 20; pick 0 0 of=axial", "pixel 0,0 shows no voxel\n");
    picks("pick 1 0 of=axial", "voxel 9,9,3 ");
    refused("pick 22 0 of=axial", "pixel 22,0 is outside the picture of 22x20");
    refused("pick 0 20 of=mosaic", "pixel 0,20 is outside the picture of 22x20");
    refused("pick 0 0 of=oblique", "of: expected rendition|axial|coronal|sagittal|mosaic");
    /* Panes of 10x9, 11x9 and 10x10 pixels and a seam of one; nine pixels for ten voxels. */
    picks("pick 8 8 of=mosaic", "voxel 1,2,0 ");
    picks("pick 9 8 of=mosaic", "shows no voxel");
    picks("pick 10 8 of=mosaic", "shows no voxel");
    picks("pick 12 8 of=mosaic", "voxel 1,9,0 ");
    picks("pick 1 18 of=mosaic", "voxel 8,1,3 ");
    picks("view front; zoom 1; pick 16 14 of=mosaic", "voxel 5,9,6 "); /* the object's front */
    must(&interp, "size 8 8");
    refused("pick 0 0 of=mosaic", "a mosaic needs 16x16 pixels or more");
    picks("render; pick 4 4 of=rendition", "voxel ");
}

/* For every pixel of slices and mosaics, at any magnification. */
STORY(each_pixel_tells_the_voxel_that_it_was_drawn_of)
{
    static const char *const how[] = {"magnify fit", "magnify 1.7 at=0,9,4", "magnify 3",
                                      "magnify 12.5 at=8,1,1", "slice axial zoom=7"};
    must(&interp, "cross 7,3,2; size 60 45");
    for (size_t i = 0; i < sizeof how / sizeof how[0]; i++) {
        must(&interp, how[i]);
        for (int kind = 0; kind <= SLICE_KIND_MOSAIC; kind++) {
            OWNED(canvas_release) struct canvas canvas;
            uint32_t wrong = 0, cell = 0;
            CHECK(slicing_draw(&canvas, interp.session, (enum slice_kind)kind, NULL, true,
                               &fault) == OK);
            for (uint32_t p = 0; p < 60 * 45; p++)
                wrong += slicing_cell_at(&cell, interp.session, (enum slice_kind)kind, NULL, p % 60,
                                         p / 60, &fault) != OK ||
                         cell != canvas.cell[p];
            CHECK_INT(wrong, 0);
        }
    }
    picks("magnify 12.5; pick 30 22 of=axial", "voxel 7,3,2 "); /* the cross-hair in the middle */
    picks("pick 14 10 of=mosaic", "voxel 7,");
}

/* ---- files and journals ---- */

STORY(an_exr_of_a_slice_holds_labels_and_voxels)
{
    struct picture picture;
    must(&interp, "seed 3,3,4 3; run; size 12 10");
    MUST_MENTION(&interp, "slice axial 4 slice.exr", "wrote slice.exr");
    refused("slice axial 4 slice.exr", "exists");
    must(&interp, "slice axial 4 slice.exr replace=yes");
    if (CHECK(exr_read(&picture, "slice.exr", &fault) == OK)) {
        CHECK(picture.width == 12 && picture.height == 10 && !picture.depth_mm);
        CHECK(picture.label && picture.label[1] == 3 && picture.label[0] == 0);
        CHECK_INT(picture.voxel[0], CELL_NONE);
        CHECK_INT(picture.voxel[1], 9 + 90 + 400); /* right, anterior */
        CHECK_INT(picture.voxel[9 * 12 + 10], 400);
        CHECK_TEXT(picture_find(&picture, "iftty:slice"), "axial through 5,5,4");
        CHECK(picture_find(&picture, "iftty:scene") != NULL);
        picture_release(&picture);
    }
    must(&interp, "size 40 40; mosaic mosaic.png");
    CHECK(file_exists("mosaic.png"));
}

static void say_nothing(void *context, const char *text)
{
    struct buf *kept = context;
    buf_add_text(kept, text);
}

/* Carry the journal out again: every picture must be the same, or the message must contain these
 * words. */
static void replay(const char *path, const char *words)
{
    static const struct golden_judge strict_judge = {.differs = NULL};
    OWNED(buf_release) struct buf told = {0};
    const struct printer printer = {&told, say_nothing, say_nothing, NULL, NULL};
    begin_anew();
    interp.judge = &strict_judge;
    fault = (struct fault){.text = ""};
    const enum err err = replay_aloud(&interp, path, &printer, &fault);
    if (!words && !CHECK(err == OK))
        printf("#   %s\n", fault.text);
    buf_add_text(&told, fault.text);
    if (words) {
        CHECK(err != OK);
        CHECK_HAS(buf_text(&told), words);
    }
}

STORY(golden_slices_are_compared_when_replayed)
{
    struct picture picture;
    write_values("values.nii", 1, 0);
    begin_anew();
    CHECK(interpreter_create_journal(&interp, "slices.iftty", &fault) == OK);
    must(&interp,
         "open values.nii; size 40 40; label 3 thing #ff8000; seed 3,3,4 3; seed 9,9,9 0; run; "
         "seed 1,1,4 3; remove 3,3,3; window 100 600; golden axial of=axial; golden coronal "
         "of=coronal; golden sagittal of=sagittal; golden mosaic of=mosaic; slice axial 4; "
         "golden rendition of=rendition; slice coronal 3 zoom=7; overlay tint cross=off; "
         "golden near of=coronal; mosaic");
    interpreter_release(&interp);
    replay("slices.iftty", NULL);
    CHECK(file_exists("slices.golden/near.png"));
    if (CHECK(exr_read(&picture, "slices.golden/mosaic.exr", &fault) == OK)) {
        CHECK(picture.label && picture.voxel && !picture.depth_mm);
        picture.rgba[4 * 5] ^= 1;
        CHECK(image_write(NULL, "slices.golden/mosaic.exr", FILE_REPLACE, &picture, &fault) == OK);
        picture_release(&picture);
        replay("slices.iftty",
               "golden image mosaic: 1 of 1600 pixels differ, first column 5, row 0");
    }
    CHECK(unlink("slices.golden/mosaic.exr") == 0);
    replay("slices.iftty", "golden image mosaic is missing");
}

int main(void)
{
    if (!make_folder(folder, "slicing") || chdir(folder) != 0)
        return 1;
    int status = check_run();
    interpreter_release(&interp);
    reply_release(&reply);
    return status | remove_folder(folder);
}
