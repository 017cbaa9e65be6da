#include "image/nifti.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include "base/mem.h"
#include "base/safe.h"
#include "engine/grid.h"
#include "image/inflate.h"
#include "image/nifti_header.h"

/* Deflate at its best: 258 bytes for two bits. */
static const uint64_t DEFLATE_MOST = 1032;

/* Extensions longer than this are an accident or an attack; the longest known are some MB. */
static const double OFFSET_MOST = 256 << 20;

enum {
    TYPE_UINT8 = 2,
    TYPE_INT16 = 4,
    TYPE_FLOAT32 = 16,
    TYPE_UINT16 = 512,
    TYPE_UINT32 = 768,
    PACKED_CHUNK = 256 << 10, /* bytes that zlib reads or writes at a time */
    HEADER_CHUNK = 16 << 10,  /* where that is for the header alone */
    BEYOND_MOST = 64 << 10,   /* a multiple of 4096 */
};

/* The file, seen through zlib, which passes plain bytes on as they are. */
struct source {
    gzFile gz;
    int fd;         /* owned by gz */
    uint64_t bytes; /* of the file on disk */
    bool packed;    /* gzip */
};

/* Voxels of small files are not read through zlib, so that it need not read far. */
static enum err source_open(struct source *source, const char *path, struct fault *fault)
{
    struct stat status;
    *source = (struct source){0};
    int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
    if (fd < 0 || fstat(fd, &status) != 0) {
        enum err err = fault_errno(fault, "open", path);
        if (fd >= 0)
            close(fd);
        return err;
    }
    if (!S_ISREG(status.st_mode)) {
        close(fd);
        return fault_set(fault, ERR_INPUT, "%s is not a regular file", path);
    }
    source->gz = gzdopen(fd, "rb");
    if (!source->gz) {
        close(fd);
        return fault_memory(fault, path);
    }
    source->fd = fd;
    source->bytes = (uint64_t)status.st_size;
    gzbuffer(source->gz, source->bytes > INFLATE_PACKED_MOST ? PACKED_CHUNK : HEADER_CHUNK);
    source->packed = !gzdirect(source->gz);
    return OK;
}

static void source_close(struct source *source)
{
    if (source->gz)
        gzclose_r(source->gz);
    source->gz = NULL;
}

/* Why `source` gave less than it was asked for. */
static enum err source_fault(struct source *source, const char *part, struct fault *fault)
{
    int number = errno, code;
    gzerror(source->gz, &code);
    if (code == Z_ERRNO)
        return fault_set(fault, ERR_IO, "cannot read: %s", strerror(number));
    if (code == Z_MEM_ERROR)
        return fault_memory(fault, "inflating");
    if (code == Z_DATA_ERROR)
        return fault_set(fault, ERR_INPUT,
                         "damaged: its gzip data or checksum is wrong (in %s); fetch it again",
                         part);
    return fault_set(fault, ERR_INPUT,
                     "cut short: it ends within %s (%" PRIu64 " bytes on disk); fetch it again",
                     part, source->bytes);
}

static enum err source_read(struct source *source, void *to, size_t length, const char *part,
                            struct watch *watch, struct fault *fault)
{
    const size_t piece_most = 1 << 20; /* gzread counts in int, and the watch wants to look */
    struct task task = task_begin(watch, "reading", length);
    uint8_t *at = to;
    while (length > 0) {
        unsigned piece = (unsigned)(length < piece_most ? length : piece_most);
        int n = gzread(source->gz, at, piece);
        if (n <= 0)
            return source_fault(source, part, fault);
        at += n;
        length -= (size_t)n;
        if (!task_advance(&task, (uint64_t)n))
            return watch_fault(watch, fault);
    }
    return OK;
}

/* Reads a little on: where the stream ends soon after the voxels, as it should, zlib compares its
 * checksum. What goes on for longer is left alone. */
