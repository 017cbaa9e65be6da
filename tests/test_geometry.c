/* SPDX-License-Identifier: MIT */
/* The place of a scene by its file, for any sform, qform and pixdim, alone and together. */
#include <math.h>

#include "image/image_inside.h"
#include "image/regrid.h"
#include "tests/check_main.h"

static const uint32_t size[3] = {24, 20, 16};

static struct nifti_header header;
static struct geometry geometry;
static char notes[VOLUME_NOTES_BYTES];

/* ---- headers ---- */

/* Voxels of 1 x 1.5 x 2 mm that say no more. */
static void begin(void)
{
    header = (struct nifti_header){.bytes = NIFTI_LEAST_BYTES,
                                   .dim = {3, 24, 20, 16},
                                   .fields = {.pixdim = {1, 1, 1.5, 2}, .xyzt_units = 2}};
}
EACH_STORY(begin, NULL)

/* An sform whose axes run towards these letters, moved by so much. */
static void put_sform(const char *letters, double moved_mm)
{
    struct geometry g = {.slope = 1};
    geometry_place_plain(&g, header.fields.pixdim + 1);
    CHECK(geometry_orient(&g, letters));
    memcpy(header.fields.srow, g.to_mm, sizeof g.to_mm);
    for (int w = 0; w < 3; w++)
        header.fields.srow[w][3] = moved_mm + w;
    header.fields.sform_code = 1;
}

/* The same as a qform, by the way of the writer. */
static void put_qform(const char *letters, double moved_mm)
{
    struct nifti_header other = header;
    struct geometry g = {.slope = 1, .spacing_nm = {1000000, 1500000, 2000000}};
    geometry_place_plain(&g, header.fields.pixdim + 1);
    CHECK(geometry_orient(&g, letters));
    g.orientation = ORIENTATION_FILE;
    nifti_header_place(&other, &g);
    memcpy(header.fields.quatern, other.fields.quatern, sizeof header.fields.quatern);
    header.fields.pixdim[0] = other.fields.pixdim[0];
    for (int w = 0; w < 3; w++)
        header.fields.qoffset[w] = moved_mm + w;
    header.fields.qform_code = 2;
}

static void read_it(void)
{
    notes[0] = '\0';
    nifti_header_geometry(&geometry, notes, &header, size);
}

static bool runs_towards(const char *letters)
{
    char is[4];
    geometry_axes(is, &geometry);
    return strcmp(is, letters) == 0;
}

