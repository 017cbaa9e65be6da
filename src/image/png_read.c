#include "image/png_read.h"

#include <libdeflate.h>
#include <stdlib.h>
#include <string.h>

#include "base/buf.h"
#include "base/mem.h"
#include "base/safe.h"

enum { HEADER = 13, AROUND = 12, COLOURED = 2, WITH_ALPHA = 6, KEYWORD_MOST = 79 };

static const uint8_t signature[8] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};

/* What else the writer puts there: the colours of sRGB, which the pixels have, and no offset. */
static const struct {
    char type[5];
    uint8_t length;
    uint8_t data[32];
} constant[] = {
    {"gAMA", 4, {0, 0, 0xb1, 0x8f}},
    {"sRGB", 1, {0}},
    {"sRGB", 1, {3}},
    {"oFFs", 9, {0}},
    {"cHRM", 32, {0, 0, 0x7a, 0x26, 0, 0, 0x80, 0x84, 0, 0, 0xfa, 0,    0, 0, 0x80, 0xe8,
                  0, 0, 0x75, 0x30, 0, 0, 0xea, 0x60, 0, 0, 0x3a, 0x98, 0, 0, 0x17, 0x70}},
};

struct reading {
    struct picture *out;
    const uint8_t *at, *end;
    const uint8_t *data; /* of the chunk at hand */
    size_t length;
    char type[5];
    size_t channels;   /* 0 before the header */
    struct buf packed; /* the pixels */
    struct fault *fault;
};

static uint32_t number_at(const uint8_t *p)
{
    return (uint32_t)p[0] << 24 | (uint32_t)p[1] << 16 | (uint32_t)p[2] << 8 | p[3];
}

static enum err refuse(const struct reading *r, const char *what)
{
    return fault_set(r->fault, ERR_INPUT, "%s", what);
}

/* ---- chunks: length, type, data, CRC of type and data ---- */

static enum err next_chunk(struct reading *r)
{
    const size_t left = (size_t)(r->end - r->at);
    const uint32_t length = left < AROUND ? 0 : number_at(r->at);
    if (left < AROUND || length > left - AROUND)
        return refuse(r, "it is cut short");
    memcpy(r->type, r->at + 4, 4);
    r->data = r->at + 8;
    r->length = length;
    if (libdeflate_crc32(0, r->at + 4, length + 4) != number_at(r->data + length))
        return refuse(r, "a checksum in it is wrong");
    r->at += length + AROUND;
    return OK;
}

static enum err take_header(struct reading *r, uint32_t width, uint32_t height)
{
    const uint8_t *d = r->data;
    if (strcmp(r->type, "IHDR") != 0 || r->length != HEADER || d[8] != 8 ||
        (d[9] != COLOURED && d[9] != WITH_ALPHA) || d[10] || d[11] || d[12])
        return refuse(r, "it is no PNG of 8 bits a channel, in colours, as iftty writes them");
    if (number_at(d) != width || number_at(d + 4) != height)
        return fault_set(r->fault, ERR_CHECK, "it has another size");
    r->channels = d[9] == COLOURED ? 3 : 4;
    return OK;
}

/* A keyword, a zero, and the text, without one. */
static enum err take_text(struct reading *r)
{
    char name[KEYWORD_MOST + 1];
    const uint8_t *zero = memchr(r->data, 0, r->length);
    const size_t before = zero ? (size_t)(zero - r->data) : 0;
    struct buf value = {0};
    if (!before || before > KEYWORD_MOST || memchr(zero + 1, 0, r->length - before - 1))
        return refuse(r, "a text in it has no name, or two");
    memcpy(name, r->data, before + 1);
    if (picture_find(r->out, name))
        return refuse(r, "two texts in it have one name");
    buf_add(&value, zero + 1, r->length - before - 1);
    const enum err err = value.failed ? fault_memory(r->fault, "a note on a picture")
                                      : picture_note(r->out, name, buf_text(&value), r->fault);
    buf_release(&value);
    return err;
}

