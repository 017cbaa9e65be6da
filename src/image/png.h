/* SPDX-License-Identifier: MIT */
/*
 * PNG (RFC 2083) in memory, without the image helper: for terminals, which need it small and fast,
 * and for HTML pages with embedded pictures. One IDAT; the same picture has the same bytes.
 *
 * A palette of up to 2, 4 or 16 colours packs 8, 4 or 2 pixels into a byte; it has only colours
 * that occur, and one may be transparent. No filter is used except for rows that equal the row
 * above, which most do in pictures in blocks of pixels. If bytes cost more than time, the average
 * filter is tried too: it saves a third for slices of ordered greys, nothing for shaded objects.
 */
#ifndef IMAGE_PNG_H
#define IMAGE_PNG_H

#include "base/buf.h"
#include "base/err.h"
#include "base/file.h"
#include "image/picture.h"
#include "image/strips.h"

/* Optimise for time or for bytes. For pictures rounded to a palette deflate's level 1 needs 45 kB
 * for a 512x512 rendition in 0.9 ms, level 6 needs 42 kB in 1.7 ms; for 40x40 pixels level 1 needs
 * 821 bytes, 6 needs 844, and 10 needs 769 in 0.1 ms. So the levels are 1; 10 for small pictures; 6
 * for files and for whole pictures in blocks of pixels; and 6 with both filters for slow lines,
 * where 10 would save 6 % of a part of a slice, in eight times the time. */
enum png_effort { PNG_FAST, PNG_SMALL, PNG_FILE, PNG_SLOW_LINE, PNG_EFFORTS };

/* Compressors and memory, reused for the next picture. Initialise with {0}. */
struct png_writer {
    struct libdeflate_compressor *compressor[PNG_EFFORTS]; /* NULL until needed */
    uint8_t *raw, *packed;
    size_t raw_capacity, packed_capacity;
};

void png_release(struct png_writer *writer);

/* Append a file. Sets png->failed if out of memory. */
void png_add(struct png_writer *writer, const struct raster *raster, enum png_effort effort,
             struct buf *png);

/* Append the file of one picture: rgba is [height][width][4]; ERR_LIMIT for sides beyond 1..16384.
 */
enum err png_encode(struct buf *out, uint32_t width, uint32_t height, const uint8_t *rgba,
                    struct fault *fault);

/*
 * Read a PNG that this program wrote next to a golden image, without the image helper: 8 bits a
 * channel, RGB or RGBA, not interlaced, with notes as text chunks before the pixels.
 *
 * Everything else is refused, in particular everything that could make a viewer show pixels other
 * than the compared ones: profiles, another gamma, a transparent colour, frames of an
 * animation, unexpected text, bytes after the end.
 *
 * `out` has rgba, with alpha 255 for files without it, the notes, and the length of a pixel.
 * ERR_CHECK for another size than the expected one, ERR_INPUT for another form, with its
 * description; ERR_MEMORY. On error *out is empty.
 */
enum err png_read(struct picture *out, const void *bytes, size_t length, uint32_t width,
                  uint32_t height, struct fault *fault);

/* Read the notes of such a file of any size; its beginning is enough. `out` has no pixels; release
 * it after OK. */
enum err png_read_notes(struct picture *out, const void *bytes, size_t length, struct fault *fault);

/*
 * PNG files of pictures: 8 bits a channel, RGB, or RGBA where the picture is clear, with notes.
 *
 * Chunks before the pixels, in this order:
 *
 *     gAMA cHRM sRGB   the colours are sRGB, to be shown by perceptual intent
 *     pHYs             pixels per metre of the scene, if known: printed without scaling, a picture
 *                      of a hand is as large as the hand
 *     tEXt, iTXt       the notes, plain ASCII or UTF-8, with the name of the program
 *
 * Strips of rows (image/strips.h) are compressed independently: an IDAT chunk each, which ends on a
 * whole byte (Z_SYNC_FLUSH of zlib), and one with the checksum of all. That costs 1 % of the bytes.
 * The row above is subtracted from each row (filter 2), in the first row of a strip the pixel on
 * the left (filter 1). The same picture has the same bytes.
 */

/* The visible colours of a picture, and its notes. ERR_INPUT for a note whose name is invalid in
 * PNG, which has 1..79 printable ASCII characters. */
extern const struct strips_format png_strips;

#endif
