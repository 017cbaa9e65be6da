/* SPDX-License-Identifier: MIT */
/*
 * NIfTI: read scenes, write label and cost maps; and ANALYZE 7.5, the format that NIfTI-1 extends.
 *
 * Single files and pairs (image/volume.h) are read, NIfTI-1 and NIfTI-2, plain or gzip, both byte
 * orders; geometry.slope and .intercept include the file's scl_slope and scl_inter.
 *
 * Place of the voxels: the sform if its code is positive and its matrix can be inverted, otherwise
 * the qform under the same conditions. The place is unknown if they contradict each other, or if
 * the file has neither. The sform wins if axes and handedness agree. xyzt_units (metres,
 * millimetres, micrometres) applies to all lengths; without it they are millimetres. A pixdim that
 * is not a number from 1 nm to 4 m above 0 is no distance: the distance is then that of the sform,
 * or unknown. Each of these cases adds a note.
 *
 * Written: little-endian. The geometry fields of a NIfTI scene are written back bit for bit. For
 * other scenes, and derived grids, the sform is to_mm if they have a place in the world, under the
 * code that was read (or the qform's, or 1); the qform is written if it can express the same place,
 * which a sheared matrix cannot. NIfTI-1, or NIfTI-2 if a side is longer than the 32767 voxels of
 * NIfTI-1, or a number longer than its single precision. 79 bytes of the description.
 *
 * From: nifti1.h and nifti2.h at https://nifti.nimh.nih.gov, whose field names are used below.
 */
#include <ctype.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "base/safe.h"
#include "base/scan.h"
#include "engine/grid.h"
#include "image/image_inside.h"
#include "image/names.h"
#include "image/reader_common.h"
#include "image/volume.h"

/* ---- the header as bytes ---- */

/* The two versions of the header, and the position of its magic. */
static const struct version {
    uint16_t bytes, magic, magic_bytes;
    char text[9];
} version[2] = {{348, 344, 4, "n+1\0"}, {540, 4, 8, "n+2\0\r\n\032\n"}};

/* The fields that are read and written, as int64_t or double in struct nifti_header. */
static const struct field {
    size_t member;
    unsigned count;
    enum { INTEGER, REAL, REAL_OR_INTEGER } kind; /* the last: an integer if it has 8 bytes */
    struct {
        uint16_t at, width; /* width: bytes of each number */
    } in[2];                /* by version */
} field[] = {
    {offsetof(struct nifti_header, dim), 8, INTEGER, {{40, 2}, {16, 8}}},
    {offsetof(struct nifti_header, intent_code), 1, INTEGER, {{68, 2}, {504, 4}}},
    {offsetof(struct nifti_header, datatype), 1, INTEGER, {{70, 2}, {12, 2}}},
    {offsetof(struct nifti_header, bitpix), 1, INTEGER, {{72, 2}, {14, 2}}},
    {offsetof(struct nifti_header, fields.pixdim), 4, REAL, {{76, 4}, {104, 8}}},
    {offsetof(struct nifti_header, vox_offset), 1, REAL_OR_INTEGER, {{108, 4}, {168, 8}}},
    {offsetof(struct nifti_header, scl_slope), 1, REAL, {{112, 4}, {176, 8}}},
    {offsetof(struct nifti_header, scl_inter), 1, REAL, {{116, 4}, {184, 8}}},
    {offsetof(struct nifti_header, fields.xyzt_units), 1, INTEGER, {{123, 1}, {500, 4}}},
    {offsetof(struct nifti_header, fields.qform_code), 1, INTEGER, {{252, 2}, {344, 4}}},
    {offsetof(struct nifti_header, fields.sform_code), 1, INTEGER, {{254, 2}, {348, 4}}},
    {offsetof(struct nifti_header, fields.quatern), 3, REAL, {{256, 4}, {352, 8}}},
    {offsetof(struct nifti_header, fields.qoffset), 3, REAL, {{268, 4}, {376, 8}}},
    {offsetof(struct nifti_header, fields.srow), 12, REAL, {{280, 4}, {400, 8}}},
};
enum { FIELDS = sizeof field / sizeof field[0] };
static const uint16_t description_at[2] = {148, 240};

static unsigned version_of(const struct nifti_header *header)
{
    return header->bytes == version[0].bytes ? 0 : 1;
}

static int64_t get_integer(const uint8_t *at, unsigned width, bool big_endian)
{
    const uint64_t sign = UINT64_C(1) << (8 * width - 1);
    return (int64_t)((bits_get(at, width, big_endian) ^ sign) - sign);
}

static bool has_magic(const struct version *v, const uint8_t *bytes, char kind)
{
    char text[sizeof v->text];
    memcpy(text, v->text, sizeof text);
    text[1] = kind;
    return memcmp(bytes + v->magic, text, v->magic_bytes) == 0;
}