static enum err source_end(struct source *source, struct fault *fault)
{
    char beyond[4096];
    int code;
    for (size_t left = BEYOND_MOST; left > 0; left -= sizeof beyond)
        if (gzread(source->gz, beyond, sizeof beyond) < (int)sizeof beyond) {
            gzerror(source->gz, &code);
            return code == Z_OK || code == Z_STREAM_END
                       ? OK
                       : source_fault(source, "its checksum", fault);
        }
    return OK;
}

static const char *type_name(int64_t datatype)
{
    static const struct {
        int16_t code;
        const char *name;
    } known[] = {
        {1, "binary"},    {2, "uint8"},       {4, "int16"},         {8, "int32"},
        {16, "float32"},  {32, "complex64"},  {64, "float64"},      {128, "rgb24"},
        {256, "int8"},    {512, "uint16"},    {768, "uint32"},      {1024, "int64"},
        {1280, "uint64"}, {1536, "float128"}, {1792, "complex128"}, {2048, "complex256"},
        {2304, "rgba32"},
    };
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++)
        if (known[i].code == datatype)
            return known[i].name;
    return "unknown";
}

/* Bytes of a voxel, or 0 for a type that is not read. */
static size_t type_bytes(int64_t datatype)
{
    switch (datatype) {
    case TYPE_UINT8:
        return 1;
    case TYPE_INT16:
    case TYPE_UINT16:
        return 2;
    case TYPE_FLOAT32:
        return 4;
    default:
        return 0;
    }
}

static enum err read_header(struct nifti_header *header, struct source *source, struct fault *fault)
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
    return err;
}

/* Three dimensions, further ones of one voxel only, and no more than a grid holds. */
static enum err read_size(uint32_t size[3], const struct nifti_header *header, struct grid *grid,
                          struct fault *fault)
{
    const int64_t *dim = header->dim;
    if (dim[0] < 2 || dim[0] > 7)
        return fault_set(fault, ERR_INPUT, "dim[0] is %" PRId64 "; expected 3 dimensions", dim[0]);
    size[2] = 1;
    for (int a = 1; a <= dim[0]; a++) {
        if (dim[a] < 1)
            return fault_set(fault, ERR_INPUT,
                             "dim[%d] is %" PRId64 "; expected at least one voxel", a, dim[a]);
        if (a > 3 && dim[a] > 1)
            return fault_set(fault, ERR_INPUT,
                             "dim[%d] is %" PRId64 ": a series; expected one 3-D volume", a,
                             dim[a]);
        if (dim[a] > UINT32_MAX)
            return fault_set(fault, ERR_LIMIT,
                             "dim[%d] is %" PRId64 "; expected at most 65534 voxels a side", a,
                             dim[a]);
        if (a <= 3)
            size[a - 1] = (uint32_t)dim[a];
    }
    return grid_init(grid, size, fault);
}

static enum err check_scale(struct nifti_header *header, struct fault *fault)
{
    if (header->scl_slope == 0) { /* nifti1.h: no scaling is told then, of either kind */
        header->scl_slope = 1;
        header->scl_inter = 0;
    }
    if (!isfinite(header->scl_slope) || !isfinite(header->scl_inter))
        return fault_set(fault, ERR_INPUT,
                         "scl_slope is %g and scl_inter %g; expected finite numbers",
                         header->scl_slope, header->scl_inter);
    return OK;
}

/* Where the voxels begin, and that a file of this size can hold `needed` bytes of them. */
static enum err read_offset(uint64_t *offset, const struct nifti_header *header, size_t needed,
                            const struct source *source, struct fault *fault)
{
    const double least = (double)header->bytes + 4; /* four bytes tell whether extensions follow */
    const double given = header->vox_offset == 0 ? least : header->vox_offset;
    if (!(given >= least && given <= OFFSET_MOST) || given != floor(given))
        return fault_set(fault, ERR_INPUT,
                         "vox_offset is %g; expected a whole number of bytes from %g to %g",
                         header->vox_offset, least, OFFSET_MOST);
    *offset = (uint64_t)given;
    uint64_t most = source->bytes;
    if (source->packed)
        most = most > UINT64_MAX / DEFLATE_MOST ? UINT64_MAX : most * DEFLATE_MOST;
    if (most < *offset || most - *offset < needed)
        return fault_set(
            fault, ERR_INPUT,
            "cut short or false: its header claims %zu bytes of voxels from byte %" PRIu64
            ", but %" PRIu64 " bytes%s hold at most %" PRIu64,
            needed, *offset, source->bytes, source->packed ? " of gzip" : "", most);
    return OK;
}

