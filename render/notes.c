/* SPDX-License-Identifier: MIT */
#include "render/notes.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "base/safe.h"
#include "render/glyph.h"

const struct ink notes_light = {{232, 232, 232}, {0, 0, 0}};
const struct ink notes_dark = {{16, 16, 16}, {255, 255, 255}};
const uint8_t notes_yellow[3] = {255, 220, 0}, notes_lime[3] = {180, 255, 30};

uint32_t notes_side(const struct canvas *canvas)
{
    return canvas->width < canvas->height ? canvas->width : canvas->height;
}

uint32_t notes_tall(uint32_t side)
{
    enum { LEAST = 8, PARTS = 45 };
    return side > LEAST * PARTS ? side / PARTS : LEAST;
}

uint32_t notes_tall_letters(uint32_t side)
{
    return side < NOTES_BARS_FROM ? notes_tall(side) : notes_tall(side) * 4 / 3;
}

int64_t notes_margin(uint32_t tall)
{
    return (tall + 1) / 2;
}

void notes_draw_sides(const struct canvas *canvas, uint32_t side, const char *const word[4],
                      const struct ink *ink)
{
    const uint32_t letter = notes_tall_letters(side);
    const int64_t margin = notes_margin(notes_tall(side));
    for (int i = 0; i < 4; i++) {
        const int64_t right = canvas->width - text_width(word[i], letter);
        const int64_t bottom = (int64_t)canvas->height - letter;
        const int64_t left = i == 0 ? margin : i == 1 ? right - margin : right / 2;
        const int64_t top = i == 2 ? margin : i == 3 ? bottom - margin : bottom / 2;
        text_draw(canvas, left, top, letter, word[i], ink);
    }
}

void notes_draw_scale(const struct canvas *canvas, uint32_t tall, int64_t pixels, const char *words,
                      const struct ink *ink)
{
    const int64_t wide = (tall + 4) / 8, tick = (tall + 1) / 2, left = notes_margin(tall);
    const int64_t bottom = canvas->height - notes_margin(tall), halo = text_halo(tall);
    const int64_t box[3][4] = {{left, bottom - wide, pixels, wide},
                               {left, bottom - tick, wide, tick},
                               {left + pixels - wide, bottom - tick, wide, tick}};
    for (int i = 0; i < 6; i++) {
        const int64_t *b = box[i % 3], around = i < 3 ? halo : 0;
        canvas_box(canvas, b[0] - around, b[1] - around, b[2] + 2 * around, b[3] + 2 * around,
                   i < 3 ? ink->outline : ink->rgb);
    }
    text_draw(canvas, left, bottom - 2 * tick - tall, tall, words, ink);
}

/* ---- marks ---- */

static const uint8_t black[3] = {0, 0, 0}, white[3] = {255, 255, 255};
static const uint8_t seed_grey[3] = {225, 225, 225}, eliminator_red[3] = {255, 72, 56};

void marks_add(struct marks *marks, struct mark mark)
{
    if (mem_grow(&marks->mark, &marks->capacity, marks->count + 1, sizeof *marks->mark))
        marks->mark[marks->count++] = mark;
    else
        marks->failed = true;
}

/* ---- runs of marks ---- */

uint16_t mark_run(const struct mark *mark)
{
    return (uint16_t)(mark->eliminates ? 0 : 1 + mark->label + (mark->waits ? 256 : 0));
}

/* Return the number of the four neighbours that are equal, or of all eight. */
static unsigned alike(const struct mark_runs *runs, size_t at, bool eight)
{
    const size_t x = at % runs->columns, y = at / runs->columns, step = runs->step;
    unsigned count = 0;
    for (unsigned i = 0; i < 9; i++) { /* outside, these wrap around */
        const size_t column = x + i % 3 * step - step, row = y + i / 3 * step - step;
        if (i != 4 && (eight || i % 2) && column < runs->columns && row < runs->rows)
            count += runs->run[row * runs->columns + column] == runs->run[at];
    }
    return count;
}

