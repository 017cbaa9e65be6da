/* SPDX-License-Identifier: MIT */
/*
 * The header of an OpenEXR file, as bytes, read without OpenEXR: the maker of a picture is known
 * without decoding it, and a golden image is compared with the header that exr_write gives.
 *
 *     76 2f 31 01        magic number
 *     02 00 00 00        version 2; flags above: 0x200 tiles, 0x400 long names
 *     "name\0" "type\0" length (4 bytes, little-endian) value        any number of attributes
 *     00                 the end
 *
 * Only the header of the first part is read, and at most EXR_HEADER_MOST bytes of it.
 */
#ifndef IMAGE_EXR_HEADER_H
#define IMAGE_EXR_HEADER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/buf.h"
#include "base/err.h"
#include "image/picture.h"

enum { EXR_HEADER_MOST = 1 << 20 };

struct exr_attribute_bytes {
    const char *name, *type; /* each ended by NUL */
    const char *value;       /* `length` bytes */
    size_t length;
};

/* bytes = the header and no more. ERR_INPUT for another file, or a longer header; ERR_IO,
 * ERR_MEMORY. */
enum err exr_header_read(struct buf *bytes, int fd, struct fault *fault);

/* The next attribute of a header that exr_header_read has read; *at begins as 0. False at the end.
 */
bool exr_header_next(const struct buf *header, size_t *at, struct exr_attribute_bytes *attribute);

/* OK where the header is that of `like` as exr_write writes it, but for the notes: the same size,
 * channels, windows and every other attribute. ERR_CHECK with the first that differs. */
enum err exr_header_check(const struct buf *header, const struct picture *like,
                          struct fault *fault);

#endif
