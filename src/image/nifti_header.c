#include "image/nifti_header.h"

#include <math.h>
#include <string.h>

/* The two versions of the header, and where each has its magic. */
static const struct version {
    uint16_t bytes, magic, magic_bytes;
    char text[9];
} version[2] = {{348, 344, 4, "n+1\0"}, {540, 4, 8, "n+2\0\r\n\032\n"}};

/* Where a version has a field, and how many bytes each of its numbers takes. */
struct place_in_file {
    uint16_t at, width;
};

/* The fields that are read and written, as int64_t or double in struct nifti_header. */
static const struct field {
    size_t member;
    unsigned count;
    enum { INTEGER, REAL, REAL_OR_INTEGER } kind; /* the last: an integer where it has 8 bytes */
    struct place_in_file in[2];                   /* by version */
} field[] = {
    {offsetof(struct nifti_header, dim), 8, INTEGER, {{40, 2}, {16, 8}}},
    {offsetof(struct nifti_header, datatype), 1, INTEGER, {{70, 2}, {12, 2}}},
    {offsetof(struct nifti_header, bitpix), 1, INTEGER, {{72, 2}, {14, 2}}},
    {offsetof(struct nifti_header, pixdim), 8, REAL, {{76, 4}, {104, 8}}},
    {offsetof(struct nifti_header, vox_offset), 1, REAL_OR_INTEGER, {{108, 4}, {168, 8}}},
    {offsetof(struct nifti_header, scl_slope), 1, REAL, {{112, 4}, {176, 8}}},
    {offsetof(struct nifti_header, scl_inter), 1, REAL, {{116, 4}, {184, 8}}},
    {offsetof(struct nifti_header, xyzt_units), 1, INTEGER, {{123, 1}, {500, 4}}},
    {offsetof(struct nifti_header, qform_code), 1, INTEGER, {{252, 2}, {344, 4}}},
    {offsetof(struct nifti_header, sform_code), 1, INTEGER, {{254, 2}, {348, 4}}},
    {offsetof(struct nifti_header, quatern), 3, REAL, {{256, 4}, {352, 8}}},
    {offsetof(struct nifti_header, qoffset), 3, REAL, {{268, 4}, {376, 8}}},
    {offsetof(struct nifti_header, srow), 12, REAL, {{280, 4}, {400, 8}}},
};
enum { FIELDS = sizeof field / sizeof field[0] };
static const uint16_t description_at[2] = {148, 240};

static unsigned version_of(const struct nifti_header *header)
{
    return header->bytes == version[0].bytes ? 0 : 1;
}

static uint64_t get_bits(const uint8_t *at, unsigned width, bool big_endian)
{
    uint64_t bits = 0;
    for (unsigned i = 0; i < width; i++)
        bits = bits << 8 | at[big_endian ? i : width - 1 - i];
    return bits;
}