/* The 48 ways in which axes can run. */
static const char *towards(unsigned number)
{
    static const uint8_t order[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2},
                                        {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    static const char sides[3][3] = {"RL", "AP", "SI"};
    static char letters[4];
    for (unsigned a = 0; a < 3; a++)
        letters[a] = sides[order[number / 8][a]][number >> a & 1];
    return letters;
}

/* ---- known places ---- */

STORY(nothing_is_known_without_codes)
{
    put_sform("LPS", 0); /* without a code */
    put_qform("LPS", 0);
    header.fields.sform_code = header.fields.qform_code = 0;
    read_it();
    CHECK_INT(geometry.orientation, ORIENTATION_UNKNOWN);
    CHECK(!geometry.spacing_unknown && !geometry_has_place(&geometry));
    CHECK_INT(geometry.spacing_nm[1], 1500000);
    CHECK_HAS(notes, "its orientation in the patient is unknown");
    CHECK_HAS(notes, "`orient RAS`");
}

STORY(either_form_alone_says_all_48_ways)
{
    for (unsigned i = 0; i < 48; i++)
        for (int by_q = 0; by_q < 2; by_q++) {
            const char *letters = towards(i);
            begin();
            (by_q ? put_qform : put_sform)(letters, 5);
            read_it();
            CHECK_INT(geometry.orientation, by_q ? ORIENTATION_QFORM : ORIENTATION_SFORM);
            CHECK(runs_towards(letters) && geometry_has_place(&geometry));
            CHECK(geometry.to_mm[1][3] == 6);
            CHECK_TEXT(notes, "");
        }
}

STORY(both_agree_or_contradict_each_other_in_all_48_by_48_ways)
{
    for (unsigned i = 0; i < 48 * 48; i++) {
        char by_s[4];
        memcpy(by_s, towards(i / 48), sizeof by_s);
        const bool agree = i / 48 == i % 48;
        begin();
        put_sform(by_s, 0);
        put_qform(towards(i % 48), 0);
        read_it();
        CHECK_INT(geometry.orientation, agree ? ORIENTATION_SFORM : ORIENTATION_UNKNOWN);
        CHECK(agree == (*notes == '\0'));
        CHECK(agree || strstr(notes, "`orient sform` or `orient qform` decides"));
        for (int by_q = 0; by_q < 2; by_q++) {
            CHECK(geometry_orient(&geometry, by_q ? "qform" : "sform"));
            CHECK(runs_towards(by_q ? towards(i % 48) : by_s) && geometry_has_place(&geometry));
        }
    }
}

STORY(the_sform_holds_where_the_qform_lies_elsewhere)
{
    put_sform("LAS", 3);
    put_qform("LAS", 3.25); /* 0.43 mm: less than half a voxel */
    read_it();
    CHECK_TEXT(notes, "");
    put_qform("LAS", 33);
    read_it();
    CHECK_INT(geometry.orientation, ORIENTATION_SFORM);
    CHECK(geometry.to_mm[0][3] == 3);
    CHECK_HAS(notes, "its sform and its qform differ by up to 52 mm: the sform is used\n");
}

/* Around 45 degrees, single precision decides which axis is nearest. */
STORY(what_is_rounded_does_not_contradict)
{
    const double half = sqrt(0.5);
    for (int i = -3; i <= 3; i++) {
        const double angle = acos(-1) / 4 + i * 1e-7;
        const double turned[3][4] = {{cos(angle), -1.5 * sin(angle), 0, 0},
                                     {sin(angle), 1.5 * cos(angle), 0, 0},
                                     {0, 0, 2, 0}};
        begin();
        memcpy(header.fields.srow, turned, sizeof turned);
        header.fields.sform_code = 1;
        header.fields.quatern[2] = (double)(float)sqrt((1 - half) / 2);
        header.fields.qform_code = 1;
        read_it();
        CHECK_INT(geometry.orientation, ORIENTATION_SFORM);
        CHECK_TEXT(notes, "");
    }
}

/* ---- numbers that make no sense ---- */

STORY(a_form_that_cannot_be_used_is_said_and_the_other_holds)
{
    static const double bad[] = {NAN, INFINITY, -INFINITY, 0};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
        for (int with = 0; with < 2; with++) {
            begin();
            put_sform("RAS", 0);
            if (with)
                put_qform("LPS", 0);
            header.fields.srow[1][1] = bad[i];
            read_it();
            CHECK_HAS(notes, "its sform (code 1) is no number, or cannot be inverted");
            CHECK_INT(geometry.orientation, with ? ORIENTATION_QFORM : ORIENTATION_UNKNOWN);
            CHECK_INT(geometry.sform.code, 0);
            CHECK(!geometry_orient(&geometry, "sform"));
            begin();
            put_qform("LPS", 0);
            if (with)
                put_sform("RAS", 0);
            (i % 2 ? header.fields.qoffset : header.fields.quatern)[1] = bad[i] == 0 ? NAN : bad[i];
            read_it();
            CHECK_HAS(notes, "its qform (code 2) is no number, or cannot be inverted");
            CHECK_INT(geometry.orientation, with ? ORIENTATION_SFORM : ORIENTATION_UNKNOWN);
        }
}

STORY(a_distance_that_is_none_is_unknown_or_the_sforms)
{
    static const double bad[] = {NAN, INFINITY, -INFINITY, 0, -1.5, 1e-9, 5000};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
        for (int a = 1; a <= 3; a++) {
            begin();
            header.fields.pixdim[a] = bad[i];
            read_it();
            CHECK(geometry.spacing_unknown && !geometry_has_place(&geometry));
            CHECK_INT(geometry.spacing_nm[0] + geometry.spacing_nm[1] + geometry.spacing_nm[2],
                      3000000);
            CHECK_HAS(notes, ", which is no distance of voxels\n");
            begin();
            put_sform("RAS", 0);
            header.fields.pixdim[a] = bad[i];
            read_it();
            CHECK(!geometry.spacing_unknown && geometry_has_place(&geometry));
            CHECK_INT(geometry.spacing_nm[0] + geometry.spacing_nm[1] + geometry.spacing_nm[2],
                      4500000);
            CHECK_HAS(notes, "the distances of voxels are those of its sform\n");
        }
}

STORY(lengths_are_by_pixdim_where_the_sform_is_a_templates)
{
    put_sform("RAS", 0);
    header.fields.pixdim[3] = 1.9;
    read_it();
    CHECK_INT(geometry.spacing_nm[2], 1900000);
    CHECK_HAS(notes, "its sform has voxels of 1x1.5x2 mm: lengths are by pixdim");
}

STORY(shear_is_measured)
{
    put_sform("RAS", 0);
    read_it();
    CHECK(geometry_shear(&geometry) < 1e-6);
    header.fields.srow[0][2] = 2; /* z leans over by 45 degrees */
    read_it();
    CHECK(fabs(geometry_shear(&geometry) - 45) < 1e-6);
}

STORY(a_tilt_is_the_angle_of_an_axis_and_the_side_that_names_it)
{
    for (unsigned i = 0; i < 48; i++) {
        begin();
        put_sform(towards(i), 0);
        read_it();
        CHECK(geometry_tilt(&geometry) < 1e-6);
    }
    begin();
    put_sform("RAS", 0);
    header.fields.srow[0][0] = header.fields.srow[1][1] =
        cos(acos(-1) / 6); /* 30 degrees about z */
    header.fields.srow[1][0] = 0.5;
    header.fields.srow[0][1] = -0.5;
    read_it();
    CHECK(fabs(geometry_tilt(&geometry) - 30) < 1e-6);
    geometry.orientation = ORIENTATION_UNKNOWN;
    CHECK(geometry_tilt(&geometry) < 1e-6);
}

/* ---- orient ---- */

STORY(letters_tell_axes_and_no_place)
{
    static const char *const wrong[] = {"",    "R",   "RA",   "RAR",     "RLS",  "RASI",
                                        "XYZ", "R S", "R\tS", "unknown", "file", "told"};
    for (unsigned i = 0; i < 48; i++) {
        begin();
        read_it();
        CHECK(geometry_orient(&geometry, towards(i)) && runs_towards(towards(i)));
        CHECK_INT(geometry.orientation, ORIENTATION_TOLD);
        CHECK(!geometry_has_place(&geometry) && geometry_step_mm(&geometry, 1) == 1.5);
    }
    CHECK(geometry_orient(&geometry, "lpi") && runs_towards("LPI"));
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        const struct geometry before = geometry;
        CHECK(!geometry_orient(&geometry, wrong[i]));
        CHECK(memcmp(&before, &geometry, sizeof before) == 0);
    }
}

