/*
 * Words in pictures: one small font, drawn in whole pixels.
 *
 * Letters are 5x7 pixels and stand 6 apart, with two rows below for tails; other sizes are whole
 * multiples. A black outline makes them legible on any ground. No library draws them, so that a
 * golden image with words in it is the same on every machine.
 */
#ifndef RENDER_TEXT_H
#define RENDER_TEXT_H

#include <stdint.h>

#include "render/canvas.h"

enum {
    TEXT_ADVANCE = 6, /* columns from one letter to the next */
    TEXT_TALL = 7,    /* rows of a capital */
    TEXT_LINE = 11,   /* rows from one line to the next */
};

/* Draws ASCII; a line feed begins the next line, any other byte comes out as a box. The first
 * letter's top left pixel falls on `left`, `top`; its outline is beyond. */
void text_draw(const struct canvas *canvas, int64_t left, int64_t top, uint32_t scale,
               const char *words, const uint8_t rgb[3]);

/* The same with another outline than black. */
struct ink {
    uint8_t rgb[3], outline[3];
};
void text_draw_outlined(const struct canvas *canvas, int64_t left, int64_t top, uint32_t scale,
                        const char *words, const struct ink *ink);

/* Columns from the first letter's left to the last one's right, of one line. */
int64_t text_width(const char *words, uint32_t scale);

#endif
