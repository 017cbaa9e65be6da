/* SPDX-License-Identifier: MIT */
/*
 * Write DICOM SEG: a binary segmentation of the slices of a DICOM series. iftty-volume reads it.
 *
 * Segments are numbered from 1 without gaps, as DICOM requires, in the order of the labels'
 * numbers; a label with another number has it in its description, "label 300". Each segment has a
 * frame in each slice that has a voxel of it, slice by slice. Frames are bits, the lowest first,
 * without padding between them: eight frames fill whole bytes, and are a row for voxels_write.
 *
 * The same map of the same series yields the same bytes. UIDs are 2.25.N, where N is a digest of
 * the contents. DICOM requires a date: without a time, it is 1 January 1900.
 */
#include <endian.h>
#include <inttypes.h>
#include <math.h>
#include <nettle/sha2.h>
#include <stdlib.h>
#include <string.h>

#include "base/buf.h"
#include "base/mem.h"
#include "base/scan.h"
#include "base/version.h"
#include "image/names.h"
#include "image/volume_format.h"

#define SEG_CLASS "1.2.840.10008.5.1.4.1.1.66.4"

enum { LABELS = 256, UID_BYTES = 65, TOGETHER = 8 };
static const uint32_t ITEM = 0xfffee000, ITEM_END = 0xfffee00d, SEQUENCE_END = 0xfffee0dd;

/* ---- elements ----
 *
 * A data set is described in lines, "TTTTTTTTVVvalue": tag, type and value, with \ between several.
 * The items of a sequence follow its line, with ";" between them and "]" at the end. */

static void put(struct buf *out, uint32_t number, unsigned bytes)
{
    for (unsigned i = 0; i < bytes; i++)
        buf_add_char(out, (char)(number >> 8 * i));
}

/* A tag, and the four bytes after it. */
static void put_tag(struct buf *out, uint32_t tag, uint32_t after)
{
    put(out, tag >> 16, 2);
    put(out, tag, 2);
    put(out, after, 4);
}

/* Write the value of an element as bytes: text, or numbers of 16 or 32 bits, or tags. */
static void put_value(struct buf *out, const char *type, const char *at, size_t length)
{
    const char *end = at + length;
    const bool is_tag = memcmp(type, "AT", 2) == 0, is_wide = memcmp(type, "UL", 2) == 0;
    if (!is_tag && !is_wide && memcmp(type, "US", 2) != 0) {
        buf_add(out, at, length);
        if (length % 2)
            buf_add_char(out, memcmp(type, "UI", 2) == 0 ? '\0' : ' ');
        return;
    }
    for (char *next; at < end; at = next + 1) {
        const uint32_t number = (uint32_t)strtoul(at, &next, is_tag ? 16 : 10);
        put(out, is_tag ? number >> 16 : number, is_wide ? 4 : 2);
        if (is_tag)
            put(out, number, 2);
    }
}

/* Write a described data set: little-endian, with explicit types. */
static void encode(struct buf *out, const struct buf *lines)
{
    OWNED(buf_release) struct buf value = {0};
    for (const char *at = buf_text(lines), *end; *at; at = end + 1) {
        end = at + strcspn(at, "\n");
        if (*at == ';' || *at == ']') {
            put_tag(out, ITEM_END, 0);
            *at == ';' ? put_tag(out, ITEM, UINT32_MAX) : put_tag(out, SEQUENCE_END, 0);
            continue;
        }
        char tag[9] = "";
        memcpy(tag, at, 8);
        const uint32_t number = (uint32_t)strtoul(tag, NULL, 16);
        if (memcmp(at + 8, "SQ", 2) == 0) {
            put_tag(out, number, 'S' | 'Q' << 8);
            put(out, UINT32_MAX, 4);
            put_tag(out, ITEM, UINT32_MAX);
            continue;
        }
        buf_clear(&value);
        put_value(&value, at + 8, at + 10, (size_t)(end - at) - 10);
        put(out, number >> 16, 2);
        put(out, number, 2);
        buf_add(out, at + 8, 2);
        put(out, (uint32_t)value.length, 2);
        buf_add(out, value.data, value.length);
    }
    out->failed |= lines->failed | value.failed;
}

/* Describe decimal numbers, of at most 16 letters each. */
static void add_decimals(struct buf *out, const char *tag, const double *number, unsigned count)
{
    buf_add_text(out, tag);
    for (unsigned i = 0; i < count; i++) {
        char word[32];
        for (int digits = 15; snprintf(word, sizeof word, "%.*g", digits, number[i] + 0.0) > 16;)
            digits--;
        buf_printf(out, i ? "\\%s" : "%s", word);
    }
    buf_add_char(out, '\n');
}