/* ---- grids within grids ---- */

STORY(a_derived_grid_lies_where_its_voxels_did)
{
    static const double first[3] = {3, 0, 2}, step[3] = {2, 1, 0.5};
    static const uint32_t from[3] = {7, 5, 3}, is[3] = {2, 5, 2};
    for (unsigned i = 0; i < 48; i++) {
        double before[3], after[3];
        begin();
        put_sform(towards(i), 7);
        put_qform(towards(i), 7);
        read_it();
        geometry_point(&geometry, from, before);
        CHECK(geometry_derive(&geometry, first, step));
        for (int way = 0; way < 3; way++) {
            if (way > 0)
                CHECK(geometry_orient(&geometry, way == 1 ? "qform" : "sform"));
            geometry_point(&geometry, is, after);
            for (int w = 0; w < 3; w++)
                CHECK(fabs(before[w] - after[w]) < 1e-6);
        }
        CHECK_INT(geometry.spacing_nm[0], 2000000);
        CHECK_INT(geometry.spacing_nm[2], 1000000);
    }
}

STORY(a_derived_grid_has_spacing_that_can_be_told)
{
    static const double first[3] = {0, 0, 0}, one[3] = {1, 1, 1}, two[3] = {1, 1, 2};
    put_sform(towards(0), 7);
    read_it();
    geometry.spacing_nm[0] = 1;
    geometry.spacing_nm[2] = 2500000000;
    const struct geometry before = geometry;
    CHECK(!geometry_derive(&geometry, first, two));
    CHECK(memcmp(&before, &geometry, sizeof before) == 0 && geometry_derive(&geometry, first, one));
    CHECK(geometry_derive(&geometry, first, (const double[3]){0.5, 1, 1.6}));
    CHECK_INT(geometry.spacing_nm[0], 1);
    CHECK_INT(geometry.spacing_nm[2], 4000000000);
}

/* ---- maps on the scene's grid ---- */

static struct fault fault;

/* A map of other voxels, whose values are their places: x + 100 y + 10000 z (mod 2^16), less 7 in
 * intensities. */
static struct volume map_of(const uint32_t is[3], const struct geometry *place)
{
    struct volume map = {.size = {is[0], is[1], is[2]}, .geometry = *place};
    size_t n = 0;
    map.geometry.slope = 1;
    map.geometry.intercept = -7;
    map.intensity = mem_array((size_t)is[0] * is[1] * is[2], sizeof *map.intensity);
    for (uint32_t z = 0; z < is[2]; z++)
        for (uint32_t y = 0; y < is[1]; y++)
            for (uint32_t x = 0; x < is[0]; x++)
                map.intensity[n++] = (uint16_t)(x + 100 * y + 10000 * z + 7);
    return map;
}

/* A scene along these sides, with voxels of 1 x 1.5 x 2 mm. */
static struct geometry scene_along(const char *letters)
{
    begin();
    put_sform(letters, 0);
    read_it();
    return geometry;
}

