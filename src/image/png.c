#include "image/png.h"

#include <libdeflate.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "image/picture.h"

enum { HEADER = 13 };
enum { COLOURED = 2, INDEXED = 3, WITH_ALPHA = 6 }; /* kinds of pixels, as the header names them */

void png_release(struct png_writer *writer)
{
    for (unsigned i = 0; i < PNG_EFFORTS; i++)
        if (writer->compressor[i])
            libdeflate_free_compressor(writer->compressor[i]);
    free(writer->raw);
    free(writer->packed);
    *writer = (struct png_writer){0};
}

/* ---- chunks: length, type, data, CRC of type and data ---- */

static void put_number(uint8_t *place, uint32_t n)
{
    for (unsigned i = 0; i < 4; i++)
        place[i] = (uint8_t)(n >> (24 - 8 * i));
}

static void add_chunk(struct buf *png, const char type[4], const void *data, size_t length)
{
    uint8_t number[4];
    uint32_t crc = libdeflate_crc32(libdeflate_crc32(0, type, 4), data, length);
    put_number(number, (uint32_t)length);
    buf_add(png, number, 4);
    buf_add(png, type, 4);
    buf_add(png, data, length);
    put_number(number, crc);
    buf_add(png, number, 4);
}

static void add_header(struct buf *png, const struct raster *raster, unsigned bits)
{
    const int kind = raster->colour ? INDEXED : raster->has_alpha ? WITH_ALPHA : COLOURED;
    uint8_t header[HEADER] = {[8] = (uint8_t)bits, [9] = (uint8_t)kind};
    put_number(header, raster->width);
    put_number(header + 4, raster->height);
    buf_add(png, "\x89PNG\r\n\x1a\n", 8);
    add_chunk(png, "IHDR", header, HEADER);
}

static void add_palette(struct buf *png, const uint32_t *colour, unsigned count)
{
    uint8_t rgb[3 * RASTER_COLOURS_MOST];
    for (size_t i = 0; i < count; i++) {
        rgb[3 * i] = (uint8_t)(colour[i] >> 16);
        rgb[3 * i + 1] = (uint8_t)(colour[i] >> 8);
        rgb[3 * i + 2] = (uint8_t)colour[i];
    }
    add_chunk(png, "PLTE", rgb, 3 * (size_t)count);
}

/* ---- rows: the number of a filter, 0 for none, and pixels, the leftmost in the highest bits */

static void pack_row(uint8_t *out, const uint8_t *row, uint32_t width, const uint8_t *place,
                     unsigned bits)
{
    const uint32_t each = 8 / bits;
    for (uint32_t x = 0; x < width; x += each) {
        unsigned byte = 0;
        for (uint32_t k = 0; k < each; k++)
            byte = byte << bits | (x + k < width ? place[row[x + k]] : 0u);
        *out++ = (uint8_t)byte;
    }
}

static void map_row(uint8_t *out, const uint8_t *row, uint32_t width, const uint8_t *place)
{
    for (uint32_t x = 0; x < width; x++)
        out[x] = place[row[x]];
}

static void fill_rows(uint8_t *out, const struct raster *raster, const uint8_t *place,
                      unsigned bits, size_t row_bytes)
{
    for (uint32_t y = 0; y < raster->height; y++) {
        const uint8_t *row = raster->bytes + y * raster->stride;
        *out++ = 0;
        if (!raster->colour)
            memcpy(out, row, row_bytes);
        else if (bits == 8)
            map_row(out, row, raster->width, place);
        else
            pack_row(out, row, raster->width, place, bits);
        out += row_bytes;
    }
}

/* Each byte less the mean of those left and above it (filter 3), from the end on, so that both are
 * still as they were. */
static void filter_rows(uint8_t *raw, size_t row_bytes, uint32_t rows, size_t each)
{
    const size_t stride = row_bytes + 1;
    for (uint32_t y = rows; y-- > 0;) {
        uint8_t *row = raw + y * stride;
        row[0] = 3;
        for (size_t i = row_bytes; i > 0; i--)
            row[i] = (uint8_t)(row[i] - ((i > each ? row[i - each] : 0u) +
                                         (y > 0 ? *(row + i - stride) : 0u)) /
                                            2);
    }
}

