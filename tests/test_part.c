/* SPDX-License-Identifier: MIT */
/* Parts of volumes: every box and every block against the whole, read and averaged plainly. */
#include <math.h>
#include <sys/resource.h>
#include <unistd.h>
#include <zlib.h>

#include "base/buf.h"
#include "base/file.h"
#include "image/volume.h"
#define RUN_IN_FOLDER
#define ONLY_LEAVES "v[.]nii([.]gz)?"
#include "folder_main.h"

static const char path[] = "v.nii", packed[] = "v.nii.gz";
enum { NX = 11, NY = 9, NZ = 7, VOXELS = NX * NY * NZ };

DRAW_FROM(1)

/* ---- files ---- */

static void put(uint8_t *at, uint64_t bits, unsigned width, bool big)
{
    for (unsigned i = 0; i < width; i++)
        at[big ? width - 1 - i : i] = (uint8_t)(bits >> 8 * i);
}

static void put_float(uint8_t *at, float value, bool big)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    put(at, bits, 4, big);
}

/* The header of a NIfTI of voxels 1 x 2 x 3 mm apart, from -10,-20,-30 mm on. */
static void make_header(uint8_t header[352], const uint32_t size[3], unsigned type, unsigned width,
                        bool big)
{
    static const float srow[3][4] = {{1, 0, 0, -10}, {0, 2, 0, -20}, {0, 0, 3, -30}};
    memset(header, 0, 352);
    put(header, 348, 4, big);
    put(header + 40, 3, 2, big);
    for (unsigned a = 0; a < 3; a++) {
        put(header + 42 + 2 * a, size[a], 2, big);
        put_float(header + 80 + 4 * a, (float)(a + 1), big);
        for (unsigned i = 0; i < 4; i++)
            put_float(header + 280 + 16 * a + 4 * i, srow[a][i], big);
    }
    put(header + 70, type, 2, big);
    put(header + 72, 8 * width, 2, big);
    put_float(header + 108, 352, big);
    put(header + 254, 1, 2, big);
    header[123] = 2;
    memcpy(header + 344, "n+1", 4);
}

static double value[VOXELS];

/* A type by its code, the bytes of a number of it, and its least number. */
struct type {
    unsigned code, width;
    int least;
    bool is_real;
};
static const struct type types[] = {
    {2, 1, 0, false},      {256, 1, -128, false}, {4, 2, -32768, false}, {512, 2, 0, false},
    {8, 4, -32768, false}, {768, 4, 0, false},    {1024, 8, -9, false},  {1280, 8, 0, false},
    {16, 4, -1000, true},  {64, 8, -1000, true},
};
enum { TYPES = sizeof types / sizeof types[0] };

static void put_value(uint8_t *at, double number, const struct type *type, bool big)
{
    uint64_t bits = (uint64_t)(int64_t)number;
    if (type->is_real && type->width == 4) {
        put_float(at, (float)number, big);
        return;
    }
    if (type->is_real)
        memcpy(&bits, &number, sizeof bits);
    put(at, bits, type->width, big);
}

/* Random numbers of a type, plain and packed; value[] has their values. */
static void make_file(const struct type *type, bool big)
{
    static const uint32_t size[3] = {NX, NY, NZ};
    static uint8_t bytes[352 + VOXELS * 8];
    const size_t length = 352 + VOXELS * type->width;
    make_header(bytes, size, type->code, type->width, big);
    for (unsigned i = 0; i < VOXELS; i++) {
        value[i] = type->least + (double)below(type->width == 1 ? 256 : 65536);
        put_value(bytes + 352 + i * type->width, value[i], type, big);
    }
    CHECK(file_write(path, bytes, length, FILE_REPLACE, NULL) == OK);
    gzFile gz = gzopen(packed, "wb");
    gzwrite(gz, bytes, (unsigned)length);
    gzclose(gz);
}

/* ---- the oracle ---- */

static double at(uint32_t x, uint32_t y, uint32_t z)
{
    return value[x + NX * (y + NY * z)];
}

/* The value of voxel x, y, z of the part. */
static double expected(const struct volume_choice *choice, const uint32_t step[3], bool whole,
                       uint32_t x, uint32_t y, uint32_t z)
{
    const uint32_t place[3] = {x, y, z};
    uint32_t begin[3];
    double sum = 0;
    for (int a = 0; a < 3; a++)
        begin[a] = (choice->has_crop ? choice->first[a] : 0) + place[a] * step[a];
    if (choice->nearest)
        return at(begin[0] + (step[0] - 1) / 2, begin[1] + (step[1] - 1) / 2,
                  begin[2] + (step[2] - 1) / 2);
    for (uint32_t k = 0; k < step[2]; k++)
        for (uint32_t j = 0; j < step[1]; j++)
            for (uint32_t i = 0; i < step[0]; i++)
                sum += at(begin[0] + i, begin[1] + j, begin[2] + k);
    sum /= step[0] * step[1] * step[2];
    return whole ? floor(sum + 0.5) : sum;
}