STORY(a_map_may_be_off_by_half_a_voxel_and_no_more)
{
    const struct geometry scene = scene_along("LPS");
    for (int w = 0; w < 3; w++)
        for (int step = -6; step <= 6; step++) {
            struct geometry moved = scene;
            moved.to_mm[w][3] += step * 0.099;
            const bool fits = abs(step) <= 5;
            fault.text[0] = '\0';
            CHECK_INT(regrid_check(size, &moved, size, &scene, false, &fault),
                      fits ? OK : ERR_INPUT);
            CHECK(fits || strstr(fault.text, "the map is up to 0.594 mm away from the scene"));
            CHECK(fits || strstr(fault.text, "resample=yes uses its nearest voxels; nothing has"));
        }
    struct geometry turned = scene_along("LAS");
    CHECK_INT(regrid_check(size, &turned, size, &scene, false, &fault), ERR_INPUT);
    CHECK_INT(regrid_check(size, &turned, size, &scene, true, &fault), OK);
}

STORY(what_does_not_know_its_place_is_taken_voxel_by_voxel_or_not_at_all)
{
    static const uint32_t other[3] = {24, 20, 15};
    const struct geometry scene = scene_along("LPS");
    begin();
    read_it();
    for (int resample = 0; resample < 2; resample++) {
        CHECK_INT(regrid_check(size, &geometry, size, &scene, resample, &fault), OK);
        CHECK_INT(regrid_check(size, &scene, size, &geometry, resample, &fault), OK);
        CHECK_INT(regrid_check(other, &geometry, size, &scene, resample, &fault), ERR_INPUT);
        CHECK_HAS(fault.text, "the map has 24x20x15 voxels and the scene 24x20x16; it cannot be");
    }
    geometry.spacing_nm[2] = 3000000;
    CHECK_INT(regrid_check(size, &geometry, size, &scene, true, &fault), ERR_INPUT);
    CHECK_HAS(fault.text, "the map has voxels of 1x1.5x3 mm and the scene of 1x1.5x2; it cannot");
}

/* The textbook's way: the nearest voxel of the map by its place in the world. */
STORY(resampled_voxels_are_the_nearest_for_all_48_ways_and_any_place)
{
    static const uint32_t is[3] = {19, 23, 6};
    uint64_t chance = 5;
    for (unsigned i = 0; i < 3 * 48; i++) {
        const struct geometry scene = scene_along("RAS");
        begin();
        put_sform(towards(i % 48), 0);
        for (int w = 0; w < 3; w++) { /* into the scene, so that they share about half */
            header.fields.srow[w][3] =
                header.fields.srow[w][0] + header.fields.srow[w][1] + header.fields.srow[w][2] < 0
                    ? 21
                    : 3;
            for (int a = 0; a < 3; a++)
                header.fields.srow[w][a] += (double)check_below(&chance, 1000) / 3000;
        }
        read_it();
        OWNED(volume_release) struct volume map = map_of(is, &geometry);
        const struct geometry place = map.geometry;
        size_t n = 0, wrong = 0, beyond = 0;
        CHECK_INT(regrid(&map, size, &scene, true, NULL, NULL, &fault), OK);
        for (uint32_t z = 0; z < size[2]; z++)
            for (uint32_t y = 0; y < size[1]; y++)
                for (uint32_t x = 0; x < size[0]; x++, n++) {
                    double mm[3];
                    int64_t at[3];
                    geometry_point(&scene, (const uint32_t[]){x, y, z}, mm);
                    CHECK(geometry_voxel(&place, mm, at));
                    bool inside = true;
                    for (int a = 0; a < 3; a++)
                        inside &= at[a] >= 0 && at[a] < is[a];
                    beyond += !inside;
                    wrong += map.intensity[n] !=
                             (inside ? (uint16_t)(at[0] + 100 * at[1] + 10000 * at[2] + 7) : 7);
                }
        CHECK_INT(wrong, 0);
        CHECK(n > 0 && memcmp(map.size, size, sizeof size) == 0);
        CHECK(memcmp(map.geometry.to_mm, scene.to_mm, sizeof scene.to_mm) == 0);
        CHECK(map.geometry.intercept == -7);
        CHECK_HAS(map.notes, "resampled from 19x23x6 voxels by the nearest\n");
        CHECK((beyond > 0) == (strstr(map.notes, "are outside the map: set to 0\n") != NULL));
    }
}

STORY(a_map_out_of_all_proportion_is_refused)
{
    const struct geometry scene = scene_along("RAS");
    static const double far[] = {1e10, 1e30, 1e300};
    for (size_t i = 0; i < sizeof far / sizeof far[0]; i++)
        for (int way = 0; way < 2; way++) {
            struct geometry place = scene;
            if (way)
                place.to_mm[1][3] = far[i];
            else
                place.to_mm[0][0] = 1 / far[i];
            OWNED(volume_release) struct volume map = map_of(size, &place);
            CHECK_INT(regrid(&map, size, &scene, true, NULL, NULL, &fault), ERR_INPUT);
            CHECK_HAS(fault.text, "too far apart, or their voxels differ too much");
        }
}