/* ---- the series (volume_helper.h) ---- */

struct line {
    const char *at;
    size_t length;
};

/* Describe an attribute as in the series: "TTTTTTTTVV". */
static void add_found(struct buf *out, const struct dicom_source *source, const char *tag)
{
    char key[12];
    snprintf(key, sizeof key, "\n%.8s ", tag);
    const char *at = strstr(buf_text(&source->words), key);
    const size_t length = at ? strcspn(at + 10, "\n") : 0;
    buf_printf(out, "%s%.*s\n", tag, (int)length, length ? at + 10 : "");
}

/* Read "slice CLASS INSTANCE FRAME" into the words; false at the end. */
static bool next_slice(const char **at, struct line word[3])
{
    if (!scan_text(at, "slice "))
        return false;
    for (int i = 0; i < 3; i++) {
        word[i] = (struct line){*at, strcspn(*at, " \n")};
        *at += word[i].length + ((*at)[word[i].length] != '\0');
    }
    return true;
}

static const char *first_slice(const struct dicom_source *source)
{
    const char *at = strstr(buf_text(&source->words), "\nslice ");
    return at ? at + 1 : "";
}

static void add_instance(struct buf *out, const struct line word[3])
{
    buf_printf(out, "00081150UI%.*s\n00081155UI%.*s\n", (int)word[0].length, word[0].at,
               (int)word[1].length, word[1].at);
}

/* ---- the segments ---- */

struct segments {
    const struct volume_map *map;
    unsigned count, label[LABELS]; /* labels of the segments, from 0 */
    struct frame {
        uint32_t z;
        unsigned segment;
    } * frame;
    size_t frames, capacity;
    uint8_t *plane; /* [y][x]: 1 more than the segment */
    uint32_t z;     /* its slice */
    uint32_t *row;
    struct sha256_ctx sha; /* digest of the contents */
    bool is_unknown;
};

static void segments_release(struct segments *segments)
{
    free(segments->frame);
    free(segments->plane);
    free(segments->row);
}

/* Read a slice; set `has` to the segments in it, unless NULL. */
static void read_plane(struct segments *segments, uint32_t z, bool has[LABELS])
{
    const struct volume_map *map = segments->map;
    uint32_t last = 0;
    uint8_t *to = segments->plane, segment = 0;
    segments->z = z;
    for (uint32_t y = 0; y < map->size[1]; y++) {
        map->row(map->context, y, z, segments->row);
        for (uint32_t x = 0; x < map->size[0]; x++) {
            const uint32_t number = voxel_number(segments->row, map->type, x);
            if (number != last) {
                last = number;
                for (segment = number ? (uint8_t)segments->count : 0;
                     segment > 0 && map->label[segments->label[segment - 1]].number != number;)
                    segment--;
                segments->is_unknown |= number && !segment;
            }
            *to++ = segment;
            if (has && segment)
                has[segment - 1] = true;
        }
    }
}

/* List the frames, and compute the digest of all voxels. */
static enum err find_frames(struct segments *segments, struct watch *watch, struct fault *fault)
{
    const uint32_t *size = segments->map->size;
    const size_t pixels = (size_t)size[0] * size[1];
    struct task task = task_begin(watch, "segments", voxels_in(size));
    for (uint32_t z = 0; z < size[2] && task_advance(&task, pixels); z++) {
        bool has[LABELS] = {0};
        read_plane(segments, z, has);
        sha256_update(&segments->sha, pixels, segments->plane);
        for (unsigned s = 0; s < segments->count; s++) {
            if (!has[s])
                continue;
            if (!mem_grow(&segments->frame, &segments->capacity, segments->frames + 1,
                          sizeof *segments->frame))
                return fault_memory(fault, "the frames");
            segments->frame[segments->frames++] = (struct frame){z, s};
        }
    }
    return watch_fault(watch, fault);
}

/* Fill the bytes of eight frames, or of the rest. */
static void fill_frames(void *context, uint32_t y, uint32_t z, void *bytes)
{
    struct segments *segments = context;
    const uint32_t *size = segments->map->size;
    const size_t pixels = (size_t)size[0] * size[1], first = (size_t)z * TOGETHER;
    uint8_t *to = bytes;
    (void)y;
    memset(to, 0, pixels);
    for (size_t f = first; f < first + TOGETHER && f < segments->frames; f++) {
        const struct frame *frame = &segments->frame[f];
        if (frame->z != segments->z)
            read_plane(segments, frame->z, NULL);
        size_t bit = (f - first) * pixels;
        for (size_t i = 0; i < pixels; i++, bit++)
            if (segments->plane[i] == frame->segment + 1)
                to[bit / 8] |= (uint8_t)(1 << bit % 8);
    }
}

