/* SPDX-License-Identifier: MIT */
#include "image/volume_format.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <zlib.h>

#include "base/file.h"
#include "base/mem.h"
#include "engine/grid.h"

enum { PACKED_CHUNK = 256 << 10 /* bytes that zlib writes at a time */ };

/* ---- voxels ---- */

static const struct {
    const char *name;
    unsigned bytes;
} types[] = {[VOXEL_INT8] = {"int8", 1},       [VOXEL_UINT8] = {"uint8", 1},
             [VOXEL_INT16] = {"int16", 2},     [VOXEL_UINT16] = {"uint16", 2},
             [VOXEL_INT32] = {"int32", 4},     [VOXEL_UINT32] = {"uint32", 4},
             [VOXEL_INT64] = {"int64", 8},     [VOXEL_UINT64] = {"uint64", 8},
             [VOXEL_FLOAT32] = {"float32", 4}, [VOXEL_FLOAT64] = {"float64", 8}};

unsigned voxel_bytes(enum voxel_type type)
{
    return types[type].bytes;
}

const char *voxel_type_name(enum voxel_type type)
{
    return types[type].name;
}

bool voxel_type_named(enum voxel_type *out, const char *name)
{
    for (unsigned type = 0; type < sizeof types / sizeof types[0]; type++)
        if (strcmp(name, types[type].name) == 0) {
            *out = (enum voxel_type)type;
            return true;
        }
    return false;
}

size_t voxels_in(const uint32_t size[3])
{
    return (size_t)size[0] * size[1] * size[2];
}

void voxels_reorder(void *value, size_t count, enum voxel_type type, bool big_endian)
{
    uint16_t *two = value;
    uint32_t *four = value;
    uint64_t *eight = value;
    if (big_endian == (__BYTE_ORDER__ == __ORDER_BIG_ENDIAN__))
        return;
    switch (voxel_bytes(type)) {
    case 2:
        for (size_t i = 0; i < count; i++)
            two[i] = (uint16_t)(two[i] << 8 | two[i] >> 8);
        break;
    case 4:
        for (size_t i = 0; i < count; i++)
            four[i] = __builtin_bswap32(four[i]);
        break;
    case 8:
        for (size_t i = 0; i < count; i++)
            eight[i] = __builtin_bswap64(eight[i]);
        break;
    default:
        break;
    }
}

/* ---- reading ---- */

void volume_note(char notes[VOLUME_NOTES_BYTES], const char *format, ...)
{
    const size_t length = strlen(notes), room = VOLUME_NOTES_BYTES - length;
    va_list arguments;
    va_start(arguments, format);
    const int n = vsnprintf(notes + length, room, format, arguments);
    va_end(arguments);
    if (n < 0 || (size_t)n + 1 >= room)
        notes[length] = '\0';
    else
        memcpy(notes + length + n, "\n", 2);
}

enum err voxels_check(const struct volume_header *header, const struct volume_source *source,
                      struct fault *fault)
{
    size_t needed;
    if (!size_multiply(voxels_in(header->size), voxel_bytes(header->type), &needed) ||
        !size_multiply(needed, header->volumes, &needed))
        return fault_set(fault, ERR_LIMIT, "its voxels do not fit the memory of any machine");
    if (source->most < header->offset || source->most - header->offset < needed)
        return fault_set(
            fault, ERR_INPUT,
            "cut short or false: its header claims %zu bytes of voxels from byte %" PRIu64
            ", but %" PRIu64 " bytes%s hold at most %" PRIu64,
            needed, header->offset, source->bytes, source->packed ? " of gzip" : "", source->most);
    return OK;
}

void header_place(struct volume_header *header, const double to_mm[3][4], bool knows_spacing,
                  bool knows_place)
{
    struct geometry *geometry = &header->geometry;
    geometry->spacing_unknown = !knows_spacing;
    memcpy(geometry->to_mm, to_mm, sizeof geometry->to_mm);
    for (int a = 0; a < 3; a++) {
        const double mm = geometry_step_mm(geometry, a);
        if (geometry_spacing(&geometry->spacing_nm[a], mm))
            continue;
        geometry->spacing_unknown = true;
        if (knows_spacing)
            volume_note(header->notes, "the distance of its voxels is %g mm; expected 1 nm to 4 m",
                        mm);
    }
    for (int a = 0; a < 3 && geometry->spacing_unknown; a++)
        geometry->spacing_nm[a] = 1000000;
    if (!knows_place ||
        !geometry_place(geometry, (const double(*)[4])geometry->to_mm, ORIENTATION_FILE))
        geometry_place_spaced(geometry);
}

void voxels_note_rest(struct volume_header *header, const struct volume_source *source,
                      const char *advice)
{
    const uint64_t voxels = (uint64_t)voxels_in(header->size) * header->volumes;
    const uint64_t end = header->offset + voxels * voxel_bytes(header->type);
    if (!source->packed && source->bytes > end)
        volume_note(header->notes, "%" PRIu64 " of its bytes come after the voxels; %s",
                    source->bytes - end, advice);
}