static void swap_16(uint16_t *value, size_t count)
{
    for (size_t i = 0; i < count; i++)
        value[i] = (uint16_t)(value[i] << 8 | value[i] >> 8);
}

static void swap_32(uint32_t *value, size_t count)
{
    for (size_t i = 0; i < count; i++)
        value[i] = __builtin_bswap32(value[i]);
}

static bool host_is_big_endian(void)
{
    return __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__;
}

/* Spreads `count` bytes from the upper half of an array over the whole of it. Piecewise through a
 * small buffer: the compiler cannot see that reading stays ahead of writing. */
static void widen_bytes(uint16_t *value, size_t count)
{
    const uint8_t *from = (const uint8_t *)value + count;
    uint8_t piece[4096];
    for (size_t done = 0; done < count;) {
        size_t n = count - done < sizeof piece ? count - done : sizeof piece;
        memcpy(piece, from + done, n);
        for (size_t i = 0; i < n; i++)
            value[done + i] = piece[i];
        done += n;
    }
}

/* Signed to unsigned by the least value; returns what was added to every voxel's value. */
static int shift_signed(uint16_t *value, size_t count)
{
    int least = 0;
    for (size_t i = 0; i < count; i++) {
        int v = (int16_t)value[i];
        least = v < least ? v : least;
    }
    for (size_t i = 0; i < count; i++)
        value[i] = (uint16_t)((int16_t)value[i] - least);
    return least;
}

/* Floats to 16 bits, in place: a voxel's two bytes never lie behind its four. */
static enum err quantise(void *voxels, const struct grid *grid, double *factor, double *least,
                         struct fault *fault)
{
    const unsigned char *from = voxels;
    unsigned char *to = voxels;
    float low = INFINITY, high = -INFINITY, value;
    for (size_t i = 0; i < grid->voxels; i++) {
        memcpy(&value, from + 4 * i, sizeof value);
        if (!isfinite(value)) {
            struct place p = {(uint32_t)(i % grid->size[0]),
                              (uint32_t)(i / grid->size[0] % grid->size[1]),
                              (uint32_t)(i / grid->size[0] / grid->size[1])};
            return fault_set(fault, ERR_INPUT, "voxel %u,%u,%u is %s; expected finite numbers", p.x,
                             p.y, p.z, isnan(value) ? "not a number (NaN)" : "infinite");
        }
        low = value < low ? value : low;
        high = value > high ? value : high;
    }
    const double base = (double)low;
    const double range = (double)high - base;
    for (size_t i = 0; i < grid->voxels; i++) {
        memcpy(&value, from + 4 * i, sizeof value);
        double part = range > 0 ? ((double)value - base) / range : 0;
        uint16_t intensity = (uint16_t)(part * 65535 + 0.5);
        memcpy(to + 2 * i, &intensity, sizeof intensity);
    }
    *factor = range > 0 ? range / 65535 : 1;
    *least = base;
    return OK;
}

/* Turns the file's voxels, in `voxels`, into intensities, and tells the way back. */
static enum err convert(void *voxels, const struct nifti_header *header, const struct grid *grid,
                        struct geometry *geometry, struct fault *fault)
{
    const bool swap = header->big_endian != host_is_big_endian();
    double factor = 1, least = 0;
    enum err err = OK;
    if (swap && type_bytes(header->datatype) == 2)
        swap_16(voxels, grid->voxels);
    if (swap && type_bytes(header->datatype) == 4)
        swap_32(voxels, grid->voxels);
    if (header->datatype == TYPE_UINT8)
        widen_bytes(voxels, grid->voxels);
    else if (header->datatype == TYPE_INT16)
        least = shift_signed(voxels, grid->voxels);
    else if (header->datatype == TYPE_FLOAT32)
        err = quantise(voxels, grid, &factor, &least, fault);
    geometry->slope = header->scl_slope * factor;
    geometry->intercept = header->scl_slope * least + header->scl_inter;
    return err;
}