static enum err take_other(struct reading *r)
{
    if (strcmp(r->type, "tEXt") == 0)
        return take_text(r);
    for (size_t i = 0; i < sizeof constant / sizeof *constant; i++)
        if (strcmp(r->type, constant[i].type) == 0 && r->length == constant[i].length &&
            memcmp(r->data, constant[i].data, r->length) == 0)
            return OK;
    struct buf type = {0};
    buf_add_safe_text(&type, r->type);
    const enum err err = fault_set(
        r->fault, ERR_INPUT, "it has a part %s that iftty does not write there", buf_text(&type));
    buf_release(&type);
    return err;
}

static enum err take_chunks(struct reading *r, uint32_t width, uint32_t height)
{
    enum err err = next_chunk(r);
    if (!err)
        err = take_header(r, width, height);
    while (!err && !(err = next_chunk(r)) && strcmp(r->type, "IDAT") != 0)
        err = take_other(r);
    while (!err && strcmp(r->type, "IDAT") == 0) {
        buf_add(&r->packed, r->data, r->length);
        err = r->packed.failed ? fault_memory(r->fault, "a picture") : next_chunk(r);
    }
    if (!err && (strcmp(r->type, "IEND") != 0 || r->length || r->at != r->end))
        err = refuse(r, "something follows its pixels");
    return err;
}

/* ---- pixels: rows, each after the number of its filter ---- */

static int paeth(int left, int above, int before)
{
    const int p = left + above - before;
    const int a = abs(p - left), b = abs(p - above), c = abs(p - before);
    return a <= b && a <= c ? left : b <= c ? above : before;
}

/* What a byte was taken less: of those left of it, above it, and left of that. */
static int predict(uint8_t filter, int left, int above, int before)
{
    switch (filter) {
    case 1:
        return left;
    case 2:
        return above;
    case 3:
        return (left + above) / 2;
    case 4:
        return paeth(left, above, before);
    default:
        return 0;
    }
}

/* Takes the filter of a row back; `above` is a row of zeros before the first. */
static bool unfilter(uint8_t *row, const uint8_t *above, size_t bytes, size_t each, uint8_t filter)
{
    for (size_t i = 0; i < bytes; i++)
        row[i] = (uint8_t)(row[i] + predict(filter, i >= each ? row[i - each] : 0, above[i],
                                            i >= each ? above[i - each] : 0));
    return filter <= 4;
}

static bool take_rows(struct reading *r, uint8_t *raw, const uint8_t *zeros)
{
    const size_t bytes = r->out->width * r->channels;
    const uint8_t *above = zeros;
    uint8_t *to = r->out->rgba;
    for (uint32_t y = 0; y < r->out->height; y++, raw += bytes + 1) {
        if (!unfilter(raw + 1, above, bytes, r->channels, raw[0]))
            return false;
        above = raw + 1;
        for (size_t x = 0; x < r->out->width; x++, to += 4) {
            to[3] = 255;
            memcpy(to, above + x * r->channels, r->channels);
        }
    }
    return true;
}

static enum err take_pixels(struct reading *r)
{
    const size_t bytes = r->out->width * r->channels, all = (bytes + 1) * r->out->height;
    struct libdeflate_decompressor *inflater = libdeflate_alloc_decompressor();
    uint8_t *raw = mem_array(all, 1), *zeros = mem_new(bytes);
    enum err err = raw && zeros && inflater ? OK : fault_memory(r->fault, "a picture");
    if (!err && (libdeflate_zlib_decompress(inflater, buf_text(&r->packed), r->packed.length, raw,
                                            all, NULL) != LIBDEFLATE_SUCCESS ||
                 !take_rows(r, raw, zeros)))
        err = refuse(r, "its pixels are damaged");
    libdeflate_free_decompressor(inflater);
    free(raw);
    free(zeros);
    return err;
}

enum err png_read(struct picture *out, const void *bytes, size_t length, uint32_t width,
                  uint32_t height, struct fault *fault)
{
    const uint8_t *from = bytes;
    struct reading r = {.out = out, .at = from, .end = from + length, .fault = fault};
    *out = (struct picture){0};
    if (length < sizeof signature || memcmp(from, signature, sizeof signature) != 0)
        return refuse(&r, "it is no PNG");
    enum err err = picture_init(out, width, height, false, fault);
    if (err)
        return err;
    r.at += sizeof signature;
    err = take_chunks(&r, width, height);
    if (!err)
        err = take_pixels(&r);
    if (err)
        picture_release(out);
    buf_release(&r.packed);
    return err;
}