/* Find the version by sizeof_hdr; NULL if it is that of neither. */
static const struct version *version_in(const uint8_t *bytes, bool *big_endian)
{
    for (int i = 0; i < 4; i++) {
        *big_endian = i / 2;
        if (bits_get(bytes, 4, *big_endian) == version[i % 2].bytes)
            return &version[i % 2];
    }
    return NULL;
}

static bool recognises(const uint8_t *begin, size_t length)
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
    header->kind = has_magic(v, bytes, '+')   ? NIFTI_SINGLE
                   : has_magic(v, bytes, 'i') ? NIFTI_PAIR
                                              : NIFTI_ANALYZE;
    if (header->kind == NIFTI_ANALYZE && v != version)
        return fault_set(fault, ERR_INPUT,
                         "not a NIfTI file: its magic is neither \"n+2\" nor \"ni2\"");
    header->bytes = v->bytes;
    return OK;
}

static bool is_integer(const struct field *f, unsigned width)
{
    return f->kind == INTEGER || (f->kind == REAL_OR_INTEGER && width == 8);
}

void nifti_header_decode(struct nifti_header *header, const uint8_t *bytes)
{
    const unsigned number = version_of(header);
    const bool big = header->big_endian;
    for (const struct field *f = field; f < field + FIELDS; f++) {
        const unsigned width = f->in[number].width;
        for (size_t i = 0; i < f->count; i++) {
            const uint8_t *at = bytes + f->in[number].at + i * width;
            const int64_t whole = get_integer(at, width, big);
            const double real = is_integer(f, width)
                                    ? (double)whole
                                    : real_of_bits(bits_get(at, width, big), width);
            memcpy((char *)header + f->member + 8 * i,
                   f->kind == INTEGER ? (const void *)&whole : &real, 8);
        }
    }
}

void nifti_header_encode(const struct nifti_header *header, uint8_t *bytes)
{
    const unsigned number = version_of(header);
    const struct version *v = &version[number];
    memset(bytes, 0, v->bytes);
    bits_put(bytes, 4, v->bytes, false);
    memcpy(bytes + v->magic, v->text, v->magic_bytes);
    for (const struct field *f = field; f < field + FIELDS; f++) {
        const unsigned width = f->in[number].width;
        for (size_t i = 0; i < f->count; i++) {
            const char *member = (const char *)header + f->member + 8 * i;
            int64_t whole;
            double real;
            memcpy(&whole, member, 8);
            memcpy(&real, member, 8);
            if (f->kind != INTEGER && is_integer(f, width))
                whole = (int64_t)real;
            bits_put(bytes + f->in[number].at + i * width, width,
                     is_integer(f, width) ? (uint64_t)whole : bits_of_real(real, width), false);
        }
    }
    memcpy(bytes + description_at[number], header->descrip, NIFTI_DESCRIPTION - 1);
}

/* ---- ANALYZE ----
 *
 * ANALYZE 7.5 has a header of the same length as NIfTI-1, which grew from it, with sizes, type,
 * spacing and offset at the same positions. In place of the position in the patient, ANALYZE has
 * names, dates and numbers of the patient, and one byte, `orient`, which most programs write
 * without looking. So its orientation is unknown.
 *
 *     byte 56     4 characters: the unit of length, "mm" if empty
 *     byte 112    float32: factor that SPM applies to the values; 0 for none
 *     byte 116    float32: summand that SPM 2 adds to them
 *     byte 252    orient: 0 to 5
 *
 * From: Mayo Clinic, ANALYZE 7.5 File Format; spm_hread.m and spm_type.m of SPM99 and SPM2. */

enum { UNIT_AT = 56, UNIT_BYTES = 4, ORIENT_AT = 252 };

/* Replace the decoded fields by their meaning in ANALYZE. */
static void convert_analyze(struct nifti_header *header, const uint8_t *bytes, char *notes)
{
    char unit[UNIT_BYTES + 1] = "";
    memcpy(unit, bytes + UNIT_AT, UNIT_BYTES);
    unit[strcspn(unit, " ")] = '\0';
    const double mm = *unit ? length_mm(unit) : 1;
    header->datatype = header->datatype == 130   ? 256 /* int8, added by SPM, */
                       : header->datatype == 132 ? 512 /* uint16 */
                       : header->datatype == 136 ? 768 /* and uint32 */
                                                 : header->datatype;
    if (mm == 0)
        volume_note(notes, "its unit of length is unknown (known: " LENGTH_UNITS ")");
    struct geometry_fields fields = {.xyzt_units = 2 /* millimetres */, .pixdim = {1}};
    for (int a = 1; a <= 3; a++) /* in single precision, as in a map that is saved */
        fields.pixdim[a] = (double)(float)(header->fields.pixdim[a] * mm);
    header->fields = fields;
    volume_note(notes,
                "it is ANALYZE, which does not say which side is left: its orient byte, %u, is not "
                "to be relied on",
                bytes[ORIENT_AT]);
    const bool is_scaled =
        isfinite(header->scl_slope) && isfinite(header->scl_inter) && header->scl_slope != 0;
    if (is_scaled && (header->scl_slope != 1 || header->scl_inter != 0))
        volume_note(notes, "its values are multiplied by %g, then %g is added, as SPM writes it",
                    header->scl_slope, header->scl_inter);
}

