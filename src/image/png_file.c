/* SPDX-License-Identifier: MIT */
#include "image/png_file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <zlib.h>

#include "base/mem.h"
#include "image/png.h"

enum {
    STRIP_ROWS = 64,
    STRIP_PIXELS = 1 << 17, /* in a strip at least: fewer cost bytes, more cost memory */
    LEVEL = 4,
    KEYWORD_MOST = 79,
};

struct png_coder {
    uint32_t width, height;
    unsigned channels;
};

/* ---- strips ---- */

static uint32_t height_of(const struct picture *like)
{
    const uint32_t least_rows = STRIP_PIXELS / like->width;
    return (least_rows / STRIP_ROWS + 1) * STRIP_ROWS;
}

static enum err begin(void **out, const char *path, const struct picture *like, unsigned planes,
                      struct fault *fault)
{
    struct png_coder *coder = mem_new(sizeof *coder);
    *out = coder;
    (void)planes; /* colours are all that it holds */
    if (!coder)
        return fault_memory(fault, path);
    *coder = (struct png_coder){like->width, like->height, like->is_clear ? 4 : 3};
    return OK;
}

/* Pixels as they are in the file; over black, where it has no alpha. */
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

/* The rows with their filters, from the last on, so that those above are still as they were. */
static void filter(uint8_t *raw, size_t row_bytes, uint32_t rows, unsigned each)
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

/* Deflates `raw` as a part of a stream that other parts follow, unless it `ends`. */
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

static enum err pack(void *context, const struct picture *rows, uint32_t top, struct buf *out,
                     uint32_t *check, struct fault *fault)
{
    const struct png_coder *coder = context;
    const size_t row_bytes = (size_t)coder->width * coder->channels, stride = row_bytes + 1;
    uint8_t *raw = mem_array(stride, rows->height);
    struct buf data = {0};
    enum err err = raw ? OK : ERR_MEMORY;
    for (uint32_t y = 0; !err && y < rows->height; y++)
        fill_row(raw + y * stride + 1, rows->rgba + (size_t)4 * y * rows->width, rows->width,
                 coder->channels);
    if (!err) {
        filter(raw, row_bytes, rows->height, coder->channels);
        *check = (uint32_t)adler32(1, raw, (uInt)(stride * rows->height));
        if (top == 0)
            buf_add(&data, "\x78\x5e", 2); /* zlib: a window of 32 kB, made fast */
        err = deflate_part(&data, raw, stride * rows->height, top + rows->height == coder->height);
    }
    if (!err)
        png_add_chunk(out, "IDAT", data.data, data.length);
    buf_release(&data);
    free(raw);
    return err || out->failed ? fault_memory(fault, "a picture") : OK;
}

/* ---- what stands before them ---- */

static bool is_keyword(const char *name)
{
    const size_t length = strlen(name);
    bool fine = length > 0 && length <= KEYWORD_MOST && name[0] != ' ' && name[length - 1] != ' ';
    for (size_t i = 0; fine && i < length; i++)
        fine = name[i] >= ' ' && name[i] <= '~' && !(name[i] == ' ' && name[i + 1] == ' ');
    return fine;
}

/* Bytes that are not ASCII are UTF-8, which tEXt does not know. */
static enum err add_note(struct buf *png, const struct attribute *note, const char *path,
                         struct fault *fault)
{
    bool is_ascii = true;
    struct buf data = {0};
    if (!is_keyword(note->name))
        return fault_set(fault, ERR_INPUT, "cannot write %s: \"%.40s\" cannot name a note in PNG",
                         path, note->name);
    for (const char *at = note->value; *at; at++)
        is_ascii = is_ascii && !(*at & 0x80);
    buf_add(&data, note->name, strlen(note->name) + 1);
    if (!is_ascii)
        buf_add(&data, "\0\0\0", 4); /* not packed, of no language */
    buf_add_text(&data, note->value);
    png_add_chunk(png, is_ascii ? "tEXt" : "iTXt", buf_text(&data), data.length);
    png->failed |= data.failed;
    buf_release(&data);
    return OK;
}

static enum err add_head(struct buf *png, const struct png_coder *coder, const char *path,
                         const struct picture *picture, struct fault *fault)
{
    png_add_beginning(png, coder->width, coder->height, 8,
                      coder->channels == 4 ? PNG_WITH_ALPHA : PNG_COLOURED);
    png_add_colours(png);
    png_add_scale(png, picture->pixel_mm);
    enum err err = OK;
    for (size_t i = 0; i < picture->attributes && !err; i++)
        err = add_note(png, &picture->attribute[i], path, fault);
    return err ? err : png->failed ? fault_memory(fault, path) : OK;
}

/* ---- the file ---- */

static enum err write_buf(int fd, const char *path, const struct buf *bytes, struct fault *fault)
{
    return file_step_write(fd, path, buf_text(bytes), bytes->length)
               ? OK
               : fault_errno(fault, "write", path);
}

static enum err write_pieces(const struct png_coder *coder, int fd, const struct strips *strips,
                             struct buf *bytes, struct fault *fault)
{
    const size_t row_bytes = (size_t)coder->width * coder->channels + 1;
    uLong sum = adler32(0, NULL, 0);
    enum err err = OK;
    for (size_t i = 0; i < strips_count(strips) && !err; i++) {
        const struct strips_piece *piece = strips_piece(strips, i);
        sum = adler32_combine(sum, piece->check, (z_off_t)(row_bytes * piece->rows));
        err = strips_read(strips, i, bytes, fault);
        if (!err)
            err = write_buf(fd, strips_path(strips), bytes, fault);
    }
    const uint8_t number[4] = {(uint8_t)(sum >> 24), (uint8_t)(sum >> 16), (uint8_t)(sum >> 8),
                               (uint8_t)sum};
    buf_clear(bytes);
    png_add_chunk(bytes, "IDAT", number, sizeof number);
    png_add_chunk(bytes, "IEND", "", 0);
    if (!err && bytes->failed)
        err = fault_memory(fault, strips_path(strips));
    return err ? err : write_buf(fd, strips_path(strips), bytes, fault);
}

static enum err write_file(void *context, const char *draft, const struct picture *like,
                           const struct strips *strips, struct fault *fault)
{
    const struct png_coder *coder = context;
    const char *path = strips_path(strips);
    struct buf bytes = {0};
    enum err err = add_head(&bytes, coder, path, like, fault);
    const int fd = err ? -1 : file_step_open(draft, O_RDWR | O_CREAT | O_EXCL);
    if (!err && fd < 0)
        err = fault_errno(fault, "write", path);
    if (!err)
        err = write_buf(fd, path, &bytes, fault);
    if (!err)
        err = write_pieces(coder, fd, strips, &bytes, fault);
    if (fd >= 0 && close(fd) != 0 && !err)
        err = fault_errno(fault, "write", path);
    buf_release(&bytes);
    return err;
}

const struct strips_format png_strips = {height_of, begin, pack, write_file, free};

enum err png_write(const char *path, enum file_mode mode, const struct picture *picture,
                   struct fault *fault)
{
    struct strips *strips;
    struct picture shown = *picture;
    shown.rgba = shown.shown ? shown.shown : shown.rgba;
    const enum err err = strips_begin(&strips, &png_strips, path, mode, picture, 0, fault);
    if (err)
        return err;
    strips_give_all(strips, &shown);
    return strips_end(strips, picture, fault);
}
