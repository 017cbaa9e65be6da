#include "base/packed.h"

#include <limits.h>
#include <stdint.h>
#include <stdlib.h>
#include <zlib.h>

#include "base/mem.h"

struct packed {
    size_t holders, length, packed_length;
    unsigned char *bytes;
};

/* zlib counts in 32 bits: what is longer goes through it part by part. */
static uInt part_of(size_t left)
{
    return left > UINT_MAX ? UINT_MAX : (uInt)left;
}

/* Deflates into room that surely is enough. False when out of memory. */
static bool deflate_all(struct packed *packed, const unsigned char *bytes)
{
    z_stream stream = {0};
    if (deflateInit(&stream, Z_BEST_SPEED) != Z_OK)
        return false;
    const size_t room = packed->length + packed->length / 1000 + 1024;
    size_t read = 0, written = 0;
    int state = Z_OK;
    packed->bytes = mem_array(room, 1);
    while (packed->bytes && state == Z_OK) {
        const uInt in = part_of(packed->length - read), out = part_of(room - written);
        stream.next_in = (unsigned char *)(uintptr_t)(bytes + read);
        stream.avail_in = in;
        stream.next_out = packed->bytes + written;
        stream.avail_out = out;
        state = deflate(&stream, read + in == packed->length ? Z_FINISH : Z_NO_FLUSH);
        read += in - stream.avail_in;
        written += out - stream.avail_out;
    }
    deflateEnd(&stream);
    packed->packed_length = written;
    return state == Z_STREAM_END;
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

enum err packed_take_out(const struct packed *packed, void *out, struct fault *fault)
{
    z_stream stream = {0};
    if (inflateInit(&stream) != Z_OK)
        return fault_memory(fault, "what was put away");
    unsigned char *to = out;
    size_t read = 0, written = 0;
    int state = Z_OK;
    while (state == Z_OK) {
        const uInt from = part_of(packed->packed_length - read);
        const uInt room = part_of(packed->length - written);
        stream.next_in = packed->bytes + read;
        stream.avail_in = from;
        stream.next_out = to + written;
        stream.avail_out = room;
        state = inflate(&stream, Z_NO_FLUSH);
        read += from - stream.avail_in;
        written += room - stream.avail_out;
    }
    inflateEnd(&stream);
    return state == Z_STREAM_END ? OK : fault_memory(fault, "what was put away");
}

size_t packed_length(const struct packed *packed)
{
    return packed->length;
}

size_t packed_memory(const struct packed *packed)
{
    return sizeof *packed + packed->packed_length;
}
