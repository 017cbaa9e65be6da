/* SPDX-License-Identifier: MIT */
/*
 * NRRD: read scenes, write label and other maps, for 3D Slicer and programs that use ITK or teem.
 *
 *     NRRD0004
 *     content: iftty labels
 *     type: unsigned char
 *     dimension: 3
 *     sizes: 181 217 181
 *     space: left-posterior-superior
 *     space directions: (-1,0,0) (0,-1,0) (0,0,1)
 *     space origin: (90,126,-72)
 *     kinds: domain domain domain
 *     endian: little
 *     encoding: gzip
 *
 * An empty line ends the header, and one gzip stream of the voxels follows. If the orientation is
 * unknown, the file has no space; it has `spacings` instead, if they are known.
 *
 * A .seg.nrrd has additional fields by which 3D Slicer recognises a segmentation: for each label
 * except 0 that has a voxel or a name, its number, name, colour (each part 0 to 1) and extent
 * (first and last voxel along each axis; 0 -1 for none).
 *
 *     Segment0_ID:=Segment_2
 *     Segment0_Name:=cerebellum
 *     Segment0_Color:=0.250980 0.752941 0.376471
 *     Segment0_LabelValue:=2
 *     Segment0_Layer:=0
 *     Segment0_Extent:=50 131 22 89 9 60
 *
 * Files with three spatial axes that contain their voxels, plain or as gzip, are read here, so that
 * the static program, which has no helper, opens scenes and segmentations of 3D Slicer;
 * image_inside.h has the rules. All others are read by iftty-volume (ITK). Both ways have the same
 * result, to the last bit of the place and the last word of a refusal, so that files opened by one
 * build verify in every other.
 *
 * From: https://teem.sourceforge.net/nrrd/format.html, and "Segmentations" in the developer guide
 * of 3D Slicer.
 */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/buf.h"
#include "base/mem.h"
#include "base/safe.h"
#include "base/scan.h"
#include "engine/grid.h"
#include "image/reader_common.h"
#include "image/image_inside.h"
#include "image/names.h"
#include "image/volume_format.h"
#include "image/volume_helper.h"

/*
 * A decoder of the voxels in the same file, with the bytes in the order of this machine: the same
 * bytes that iftty-volume sends, and for a cut or damaged file the same message with the same count
 * of available bytes.
 */

struct voxels {
    struct source_decoder decoder; /* first: the source points to it */
    struct volume_source file;     /* gzip begins at its first byte */
    enum voxel_type type;
    bool big_endian, is_packed;
    uint64_t offset, at, needed; /* bytes before the voxels; read voxels; all voxels */
};

static uint64_t nrrd_voxels_bytes(const struct nrrd_header *header)
{
    return (uint64_t)voxels_in(header->size) * voxel_bytes(header->type);
}

/* Explain why packed voxels cannot be read, in place of an ERR_INPUT. OK if the voxels are whole
 * and only the bytes after them are damaged. */
static enum err explain_damage(const struct voxels *voxels, enum err err, struct fault *fault)
{
    bool ends;
    if (err != ERR_INPUT || !voxels->is_packed)
        return err;
    const uint64_t needed = voxels->needed, bytes = inflated_bytes(voxels->file.fd, voxels->offset,
                                                                   UINT64_MAX, needed, &ends);
    if (ends && bytes >= needed)
        return OK;
    return fault_set(fault, ERR_INPUT, INFLATED_LACKS, "", (unsigned long long)bytes,
                     bytes < needed ? "" : INFLATED_CHECKSUM, (unsigned long long)needed);
}

static enum err take_voxels(struct source_decoder *decoder, void *to, size_t length,
                            struct fault *fault)
{
    struct voxels *voxels = (struct voxels *)decoder;
    enum err err = source_read(&voxels->file, to, length, "the voxels", NULL, fault);
    if (err) {
        const enum err why = explain_damage(voxels, err, fault);
        return why ? why : err;
    }
    voxels->at += length;
    voxels_reorder(to, length / voxel_bytes(voxels->type), voxels->type, voxels->big_endian);
    if (voxels->at == voxels->needed)
        err = source_finish(&voxels->file, fault);
    return explain_damage(voxels, err, fault);
}