static void check_part(const char *file, const struct volume_choice *choice, bool whole)
{
    static const uint32_t size[3] = {NX, NY, NZ};
    OWNED(volume_release) struct volume v = {0};
    struct fault fault = {0};
    uint32_t step[3];
    if (!CHECK(volume_read(&v, file, choice, NULL, &fault) == OK)) {
        printf("#   %s\n", fault.text);
        return;
    }
    for (int a = 0; a < 3; a++) {
        const uint32_t begin = choice->has_crop ? choice->first[a] : 0;
        const uint32_t count = choice->has_crop ? choice->last[a] - begin + 1 : size[a];
        step[a] = choice->reduce > 1 && count >= choice->reduce ? choice->reduce : 1;
        CHECK_INT(v.size[a], count / step[a]);
        CHECK_INT(v.whole[a], size[a]);
        CHECK_INT(v.geometry.spacing_nm[a], (uint32_t)(a + 1) * 1000000 * step[a]);
        CHECK(fabs(v.geometry.to_mm[a][3] -
                   (-10 * (a + 1) + (a + 1) * (begin + (step[a] - 1) / 2.0))) < 1e-9);
    }
    bool same = true;
    for (uint32_t z = 0, n = 0; z < v.size[2]; z++)
        for (uint32_t y = 0; y < v.size[1]; y++)
            for (uint32_t x = 0; x < v.size[0]; x++, n++) {
                const double is = geometry_value(&v.geometry, v.intensity[n]);
                const double wanted = expected(choice, step, whole, x, y, z);
                same &= fabs(is - wanted) <= (whole ? 0 : 0.51);
            }
    CHECK(same);
}

/* ---- stories ---- */

STORY(a_part_is_what_the_whole_has_there)
{
    for (int round = 0; round < 400; round++) {
        struct volume_choice choice = {.has_crop = below(4) > 0, .nearest = below(2) == 0};
        const uint32_t size[3] = {NX, NY, NZ};
        for (int a = 0; a < 3; a++) {
            choice.first[a] = below(size[a]);
            choice.last[a] = choice.first[a] + below(size[a] - choice.first[a]);
        }
        choice.reduce = below(5);
        const struct type *type = &types[round % TYPES];
        make_file(type, round / TYPES % 2);
        check_part(round % 3 ? path : packed, &choice, !type->is_real);
    }
}

STORY(halves_are_rounded_up_and_what_is_not_finite_is_left_out)
{
    static const uint32_t size[3] = {2, 2, 2};
    static const float given[8] = {1, NAN, 3, INFINITY, 4, NAN, NAN, NAN};
    static const struct volume_choice choice = {.reduce = 2};
    uint8_t bytes[352 + 32];
    struct volume v;
    make_header(bytes, size, 4, 2, false);
    for (unsigned i = 0; i < 8; i++) /* seven of -1 and one of -5: -12 / 8 = -1.5 */
        put(bytes + 352 + 2 * i, (uint64_t)(i ? -1 : -5), 2, false);
    CHECK(file_write(path, bytes, 352 + 16, FILE_REPLACE, NULL) == OK);
    CHECK(volume_read(&v, path, &choice, NULL, NULL) == OK);
    CHECK(geometry_value(&v.geometry, v.intensity[0]) == -1);
    volume_release(&v);
    make_header(bytes, size, 16, 4, false);
    for (unsigned i = 0; i < 8; i++)
        put_float(bytes + 352 + 4 * i, given[i], false);
    CHECK(file_write(path, bytes, 352 + 32, FILE_REPLACE, NULL) == OK);
    CHECK(volume_read(&v, path, &choice, NULL, NULL) == OK);
    CHECK(fabs(geometry_value(&v.geometry, v.intensity[0]) - 8.0 / 3) < 1e-6);
    volume_release(&v);
}

STORY(a_box_outside_is_refused_and_what_is_left_out_is_noted)
{
    struct volume_choice choice = {
        .has_crop = true, .first = {0, 0, 0}, .last = {NX - 1, NY, NZ - 1}};
    struct fault fault = {0};
    OWNED(volume_release) struct volume v;
    make_file(&types[0], false);
    CHECK_INT(volume_read(&v, path, &choice, NULL, &fault), ERR_USAGE);
    CHECK_HAS(fault.text, "crop: 0-9 is not in the 9 voxels along y, 0-8");
    choice = (struct volume_choice){.reduce = 4};
    CHECK_INT(volume_read(&v, path, &choice, NULL, &fault), OK);
    CHECK_HAS(v.notes, "the last 3 of 11 voxels along x left out");
    CHECK_HAS(v.notes, "the last 1 of 9 voxels along y left out");
}

static long peak_kb(void)
{
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    return usage.ru_maxrss;
}

STORY(a_large_file_takes_the_memory_of_the_part_alone)
{
    static const uint32_t size[3] = {2048, 2048, 2048};
    const struct volume_choice box = {
        .has_crop = true, .first = {1000, 1000, 2000}, .last = {1063, 1063, 2031}};
    uint8_t header[352];
    struct fault fault = {0};
    struct volume v;
    make_header(header, size, 4, 2, false);
    CHECK(file_write(path, header, sizeof header, FILE_REPLACE, NULL) == OK);
    CHECK(truncate(path, 352 + ((off_t)1 << 34)) == 0); /* a hole */
    const long before = peak_kb();
    CHECK_INT(volume_read(&v, path, &box, NULL, &fault), OK);
    CHECK(v.size[0] == 64 && v.size[2] == 32);
    volume_release(&v);
    CHECK(peak_kb() - before < 8 << 10);
    CHECK_INT(volume_read(&v, path, NULL, NULL, &fault), ERR_LIMIT);
    CHECK_HAS(fault.text, "at most 2^32 cells are held");
    CHECK_HAS(fault.text, "open a part of it, with crop=A-B,C-D,E-F or reduce=2");
    CHECK(unlink(path) == 0);
}
