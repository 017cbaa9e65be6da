/* SPDX-License-Identifier: MIT */
#include "image/volume_helper.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/confine.h"
#include "base/mem.h"
#include "base/scan.h"
#include "engine/grid.h"
#include "image/coprocess.h"

enum {
    PATH_MOST = 4096,
    FORMAT_MOST = VOLUME_WORD_BYTES - 1,
    TYPE_MOST = 8,
    NOTES_MOST = 1200,
    VOLUMES_MOST = 1000000,
    FILES_MOST = 1000000,
    PIECE_MOST = 4 << 20,
    NUMBERS = 14,
    SPACING = 1, /* in KNOWN */
    PLACE = 2,
    CLOSE = 4,
    FOLLOW_LINKS = 1, /* in FLAGS */
    FILL_GAPS = 2,
    SHOW_LIST = 4,
    ALONE = 8,
    CHOSEN = 16,
    REFERENCES = 32,
    IDENTITY = 64,
    LIST_MOST = 200100,
    NAMES_MOST = 16 << 20,
    REFERENCE_MOST = 256,
    SERIES_MOST = 100000,
    BYTES_PER_MS = 20000,
};

/* Memory for libraries and headers, before the size of the volume is known. */
static const uint64_t HELD_BEFORE = UINT64_C(1) << 30;

/* A file that claims more bytes than this needs a byte for each PACKED_BEST of them. */
static const uint64_t CLAIMED_FREELY = UINT64_C(64) << 20;
static const uint64_t PACKED_BEST = 1032;

const char *volume_helper_program;
int volume_helper_patience_ms = 60000;
uint64_t volume_helper_memory_most;
bool volume_helper_is_wary;
bool volume_helper_needs_landlock;

struct volume_helper {
    struct source_decoder decoder; /* first: the source points to it */
    struct coprocess process;
    uint64_t left;   /* bytes left of the current piece */
    struct buf room; /* the folder that it may write into; empty for none */
};

/* End the helper and remove its folder. */
static void free_helper(struct source_decoder *decoder)
{
    struct volume_helper *helper = (struct volume_helper *)decoder;
    coprocess_release(&helper->process);
    if (helper->room.length)
        folder_remove(buf_text(&helper->room));
    buf_release(&helper->room);
    free(helper);
}

/* Receive the next bytes of the voxels. */
static enum err take_bytes(struct source_decoder *decoder, void *to, size_t length,
                           struct fault *fault)
{
    struct volume_helper *helper = (struct volume_helper *)decoder;
    static const int64_t most = PIECE_MOST;
    struct coprocess *process = &helper->process;
    uint8_t *at = to;
    while (length > 0) {
        char line[COPROCESS_LINE];
        int64_t piece;
        const char *rest = line;
        if (helper->left == 0) {
            TRY(coprocess_answer(process, line, NULL, NULL, fault));
            if (!scan_text(&rest, "piece ") || !coprocess_numbers(rest, 1, &most, &piece)) {
                coprocess_odd(process);
                return coprocess_fault(process, NULL, NULL, fault);
            }
            helper->left = (uint64_t)piece;
        }
        const size_t n = helper->left < length ? (size_t)helper->left : length;
        if (!coprocess_receive(process, at, n))
            return coprocess_fault(process, NULL, NULL, fault);
        at += n;
        length -= n;
        helper->left -= n;
    }
    return OK;
}

/* ---- the kind of a file ---- */

struct kind {
    const char *name, *endings; /* "" if only a folder or first bytes identify it */
    unsigned at;                /* position of the first bytes */
    unsigned length;
    const char *bytes;
};

