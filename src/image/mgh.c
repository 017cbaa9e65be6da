/* SPDX-License-Identifier: MIT */
/*
 * MGH: the volumes of FreeSurfer, .mgh, or .mgz as gzip; read scenes, write maps.
 *
 * Big-endian. A header of 284 bytes, with 90 in use, and the voxels of one volume after another, x
 * fastest; the rest (scan parameters, the commands that made it) is ignored.
 *
 *     byte  0  int32      version, 1
 *           4  int32[4]   width, height, depth, volumes
 *          20  int32      type: 0 uint8, 1 int32, 3 float32, 4 int16, 10 uint16
 *          24  int32      degrees of freedom, unused here
 *          28  int16      goodRASFlag: the following fields are valid
 *          30  float32[3] distances of voxels, millimetres
 *          42  float32[9] directions of the three axes: to the right, the front and the head
 *          78  float32[3] position of voxel width/2, height/2, depth/2: the middle of the volume
 *
 * After the voxels, five numbers of the scan and then tags, each with its length except for the
 * oldest. Tag 1 is a table of labels, which mri_convert and the programs of recon-all embed:
 *
 *     int32   -2, or the number of entries in version 1, which then has no next but one field
 *     int32   the number after the largest of its labels
 *     text    a name of the table: its length with the NUL, and its bytes
 *     int32   the number of entries
 *     entry   int32 number, text name, int32 red, green, blue and 255 - alpha, each 0 to 255;
 *             in version 1 without the number: it counts from 0
 *
 * Without the flag neither distances nor the place are known: FreeSurfer's readers then assume 1 mm
 * and coronal slices, which is a guess.
 *
 * Written: maps of bytes as uint8, of 16 bits as int32, since uint16 is younger than many readers.
 * The format has no type for unsigned numbers of 32 bits.
 *
 * From: https://surfer.nmr.mgh.harvard.edu/fswiki/FsTutorial/MghFormat
 */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/buf.h"
#include "base/mem.h"
#include "base/scan.h"
#include "engine/grid.h"
#include "image/names.h"
#include "image/volume_format.h"

enum {
    VERSION_AT = 0,
    SIZE_AT = 4,
    TYPE_AT = 20,
    FLAG_AT = 28,
    SPACING_AT = 30,
    HEADER_BYTES = 284
};
enum { VERSION = 1, NUMBERS = 15 /* floats after the flag: */, AXES = 3, MIDDLE = 12 };
enum { UINT8 = 0, INT32 = 1 /* types that are written */ };

static int32_t get_int(const uint8_t *at)
{
    return (int32_t)bits_get(at, 4, true);
}

static void put_int(uint8_t *at, int32_t value)
{
    bits_put(at, 4, (uint32_t)value, true);
}

/* ---- reading ---- */

static const struct type {
    const char *name;
    int32_t code;
    int type; /* enum voxel_type; -1: not read */
} types[] = {
    {"uint8", UINT8, VOXEL_UINT8},
    {"int32", INT32, VOXEL_INT32},
    {"float32", 3, VOXEL_FLOAT32},
    {"int16", 4, VOXEL_INT16},
    {"uint16", 10, VOXEL_UINT16},
    {"int64", 2, -1},
    {"bitmap", 5, -1},
    {"tensor", 6, -1},
    {"complex64", 7, -1},
    {"complex128", 8, -1},
    {"rgb", 9, -1},
};

static const struct type *type_of(int32_t code)
{
    for (size_t i = 0; i < sizeof types / sizeof types[0]; i++)
        if (types[i].code == code)
            return &types[i];
    return NULL;
}

/* The four bytes of the version alone are too common to identify the format. */
static bool recognises(const uint8_t *begin, size_t length)
{
    if (length < HEADER_BYTES || get_int(begin + VERSION_AT) != VERSION)
        return false;
    for (int a = 0; a < 4; a++)
        if (get_int(begin + SIZE_AT + 4 * a) < 1)
            return false;
    return type_of(get_int(begin + TYPE_AT)) != NULL;
}