static int64_t get_integer(const uint8_t *at, unsigned width, bool big_endian)
{
    uint64_t sign = UINT64_C(1) << (8 * width - 1);
    uint64_t bits = get_bits(at, width, big_endian);
    int64_t value;
    bits = (bits ^ sign) - sign;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static double get_real(const uint8_t *at, unsigned width, bool big_endian)
{
    uint64_t bits = get_bits(at, width, big_endian);
    uint32_t narrow = (uint32_t)bits;
    double value;
    float single;
    if (width == sizeof value) {
        memcpy(&value, &bits, sizeof value);
        return value;
    }
    memcpy(&single, &narrow, sizeof single);
    return (double)single;
}

static void put_integer(uint8_t *at, unsigned width, int64_t value)
{
    uint64_t bits = (uint64_t)value;
    for (unsigned i = 0; i < width; i++)
        at[i] = (uint8_t)(bits >> 8 * i);
}

static void put_real(uint8_t *at, unsigned width, double value)
{
    uint64_t bits;
    float single = (float)value;
    uint32_t narrow;
    memcpy(&bits, &value, sizeof bits);
    memcpy(&narrow, &single, sizeof narrow);
    put_integer(at, width, (int64_t)(width == sizeof value ? bits : narrow));
}

static bool has_magic(const struct version *v, const uint8_t *bytes, char kind)
{
    char text[sizeof v->text];
    memcpy(text, v->text, sizeof text);
    text[1] = kind;
    return memcmp(bytes + v->magic, text, v->magic_bytes) == 0;
}

/* By sizeof_hdr; NULL where it is that of neither. */
static const struct version *version_in(const uint8_t *bytes, bool *big_endian)
{
    for (int i = 0; i < 4; i++) {
        *big_endian = i / 2;
        if (get_bits(bytes, 4, *big_endian) == version[i % 2].bytes)
            return &version[i % 2];
    }
    return NULL;
}

bool nifti_header_is_one(const uint8_t *begin, size_t length)
{
    bool big_endian;
    return length >= NIFTI_LEAST_BYTES && version_in(begin, &big_endian);
}

enum err nifti_header_recognise(struct nifti_header *header, const uint8_t *bytes,
                                struct fault *fault)
{
    const struct version *v = version_in(bytes, &header->big_endian);
    if (!v)
        return fault_set(fault, ERR_INPUT,
                         "not a NIfTI file: sizeof_hdr is %lld; expected 348 or 540",
                         (long long)get_integer(bytes, 4, false));
    if (has_magic(v, bytes, 'i'))
        return fault_set(fault, ERR_INPUT,
                         "the header of a .hdr/.img pair; expected a single .nii or .nii.gz file");
    if (!has_magic(v, bytes, '+'))
        return fault_set(fault, ERR_INPUT,
                         "not a NIfTI file: its magic is neither \"n+1\" nor \"n+2\" (an ANALYZE "
                         "header has none)");
    header->bytes = v->bytes;
    return OK;
}

static bool is_integer(const struct field *f, unsigned width)
{
    return f->kind == INTEGER || (f->kind == REAL_OR_INTEGER && width == 8);
}

void nifti_header_decode(struct nifti_header *header, const uint8_t *bytes)
{
    const bool big = header->big_endian;
    for (const struct field *f = field; f < field + FIELDS; f++)
        for (unsigned i = 0; i < f->count; i++) {
            const struct place_in_file in = f->in[version_of(header)];
            const uint8_t *at = bytes + in.at + i * in.width;
            char *member = (char *)header + f->member + 8 * i;
            const int64_t whole = is_integer(f, in.width) ? get_integer(at, in.width, big) : 0;
            const double real =
                is_integer(f, in.width) ? (double)whole : get_real(at, in.width, big);
            memcpy(member, f->kind == INTEGER ? (const void *)&whole : &real, 8);
        }
}

void nifti_header_encode(const struct nifti_header *header, uint8_t *bytes)
{
    const unsigned number = version_of(header);
    const struct version *v = &version[number];
    memset(bytes, 0, v->bytes);
    put_integer(bytes, 4, v->bytes);
    memcpy(bytes + v->magic, v->text, v->magic_bytes);
    for (const struct field *f = field; f < field + FIELDS; f++)
        for (unsigned i = 0; i < f->count; i++) {
            const struct place_in_file in = f->in[number];
            uint8_t *at = bytes + in.at + i * in.width;
            const char *member = (const char *)header + f->member + 8 * i;
            int64_t whole;
            double real;
            memcpy(&whole, member, 8);
            memcpy(&real, member, 8);
            if (!is_integer(f, in.width))
                put_real(at, in.width, real);
            else
                put_integer(at, in.width, f->kind == INTEGER ? whole : (int64_t)real);
        }
    memcpy(bytes + description_at[number], header->descrip, NIFTI_DESCRIPTION - 1);
}

/* Millimetres in the header's unit of length. */
static double unit_mm(const struct nifti_header *header)
{
    switch (header->xyzt_units & 7) {
    case 1:
        return 1000;
    case 3:
        return 0.001;
    default:
        return 1;
    }
}

/* The matrix of the quaternion (a, b, c, d), whose a >= 0 the file leaves out; nifti1.h, method 2.
 * Numbers that are no rotation come out as NaN or singular and are refused by geometry_place. */
static void matrix_of_qform(double to_mm[3][4], const struct nifti_header *header,
                            const double spacing_mm[3], double unit)
{
    double b = header->quatern[0], c = header->quatern[1], d = header->quatern[2];
    double rest = 1 - (b * b + c * c + d * d);
    double a = rest > 0 ? sqrt(rest) : 0;
    if (rest < 1e-7) { /* half a turn, written in single precision: make b, c, d a unit vector */
        double length = sqrt(b * b + c * c + d * d);
        a = 0;
        b /= length;
        c /= length;
        d /= length;
    }
    const double turn[3][3] = {
        {a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c)},
        {2 * (b * c + a * d), a * a + c * c - b * b - d * d, 2 * (c * d - a * b)},
        {2 * (b * d - a * c), 2 * (c * d + a * b), a * a + d * d - b * b - c * c},
    };
    double flip = header->pixdim[0] < 0 ? -1 : 1;
    for (int w = 0; w < 3; w++) {
        for (int i = 0; i < 3; i++)
            to_mm[w][i] = turn[w][i] * spacing_mm[i] * (i == 2 ? flip : 1);
        to_mm[w][3] = header->qoffset[w] * unit;
    }
}

