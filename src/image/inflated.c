/* SPDX-License-Identifier: MIT */
#include "image/inflated.h"

#include <unistd.h>
#include <zlib.h>

enum { IN = 16 << 10, OUT = 64 << 10, BEYOND = 64 << 10, ANY_WRAPPING = 47 /* of zlib */ };

uint64_t inflated_bytes(int fd, uint64_t from, uint64_t packed, uint64_t needed, bool *ends)
{
    uint8_t in[IN], out[OUT];
    uint64_t bytes = 0;
    z_stream stream = {0};
    *ends = false;
    if (inflateInit2(&stream, ANY_WRAPPING) != Z_OK)
        return 0;
    while (!*ends) {
        if (stream.avail_in == 0) {
            const ssize_t n = pread(fd, in, packed < IN ? (size_t)packed : IN, (off_t)from);
            stream.next_in = in;
            stream.avail_in = n > 0 ? (uInt)n : 0;
            from += stream.avail_in;
            packed -= stream.avail_in;
        }
        stream.next_out = out;
        stream.avail_out = OUT;
        const int code = stream.avail_in ? inflate(&stream, Z_NO_FLUSH) : Z_BUF_ERROR;
        bytes += OUT - stream.avail_out;
        *ends = code == Z_STREAM_END || (bytes > needed && bytes - needed > BEYOND);
        if (code == Z_STREAM_END && bytes < needed) /* another may follow */
            *ends = inflateReset(&stream) != Z_OK;
        if (code != Z_OK && code != Z_STREAM_END)
            break;
    }
    inflateEnd(&stream);
    return bytes;
}