/* ---- the data set ---- */

/* Write a UID of the contents: 2.25.N, N of 128 bits: the decimal digits of two halves. */
static void make_uid(char uid[UID_BYTES], const struct sha256_ctx *contents, uint8_t purpose)
{
    struct sha256_ctx sha = *contents;
    uint64_t half[2];
    sha256_update(&sha, 1, &purpose);
    sha256_digest(&sha, sizeof half, (uint8_t *)half);
    snprintf(uid, UID_BYTES, "2.25.%" PRIu64 "%019" PRIu64, be64toh(half[0]) | UINT64_C(1) << 63,
             be64toh(half[1]) % UINT64_C(10000000000000000000));
}

/* Convert sRGB to CIELab relative to D50, in the numbers of DICOM. */
static void add_colour(struct buf *out, const uint8_t rgb[3])
{
    static const double matrix[3][3] = {{0.4360747, 0.3850649, 0.1430804},
                                        {0.2225045, 0.7168786, 0.0606169},
                                        {0.0139322, 0.0971045, 0.7141733}};
    static const double white[3] = {0.9642, 1.0, 0.8251};
    double linear[3], f[3];
    for (int i = 0; i < 3; i++) {
        const double value = rgb[i] / 255.0;
        linear[i] = value <= 0.04045 ? value / 12.92 : pow((value + 0.055) / 1.055, 2.4);
    }
    for (int i = 0; i < 3; i++) {
        const double *m = matrix[i];
        const double t = (m[0] * linear[0] + m[1] * linear[1] + m[2] * linear[2]) / white[i];
        f[i] = t > 216 / 24389.0 ? cbrt(t) : t * 841 / 108 + 4 / 29.0;
    }
    buf_printf(
        out, "0062000dUS%ld\\%ld\\%ld\n", lround(fmin(fmax((116 * f[1] - 16) * 655.35, 0), 65535)),
        lround((500 * (f[0] - f[1]) + 128) * 257), lround((200 * (f[1] - f[2]) + 128) * 257));
}

static void add_segments(struct buf *out, const struct segments *segments)
{
    static const char code[] = "00080100SH%s\n00080102SH%s\n00080104LO%s\n]\n";
    buf_add_text(out, "00620002SQ\n");
    for (unsigned s = 0; s < segments->count; s++) {
        const struct volume_label *label = &segments->map->label[segments->label[s]];
        char number[24], part[3][CODE_PART_BYTES] = {"SCT", "85756007", "Tissue"};
        snprintf(number, sizeof number, "label %u", label->number);
        if (*label->code)
            names_split_code(part, label);
        buf_add_text(out, s ? ";\n00620003SQ\n" : "00620003SQ\n");
        buf_printf(out, code, *label->code ? "123037004" : part[1], "SCT",
                   *label->code ? "Anatomical Structure" : part[2]);
        buf_printf(out, "00620004US%u\n00620005LO%s\n", s + 1, *label->name ? label->name : number);
        if (label->number != s + 1)
            buf_printf(out, "00620006ST%s\n", number);
        buf_add_text(out, "00620008CSSEMIAUTOMATIC\n00620009LOiftty\n");
        add_colour(out, label->rgb);
        buf_add_text(out, "0062000fSQ\n");
        buf_printf(out, code, part[1], part[0], part[2]);
    }
    buf_add_text(out, "]\n");
}

static void add_references(struct buf *out, const struct dicom_source *source)
{
    struct line word[3], before = {"", 0};
    buf_add_text(out, "00081115SQ\n0008114aSQ\n");
    for (const char *at = first_slice(source); next_slice(&at, word);) {
        if (word[1].length == 0 ||
            (word[1].length == before.length && memcmp(word[1].at, before.at, before.length) == 0))
            continue;
        buf_add_text(out, before.length ? ";\n" : "");
        add_instance(out, word);
        before = word[1];
    }
    buf_add_text(out, "]\n");
    add_found(out, source, "0020000eUI");
    buf_add_text(out, "]\n");
}

/* Describe the groups that all frames share. */
static void add_shared(struct buf *out, const struct geometry *geometry, const double lps[3][4])
{
    const double spacing[2] = {geometry_step_mm(geometry, 1), geometry_step_mm(geometry, 0)};
    const double depth = geometry_step_mm(geometry, 2) * geometry_fill(geometry);
    double axis[6];
    for (int i = 0; i < 6; i++)
        axis[i] = lps[i % 3][i / 3] / spacing[1 - i / 3];
    buf_add_text(out, "52009229SQ\n00209116SQ\n");
    add_decimals(out, "00200037DS", axis, 6);
    buf_add_text(out, "]\n00289110SQ\n");
    add_decimals(out, "00180050DS", &depth, 1);
    add_decimals(out, "00180088DS", &depth, 1);
    add_decimals(out, "00280030DS", spacing, 2);
    buf_add_text(out, "]\n]\n");
}