/* ---- the place of the voxels, read ---- */

/* Millimetres in the header's unit of length. */
static double unit_mm(const struct nifti_header *header)
{
    const int64_t unit = header->fields.xyzt_units & 7;
    return unit == 1 ? 1000 : unit == 3 ? 0.001 : 1;
}

/* Compute the matrix of the quaternion (a, b, c, d); the file leaves out a >= 0 (nifti1.h, method
 * 2). Numbers that are no rotation give NaN or a singular matrix, which geometry_place refuses. */
static void matrix_of_qform(double to_mm[3][4], const struct nifti_header *header,
                            const double spacing_mm[3], double unit)
{
    double b = header->fields.quatern[0], c = header->fields.quatern[1],
           d = header->fields.quatern[2];
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
    double flip = header->fields.pixdim[0] < 0 ? -1 : 1;
    for (int w = 0; w < 3; w++) {
        for (int i = 0; i < 3; i++)
            to_mm[w][i] = turn[w][i] * spacing_mm[i] * (i == 2 ? flip : 1);
        to_mm[w][3] = header->fields.qoffset[w] * unit;
    }
}

/* Other readers refuse a quaternion that is longer than 1 by more than single precision rounds. It
 * is read and written as one of length 1. */
static void shorten_quaternion(double quatern[3], bool is_used, char *notes)
{
    const double square =
        quatern[0] * quatern[0] + quatern[1] * quatern[1] + quatern[2] * quatern[2];
    if (!isfinite(square) || square <= 1 + 2e-7)
        return;
    for (int i = 0; i < 3; i++)
        quatern[i] = (double)(float)(quatern[i] / sqrt(square));
    if (is_used)
        volume_note(notes, "its quaternion is longer than 1 (%.6g): taken and saved as of length 1",
                    sqrt(square));
}

/* Read the spacing, in whole nanometres and in millimetres. A pixdim that is no distance is noted,
 * and counts as its size or as 1 mm. */
static void read_spacing(struct geometry *geometry, double spacing_mm[3], char *notes,
                         const struct nifti_header *header)
{
    for (int a = 0; a < 3; a++) {
        const double given = header->fields.pixdim[a + 1], mm = fabs(given) * unit_mm(header);
        const bool is_distance = geometry_spacing(&geometry->spacing_nm[a], mm);
        spacing_mm[a] = is_distance ? mm : 1;
        if (is_distance && given > 0)
            continue;
        geometry->spacing_unknown = true;
        volume_note(notes, "pixdim[%d] is %g, which is no distance of voxels", a + 1, given);
    }
    for (int a = 0; a < 3 && geometry->spacing_unknown; a++)
        geometry->spacing_nm[a] = 1000000;
}

static int16_t usable_code(int64_t code)
{
    return code > 0 && code <= INT16_MAX ? (int16_t)code : 0;
}

/* Return true if the form is a way to the world; *axes then has its axes. */
static bool take_form(struct geometry *axes, struct geometry_form *form, const char *name,
                      char *notes)
{
    if (!form->code)
        return false;
    if (geometry_place(axes, (const double(*)[4])form->to_mm, ORIENTATION_UNKNOWN))
        return true;
    volume_note(notes, "its %s (code %d) is no number, or cannot be inverted: it is not used", name,
                form->code);
    form->code = 0;
    return false;
}

/* Compare two forms that can both be used; false if they contradict each other. */
static bool forms_agree(const struct geometry *s, const struct geometry *q, const uint32_t size[3],
                        char *notes)
{
    char by_s[4], by_q[4];
    const double apart_mm = geometry_apart(s, q, size);
    geometry_axes(by_s, s);
    geometry_axes(by_q, q);
    if (!geometry_same_directions(s, q)) {
        volume_note(notes,
                    "its sform and its qform contradict each other: axes towards %s by the sform, "
                    "%s by the qform; `orient sform` or `orient qform` decides",
                    by_s, by_q);
        return false;
    }
    if (apart_mm > geometry_half_voxel(s))
        volume_note(notes, "its sform and its qform differ by up to %.3g mm: the sform is used",
                    apart_mm);
    return true;
}

/* The distances by the sform: they replace a pixdim that is no distance; else they are noted if
 * they differ from it, as those of an sform into a template do. */
