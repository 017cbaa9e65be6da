/* SPDX-License-Identifier: MIT */
/* NIfTI: each kind of file that is read, each kind that is refused, and written files. */
#include <math.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>
#include <zlib.h>

#include "base/buf.h"
#include "base/file.h"
#include "image/volume.h"
#define ONLY_LEAVES "a[.](nii|nii[.]gz|hdr|img|scene)"
#define RUN_IN_FOLDER
#include "folder_main.h"

static const char plain[] = "a.nii", packed[] = "a.nii.gz";

/* ---- files made by hand; the places of fields are those of nifti1.h ---- */

enum { NX = 4, NY = 3, NZ = 2, VOXELS = NX * NY * NZ };

struct made {
    uint8_t bytes[8192];
    size_t length;
    bool big; /* byte order */
};

static void put(struct made *m, size_t at, uint64_t bits, unsigned width)
{
    for (unsigned i = 0; i < width; i++)
        m->bytes[at + (m->big ? width - 1 - i : i)] = (uint8_t)(bits >> 8 * i);
}

static void put_float(struct made *m, size_t at, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    put(m, at, bits, 4);
}

static void put_double(struct made *m, size_t at, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    put(m, at, bits, 8);
}

enum { DIM = 40, DATATYPE = 70, PIXDIM = 76, OFFSET = 108, SLOPE = 112, INTER = 116, UNITS = 123 };
enum { DESCRIP = 148, QFORM = 252, SFORM = 254, QUATERN = 256, SROW = 280, MAGIC = 344 };
enum { DATA = 352 };

static unsigned width_of(int datatype)
{
    return datatype == 2 || datatype == 256                         ? 1
           : datatype == 16 || datatype == 8 || datatype == 768     ? 4
           : datatype == 64 || datatype == 1024 || datatype == 1280 ? 8
                                                                    : 2;
}

/* A 4x3x2 scene of zeros, voxels of 1 x 2 x 3 mm. */
static struct made make(int datatype, bool big)
{
    struct made m = {.big = big, .length = DATA + VOXELS * width_of(datatype)};
    static const uint64_t dim[8] = {3, NX, NY, NZ, 1, 1, 1, 1};
    put(&m, 0, 348, 4);
    for (unsigned i = 0; i < 8; i++)
        put(&m, DIM + 2 * i, dim[i], 2);
    put(&m, DATATYPE, (uint64_t)datatype, 2);
    for (unsigned i = 0; i < 4; i++)
        put_float(&m, PIXDIM + 4 * i, (float)i);
    put_float(&m, OFFSET, DATA);
    m.bytes[UNITS] = 2;
    memcpy(m.bytes + MAGIC, "n+1", 4);
    return m;
}

/* The same as a NIfTI-2 of 16 bits, along these sides. */
static struct made make_nifti_2(const uint64_t side[3], bool big)
{
    struct made m = {.big = big, .length = 1000};
    put(&m, 0, 540, 4);
    memcpy(m.bytes + 4, "n+2\0\r\n\032\n", 8);
    put(&m, 12, 512, 2);
    put(&m, 16, 3, 8);
    for (unsigned a = 0; a < 3; a++)
        put(&m, 24 + 8 * a, side[a], 8);
    put(&m, 168, 544, 8);
    return m;
}

static void put_sform(struct made *m, const float row[12])
{
    put(m, SFORM, 1, 2);
    for (unsigned i = 0; i < 12; i++)
        put_float(m, SROW + 4 * i, row[i]);
}

static void save(const char *path, const void *bytes, size_t length)
{
    OWNED(stream_release) FILE *file = fopen(path, "wb");
    fwrite(bytes, 1, length, file);
}

static void save_packed(const char *path, const void *bytes, size_t length)
{
    gzFile file = gzopen(path, "wb");
    gzwrite(file, bytes, (unsigned)length);
    gzclose(file);
}

/* Read a file; a refusal fails the story. */
static struct volume read_back(const char *path)
{
    struct volume v;
    struct fault fault = {0};
    CHECK_INT(volume_read(&v, path, NULL, NULL, &fault), OK);
    CHECK_TEXT(fault.text, "");
    return v;
}

static struct volume read_made(const struct made *m)
{
    save(plain, m->bytes, m->length);
    return read_back(plain);
}

static const char *refusal_of(const char *path)
{
    static struct fault fault;
    OWNED(volume_release) struct volume v = {0};
    fault = (struct fault){0};
    CHECK(volume_read(&v, path, NULL, NULL, &fault) != OK && v.intensity == NULL && v.size[0] == 0);
    CHECK(strpbrk(fault.text, "\n\033") == NULL);
    return fault.text;
}

/* Check that two volumes have the same 900 intensities, of the same scale; release both. */
static void are_same(struct volume *a, struct volume *b)
{
    CHECK(a->intensity && b->intensity && memcmp(a->intensity, b->intensity, 900 * 2) == 0);
    CHECK(a->geometry.slope == b->geometry.slope && a->geometry.intercept == b->geometry.intercept);
    volume_release(a);
    volume_release(b);
}

/* The message that refuses the bytes. */
static const char *refusal(const struct made *m)
{
    save(plain, m->bytes, m->length);
    return refusal_of(plain);
}

/* ---- tables ---- */

/* One change of a header, by the kind of its number; NONE ends a list. */
struct edit {
    enum { NONE, U8, U16, U32, F32, LENGTH /* of the file */ } kind;
    size_t at;
    double value;
};

static void apply_edits(struct made *m, const struct edit *edit, size_t most)
{
    for (size_t i = 0; i < most && edit[i].kind != NONE; i++) {
        const double value = edit[i].value;
        if (edit[i].kind == F32)
            put_float(m, edit[i].at, (float)value);
        else if (edit[i].kind == LENGTH)
            m->length = (size_t)value;
        else
            put(m, edit[i].at, (uint64_t)(int64_t)value, 1U << (edit[i].kind - U8));
    }
}

/* Put voxel i of a type, after `begin` bytes. */
static void put_voxel(struct made *m, int datatype, size_t begin, unsigned i, double value)
{
    const unsigned width = width_of(datatype);
    if (datatype == 16)
        put_float(m, begin + 4 * i, (float)value);
    else if (datatype == 64)
        put_double(m, begin + 8 * i, value);
    else
        put(m, begin + width * i, (uint64_t)(int64_t)value, width);
}

/* ---- voxels ---- */