/* That the voxels are of a type that is read, and where they lie. */
static enum err plan_voxels(size_t *needed, uint64_t *offset, struct nifti_header *header,
                            const struct grid *grid, struct source *source, struct fault *fault)
{
    if (type_bytes(header->datatype) == 0)
        return fault_set(fault, ERR_INPUT,
                         "its voxels are %s (datatype %" PRId64
                         "); expected uint8, int16, uint16 or float32",
                         type_name(header->datatype), header->datatype);
    enum err err = check_scale(header, fault);
    if (!err && !size_multiply(grid->voxels, type_bytes(header->datatype), needed))
        err = fault_set(fault, ERR_LIMIT, "its voxels do not fit the memory of any machine");
    if (!err)
        err = read_offset(offset, header, *needed, source, fault);
    return err;
}

/* Everything that can be told from the header alone, before anything large is allocated. */
static enum err read_plan(struct volume *volume, struct nifti_header *header, struct grid *grid,
                          size_t *needed, uint64_t *offset, struct source *source,
                          struct fault *fault)
{
    enum err err = read_header(header, source, fault);
    if (!err)
        err = read_size(volume->size, header, grid, fault);
    if (!err)
        err = plan_voxels(needed, offset, header, grid, source, fault);
    if (!err)
        err = nifti_header_geometry(&volume->geometry, header, fault);
    return err;
}

/* Reads the file's voxels to `to`, by zlib. */
static enum err stream_voxels(uint8_t *to, size_t needed, uint64_t offset, struct source *source,
                              struct watch *watch, struct fault *fault)
{
    enum err err = OK;
    if (gzseek(source->gz, (z_off_t)offset, SEEK_SET) < 0)
        err = source_fault(source, "the extensions of its header", fault);
    if (!err)
        err = source_read(source, to, needed, "the voxels", watch, fault);
    if (!err && source->packed)
        err = source_end(source, fault);
    return err;
}

/* Whether the file may be inflated as a whole, header and all. */
static bool fits_at_once(const struct source *source, size_t needed, uint64_t offset)
{
    return source->packed && source->bytes <= INFLATE_PACKED_MOST && needed <= INFLATE_MOST &&
           offset <= INFLATE_MOST - needed;
}

/* Has the voxels end up behind `lead` bytes of `voxels`, where there is room for them and for
 * `offset` bytes more, before or behind them. False where this file is not one for that. */
static bool inflate_voxels(uint8_t *voxels, size_t lead, size_t needed, size_t offset,
                           const struct source *source)
{
    uint8_t *begin = lead > offset ? voxels + (lead - offset) : voxels;
    if (!inflate_file(begin, offset + needed, source->fd, source->bytes))
        return false;
    if (begin + offset != voxels + lead)
        memmove(voxels + lead, begin + offset, needed);
    return true;
}

static enum err read_voxels(struct volume *volume, const struct nifti_header *header,
                            const struct grid *grid, size_t needed, uint64_t offset,
                            struct source *source, struct watch *watch, struct fault *fault)
{
    const size_t held = grid->voxels * sizeof(uint16_t);
    const size_t wide = needed > held ? needed : held, lead = wide - needed;
    const bool at_once = fits_at_once(source, needed, offset);
    const size_t room = at_once && offset > lead ? (size_t)offset + needed : wide;
    if (room > mem_available())
        return fault_set(fault, ERR_MEMORY, "%zu MB of voxels; this machine has %zu MB left",
                         room >> 20, mem_available() >> 20);
    uint8_t *voxels = mem_array(room, 1);
    if (!voxels)
        return fault_memory(fault, "the voxels");
    volume->intensity = (uint16_t *)(void *)voxels;
    enum err err = OK;
    if (!at_once || !inflate_voxels(voxels, lead, needed, (size_t)offset, source))
        err = stream_voxels(voxels + lead, needed, offset, source, watch, fault);
    if (!err)
        err = convert(voxels, header, grid, &volume->geometry, fault);
    if (!err)
        err = watch_fault(watch, fault);
    if (!err && room > held) {
        void *smaller = realloc(voxels, held);
        if (smaller)
            volume->intensity = smaller;
    }
    return err;
}

