/* SPDX-License-Identifier: MIT */
/*
 * PNG (RFC 2083) in memory, without the image helper: for terminals, which want it small and at
 * once, and for pages that hold their own pictures. One IDAT; the same picture gives the same
 * bytes.
 *
 * A palette of up to 2, 4 or 16 colours packs 8, 4 or 2 pixels into a byte; only colours that occur
 * are in it, and one may be clear. There is no filter, but where bytes cost more than time the
 * average of what is left and above is tried too: of greys in order, as slices have them, it takes
 * a third away, of shaded objects nothing.
 */
#ifndef IMAGE_PNG_H
#define IMAGE_PNG_H

#include "base/buf.h"
#include "base/err.h"
#include "base/file.h"
#include "image/picture.h"
#include "image/strips.h"

/* Whether time counts, or bytes do. On pictures rounded to a palette deflate's level 1 makes 45 kB
 * of a 512x512 rendition in 0.9 ms, 6 makes 42 kB in 1.7 ms; of 40x40 pixels 1 makes 821 bytes, 6
 * makes 844, and 10 makes 769 in 0.1 ms. So the levels are 1, 10, which is for small pictures, 6
 * for files and for whole pictures in blocks of pixels, and 6 with both filters for slow lines. */
enum png_effort { PNG_FAST, PNG_SMALL, PNG_FILE, PNG_SLOW_LINE, PNG_EFFORTS };

/* Compressors and memory, used again for the next picture. `struct png_writer w = {0}` is ready. */
struct png_writer {
    struct libdeflate_compressor *compressor[PNG_EFFORTS]; /* NULL until needed */
    uint8_t *raw, *packed;
    size_t raw_capacity, packed_capacity;
};

void png_release(struct png_writer *writer);

/* Adds a file. Without memory png->failed is set. */
void png_add(struct png_writer *writer, const struct raster *raster, enum png_effort effort,
             struct buf *png);

/* Adds no file, but its pixels alone: 24 bits each, deflated (zlib). Smaller where they are few.
 * Not for pixels with alpha. */
void png_add_pixels(struct png_writer *writer, const struct raster *raster, enum png_effort effort,
                    struct buf *out);

/* Adds the file of one picture: rgba is [height][width][4], sides 1..16384, else ERR_LIMIT. */
enum err png_encode(struct buf *out, uint32_t width, uint32_t height, const uint8_t *rgba,
                    struct fault *fault);

/*
 * A PNG as this program writes it beside a golden image, taken apart without the image helper:
 * 8 bits a channel, RGB or RGBA, not interlaced, with notes as text chunks before the pixels.
 *
 * Everything else is refused, and with it whatever could make a viewer show something else than the
 * pixels that were compared: profiles, another gamma, a colour that is clear, frames of an
 * animation, text that nobody asked for, bytes after the end.
 *
 * `out` gets rgba, alpha 255 in files without, the notes, and the length of a pixel. The size is
 * that of the picture which it is compared with: ERR_CHECK for another. ERR_INPUT for another form,
 * with what it is;
 * ERR_MEMORY. On error *out is empty.
 */
enum err png_read(struct picture *out, const void *bytes, size_t length, uint32_t width,
                  uint32_t height, struct fault *fault);

/* Reads the notes alone of such a file of any size, of which the beginning is enough. `out` has no
 * pixels; it is to be released after OK. */
enum err png_read_notes(struct picture *out, const void *bytes, size_t length, struct fault *fault);

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

extern const struct strips_format png_strips;

/* Writes what is shown of `picture`, and its notes, as `path`, whole or not at all. ERR_INPUT for a
 * note whose name PNG does not hold: 1..79 printable ASCII characters. */
enum err png_write(const char *path, enum file_mode mode, const struct picture *picture,
                   struct fault *fault);

#endif