/* In both byte orders: the first four voxels; from the fourth on each has `rise` more intensity. */
STORY(numbers_of_each_type_become_intensities_and_keep_their_values)
{
    static const struct {
        int datatype;
        struct edit edit[4];
        double value[4];
        int rise, intensity[4];
        double slope, intercept;
        const char *note;
    } row[] = {
        {2, {{0}}, {250, 255, 0, 7}, 12, {250, 255, 0, 7}, 1, 0, ""},
        {512, {{0}}, {65535, 4711, 0, 7}, 3001, {65535, 4711, 0, 7}, 1, 0, ""},
        /* signed words are shifted only if some are negative, signed bytes too */
        {4, {{0}}, {-32768, 7, 13, 0}, 1501, {0, 32775, 32781, 32768}, 1, -32768, ""},
        {4, {{0}}, {7, 13, 32767, 0}, 1501, {7, 13, 32767, 0}, 1, 0, ""},
        {256, {{0}}, {-128, 106, 127, 0}, -6, {0, 234, 255, 128}, 1, -128, ""},
        {256, {{0}}, {-64, 106, 127, 0}, 6, {0, 170, 191, 64}, 1, -64, ""},
        {256, {{0}}, {0, 106, 127, 0}, 6, {0, 106, 127, 0}, 1, 0, ""},
        /* floats are spread over 16 bits, and halves round up */
        {16, {{0}}, {0, 131070, 1, 131069}, -3001, {0, 65535, 1, 65535}, 2, 0, ""},
        {16, {{0}}, {-2.5, 2.5, 0, -2.5}, 3001, {0, 65535, 32768, 0}, 5.0 / 65535, -2.5, ""},
        {16, {{0}}, {7.5, 7.5, 7.5, 7.5}, 0, {0, 0, 0, 0}, 1, 7.5, ""},
        {16, {{0}}, {-3.4e38, 3.4e38, 0, 0}, 0, {0, 65535, 32768, 32768}, NAN, NAN, ""},
        {64, {{0}}, {-1.7e308, 1.7e308, 0, 0}, 0, {0, 65535, 32768, 32768}, NAN, NAN, ""},
        /* the scale of the file; slope 0 and no numbers are no scale */
        {4, {{F32, SLOPE, 0.5}, {F32, INTER, 100}}, {-10, 0}, 1, {0, 10, 10, 10}, 0.5, 95, ""},
        {4, {{F32, SLOPE, 0}, {F32, INTER, 100}}, {-10, 0}, 1, {0, 10, 10, 10}, 1, -10, ""},
        {2,
         {{F32, SLOPE, NAN}, {F32, INTER, 5}},
         {1},
         1,
         {1},
         1,
         0,
         "scl_slope is nan and scl_inter 5: values are not scaled\n"},
        {2, {{F32, SLOPE, INFINITY}, {F32, INTER, 5}}, {1}, 1, {1}, 1, 0, "inf"},
        {2, {{F32, SLOPE, 2}, {F32, INTER, -INFINITY}}, {1}, 1, {1}, 1, 0, "inf"},
        /* extensions are skipped, two dimensions are a slice, further ones of one voxel pass */
        {2, {{U16, DIM, 2}, {U16, DIM + 6, 0}, {F32, OFFSET, 416}}, {99}, 1, {99}, 1, 0, ""},
        {2, {{U16, DIM, 5}}, {99}, 1, {99}, 1, 0, ""},
        {2, {{F32, OFFSET, 0}}, {99}, 1, {99}, 1, 0, ""}, /* some writers leave it out */
    };
    for (size_t i = 0; i < 2 * sizeof row / sizeof *row; i++) {
        const size_t k = i / 2;
        struct made m = make(row[k].datatype, i % 2);
        apply_edits(&m, row[k].edit, 4);
        const bool is_slice = row[k].edit[2].kind == F32;
        const unsigned begin = is_slice ? 416 : DATA, voxels = is_slice ? NX * NY : VOXELS;
        const double step = row[k].datatype == 16 && row[k].rise ? row[k].slope : 1;
        for (unsigned n = 0; n < voxels; n++)
            put_voxel(&m, row[k].datatype, begin, n,
                      row[k].value[n < 4 ? n : 3] + (n < 4 ? 0 : (n - 3.0) * row[k].rise * step));
        m.length = begin + voxels * width_of(row[k].datatype);
        OWNED(volume_release) struct volume v = read_made(&m);
        for (int n = 0; n < (int)voxels; n++)
            CHECK_INT(v.intensity[n],
                      row[k].intensity[n < 4 ? n : 3] + (n < 4 ? 0 : (n - 3) * row[k].rise));
        CHECK(isnan(row[k].slope) ? isfinite(v.geometry.slope)
                                  : fabs(v.geometry.slope - row[k].slope) < 1e-12);
        CHECK(isnan(row[k].intercept) ? isfinite(v.geometry.intercept)
                                      : v.geometry.intercept == row[k].intercept);
        CHECK(v.size[0] == NX && v.size[1] == NY && v.size[2] == (is_slice ? 1 : NZ));
        CHECK_HAS(v.notes, row[k].note);
    }
}

/* The same in two members, which only zlib's stream reads. */
static void save_in_members(const char *path, const struct made *m)
{
    save_packed(path, m->bytes, m->length / 2);
    gzFile file = gzopen(path, "ab");
    gzwrite(file, m->bytes + m->length / 2, (unsigned)(m->length - m->length / 2));
    gzclose(file);
}

static void append(const char *path, const char *bytes)
{
    OWNED(stream_release) FILE *file = fopen(path, "ab");
    fputs(bytes, file);
}

/* Make 10x10x9 voxels, with or without 48 bytes of an extension. */
static struct made make_larger(int datatype, bool big, bool extended, uint64_t *chance)
{
    struct made m = make(datatype, big);
    const unsigned width = width_of(datatype), begin = extended ? 400 : DATA;
    for (unsigned i = 1; i < 4; i++)
        put(&m, DIM + 2 * i, i < 3 ? 10 : 9, 2);
    put_float(&m, OFFSET, (float)begin);
    for (unsigned i = 0; i < 900; i++)
        if (datatype == 16 || datatype == 64)
            put_voxel(&m, datatype, begin, i, check_below(chance, 5000) / 7.0);
        else
            put(&m, begin + width * i, check_random(chance), width);
    m.length = begin + 900 * width;
    return m;
}

STORY(a_gzip_gives_the_voxels_of_the_plain_file_however_it_is_inflated)
{
    static const int datatype[] = {2, 4, 512, 16, 256, 8, 768, 64, 1024, 1280};
    uint64_t chance = 14;
    for (unsigned i = 0; i < 120; i++) {
        const struct made m = make_larger(datatype[i % 10], i / 10 % 2, i / 20 % 2, &chance);
        struct volume expected = read_made(&m), v;
        (i / 40 == 1 ? save_in_members(packed, &m) : save_packed(packed, m.bytes, m.length));
        if (i / 40 == 2)
            append(packed, "what follows is nobody's");
        CHECK_INT(volume_read(&v, packed, NULL, NULL, NULL), OK);
        are_same(&v, &expected);
    }
}