static void compare_lengths(struct geometry *geometry, char *notes)
{
    double mm[3];
    uint32_t nm[3];
    bool same = true, all = true;
    for (int a = 0; a < 3; a++) {
        mm[a] = geometry_step_mm(geometry, a);
        all &= geometry_spacing(&nm[a], mm[a]);
        same &= fabs(mm[a] * 1e6 - geometry->spacing_nm[a]) <= 0.01 * geometry->spacing_nm[a];
    }
    if (geometry->spacing_unknown && all) {
        memcpy(geometry->spacing_nm, nm, sizeof nm);
        geometry->spacing_unknown = false;
        volume_note(notes, "the distances of voxels are those of its sform");
    } else if (!geometry->spacing_unknown && !same)
        volume_note(notes,
                    "its sform has voxels of %.6gx%.6gx%.6g mm: lengths are by pixdim, places by "
                    "the sform",
                    mm[0], mm[1], mm[2]);
}

void nifti_header_geometry(struct geometry *geometry, char notes[VOLUME_NOTES_BYTES],
                           const struct nifti_header *header, const uint32_t size[3])
{
    static const double voxels_mm[3] = {1, 1, 1};
    const double unit = unit_mm(header);
    double spacing_mm[3];
    *geometry = (struct geometry){.slope = 1, .fields = header->fields};
    geometry->fields.given = true;
    shorten_quaternion(geometry->fields.quatern, header->fields.qform_code > 0, notes);
    const unsigned unit_code = (unsigned)header->fields.xyzt_units & 7;
    if (unit_code == 0)
        volume_note(notes, "it has no unit of length: millimetres are assumed");
    else if (unit_code > 3)
        volume_note(notes, "its unit of length is %u, which is invalid: millimetres are assumed",
                    unit_code);
    read_spacing(geometry, spacing_mm, notes, header);
    struct geometry_form *sform = &geometry->sform, *qform = &geometry->qform;
    sform->code = usable_code(header->fields.sform_code);
    qform->code = usable_code(header->fields.qform_code);
    for (int w = 0; w < 3; w++)
        for (int i = 0; i < 4; i++)
            sform->to_mm[w][i] = header->fields.srow[w][i] * unit;
    matrix_of_qform(qform->to_mm, header, spacing_mm, unit);
    geometry_place_plain(geometry, geometry->spacing_unknown ? voxels_mm : spacing_mm);
    struct geometry s = *geometry, q = *geometry;
    const bool has_s = take_form(&s, sform, "sform", notes);
    const bool has_q = take_form(&q, qform, "qform", notes);
    if (has_s && has_q && !forms_agree(&s, &q, size, notes))
        return;
    if (has_s || has_q)
        geometry_take_form(geometry, has_s ? ORIENTATION_SFORM : ORIENTATION_QFORM);
    else
        volume_note(notes, "its orientation in the patient is unknown; if you know towards which "
                           "sides its axes run, type them, as in `orient RAS`");
    if (has_s)
        compare_lengths(geometry, notes);
}

/* ---- the place of the voxels, written ---- */

/* Compute the quaternion of a rotation, with a >= 0, by the largest of its four squares, to avoid a
 * division by a small number. */
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
    const int k = largest - 1;                          /* -1: it is a */
    const double sign = k >= 0 && turn[k] < 0 ? -1 : 1; /* a itself is turn[k] * over */
    for (int i = 0; i < 3; i++)
        quatern[i] = k < 0 ? turn[i] * over : sign * (i == k ? root / 2 : even[3 - i - k] * over);
}

/* Fill the qform if it can express the matrix: axes at right angles, as long as the spacing, within
 * single precision. */
static bool place_qform(struct nifti_header *header, const struct geometry *geometry)
{
    const double close = 1e-4;
    double r[3][3];
    for (int i = 0; i < 3; i++)
        for (int w = 0; w < 3; w++)
            r[w][i] = geometry->to_mm[w][i] / header->fields.pixdim[i + 1];
    for (int i = 0; i < 3; i++)
        for (int j = i; j < 3; j++) {
            double dot = r[0][i] * r[0][j] + r[1][i] * r[1][j] + r[2][i] * r[2][j];
            if (!(fabs(dot - (i == j)) < close))
                return false;
        }
    double turned = r[0][2] * (r[1][0] * r[2][1] - r[1][1] * r[2][0]) +
                    r[1][2] * (r[2][0] * r[0][1] - r[2][1] * r[0][0]) +
                    r[2][2] * (r[0][0] * r[1][1] - r[0][1] * r[1][0]);
    header->fields.pixdim[0] = turned < 0 ? -1 : 1;
    for (int w = 0; w < 3; w++) {
        r[w][2] *= header->fields.pixdim[0];
        header->fields.qoffset[w] = geometry->to_mm[w][3];
    }
    quaternion_of(header->fields.quatern, r);
    return true;
}

/* Return true if single precision holds all numbers; NaN is NaN there too. */
static bool fit_single(const double *value, size_t count)
{
    bool fit = true;
    for (size_t i = 0; i < count; i++)
        fit &= isnan(value[i]) || (double)(float)value[i] == value[i];
    return fit;
}

