/* SPDX-License-Identifier: MIT */
#include "image/png.h"

#include <errno.h>
#include <fcntl.h>
#include <libdeflate.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <zlib.h>

#include "base/mem.h"
#include "base/safe.h"
#include "base/scan.h"

enum {
    STRIP_ROWS = 64,
    STRIP_PIXELS = 1 << 17, /* in a strip at least: fewer cost bytes, more cost memory */
    LEVEL = 4,
    KEYWORD_MOST = 79,
};

enum { HEADER = 13, AROUND = 12 /* bytes around the data of a chunk */, SCALE = 9 };

static const uint8_t signature[8] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};

/* Kinds of pixels, as the header stores them. */
enum png_kind { PNG_COLOURED = 2, PNG_INDEXED = 3, PNG_WITH_ALPHA = 6 };

struct png_coder {
    uint32_t width, height;
    unsigned channels;
};

/* ---- chunks: length, type, data, CRC of type and data ---- */

static void add_chunk(struct buf *png, const char type[4], const void *data, size_t length)
{
    uint8_t number[4];
    uint32_t crc = libdeflate_crc32(libdeflate_crc32(0, type, 4), data, length);
    bits_put(number, 4, length, true);
    buf_add(png, number, 4);
    buf_add(png, type, 4);
    buf_add(png, data, length);
    bits_put(number, 4, crc, true);
    buf_add(png, number, 4);
}

static void add_beginning(struct buf *png, uint32_t width, uint32_t height, unsigned bits,
                          enum png_kind kind)
{
    uint8_t header[HEADER] = {[8] = (uint8_t)bits, [9] = (uint8_t)kind};
    bits_put(header, 4, width, true);
    bits_put(header + 4, 4, height, true);
    buf_add(png, signature, sizeof signature);
    add_chunk(png, "IHDR", header, HEADER);
}

/* The colours of the pixels: sRGB, to be shown by perceptual intent. The last two are accepted as
 * well, since former versions wrote them by OpenImageIO: no intent, and no offset. */
enum { WRITTEN = 3 };
static const struct {
    char type[5];
    uint8_t length;
    uint8_t data[32];
} constant[] = {
    {"gAMA", 4, {0, 0, 0xb1, 0x8f}},
    {"cHRM", 32, {0, 0, 0x7a, 0x26, 0, 0, 0x80, 0x84, 0, 0, 0xfa, 0,    0, 0, 0x80, 0xe8,
                  0, 0, 0x75, 0x30, 0, 0, 0xea, 0x60, 0, 0, 0x3a, 0x98, 0, 0, 0x17, 0x70}},
    {"sRGB", 1, {0}},
    {"sRGB", 1, {3}},
    {"oFFs", 9, {0}},
};

/* ---- strips ---- */

static uint32_t strip_height(const struct picture *like)
{
    const uint32_t least_rows = STRIP_PIXELS / like->width;
    return (least_rows / STRIP_ROWS + 1) * STRIP_ROWS;
}

static enum err begin_coder(void **out, const char *path, const struct picture *like,
                            unsigned planes, struct fault *fault)
{
    struct png_coder *coder = mem_new(sizeof *coder);
    *out = coder;
    (void)planes; /* colours are all that it holds */
    if (!coder)
        return fault_memory(fault, path);
    *coder = (struct png_coder){like->width, like->height, like->is_clear ? 4 : 3};
    return OK;
}

/* Convert pixels to those of the file; over black, if it has no alpha. */
static void fill_row(uint8_t *out, const uint8_t *rgba, uint32_t width, unsigned channels)
{
    if (channels == 4) {
        memcpy(out, rgba, (size_t)4 * width);
        return;
    }
    for (uint32_t x = 0; x < width; x++, rgba += 4, out += 3)
        for (unsigned c = 0; c < 3; c++)
            out[c] = (uint8_t)((rgba[c] * rgba[3] + 127) / 255);
}

/* Filter the rows, from the last to the first, so that the row above is still unfiltered. */
static void filter_strip(uint8_t *raw, size_t row_bytes, uint32_t rows, unsigned each)
{
    const size_t stride = row_bytes + 1;
    for (uint32_t y = rows; y-- > 0;) {
        uint8_t *row = raw + y * stride;
        *row++ = y ? 2 : 1;
        for (size_t i = row_bytes; y && i-- > 0;)
            row[i] = (uint8_t)(row[i] - *(row + i - stride));
        for (size_t i = row_bytes; !y && i-- > each;)
            row[i] = (uint8_t)(row[i] - row[i - each]);
    }
}