static void free_voxels(struct source_decoder *decoder)
{
    struct voxels *voxels = (struct voxels *)decoder;
    source_close(&voxels->file);
    free(voxels);
}

/* Make the source decode the voxels; it owns the decoder. Leave the source unchanged, and return
 * OK, if voxels that should be gzip are not, which zlib may accept all the same. */
static enum err enter_voxels(struct volume_source *source, const struct nrrd_header *header,
                             struct fault *fault)
{
    struct voxels *voxels = mem_new(sizeof *voxels);
    if (!voxels)
        return fault_memory(fault, "the voxels");
    *voxels = (struct voxels){.decoder = {take_voxels, free_voxels},
                              .type = header->type,
                              .big_endian = header->big_endian,
                              .is_packed = header->is_packed,
                              .offset = header->offset,
                              .needed = nrrd_voxels_bytes(header)};
    const enum err err =
        source_enter(&voxels->file, source, header->is_packed ? header->offset : 0, fault);
    if (err || voxels->file.packed != header->is_packed)
        free_voxels(&voxels->decoder);
    else
        source->decoder = &voxels->decoder;
    return err;
}

static enum err begin_voxels(const struct volume_header *header, struct volume_source *source,
                             struct fault *fault)
{
    struct voxels *voxels = (struct voxels *)source->decoder;
    enum err err = OK;
    if (source->decoder->take != take_voxels)
        return volume_helper_begin_voxels(header, source, fault);
    if (voxels->is_packed && voxels->file.most < voxels->needed)
        err = explain_damage(voxels, ERR_INPUT,
                             fault); /* before anything of their size is allocated */
    else if (voxels->is_packed && part_is_less(header)) {
        uint8_t last; /* inflate all of them first: a part is read from a sound file alone */
        err = source_go_to(&voxels->file, voxels->needed - 1, "the voxels", fault);
        if (!err)
            err = source_read(&voxels->file, &last, 1, "the voxels", NULL, fault);
        if (!err)
            err = source_finish(&voxels->file, fault);
        err = explain_damage(voxels, err, fault);
    }
    return err ? err
               : source_go_to(&voxels->file, voxels->is_packed ? 0 : voxels->offset, "the voxels",
                              fault);
}

/*
 * Segments of a .seg.nrrd with several layers, because some of them overlap: each has a layer,
 * which is a volume of the file, and the value of its voxels there.
 *
 *     Segment2_Name:=vessel
 *     Segment2_LabelValue:=1
 *     Segment2_Layer:=1
 *
 * A file without layers, from 3D Slicer before 4.11, has one segment in each volume, with value 1.
 */

enum { SEGMENTS_MOST = 4096 };

struct segment {
    const char *name, *id, *tags; /* NULL for none */
    bool is_auto, has_colour;     /* is_auto: 3D Slicer made the name */
    uint8_t rgb[3];
    int64_t layer, value;
};

/* Read the value of "SegmentN_KEY:=VALUE". */
static void read_field(struct segment *segment, const char *at)
{
    uint8_t rgb[3];
    if (scan_text(&at, "Name:=")) {
        segment->name = at;
    } else if (scan_text(&at, "ID:=")) {
        segment->id = at;
    } else if (scan_text(&at, "Tags:=")) {
        segment->tags = at;
    } else if (scan_text(&at, "NameAutoGenerated:=")) {
        segment->is_auto = *at == '1';
    } else if (scan_text(&at, "Layer:=")) {
        scan_integer(&at, 0, UINT32_MAX, &segment->layer);
    } else if (scan_text(&at, "LabelValue:=")) {
        scan_integer(&at, 0, UINT32_MAX, &segment->value);
    } else if (scan_text(&at, "Color:=")) {
        segment->has_colour = true;
        for (int k = 0; k < 3; k++) {
            scan_blanks(&at);
            segment->has_colour = segment->has_colour && names_scan_part(&at, &rgb[k]);
        }
        if (segment->has_colour)
            memcpy(segment->rgb, rgb, sizeof rgb);
    }
}

