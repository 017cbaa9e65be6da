#include "base/packed.h"

#include <limits.h>
#include <stdlib.h>
#include <zlib.h>

#include "base/mem.h"

struct packed {
    size_t holders, length, packed_length;
    unsigned char *bytes;
};

/* Deflates into room that surely is enough. False when out of memory. */
static bool deflate_all(struct packed *packed, const unsigned char *bytes)
{
    uLong room = compressBound(packed->length);
    packed->bytes = mem_array(room, 1);
    if (!packed->bytes ||
        compress2(packed->bytes, &room, bytes, packed->length, Z_BEST_SPEED) != Z_OK)
        return false;
    packed->packed_length = room;
    return true;
}

struct packed *packed_new(const void *bytes, size_t length)
{
    struct packed *packed = mem_new(sizeof *packed);
    if (!packed)
        return NULL;
    packed->holders = 1;
    packed->length = length;
    if (!deflate_all(packed, bytes)) {
        packed_release(packed);
        return NULL;
    }
    unsigned char *exact = realloc(packed->bytes, packed->packed_length);
    packed->bytes = exact ? exact : packed->bytes;
    return packed;
}

struct packed *packed_hold(struct packed *packed)
{
    if (packed)
        packed->holders++;
    return packed;
}

void packed_release(struct packed *packed)
{
    if (!packed || --packed->holders > 0)
        return;
    free(packed->bytes);
    free(packed);
}

/* The room for the tables of inflating and its window of 32 kB: some 40 kB with zlib. */
struct room {
    size_t used;
    _Alignas(64) unsigned char bytes[96 << 10];
};

static void *take_room(void *context, uInt items, uInt size)
{
    struct room *room = context;
    const size_t bytes = ((size_t)items * size + 63) / 64 * 64;
    if (bytes > sizeof room->bytes - room->used)
        return NULL;
    room->used += bytes;
    return room->bytes + room->used - bytes;
}

static void leave_room(void *context, void *bytes)
{
    (void)context, (void)bytes;
}

/* zlib counts in 32 bits: what is longer goes through it part by part. */
static uInt part_of(size_t left)
{
    return left > UINT_MAX ? UINT_MAX : (uInt)left;
}

/* Fills `out` with the next `length` bytes. */
static bool inflate_part(const struct packed *packed, z_stream *stream, unsigned char *out,
                         size_t length)
{
    int state = Z_OK;
    while (length > 0 && state == Z_OK) {
        const uInt room = part_of(length);
        const size_t read = (size_t)(stream->next_in - packed->bytes);
        stream->avail_in = part_of(packed->packed_length - read);
        stream->next_out = out;
        stream->avail_out = room;
        state = inflate(stream, Z_NO_FLUSH);
        out += room - stream->avail_out;
        length -= room - stream->avail_out;
    }
    return length == 0;
}

enum err packed_read(const struct packed *packed, void *piece, size_t length,
                     void (*take)(void *context, const void *piece, size_t length), void *context,
                     struct fault *fault)
{
    struct room room = {.used = 0};
    z_stream stream = {.zalloc = take_room, .zfree = leave_room, .opaque = &room};
    bool reads = inflateInit(&stream) == Z_OK;
    size_t left = packed->length;
    stream.next_in = packed->bytes;
    while (reads && left > 0) {
        const size_t part = left < length ? left : length;
        reads = inflate_part(packed, &stream, piece, part);
        if (reads)
            take(context, piece, part);
        left -= part;
    }
    return reads ? OK : fault_memory(fault, "a map of a former state");
}

static void take_nothing(void *context, const void *piece, size_t length)
{
    (void)context, (void)piece, (void)length;
}

enum err packed_take_out(const struct packed *packed, void *out, struct fault *fault)
{
    return packed_read(packed, out, packed->length, take_nothing, NULL, fault);
}

size_t packed_length(const struct packed *packed)
{
    return packed->length;
}

size_t packed_memory(const struct packed *packed)
{
    return sizeof *packed + packed->packed_length;
}