enum err nifti_read(struct volume *out, const char *path, struct watch *watch, struct fault *fault)
{
    struct source source;
    struct nifti_header header;
    struct grid grid;
    size_t needed = 0;
    uint64_t offset = 0;
    *out = (struct volume){0};
    enum err err = source_open(&source, path, fault);
    if (err)
        return err;
    err = read_plan(out, &header, &grid, &needed, &offset, &source, fault);
    if (!err)
        err = read_voxels(out, &header, &grid, needed, offset, &source, watch, fault);
    source_close(&source);
    if (err) {
        volume_release(out);
        fault_prefix(fault, err, "%s", path);
    }
    return err;
}

enum err nifti_about(struct nifti_facts *out, const char *path, struct fault *fault)
{
    struct source source;
    struct nifti_header header;
    struct grid grid;
    size_t needed;
    uint64_t offset;
    *out = (struct nifti_facts){.version = 1};
    enum err err = source_open(&source, path, fault);
    if (err)
        return err;
    err = read_header(&header, &source, fault);
    if (!err)
        err = read_size(out->size, &header, &grid, fault);
    if (!err && type_bytes(header.datatype) > 0)
        err = plan_voxels(&needed, &offset, &header, &grid, &source, fault);
    if (!err)
        err = nifti_header_geometry(&out->geometry, &header, fault);
    source_close(&source);
    if (err)
        return fault_prefix(fault, err, "%s", path);
    out->type = type_name(header.datatype);
    out->version = header.bytes == NIFTI_LEAST_BYTES ? 1 : 2;
    out->big_endian = header.big_endian;
    return OK;
}

enum err nifti_size(uint32_t size[3], const char *path, struct fault *fault)
{
    struct source source;
    struct nifti_header header;
    struct volume plan = {0};
    struct grid grid;
    size_t needed;
    uint64_t offset;
    enum err err = source_open(&source, path, fault);
    if (err)
        return err;
    err = read_plan(&plan, &header, &grid, &needed, &offset, &source, fault);
    source_close(&source);
    memcpy(size, plan.size, sizeof plan.size);
    return err ? fault_prefix(fault, err, "%s", path) : OK;
}

void volume_release(struct volume *volume)
{
    free(volume->intensity);
    *volume = (struct volume){0};
}

/* ---- writing ---- */

static const struct {
    int16_t datatype, bytes;
} written_type[] = {
    [NIFTI_UINT8] = {TYPE_UINT8, 1},
    [NIFTI_UINT16] = {TYPE_UINT16, 2},
    [NIFTI_UINT32] = {TYPE_UINT32, 4},
};

/* The header and the four bytes after it that say "no extensions"; returns their number. */
static unsigned make_header(uint8_t *bytes, const uint32_t size[3], const struct geometry *geometry,
                            enum nifti_type type, const char *description)
{
    struct nifti_header header = {.bytes = NIFTI_LEAST_BYTES, .scl_slope = 1, .dim = {3}};
    for (int a = 1; a < 8; a++) {
        header.dim[a] = a <= 3 ? size[a - 1] : 1;
        if (header.dim[a] > INT16_MAX)
            header.bytes = NIFTI_MOST_BYTES;
    }
    header.datatype = written_type[type].datatype;
    header.bitpix = 8 * written_type[type].bytes;
    header.vox_offset = (double)header.bytes + 4;
    nifti_header_place(&header, geometry);
    size_t length = strnlen(description, sizeof header.descrip - 1), kept = 0;
    while (kept < length) { /* never half a character */
        size_t n = safe_character(description + kept, strlen(description + kept));
        if (kept + (n ? n : 1) > length)
            break;
        kept += n ? n : 1;
    }
    memcpy(header.descrip, description, kept);
    nifti_header_encode(&header, bytes);
    memset(bytes + header.bytes, 0, 4);
    return (unsigned)header.bytes + 4;
}

