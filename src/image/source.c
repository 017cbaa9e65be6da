/* SPDX-License-Identifier: MIT */
#include "image/source.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <zlib.h>

#include "base/file.h"
#include "base/mem.h"

#if __has_include(<isa-l/igzip_lib.h>)
#include <isa-l/igzip_lib.h>
#define HAS_ISAL
#endif

enum {
    DEFLATE_MOST = 1032,    /* deflate at its best: 258 bytes for two bits */
    CHUNK = 16 << 10,       /* bytes that zlib reads at a time */
    BEYOND_MOST = 64 << 10, /* a multiple of 4096 */
};

/* ---- ISA-L ---- */

#ifdef HAS_ISAL

enum { ISAL_CHUNK = 64 << 10, PASSED = 16 << 10 }; /* bytes read at a time, and skipped at a time */
enum { GZIP_MAGIC = 0x1f };

struct inflater {
    int fd;
    uint64_t at;    /* position in the file */
    bool has_ended; /* after the last stream, with a correct checksum */
    bool has_failed;
    struct inflate_state state;
    uint8_t chunk[ISAL_CHUNK], passed[PASSED];
};

static void begin_stream(struct inflater *inflater)
{
    struct inflate_state *state = &inflater->state;
    uint8_t *const next_in = state->next_in;
    const uint32_t avail_in = state->avail_in;
    isal_inflate_init(state);
    state->crc_flag = ISAL_GZIP;
    state->next_in = next_in;
    state->avail_in = avail_in;
}

/* Inflate an open file of the caller from that byte, without moving its file position. NULL without
 * memory. */
static struct inflater *inflater_new(int fd, uint64_t from)
{
    struct inflater *inflater = mem_array(1, sizeof *inflater);
    if (!inflater)
        return NULL;
    inflater->fd = fd;
    inflater->at = from;
    inflater->has_ended = inflater->has_failed = false;
    inflater->state.next_in = inflater->chunk;
    inflater->state.avail_in = 0;
    begin_stream(inflater);
    return inflater;
}

/* Read input if none is left; false at the end of the file. */
static bool refill(struct inflater *inflater)
{
    struct inflate_state *state = &inflater->state;
    if (state->avail_in)
        return true;
    const ssize_t n = file_read_at(inflater->fd, inflater->chunk, ISAL_CHUNK, inflater->at);
    if (n <= 0)
        return false;
    inflater->at += (uint64_t)n;
    state->next_in = inflater->chunk;
    state->avail_in = (uint32_t)n;
    return true;
}

/* Inflate at most `most` bytes to `to`. A call may return none before another that does. Output may
 * follow after the last input was read. */
static size_t inflate_some(struct inflater *inflater, uint8_t *to, uint32_t most)
{
    struct inflate_state *state = &inflater->state;
    const bool was_refilled = refill(inflater);
    state->next_out = to;
    state->avail_out = most;
    const int result = isal_inflate(state);
    const bool has_ended = state->block_state == ISAL_BLOCK_FINISH;
    const size_t given = most - state->avail_out;
    if (result < 0 || (!was_refilled && !given && !has_ended))
        inflater->has_failed = true;
    else if (has_ended && refill(inflater) && *state->next_in == GZIP_MAGIC)
        begin_stream(inflater); /* the file has several streams, one after another */
    else if (has_ended)         /* ignore other bytes after the last stream, as zlib does */
        inflater->has_ended = true;
    return given;
}

/* Inflate into `to`, or skip (NULL). Returns the number of bytes: fewer than `most` after the last
 * stream or after an error. */
static size_t inflater_take(struct inflater *inflater, void *to, size_t most)
{
    const size_t piece = to ? UINT32_MAX : PASSED;
    uint8_t *at = to ? to : inflater->passed;
    size_t done = 0;
    while (done < most && !inflater->has_ended && !inflater->has_failed) {
        const size_t left = most - done;
        const size_t n = inflate_some(inflater, at, (uint32_t)(left < piece ? left : piece));
        at += to ? n : 0;
        done += n;
    }
    return done;
}

#else

struct inflater {
    bool has_ended;
};

static struct inflater *inflater_new(int fd, uint64_t from)
{
    (void)fd, (void)from;
    return NULL;
}

static size_t inflater_take(struct inflater *inflater, void *to, size_t most)
{
    (void)inflater, (void)to, (void)most;
    return 0;
}

#endif

/* ---- a file ---- */

/* Begin reading at the file position, which is source->from. */
static enum err begin_source(struct volume_source *source, int fd, struct fault *fault)
{
    source->gz = gzdopen(fd, "rb");
    if (!source->gz) {
        close(fd);
        return fault_memory(fault, source->path);
    }
    source->fd = fd;
    source->most = source->bytes - source->from;
    gzbuffer(source->gz, CHUNK);
    source->packed = !gzdirect(source->gz);
    if (source->packed && __builtin_mul_overflow(source->most, DEFLATE_MOST, &source->most))
        source->most = UINT64_MAX;
    if (source->packed)
        source->inflater = inflater_new(fd, source->from);
    return OK;
}

