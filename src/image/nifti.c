/* SPDX-License-Identifier: MIT */
/*
 * NIfTI: scenes in, label and cost maps out; and ANALYZE 7.5, of which it is made.
 *
 * Single files and pairs (nifti.h) are read, NIfTI-1 and NIfTI-2, plain or gzip, both byte
 * orders; geometry.slope and .intercept include the file's own scl_slope and scl_inter. What
 * differs in ANALYZE is in nifti_header.c; the rest here holds for it, too.
 *
 * Where the voxels lie: the sform if its code is positive and its matrix can be inverted, else the
 * qform likewise; where they contradict each other, or there is neither, it is unknown. Where axes
 * and handedness are the same the sform holds. xyzt_units (metres, millimetres, micrometres)
 * applies to all; without it they are millimetres. A pixdim that is not a number from 1 nm to 4 m
 * above 0 says no distance: then it is the sform's, or unknown. All of that is noted.
 *
 * Written: little-endian. What a NIfTI said of the geometry is written as it was, bit for bit. For
 * other scenes, and derived grids, the sform is to_mm, under the code it was read with (or the
 * qform's, or 1), where they have a place in the world; the qform is written where it can say the
 * same; a sheared matrix has none. NIfTI-1, or NIfTI-2 where a side is longer than the 32767 voxels
 * that NIfTI-1 can hold, or a number longer than its single precision. 79 bytes of the description.
 *
 * From: nifti1.h and nifti2.h at https://nifti.nimh.nih.gov, whose field names are used below.
 */
#include "image/nifti.h"

#include <ctype.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/safe.h"
#include "engine/grid.h"
#include "image/image_inside.h"

#define BOTH     "; expected both files of the pair"
#define EXCHANGE "; the .hdr and the .img may have each other's names"

enum { ENDING = 4 /* ".hdr" or ".img" */ };

/* Extensions longer than this are an accident or an attack; the longest known are some MB. */
static const double OFFSET_MOST = 256 << 20;

enum { UNREAD = -1 };

#define CHANNEL   "it has colours: take one channel, as `c3d -mcs IN -oo R.nii G.nii B.nii` does"
#define MAGNITUDE "take the magnitude, as `fslcomplex -realabs IN OUT` does"

static const struct datatype {
    int16_t code;
    const char *name;
    int type;           /* enum voxel_type, or UNREAD: */
    const char *remedy; /* what makes of it what can be read */
} known[] = {
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
};

static const struct datatype *datatype_of(int64_t code)
{
    static const struct datatype unknown = {0, "unknown", UNREAD, "write whole or real numbers"};
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++)
        if (known[i].code == code)
            return &known[i];
    return &unknown;
}

static enum err read_fields(struct nifti_header *header, char *notes, struct volume_source *source,
                            struct fault *fault)
{
    uint8_t bytes[NIFTI_MOST_BYTES];
    if (!source->packed && source->bytes < NIFTI_LEAST_BYTES)
        return fault_set(fault, ERR_INPUT,
                         "not a NIfTI file: %" PRIu64 " bytes; expected at least 348 of header",
                         source->bytes);
    *header = (struct nifti_header){0};
    enum err err = source_read(source, bytes, NIFTI_LEAST_BYTES, "the header", NULL, fault);
    if (!err)
        err = nifti_header_recognise(header, bytes, fault);
    if (!err)
        err = source_read(source, bytes + NIFTI_LEAST_BYTES, header->bytes - NIFTI_LEAST_BYTES,
                          "the header", NULL, fault);
    if (!err)
        nifti_header_decode(header, bytes);
    if (!err && header->kind == NIFTI_ANALYZE)
        nifti_header_take_analyze(header, bytes, notes);
    return err;
}

/* Three dimensions, of which a grid may hold no more than a part; further ones count volumes. */
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

/* What is said of voxels that can be read. */
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
    /* After the header four bytes say whether extensions follow. */
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
    return err ? fault_prefix(fault, err, "its .img") : OK;
}

