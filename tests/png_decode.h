/* SPDX-License-Identifier: MIT */
/* A decoder of base64 and of the PNG files that we write: one IDAT, filters 0, 2, 3, a palette of 1
 * to 8 bits, whose first colour may be clear, or 24-bit colours. Anything else is refused, and so
 * is a truncated file. It uses zlib, which did not write the file. */
#ifndef TESTS_PNG_DECODE_H
#define TESTS_PNG_DECODE_H

#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include "base/buf.h"

#define PNG_CLEAR UINT32_MAX

struct decoded_png {
    uint32_t width, height;
    unsigned bits, colours; /* 0 colours: no palette */
    bool has_clear;         /* the palette's first */
    uint32_t *pixel;        /* [height][width] 0xRRGGBB, or PNG_CLEAR; for the caller to free */
};

static inline int base64_value(char c)
{
    static const char digit[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const char *place = c ? strchr(digit, c) : NULL;
    return place ? (int)(place - digit) : -1;
}

static inline bool base64_decode(struct buf *out, const char *text, size_t length)
{
    if (length % 4 != 0)
        return false;
    for (const char *end = text + length; text < end; text += 4) {
        uint32_t n = 0;
        unsigned bytes = text[3] != '=' ? 3 : text[2] != '=' ? 2 : 1;
        if (bytes < 3 && text + 4 != end)
            return false;
        for (unsigned i = 0; i <= bytes; i++) {
            if (base64_value(text[i]) < 0)
                return false;
            n |= (uint32_t)base64_value(text[i]) << (18 - 6 * i);
        }
        buf_add(out, (uint8_t[3]){(uint8_t)(n >> 16), (uint8_t)(n >> 8), (uint8_t)n}, bytes);
    }
    return true;
}

static inline uint32_t png_number(const uint8_t *p)
{
    return (uint32_t)p[0] << 24 | (uint32_t)p[1] << 16 | (uint32_t)p[2] << 8 | p[3];
}

/* Remove the filter of a row: 2 adds the pixel above, 3 the mean of those to the left and above. */
static inline bool png_unfilter(uint8_t *line, size_t row, const uint8_t *above, size_t each)
{
    if (line[0] != 0 && line[0] != 2 && line[0] != 3)
        return false;
    for (size_t i = 1; line[0] == 2 && above && i < row; i++)
        line[i] = (uint8_t)(line[i] + above[i]);
    for (size_t i = 1; line[0] == 3 && i < row; i++)
        line[i] =
            (uint8_t)(line[i] + ((i > each ? line[i - each] : 0u) + (above ? above[i] : 0u)) / 2);
    return true;
}

static inline bool png_unpack(struct decoded_png *png, const uint8_t *packed, size_t length,
                              const uint8_t *palette)
{
    size_t row = 1 + ((size_t)png->width * png->bits * (png->colours ? 1 : 3) + 7) / 8;
    uLongf raw_length = (uLongf)(row * png->height);
    uint8_t *raw = calloc(png->height, row), *line = raw;
    png->pixel = calloc((size_t)png->width * png->height, sizeof *png->pixel);
    bool fine = uncompress(raw, &raw_length, packed, (uLong)length) == Z_OK &&
                raw_length == row * png->height;
    for (uint32_t y = 0; fine && y < png->height; y++, line += row) {
        fine = png_unfilter(line, row, y > 0 ? line - row : NULL, png->colours ? 1 : 3);
        for (uint32_t x = 0; fine && x < png->width; x++) {
            const uint8_t *c = line + 1 + 3 * x;
            if (png->colours) {
                unsigned bit = x * png->bits;
                unsigned byte = line[1 + bit / 8];
                unsigned i = byte >> (8 - png->bits - bit % 8) & ((1u << png->bits) - 1);
                fine = i < png->colours;
                c = palette + 3 * i;
            }
            png->pixel[(size_t)y * png->width + x] =
                png->has_clear && c == palette ? PNG_CLEAR
                                               : (uint32_t)c[0] << 16 | (uint32_t)c[1] << 8 | c[2];
        }
    }
    free(raw);
    return fine;
}

static inline bool png_decode(struct decoded_png *png, const uint8_t *p, size_t length)
{
    uint8_t palette[768] = {0};
    const uint8_t *end = p + length;
    bool fine = false;
    *png = (struct decoded_png){0};
    if (length < 8 || memcmp(p, "\x89PNG\r\n\x1a\n", 8) != 0)
        return false;
    for (p += 8; end - p >= 12;) {
        uint32_t n = png_number(p);
        if (n > end - p - 12 || crc32(0, p + 4, n + 4) != png_number(p + 8 + n))
            return false;
        if (memcmp(p + 4, "IHDR", 4) == 0) {
            png->width = png_number(p + 8);
            png->height = png_number(p + 12);
            png->bits = p[16];
        } else if (memcmp(p + 4, "PLTE", 4) == 0 && n <= sizeof palette) {
            memcpy(palette, p + 8, n);
            png->colours = n / 3;
        } else if (memcmp(p + 4, "tRNS", 4) == 0) {
            png->has_clear = png->colours > 0 && n == 1 && p[8] == 0;
            if (!png->has_clear)
                return false;
        } else if (memcmp(p + 4, "IDAT", 4) == 0) {
            fine = !png->pixel && png_unpack(png, p + 8, n, palette);
        } else if (memcmp(p + 4, "IEND", 4) == 0) {
            return fine && p + 12 == end;
        }
        p += 12 + n;
    }
    return false;
}

/* The difference of two colours in the channel in which it is largest. */
static inline uint32_t channel_distance(uint32_t a, uint32_t b)
{
    uint32_t most = 0;
    for (unsigned shift = 0; shift < 24; shift += 8) {
        int32_t d = (int32_t)(a >> shift & 255) - (int32_t)(b >> shift & 255);
        uint32_t size = (uint32_t)(d < 0 ? -d : d);
        most = size > most ? size : most;
    }
    return most;
}

#endif