enum err source_open(struct volume_source *source, const char *path, struct watch *watch,
                     struct fault *fault)
{
    int fd;
    *source = (struct volume_source){.path = path, .watch = watch};
    source->is_folder = file_is_folder(path);
    if (source->is_folder)
        return OK;
    TRY(file_open(&fd, &source->bytes, path, O_RDONLY, fault));
    return begin_source(source, fd, fault);
}

enum err source_enter(struct volume_source *source, const struct volume_source *of, uint64_t from,
                      struct fault *fault)
{
    const int fd = fcntl(of->fd, F_DUPFD_CLOEXEC, 0);
    *source = (struct volume_source){
        .path = of->path, .watch = of->watch, .from = from, .bytes = of->bytes};
    if (fd >= 0 && lseek(fd, (off_t)from, SEEK_SET) >= 0)
        return begin_source(source, fd, fault);
    const enum err err = fault_errno(fault, "read", of->path);
    if (fd >= 0)
        close(fd);
    return err;
}

void source_close(struct volume_source *source)
{
    if (source->gz)
        gzclose_r(source->gz);
    free(source->inflater);
    if (source->decoder)
        source->decoder->free(source->decoder);
    source->gz = NULL;
    source->inflater = NULL;
    source->decoder = NULL;
}

enum err source_switch(struct volume_source *source, const char *path, struct fault *fault)
{
    struct volume_source other;
    TRY(source_open(&other, path, source->watch, fault));
    if (other.is_folder)
        return fault_set(fault, ERR_INPUT, "a folder; expected a file");
    other.path = source->path;
    source_close(source);
    *source = other;
    return OK;
}

/* Report why fewer bytes were read. */
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

/* ---- reading ---- */

/* Continue with zlib at the position of the inflater. */
static void fall_back_to_zlib(struct volume_source *source)
{
    free(source->inflater);
    source->inflater = NULL;
    gzseek(source->gz, (z_off_t)source->at, SEEK_SET);
}

/* Read at least one of the next `most` bytes, which fit an int; 0 or less at the end or on error.
 */
static int read_some(struct volume_source *source, uint8_t *to, unsigned most)
{
    size_t n = 0;
    if (source->inflater) {
        n = inflater_take(source->inflater, to, most);
        source->at += n;
        if (n < most && !source->inflater->has_ended)
            fall_back_to_zlib(source);
    }
    return n > 0 || source->inflater ? (int)n : gzread(source->gz, to, most);
}

static enum err take_decoded(struct volume_source *source, uint8_t *to, size_t length,
                             struct fault *fault)
{
    source->at += length;
    return source->decoder->take(source->decoder, to, length, fault);
}

enum err source_read(struct volume_source *source, void *to, size_t length, const char *part,
                     struct watch *watch, struct fault *fault)
{
    const size_t piece_most = 1 << 20; /* between polls of the watch */
    struct task task = task_begin(watch, "reading", length);
    uint8_t *at = to;
    while (length > 0) {
        unsigned piece = (unsigned)(length < piece_most ? length : piece_most);
        const enum err err = source->decoder ? take_decoded(source, at, piece, fault) : OK;
        const int n = source->decoder ? (int)piece : read_some(source, at, piece);
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
    _Alignas(uint64_t) uint8_t passed[4096]; /* aligned for decoders, which swap numbers */
    enum err err = OK;
    while (source->decoder && source->at < offset && !err) {
        const uint64_t left = offset - source->at;
        err = take_decoded(source, passed, left < sizeof passed ? (size_t)left : sizeof passed,
                           fault);
    }
    if (source->decoder)
        return err;
    if (source->inflater && offset < source->at) {
        free(source->inflater);
        source->inflater = inflater_new(source->fd, source->from);
        source->at = 0;
    }
    if (source->inflater) { /* skip until an error or a stop */
        const size_t piece_most = 1 << 20;
        struct task task = task_begin(source->watch, "reading", offset - source->at);
        for (size_t n = 1; source->at < offset && n > 0 && task_advance(&task, n);) {
            const uint64_t left = offset - source->at;
            n = inflater_take(source->inflater, NULL,
                              left < piece_most ? (size_t)left : piece_most);
            source->at += n;
        }
    }
    if (source->inflater && source->at == offset)
        return OK;
    if (watch_stops(source->watch))
        return watch_fault(source->watch, fault);
    if (source->inflater)
        fall_back_to_zlib(source);
    return gzseek(source->gz, (z_off_t)offset, SEEK_SET) < 0 ? source_fault(source, part, fault)
                                                             : OK;
}

enum err source_finish(struct volume_source *source, struct fault *fault)
{
    char beyond[4096];
    int code;
    if (source->inflater) {
        const size_t n = inflater_take(source->inflater, NULL, BEYOND_MOST);
        source->at += n;
        if (n == BEYOND_MOST || source->inflater->has_ended)
            return OK; /* the stream has ended, or continues far beyond */
        fall_back_to_zlib(source);
    }
    for (size_t left = source->packed ? BEYOND_MOST : 0; left > 0; left -= sizeof beyond)
        if (gzread(source->gz, beyond, sizeof beyond) < (int)sizeof beyond) {
            gzerror(source->gz, &code);
            return code == Z_OK || code == Z_STREAM_END
                       ? OK
                       : source_fault(source, "its checksum", fault);
        }
    return OK;
}