void nifti_header_place(struct nifti_header *header, const struct geometry *geometry)
{
    const struct geometry_fields *fields = &geometry->fields;
    if (fields->given) { /* as they were read, in a NIfTI-2 if no other holds them */
        if (!fit_single(fields->pixdim, 4) || !fit_single(fields->quatern, 3) ||
            !fit_single(fields->qoffset, 3) || !fit_single(&fields->srow[0][0], 12))
            header->bytes = NIFTI_MOST_BYTES;
        header->fields = *fields;
        return;
    }
    enum { MILLIMETRES = 2, SCANNER = 1 };
    const int16_t sform_code = geometry->sform.code, qform_code = geometry->qform.code;
    const int16_t code = sform_code ? sform_code : qform_code ? qform_code : SCANNER;
    header->fields.xyzt_units = MILLIMETRES;
    header->fields.pixdim[0] = 1;
    for (int a = 0; a < 3; a++)
        header->fields.pixdim[a + 1] = geometry->spacing_nm[a] / 1e6;
    if (!geometry_has_place(geometry))
        return;
    header->fields.sform_code = code;
    memcpy(header->fields.srow, geometry->to_mm, sizeof header->fields.srow);
    if (place_qform(header, geometry))
        header->fields.qform_code = qform_code ? qform_code : code;
}

/* ---- reading ---- */

#define BOTH     "; expected both files of the pair"
#define EXCHANGE "; the .hdr and the .img may have each other's names"

enum { ENDING = 4 /* ".hdr" or ".img" */ };

/* Extensions longer than this are an accident or an attack; the longest known have some MB. */
static const double OFFSET_MOST = 256 << 20;

enum { UNREAD = -1 };

#define CHANNEL   "it has colours: take one channel, as `c3d -mcs IN -oo R.nii G.nii B.nii` does"
#define MAGNITUDE "take the magnitude, as `fslcomplex -realabs IN OUT` does"

/* The last row is for every other code. */
static const struct datatype {
    int16_t code;
    const char *name;
    int type;           /* enum voxel_type, or UNREAD: */
    const char *remedy; /* advice for conversion */
} datatypes[] = {
    {2, "uint8", VOXEL_UINT8, NULL},
    {4, "int16", VOXEL_INT16, NULL},
    {8, "int32", VOXEL_INT32, NULL},
    {16, "float32", VOXEL_FLOAT32, NULL},
    {64, "float64", VOXEL_FLOAT64, NULL},
    {256, "int8", VOXEL_INT8, NULL},
    {512, "uint16", VOXEL_UINT16, NULL},
    {768, "uint32", VOXEL_UINT32, NULL},
    {1024, "int64", VOXEL_INT64, NULL},
    {1280, "uint64", VOXEL_UINT64, NULL},
    {1, "binary", UNREAD, "write it as uint8"},
    {32, "complex64", UNREAD, MAGNITUDE},
    {128, "rgb24", UNREAD, CHANNEL},
    {1536, "float128", UNREAD, "write it as float64"},
    {1792, "complex128", UNREAD, MAGNITUDE},
    {2048, "complex256", UNREAD, MAGNITUDE},
    {2304, "rgba32", UNREAD, CHANNEL},
    {0, "unknown", UNREAD, "write whole or real numbers"},
};

static enum err read_fields(struct nifti_header *header, char *notes, struct volume_source *source,
                            struct fault *fault)
{
    uint8_t bytes[NIFTI_MOST_BYTES];
    if (!source->packed && source->bytes < NIFTI_LEAST_BYTES)
        return fault_set(fault, ERR_INPUT,
                         "not a NIfTI file: %" PRIu64 " bytes; expected at least 348 of header",
                         source->bytes);
    *header = (struct nifti_header){0};
    TRY(source_read(source, bytes, NIFTI_LEAST_BYTES, "the header", NULL, fault));
    TRY(nifti_header_recognise(header, bytes, fault));
    TRY(source_read(source, bytes + NIFTI_LEAST_BYTES, header->bytes - NIFTI_LEAST_BYTES,
                    "the header", NULL, fault));
    nifti_header_decode(header, bytes);
    if (header->kind == NIFTI_ANALYZE)
        convert_analyze(header, bytes, notes);
    return OK;
}