static void read_geometry(struct volume_header *out, const uint8_t *bytes)
{
    struct geometry *geometry = &out->geometry;
    double number[NUMBERS], to_mm[3][4] = {{0}};
    const bool has_place = bytes[FLAG_AT] < 0x80 && (bytes[FLAG_AT] || bytes[FLAG_AT + 1]);
    *geometry = (struct geometry){.slope = 1};
    for (int i = 0; i < NUMBERS; i++)
        number[i] = real_of_bits(bits_get(bytes + SPACING_AT + 4 * i, 4, true), 4);
    for (int w = 0; w < 3; w++) {
        to_mm[w][3] = number[MIDDLE + w];
        for (int a = 0; a < 3; a++) {
            to_mm[w][a] = number[AXES + 3 * a + w] * number[a];
            to_mm[w][3] -= to_mm[w][a] * out->size[a] / 2;
        }
    }
    header_place(out, (const double(*)[4])to_mm, has_place, has_place);
    for (int a = 0; a < 3 && !geometry->spacing_unknown; a++) {
        /* The stored distances, unless the directions are not of unit length. */
        const double step =
            sqrt(to_mm[0][a] * to_mm[0][a] + to_mm[1][a] * to_mm[1][a] + to_mm[2][a] * to_mm[2][a]);
        uint32_t nm;
        if (fabs(step - number[a]) <= 1e-6 * step && geometry_spacing(&nm, number[a]))
            geometry->spacing_nm[a] = nm;
    }
    if (!has_place)
        volume_note(out->notes,
                    "its goodRASFlag is 0: its spacing and its orientation in the patient are "
                    "unknown; if you know them, open it with spacing=X,Y,Z and type `orient`");
    else if (geometry->spacing_unknown || geometry->orientation == ORIENTATION_UNKNOWN) {
        geometry_place_spaced(geometry);
        volume_note(out->notes,
                    "its position in the patient is invalid: orientation and position are unknown");
    }
}

static enum err read_header(struct volume_header *out, struct volume_source *source,
                            struct fault *fault)
{
    uint8_t bytes[HEADER_BYTES];
    TRY(source_read(source, bytes, sizeof bytes, "the header", NULL, fault));
    const int32_t version = get_int(bytes + VERSION_AT), code = get_int(bytes + TYPE_AT);
    if (version != VERSION)
        return fault_set(fault, ERR_INPUT,
                         "no volume of FreeSurfer: its version is %" PRId32 "; expected 1",
                         version);
    static const char *const name[] = {"width", "height", "depth", "number of volumes"};
    for (int a = 0; a < 4; a++) {
        const int32_t is = get_int(bytes + SIZE_AT + 4 * a);
        if (is < 1)
            return fault_set(fault, ERR_INPUT, "its %s is %" PRId32 "; expected at least 1",
                             name[a], is);
        if (a < 3 && is > GRID_SIDE_MOST)
            return fault_set(fault, ERR_LIMIT, "its %s is %" PRId32 "; expected at most %d voxels",
                             name[a], is, GRID_SIDE_MOST);
        *(a < 3 ? &out->size[a] : &out->volumes) = (uint32_t)is;
    }
    const struct type *type = type_of(code);
    snprintf(out->format, sizeof out->format, "mgh");
    snprintf(out->type_name, sizeof out->type_name, "%s", type ? type->name : "unknown");
    out->big_endian = true;
    out->offset = HEADER_BYTES;
    read_geometry(out, bytes);
    if (!type || type->type < 0) {
        snprintf(out->refusal, sizeof out->refusal,
                 "its voxels are %s (type %" PRId32 "); `mri_convert --out_data_type float` makes "
                 "real numbers of them",
                 out->type_name, code);
        return OK;
    }
    out->type = (enum voxel_type)type->type;
    return voxels_check(out, source, fault);
}

/* ---- names of labels ---- */

enum { TAG_TABLE = 1, TAG_OLD_PLACE = 2, TAG_OLD_SURFACE = 20, TAG_OLD_TRANSFORM = 30 };
enum { SCAN_BYTES = 20, TEXT_MOST = 4096, ENTRIES_MOST = 65536, TABLE_VERSION = 2 };