/* Read the segments in the lines of a header, which become strings: an array to be freed; NULL out
 * of memory. */
static struct segment *read_segments(unsigned *count, char *bytes, size_t length)
{
    struct segment *segment = mem_array(SEGMENTS_MOST, sizeof *segment);
    const char *const end = bytes + length;
    *count = 0;
    for (unsigned i = 0; segment && i < SEGMENTS_MOST; i++)
        segment[i] = (struct segment){.layer = i, .value = 1};
    for (char *stop; segment && bytes < end; bytes = stop + 1) {
        int64_t number;
        const char *at = bytes;
        stop = memchr(at, '\n', (size_t)(end - at));
        if (!stop)
            break;
        *(stop - (stop[-1] == '\r')) = '\0';
        if (scan_text(&at, "Segment") && scan_integer(&at, 0, SEGMENTS_MOST - 1, &number) &&
            scan_text(&at, "_"))
            read_field(&segment[number], at);
    }
    for (; segment && *count < SEGMENTS_MOST; ++*count) {
        struct segment *s = &segment[*count];
        s->name = s->name ? s->name : s->id;
        if (!s->name)
            break;
    }
    return segment;
}

/* "vessel (1), stone (2)" */
static void write_layer(struct buf *out, const struct segment *segment, unsigned count,
                        uint32_t layer)
{
    const char *between = "";
    for (unsigned i = 0; i < count; i++) {
        if (segment[i].layer != layer)
            continue;
        buf_add_text(out, between);
        buf_add_safe_text(out, segment[i].name);
        buf_printf(out, " (%" PRId64 ")", segment[i].value);
        between = ", ";
    }
    if (!*between)
        buf_add_text(out, "none");
}

/* Set out->contents by the lines of a header: all segments, those of the chosen volume first. */
static void list_segments(struct volume_header *out, char *bytes, size_t length)
{
    enum { LISTED_MOST = 64 };
    unsigned count;
    OWNED(mem_release) struct segment *segment = read_segments(&count, bytes, length);
    const bool is_chosen = out->choice.has_volume;
    OWNED(buf_release) struct buf text = {0};
    const char *between = is_chosen ? "; other layers:" : "";
    if (count == 0)
        return;
    buf_add_text(&text, is_chosen ? "the segments " : "layers of segments:");
    if (is_chosen)
        write_layer(&text, segment, count, out->choice.volume);
    for (uint32_t v = 0; v < out->volumes && v < LISTED_MOST && count; v++) {
        if (is_chosen && v == out->choice.volume)
            continue;
        buf_printf(&text, "%s volume=%" PRIu32 " ", between, v);
        write_layer(&text, segment, count, v);
        between = ";";
    }
    safe_copy(out->contents, sizeof out->contents, buf_text(&text), text.length);
}

/* ---- reading ---- */

/* Read the header, of *length bytes, to be freed; NULL without a header, if it is too long, or out
 * of memory. */
static char *first_bytes(struct volume_source *source, size_t *length)
{
    for (size_t most = 8 << 10;; most *= 8) {
        most = most < NRRD_HEADER_MOST ? most : NRRD_HEADER_MOST;
        char *bytes = mem_array(most, 1);
        const size_t n = bytes ? source_peek(source, (uint8_t *)bytes, most) : 0;
        *length = n ? nrrd_header_length(bytes, n) : 0;
        if (*length)
            return bytes;
        free(bytes);
        if (n < most || most == NRRD_HEADER_MOST)
            return NULL;
    }
}