/* Read three dimensions, whose grid may be larger than its part; further ones count volumes. */
static enum err read_size(uint32_t size[3], uint32_t *volumes, const struct nifti_header *header,
                          struct fault *fault)
{
    const int64_t *dim = header->dim;
    if (dim[0] < 2 || dim[0] > 7)
        return fault_set(fault, ERR_INPUT, "dim[0] is %" PRId64 "; expected 3 dimensions", dim[0]);
    size[2] = *volumes = 1;
    for (int a = 1; a <= dim[0]; a++) {
        if (dim[a] < 1)
            return fault_set(fault, ERR_INPUT,
                             "dim[%d] is %" PRId64 "; expected at least one voxel", a, dim[a]);
        if (dim[a] > (a > 3 ? UINT32_MAX : GRID_SIDE_MOST) ||
            (a > 3 && __builtin_mul_overflow(*volumes, (uint32_t)dim[a], volumes)))
            return fault_set(fault, ERR_LIMIT, "dim[%d] is %" PRId64 "; expected at most %s", a,
                             dim[a], a > 3 ? "4 billion volumes" : "65534 voxels a side");
        if (a <= 3)
            size[a - 1] = (uint32_t)dim[a];
    }
    return OK;
}

/* Read the scale and the position of voxels of a type that can be read. */
static enum err read_layout(struct volume_header *out, struct nifti_header *header,
                            const struct volume_source *source, struct fault *fault)
{
    const bool is_odd = !isfinite(header->scl_slope) || !isfinite(header->scl_inter);
    if (is_odd)
        volume_note(out->notes, "scl_slope is %g and scl_inter %g: values are not scaled",
                    header->scl_slope, header->scl_inter);
    if (is_odd || header->scl_slope == 0) { /* nifti1.h: then there is no scaling of either kind */
        header->scl_slope = 1;
        header->scl_inter = 0;
    }
    /* Four bytes after the header say whether extensions follow. */
    const double least = header->kind == NIFTI_SINGLE ? (double)header->bytes + 4 : 0;
    const double begin = header->vox_offset == 0 ? least : header->vox_offset;
    if (!(begin >= least && begin <= OFFSET_MOST) || begin != floor(begin))
        return fault_set(fault, ERR_INPUT,
                         "vox_offset is %g; expected a whole number of bytes from %g to %g",
                         header->vox_offset, least, OFFSET_MOST);
    out->offset = (uint64_t)begin;
    const enum err err = voxels_check(out, source, fault);
    if (header->kind == NIFTI_SINGLE) {
        voxels_note_rest(out, source, "does its header say all of its volumes?");
        return err;
    }
    out->bytes = source->bytes;
    voxels_note_rest(out, source, "is this .img the one of this .hdr?");
    return fault_prefix(fault, err, "its .img");
}

/* Fill the header of the volume from the fields; `source` has the voxels. */
static enum err take_fields(struct volume_header *out, struct nifti_header *header,
                            const struct volume_source *source, struct fault *fault)
{
    const int64_t *dim = header->dim, intent = header->intent_code;
    const struct datatype *datatype = datatypes;
    enum err err = OK;
    TRY(read_size(out->size, &out->volumes, header, fault));
    while (datatype->code && datatype->code != header->datatype)
        datatype++;
    snprintf(out->format, sizeof out->format, "%s%s",
             header->kind == NIFTI_ANALYZE        ? "analyze"
             : header->bytes == NIFTI_LEAST_BYTES ? "nifti-1"
                                                  : "nifti-2",
             header->kind == NIFTI_PAIR ? " pair" : "");
    snprintf(out->type_name, sizeof out->type_name, "%s", datatype->name);
    out->big_endian = header->big_endian;
    /* CIFTI has values of grayordinates, points of surfaces and voxels in a list. Its grid is
     * 1x1x1, and the XML in its extension describes them. */
    if (header->kind == NIFTI_SINGLE && intent >= 3000 && intent < 3100 && dim[0] > 4 &&
        dim[1] == 1 && dim[2] == 1 && dim[3] == 1)
        snprintf(out->refusal, sizeof out->refusal,
                 "it is CIFTI, values of grayordinates and of no grid; `wb_command -cifti-separate "
                 "FILE COLUMN -volume-all A.nii` makes a NIfTI of its voxels");
    else if (datatype->type == UNREAD)
        snprintf(out->refusal, sizeof out->refusal, "its voxels are %s (datatype %" PRId64 "); %s",
                 datatype->name, header->datatype, datatype->remedy);
    else {
        out->type = (enum voxel_type)datatype->type;
        err = read_layout(out, header, source, fault);
    }
    nifti_header_geometry(&out->geometry, out->notes, header, out->size);
    out->geometry.slope = header->scl_slope;
    out->geometry.intercept = header->scl_inter;
    return err;
}

/*
 * A single file has extensions between header and voxels if the first of the four bytes after the
 * header is not 0. Each begins with its length, a multiple of 16, and a code. Code 30 is the XML of
 * Caret and Workbench, whose LabelTable has the names of labels; TotalSegmentator writes the same
 * under code 0. A map of labels gets one if a label has a name.
 */

enum { CARET = 30, EXTENSION_HEAD = 8, TABLE_BYTES_MOST = 4 << 20, LABEL_INTENT = 1002 };

