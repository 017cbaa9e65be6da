#include "image/source.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <libdeflate.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <zlib.h>

#include "base/file.h"
#include "base/mem.h"
#include "image/volume_helper.h"

enum {
    DEFLATE_MOST = 1032,      /* deflate at its best: 258 bytes for two bits */
    PACKED_CHUNK = 256 << 10, /* bytes that zlib reads at a time ... */
    HEADER_CHUNK = 16 << 10,  /* ... and where that is for a header alone */
    BEYOND_MOST = 64 << 10,   /* a multiple of 4096 */
    PACKED_MOST = 64 << 20,   /* larger files, packed or inflated, are zlib's */
    INFLATED_MOST = 128 << 20,
    TRAILER = 8, /* of a gzip file: checksum and length, little-endian, 32 bits each */
};

enum err source_open(struct volume_source *source, const char *path, struct watch *watch,
                     struct fault *fault)
{
    int fd;
    *source = (struct volume_source){.path = path, .watch = watch};
    source->is_folder = file_is_folder(path);
    if (source->is_folder)
        return OK;
    const enum err err = file_open(&fd, &source->bytes, path, O_RDONLY, fault);
    if (err)
        return err;
    source->gz = gzdopen(fd, "rb");
    if (!source->gz) {
        close(fd);
        return fault_memory(fault, path);
    }
    source->fd = fd;
    source->most = source->bytes;
    gzbuffer(source->gz, source->bytes > PACKED_MOST ? PACKED_CHUNK : HEADER_CHUNK);
    source->packed = !gzdirect(source->gz);
    if (source->packed && __builtin_mul_overflow(source->bytes, DEFLATE_MOST, &source->most))
        source->most = UINT64_MAX;
    return OK;
}

void source_close(struct volume_source *source)
{
    if (source->gz)
        gzclose_r(source->gz);
    volume_helper_free(source->helper);
    source->gz = NULL;
    source->helper = NULL;
}

enum err source_switch(struct volume_source *source, const char *path, struct fault *fault)
{
    struct volume_source other;
    if (file_is_folder(path))
        return fault_set(fault, ERR_INPUT, "a folder; expected a file");
    const enum err err = source_open(&other, path, source->watch, fault);
    if (err)
        return err;
    other.path = source->path;
    source_close(source);
    *source = other;
    return OK;
}

/* Why `source` gave less than it was asked for. */
static enum err source_fault(struct volume_source *source, const char *part, struct fault *fault)
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

size_t source_peek(struct volume_source *source, uint8_t *bytes, size_t most)
{
    if (source->is_folder)
        return 0;
    const int n = gzread(source->gz, bytes, (unsigned)most);
    gzrewind(source->gz);
    return n > 0 ? (size_t)n : 0;
}

/* The next bytes of its helper. */
static enum err read_helped(struct volume_source *source, void *to, size_t length,
                            struct fault *fault)
{
    const enum err err = volume_helper_take(source->helper, to, length, fault);
    source->at += err ? 0 : length;
    return err;
}

enum err source_read(struct volume_source *source, void *to, size_t length, const char *part,
                     struct watch *watch, struct fault *fault)
{
    const size_t piece_most = 1 << 20; /* gzread counts in int, and the watch is to be polled */
    struct task task = task_begin(watch, "reading", length);
    uint8_t *at = to;
    while (length > 0) {
        unsigned piece = (unsigned)(length < piece_most ? length : piece_most);
        const enum err err = source->helper ? read_helped(source, at, piece, fault) : OK;
        int n = source->helper ? (int)piece : gzread(source->gz, at, piece);
        if (err || n <= 0)
            return err ? err : source_fault(source, part, fault);
        at += n;
        length -= (size_t)n;
        if (!task_advance(&task, (uint64_t)n))
            return watch_fault(watch, fault);
    }
    return OK;
}

enum err source_go_to(struct volume_source *source, uint64_t offset, const char *part,
                      struct fault *fault)
{
    enum err err = OK;
    if (source->helper) {
        uint8_t passed[4096];
        for (size_t n; source->at < offset && !err;) {
            n = offset - source->at < sizeof passed ? (size_t)(offset - source->at) : sizeof passed;
            err = read_helped(source, passed, n, fault);
        }
        return err;
    }
    return gzseek(source->gz, (z_off_t)offset, SEEK_SET) < 0 ? source_fault(source, part, fault)
                                                             : OK;
}

enum err source_finish(struct volume_source *source, struct fault *fault)
{
    char beyond[4096];
    int code;
    for (size_t left = source->packed ? BEYOND_MOST : 0; left > 0; left -= sizeof beyond)
        if (gzread(source->gz, beyond, sizeof beyond) < (int)sizeof beyond) {
            gzerror(source->gz, &code);
            return code == Z_OK || code == Z_STREAM_END
                       ? OK
                       : source_fault(source, "its checksum", fault);
        }
    return OK;
}

/* ---- at once ---- */

/* Whether the file claims this length at its end; most files that do not fit differ here. */
static bool claims(const struct volume_source *source, size_t length)
{
    uint8_t end[4];
    uint32_t claimed = 0;
    if (source->bytes < TRAILER ||
        pread(source->fd, end, sizeof end, (off_t)(source->bytes - sizeof end)) != sizeof end)
        return false;
    for (unsigned i = 0; i < sizeof end; i++)
        claimed |= (uint32_t)end[i] << 8 * i;
    return length == claimed;
}

static bool inflate_bytes(void *out, size_t length, const uint8_t *bytes, size_t packed)
{
    struct libdeflate_decompressor *d = libdeflate_alloc_decompressor();
    size_t taken = 0;
    if (!d)
        return false;
    const enum libdeflate_result result =
        libdeflate_gzip_decompress_ex(d, bytes, packed, out, length, &taken, NULL);
    libdeflate_free_decompressor(d);
    return result == LIBDEFLATE_SUCCESS && taken == packed;
}

bool source_inflates(const struct volume_source *source, uint64_t length)
{
    return source->packed && source->bytes <= PACKED_MOST && length <= INFLATED_MOST;
}

bool source_inflate(struct volume_source *source, void *out, size_t length)
{
    if (!source_inflates(source, length) || !claims(source, length))
        return false;
    uint8_t *bytes = mem_array((size_t)source->bytes, 1);
    const bool inflated =
        bytes &&
        file_read_at(source->fd, bytes, (size_t)source->bytes, 0) == (ssize_t)source->bytes &&
        inflate_bytes(out, length, bytes, (size_t)source->bytes);
    free(bytes);
    return inflated;
}