/* Spacing in whole nanometres and in millimetres; see nifti.c for what is accepted. */
static enum err read_spacing(struct geometry *geometry, double spacing_mm[3],
                             const struct nifti_header *header, struct fault *fault)
{
    for (int a = 0; a < 3; a++) {
        double mm = fabs(header->pixdim[a + 1]) * unit_mm(header);
        if (mm == 0) {
            mm = 1;
            geometry->spacing_assumed = true;
        }
        double nm = floor(mm * 1e6 + 0.5);
        if (!(nm >= 1 && nm <= 4e9))
            return fault_set(fault, ERR_INPUT,
                             "pixdim[%d] is %g; expected a distance of voxels from 1 nm to 4 m",
                             a + 1, header->pixdim[a + 1]);
        geometry->spacing_nm[a] = (uint32_t)nm;
        spacing_mm[a] = mm;
    }
    return OK;
}

static int16_t usable_code(int64_t code)
{
    return code > 0 && code <= INT16_MAX ? (int16_t)code : 0;
}

enum err nifti_header_geometry(struct geometry *geometry, const struct nifti_header *header,
                               struct fault *fault)
{
    const double unit = unit_mm(header);
    double spacing_mm[3], sform[3][4], qform[3][4];
    *geometry = (struct geometry){.slope = 1};
    enum err err = read_spacing(geometry, spacing_mm, header, fault);
    if (err)
        return err;
    geometry->sform_code = usable_code(header->sform_code);
    geometry->qform_code = usable_code(header->qform_code);
    for (int w = 0; w < 3; w++)
        for (int i = 0; i < 4; i++)
            sform[w][i] = header->srow[w][i] * unit;
    matrix_of_qform(qform, header, spacing_mm, unit);
    if (geometry->sform_code && geometry_place(geometry, (const double(*)[4])sform))
        return OK;
    geometry->sform_code = 0;
    if (geometry->qform_code && geometry_place(geometry, (const double(*)[4])qform))
        return OK;
    geometry->qform_code = 0;
    geometry_place_plain(geometry, spacing_mm);
    return OK;
}

/* The quaternion of a rotation with a >= 0, by the largest of its four squares, so that no small
 * number is divided by. */
static void quaternion_of(double quatern[3], double r[3][3])
{
    double square[4] = {1 + r[0][0] + r[1][1] + r[2][2], 1 + r[0][0] - r[1][1] - r[2][2],
                        1 - r[0][0] + r[1][1] - r[2][2], 1 - r[0][0] - r[1][1] + r[2][2]};
    int largest = 0;
    for (int i = 1; i < 4; i++)
        if (square[i] > square[largest])
            largest = i;
    double root = sqrt(square[largest]), over = 0.5 / root;
    double turn[3] = {r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1]};
    double even[3] = {r[2][1] + r[1][2], r[0][2] + r[2][0], r[1][0] + r[0][1]};
    if (largest == 0) {
        for (int i = 0; i < 3; i++)
            quatern[i] = turn[i] * over;
        return;
    }
    int k = largest - 1;
    double sign = turn[k] < 0 ? -1 : 1; /* a itself is turn[k] * over */
    for (int i = 0; i < 3; i++)
        quatern[i] = sign * (i == k ? root / 2 : even[3 - i - k] * over);
}

/* Fills the qform where it can say what the matrix says: axes at right angles, as long as the
 * spacing, within single precision. */
static bool place_qform(struct nifti_header *header, const struct geometry *geometry)
{
    const double close = 1e-4;
    double r[3][3];
    for (int i = 0; i < 3; i++)
        for (int w = 0; w < 3; w++)
            r[w][i] = geometry->to_mm[w][i] / header->pixdim[i + 1];
    for (int i = 0; i < 3; i++)
        for (int j = i; j < 3; j++) {
            double dot = r[0][i] * r[0][j] + r[1][i] * r[1][j] + r[2][i] * r[2][j];
            if (!(fabs(dot - (i == j)) < close))
                return false;
        }
    double turned = r[0][2] * (r[1][0] * r[2][1] - r[1][1] * r[2][0]) +
                    r[1][2] * (r[2][0] * r[0][1] - r[2][1] * r[0][0]) +
                    r[2][2] * (r[0][0] * r[1][1] - r[0][1] * r[1][0]);
    header->pixdim[0] = turned < 0 ? -1 : 1;
    for (int w = 0; w < 3; w++) {
        r[w][2] *= header->pixdim[0];
        header->qoffset[w] = geometry->to_mm[w][3];
    }
    quaternion_of(header->quatern, r);
    return true;
}

void nifti_header_place(struct nifti_header *header, const struct geometry *geometry)
{
    enum { MILLIMETRES = 2, SCANNER = 1 };
    int16_t code = geometry->sform_code   ? geometry->sform_code
                   : geometry->qform_code ? geometry->qform_code
                                          : SCANNER;
    header->xyzt_units = MILLIMETRES;
    header->pixdim[0] = 1;
    for (int a = 0; a < 3; a++)
        header->pixdim[a + 1] = geometry->spacing_nm[a] / 1e6;
    header->sform_code = code;
    memcpy(header->srow, geometry->to_mm, sizeof header->srow);
    if (place_qform(header, geometry))
        header->qform_code = geometry->qform_code ? geometry->qform_code : code;
}
