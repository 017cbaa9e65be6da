/* SPDX-License-Identifier: MIT */
#include "session/packed.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include "base/mem.h"

struct packed {
    size_t holders, length, packed_length;
    unsigned char *bytes;
};

/* zlib counts in 32 bits: what is longer goes through it part by part. */
static uInt part_of(size_t left, size_t most)
{
    return (uInt)(left > most ? most : left);
}

/* Deflates into `room` bytes, which surely are enough. False when out of memory. */
static bool deflate_all(struct packed *packed, const unsigned char *bytes, size_t room,
                        struct watch *watch)
{
    struct task task = task_begin(watch, "packing", packed->length);
    z_stream stream = {.next_in = (unsigned char *)(uintptr_t)bytes, .next_out = packed->bytes};
    int state = deflateInit(&stream, Z_BEST_SPEED);
    if (state != Z_OK)
        return false;
    for (size_t left = packed->length; state == Z_OK;) {
        const uInt part = part_of(left, TASK_STEP);
        stream.avail_in = part;
        stream.avail_out = part_of(room - (size_t)(stream.next_out - packed->bytes), UINT_MAX);
        left -= part;
        state = deflate(&stream, left ? Z_NO_FLUSH : Z_FINISH);
        if (!task_advance(&task, part))
            break;
    }
    packed->packed_length = (size_t)(stream.next_out - packed->bytes);
    deflateEnd(&stream);
    return state == Z_OK || state == Z_STREAM_END;
}

enum err packed_new(struct packed **out, const void *bytes, size_t length, struct watch *watch,
                    struct fault *fault)
{
    const size_t room = compressBound(length) + 64; /* for the parts that it is deflated in */
    struct packed *packed = mem_new(sizeof *packed);
    *out = NULL;
    if (!packed)
        return fault_memory(fault, "a map");
    packed->holders = 1;
    packed->length = length;
    packed->bytes = mem_array(room, 1);
    enum err err = packed->bytes && deflate_all(packed, bytes, room, watch)
                       ? watch_fault(watch, fault)
                       : fault_memory(fault, "a map");
    if (err) {
        packed_release(packed);
        return err;
    }
    unsigned char *exact = realloc(packed->bytes, packed->packed_length);
    packed->bytes = exact ? exact : packed->bytes;
    *out = packed;
    return OK;
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

/* Fills `out` with the next `length` bytes. */
static bool inflate_part(const struct packed *packed, z_stream *stream, unsigned char *out,
                         size_t length)
{
    int state = Z_OK;
    while (length > 0 && state == Z_OK) {
        const uInt room = part_of(length, UINT_MAX);
        const size_t read = (size_t)(stream->next_in - packed->bytes);
        stream->avail_in = part_of(packed->packed_length - read, UINT_MAX);
        stream->next_out = out;
        stream->avail_out = room;
        state = inflate(stream, Z_NO_FLUSH);
        out += room - stream->avail_out;
        length -= room - stream->avail_out;
    }
    return length == 0;
}

enum err packed_read(const struct packed *packed,
                     void (*take)(void *context, const void *piece, size_t length), void *context,
                     struct watch *watch, struct fault *fault)
{
    _Alignas(64) unsigned char piece[PACKED_PIECE];
    struct room room = {.used = 0};
    struct task task = task_begin(watch, "unpacking", packed->length);
    z_stream stream = {.zalloc = take_room, .zfree = leave_room, .opaque = &room};
    bool reads = inflateInit(&stream) == Z_OK;
    size_t left = packed->length;
    stream.next_in = packed->bytes;
    while (reads && left > 0) {
        const size_t part = left < sizeof piece ? left : sizeof piece;
        reads = inflate_part(packed, &stream, piece, part);
        if (reads)
            take(context, piece, part);
        left -= part;
        if (!task_advance(&task, part))
            return watch_fault(watch, fault);
    }
    return reads ? OK : fault_memory(fault, "a map of a former state");
}

static void take_copy(void *context, const void *piece, size_t length)
{
    unsigned char **to = context;
    memcpy(*to, piece, length);
    *to += length;
}

enum err packed_take_out(const struct packed *packed, void *out, struct watch *watch,
                         struct fault *fault)
{
    unsigned char *to = out;
    return packed_read(packed, take_copy, &to, watch, fault);
}

size_t packed_length(const struct packed *packed)
{
    return packed->length;
}

size_t packed_memory(const struct packed *packed)
{
    return sizeof *packed + packed->packed_length;
}
