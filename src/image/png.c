#include "image/png.h"

#include <string.h>
#include <zlib.h>

enum { SIDE_MOST = 16384 };

static void add_number(struct buf *out, uint32_t number)
{
    const uint8_t bytes[4] = {(uint8_t)(number >> 24), (uint8_t)(number >> 16),
                              (uint8_t)(number >> 8), (uint8_t)number};
    buf_add(out, bytes, 4);
}

/* Length, type, content, and a check sum over type and content. */
static void add_chunk(struct buf *out, const char type[4], const void *bytes, size_t length)
{
    uLong sum = crc32_z(0, (const Bytef *)type, 4);
    if (length)
        sum = crc32_z(sum, bytes, length);
    add_number(out, (uint32_t)length);
    buf_add(out, type, 4);
    buf_add(out, bytes, length);
    add_number(out, (uint32_t)sum);
}

/* Lines as PNG has them: the filter's number, 0 for none, before each. */
static void add_lines(struct buf *out, uint32_t width, uint32_t height, const uint8_t *rgba)
{
    const size_t line = (size_t)width * 4;
    if (!buf_reserve(out, (line + 1) * height))
        return;
    for (uint32_t y = 0; y < height; y++) {
        buf_add_char(out, 0);
        buf_add(out, rgba + y * line, line);
    }
}

enum err png_encode(struct buf *out, uint32_t width, uint32_t height, const uint8_t *rgba,
                    struct fault *fault)
{
    struct buf head = {0}, lines = {0}, packed = {0};
    enum err err = OK;
    if (width == 0 || height == 0 || width > SIDE_MOST || height > SIDE_MOST)
        return fault_set(fault, ERR_LIMIT, "a picture has sides of 1 to %d pixels, not %ux%u",
                         SIDE_MOST, width, height);
    add_number(&head, width);
    add_number(&head, height);
    buf_add(&head, "\10\6\0\0\0", 5); /* 8 bits, RGBA, deflate, filters by line, not interlaced */
    add_lines(&lines, width, height, rgba);
    uLongf length = compressBound(lines.length);
    uint8_t *place = lines.failed ? NULL : buf_reserve(&packed, length);
    if (!place || compress2(place, &length, (const Bytef *)lines.data, lines.length, 6) != Z_OK) {
        err = fault_memory(fault, "a picture");
    } else {
        buf_add(out, "\x89PNG\r\n\x1a\n", 8);
        add_chunk(out, "IHDR", head.data, head.length);
        add_chunk(out, "IDAT", place, length);
        add_chunk(out, "IEND", "", 0);
        if (out->failed)
            err = fault_memory(fault, "a picture");
    }
    buf_release(&packed);
    buf_release(&lines);
    buf_release(&head);
    return err;
}