static const struct kind kinds[] = {
    {"dicom", ".dcm|.dicom|.ima", 128, 4, "DICM"}, /* first: any bytes may precede it */
    {"nrrd", ".nrrd|.nhdr", 0, 7, "NRRD000"},
    {"meta", ".mha|.mhd", 0, 10, "ObjectType"},
    {"meta", ".mha|.mhd", 0, 5, "NDims"},
    {"minc", ".mnc|.mnc2", 0, 3, "CDF"},
    {"hdf5", ".h5|.hdf5|.hdf|.mnc|.mnc2|.ims", 0, 4, "\x89HDF"},
    {"mrc", ".mrc|.map|.rec|.st", 208, 4, "MAP "},
    {"tiff", "", 0, 4, "II*"},
    {"tiff", "", 0, 4, "MM\0*"},
    {"tiff", "", 0, 4, "II+"},
    {"tiff", "", 0, 4, "MM\0+"},
    {"png", "", 0, 4, "\x89PNG"},
    {"vtk", ".vtk", 0, 14, "# vtk DataFile"},
    {"gipl", ".gipl", 252, 4, "\x2a\xe3\x89\xb8"},
    {"gipl", ".gipl", 252, 4, "\xef\xff\xe9\xb0"},
};
enum { KINDS = sizeof kinds / sizeof kinds[0] };

/* Find the kind by the first bytes of a file; NULL for none. */
static const char *kind_by_bytes(const uint8_t *begin, size_t length)
{
    for (const struct kind *k = kinds; k < kinds + KINDS; k++)
        if (k->at + k->length <= length && memcmp(begin + k->at, k->bytes, k->length) == 0)
            return k->name;
    return NULL;
}

static bool recognises(const uint8_t *begin, size_t length)
{
    return kind_by_bytes(begin, length) != NULL;
}

static const char *kind_of(struct volume_source *source)
{
    uint8_t begin[512];
    if (source->is_folder)
        return "folder";
    const char *name = kind_by_bytes(begin, source_peek(source, begin, sizeof begin));
    for (int i = 0; i < KINDS && !name; i++)
        if (*kinds[i].endings && file_is_named(source->path, kinds[i].endings))
            name = kinds[i].name;
    return name ? name : "any";
}

/* ---- the request ---- */

/* Start a helper for the source, which owns it then. MINC 1 is read by way of a MINC 2 that the
 * library writes into a folder; the folder is removed however the helper ends. */
static enum err start_helper(struct volume_source *source, struct fault *fault)
{
    struct volume_helper *helper = mem_new(sizeof *helper);
    const uint64_t available = mem_available(), most = volume_helper_memory_most;
    uint8_t first[3];
    if (!helper)
        return fault_memory(fault, "the volume helper");
    helper->decoder = (struct source_decoder){take_bytes, free_helper};
    source->decoder = &helper->decoder;
    struct coprocess *process = &helper->process;
    TRY(coprocess_init(process, VOLUME_HELPER, volume_helper_program, fault));
    process->kind = "the volume helper";
    process->hint = " (NIfTI, MGH, NRRD in one file and raw voxels work without it)";
    process->made_of = COPROCESS_OF_ITK;
    process->package = "iftty-volume";
    process->patience_ms = volume_helper_patience_ms;
    process->watch = source->watch;
    process->doing = "reading";
    process->memory = most && most < available ? most : available;
    TRY(coprocess_start(process, fault));
    if (!coprocess_limit(process, HELD_BEFORE, process->memory))
        return fault_errno(fault, "limit the memory of", process->program);
    if (source_peek(source, first, sizeof first) < sizeof first ||
        memcmp(first, "CDF", sizeof first) != 0)
        return OK;
    return fault_prefix(fault, folder_temporary(&helper->room, NULL, fault),
                        "it is MINC 1, which needs room in $TMPDIR to read; `mincconvert -2` "
                        "converts it to MINC 2");
}