static enum err read_names(struct buf *names, const struct volume_header *header,
                           struct volume_source *source, struct fault *fault)
{
    static const char part[] = "its extensions";
    const bool big = header->big_endian, is_second = strcmp(header->format, "nifti-2") == 0;
    const size_t before = names->length;
    uint64_t at = is_second ? NIFTI_MOST_BYTES : NIFTI_LEAST_BYTES;
    uint8_t head[EXTENSION_HEAD] = {0};
    if (!is_second && strcmp(header->format, "nifti-1") != 0)
        return OK; /* a pair */
    TRY(source_go_to(source, at, part, fault));
    TRY(source_read(source, head, 4, part, NULL, fault));
    at += 4;
    for (bool goes_on = head[0]; goes_on && header->offset - at > EXTENSION_HEAD;) {
        TRY(source_read(source, head, sizeof head, part, NULL, fault));
        const uint64_t length = bits_get(head, 4, big), code = bits_get(head + 4, 4, big);
        if (length <= EXTENSION_HEAD || length > header->offset - at)
            return OK;
        at += length;
        if ((code != CARET && code != 0) || length > TABLE_BYTES_MOST) {
            TRY(source_go_to(source, at, part, fault));
            continue;
        }
        OWNED(mem_release) char *xml = mem_new((size_t)length);
        TRY(xml ? source_read(source, xml, (size_t)length - EXTENSION_HEAD, part, NULL, fault)
                : fault_memory(fault, part));
        names_read_xml(names, xml, (size_t)length - EXTENSION_HEAD, header->choice.volume);
        goes_on = names->length == before;
    }
    return OK;
}

/* Append the four bytes after the header, and the extension. */
static void write_names(struct buf *out, const struct volume_map *map)
{
    OWNED(buf_release) struct buf xml = {0};
    uint8_t head[4 + EXTENSION_HEAD] = {0};
    bool has_names = false;
    for (int l = 1; map->label && l < 256; l++)
        has_names |= *map->label[l].name != '\0';
    if (has_names) {
        names_write_xml(&xml, map->label);
        while ((xml.length + EXTENSION_HEAD) % 16 && !xml.failed)
            buf_add_char(&xml, '\n');
        head[0] = 1;
        bits_put(head + 4, 4, xml.length + EXTENSION_HEAD, false);
        bits_put(head + 8, 4, CARET, false);
    }
    buf_add(out, head, has_names ? sizeof head : 4);
    buf_add_text(out, buf_text(&xml));
    out->failed |= xml.failed;
}

/* ---- pairs ---- */

static bool is_voxels(const char *path)
{
    return file_is_named(path, PAIR_VOXELS);
}

bool pair_other(struct buf *other, const char *path)
{
    const char *end = file_ending(path, PAIR_HEADERS "|" PAIR_VOXELS);
    const char *to = is_voxels(path) ? ".hdr" : ".img";
    buf_clear(other);
    if (!end)
        return false;
    const bool is_packed = end[ENDING] != '\0';
    for (int i = 0; i < 3; i++) { /* packed as `path` is, the other way, and if neither is there */
        const bool packs = i == 1 ? !is_packed : is_packed;
        buf_clear(other);
        buf_add(other, path, (size_t)(end - path));
        for (int k = 0; k < ENDING; k++) /* small letters or capitals, as in `path` */
            buf_add_char(other, (char)(isupper((unsigned char)end[k]) ? toupper(to[k]) : to[k]));
        buf_add_text(other, !packs ? "" : is_packed ? end + ENDING : ".gz");
        if (i < 2 && !other->failed && file_exists(buf_text(other)))
            return true;
    }
    return false;
}

/* Read the other file of the pair from now on; the error says its name. */
static enum err go_to_other(struct volume_source *source, bool to_voxels, struct fault *fault)
{
    OWNED(buf_release) struct buf other = {0};
    const bool has_other = pair_other(&other, source->path);
    if (other.failed)
        return fault_memory(fault, "a path");
    if (!has_other)
        return fault_set(
            fault, ERR_IO, "there is no %s next to it, with its %s" BOTH "%s",
            file_name(buf_text(&other)), to_voxels ? "voxels" : "header",
            to_voxels ? "" : "; `open raw:FILE size=X,Y,Z type=T` reads voxels without one");
    return fault_prefix(fault, source_switch(source, buf_text(&other), fault), "%s",
                        file_name(buf_text(&other)));
}

/* Go to the voxels of a pair whose header was read, and fill the header of the volume. */
static enum err take_pair(struct volume_header *out, struct nifti_header *header,
                          struct volume_source *source, struct fault *fault)
{
    TRY(is_voxels(source->path) ? source_switch(source, source->path, fault)
                                : go_to_other(source, true, fault));
    if (header->kind == NIFTI_ANALYZE) { /* SPM writes the place to a file of MATLAB */
        OWNED(buf_release) struct buf matrix = {0};
        buf_add(&matrix, source->path,
                (size_t)(file_ending(source->path, PAIR_HEADERS "|" PAIR_VOXELS) - source->path));
        buf_add_text(&matrix, ".mat");
        if (!matrix.failed && file_exists(buf_text(&matrix)))
            volume_note(out->notes,
                        "the .mat of SPM next to it may have its position; it is not read: "
                        "`nib-convert FILE A.nii` (nibabel) makes a NIfTI of both");
    }
    return take_fields(out, header, source, fault);
}