void marks_keep(struct marks *marks, const struct mark_runs *runs, unsigned most)
{
    size_t left = 0;
    for (size_t i = 0; i < marks->count; i++)
        if (marks->mark[i].eliminates || !runs->run[marks->mark[i].at] ||
            alike(runs, marks->mark[i].at, most == MARKS_ALONE) <= most)
            marks->mark[left++] = marks->mark[i];
    marks->count = left;
}

/* Draw a disc or two diagonals, `around` pixels wider on every side. */
static void stamp(const struct canvas *canvas, const struct mark *mark, int64_t radius,
                  int64_t around, const uint8_t rgb[3])
{
    const int64_t reach = radius + around;
    for (int64_t dy = -reach; dy <= reach; dy++)
        for (int64_t dx = -reach; dx <= reach; dx++)
            if (mark->eliminates ? llabs(llabs(dx) - llabs(dy)) <= radius / 3 + around
                                 : dx * dx + dy * dy <= reach * reach + reach / 2)
                canvas_dot(canvas, mark->column + dx, mark->row + dy, rgb);
}

int64_t marks_more(const struct canvas *canvas)
{
    return notes_side(canvas) >= NOTES_LARGE_FROM;
}

const uint8_t *marks_colour(const struct palette *palette, uint8_t label)
{
    const uint8_t *rgb = palette->rgb[label];
    return rgb[0] || rgb[1] || rgb[2] ? rgb : seed_grey;
}

void marks_draw(const struct canvas *canvas, const struct marks *marks, int64_t unit, int64_t more,
                const struct palette *palette)
{
    for (int pass = 0; pass < 4; pass++)
        for (size_t i = 0; i < marks->count; i++) {
            const struct mark *mark = &marks->mark[i];
            const uint8_t *rgb =
                mark->eliminates ? eliminator_red : marks_colour(palette, mark->label);
            const int64_t radius = (mark->eliminates ? 2 * unit : unit) + more;
            if (mark->eliminates != (pass >= 2))
                continue;
            if (pass % 2 == 0)
                stamp(canvas, mark, radius, unit, mark->waits ? white : black);
            else
                stamp(canvas, mark, radius, 0, rgb);
        }
}

enum { ONE = GLYPH_ONE, HALO_PARTS = 10 };

/* ---- letters ---- */

/* A line of text, letter by letter. */
struct setting {
    const char *next;
    size_t left;   /* bytes */
    uint32_t tall; /* rows of a capital */
    uint32_t point;
    unsigned outline;
    int64_t at, end; /* horizontal extent of the letter, in parts of a pixel from the line's begin
                        */
};

static struct setting begin_setting(const char *words, uint32_t tall)
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

/* Return the width of the halo, in parts of a pixel. */
static uint32_t halo_of(uint32_t tall)
{
    const uint32_t wide = tall * ONE / HALO_PARTS, most = GLYPH_HALO_MOST * ONE;
    return wide < ONE ? ONE : wide < most ? wide : most;
}

/* Draw ink over the halo of the next letter, which reaches no earlier letter. */
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
        draw_line(canvas, left, top + tall, begin_setting(words, tall), halo, ink);
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
    struct setting s = begin_setting(words, tall);
    while (next_letter(&s))
        continue;
    return (s.end + ONE - 1) / ONE;
}

void text_cut(char *words, size_t capacity, uint32_t tall, int64_t columns)
{
    static const char dots[] = "\xe2\x80\xa6";
    const int64_t room = columns - text_width(dots, tall);
    struct setting s = begin_setting(words, tall);
    size_t fit = 0;
    if (text_width(words, tall) <= columns)
        return;
    while (next_letter(&s) && s.end <= room * ONE)
        if ((size_t)(s.next - words) + sizeof dots <= capacity && s.next[-1] != ' ')
            fit = (size_t)(s.next - words);
    memcpy(words + fit, fit ? dots : "", fit ? sizeof dots : 1);
}
