#include "image/source.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <zlib.h>

#include "base/file.h"
#include "image/inflater.h"
#include "image/volume_helper.h"

enum {
    DEFLATE_MOST = 1032,    /* deflate at its best: 258 bytes for two bits */
    CHUNK = 16 << 10,       /* bytes that zlib reads at a time */
    BEYOND_MOST = 64 << 10, /* a multiple of 4096 */
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
    gzbuffer(source->gz, CHUNK);
    source->packed = !gzdirect(source->gz);
    if (source->packed && __builtin_mul_overflow(source->bytes, DEFLATE_MOST, &source->most))
        source->most = UINT64_MAX;
    if (source->packed)
        source->inflater = inflater_new(fd);
    return OK;
}

void source_close(struct volume_source *source)
{
    if (source->gz)
        gzclose_r(source->gz);
    inflater_free(source->inflater);
    volume_helper_free(source->helper);
    source->gz = NULL;
    source->inflater = NULL;
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

/* ---- in pieces ---- */

/* Has zlib go on from where the inflater is. */
static void give_up(struct volume_source *source)
{
    inflater_free(source->inflater);
    source->inflater = NULL;
    gzseek(source->gz, (z_off_t)source->at, SEEK_SET);
}

/* At least one byte of the next `most`, which are few enough for an int; 0, or less, where there is
 * none. */
static int take(struct volume_source *source, uint8_t *to, unsigned most)
{
    size_t n = 0;
    if (source->inflater) {
        n = inflater_take(source->inflater, to, most);
        source->at += n;
        if (n < most && !inflater_has_ended(source->inflater))
            give_up(source);
    }
    if (n > 0 || source->inflater)
        return (int)n;
    return gzread(source->gz, to, most);
}

enum err source_read(struct volume_source *source, void *to, size_t length, const char *part,
                     struct watch *watch, struct fault *fault)
{
    const size_t piece_most = 1 << 20; /* for the watch */
    struct task task = task_begin(watch, "reading", length);
    uint8_t *at = to;
    while (length > 0) {
        unsigned piece = (unsigned)(length < piece_most ? length : piece_most);
        const enum err err =
            source->helper ? volume_helper_take(source->helper, at, piece, fault) : OK;
        int n = source->helper ? (int)piece : take(source, at, piece);
        if (err || n <= 0)
            return err ? err : source_fault(source, part, fault);
        source->at += source->helper ? piece : 0;
        at += n;
        length -= (size_t)n;
        if (!task_advance(&task, (uint64_t)n))
            return watch_fault(watch, fault);
    }
    return OK;
}

static enum err pass_helped(struct volume_source *source, uint64_t offset, struct fault *fault)
{
    uint8_t passed[4096];
    enum err err = OK;
    while (source->at < offset && !err) {
        const uint64_t left = offset - source->at;
        const size_t n = left < sizeof passed ? (size_t)left : sizeof passed;
        err = volume_helper_take(source->helper, passed, n, fault);
        source->at += n;
    }
    return err;
}

/* As far as the inflater gets, and the watch lets it. */
static void pass_inflated(struct volume_source *source, uint64_t offset)
{
    const size_t piece_most = 1 << 20;
    struct task task = task_begin(source->watch, "reading", offset - source->at);
    for (size_t n = 1; source->at < offset && n > 0 && task_advance(&task, n);) {
        const uint64_t left = offset - source->at;
        n = inflater_take(source->inflater, NULL, left < piece_most ? (size_t)left : piece_most);
        source->at += n;
    }
}

enum err source_go_to(struct volume_source *source, uint64_t offset, const char *part,
                      struct fault *fault)
{
    if (source->helper)
        return pass_helped(source, offset, fault);
    if (source->inflater && offset < source->at) {
        inflater_free(source->inflater);
        source->inflater = inflater_new(source->fd);
        source->at = 0;
    }
    if (source->inflater)
        pass_inflated(source, offset);
    if (source->inflater && source->at == offset)
        return OK;
    if (watch_stops(source->watch))
        return watch_fault(source->watch, fault);
    if (source->inflater)
        give_up(source);
    return gzseek(source->gz, (z_off_t)offset, SEEK_SET) < 0 ? source_fault(source, part, fault)
                                                             : OK;
}

/* Whether the inflater has seen the end of the stream, or that this is far away. */
static bool ends_well(struct volume_source *source)
{
    const size_t n = inflater_take(source->inflater, NULL, BEYOND_MOST);
    source->at += n;
    return n == BEYOND_MOST || inflater_has_ended(source->inflater);
}

enum err source_finish(struct volume_source *source, struct fault *fault)
{
    char beyond[4096];
    int code;
    if (source->inflater && ends_well(source))
        return OK;
    if (source->inflater)
        give_up(source);
    for (size_t left = source->packed ? BEYOND_MOST : 0; left > 0; left -= sizeof beyond)
        if (gzread(source->gz, beyond, sizeof beyond) < (int)sizeof beyond) {
            gzerror(source->gz, &code);
            return code == Z_OK || code == Z_STREAM_END
                       ? OK
                       : source_fault(source, "its checksum", fault);
        }
    return OK;
}