static bool take_int(struct volume_source *source, int32_t *value, struct fault *fault)
{
    uint8_t bytes[4];
    const enum err err = source_read(source, bytes, sizeof bytes, "its tags", NULL, fault);
    *value = err ? 0 : get_int(bytes);
    return !err;
}

/* Read a text with its length before it. */
static bool take_text(struct volume_source *source, char text[TEXT_MOST], struct fault *fault)
{
    int32_t length;
    if (!take_int(source, &length, fault) || length < 0 || length >= TEXT_MOST)
        return false;
    text[length] = '\0';
    return !source_read(source, text, (size_t)length, "its table", NULL, fault);
}

static bool take_table(struct buf *names, struct volume_source *source, struct fault *fault)
{
    char text[TEXT_MOST];
    int32_t version, entries, number, part[4];
    if (!take_int(source, &version, fault))
        return false;
    entries = version;
    if (version == -TABLE_VERSION && !take_int(source, &entries, fault))
        return false;
    if (!take_text(source, text, fault) || (version < 0 && !take_int(source, &entries, fault)))
        return false;
    bool fits = version >= -TABLE_VERSION && version != -1 && entries <= ENTRIES_MOST;
    for (int32_t i = 0; fits && i < entries; i++) {
        number = i;
        fits = (version > 0 || take_int(source, &number, fault)) && number >= 0 &&
               take_text(source, text, fault);
        for (int k = 0; fits && k < 4; k++)
            fits = take_int(source, &part[k], fault) && part[k] >= 0 && part[k] <= 255;
        if (fits && number > 0)
            names_add(names, (uint32_t)number,
                      (const uint8_t[]){(uint8_t)part[0], (uint8_t)part[1], (uint8_t)part[2]}, text,
                      strlen(text), "");
    }
    return fits;
}

/* Find the table among the tags; a file ends after any of them. */
static enum err read_names(struct buf *names, const struct volume_header *header,
                           struct volume_source *source, struct fault *fault)
{
    uint64_t at = header->offset + SCAN_BYTES +
                  (uint64_t)voxels_in(header->whole) * header->volumes * voxel_bytes(header->type);
    int32_t tag, length[2];
    enum err err = source_go_to(source, at, "its tags", fault);
    while (!err && take_int(source, &tag, NULL) && tag > 0) {
        const bool is_long = tag != TAG_OLD_TRANSFORM;
        at += 4;
        length[0] = length[1] = 0;
        if (tag == TAG_TABLE)
            return take_table(names, source, fault)
                       ? OK
                       : fault_set(fault, ERR_INPUT, "its table of labels is damaged");
        if (tag == TAG_OLD_PLACE || tag == TAG_OLD_SURFACE)
            continue;
        if ((is_long && !take_int(source, &length[0], NULL)) ||
            !take_int(source, &length[1], NULL) || length[0] || length[1] < 0)
            return OK;
        at += (is_long ? 8U : 4U) + (uint64_t)(uint32_t)length[1];
        err = source_go_to(source, at, "its tags", fault);
    }
    return watch_fault(source->watch, fault);
}

static void add_int(struct buf *out, int32_t value)
{
    uint8_t bytes[4];
    put_int(bytes, value);
    buf_add(out, bytes, sizeof bytes);
}

static void add_text(struct buf *out, const char *text)
{
    add_int(out, (int32_t)strlen(text) + 1);
    buf_add(out, text, strlen(text) + 1);
}