STORY(a_false_length_at_the_end_of_a_gzip_is_told)
{
    uint64_t chance = 15;
    const struct made m = make_larger(512, false, false, &chance);
    OWNED(buf_release) struct buf file = {0};
    save_packed(packed, m.bytes, m.length + 100); /* longer than its voxels; its end denies it */
    CHECK_INT(file_read(&file, packed, 8192, NULL), OK);
    file.data[file.length - 4] = (char)(m.length & 255);
    file.data[file.length - 3] = (char)(m.length >> 8);
    save(packed, file.data, file.length);
    CHECK_HAS(refusal_of(packed), "damaged: its gzip data or checksum is wrong");
}

STORY(nifti_2_is_read_in_both_byte_orders)
{
    for (int big = 0; big < 2; big++) {
        struct made m = make_nifti_2((const uint64_t[]){NX, NY, NZ}, big);
        m.length = 544 + VOXELS * 2;
        for (unsigned i = 0; i < 8; i++)
            put_double(&m, 104 + 8 * i, 0.25);
        for (unsigned i = 4; i < 8; i++)
            put(&m, 16 + 8 * i, 1, 8);
        put_double(&m, 176, 2.0);
        put(&m, 500, 2, 4);
        put(&m, 544 + 2 * 23, 815, 2);
        OWNED(volume_release) struct volume v = read_made(&m);
        CHECK(v.intensity && v.intensity[23] == 815);
        CHECK(v.geometry.slope == 2 && v.geometry.spacing_nm[1] == 250000);
    }
}

/* ---- pairs ---- */

/* The same as a pair, read by its header. */
static struct volume read_pair(const struct made *m, size_t begin)
{
    save("a.hdr", m->bytes, 348);
    save("a.img", m->bytes + begin, m->length - begin);
    return read_back("a.hdr");
}

STORY(a_pair_is_what_the_single_file_is)
{
    uint64_t chance = 16;
    for (unsigned i = 0; i < 20; i++) {
        static const int datatype[] = {2, 4, 512, 16, 64};
        struct made m = make_larger(datatype[i % 5], i / 5 % 2, false, &chance);
        put_sform(&m, (const float[12]){-2, 0, 0, 9, 0, 2, 0, 8, 0, 0, 3, 7});
        struct volume expected = read_made(&m);
        memcpy(m.bytes + MAGIC, "ni1", 4);
        put_float(&m, OFFSET, i / 10 ? 32 : 0); /* bytes before the voxels */
        struct volume v = read_pair(&m, i / 10 ? DATA - 32 : DATA);
        CHECK(memcmp(v.geometry.to_mm, expected.geometry.to_mm, sizeof v.geometry.to_mm) == 0);
        CHECK_INT(v.geometry.orientation, ORIENTATION_SFORM);
        are_same(&v, &expected);
    }
}

STORY(analyze_says_no_place_whatever_stands_there)
{
    for (int big = 0; big < 2; big++) {
        struct made m = make(4, big);
        memset(m.bytes + MAGIC, 0, 4);
        put(&m, QFORM, 1, 2); /* orient, and an origin */
        put_sform(&m, (const float[12]){-2, 0, 0, 9, 0, 2, 0, 8, 0, 0, 3, 7});
        put_float(&m, OFFSET, 0);
        memcpy(m.bytes + 56, big ? "mm" : "cm", 2);
        struct volume v = read_pair(&m, DATA);
        CHECK_INT(v.geometry.orientation, ORIENTATION_UNKNOWN);
        CHECK(!v.geometry.spacing_unknown);
        CHECK_INT(v.geometry.spacing_nm[1], big ? 2000000 : 20000000);
        CHECK_HAS(v.notes, "it is ANALYZE, which does not say which side is left");
        CHECK_INT(v.geometry.fields.sform_code, 0);
        CHECK_INT(v.geometry.fields.qform_code, 0);
        volume_release(&v);
        memcpy(m.bytes + 56, "px", 2);
        v = read_pair(&m, DATA);
        CHECK(v.geometry.spacing_unknown);
        CHECK_HAS(v.notes, "its unit of length is unknown");
        volume_release(&v);
    }
}

STORY(types_and_scales_of_spm_are_read)
{
    static const struct {
        int by_spm, by_nifti;
    } type[] = {{130, 256}, {132, 512}, {136, 768}};
    uint64_t chance = 17;
    for (unsigned i = 0; i < 3; i++) {
        struct made m = make_larger(type[i].by_nifti, false, false, &chance);
        put_float(&m, SLOPE, 0.5f);
        put_float(&m, INTER, 7);
        struct volume expected = read_made(&m);
        memset(m.bytes + MAGIC, 0, 4);
        put(&m, DATATYPE, (uint64_t)type[i].by_spm, 2);
        put_float(&m, OFFSET, 0);
        struct volume v = read_pair(&m, DATA);
        CHECK_HAS(v.notes, "its values are multiplied by 0.5, then 7 is added");
        are_same(&v, &expected);
    }
}

/* ---- the place ---- */

STORY(the_place_is_the_sform_or_the_qform_or_the_axes_of_the_world)
{
    static const struct {
        struct edit edit[8];
        float srow[12]; /* all 0: no sform */
        float to_mm[12];
        const char *axes;
        int sform_code, qform_code;
    } row[] = {
        {{{0}}, {0}, {1, 0, 0, 0, 0, 2, 0, 0, 0, 0, 3, 0}, "RAS", 0, 0},
        /* both have the same axes, in different places: the sform holds */
        {{{U16, QFORM, 1},
          {F32, PIXDIM, 1},
          {F32, QUATERN, 0.5},
          {F32, QUATERN + 4, 0.5},
          {F32, QUATERN + 8, -0.5}},
         {0, 2, 0, 5, 0, 0, -3, 6, -1, 0, 0, 7},
         {0, 2, 0, 5, 0, 0, -3, 6, -1, 0, 0, 7},
         "IRP",
         1,
         1},
        /* a quarter turn about z, and a flip: i runs along +y */
        {{{U16, QFORM, 2},
          {F32, PIXDIM, -1},
          {F32, QUATERN + 8, 0.70710678},
          {F32, QUATERN + 12, -11}},
         {0},
         {0, -2, 0, -11, 1, 0, 0, 0, 0, 0, -3, 0},
         "ALI",
         0,
         2},
    };
    for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
        struct made m = make(2, false);
        char axes[4];
        apply_edits(&m, row[i].edit, 8);
        if (row[i].sform_code)
            put_sform(&m, row[i].srow);
        OWNED(volume_release) struct volume v = read_made(&m);
        for (int k = 0; k < 12; k++)
            CHECK(fabs(v.geometry.to_mm[k / 4][k % 4] - (double)row[i].to_mm[k]) < 1e-6);
        for (int a = 0; a < 3; a++)
            CHECK_INT(v.geometry.spacing_nm[a], 1000000 * (a + 1));
        geometry_axes(axes, &v.geometry);
        CHECK_TEXT(axes, row[i].axes);
        CHECK_INT(v.geometry.sform.code, row[i].sform_code);
        CHECK_INT(v.geometry.qform.code, row[i].qform_code);
    }
}

