#include "image/nifti_header.h"

#include <math.h>
#include <string.h>

/* Where each field lies, and how many bytes a number of its kind takes. */
struct layout {
    uint16_t bytes, magic, magic_bytes;
    uint16_t dim, dim_width;
    uint16_t datatype, bitpix; /* 2 bytes in both */
    uint16_t pixdim, real_width;
    uint16_t vox_offset;
    uint16_t scl_slope, scl_inter;
    uint16_t xyzt_units, units_width;
    uint16_t qform_code, sform_code, code_width;
    uint16_t quatern, qoffset, srow;
    uint16_t descrip;
    char text[9];
};

static const struct layout LAYOUT_1 = {
    .bytes = 348,
    .magic = 344,
    .magic_bytes = 4,
    .dim = 40,
    .dim_width = 2,
    .datatype = 70,
    .bitpix = 72,
    .pixdim = 76,
    .real_width = 4,
    .vox_offset = 108,
    .scl_slope = 112,
    .scl_inter = 116,
    .xyzt_units = 123,
    .units_width = 1,
    .qform_code = 252,
    .sform_code = 254,
    .code_width = 2,
    .quatern = 256,
    .qoffset = 268,
    .srow = 280,
    .descrip = 148,
    .text = "n+1\0",
};
static const struct layout LAYOUT_2 = {
    .bytes = 540,
    .magic = 4,
    .magic_bytes = 8,
    .dim = 16,
    .dim_width = 8,
    .datatype = 12,
    .bitpix = 14,
    .pixdim = 104,
    .real_width = 8,
    .vox_offset = 168,
    .scl_slope = 176,
    .scl_inter = 184,
    .xyzt_units = 500,
    .units_width = 4,
    .qform_code = 344,
    .sform_code = 348,
    .code_width = 4,
    .quatern = 352,
    .qoffset = 376,
    .srow = 400,
    .descrip = 240,
    .text = "n+2\0\r\n\032\n",
};