/* Deflate `raw` as a part of a stream, which it ends or not. */
static enum err deflate_part(struct buf *out, uint8_t *raw, size_t bytes, bool ends)
{
    z_stream stream = {.next_in = raw, .avail_in = (uInt)bytes};
    if (deflateInit2(&stream, LEVEL, Z_DEFLATED, -MAX_WBITS, 8, Z_FILTERED) != Z_OK)
        return ERR_MEMORY;
    const size_t most = deflateBound(&stream, (uLong)bytes) + 16;
    stream.next_out = buf_reserve(out, most);
    stream.avail_out = (uInt)most;
    const int wanted = ends ? Z_STREAM_END : Z_OK;
    const bool fine = stream.next_out && deflate(&stream, ends ? Z_FINISH : Z_SYNC_FLUSH) == wanted;
    if (fine)
        out->length += most - stream.avail_out;
    deflateEnd(&stream);
    return fine ? OK : ERR_MEMORY;
}

static enum err compress_strip(void *context, const struct picture *rows, uint32_t top,
                               struct buf *out, uint32_t *check, struct fault *fault)
{
    const struct png_coder *coder = context;
    const size_t row_bytes = (size_t)coder->width * coder->channels, stride = row_bytes + 1;
    OWNED(mem_release) uint8_t *raw = mem_array(stride, rows->height);
    OWNED(buf_release) struct buf data = {0};
    if (!raw)
        return fault_memory(fault, "a picture");
    for (uint32_t y = 0; y < rows->height; y++)
        fill_row(raw + y * stride + 1, rows->rgba + (size_t)4 * y * rows->width, rows->width,
                 coder->channels);
    filter_strip(raw, row_bytes, rows->height, coder->channels);
    *check = (uint32_t)adler32(1, raw, (uInt)(stride * rows->height));
    if (top == 0)
        buf_add(&data, "\x78\x5e", 2); /* zlib: a window of 32 kB, made fast */
    const enum err err =
        deflate_part(&data, raw, stride * rows->height, top + rows->height == coder->height);
    if (!err)
        add_chunk(out, "IDAT", data.data, data.length);
    return err || out->failed ? fault_memory(fault, "a picture") : OK;
}

/* ---- chunks before the pixels ---- */

static bool is_keyword(const char *name)
{
    const size_t length = strlen(name);
    bool fine = length > 0 && length <= KEYWORD_MOST && name[0] != ' ' && name[length - 1] != ' ';
    for (size_t i = 0; fine && i < length; i++)
        fine = name[i] >= ' ' && name[i] <= '~' && !(name[i] == ' ' && name[i + 1] == ' ');
    return fine;
}

/* tEXt has no UTF-8, which bytes beyond ASCII are. */
static enum err add_note(struct buf *png, const struct attribute *note, const char *path,
                         struct fault *fault)
{
    bool is_ascii = true;
    OWNED(buf_release) struct buf data = {0};
    if (!is_keyword(note->name))
        return fault_set(fault, ERR_INPUT, "cannot write %s: \"%.40s\" cannot name a note in PNG",
                         path, note->name);
    for (const char *at = note->value; *at; at++)
        is_ascii = is_ascii && !(*at & 0x80);
    buf_add(&data, note->name, strlen(note->name) + 1);
    if (!is_ascii)
        buf_add(&data, "\0\0\0", 4); /* not packed, of no language */
    buf_add_text(&data, note->value);
    add_chunk(png, is_ascii ? "tEXt" : "iTXt", buf_text(&data), data.length);
    png->failed |= data.failed;
    return OK;
}