/* Values of grayordinates, points of surfaces and voxels in a list: its grid is 1x1x1, and what
 * they are the XML in its extension says. */
static bool is_cifti(const struct nifti_header *header)
{
    const int64_t *dim = header->dim, intent = header->intent_code;
    return header->kind == NIFTI_SINGLE && intent >= 3000 && intent < 3100 && dim[0] > 4 &&
           dim[1] == 1 && dim[2] == 1 && dim[3] == 1;
}

/* What the fields say of the voxels of `source`. */
static enum err take_fields(struct volume_header *out, struct nifti_header *header,
                            const struct volume_source *source, struct fault *fault)
{
    enum err err = read_size(out->size, &out->volumes, header, fault);
    if (err)
        return err;
    const struct datatype *datatype = datatype_of(header->datatype);
    snprintf(out->format, sizeof out->format, "%s%s",
             header->kind == NIFTI_ANALYZE        ? "analyze"
             : header->bytes == NIFTI_LEAST_BYTES ? "nifti-1"
                                                  : "nifti-2",
             header->kind == NIFTI_PAIR ? " pair" : "");
    snprintf(out->type_name, sizeof out->type_name, "%s", datatype->name);
    out->big_endian = header->big_endian;
    if (is_cifti(header))
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

/* ---- pairs ---- */

static bool is_voxels(const char *path)
{
    return file_is_named(path, PAIR_VOXELS);
}

/* Its ending in small letters or capitals, as that of `path` is. */
static void name_other(struct buf *other, const char *path, const char *end, bool is_packed)
{
    const char *to = is_voxels(path) ? ".hdr" : ".img";
    buf_clear(other);
    buf_add(other, path, (size_t)(end - path));
    for (int i = 0; i < ENDING; i++)
        buf_add_char(other, (char)(isupper((unsigned char)end[i]) ? toupper(to[i]) : to[i]));
    buf_add_text(other, !is_packed ? "" : end[ENDING] ? end + ENDING : ".gz");
}

bool pair_other(struct buf *other, const char *path)
{
    const char *end = file_ending(path, PAIR_HEADERS "|" PAIR_VOXELS);
    buf_clear(other);
    if (!end)
        return false;
    const bool is_packed = end[ENDING] != '\0';
    for (int i = 0; i < 2; i++) {
        name_other(other, path, end, i ? !is_packed : is_packed);
        if (!other->failed && file_exists(buf_text(other)))
            return true;
    }
    name_other(other, path, end, is_packed);
    return false;
}

/* What it is called, and where it should be, is said where there is none. */
static enum err go_to_other(struct volume_source *source, bool to_voxels, struct fault *fault)
{
    struct buf other = {0};
    enum err err;
    if (pair_other(&other, source->path)) {
        err = source_switch(source, buf_text(&other), fault);
        if (err)
            fault_prefix(fault, err, "%s", file_name(buf_text(&other)));
    } else if (to_voxels)
        err = fault_set(fault, ERR_IO, "there is no %s beside it, with its voxels" BOTH,
                        file_name(buf_text(&other)));
    else
        err = fault_set(fault, ERR_IO,
                        "there is no %s beside it, with its header" BOTH
                        "; `open raw:FILE size=X,Y,Z type=T` reads voxels without one",
                        file_name(buf_text(&other)));
    err = other.failed ? fault_memory(fault, "a path") : err;
    buf_release(&other);
    return err;
}

/* The voxels of a pair, whose header was read, and what is said of both. */
static enum err take_pair(struct volume_header *out, struct nifti_header *header,
                          struct volume_source *source, struct fault *fault)
{
    const enum err err = is_voxels(source->path) ? source_switch(source, source->path, fault)
                                                 : go_to_other(source, true, fault);
    if (err)
        return err;
    if (header->kind == NIFTI_ANALYZE) { /* SPM has its place in a file of MATLAB */
        struct buf matrix = {0};
        buf_add(&matrix, source->path,
                (size_t)(file_ending(source->path, PAIR_HEADERS "|" PAIR_VOXELS) - source->path));
        buf_add_text(&matrix, ".mat");
        if (!matrix.failed && file_exists(buf_text(&matrix)))
            volume_note(out->notes,
                        "the .mat of SPM beside it may say where its voxels lie; it is not read: "
                        "`nib-convert FILE A.nii` (nibabel) makes a NIfTI of them");
        buf_release(&matrix);
    }
    return take_fields(out, header, source, fault);
}

/* A file that begins with a header. */
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

/* A file that the name says to be of a pair, and that begins with no header. */
static enum err read_beside(struct volume_header *out, struct volume_source *source,
                            struct fault *fault)
{
    struct nifti_header header;
    uint8_t begin[NIFTI_LEAST_BYTES];
    if (!is_voxels(source->path)) {
        const bool has_other = go_to_other(source, false, NULL) == OK;
        if (has_other && nifti_header_is_one(begin, source_peek(source, begin, sizeof begin)))
            return fault_set(fault, ERR_INPUT,
                             "it begins with no header, and its .img does" EXCHANGE);
        return fault_set(
            fault, ERR_INPUT,
            "no header of ANALYZE or NIfTI: its first four bytes are neither 348 nor 540");
    }
    enum err err = go_to_other(source, false, fault);
    if (err)
        return err;
    err = read_fields(&header, out->notes, source, fault);
    if (err)
        return fault_prefix(fault, err, "its .hdr");
    if (header.kind == NIFTI_SINGLE)
        return fault_set(fault, ERR_INPUT, "its .hdr is that of a single file, not of a pair");
    return take_pair(out, &header, source, fault);
}

/* ---- writing ---- */

/* The header and the four bytes after it that say "no extensions". */
static enum err write(const char *path, enum file_mode mode, const struct volume_map *map,
                      struct watch *watch, struct fault *fault)
{
    uint8_t bytes[NIFTI_MOST_BYTES + 4] = {0};
    struct buf begin = {0};
    struct nifti_header header = {.bytes = NIFTI_LEAST_BYTES, .scl_slope = 1, .dim = {3}};
    for (int a = 1; a < 8; a++) {
        header.dim[a] = a <= 3 ? map->size[a - 1] : 1;
        if (header.dim[a] > INT16_MAX)
            header.bytes = NIFTI_MOST_BYTES;
    }
    header.datatype = map->type == VOXEL_UINT8    ? 2
                      : map->type == VOXEL_UINT16 ? 512
                      : map->type == VOXEL_UINT32 ? 768
                                                  : 16;
    header.bitpix = INT64_C(8) * voxel_bytes(map->type);
    nifti_header_place(&header, map->geometry);
    header.vox_offset = (double)header.bytes + 4;
    const size_t length = strnlen(map->description, sizeof header.descrip - 1);
    size_t fits = 0; /* of the description, and never half a character */
    for (size_t n; fits < length; fits += n) {
        n = safe_character(map->description + fits, strlen(map->description + fits));
        n = n ? n : 1;
        if (fits + n > length)
            break;
    }
    memcpy(header.descrip, map->description, fits);
    nifti_header_encode(&header, bytes);
    buf_add(&begin, bytes, header.bytes + 4);
    return voxels_write(path, mode, &begin, file_is_named(path, ".gz") ? PACKED_WHOLE : PACKED_NOT,
                        map, watch, fault);
}

extern const struct volume_format nifti_format;
const struct volume_format nifti_format = {
    .name = "NIfTI",
    .endings = ".nii|.nii.gz",
    .recognises = nifti_header_is_one,
    .read_header = read_header,
    .write = write,
};

extern const struct volume_format pair_format;
const struct volume_format pair_format = {
    .name = "ANALYZE",
    .endings = PAIR_HEADERS "|" PAIR_VOXELS,
    .read_header = read_beside, /* what begins with a header is taken above */
};
