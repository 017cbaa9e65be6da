/* SPDX-License-Identifier: MIT */
/* A decoder for the sixels that we write. A truncated picture is refused, and so is painting
 * outside the picture or with an undeclared colour. */
#ifndef TESTS_SIXEL_DECODE_H
#define TESTS_SIXEL_DECODE_H

#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

struct decoded_sixel {
    uint32_t width, height;
    unsigned colours;
    bool all_painted;
    uint32_t *pixel; /* [height][width] 0xRRGGBB, UINT32_MAX where none was painted; to be freed */
};

static inline uint32_t sixel_number(const char **text)
{
    uint32_t n = 0;
    for (; **text >= '0' && **text <= '9'; ++*text)
        n = n * 10 + (uint32_t)(**text - '0');
    return n;
}

static inline uint32_t sixel_next(const char **text) /* a semicolon and a number */
{
    ++*text;
    return sixel_number(text);
}

/* The channel that a terminal draws for 0..100. */
static inline uint32_t sixel_of_percent(uint32_t percent)
{
    return (percent * 255 + 50) / 100;
}

/* The colour after encoding and decoding. */
static inline uint32_t sixel_round_trip(uint32_t colour)
{
    uint32_t back = 0;
    for (unsigned shift = 24; shift > 0;) {
        shift -= 8;
        back = back << 8 | sixel_of_percent(((colour >> shift & 255) * 100 + 127) / 255);
    }
    return back;
}

static inline bool sixel_paint(struct decoded_sixel *s, unsigned bits, uint32_t colour, uint32_t x,
                               uint32_t y)
{
    for (unsigned i = 0; i < 6; i++) {
        if (!(bits >> i & 1))
            continue;
        if (x >= s->width || y + i >= s->height || colour == UINT32_MAX)
            return false;
        s->pixel[(size_t)(y + i) * s->width + x] = colour;
    }
    return true;
}

static inline bool sixel_body(struct decoded_sixel *s, const char **at)
{
    uint32_t palette[256], x = 0, y = 0, colour = 0;
    const char *text = *at;
    memset(palette, 255, sizeof palette);
    while (*text && *text != '\033') {
        uint32_t run = 1;
        if (*text == '#') {
            colour = sixel_next(&text);
            if (colour > 255)
                return false;
            if (*text != ';')
                continue;
            if (sixel_next(&text) != 2)
                return false;
            uint32_t r = sixel_next(&text), g = sixel_next(&text), b = sixel_next(&text);
            palette[colour] =
                sixel_of_percent(r) << 16 | sixel_of_percent(g) << 8 | sixel_of_percent(b);
            s->colours++;
            continue;
        }
        if (*text == '$' || *text == '-') {
            x = 0;
            y += *text++ == '-' ? 6 : 0;
            continue;
        }
        if (*text == '!')
            run = sixel_next(&text);
        if (*text < '?' || *text > '~')
            return false;
        for (unsigned bits = (unsigned)(*text++ - '?'); run > 0; run--, x++)
            if (!sixel_paint(s, bits, palette[colour], x, y))
                return false;
    }
    *at = text;
    return strncmp(text, "\033\\", 2) == 0;
}

/* Decodes the picture that begins at *text, and moves *text behind it. */
static inline bool sixel_decode(struct decoded_sixel *s, const char **text)
{
    *s = (struct decoded_sixel){0};
    if (strncmp(*text, "\033P0;1q\"1;1;", 11) != 0)
        return false;
    *text += 11;
    s->width = sixel_number(text);
    s->height = sixel_next(text);
    const size_t pixels = (size_t)s->width * s->height;
    s->pixel = malloc((pixels + 1) * sizeof *s->pixel);
    memset(s->pixel, 255, pixels * sizeof *s->pixel);
    if (!sixel_body(s, text))
        return false;
    *text += 2;
    s->all_painted = true;
    for (size_t i = 0; i < pixels; i++)
        s->all_painted &= s->pixel[i] != UINT32_MAX;
    return true;
}

#endif