STORY(a_matrix_that_cannot_be_inverted_falls_back)
{
    static const float bad[][12] = {
        {1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0},   /* two axes alike */
        {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0},   /* nothing */
        {NAN, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}, /* not a number */
        {1, 0, 0, INFINITY, 0, 1, 0, 0, 0, 0, 1, 0},
        {1, 2, 3, 0, 4, 5, 6, 0, 7, 8, 9, 0}, /* in one plane */
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
        for (int turned = 0; turned < 2; turned++) {
            struct made m = make(2, false);
            put_sform(&m, bad[i]);
            put(&m, QFORM, 1, 2);
            put_float(&m, QUATERN + 8, turned ? 1.0f : NAN); /* half a turn, or nonsense */
            OWNED(volume_release) struct volume v = read_made(&m);
            CHECK(fabs(v.geometry.to_mm[0][0] - (turned ? -1 : 1)) < 1e-6);
            CHECK_INT(v.geometry.sform.code, 0);
            CHECK_INT(v.geometry.qform.code, turned);
        }
}

STORY(the_axes_are_a_permutation_whatever_the_matrix)
{
    uint64_t chance = 3;
    for (int round = 0; round < 2000; round++) {
        struct made m = make(2, false);
        float row[12];
        for (int i = 0; i < 12; i++)
            row[i] = (float)((int)check_below(&chance, 7) - 3);
        put_sform(&m, row);
        OWNED(volume_release) struct volume v = read_made(&m);
        int seen = 0;
        for (int a = 0; a < 3; a++) {
            seen |= 1 << v.geometry.world_axis[a];
            CHECK(v.geometry.world_sign[a] == 1 || v.geometry.world_sign[a] == -1);
        }
        CHECK_INT(seen, 7);
    }
}

STORY(units_of_length_are_honoured)
{
    static const struct {
        uint8_t units;
        uint32_t spacing_nm;
        const char *note;
    } unit[] = {
        {0, 1000000, "it has no unit of length: millimetres are assumed\n"},
        {1, 1000000000, ""},
        {2, 1000000, ""},
        {3, 1000, ""},
        {3 | 8, 1000, ""},
        {5 | 8, 1000000, "its unit of length is 5, which is invalid: millimetres are assumed\n"}};
    for (size_t i = 0; i < sizeof unit / sizeof unit[0]; i++) {
        struct made m = make(2, false);
        m.bytes[UNITS] = unit[i].units;
        OWNED(volume_release) struct volume v = read_made(&m);
        CHECK_INT(v.geometry.spacing_nm[0], unit[i].spacing_nm);
        CHECK(fabs(v.geometry.to_mm[0][0] * 1e6 - unit[i].spacing_nm) < 1e-3);
        CHECK_HAS(v.notes, unit[i].note);
        CHECK(*unit[i].note || !strstr(v.notes, "unit"));
    }
}

/* ---- refusals ---- */

/* Headers with wrong fields. */
STORY(wrong_headers_are_refused_with_what_was_expected)
{
    static const struct {
        struct edit edit[5];
        const char *words;
    } row[] = {
        {{{U32, 0, 349}}, "sizeof_hdr is 349; expected 348 or 540"},
        {{{U32, MAGIC, 0}}, "its magic, which is neither \"n+1\" nor \"n+2\""},
        {{{U8, MAGIC + 1, 'i'}}, "expected the names A.hdr and A.img"},
        {{{LENGTH, 0, 5}}, "5 bytes; expected at least 348"},
        {{{LENGTH, 0, 0}}, "0 bytes; expected at least 348"},
        {{{U16, DIM, 0}}, "dim[0] is 0; expected 3 dimensions"},
        {{{U16, DIM, 1}}, "dim[0] is 1; expected 3 dimensions"},
        {{{U16, DIM, 8}}, "dim[0] is 8; expected 3 dimensions"},
        {{{U16, DIM, -3}}, "dim[0] is -3; expected 3 dimensions"},
        {{{U16, DIM + 2, 0}}, "dim[1] is 0; expected at least one voxel"},
        {{{U16, DIM + 4, -5}}, "dim[2] is -5; expected at least one voxel"},
        {{{U16, DIM, 4}, {U16, DIM + 8, 200}}, "its header claims 4800 bytes"},
        {{{U16, DIM, 5}, {U16, DIM + 8, 2}, {U16, DIM + 10, 3}, {LENGTH, 0, DATA + 6 * VOXELS}},
         "a series of 6 volumes; choose one, as in --volume 0, of 0 to 5"},
        /* more voxels than the file can hold, before anything is allocated */
        {{{U16, DATATYPE, 512}, {U16, DIM + 2, 1000}, {U16, DIM + 4, 1000}, {LENGTH, 0, 400}},
         "claims 4000000 bytes of voxels from byte 352, but 400 bytes"},
        {{{LENGTH, 0, DATA + VOXELS - 1}}, "cut short"},
        {{{U16, DATATYPE, 512},
          {U16, DIM + 2, 32767},
          {U16, DIM + 4, 32767},
          {U16, DIM + 6, 32767},
          {LENGTH, 0, 399}},
         "claims 70362301923326 bytes of voxels from byte 352, but 399 bytes"},
        {{{F32, OFFSET, 1}}, "vox_offset is 1; expected a whole number of bytes from 352"},
        {{{F32, OFFSET, 348}}, "vox_offset is 348; expected a whole number of bytes from 352"},
        {{{F32, OFFSET, 351}}, "vox_offset is 351; expected a whole number of bytes from 352"},
        {{{F32, OFFSET, 352.5}}, "vox_offset is 352.5; expected a whole number of bytes from 352"},
        {{{F32, OFFSET, -352}}, "vox_offset is -352; expected a whole number of bytes from 352"},
        {{{F32, OFFSET, 1e30}}, "vox_offset is 1e+30; expected a whole number of bytes from 352"},
        {{{F32, OFFSET, INFINITY}}, "vox_offset is inf; expected a whole number of bytes"},
        {{{F32, OFFSET, NAN}}, "vox_offset is nan; expected a whole number of bytes"},
        {{{F32, OFFSET, 3e8}}, "vox_offset is 3e+08; expected a whole number of bytes from 352"},
        {{{F32, OFFSET, 100000}}, "cut short"},
    };
    for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
        struct made m = make(2, false);
        apply_edits(&m, row[i].edit, 5);
        CHECK_HAS(refusal(&m), row[i].words);
    }
    CHECK_HAS(refusal_of(folder), "the volume helper"); /* a folder of slices: not with a test */
    CHECK_HAS(refusal_of("/nonexistent/a.nii"), "No such file");
    struct made m = make(2, false);
    put(&m, DIM + 2, 30000, 2);
    put(&m, DIM + 4, 10000, 2);
    save_packed(packed, m.bytes, m.length);
    CHECK_HAS(refusal_of(packed), "bytes of gzip hold at most");
    m = make_nifti_2((const uint64_t[]){NX, NY, NZ}, false);
    m.length = 400;
    CHECK_HAS(refusal(&m), "ends within the header");
}