static bool send_request(struct volume_helper *helper, const char *kind, const char *path,
                         const struct volume_choice *choice)
{
    struct coprocess *process = &helper->process;
    char line[COPROCESS_LINE];
    const char *text[] = {choice->series_name ? choice->series_name : "",
                          choice->skip ? choice->skip : "",
                          choice->data ? choice->data : "",
                          choice->segments ? choice->segments : "",
                          buf_text(&helper->room),
                          path};
    enum { TEXTS = sizeof text / sizeof *text };
    const unsigned flags =
        (volume_helper_is_wary ? 0u : (unsigned)FOLLOW_LINKS) |
        (choice->fills_gaps ? (unsigned)FILL_GAPS : 0u) |
        (choice->list ? (unsigned)SHOW_LIST : 0u) | (choice->has_volume ? (unsigned)CHOSEN : 0u) |
        (choice->proof ? (unsigned)ALONE : 0u) | (choice->references ? (unsigned)REFERENCES : 0u) |
        (choice->keeps_identity ? (unsigned)IDENTITY : 0u);
    int length =
        snprintf(line, sizeof line, "open %s %u %" PRIu32 " %" PRIu32 " %" PRIu32 " %" PRIu32, kind,
                 flags, choice->series, choice->volume, choice->threshold, choice->step_nm);
    for (int i = 0; i < TEXTS; i++)
        length += snprintf(line + length, sizeof line - (size_t)length, " %zu%s", strlen(text[i]),
                           i + 1 < TEXTS ? "" : "\n");
    bool goes = coprocess_transmit(process, line, (size_t)length);
    for (int i = 0; i < TEXTS; i++)
        goes = goes && coprocess_transmit(process, text[i], strlen(text[i]));
    return goes;
}

static bool are_lines(const char *text, size_t length)
{
    for (size_t i = 0; i < length; i++)
        if (text[i] != '\n' && (text[i] < ' ' || text[i] > '~'))
            return false;
    return true;
}

/* Receive lines for the user and append them to the caller's list, once. */
static bool receive_list(struct buf *list, struct coprocess *process, const char *length)
{
    static const int64_t most = LIST_MOST;
    char piece[1024];
    int64_t left = 0;
    if (!list || list->length || !coprocess_numbers(length, 1, &most, &left) || left < 1)
        return coprocess_odd(process);
    for (size_t n; left > 0; left -= (int64_t)n) {
        n = left < (int64_t)sizeof piece ? (size_t)left : sizeof piece;
        if (!coprocess_receive(process, piece, n))
            return false;
        if (!are_lines(piece, n))
            return coprocess_odd(process);
        buf_add(list, piece, n);
    }
    return true;
}

/* Receive one line about the volumes. */
static bool receive_contents(char out[VOLUME_CONTENTS_BYTES], struct coprocess *process,
                             const char *length)
{
    static const int64_t most = VOLUME_CONTENTS_BYTES - 1;
    int64_t n;
    if (*out || !coprocess_numbers(length, 1, &most, &n))
        return coprocess_odd(process);
    if (!coprocess_receive(process, out, (size_t)n))
        return false;
    out[n] = '\0';
    return (are_lines(out, (size_t)n) && !strchr(out, '\n')) || coprocess_odd(process);
}

static bool receive_text(struct buf *out, struct coprocess *process, int64_t length)
{
    char *to = buf_reserve(out, (size_t)length);
    if (!to || !coprocess_receive(process, to, (size_t)length))
        return to ? false : coprocess_odd(process);
    out->length += (size_t)length;
    to[length] = '\0';
    return true;
}

/* Receive the number of voxels in several segments, and the names of segments. */
static bool receive_segments(struct volume_header *out, struct coprocess *process, const char *line)
{
    static const int64_t most[2] = {INT64_MAX / 10, NAMES_MOST};
    OWNED(buf_release) struct buf unused = {0};
    int64_t number[2];
    if (out->is_segments || !coprocess_numbers(line, 2, most, number))
        return coprocess_odd(process);
    out->is_segments = true;
    out->overlaps = (uint64_t)number[0];
    return receive_text(out->choice.names ? out->choice.names : &unused, process, number[1]);
}

/* Receive lines about the series, each of a length that fits DICOM. */
static bool receive_references(struct buf *out, struct coprocess *process, const char *line)
{
    static const int64_t most = NAMES_MOST;
    int64_t length;
    if (!out || out->length || !coprocess_numbers(line, 1, &most, &length))
        return coprocess_odd(process);
    buf_add_char(out, '\n');
    if (!receive_text(out, process, length))
        return false;
    size_t begin = 0;
    for (size_t i = 0; i < out->length; i++) {
        if (out->data[i] == '\n')
            begin = i;
        else if ((unsigned char)out->data[i] < ' ' || i - begin > REFERENCE_MOST)
            return coprocess_odd(process);
    }
    return true;
}

/* Receive the line that answers, after lines of progress, each further than the one before, and
 * lines about series and volumes. */