/* Read a file that begins with a header. */
static enum err read_header(struct volume_header *out, struct volume_source *source,
                            struct fault *fault)
{
    struct nifti_header header;
    enum err err = read_fields(&header, out->notes, source, fault);
    if (err || header.kind == NIFTI_SINGLE)
        return err ? err : take_fields(out, &header, source, fault);
    if (is_voxels(source->path))
        return fault_set(fault, ERR_INPUT,
                         "it begins with a header, and its name is that of the voxels" EXCHANGE);
    if (!file_is_named(source->path, PAIR_HEADERS))
        return fault_set(fault, ERR_INPUT,
                         "the header of a pair, ANALYZE or NIfTI, by its magic, which is neither "
                         "\"n+1\" nor \"n+2\"; expected the names A.hdr and A.img");
    return take_pair(out, &header, source, fault);
}

/* Read a file that belongs to a pair by its name, and that begins with no header. */
static enum err read_without_header(struct volume_header *out, struct volume_source *source,
                                    struct fault *fault)
{
    struct nifti_header header;
    uint8_t begin[NIFTI_LEAST_BYTES];
    if (!is_voxels(source->path)) {
        const bool has_other = go_to_other(source, false, NULL) == OK;
        if (has_other && recognises(begin, source_peek(source, begin, sizeof begin)))
            return fault_set(fault, ERR_INPUT,
                             "it begins with no header, and its .img does" EXCHANGE);
        return fault_set(
            fault, ERR_INPUT,
            "no header of ANALYZE or NIfTI: its first four bytes are neither 348 nor 540");
    }
    TRY(go_to_other(source, false, fault));
    TRY(fault_prefix(fault, read_fields(&header, out->notes, source, fault), "its .hdr"));
    if (header.kind == NIFTI_SINGLE)
        return fault_set(fault, ERR_INPUT, "its .hdr is that of a single file, not of a pair");
    return take_pair(out, &header, source, fault);
}

/* ---- writing ---- */

/* Write the header, the names of labels, then the voxels. */
static enum err write_map(const char *path, enum file_mode mode, const struct volume_map *map,
                          struct watch *watch, struct fault *fault)
{
    uint8_t bytes[NIFTI_MOST_BYTES] = {0};
    OWNED(buf_release) struct buf names = {0};
    struct buf begin = {0};
    struct nifti_header header = {.bytes = NIFTI_LEAST_BYTES, .scl_slope = 1, .dim = {3}};
    for (int a = 1; a < 8; a++) {
        header.dim[a] = a <= 3 ? map->size[a - 1] : 1;
        if (header.dim[a] > INT16_MAX)
            header.bytes = NIFTI_MOST_BYTES;
    }
    const struct datatype *datatype = datatypes;
    while (datatype->type != (int)map->type)
        datatype++;
    header.datatype = datatype->code;
    header.bitpix = INT64_C(8) * voxel_bytes(map->type);
    nifti_header_place(&header, map->geometry);
    header.intent_code = map->label ? LABEL_INTENT : 0;
    write_names(&names, map);
    header.vox_offset = (double)(header.bytes + names.length);
    const size_t length = strnlen(map->description, sizeof header.descrip - 1);
    size_t fits = 0; /* bytes of the description, and never half a character */
    for (size_t n; fits < length; fits += n) {
        n = safe_character(map->description + fits, strlen(map->description + fits));
        n = n ? n : 1;
        if (fits + n > length)
            break;
    }
    memcpy(header.descrip, map->description, fits);
    nifti_header_encode(&header, bytes);
    buf_add(&begin, bytes, header.bytes);
    buf_add(&begin, names.data, names.length);
    begin.failed |= names.failed;
    return voxels_write(path, mode, &begin, file_is_named(path, ".gz") ? PACKED_WHOLE : PACKED_NOT,
                        map, watch, fault);
}

extern const struct volume_format nifti_format;
const struct volume_format nifti_format = {
    .name = "NIfTI",
    .endings = ".nii|.nii.gz",
    .recognises = recognises,
    .read_header = read_header,
    .read_names = read_names,
    .held_by = ".nii|.nii.gz",
    .write = write_map,
};

extern const struct volume_format pair_format;
const struct volume_format pair_format = {
    .name = "ANALYZE",
    .endings = PAIR_HEADERS "|" PAIR_VOXELS,
    .read_header = read_without_header, /* a file with a header belongs to nifti_format */
};