STORY(a_format_is_known_by_content_or_by_name)
{
    static const char other[] = "a.scene";
    struct made m = make(2, false);
    m.bytes[DATA + 7] = 47;
    for (int i = 0; i < 3; i++) {
        const char *path = i < 2 ? other : plain;
        (i == 0 ? save : save_packed)(path, m.bytes, m.length);
        OWNED(volume_release) struct volume v = read_back(path);
        CHECK(v.intensity && v.intensity[7] == 47);
    }
    save(other, "x,y,z,label\n", 12);
    CHECK_HAS(refusal_of(other), "a.scene: not a volume; expected NIfTI (.nii or .nii.gz)");
    save(plain, "x,y,z,label\n", 12);
    CHECK_HAS(refusal_of(plain), "a.nii: not a NIfTI file: 12 bytes");
}

STORY(one_volume_of_a_series_is_read)
{
    for (int packs = 0; packs < 2; packs++) {
        struct made m = make(512, false);
        const char *path = packs ? packed : plain;
        put(&m, DIM, 4, 2);
        put(&m, DIM + 8, 5, 2);
        m.length += 4 * 2 * VOXELS;
        for (uint32_t i = 0; i < 5 * VOXELS; i++)
            put(&m, DATA + 2 * i, 1000 * (i / VOXELS) + i % VOXELS, 2);
        (packs ? save_packed : save)(path, m.bytes, m.length);
        for (uint32_t n = 0; n <= 5; n++) {
            const struct volume_choice choice = {.has_volume = true, .volume = n};
            struct fault fault = {0};
            OWNED(volume_release) struct volume v;
            CHECK_INT(volume_read(&v, path, &choice, NULL, &fault), n < 5 ? OK : ERR_INPUT);
            for (uint32_t i = 0; n < 5 && i < VOXELS; i++)
                CHECK_INT(v.intensity[i], 1000 * n + i);
            CHECK(n < 5 || strstr(fault.text, "there is no volume 5; it holds 5, counted from 0"));
        }
    }
}

STORY(nifti_2_dimensions_beyond_64_bits_are_refused)
{
    static const uint64_t side[] = {UINT64_C(1) << 62, 65535, UINT64_C(0xffffffffffffffff)};
    for (size_t i = 0; i < 3; i++) {
        struct made m = make_nifti_2((const uint64_t[]){side[i], side[i], side[i]}, false);
        CHECK_HAS(refusal(&m), i == 2 ? "dim[1] is -1" : "65534");
    }
}

STORY(types_that_are_not_read_are_named)
{
    static const struct {
        int datatype;
        const char *name;
    } other[] = {{1536, "float128 (datatype 1536); write it as float64"},
                 {1, "binary (datatype 1); write it as uint8"},
                 {128, "rgb24 (datatype 128); it has colours: take one channel, as `c3d -mcs"},
                 {2304, "rgba32 (datatype 2304); it has colours"},
                 {32, "complex64 (datatype 32); take the magnitude, as `fslcomplex"},
                 {1792, "complex128"},
                 {77, "unknown (datatype 77); write whole or real numbers"}};
    for (size_t i = 0; i < sizeof other / sizeof other[0]; i++) {
        struct made m = make(2, false);
        put(&m, DATATYPE, (uint64_t)other[i].datatype, 2);
        CHECK_HAS(refusal(&m), other[i].name);
    }
}

STORY(voxels_that_are_no_numbers_are_background_and_counted)
{
    static const double odd[] = {NAN, INFINITY, -INFINITY}, least[] = {-8, 0, 4};
    for (unsigned i = 0; i < 2 * 2 * 3; i++) {
        const int datatype = i % 2 ? 64 : 16;
        struct made m = make(datatype, i / 2 % 2);
        const double low = least[i / 4], zero = low < 0 ? low : 0;
        for (unsigned k = 0; k < VOXELS; k++)
            put_voxel(&m, datatype, DATA, k, k % 5 == 2 ? odd[k % 3] : low + k);
        put_voxel(&m, datatype, DATA, 0, low);
        OWNED(volume_release) struct volume v = read_made(&m);
        CHECK_HAS(v.notes, low < 0 ? "5 voxels are no number or infinite: taken for -8\n"
                                   : "5 voxels are no number or infinite: taken for 0\n");
        for (unsigned k = 0; k < VOXELS; k++) {
            const double is = geometry_value(&v.geometry, v.intensity[k]);
            CHECK(fabs(is - (k % 5 == 2 ? zero : low + k)) < 1e-3);
        }
    }
    struct made m = make(64, false); /* none is a number */
    for (unsigned k = 0; k < VOXELS; k++)
        put_voxel(&m, 64, DATA, k, NAN);
    OWNED(volume_release) struct volume v = read_made(&m);
    CHECK_HAS(v.notes, "24 voxels are no number");
    CHECK(v.intensity[3] == 0 && v.geometry.slope == 1 && v.geometry.intercept == 0);
}

/* Whole numbers of a type, between `low` and `high`: exact in 16 bits, or to half a step. */
static void check_whole(int datatype, bool big, int64_t low, uint64_t range, uint64_t *chance)
{
    struct made m = make(datatype, big);
    uint64_t above[VOXELS];
    const unsigned width = width_of(datatype);
    for (unsigned i = 0; i < VOXELS; i++) {
        above[i] = i == 3 ? 0 : i == 4 ? range : check_random(chance) % range;
        put(&m, DATA + width * i, (uint64_t)low + above[i], width);
    }
    OWNED(volume_release) struct volume v = read_made(&m);
    const bool fits = low >= 0 && (uint64_t)low + range <= 65535;
    const double step = v.geometry.slope;
    CHECK(v.is_coarse == (range > 65535) && (step == 1) == (range <= 65535));
    CHECK(v.is_coarse == (strstr(v.notes, "of them are one intensity\n") != NULL));
    CHECK(v.geometry.intercept == (fits ? 0 : (double)low) && step < 2 + (double)range / 65535);
    for (unsigned i = 0; i < VOXELS; i++) {
        const double is = v.intensity[i] * step + (fits ? -(double)low : 0);
        CHECK(fabs(is - (double)above[i]) <= (step == 1 ? 0 : step / 2 + (double)range * 1e-15));
    }
}