static void add_frames(struct buf *out, const struct segments *segments, const double lps[3][4])
{
    const struct dicom_source *source = segments->map->source;
    const char *at = source->has_slices ? first_slice(source) : "";
    struct line word[3] = {{"", 0}, {"", 0}, {"", 0}};
    uint32_t next = 0, plane = 0;
    buf_add_text(out, "52009230SQ\n");
    for (size_t f = 0; f < segments->frames; f++) {
        const struct frame *frame = &segments->frame[f];
        double place[3];
        for (int w = 0; w < 3; w++)
            place[w] = lps[w][3] + frame->z * lps[w][2];
        plane += f == 0 || frame->z != frame[-1].z;
        while (next <= source->first + frame->z && next_slice(&at, word))
            next++;
        buf_add_text(out, f ? ";\n" : "");
        if (next == source->first + frame->z + 1 && word[1].length) {
            buf_add_text(out, "00089124SQ\n00082112SQ\n");
            add_instance(out, word);
            if (*word[2].at != '0')
                buf_printf(out, "00081160IS%.*s\n", (int)word[2].length, word[2].at);
            buf_add_text(out, "0028135aCSYES\n0040a170SQ\n00080100SH121322\n00080102SHDCM\n"
                              "00080104LOSource image for image processing operation\n]\n]\n"
                              "00089215SQ\n00080100SH113076\n00080102SHDCM\n"
                              "00080104LOSegmentation\n]\n]\n");
        }
        buf_printf(out, "00209111SQ\n00209157UL%u\\%u\n]\n00209113SQ\n", frame->segment + 1, plane);
        add_decimals(out, "00200032DS", place, 3);
        buf_printf(out, "]\n0062000aSQ\n0062000bUS%u\n]\n", frame->segment + 1);
    }
    buf_add_text(out, "]\n");
}

/* Describe the data set up to its pixels. `uid`: of the instance, the series and the dimensions. */
static void add_data_set(struct buf *out, const struct segments *segments, char uid[3][UID_BYTES])
{
    static const char *const patient[] = {"00100010PN", "00100020LO", "00100030DA", "00100040CS"};
    const struct volume_map *map = segments->map;
    const struct dicom_source *source = map->source;
    double lps[3][4];
    geometry_to_lps(map->geometry, lps);
    buf_printf(out,
               "00080005CSISO_IR 192\n00080008CSDERIVED\\PRIMARY\n00080016UI" SEG_CLASS
               "\n00080018UI%s\n",
               uid[0]);
    add_found(out, source, "00080020DA");
    buf_printf(out, "00080023DA%s\n", source->date);
    add_found(out, source, "00080030TM");
    buf_printf(out, "00080033TM%s\n", source->time);
    add_found(out, source, "00080050SH");
    buf_add_text(out, "00080060CSSEG\n00080070LOiftty\n");
    add_found(out, source, "00080090PN");
    buf_printf(out, "0008103eLO%.64s\n00081090LOiftty\n", map->description);
    add_references(out, source);
    for (int i = 0; i < 4; i++)
        add_found(out, source, patient[i]);
    buf_add_text(out, "00181000LO0\n00181020LO" PROGRAM_VERSION "\n");
    add_found(out, source, "0020000dUI");
    buf_printf(out, "0020000eUI%s\n", uid[1]);
    add_found(out, source, "00200010SH");
    buf_add_text(out, "00200011IS1\n00200013IS1\n");
    add_found(out, source, "00200052UI");
    buf_printf(out,
               "00201040LO\n00209221SQ\n00209164UI%s\n]\n00209222SQ\n00209164UI%s\n"
               "00209165AT0062000b\n00209167AT0062000a\n;\n00209164UI%s\n"
               "00209165AT00200032\n00209167AT00209113\n]\n",
               uid[2], uid[2], uid[2]);
    buf_printf(out,
               "00280002US1\n00280004CSMONOCHROME2\n00280008IS%zu\n00280010US%u\n"
               "00280011US%u\n00280100US1\n00280101US1\n00280102US0\n00280103US0\n"
               "00282110CS00\n00620001CSBINARY\n",
               segments->frames, map->size[1], map->size[0]);
    add_segments(out, segments);
    buf_add_text(out, "00620013CSNO\n00700080CSSEGMENTATION\n00700081LO\n00700084PN\n");
    add_shared(out, map->geometry, (const double(*)[4])lps);
    add_frames(out, segments, (const double(*)[4])lps);
}