/* Add the chunks before the pixels. */
static enum err add_head(struct buf *png, const struct png_coder *coder, const char *path,
                         const struct picture *picture, struct fault *fault)
{
    const double most = INT32_MAX;
    const double count = picture->pixel_mm > 0 ? 1000 / picture->pixel_mm + 0.5 : 0;
    const uint32_t a_metre = count < most ? (uint32_t)count : 0;
    uint8_t scale[SCALE] = {[8] = 1}; /* unit: metres */
    add_beginning(png, coder->width, coder->height, 8,
                  coder->channels == 4 ? PNG_WITH_ALPHA : PNG_COLOURED);
    for (int i = 0; i < WRITTEN; i++)
        add_chunk(png, constant[i].type, constant[i].data, constant[i].length);
    bits_put(scale, 4, a_metre, true);
    bits_put(scale + 4, 4, a_metre, true);
    if (a_metre)
        add_chunk(png, "pHYs", scale, SCALE);
    for (size_t i = 0; i < picture->attributes; i++)
        TRY(add_note(png, &picture->attribute[i], path, fault));
    return png->failed ? fault_memory(fault, path) : OK;
}

/* ---- the file ---- */

static enum err write_buf(int fd, const char *path, const struct buf *bytes, struct fault *fault)
{
    return file_step_write(fd, path, buf_text(bytes), bytes->length)
               ? OK
               : fault_errno(fault, "write", path);
}

static enum err write_file(void *context, const char *draft, const struct picture *like,
                           const struct strips_pieces *pieces, struct fault *fault)
{
    const struct png_coder *coder = context;
    const size_t row_bytes = (size_t)coder->width * coder->channels + 1;
    const char *path = pieces->path;
    uLong sum = adler32(0, NULL, 0);
    uint8_t number[4];
    OWNED(buf_release) struct buf bytes = {0};
    enum err err = add_head(&bytes, coder, path, like, fault);
    const int fd = err ? -1 : file_step_open(draft, O_RDWR | O_CREAT | O_EXCL);
    if (!err && fd < 0)
        err = fault_errno(fault, "write", path);
    if (!err)
        err = write_buf(fd, path, &bytes, fault);
    for (size_t i = 0; i < pieces->count && !err; i++) {
        const struct strips_piece *piece = &pieces->piece[i];
        sum = adler32_combine(sum, piece->check, (z_off_t)(row_bytes * piece->rows));
        err = strips_read(pieces, i, &bytes, fault);
        if (!err)
            err = write_buf(fd, path, &bytes, fault);
    }
    bits_put(number, 4, sum, true);
    buf_clear(&bytes);
    add_chunk(&bytes, "IDAT", number, sizeof number);
    add_chunk(&bytes, "IEND", "", 0);
    if (!err)
        err = bytes.failed ? fault_memory(fault, path) : write_buf(fd, path, &bytes, fault);
    if (fd >= 0 && close(fd) != 0 && !err)
        err = fault_errno(fault, "write", path);
    return err;
}

const struct strips_format png_strips = {.height = strip_height,
                                         .begin = begin_coder,
                                         .pack = compress_strip,
                                         .write = write_file,
                                         .end = free};

/* ---- rasters ---- */

void png_release(struct png_writer *writer)
{
    for (unsigned i = 0; i < PNG_EFFORTS; i++)
        if (writer->compressor[i])
            libdeflate_free_compressor(writer->compressor[i]);
    free(writer->raw);
    free(writer->packed);
    *writer = (struct png_writer){0};
}

/* Pack a row of a small palette: several pixels in a byte, the leftmost in the highest bits. */
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

/* Copy the rows, each after the number of its filter: 0 for none, or 2, with zeros, for a row that
 * equals the one above. */
static void fill_rows(uint8_t *out, const struct raster *raster, const uint8_t *place,
                      unsigned bits, size_t row_bytes)
{
    for (uint32_t y = 0; y < raster->height; y++) {
        const uint8_t *row = raster->bytes + y * raster->stride;
        const bool is_same = y > 0 && memcmp(row, row - raster->stride,
                                             raster->width * raster_pixel_bytes(raster)) == 0;
        *out++ = is_same ? 2 : 0;
        if (is_same)
            memset(out, 0, row_bytes);
        else if (!raster->colour)
            memcpy(out, row, row_bytes);
        else if (bits == 8)
            for (uint32_t x = 0; x < raster->width; x++)
                out[x] = place[row[x]];
        else
            pack_row(out, row, raster->width, place, bits);
        out += row_bytes;
    }
}

/* Subtract from each byte the mean of those left and above it (filter 3), from the end to the
 * start, so that both are still unfiltered. */