STORY(whole_numbers_of_any_width_are_exact_where_they_fit)
{
    static const struct {
        int datatype;
        int64_t low;
        uint64_t range;
    } row[] = {
        {8, 0, 65535},
        {8, 7, 14175},
        {8, -5, 65535},
        {8, 100000, 65535},
        {8, 0, 65536},
        {8, INT32_MIN, UINT32_MAX},
        {768, 0, 65535},
        {768, 4000000000, 60000},
        {768, 0, UINT32_MAX},
        {1024, -3, 65535},
        {1024, INT64_MIN, 65535},
        {1024, INT64_MIN, UINT64_MAX},
        {1024, -9, 131071},
        {1280, 0, 65535},
        {1280, 5, 65531},
        {1280, 0, UINT64_MAX},
    };
    uint64_t chance = 21;
    for (size_t i = 0; i < 20 * sizeof row / sizeof row[0]; i++) {
        const size_t k = i % (sizeof row / sizeof row[0]);
        check_whole(row[k].datatype, i % 2, row[k].low, row[k].range, &chance);
    }
}

STORY(a_gzip_cut_short_or_damaged_is_told)
{
    struct made m = make(512, false);
    OWNED(buf_release) struct buf file = {0};
    for (unsigned i = 0; i < 2 * VOXELS; i++)
        m.bytes[DATA + i] = (uint8_t)(i * 37);
    save_packed(packed, m.bytes, m.length);
    CHECK_INT(file_read(&file, packed, 4096, NULL), OK);
    for (size_t length = 2; length < file.length; length++) {
        save(packed, file.data, length);
        CHECK(strlen(refusal_of(packed)) > 0);
    }
    save(packed, file.data, file.length - 3);
    CHECK_HAS(refusal_of(packed), "cut short: it ends within its checksum");
    file.data[file.length - 6] ^= 1;
    save(packed, file.data, file.length);
    CHECK_HAS(refusal_of(packed), "damaged: its gzip data or checksum is wrong");
}

STORY(a_gzip_bomb_is_inflated_no_further_than_its_voxels)
{
    struct made m = make(2, false);
    static uint8_t zeros[1 << 20];
    gzFile file = gzopen(packed, "wb9");
    gzwrite(file, m.bytes, (unsigned)m.length);
    for (int i = 0; i < 100; i++)
        gzwrite(file, zeros, sizeof zeros);
    gzclose(file);
    OWNED(volume_release)
    struct volume v = read_back(packed); /* the first voxels are fine; nothing more is read */
}

STORY(words_of_the_file_never_reach_the_terminal)
{
    struct made m = make(128, false);
    memcpy(m.bytes + DESCRIP, "\033]0;owned\a\n", 11);
    CHECK(strstr(refusal(&m), "owned") == NULL);
    save("\033[31m\n.nii", m.bytes, m.length);
    CHECK_HAS(refusal_of("\033[31m\n.nii"), "\\x1b[31m\\x0a.nii");
    unlink("\033[31m\n.nii");
}

STORY(damaged_files_never_do_harm)
{
    uint64_t chance = 11;
    static const int datatype[] = {2, 4, 512, 16};
    for (int round = 0; round < 6000; round++) {
        struct made m = make(datatype[round % 4], round / 4 % 2);
        struct fault fault = {0};
        OWNED(volume_release) struct volume v = {0};
        for (unsigned flips = 1 + check_below(&chance, 4); flips > 0; flips--)
            m.bytes[check_below(&chance, DATA + 8)] ^= (uint8_t)(1u << check_below(&chance, 8));
        if (round % 3 == 0)
            m.length = check_below(&chance, (uint32_t)m.length + 1);
        const char *path = round % 2 ? plain : packed;
        (round % 2 ? save : save_packed)(path, m.bytes, m.length);
        if (volume_read(&v, path, NULL, NULL, &fault) != OK)
            CHECK(fault.text[0] != '\0' && v.intensity == NULL);
    }
}

STORY(damaged_gzip_never_does_harm)
{
    struct made m = make(512, false);
    OWNED(buf_release) struct buf file = {0};
    uint64_t chance = 12;
    for (unsigned i = 0; i < 2 * VOXELS; i++)
        m.bytes[DATA + i] = (uint8_t)check_random(&chance);
    save_packed(packed, m.bytes, m.length);
    CHECK_INT(file_read(&file, packed, 4096, NULL), OK);
    for (int round = 0; round < 3000; round++) {
        OWNED(volume_release) struct volume v = {0};
        struct fault fault = {0};
        uint32_t at = check_below(&chance, (uint32_t)file.length);
        char kept = file.data[at];
        file.data[at] ^= (char)(1 + check_below(&chance, 255));
        save(packed, file.data, file.length);
        /* A damaged time or padding may pass, but no voxel ever differs. */
        if (volume_read(&v, packed, NULL, NULL, &fault) == OK)
            for (unsigned i = 0; i < VOXELS; i++)
                CHECK_INT(v.intensity[i], m.bytes[DATA + 2 * i] | m.bytes[DATA + 2 * i + 1] << 8);
        file.data[at] = kept;
    }
}

/* ---- writing ---- */

struct asked {
    const uint32_t *size;
    enum voxel_type type;
    uint64_t rows;
    bool in_order;
};

static uint32_t value_at(uint32_t x, uint32_t y, uint32_t z)
{
    return x * 7 + y * 131 + z * 1009 + 70000;
}

static void give_row(void *context, uint32_t y, uint32_t z, void *values)
{
    struct asked *a = context;
    a->in_order = a->in_order && a->rows == y + (uint64_t)a->size[1] * z;
    a->rows++;
    for (uint32_t x = 0; x < a->size[0]; x++) {
        uint32_t v = value_at(x, y, z);
        if (a->type == VOXEL_UINT8)
            ((uint8_t *)values)[x] = (uint8_t)v;
        else if (a->type == VOXEL_UINT16)
            ((uint16_t *)values)[x] = (uint16_t)v;
        else
            ((uint32_t *)values)[x] = v;
    }
}

static enum err write_sample(const char *path, const uint32_t size[3], const struct geometry *g,
                             enum voxel_type type, enum file_mode mode, struct fault *fault)
{
    struct asked asked = {size, type, 0, true};
    enum err err = volume_write(
        path, mode,
        &(struct volume_map){size, g, type, "iftty \xc3\xa4", give_row, &asked, NULL, NULL, NULL},
        NULL, fault);
    CHECK(asked.in_order && (err || asked.rows == (uint64_t)size[1] * size[2]));
    return err;
}

static const struct geometry plain_geometry = {
    .orientation = ORIENTATION_FILE,
    .to_mm = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}},
    .slope = 1,
    .spacing_nm = {1000000, 1000000, 1000000},
    .world_axis = {0, 1, 2},
    .world_sign = {1, 1, 1},
};