/* Tests make the step fail here, as they do in the file layer. */
static bool put(gzFile gz, const char *path, const void *bytes, size_t length)
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

struct map {
    const uint32_t *size;
    enum nifti_type type;
    void (*row)(void *context, uint32_t y, uint32_t z, void *values);
    void *context;
    struct watch *watch;
};

/* Also false where the watch stops it. */
static bool put_rows(gzFile gz, const char *path, const struct map *map, void *values)
{
    const size_t bytes = (size_t)map->size[0] * (size_t)written_type[map->type].bytes;
    const uint64_t plane = (uint64_t)map->size[0] * map->size[1];
    struct task task = task_begin(map->watch, "writing", plane * map->size[2]);
    for (uint32_t z = 0; z < map->size[2]; z++)
        for (uint32_t y = 0; y < map->size[1]; y++) {
            map->row(map->context, y, z, values);
            if (host_is_big_endian() && map->type == NIFTI_UINT16)
                swap_16(values, map->size[0]);
            if (host_is_big_endian() && map->type == NIFTI_UINT32)
                swap_32(values, map->size[0]);
            if (!put(gz, path, values, bytes) || !task_advance(&task, map->size[0]))
                return false;
        }
    return true;
}

static enum err write_draft(const char *draft, const char *path, bool packed, const void *header,
                            unsigned header_bytes, const struct map *map, struct fault *fault)
{
    void *values = mem_array(map->size[0], (size_t)written_type[map->type].bytes);
    if (!values)
        return fault_memory(fault, path);
    enum err err = OK;
    gzFile gz = NULL;
    int fd = file_step_fails(FILE_STEP_OPEN, path)
                 ? -1
                 : open(draft, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (fd < 0) {
        err = fault_errno(fault, "write", path);
    } else if (!(gz = gzdopen(fd, packed ? "wb1" : "wbT"))) {
        close(fd);
        err = fault_memory(fault, path);
    }
    if (gz) {
        gzbuffer(gz, PACKED_CHUNK);
        errno = EIO;
        bool fine = put(gz, path, header, header_bytes) && put_rows(gz, path, map, values);
        int number = errno;
        if (gzclose_w(gz) != Z_OK && fine) {
            fine = false;
            number = errno;
        }
        errno = number;
        if (!fine)
            err = map->watch && map->watch->stopped ? watch_fault(map->watch, fault)
                                                    : fault_errno(fault, "write", path);
        if (err)
            file_discard(draft);
    }
    free(values);
    return err;
}

enum err nifti_write(const char *path, enum file_mode mode, const uint32_t size[3],
                     const struct geometry *geometry, enum nifti_type type, const char *description,
                     void (*row)(void *context, uint32_t y, uint32_t z, void *values),
                     void *context, struct watch *watch, struct fault *fault)
{
    const bool packed = file_is_named(path, ".nii.gz");
    const struct map map = {size, type, row, context, watch};
    uint8_t header[NIFTI_MOST_BYTES + 4];
    struct grid grid;
    struct buf draft = {0};
    if (!packed && !file_is_named(path, ".nii"))
        return fault_set(fault, ERR_USAGE, "cannot write %s: expected a name in .nii or .nii.gz",
                         path);
    enum err err = grid_init(&grid, size, fault);
    if (!err)
        err = file_draft(&draft, path, mode, fault);
    if (!err) {
        unsigned header_bytes = make_header(header, size, geometry, type, description);
        err = write_draft(buf_text(&draft), path, packed, header, header_bytes, &map, fault);
    }
    if (!err)
        err = file_publish(buf_text(&draft), path, mode, fault);
    buf_release(&draft);
    return err;
}