static enum err receive_answer(struct volume_header *out, struct coprocess *process,
                               char line[COPROCESS_LINE], struct fault *fault)
{
    static const int64_t most[2] = {FILES_MOST, FILES_MOST}, most_series = SERIES_MOST,
                         most_frame = UINT32_MAX;
    bool fine = true;
    for (int64_t before = -1; fine;) {
        int64_t number[2];
        const char *at = line;
        TRY(coprocess_answer(process, line, NULL, NULL, fault));
        if (scan_text(&at, "list "))
            fine = receive_list(out->choice.list, process, at);
        else if (scan_text(&at, "references "))
            fine = receive_references(out->choice.references, process, at);
        else if (scan_text(&at, "segments "))
            fine = receive_segments(out, process, at);
        else if (scan_text(&at, "contents "))
            fine = receive_contents(out->contents, process, at);
        else if (out->series == 0 && scan_text(&at, "series ") &&
                 coprocess_numbers(at, 1, &most_series, number))
            out->series = (uint32_t)number[0];
        else if (out->geometry.frame == 0 && scan_text(&at, "frame ") &&
                 coprocess_numbers(at, 1, &most_frame, number))
            out->geometry.frame = (uint32_t)number[0];
        else if (!scan_text(&at, "progress "))
            return OK;
        else if (!coprocess_numbers(at, 2, most, number) || number[0] <= before)
            fine = coprocess_odd(process);
        else {
            before = number[0];
            if (watch_poll(process->watch, "files", (uint64_t)number[0], (uint64_t)number[1]))
                return watch_fault(process->watch, fault);
        }
    }
    return coprocess_fault(process, NULL, NULL, fault);
}

/* ---- the header ---- */

/* Receive the header: the line and the bytes after it; false if they are invalid. */
static bool receive_header(struct volume_header *out, struct coprocess *process, const char *line,
                           double number[NUMBERS], bool *is_close)
{
    enum { VOLUMES = 3, KNOWN, FORMAT_LENGTH, TYPE_LENGTH, NOTES_LENGTH, VALUES };
    static const int64_t most[VALUES] = {UINT16_MAX, UINT16_MAX,  UINT16_MAX, VOLUMES_MOST,
                                         7,          FORMAT_MOST, TYPE_MOST,  NOTES_MOST};
    int64_t value[VALUES];
    double to_mm[3][4];
    if (!scan_text(&line, "volume ") || !coprocess_numbers(line, VALUES, most, value) ||
        value[0] < 1 || value[1] < 1 || value[2] < 1 || value[VOLUMES] < 1)
        return coprocess_odd(process);
    out->format[value[FORMAT_LENGTH]] = out->type_name[value[TYPE_LENGTH]] = '\0';
    out->notes[value[NOTES_LENGTH]] = '\0';
    if (!coprocess_receive(process, out->format, (size_t)value[FORMAT_LENGTH]) ||
        !coprocess_receive(process, out->type_name, (size_t)value[TYPE_LENGTH]) ||
        !coprocess_receive(process, out->notes, (size_t)value[NOTES_LENGTH]) ||
        !(are_lines(out->notes, strlen(out->notes)) || coprocess_odd(process)) ||
        !coprocess_receive(process, number, NUMBERS * sizeof *number))
        return false;
    for (int a = 0; a < 3; a++)
        out->size[a] = (uint32_t)value[a];
    out->volumes = (uint32_t)value[VOLUMES];
    out->big_endian = __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__;
    memcpy(to_mm, number, sizeof to_mm);
    header_place(out, (const double(*)[4])to_mm, value[KNOWN] & SPACING, value[KNOWN] & PLACE);
    *is_close = value[KNOWN] & CLOSE;
    return true;
}