/* Write the table after the voxels; nothing if no label has a name. */
static void write_names(struct buf *out, const struct volume_label label[256])
{
    int32_t entries = 0;
    uint32_t last = 0;
    bool has_names = false;
    for (unsigned l; (l = names_next(label, &last)) > 0; entries++)
        has_names |= *label[l].name != '\0';
    if (!has_names)
        return;
    for (int i = 0; i < SCAN_BYTES / 4; i++)
        add_int(out, 0);
    add_int(out, TAG_TABLE);
    add_int(out, -TABLE_VERSION);
    add_int(out, (int32_t)last + 1);
    add_text(out, "iftty");
    add_int(out, entries);
    last = 0;
    for (unsigned l; (l = names_next(label, &last)) > 0;) {
        add_int(out, (int32_t)label[l].number);
        add_text(out, label[l].name);
        for (int k = 0; k < 3; k++)
            add_int(out, label[l].rgb[k]);
        add_int(out, 0);
    }
}

/* ---- writing ---- */

static void put_place(uint8_t *bytes, const struct geometry *geometry, const uint32_t size[3])
{
    double number[NUMBERS] = {0};
    if (!geometry_has_place(geometry))
        return;
    for (int a = 0; a < 3; a++) { /* in single precision; as it was read if the matrix agrees */
        const double step = geometry_step_mm(geometry, a), said = geometry->spacing_nm[a] / 1e6;
        number[a] = (double)(float)(fabs(step - said) <= 1e-6 * step ? said : step);
    }
    for (int w = 0; w < 3; w++) {
        number[MIDDLE + w] = geometry->to_mm[w][3];
        for (int a = 0; a < 3; a++) {
            number[AXES + 3 * a + w] = geometry->to_mm[w][a] / number[a];
            number[MIDDLE + w] += geometry->to_mm[w][a] * size[a] / 2;
        }
    }
    bytes[FLAG_AT + 1] = 1;
    for (int i = 0; i < NUMBERS; i++)
        bits_put(bytes + SPACING_AT + 4 * i, 4, bits_of_real(number[i], 4), true);
}

/* Widen a row of 16 bits to 32, and swap its bytes: voxels_write is little-endian. */
static void widen_row(void *context, uint32_t y, uint32_t z, void *values)
{
    const struct volume_map *map = context;
    const uint16_t *narrow = values;
    uint32_t *wide = values;
    map->row(map->context, y, z, values);
    for (uint32_t x = map->size[0]; x-- > 0;) {
        uint16_t value;
        memcpy(&value, narrow + x, sizeof value);
        memcpy(wide + x, &(uint32_t){__builtin_bswap32(value)}, sizeof *wide);
    }
}

static enum err write_map(const char *path, enum file_mode mode, const struct volume_map *map,
                          struct watch *watch, struct fault *fault)
{
    uint8_t bytes[HEADER_BYTES] = {0};
    struct volume_map written = *map, narrow = *map;
    OWNED(buf_release) struct buf tail = {0};
    struct buf header = {0};
    if (map->type == VOXEL_UINT32)
        return fault_set(fault, ERR_USAGE,
                         "cannot write %s: FreeSurfer's files hold no numbers up to 4294967295; "
                         "expected .nii.gz, .nrrd or .mha for this map",
                         path);
    if (map->type == VOXEL_UINT16) {
        written.type = VOXEL_INT32;
        written.row = widen_row;
        written.context = &narrow;
    }
    put_int(bytes + VERSION_AT, VERSION);
    for (int a = 0; a < 4; a++)
        put_int(bytes + SIZE_AT + 4 * a, a < 3 ? (int32_t)map->size[a] : 1);
    put_int(bytes + TYPE_AT, map->type == VOXEL_UINT8 ? UINT8 : INT32);
    put_place(bytes, map->geometry, map->size);
    buf_add(&header, bytes, sizeof bytes);
    if (map->label)
        write_names(&tail, map->label);
    header.failed |= tail.failed;
    written.tail = &tail;
    return voxels_write(path, mode, &header,
                        file_is_named(path, ".mgh") ? PACKED_NOT : PACKED_WHOLE, &written, watch,
                        fault);
}

extern const struct volume_format mgh_format;
const struct volume_format mgh_format = {
    .name = "MGH of FreeSurfer",
    .endings = ".mgh|.mgz|.mgh.gz",
    .recognises = recognises,
    .read_header = read_header,
    .read_names = read_names,
    .held_by = ".mgh|.mgz|.mgh.gz",
    .write = write_map,
};