/* Append the cells of a segment's code (show/label_table.h). Its tags are "NAME:VALUE|NAME:VALUE|";
 * one is "TerminologyEntry:LIST~CATEGORY~TYPE~MODIFIER~LIST~REGION~MODIFIER", of codes
 * "SCHEME^VALUE^MEANING". */
static void add_code(struct buf *out, const struct segment *segment, bool has_more)
{
    char category[20] = "", part[3][CODE_PART_BYTES] = {""}, entry[1024];
    const char *tags = segment->tags ? segment->tags : "", *at = strstr(tags, "TerminologyEntry:");
    const int length = at ? (int)strcspn(at, "|") : 0;
    int end = 0;
    has_more |= (at && at != tags) || strlen(at ? at + length : tags) > 1;
    snprintf(entry, sizeof entry, "%.*s", length, at ? at : "");
    sscanf(entry, "%*[^~]~%*[^^]^%16[^^]^%*[^~]~%16[^:^~]^%16[^:^~]^%n%64[^~]%n", category, part[0],
           part[1], &end, part[2], &end);
    has_more |= at && (strncmp(entry + end, "~^^~", 4) != 0 || !strstr(entry + end, "~^^~^^"));
    if (end)
        buf_printf(out, *part[2] ? "%s:%s:%s" : "%s:%s", part[0], part[1], part[2]);
    buf_printf(out, "\t%s%s", category, has_more ? "\tm" : "");
}

/* Append the names of the segments in the chosen layer, without names that Slicer made and that
 * write_segment makes again. */
static enum err read_names(struct buf *names, const struct volume_header *header,
                           struct volume_source *source, struct fault *fault)
{
    size_t length = 0;
    unsigned count = 0;
    OWNED(mem_release) char *bytes = source->packed ? NULL : first_bytes(source, &length);
    OWNED(mem_release)
    struct segment *segment = bytes ? read_segments(&count, bytes, length) : NULL;
    OWNED(buf_release) struct buf code = {0};
    for (unsigned i = 0; i < count; i++) {
        const struct segment *s = &segment[i];
        char id[24];
        snprintf(id, sizeof id, "Segment_%" PRId64, s->value);
        if (s->layer != header->choice.volume && header->volumes > 1)
            continue;
        const bool is_ours = s->is_auto && strcmp(id, s->name) == 0;
        buf_clear(&code);
        add_code(&code, s, s->id && strcmp(s->id, id) != 0);
        names_add(names, (uint32_t)s->value, s->has_colour ? s->rgb : NULL, s->name,
                  is_ours ? 0 : strlen(s->name), buf_text(&code));
    }
    return (bytes && !segment) || code.failed ? fault_memory(fault, "the segments") : OK;
}

static bool recognises(const uint8_t *begin, size_t length)
{
    return length >= sizeof NRRD_MAGIC - 1 && memcmp(begin, NRRD_MAGIC, sizeof NRRD_MAGIC - 1) == 0;
}

static enum err read_header(struct volume_header *out, struct volume_source *source,
                            struct fault *fault)
{
    struct nrrd_header header;
    struct grid grid;
    size_t length = 0;
    OWNED(mem_release) char *bytes = source->packed ? NULL : first_bytes(source, &length);
    const bool is_ours = bytes && nrrd_header_read(&header, bytes, length);
    TRY(is_ours ? enter_voxels(source, &header, fault) : OK);
    if (!source->decoder) { /* read by the helper; add the segments of several volumes */
        OWNED(mem_release) char *unchanged = bytes ? first_bytes(source, &length) : NULL;
        TRY(volume_helper_read_header(out, source, fault));
        if (unchanged && out->volumes > 1)
            list_segments(out, unchanged, length);
        return OK;
    }
    const uint64_t end = header.offset + (header.is_packed ? 1 : nrrd_voxels_bytes(&header));
    if (source->bytes < end)
        return fault_set(fault, ERR_INPUT,
                         "cut short: it has %" PRIu64 " bytes, and its header promises %" PRIu64
                         "; fetch it again",
                         source->bytes, end);
    memcpy(out->size, header.size, sizeof out->size);
    out->type = header.type;
    snprintf(out->format, sizeof out->format, "NRRD");
    snprintf(out->type_name, sizeof out->type_name, "%s", voxel_type_name(header.type));
    out->big_endian = __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__; /* order of the decoded bytes */
    out->bytes = UINT64_MAX; /* as by the helper: no limit on inflation */
    out->geometry.slope = 1;
    header_place(out, (const double(*)[4])header.to_mm, header.knows_spacing, header.knows_place);
    return grid_init(&grid, header.size, fault);
}