/* Write the header up to the pixels, whose length is `bytes`. */
static void write_header(struct buf *out, const struct segments *segments, uint32_t bytes)
{
    OWNED(buf_release) struct buf lines = {0}, meta = {0};
    char uid[3][UID_BYTES];
    for (uint8_t i = 0; i < 3; i++)
        make_uid(uid[i], &segments->sha, i);
    buf_printf(&lines,
               "00020002UI" SEG_CLASS "\n00020003UI%s\n00020010UI1.2.840.10008.1.2.1\n"
               "00020012UI2.25.160546361157871906212341\n",
               uid[0]);
    put_tag(&meta, 0x00020001, 'O' | 'B' << 8);
    put(&meta, 2, 4);
    put(&meta, 1 << 8, 2);
    encode(&meta, &lines);
    for (int i = 0; i < 128 / 4; i++)
        put(out, 0, 4);
    buf_add_text(out, "DICM");
    put_tag(out, 0x00020000, 'U' | 'L' << 8 | 4 << 16);
    put(out, (uint32_t)meta.length, 4);
    buf_add(out, meta.data, meta.length);
    buf_clear(&lines);
    add_data_set(&lines, segments, uid);
    encode(out, &lines);
    put_tag(out, 0x7fe00010, 'O' | 'B' << 8);
    put(out, bytes, 4);
    out->failed |= meta.failed;
}

static enum err write_map(const char *path, enum file_mode mode, const struct volume_map *map,
                          struct watch *watch, struct fault *fault)
{
    OWNED(segments_release) struct segments segments = {.map = map};
    OWNED(buf_release) struct buf header = {0}, tail = {0};
    if (!map->label || !map->source)
        return fault_set(fault, ERR_USAGE, "cannot write %s: a .dcm holds labels alone", path);
    const size_t pixels = (size_t)map->size[0] * map->size[1];
    segments.plane = mem_array(pixels, 1);
    segments.row = mem_array(map->size[0], sizeof *segments.row);
    if (!segments.plane || !segments.row)
        return fault_memory(fault, "a slice");
    sha256_init(&segments.sha);
    sha256_update(&segments.sha, map->source->words.length,
                  (const uint8_t *)map->source->words.data);
    sha256_update(&segments.sha, sizeof map->source->date, (const uint8_t *)map->source->date);
    sha256_update(&segments.sha, sizeof map->source->time, (const uint8_t *)map->source->time);
    uint32_t last = 0;
    for (unsigned l; (l = names_next(map->label, &last)) > 0;)
        segments.label[segments.count++] = l;
    add_segments(&header, &segments);
    sha256_update(&segments.sha, header.length, (const uint8_t *)header.data);
    buf_clear(&header);
    TRY(find_frames(&segments, watch, fault));
    const uint64_t bytes = ((uint64_t)segments.frames * pixels + 7) / 8;
    if (segments.is_unknown || segments.frames == 0 || bytes >= UINT32_MAX - 1)
        return fault_set(fault, ERR_INPUT, "cannot write %s: %s; .nii.gz or .seg.nrrd hold it",
                         path,
                         segments.is_unknown ? "regions kept by rest=keep have no label"
                         : segments.frames   ? "it would need 4 GB of frames"
                                             : "no voxel has a label");
    write_header(&header, &segments, (uint32_t)(bytes + bytes % 2));
    const size_t groups = segments.frames / TOGETHER;
    const size_t rest = (size_t)(bytes - groups * pixels);
    uint8_t *held = mem_array(pixels + 1, 1);
    if (!held)
        return fault_memory(fault, "a slice");
    fill_frames(&segments, 0, (uint32_t)groups, held);
    held[rest] = 0;
    buf_add(&tail, held, rest + bytes % 2);
    free(held);
    if (tail.failed)
        return fault_memory(fault, "a slice");
    const uint32_t size[3] = {(uint32_t)pixels, 1, (uint32_t)groups};
    const struct volume_map frames = {
        .size = size, .type = VOXEL_UINT8, .row = fill_frames, .context = &segments, .tail = &tail};
    return voxels_write(path, mode, &header, PACKED_NOT, &frames, watch, fault);
}

extern const struct volume_format seg_format;
const struct volume_format seg_format = {
    .name = "DICOM SEG",
    .endings = ".dcm",
    .held_by = ".dcm",
    .write = write_map,
};