void volume_release(struct volume *volume)
{
    free(volume->intensity);
    free(volume->levels);
    free(volume->value);
    free(volume->number);
    *volume = (struct volume){0};
}

/* ---- writing ---- */

/* Write a piece; tests make this step fail, as they do in the file layer. */
static bool write_bytes(gzFile gz, const char *path, const void *bytes, size_t length)
{
    const uint8_t *at = bytes;
    const size_t piece_most = (size_t)1 << 30;
    while (length > 0) {
        unsigned piece = (unsigned)(length < piece_most ? length : piece_most);
        if (file_step_fails(FILE_STEP_WRITE, path) || gzwrite(gz, at, piece) != (int)piece)
            return false;
        at += piece;
        length -= piece;
    }
    return true;
}

/* Write all rows; false too if the watch stops. */
static bool write_rows(gzFile gz, const char *path, const struct volume_map *map, void *values,
                       struct watch *watch)
{
    const size_t bytes = (size_t)map->size[0] * voxel_bytes(map->type);
    struct task task = task_begin(watch, "writing", voxels_in(map->size) * voxel_bytes(map->type));
    for (uint32_t z = 0; z < map->size[2]; z++)
        for (uint32_t y = 0; y < map->size[1]; y++) {
            map->row(map->context, y, z, values);
            voxels_reorder(values, map->size[0], map->type, false);
            if (!write_bytes(gz, path, values, bytes) || !task_advance(&task, bytes))
                return false;
        }
    return true;
}

/* Write the file `draft`: the header, and the voxels, which may be gzip. */
static enum err write_draft(const char *draft, const char *path, const struct buf *header,
                            enum packing packing, const struct volume_map *map, struct watch *watch,
                            struct fault *fault)
{
    OWNED(mem_release) void *values = mem_array(map->size[0], voxel_bytes(map->type));
    const int fd = values ? file_step_open(draft, O_WRONLY | O_CREAT | O_EXCL) : -1;
    enum err err = OK;
    if (!values)
        return fault_memory(fault, path);
    if (fd < 0 || (packing == PACKED_VOXELS && /* before the stream begins */
                   !file_step_write(fd, path, header->data, header->length)))
        err = fault_errno(fault, "write", path);
    gzFile gz = err ? NULL : gzdopen(fd, packing == PACKED_NOT ? "wbT" : "wb1");
    if (!gz && fd >= 0) {
        err = err ? err : fault_memory(fault, path);
        close(fd);
        file_discard(draft);
    }
    if (gz) {
        gzbuffer(gz, PACKED_CHUNK);
        errno = EIO;
        const bool fine =
            (packing == PACKED_VOXELS || write_bytes(gz, path, header->data, header->length)) &&
            write_rows(gz, path, map, values, watch) &&
            (!map->tail || write_bytes(gz, path, map->tail->data, map->tail->length));
        const int number = errno;
        const bool closed = gzclose_w(gz) == Z_OK;
        if (!fine)
            errno = number;
        if (!fine || !closed) {
            err = watch && watch->stopped ? watch_fault(watch, fault)
                                          : fault_errno(fault, "write", path);
            file_discard(draft);
        }
    }
    return err;
}

enum err voxels_write(const char *path, enum file_mode mode, struct buf *header,
                      enum packing packing, const struct volume_map *map, struct watch *watch,
                      struct fault *fault)
{
    OWNED(buf_release) struct buf draft = {0};
    enum err err = header->failed ? fault_memory(fault, "the header of a volume")
                                  : file_draft(&draft, path, mode, fault);
    if (!err)
        err = write_draft(buf_text(&draft), path, header, packing, map, watch, fault);
    if (!err)
        err = file_publish(buf_text(&draft), path, mode, fault);
    buf_release(header);
    return err;
}

/* ---- raw ----
 *
 * Voxels without a header, x fastest, in a layout that the user states; plain or gzip. The file
 * states neither place nor spacing. Bytes after the last voxel are noted, since they may result
 * from a wrong layout. */

static enum err read_raw(struct volume_header *out, struct volume_source *source,
                         struct fault *fault)
{
    const struct raw_layout *raw = &out->choice.raw;
    struct grid grid;
    TRY(grid_init(&grid, raw->size, fault));
    snprintf(out->format, sizeof out->format, "raw");
    out->type = (enum voxel_type)raw->type;
    snprintf(out->type_name, sizeof out->type_name, "%s", voxel_type_name(out->type));
    out->big_endian = raw->big_endian;
    out->offset = raw->offset;
    memcpy(out->size, raw->size, sizeof out->size);
    out->geometry.slope = 1;
    header_place(out, (const double[3][4]){{1}, {0, 1}, {0, 0, 1}}, false, false);
    TRY(voxels_check(out, source, fault));
    voxels_note_rest(out, source, "check size, type and offset");
    return OK;
}

extern const struct volume_format raw_format;
const struct volume_format raw_format = {
    .name = "raw",
    .endings = "",
    .takes = TAKES_LAYOUTS,
    .read_header = read_raw,
};
