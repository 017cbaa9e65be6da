/* SPDX-License-Identifier: MIT */
#include "image/image_inside.h"

#include <math.h>
#include <string.h>

#include "image/units.h"

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
    {offsetof(struct nifti_header, intent_code), 1, INTEGER, {{68, 2}, {504, 4}}},
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
    const bool big = header->big_endian;
    for (const struct field *f = field; f < field + FIELDS; f++)
        for (size_t i = 0; i < f->count; i++) {
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
        for (size_t i = 0; i < f->count; i++) {
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

/* ---- ANALYZE ----
 *
 * ANALYZE 7.5: the format that NIfTI-1 grew from, whose header has the same length.
 *
 * Sizes, type, spacing and offset are where NIfTI has them. Where NIfTI has the place of voxels in
 * the patient, ANALYZE has names, dates and numbers of the patient, and one byte, `orient`, which
 * most programs write without looking. So its orientation is unknown.
 *
 *     byte 56     4 characters: the unit of length, "mm" where there is none
 *     byte 112    float32: what SPM multiplies the values by; 0 for none
 *     byte 116    float32: what SPM 2 adds to them
 *     byte 252    orient: 0 to 5
 *
 * From: Mayo Clinic, ANALYZE 7.5 File Format; spm_hread.m and spm_type.m of SPM99 and SPM2. */

enum { UNIT_AT = 56, UNIT_BYTES = 4, ORIENT_AT = 252 };

/* Millimetres in its unit; 0 where that is not known. */
static double analyze_unit_mm(const uint8_t *bytes)
{
    char name[UNIT_BYTES + 1] = "";
    memcpy(name, bytes + UNIT_AT, UNIT_BYTES);
    name[strcspn(name, " ")] = '\0';
    return *name ? length_mm(name) : 1;
}

void nifti_header_take_analyze(struct nifti_header *header, const uint8_t *bytes,
                               char notes[VOLUME_NOTES_BYTES])
{
    const double mm = analyze_unit_mm(bytes);
    header->datatype = header->datatype == 130   ? 256 /* int8, which SPM has added, */
                       : header->datatype == 132 ? 512 /* uint16 */
                       : header->datatype == 136 ? 768 /* and uint32 */
                                                 : header->datatype;
    if (mm == 0)
        volume_note(notes, "its unit of length is none that is known (" LENGTH_UNITS ")");
    header->xyzt_units = 2; /* millimetres */
    header->pixdim[0] = 1;
    for (int a = 1; a <= 3; a++) /* in single precision, as a map that is saved has it */
        header->pixdim[a] = (double)(float)(header->pixdim[a] * mm);
    header->qform_code = header->sform_code = 0;
    memset(header->quatern, 0, sizeof header->quatern);
    memset(header->qoffset, 0, sizeof header->qoffset);
    memset(header->srow, 0, sizeof header->srow);
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

/* ---- where voxels lie ---- */

/* Millimetres in the header's unit of length. */
static double unit_mm(const struct nifti_header *header)
{
    const int64_t unit = header->xyzt_units & 7;
    return unit == 1 ? 1000 : unit == 3 ? 0.001 : 1;
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

/* Readers of others refuse a quaternion longer than 1 by more than single precision rounds; it is
 * read as one of length 1, and so it is written. */
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

/* Spacing in whole nanometres and in millimetres. What is no distance is noted, and counts as its
 * size or as 1 mm. */
static void read_spacing(struct geometry *geometry, double spacing_mm[3], char *notes,
                         const struct nifti_header *header)
{
    for (int a = 0; a < 3; a++) {
        const double given = header->pixdim[a + 1], mm = fabs(given) * unit_mm(header);
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

/* Whether this is a way to the world; its axes are then those of *axes. */
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

/* Both can be used: whether they contradict each other, and what to say of that. */
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
        volume_note(notes, "its sform and its qform lie up to %.3g mm apart: the sform holds",
                    apart_mm);
    return true;
}

/* Where sform and pixdim measure voxels differently, as an sform into a template does. */
static void compare_lengths(const struct geometry *geometry, char *notes)
{
    double mm[3];
    bool same = true;
    for (int a = 0; a < 3; a++) {
        mm[a] = geometry_step_mm(geometry, a);
        same &= fabs(mm[a] * 1e6 - geometry->spacing_nm[a]) <= 0.01 * geometry->spacing_nm[a];
    }
    if (!same)
        volume_note(notes,
                    "its sform has voxels of %.6gx%.6gx%.6g mm: lengths are by pixdim, places by "
                    "the sform",
                    mm[0], mm[1], mm[2]);
}

/* A pixdim that is no distance has the sform say it. */
static void measure_by_sform(struct geometry *geometry, char *notes)
{
    uint32_t nm[3];
    for (int a = 0; a < 3; a++)
        if (!geometry_spacing(&nm[a], geometry_step_mm(geometry, a)))
            return;
    memcpy(geometry->spacing_nm, nm, sizeof nm);
    geometry->spacing_unknown = false;
    volume_note(notes, "the distances of voxels are those of its sform");
}

void nifti_header_geometry(struct geometry *geometry, char notes[VOLUME_NOTES_BYTES],
                           const struct nifti_header *header, const uint32_t size[3])
{
    static const double voxels_mm[3] = {1, 1, 1};
    const double unit = unit_mm(header);
    double spacing_mm[3];
    *geometry = (struct geometry){.slope = 1,
                                  .fields = {.given = true,
                                             .xyzt_units = header->xyzt_units,
                                             .qform_code = header->qform_code,
                                             .sform_code = header->sform_code}};
    struct geometry_fields *fields = &geometry->fields;
    memcpy(fields->pixdim, header->pixdim, sizeof fields->pixdim);
    memcpy(fields->quatern, header->quatern, sizeof fields->quatern);
    shorten_quaternion(fields->quatern, header->qform_code > 0, notes);
    memcpy(fields->qoffset, header->qoffset, sizeof fields->qoffset);
    memcpy(fields->srow, header->srow, sizeof fields->srow);
    const unsigned unit_code = (unsigned)header->xyzt_units & 7;
    if (unit_code == 0)
        volume_note(notes, "it does not say the unit of its lengths: taken as millimetres");
    else if (unit_code > 3)
        volume_note(notes, "the unit of its lengths is %u, which is none: taken as millimetres",
                    unit_code);
    read_spacing(geometry, spacing_mm, notes, header);
    struct geometry_form *sform = &geometry->sform, *qform = &geometry->qform;
    sform->code = usable_code(header->sform_code);
    qform->code = usable_code(header->qform_code);
    for (int w = 0; w < 3; w++)
        for (int i = 0; i < 4; i++)
            sform->to_mm[w][i] = header->srow[w][i] * unit;
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
        volume_note(notes, "it does not say how its voxels lie in the patient; if you know which "
                           "sides their axes run towards, type it, as in `orient RAS`");
    if (has_s && geometry->spacing_unknown)
        measure_by_sform(geometry, notes);
    else if (has_s)
        compare_lengths(geometry, notes);
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

/* Whether single precision holds them all; what is no number is one there too. */
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
    if (fields->given) { /* as they were read; where only a NIfTI-2 holds them, it is one */
        if (!fit_single(fields->pixdim, 4) || !fit_single(fields->quatern, 3) ||
            !fit_single(fields->qoffset, 3) || !fit_single(&fields->srow[0][0], 12))
            header->bytes = NIFTI_MOST_BYTES;
        header->xyzt_units = fields->xyzt_units;
        header->qform_code = fields->qform_code;
        header->sform_code = fields->sform_code;
        memcpy(header->pixdim, fields->pixdim, sizeof fields->pixdim);
        memcpy(header->quatern, fields->quatern, sizeof fields->quatern);
        memcpy(header->qoffset, fields->qoffset, sizeof fields->qoffset);
        memcpy(header->srow, fields->srow, sizeof fields->srow);
        return;
    }
    enum { MILLIMETRES = 2, SCANNER = 1 };
    const int16_t sform_code = geometry->sform.code, qform_code = geometry->qform.code;
    const int16_t code = sform_code ? sform_code : qform_code ? qform_code : SCANNER;
    header->xyzt_units = MILLIMETRES;
    header->pixdim[0] = 1;
    for (int a = 0; a < 3; a++)
        header->pixdim[a + 1] = geometry->spacing_nm[a] / 1e6;
    if (!geometry_has_place(geometry))
        return;
    header->sform_code = code;
    memcpy(header->srow, geometry->to_mm, sizeof header->srow);
    if (place_qform(header, geometry))
        header->qform_code = qform_code ? qform_code : code;
}