STORY(maps_come_back_as_they_were_written)
{
    static const uint32_t size[3] = {37, 11, 5};
    for (int wide = 0; wide < 2; wide++)
        for (int zip = 0; zip < 2; zip++) {
            const enum voxel_type type = wide ? VOXEL_UINT16 : VOXEL_UINT8;
            const char *path = zip ? packed : plain;
            CHECK_INT(write_sample(path, size, &plain_geometry, type, FILE_REPLACE, NULL), OK);
            OWNED(volume_release) struct volume v = read_back(path);
            for (uint32_t i = 0; i < 37 * 11 * 5; i++) {
                uint32_t e = value_at(i % 37, i / 37 % 11, i / 37 / 11);
                CHECK_INT(v.intensity[i], wide ? (uint16_t)e : (uint8_t)e);
            }
            CHECK_INT(v.geometry.sform.code, 1);
        }
}

STORY(a_map_of_32_bits_is_little_endian_after_its_header)
{
    static const uint32_t size[3] = {3, 2, 2};
    OWNED(buf_release) struct buf file = {0};
    CHECK_INT(write_sample(plain, size, &plain_geometry, VOXEL_UINT32, FILE_REPLACE, NULL), OK);
    CHECK_INT(file_read(&file, plain, 4096, NULL), OK);
    CHECK_INT(file.length, 352 + 12 * 4);
    CHECK(memcmp(file.data + DATATYPE, "\0\3\x20\0", 4) == 0); /* 768, 32 bits */
    for (uint32_t i = 0; i < 12 && file.length == 400; i++) {
        const uint8_t *at = (const uint8_t *)file.data + 352 + 4 * i;
        CHECK_INT(at[0] + 256 * (at[1] + 256 * (at[2] + 256 * at[3])),
                  value_at(i % 3, i / 3 % 2, i / 6));
    }
    CHECK_TEXT(file.data + DESCRIP, "iftty \xc3\xa4");
}

STORY(the_place_in_the_world_is_kept)
{
    uint64_t chance = 5;
    static const uint32_t size[3] = {2, 2, 2};
    for (int round = 0; round < 300; round++) {
        struct made m = make(2, false);
        put(&m, QFORM, 3, 2); /* any rotation, with and without a flip */
        put_float(&m, PIXDIM, round % 2 ? -1 : 1);
        for (unsigned i = 0; i < 3; i++) {
            float part = ((float)check_below(&chance, 1001) - 500) / 500 * 0.57f;
            put_float(&m, QUATERN + 4 * i, round < 8 ? (float)(round >> i & 1) * 0.57f : part);
            put_float(&m, QUATERN + 12 + 4 * i, part * 100);
        }
        OWNED(volume_release) struct volume v = read_made(&m), w, only_q;
        v.geometry.fields.given = false; /* as of another format, or a derived grid */
        CHECK_INT(write_sample(plain, size, &v.geometry, VOXEL_UINT8, FILE_REPLACE, NULL), OK);
        CHECK_INT(volume_read(&w, plain, NULL, NULL, NULL), OK);
        CHECK_INT(w.geometry.qform.code, 3);
        OWNED(buf_release) struct buf file = {0};
        CHECK_INT(file_read(&file, plain, 4096, NULL), OK);
        memset(file.data + SFORM, 0, 2); /* now the qform alone has to say it */
        save(plain, file.data, file.length);
        CHECK_INT(volume_read(&only_q, plain, NULL, NULL, NULL), OK);
        for (int i = 0; i < 12; i++) {
            double e = v.geometry.to_mm[i / 4][i % 4];
            CHECK(fabs(w.geometry.to_mm[i / 4][i % 4] - e) < 1e-4);
            CHECK(fabs(only_q.geometry.to_mm[i / 4][i % 4] - e) < 1e-3);
        }
        CHECK(memcmp(v.geometry.spacing_nm, w.geometry.spacing_nm, 12) == 0);
        CHECK(memcmp(v.geometry.world_axis, w.geometry.world_axis, 3) == 0);
    }
}

STORY(a_quaternion_longer_than_1_is_normalised_on_saving)
{
    static const uint32_t size[3] = {NX, NY, NZ};
    static const float given[][3] = {{1.2f, 0, 0},
                                     {0.8f, 0.8f, 0},
                                     {0, 3, 4},
                                     {0.6f, 0.8f, 1e-4f},
                                     {0.70710678f, 0.70710678f, 0}};
    for (unsigned i = 0; i < 5; i++) {
        struct made m = make(2, false);
        put(&m, QFORM, 1, 2);
        for (unsigned k = 0; k < 3; k++)
            put_float(&m, QUATERN + 4 * k, given[i][k]);
        OWNED(volume_release) struct volume v = read_made(&m);
        OWNED(buf_release) struct buf file = {0};
        float q[3];
        CHECK_INT(strstr(v.notes, "its quaternion is longer than 1") != NULL, i < 3);
        CHECK_INT(write_sample(plain, size, &v.geometry, VOXEL_UINT8, FILE_REPLACE, NULL), OK);
        CHECK_INT(file_read(&file, plain, 4096, NULL), OK);
        memcpy(q, file.data + QUATERN, sizeof q);
        const double square = (double)q[0] * q[0] + (double)q[1] * q[1] + (double)q[2] * q[2];
        CHECK(square < 1 + 3e-7);
        CHECK(i < 4 || memcmp(q, given[i], sizeof q) == 0); /* a rounded one is not changed */
        OWNED(volume_release) struct volume again = read_back(plain);
        CHECK(geometry_apart(&v.geometry, &again.geometry, size) < 1e-5);
    }
}