/* Memory for `rows` rows of `row_bytes` and for them deflated; the bytes of all, 0 without. */
static size_t prepare(struct png_writer *w, enum png_effort effort, size_t row_bytes, size_t rows)
{
    size_t raw_length;
    static const int level[PNG_EFFORTS] = {
        [PNG_FAST] = 1, [PNG_SMALL] = 10, [PNG_FILE] = 6, [PNG_SLOW_LINE] = 6};
    if (!size_multiply(row_bytes, rows, &raw_length) || raw_length > UINT32_MAX / 2)
        return 0;
    if (!w->compressor[effort])
        w->compressor[effort] = libdeflate_alloc_compressor(level[effort]);
    if (!w->compressor[effort] || !mem_grow(&w->raw, &w->raw_capacity, raw_length, 1) ||
        !mem_grow(&w->packed, &w->packed_capacity,
                  2 * libdeflate_zlib_compress_bound(w->compressor[effort], raw_length), 1))
        return 0;
    return raw_length;
}

/* Into one half of the memory or the other. */
static size_t deflate_rows(struct png_writer *w, enum png_effort effort, size_t raw_length,
                           unsigned half)
{
    const size_t room = w->packed_capacity / 2;
    return libdeflate_zlib_compress(w->compressor[effort], w->raw, raw_length,
                                    w->packed + half * room, room);
}

static unsigned bits_for(unsigned colours)
{
    return colours <= 2 ? 1 : colours <= 4 ? 2 : colours <= 16 ? 4 : 8;
}

void png_add(struct png_writer *w, const struct raster *raster, enum png_effort effort,
             struct buf *png)
{
    uint8_t place[RASTER_COLOURS_MOST];
    uint32_t used[RASTER_COLOURS_MOST];
    bool is_clear = false;
    const unsigned colours = raster->colour ? raster_used(raster, place, used, &is_clear) : 0;
    const unsigned bits = raster->colour ? bits_for(colours) : 8;
    const size_t row_bytes = raster->colour ? ((size_t)raster->width * bits + 7) / 8
                                            : raster->width * raster_pixel_bytes(raster);
    const size_t raw_length = prepare(w, effort, row_bytes + 1, raster->height);
    if (raw_length == 0) {
        png->failed = true;
        return;
    }
    fill_rows(w->raw, raster, place, bits, row_bytes);
    size_t packed_length = deflate_rows(w, effort, raw_length, 0);
    const uint8_t *packed = w->packed;
    if (effort == PNG_SLOW_LINE && bits == 8) {
        filter_rows(w->raw, row_bytes, raster->height, raster_pixel_bytes(raster));
        const size_t length = deflate_rows(w, effort, raw_length, 1);
        packed = length < packed_length ? packed + w->packed_capacity / 2 : packed;
        packed_length = length < packed_length ? length : packed_length;
    }
    add_header(png, raster, bits);
    if (raster->colour)
        add_palette(png, used, colours);
    if (is_clear)
        add_chunk(png, "tRNS", "", 1); /* the first colour is seen through */
    add_chunk(png, "IDAT", packed, packed_length);
    add_chunk(png, "IEND", "", 0);
}

void png_add_pixels(struct png_writer *w, const struct raster *raster, enum png_effort effort,
                    struct buf *out)
{
    const size_t row_bytes = (size_t)raster->width * 3;
    const size_t raw_length = prepare(w, effort, row_bytes, raster->height);
    if (raw_length == 0) {
        out->failed = true;
        return;
    }
    uint8_t *raw = w->raw;
    for (uint32_t y = 0; y < raster->height; y++, raw += row_bytes) {
        const uint8_t *row = raster->bytes + y * raster->stride;
        for (uint32_t x = 0; raster->colour && x < raster->width; x++)
            for (unsigned k = 0; k < 3; k++)
                raw[3 * x + k] = (uint8_t)(raster->colour[row[x]] >> (16 - 8 * k));
        if (!raster->colour)
            memcpy(raw, row, row_bytes);
    }
    const size_t packed_length = deflate_rows(w, effort, raw_length, 0);
    buf_add(out, w->packed, packed_length);
}

enum err png_encode(struct buf *out, uint32_t width, uint32_t height, const uint8_t *rgba,
                    struct fault *fault)
{
    const struct raster raster = {.width = width,
                                  .height = height,
                                  .stride = (size_t)width * 4,
                                  .bytes = rgba,
                                  .has_alpha = true};
    struct png_writer writer = {0};
    if (width == 0 || height == 0 || width > PICTURE_SIDE_MOST || height > PICTURE_SIDE_MOST)
        return fault_set(fault, ERR_LIMIT, "a picture has sides of 1 to %d pixels, not %ux%u",
                         PICTURE_SIDE_MOST, width, height);
    png_add(&writer, &raster, PNG_FILE, out);
    png_release(&writer);
    return out->failed ? fault_memory(fault, "a picture") : OK;
}
