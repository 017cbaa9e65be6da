/*
 * A PNG in memory, without the image helper: for pages that hold their own pictures.
 *
 * Eight bits a sample, RGBA, one chunk of data, no filter; nothing is noted. The same picture gives
 * the same bytes.
 */
#ifndef IMAGE_PNG_H
#define IMAGE_PNG_H

#include <stdint.h>

#include "base/buf.h"
#include "base/err.h"

/* Adds the file to `out`. rgba is [height][width][4], sides 1..16384; ERR_LIMIT for others. */
enum err png_encode(struct buf *out, uint32_t width, uint32_t height, const uint8_t *rgba,
                    struct fault *fault);

#endif
