/* SPDX-License-Identifier: MIT */
#include "render/text.h"

#include <string.h>

#include "base/safe.h"
#include "render/face.h"
#include "render/glyph.h"

enum { ONE = GLYPH_ONE, HALO_PARTS = 10 };

/* ---- letters ---- */

/* A line, letter by letter. */
struct setting {
    const char *next;
    size_t left;   /* bytes */
    uint32_t tall; /* rows of a capital */
    uint32_t point;
    unsigned outline;
    int64_t at, end; /* where it begins and ends, in parts of a pixel from the line's begin */
};

static struct setting begin(const char *words, uint32_t tall)
{
    return (struct setting){.next = words, .left = strcspn(words, "\n"), .tall = tall};
}

static bool next_letter(struct setting *s)
{
    const uint32_t former = s->point;
    if (s->left == 0)
        return false;
    const size_t bytes = safe_character(s->next, s->left);
    s->point = 0;
    if (bytes)
        utf8_read(s->next, s->left, &s->point);
    s->outline = face_find(s->point);
    s->at = s->end + glyph_scaled(face_kerning(former, s->point), s->tall);
    s->end = s->at + glyph_scaled(face_advance(s->outline), s->tall);
    s->next += bytes ? bytes : 1;
    s->left -= bytes ? bytes : 1;
    return true;
}

/* ---- drawing ---- */

/* In parts of a pixel. */
static uint32_t halo_of(uint32_t tall)
{
    const uint32_t wide = tall * ONE / HALO_PARTS, most = GLYPH_HALO_MOST * ONE;
    return wide < ONE ? ONE : wide < most ? wide : most;
}

/* A letter's ink goes over the halo of the next, which does not reach any letter before. */
static void draw_line(const struct canvas *canvas, int64_t left, int64_t base, struct setting s,
                      uint32_t halo, const struct ink *ink)
{
    struct glyph glyph[2];
    for (unsigned i = 0; next_letter(&s); i++) {
        glyph_make(&glyph[i % 2], s.outline, s.tall, left * ONE + s.at, base);
        glyph_draw(canvas, &glyph[i % 2], halo, ink->outline);
        if (i > 0)
            glyph_draw(canvas, &glyph[(i - 1) % 2], 0, ink->rgb);
        if (s.left == 0)
            glyph_draw(canvas, &glyph[i % 2], 0, ink->rgb);
    }
}

void text_draw(const struct canvas *canvas, int64_t left, int64_t top, uint32_t tall,
               const char *words, const struct ink *ink)
{
    const uint32_t halo = halo_of(tall);
    for (;; words++, top += text_line(tall)) {
        draw_line(canvas, left, top + tall, begin(words, tall), halo, ink);
        words += strcspn(words, "\n");
        if (!*words)
            return;
    }
}

int64_t text_halo(uint32_t tall)
{
    return (halo_of(tall) + ONE / 2) / ONE;
}

int64_t text_line(uint32_t tall)
{
    return (tall * 8 + 4) / 5;
}

int64_t text_width(const char *words, uint32_t tall)
{
    struct setting s = begin(words, tall);
    while (next_letter(&s))
        continue;
    return (s.end + ONE - 1) / ONE;
}

void text_cut(char *words, size_t capacity, uint32_t tall, int64_t columns)
{
    static const char dots[] = "\xe2\x80\xa6";
    const int64_t room = columns - text_width(dots, tall);
    struct setting s = begin(words, tall);
    size_t fit = 0;
    if (text_width(words, tall) <= columns)
        return;
    while (next_letter(&s) && s.end <= room * ONE)
        if ((size_t)(s.next - words) + sizeof dots <= capacity && s.next[-1] != ' ')
            fit = (size_t)(s.next - words);
    memcpy(words + fit, fit ? dots : "", fit ? sizeof dots : 1);
}