STORY(what_a_file_says_of_its_place_is_written_bit_for_bit)
{
    static const uint32_t size[3] = {NX, NY, NZ};
    static const float odd[] = {0, -1, 0.9570312f, NAN, INFINITY, 1e-30f, 3e38f};
    uint64_t chance = 31;
    for (int round = 0; round < 300; round++) {
        struct made m = make(2, false);
        put(&m, QFORM, check_below(&chance, 6), 2);
        put(&m, SFORM, check_below(&chance, 6), 2);
        m.bytes[UNITS] = (uint8_t)check_below(&chance, 64);
        for (unsigned at = QUATERN; at < SROW + 48; at += 4)
            put_float(&m, at, (float)check_below(&chance, 1000000) / 7.0f - 70000);
        for (unsigned i = 0; i < 4; i++)
            put_float(&m, PIXDIM + 4 * i, (float)(1 + check_below(&chance, 4000)) / 1000.0f);
        if (round % 3 == 0)
            put_float(&m, (round % 2 ? PIXDIM : QUATERN) + 4 * check_below(&chance, 4),
                      odd[check_below(&chance, 7)]);
        OWNED(volume_release) struct volume v = read_made(&m);
        OWNED(buf_release) struct buf file = {0};
        CHECK_INT(write_sample(plain, size, &v.geometry, VOXEL_UINT8, FILE_REPLACE, NULL), OK);
        CHECK_INT(file_read(&file, plain, 4096, NULL), OK);
        /* 0.957031 is 0.9570312 again, whatever the fields hold. Readers of others refuse a
         * quaternion that is longer than 1. */
        float q[3];
        memcpy(q, m.bytes + QUATERN, sizeof q);
        const double square = (double)q[0] * q[0] + (double)q[1] * q[1] + (double)q[2] * q[2];
        for (unsigned i = 0; i < 3 && isfinite(square) && square > 1 + 2e-7; i++)
            put_float(&m, QUATERN + 4 * i, (float)(q[i] / sqrt(square)));
        CHECK(memcmp(file.data + PIXDIM, m.bytes + PIXDIM, 16) == 0);
        CHECK(file.data[UNITS] == (char)m.bytes[UNITS]);
        CHECK(memcmp(file.data + QFORM, m.bytes + QFORM, SROW + 48 - QFORM) == 0);
    }
}

STORY(doubles_of_a_nifti_2_are_written_as_one)
{
    static const uint32_t size[3] = {2, 2, 2};
    for (int wide = 0; wide < 2; wide++) {
        const double third = wide ? 1.0 / 3 : 0.25;
        struct geometry g = plain_geometry;
        OWNED(volume_release) struct volume v;
        g.fields = (struct geometry_fields){.given = true,
                                            .xyzt_units = 2,
                                            .sform_code = 2,
                                            .pixdim = {1, third, 1, 1},
                                            .srow = {{third}, {0, 1}, {0, 0, 1, third}}};
        CHECK_INT(write_sample(plain, size, &g, VOXEL_UINT8, FILE_REPLACE, NULL), OK);
        struct volume_reader reader;
        CHECK_INT(volume_begin(&reader, plain, NULL, NULL, NULL), OK);
        CHECK_TEXT(reader.header.format, wide ? "nifti-2" : "nifti-1");
        volume_close(&reader);
        CHECK_INT(volume_read(&v, plain, NULL, NULL, NULL), OK);
        CHECK(memcmp(&v.geometry.fields.srow, &g.fields.srow, sizeof g.fields.srow) == 0);
        CHECK(v.geometry.fields.pixdim[1] == third);
    }
}

STORY(a_sheared_matrix_is_kept_by_the_sform_alone)
{
    static const uint32_t size[3] = {2, 2, 2};
    struct made m = make(2, false);
    put(&m, QFORM, 2, 2);
    put_sform(&m, (const float[12]){1, 1, 0, 5, 0, 2, 0, 6, 0, 0, 3, 7});
    put(&m, SFORM, 4, 2);
    OWNED(volume_release) struct volume v = read_made(&m), w;
    v.geometry.fields.given = false;
    CHECK_INT(write_sample(plain, size, &v.geometry, VOXEL_UINT8, FILE_REPLACE, NULL), OK);
    CHECK_INT(volume_read(&w, plain, NULL, NULL, NULL), OK);
    CHECK(memcmp(v.geometry.to_mm, w.geometry.to_mm, sizeof v.geometry.to_mm) == 0);
    CHECK(w.geometry.sform.code == 4 && w.geometry.qform.code == 0);
}

STORY(a_side_too_long_for_nifti_1_makes_nifti_2)
{
    static const uint32_t size[3] = {40000, 2, 1};
    CHECK_INT(write_sample(packed, size, &plain_geometry, VOXEL_UINT16, FILE_REPLACE, NULL), OK);
    OWNED(volume_release) struct volume v = read_back(packed);
    CHECK_INT(v.size[0], 40000);
    CHECK(v.intensity && v.intensity[79999] == (uint16_t)value_at(39999, 1, 0));
}

STORY(the_same_map_gives_the_same_gzip)
{
    static const uint32_t size[3] = {30, 30, 30};
    OWNED(buf_release) struct buf first = {0}, second = {0};
    CHECK_INT(write_sample(packed, size, &plain_geometry, VOXEL_UINT16, FILE_REPLACE, NULL), OK);
    CHECK_INT(file_read(&first, packed, 1 << 20, NULL), OK);
    CHECK(memcmp(first.data + 4, "\0\0\0\0", 4) == 0); /* no time */
    sleep(1);
    CHECK_INT(write_sample(packed, size, &plain_geometry, VOXEL_UINT16, FILE_REPLACE, NULL), OK);
    CHECK_INT(file_read(&second, packed, 1 << 20, NULL), OK);
    CHECK(first.length == second.length && memcmp(first.data, second.data, first.length) == 0);
}

STORY(names_and_existing_files_are_checked)
{
    static const uint32_t size[3] = {2, 2, 2};
    static const struct {
        const char *name;
        enum err err;
        const char *words;
    } row[] = {{"a.img", ERR_USAGE, "expected the name of a volume, NIfTI (.nii or .nii.gz)"},
               {".nii", ERR_USAGE, ""},
               {"a.nii", ERR_IO, "exists already"},
               {"none/a.nii", ERR_IO, "there is no folder"}};
    save(plain, "mine", 4);
    for (int i = 0; i < 4; i++) {
        struct fault fault = {0};
        CHECK_INT(write_sample(row[i].name, size, &plain_geometry, VOXEL_UINT8, FILE_KEEP, &fault),
                  row[i].err);
        CHECK_HAS(fault.text, row[i].words);
    }
}

/* A limit on the size of files simulates a full disk: the write itself fails, early or only
 * when the last block is flushed at the close. */
STORY(a_disk_that_fills_leaves_the_former_file)
{
    static const uint32_t size[3] = {300, 300, 20};
    static const rlim_t room[] = {0, 100, 65536, 1000000};
    struct rlimit kept;
    getrlimit(RLIMIT_FSIZE, &kept);
    signal(SIGXFSZ, SIG_IGN);
    save(plain, "mine", 4);
    for (int i = 0; i < 4; i++) {
        struct fault fault = {0};
        struct rlimit tight = {room[i], kept.rlim_max};
        setrlimit(RLIMIT_FSIZE, &tight);
        enum err err =
            write_sample(plain, size, &plain_geometry, VOXEL_UINT8, FILE_REPLACE, &fault);
        setrlimit(RLIMIT_FSIZE, &kept);
        CHECK_INT(err, ERR_IO);
        CHECK_HAS(fault.text, "a.nii: File too large");
    }
    OWNED(buf_release) struct buf file = {0};
    CHECK_INT(file_read(&file, plain, 100, NULL), OK);
    CHECK_TEXT(buf_text(&file), "mine");
}
