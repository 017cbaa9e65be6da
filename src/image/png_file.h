/* SPDX-License-Identifier: MIT */
/*
 * PNG files of pictures: 8 bits a channel, RGB, or RGBA where the picture is clear, with notes.
 *
 * What stands before the pixels, in this order:
 *
 *     gAMA cHRM sRGB   the colours are sRGB, to be shown by perceptual intent
 *     pHYs             pixels per metre of what is shown, where that is known: printed without
 *                      scaling, a picture of a hand is as large as the hand
 *     tEXt, iTXt       the notes, plain ASCII or UTF-8; the program's name says which has made it
 *
 * Rows are packed strip by strip (image/strips.h), each strip without regard to the others: an IDAT
 * chunk each, which ends on a whole byte (Z_SYNC_FLUSH of zlib), and one with the checksum of all.
 * That costs 1 % of the bytes. Each row is less the one above it (filter 2), the first of a strip
 * less its own pixel on the left (filter 1). The same picture gives the same bytes.
 */
#ifndef IMAGE_PNG_FILE_H
#define IMAGE_PNG_FILE_H

#include "base/err.h"
#include "base/file.h"
#include "image/picture.h"
#include "image/strips.h"

extern const struct strips_format png_strips;

/* Writes what is shown of `picture`, and its notes, as `path`, whole or not at all. ERR_INPUT for a
 * note whose name PNG does not hold: 1..79 printable ASCII characters. */
enum err png_write(const char *path, enum file_mode mode, const struct picture *picture,
                   struct fault *fault);

#endif