/* Receive the header and check it against the size of the file. */
static enum err receive_checked(struct volume_header *out, struct coprocess *process,
                                const char *line, struct fault *fault)
{
    double number[NUMBERS];
    struct grid grid;
    bool is_close = false;
    if (!receive_header(out, process, line, number, &is_close))
        return coprocess_fault(process, NULL, NULL, fault);
    if (!voxel_type_named(&out->type, out->type_name))
        snprintf(out->refusal, sizeof out->refusal, "its voxels are %s, which are not read",
                 out->type_name);
    out->geometry.slope = number[12];
    out->geometry.intercept = number[13];
    if (!isfinite(number[12]) || !isfinite(number[13]) || number[12] == 0)
        return fault_set(fault, ERR_INPUT,
                         "its numbers are scaled by %g and %g; expected finite ones", number[12],
                         number[13]);
    TRY(grid_init(&grid, out->size, fault));
    size_t bytes = voxel_bytes(out->type);
    for (int a = 0; a < 3; a++)
        if (!size_multiply(bytes, out->size[a], &bytes))
            return fault_set(fault, ERR_LIMIT, "its voxels do not fit the memory of any machine");
    if (!is_close && bytes > CLAIMED_FREELY && bytes / PACKED_BEST > out->bytes)
        return fault_set(fault, ERR_INPUT,
                         "cut short or false: its header claims %zu bytes of voxels, and it has "
                         "%" PRIu64 " bytes",
                         bytes, out->bytes);
    return OK;
}

enum err volume_helper_read_header(struct volume_header *out, struct volume_source *source,
                                   struct fault *fault)
{
    char line[COPROCESS_LINE];
    const char *kind = kind_of(source);
    if (source->packed)
        return fault_set(fault, ERR_INPUT, "packed by gzip; `gunzip` it first");
    if (strlen(source->path) > PATH_MOST)
        return fault_set(fault, ERR_INPUT, "a path of more than %d bytes", PATH_MOST);
    if (out->choice.segments && strlen(out->choice.segments) > PATH_MOST)
        return fault_set(fault, ERR_USAGE, "regions: a list of more than %d bytes", PATH_MOST);
    if (volume_helper_needs_landlock && !confine_version())
        return fault_set(fault, ERR_INPUT,
                         "its reader is a library, and this kernel has no Landlock to keep it to "
                         "this file; `--unconfined` has it read all the same");
    TRY(start_helper(source, fault));
    struct volume_helper *helper = (struct volume_helper *)source->decoder;
    if (source->is_folder || strcmp(kind, "nrrd") == 0 || strcmp(kind, "meta") == 0 ||
        strcmp(kind, "any") == 0) /* its voxels may be in another file */
        out->bytes = UINT64_MAX;
    if (!send_request(helper, kind, source->path, &out->choice))
        return coprocess_fault(&helper->process, NULL, NULL, fault);
    TRY(receive_answer(out, &helper->process, line, fault));
    return receive_checked(out, &helper->process, line, fault);
}

/* Raise its limits of memory, for the volume and a second one in transfer, and of time. */
enum err volume_helper_begin_voxels(const struct volume_header *header,
                                    struct volume_source *source, struct fault *fault)
{
    struct coprocess *process = &((struct volume_helper *)source->decoder)->process;
    const uint32_t *whole = header->whole;
    const uint64_t bytes =
        (uint64_t)whole[0] * whole[1] * whole[2] * voxel_bytes(header->type) * header->volumes;
    const uint64_t more_ms = bytes / BYTES_PER_MS;
    process->patience_ms += more_ms < INT32_MAX / 2 ? (int)more_ms : INT32_MAX / 2;
    if (!coprocess_limit(process, HELD_BEFORE + 2 * bytes, process->memory))
        return fault_errno(fault, "limit the memory of", process->program);
    return coprocess_transmit(process, "voxels\n", 7) ? OK
                                                      : coprocess_fault(process, NULL, NULL, fault);
}

extern const struct volume_format helped_format;
const struct volume_format helped_format = {
    .name = "DICOM, MetaImage, MINC, HDF5, MRC, TIFF, VTK and GIPL",
    .endings = ".nrrd|.nhdr|.mha|.mhd|.mnc|.mnc2|.h5|.hdf5|.hdf|.ims|.mrc|.map|.rec|.st|.dcm|.ima|"
               ".dicom|.lsm|.vtk|.gipl",
    .takes = TAKES_FOLDERS,
    .recognises = recognises,
    .read_header = volume_helper_read_header,
    .begin_voxels = volume_helper_begin_voxels,
};
