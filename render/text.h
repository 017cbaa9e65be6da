/* SPDX-License-Identifier: MIT */
/*
 * Words in pictures, set in one face (render/face.h) at any size.
 *
 * A size is how many rows a capital is tall. Around letters is a halo, so that they stand on any
 * ground: of black or what is asked for, a tenth as wide as they are tall, and a pixel at least.
 * Where letters meet ink goes over halos. No library draws them, and no float, so that a golden
 * image with words in it is the same on every machine.
 *
 * Words are UTF-8. What the face lacks is a box, as is each byte that is no such text, and a
 * character that nobody would see.
 */
#ifndef RENDER_TEXT_H
#define RENDER_TEXT_H

#include <stddef.h>
#include <stdint.h>

#include "render/canvas.h"

struct ink {
    uint8_t rgb[3], outline[3];
};

/* Draws words; a line feed begins the next line. The first letter stands at column `left`, and the
 * top of its capitals is row `top`; accents, tails and the halo go beyond. `tall` is
 * 1..GLYPH_TALL_MOST. */
void text_draw(const struct canvas *canvas, int64_t left, int64_t top, uint32_t tall,
               const char *words, const struct ink *ink);

/* How wide halos are, in whole pixels. */
int64_t text_halo(uint32_t tall);

/* Columns that one line takes; rows from one line to the next. */
int64_t text_width(const char *words, uint32_t tall);
int64_t text_line(uint32_t tall);

/* Cuts a line at whole letters, and ends it with dots, so that it takes no more columns; where
 * nothing fits, nothing is left. `capacity` is that of `words`. */
void text_cut(char *words, size_t capacity, uint32_t tall, int64_t columns);

#endif