static void filter_rows(uint8_t *raw, size_t row_bytes, uint32_t rows, size_t each)
{
    const size_t stride = row_bytes + 1;
    for (uint8_t *row = raw; row < raw + rows * stride; row += stride)
        if (row[0] == 2)
            memcpy(row + 1, row + 1 - stride, row_bytes);
    for (uint32_t y = rows; y-- > 0;) {
        uint8_t *row = raw + y * stride;
        row[0] = 3;
        for (size_t i = row_bytes; i > 0; i--)
            row[i] = (uint8_t)(row[i] - ((i > each ? row[i - each] : 0u) +
                                         (y > 0 ? *(row + i - stride) : 0u)) /
                                            2);
    }
}

/* Deflate into one half of the memory or the other. */
static size_t deflate_rows(struct png_writer *w, enum png_effort effort, size_t raw_length,
                           unsigned half)
{
    const size_t room = w->packed_capacity / 2;
    return libdeflate_zlib_compress(w->compressor[effort], w->raw, raw_length,
                                    w->packed + half * room, room);
}

void png_add(struct png_writer *w, const struct raster *raster, enum png_effort effort,
             struct buf *png)
{
    static const int level[PNG_EFFORTS] = {
        [PNG_FAST] = 1, [PNG_SMALL] = 10, [PNG_FILE] = 6, [PNG_SLOW_LINE] = 6};
    uint8_t place[RASTER_COLOURS_MOST];
    uint32_t used[RASTER_COLOURS_MOST];
    bool is_clear = false;
    const unsigned colours = raster->colour ? raster_used(raster, place, used, &is_clear) : 0;
    const unsigned bits = !raster->colour || colours > 16 ? 8
                          : colours > 4                   ? 4
                          : colours > 2                   ? 2
                                                          : 1;
    const size_t row_bytes = raster->colour ? ((size_t)raster->width * bits + 7) / 8
                                            : raster->width * raster_pixel_bytes(raster);
    struct libdeflate_compressor **compressor = &w->compressor[effort];
    size_t raw_length;
    if (!*compressor)
        *compressor = libdeflate_alloc_compressor(level[effort]);
    if (!*compressor || !size_multiply(row_bytes + 1, raster->height, &raw_length) ||
        raw_length > UINT32_MAX / 2 || !mem_grow(&w->raw, &w->raw_capacity, raw_length, 1) ||
        !mem_grow(&w->packed, &w->packed_capacity,
                  2 * libdeflate_zlib_compress_bound(*compressor, raw_length), 1)) {
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
    const enum png_kind kind = raster->colour      ? PNG_INDEXED
                               : raster->has_alpha ? PNG_WITH_ALPHA
                                                   : PNG_COLOURED;
    add_beginning(png, raster->width, raster->height, bits, kind);
    if (raster->colour) {
        uint8_t rgb[3 * RASTER_COLOURS_MOST];
        for (size_t i = 0; i < colours; i++) {
            rgb[3 * i] = (uint8_t)(used[i] >> 16);
            rgb[3 * i + 1] = (uint8_t)(used[i] >> 8);
            rgb[3 * i + 2] = (uint8_t)used[i];
        }
        add_chunk(png, "PLTE", rgb, 3 * (size_t)colours);
    }
    if (is_clear)
        add_chunk(png, "tRNS", "", 1); /* the first colour is transparent */
    add_chunk(png, "IDAT", packed, packed_length);
    add_chunk(png, "IEND", "", 0);
}

enum err png_encode(struct buf *out, uint32_t width, uint32_t height, const uint8_t *rgba,
                    struct fault *fault)
{
    const struct raster raster = {.width = width,
                                  .height = height,
                                  .stride = (size_t)width * 4,
                                  .bytes = rgba,
                                  .has_alpha = true};
    OWNED(png_release) struct png_writer writer = {0};
    if (width == 0 || height == 0 || width > PICTURE_SIDE_MOST || height > PICTURE_SIDE_MOST)
        return fault_set(fault, ERR_LIMIT, "a picture has sides of 1 to %d pixels, not %ux%u",
                         PICTURE_SIDE_MOST, width, height);
    png_add(&writer, &raster, PNG_FILE, out);
    return out->failed ? fault_memory(fault, "a picture") : OK;
}

/* ---- reading ---- */

struct reading {
    struct picture *out;
    const uint8_t *at, *end;
    const uint8_t *data; /* data of the current chunk */
    size_t length;
    char type[5];
    size_t channels;   /* 0 before the header */
    struct buf packed; /* the pixels */
    struct fault *fault;
};

static enum err refuse(const struct reading *r, const char *what)
{
    return fault_set(r->fault, ERR_INPUT, "%s", what);
}

static enum err next_chunk(struct reading *r)
{
    const size_t left = (size_t)(r->end - r->at);
    const size_t length = left < AROUND ? 0 : bits_get(r->at, 4, true);
    if (left < AROUND || length > left - AROUND)
        return refuse(r, "it is cut short");
    memcpy(r->type, r->at + 4, 4);
    r->data = r->at + 8;
    r->length = length;
    if (libdeflate_crc32(0, r->at + 4, length + 4) != bits_get(r->data + length, 4, true))
        return refuse(r, "a checksum in it is wrong");
    r->at += length + AROUND;
    return OK;
}

/* A width of 0 accepts every size. */
static enum err take_header(struct reading *r, uint32_t width, uint32_t height)
{
    const uint8_t *d = r->data;
    if (strcmp(r->type, "IHDR") != 0 || r->length != HEADER || d[8] != 8 ||
        (d[9] != PNG_COLOURED && d[9] != PNG_WITH_ALPHA) || d[10] || d[11] || d[12])
        return refuse(r, "it is no PNG of 8 bits a channel, in colours, as iftty writes them");
    if (width && (bits_get(d, 4, true) != width || bits_get(d + 4, 4, true) != height))
        return fault_set(r->fault, ERR_CHECK, "it has another size");
    r->channels = d[9] == PNG_COLOURED ? 3 : 4;
    return OK;
}

static enum err take_other(struct reading *r)
{
    const bool is_utf8 = strcmp(r->type, "iTXt") == 0;
    if (is_utf8 || strcmp(r->type, "tEXt") == 0) {
        /* A keyword, a zero, and the text, without one; before one of UTF-8 four more, which say
         * that it is not packed, of no language, and the keyword not translated. */
        char name[KEYWORD_MOST + 1];
        const uint8_t *zero = memchr(r->data, 0, r->length);
        const size_t before = zero ? (size_t)(zero - r->data) : 0;
        const size_t skipped = before + 1 + (is_utf8 ? 4 : 0);
        OWNED(buf_release) struct buf value = {0};
        if (!before || before > KEYWORD_MOST || skipped > r->length ||
            (is_utf8 && memcmp(zero + 1, "\0\0\0", 4) != 0) ||
            memchr(r->data + skipped, 0, r->length - skipped))
            return refuse(r, "a text in it has no name, or two");
        memcpy(name, r->data, before + 1);
        if (picture_find(r->out, name))
            return refuse(r, "two texts in it have one name");
        buf_add(&value, r->data + skipped, r->length - skipped);
        return value.failed ? fault_memory(r->fault, "a note on a picture")
                            : picture_note(r->out, name, buf_text(&value), r->fault);
    }
    if (strcmp(r->type, "pHYs") == 0 && r->length == SCALE && bits_get(r->data, 4, true) > 0 &&
        bits_get(r->data, 4, true) == bits_get(r->data + 4, 4, true) &&
        r->data[8] == 1) { /* per metre, square */
        r->out->pixel_mm = 1000.0 / (double)bits_get(r->data, 4, true);
        return OK;
    }
    for (size_t i = 0; i < sizeof constant / sizeof *constant; i++)
        if (strcmp(r->type, constant[i].type) == 0 && r->length == constant[i].length &&
            memcmp(r->data, constant[i].data, r->length) == 0)
            return OK;
    OWNED(buf_release) struct buf type = {0};
    buf_add_safe_text(&type, r->type);
    return fault_set(r->fault, ERR_INPUT, "it has a part %s that iftty does not write there",
                     buf_text(&type));
}

static enum err take_chunks(struct reading *r, uint32_t width, uint32_t height)
{
    TRY(next_chunk(r));
    TRY(take_header(r, width, height));
    TRY(next_chunk(r));
    while (strcmp(r->type, "IDAT") != 0) {
        TRY(take_other(r));
        TRY(next_chunk(r));
    }
    while (strcmp(r->type, "IDAT") == 0) {
        buf_add(&r->packed, r->data, r->length);
        TRY(r->packed.failed ? fault_memory(r->fault, "a picture") : next_chunk(r));
    }
    if (strcmp(r->type, "IEND") != 0 || r->length || r->at != r->end)
        return refuse(r, "something follows its pixels");
    return OK;
}

/* Predict a byte from those left of it, above it, and left of that. */
static int predict(uint8_t filter, int left, int above, int before)
{
    int p, a, b, c;
    switch (filter) {
    case 1:
        return left;
    case 2:
        return above;
    case 3:
        return (left + above) / 2;
    case 4: /* Paeth */
        p = left + above - before;
        a = abs(p - left), b = abs(p - above), c = abs(p - before);
        return a <= b && a <= c ? left : b <= c ? above : before;
    default:
        return 0;
    }
}

/* Undo the filter of each row; `zeros` is the row above the first. False for an unknown filter. */
static bool take_rows(struct reading *r, uint8_t *raw, const uint8_t *zeros)
{
    const size_t each = r->channels, bytes = r->out->width * each;
    const uint8_t *above = zeros;
    uint8_t *to = r->out->rgba;
    for (uint32_t y = 0; y < r->out->height; y++, raw += bytes + 1) {
        uint8_t *row = raw + 1;
        for (size_t i = 0; i < bytes; i++)
            row[i] = (uint8_t)(row[i] + predict(*raw, i >= each ? row[i - each] : 0, above[i],
                                                i >= each ? above[i - each] : 0));
        if (*raw > 4)
            return false;
        for (size_t x = 0; x < r->out->width; x++, to += 4) {
            to[3] = 255;
            memcpy(to, row + x * each, each);
        }
        above = row;
    }
    return true;
}

static enum err take_pixels(struct reading *r)
{
    const size_t bytes = r->out->width * r->channels, all = (bytes + 1) * r->out->height;
    struct libdeflate_decompressor *inflater = libdeflate_alloc_decompressor();
    OWNED(mem_release) uint8_t *raw = mem_array(all, 1), *zeros = mem_new(bytes);
    size_t used = 0, made = 0;
    enum err err = raw && zeros && inflater ? OK : fault_memory(r->fault, "a picture");
    if (!err && (libdeflate_zlib_decompress_ex(inflater, buf_text(&r->packed), r->packed.length,
                                               raw, all, &used, &made) != LIBDEFLATE_SUCCESS ||
                 made != all || !take_rows(r, raw, zeros)))
        err = refuse(r, "its pixels are damaged");
    if (!err && used != r->packed.length)
        err = refuse(r, "bytes follow its packed pixels");
    libdeflate_free_decompressor(inflater);
    return err;
}

static enum err begin_reading(struct reading *r, struct picture *out, const void *bytes,
                              size_t length, struct fault *fault)
{
    const uint8_t *from = bytes;
    *r = (struct reading){.out = out, .fault = fault};
    *out = (struct picture){0};
    if (length < sizeof signature || memcmp(from, signature, sizeof signature) != 0)
        return refuse(r, "it is no PNG");
    r->at = from + sizeof signature;
    r->end = from + length;
    return OK;
}

enum err png_read(struct picture *out, const void *bytes, size_t length, uint32_t width,
                  uint32_t height, struct fault *fault)
{
    struct reading r;
    enum err err = begin_reading(&r, out, bytes, length, fault);
    if (!err)
        err = picture_init(out, width, height, 0, fault);
    if (!err)
        err = take_chunks(&r, width, height);
    if (!err)
        err = take_pixels(&r);
    if (err)
        picture_release(out);
    buf_release(&r.packed);
    return err;
}

enum err png_read_notes(struct picture *out, const void *bytes, size_t length, struct fault *fault)
{
    struct reading r;
    enum err err = begin_reading(&r, out, bytes, length, fault);
    if (!err)
        err = next_chunk(&r);
    if (!err)
        err = take_header(&r, 0, 0);
    while (!err && r.end - r.at >= AROUND && memcmp(r.at + 4, "IDAT", 4) != 0 &&
           !(err = next_chunk(&r)))
        err = take_other(&r);
    if (err)
        picture_release(out);
    return err;
}
