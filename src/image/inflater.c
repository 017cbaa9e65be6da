#include "image/inflater.h"

#include "base/file.h"
#include "base/mem.h"

#include <stdlib.h>

#if __has_include(<isa-l/igzip_lib.h>)

#include <isa-l/igzip_lib.h>

enum { CHUNK = 64 << 10, PASSED = 16 << 10 }; /* bytes read at a time, and passed over */

struct inflater {
    int fd;
    uint64_t at; /* bytes that were read of the file */
    bool has_ended, has_failed;
    struct inflate_state state;
    uint8_t chunk[CHUNK], passed[PASSED];
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

struct inflater *inflater_new(int fd)
{
    struct inflater *inflater = mem_array(1, sizeof *inflater);
    if (!inflater)
        return NULL;
    inflater->fd = fd;
    inflater->at = 0;
    inflater->has_ended = inflater->has_failed = false;
    inflater->state.next_in = inflater->chunk;
    inflater->state.avail_in = 0;
    begin_stream(inflater);
    return inflater;
}

void inflater_free(struct inflater *inflater)
{
    free(inflater);
}

/* Has something to inflate at hand; false at the end of the file. */
static bool refill(struct inflater *inflater)
{
    struct inflate_state *state = &inflater->state;
    if (state->avail_in)
        return true;
    const ssize_t n = file_read_at(inflater->fd, inflater->chunk, CHUNK, inflater->at);
    if (n <= 0)
        return false;
    inflater->at += (uint64_t)n;
    state->next_in = inflater->chunk;
    state->avail_in = (uint32_t)n;
    return true;
}

/* At the end of a stream: what follows and does not begin as one is left alone, as zlib does. */
static void end_stream(struct inflater *inflater)
{
    enum { MAGIC = 0x1f };
    if (refill(inflater) && *inflater->state.next_in == MAGIC)
        begin_stream(inflater);
    else
        inflater->has_ended = true;
}

/* At most `most` bytes to `to`; a call that gives none may be followed by one that does. What the
 * last bytes of a file lead to may still be to come when they have been taken. */
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
    else if (has_ended)
        end_stream(inflater);
    return given;
}

size_t inflater_take(struct inflater *inflater, void *to, size_t most)
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

bool inflater_has_ended(const struct inflater *inflater)
{
    return inflater->has_ended;
}

#else

struct inflater *inflater_new(int fd)
{
    (void)fd;
    return NULL;
}

void inflater_free(struct inflater *inflater)
{
    (void)inflater;
}

size_t inflater_take(struct inflater *inflater, void *to, size_t most)
{
    (void)inflater, (void)to, (void)most;
    return 0;
}

bool inflater_has_ended(const struct inflater *inflater)
{
    (void)inflater;
    return false;
}

#endif