/* ---- writing ---- */

/* "(-1,0,0)": a column of the matrix to the world. */
static void write_column(struct buf *out, const double to_mm[3][4], int column)
{
    for (int w = 0; w < 3; w++) {
        buf_add_char(out, w ? ',' : '(');
        buf_add_real(out, to_mm[w][column]);
    }
    buf_add_char(out, ')');
}

static void write_header(struct buf *out, const struct volume_map *map)
{
    const struct geometry *geometry = map->geometry;
    buf_printf(out, "NRRD0004\ncontent: %s\ntype: %s\ndimension: 3\nsizes: %u %u %u\n",
               map->description,
               map->type == VOXEL_UINT8    ? "unsigned char"
               : map->type == VOXEL_UINT16 ? "unsigned short"
                                           : "unsigned int",
               map->size[0], map->size[1], map->size[2]);
    if (geometry_has_place(geometry)) {
        double to_mm[3][4];
        geometry_to_lps(geometry, to_mm);
        buf_add_text(out, "space: left-posterior-superior\nspace directions:");
        for (int a = 0; a < 3; a++) {
            buf_add_char(out, ' ');
            write_column(out, (const double(*)[4])to_mm, a);
        }
        buf_add_text(out, "\nspace origin: ");
        write_column(out, (const double(*)[4])to_mm, 3);
        buf_add_char(out, '\n');
    } else if (!geometry->spacing_unknown) {
        const uint32_t *nm = geometry->spacing_nm;
        buf_add_text(out, "spacings:");
        for (int a = 0; a < 3; a++) {
            buf_add_char(out, ' ');
            buf_add_real(out, nm[a] / 1e6);
        }
        buf_add_char(out, '\n');
    }
    buf_add_text(out, "kinds: domain domain domain\nendian: little\nencoding: gzip\n");
}

/* ---- segments ---- */

enum { LABELS = 256 };

struct extent {
    bool any;
    uint32_t first[3], last[3];
};

/* The label with a number; 0 if none has it. */
static unsigned label_at(const struct volume_map *map, uint32_t number)
{
    unsigned label = LABELS - 1;
    while (label > 0 && map->label[label].number != number)
        label--;
    return label;
}

/* Find the extent of each label; `row` has room for one. */
static void find_extents(struct extent extent[LABELS], const struct volume_map *map, void *row,
                         struct watch *watch)
{
    unsigned label = 0;
    const uint32_t *size = map->size;
    struct task task = task_begin(watch, "extents", (uint64_t)size[1] * size[2]);
    for (uint32_t z = 0; z < size[2]; z++)
        for (uint32_t y = 0; y < size[1] && task_advance(&task, 1); y++) {
            map->row(map->context, y, z, row);
            for (uint32_t x = 0; x < size[0]; x++) {
                const uint32_t is = voxel_number(row, map->type, x);
                if (x > 0 && x + 1 < size[0] && is == voxel_number(row, map->type, x - 1) &&
                    is == voxel_number(row, map->type, x + 1))
                    continue;
                if (is != map->label[label].number)
                    label = label_at(map, is);
                struct extent *of = &extent[label];
                const uint32_t place[3] = {x, y, z};
                for (int a = 0; a < 3; a++) {
                    of->first[a] = !of->any || place[a] < of->first[a] ? place[a] : of->first[a];
                    of->last[a] = !of->any || place[a] > of->last[a] ? place[a] : of->last[a];
                }
                of->any = true;
            }
        }
}