static const struct layout *layout_of(const struct nifti_header *header)
{
    return header->bytes == LAYOUT_1.bytes ? &LAYOUT_1 : &LAYOUT_2;
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

static bool has_magic(const struct layout *layout, const uint8_t *bytes, char kind)
{
    char text[sizeof layout->text];
    memcpy(text, layout->text, sizeof text);
    text[1] = kind;
    return memcmp(bytes + layout->magic, text, layout->magic_bytes) == 0;
}

/* By sizeof_hdr; NULL where it is that of neither. */
static const struct layout *layout_in(const uint8_t *bytes, bool *big_endian)
{
    for (int big = 0; big < 2; big++) {
        const uint64_t size = get_bits(bytes, 4, big);
        *big_endian = big;
        if (size == LAYOUT_1.bytes || size == LAYOUT_2.bytes)
            return size == LAYOUT_1.bytes ? &LAYOUT_1 : &LAYOUT_2;
    }
    return NULL;
}

bool nifti_header_is_one(const uint8_t *begin, size_t length)
{
    bool big_endian;
    return length >= NIFTI_LEAST_BYTES && layout_in(begin, &big_endian);
}

enum err nifti_header_recognise(struct nifti_header *header, const uint8_t *bytes,
                                struct fault *fault)
{
    const struct layout *layout = layout_in(bytes, &header->big_endian);
    if (!layout)
        return fault_set(fault, ERR_INPUT,
                         "not a NIfTI file: sizeof_hdr is %lld; expected 348 or 540",
                         (long long)get_integer(bytes, 4, false));
    if (has_magic(layout, bytes, 'i'))
        return fault_set(fault, ERR_INPUT,
                         "the header of a .hdr/.img pair; expected a single .nii or .nii.gz file");
    if (!has_magic(layout, bytes, '+'))
        return fault_set(fault, ERR_INPUT,
                         "not a NIfTI file: its magic is neither \"n+1\" nor \"n+2\" (an ANALYZE "
                         "header has none)");
    header->bytes = layout->bytes;
    return OK;
}

void nifti_header_decode(struct nifti_header *header, const uint8_t *bytes)
{
    const struct layout *at = layout_of(header);
    const bool big = header->big_endian;
    const unsigned real = at->real_width;
    for (unsigned i = 0; i < 8; i++) {
        header->dim[i] = get_integer(bytes + at->dim + i * at->dim_width, at->dim_width, big);
        header->pixdim[i] = get_real(bytes + at->pixdim + i * real, real, big);
    }
    header->datatype = get_integer(bytes + at->datatype, 2, big);
    header->bitpix = get_integer(bytes + at->bitpix, 2, big);
    header->vox_offset = at == &LAYOUT_1 ? get_real(bytes + at->vox_offset, 4, big)
                                         : (double)get_integer(bytes + at->vox_offset, 8, big);
    header->scl_slope = get_real(bytes + at->scl_slope, real, big);
    header->scl_inter = get_real(bytes + at->scl_inter, real, big);
    header->xyzt_units = get_integer(bytes + at->xyzt_units, at->units_width, big);
    header->qform_code = get_integer(bytes + at->qform_code, at->code_width, big);
    header->sform_code = get_integer(bytes + at->sform_code, at->code_width, big);
    for (unsigned a = 0; a < 3; a++) {
        header->quatern[a] = get_real(bytes + at->quatern + a * real, real, big);
        header->qoffset[a] = get_real(bytes + at->qoffset + a * real, real, big);
        for (unsigned i = 0; i < 4; i++)
            header->srow[a][i] = get_real(bytes + at->srow + (4 * a + i) * real, real, big);
    }
}

void nifti_header_encode(const struct nifti_header *header, uint8_t *bytes)
{
    const struct layout *at = layout_of(header);
    const unsigned real = at->real_width;
    memset(bytes, 0, at->bytes);
    put_integer(bytes, 4, at->bytes);
    memcpy(bytes + at->magic, at->text, at->magic_bytes);
    for (unsigned i = 0; i < 8; i++) {
        put_integer(bytes + at->dim + i * at->dim_width, at->dim_width, header->dim[i]);
        put_real(bytes + at->pixdim + i * real, real, header->pixdim[i]);
    }
    put_integer(bytes + at->datatype, 2, header->datatype);
    put_integer(bytes + at->bitpix, 2, header->bitpix);
    if (at == &LAYOUT_1)
        put_real(bytes + at->vox_offset, 4, header->vox_offset);
    else
        put_integer(bytes + at->vox_offset, 8, (int64_t)header->vox_offset);
    put_real(bytes + at->scl_slope, real, header->scl_slope);
    put_real(bytes + at->scl_inter, real, header->scl_inter);
    put_integer(bytes + at->xyzt_units, at->units_width, header->xyzt_units);
    put_integer(bytes + at->qform_code, at->code_width, header->qform_code);
    put_integer(bytes + at->sform_code, at->code_width, header->sform_code);
    for (unsigned a = 0; a < 3; a++) {
        put_real(bytes + at->quatern + a * real, real, header->quatern[a]);
        put_real(bytes + at->qoffset + a * real, real, header->qoffset[a]);
        for (unsigned i = 0; i < 4; i++)
            put_real(bytes + at->srow + (4 * a + i) * real, real, header->srow[a][i]);
    }
    memcpy(bytes + at->descrip, header->descrip, NIFTI_DESCRIPTION - 1);
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
 * What cannot be a rotation comes out as NaN or singular and is refused by geometry_place. */
static void matrix_of_qform(double to_mm[3][4], const struct nifti_header *header,
                            const double spacing_mm[3], double unit)
{
    double b = header->quatern[0], c = header->quatern[1], d = header->quatern[2];
    double rest = 1 - (b * b + c * c + d * d);
    double a = rest > 0 ? sqrt(rest) : 0;
    if (rest < 1e-7) { /* half a turn, told in single precision: make b, c, d a unit vector */
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

/* Spacing in whole nanometres and in millimetres; see nifti.h for what is let pass. */
static enum err read_spacing(struct geometry *geometry, double spacing_mm[3],
                             const struct nifti_header *header, struct fault *fault)
{
    for (int a = 0; a < 3; a++) {
        double mm = fabs(header->pixdim[a + 1]) * unit_mm(header);
        if (mm == 0)
            mm = 1;
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

static int16_t kept_code(int64_t code)
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
    geometry->sform_code = kept_code(header->sform_code);
    geometry->qform_code = kept_code(header->qform_code);
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
 * spacing, within what single precision tells apart. */
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
