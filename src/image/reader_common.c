/* SPDX-License-Identifier: MIT */
#include "image/reader_common.h"

#include <stddef.h>
#include <string.h>
#include <unistd.h>
#include <zlib.h>

#include "base/choice.h"

double length_mm(const char *name)
{
    static const struct {
        const char *names;
        double mm;
    } unit[] = {
        {"pm|picometer|picometre|picometers|picometres", 1e-9},
        {"angstrom|angstroms|\xc3\x85|\xc3\xa5|\xe2\x84\xab|\\u00c5|\\u00e5", 1e-7},
        {"nm|nanometer|nanometre|nanometers|nanometres", 1e-6},
        {"um|micron|microns|micrometer|micrometre|micrometers|micrometres|\xb5m|\xc2\xb5m|"
         "\xce\xbcm|\\u00b5m|\\u03bcm",
         1e-3},
        {"mm|millimeter|millimetre|millimeters|millimetres", 1},
        {"cm|centimeter|centimetre|centimeters|centimetres", 10},
        {"dm|decimeter|decimetre|decimeters|decimetres", 100},
        {"m|meter|metre|meters|metres", 1e3},
        {"in|inch|inches", 25.4},
    };
    char small[24];
    const size_t length = strlen(name);
    if (length == 0 || length >= sizeof small)
        return 0;
    for (size_t i = 0; i <= length; i++)
        small[i] = name[i] >= 'A' && name[i] <= 'Z' ? (char)(name[i] - 'A' + 'a') : name[i];
    for (size_t i = 0; i < sizeof unit / sizeof unit[0]; i++)
        if (choice_find(unit[i].names, small) >= 0)
            return unit[i].mm;
    return 0;
}

enum { IN = 16 << 10, OUT = 64 << 10, BEYOND = 64 << 10, ANY_WRAPPING = 47 /* gzip or zlib */ };

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
        if (code == Z_STREAM_END && bytes < needed) /* another stream may follow */
            *ends = inflateReset(&stream) != Z_OK;
        if (code != Z_OK && code != Z_STREAM_END)
            break;
    }
    inflateEnd(&stream);
    return bytes;
}