static void write_segment(struct buf *out, unsigned n, const struct volume_label *look,
                          const struct extent *extent)
{
    const uint32_t label = look->number;
    char id[24];
    snprintf(id, sizeof id, "Segment_%u", label);
    buf_printf(out, "Segment%u_ID:=%s\nSegment%u_Name:=%s\nSegment%u_NameAutoGenerated:=%d\n", n,
               id, n, *look->name ? look->name : id, n, !*look->name);
    buf_printf(out, "Segment%u_Color:=%.6f %.6f %.6f\nSegment%u_ColorAutoGenerated:=0\n", n,
               look->rgb[0] / 255.0, look->rgb[1] / 255.0, look->rgb[2] / 255.0, n);
    buf_printf(out, "Segment%u_LabelValue:=%u\nSegment%u_Layer:=0\nSegment%u_Tags:=", n, label, n,
               n);
    if (*look->code) {
        char part[3][CODE_PART_BYTES];
        names_split_code(part, look);
        buf_printf(out,
                   "TerminologyEntry:Segmentation category and type - DICOM master list~"
                   "SCT^123037004^Anatomical Structure~%s^%s^%s~^^~Anatomic codes - DICOM master "
                   "list~^^~^^",
                   part[0], part[1], part[2]);
    }
    buf_add_text(out, "|\n");
    buf_printf(out, "Segment%u_Extent:=", n);
    for (int a = 0; a < 3; a++)
        buf_printf(out, "%s%u %d", a ? " " : "", extent->first[a],
                   extent->any ? (int)extent->last[a] : -1);
    buf_add_char(out, '\n');
}

static enum err write_segments(struct buf *out, const struct volume_map *map, struct watch *watch,
                               struct fault *fault)
{
    struct extent extent[LABELS] = {0};
    OWNED(mem_release) uint32_t *row = mem_array(map->size[0], sizeof *row);
    unsigned number = 0;
    if (!row)
        return fault_memory(fault, "the segments");
    find_extents(extent, map, row, watch);
    buf_add_text(out, "Segmentation_MasterRepresentation:=Binary labelmap\n"
                      "Segmentation_ContainedRepresentationNames:=Binary labelmap|\n"
                      "Segmentation_ReferenceImageExtentOffset:=0 0 0\n");
    uint32_t last = 0;
    for (unsigned label; (label = names_next(map->label, &last)) > 0;)
        write_segment(out, number++, &map->label[label], &extent[label]);
    return watch_fault(watch, fault);
}

static enum err write_map(const char *path, enum file_mode mode, const struct volume_map *map,
                          struct watch *watch, struct fault *fault)
{
    const bool is_segmentation = file_is_named(path, ".seg.nrrd");
    OWNED(buf_release) struct buf header = {0};
    if (is_segmentation && !map->label)
        return fault_set(fault, ERR_USAGE,
                         "cannot write %s: a .seg.nrrd holds labels; expected .nrrd for this map",
                         path);
    write_header(&header, map);
    TRY(is_segmentation ? write_segments(&header, map, watch, fault) : OK);
    buf_add_char(&header, '\n');
    return voxels_write(path, mode, &header, PACKED_VOXELS, map, watch, fault);
}

extern const struct volume_format nrrd_format;
const struct volume_format nrrd_format = {
    .name = "NRRD",
    .endings = ".nrrd|.seg.nrrd",
    .recognises = recognises,
    .read_header = read_header,
    .begin_voxels = begin_voxels,
    .read_names = read_names,
    .held_by = ".seg.nrrd",
    .write = write_map,
};
