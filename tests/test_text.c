/* SPDX-License-Identifier: MIT */
/* Words in pictures: letters exist, differ, cover the area of their outlines, and stay within the
 * canvas; for any bytes. */
#include "tests/check_main.h"

#include <math.h>

#include "base/hash.h"
#include "base/safe.h"
#include "render/glyph.h"
#include "render/notes.h"

static const struct ink on_black = {{255, 255, 255}, {0, 0, 0}}, red = {{200, 9, 9}, {9, 9, 200}};

static struct canvas canvas_of(uint32_t width, uint32_t height)
{
    struct canvas canvas;
    CHECK(canvas_init(&canvas, width, height, 0, NULL) == OK);
    return canvas;
}

static bool is_same(const struct canvas *a, const struct canvas *b)
{
    return memcmp(a->rgba, b->rgba, (size_t)4 * a->width * a->height) == 0;
}

static void draw_glyph(const struct canvas *canvas, unsigned outline, uint32_t tall)
{
    struct glyph glyph;
    glyph_make(&glyph, outline, tall, 64 * GLYPH_ONE, 3 * (int64_t)tall / 2);
    glyph_draw(canvas, &glyph, 0, on_black.rgb);
}

/* Compute the inked area of a canvas, white on black, in pixels: light is the square of a
 * colour. */
static double inked(const struct canvas *canvas)
{
    double sum = 0;
    for (size_t i = 0; i < (size_t)canvas->width * canvas->height; i++)
        sum += canvas->rgba[4 * i] * canvas->rgba[4 * i];
    return sum / (255 * 255);
}

static double cross(const struct face_point *a, const struct face_point *b)
{
    return (double)a->x * b->y - (double)b->x * a->y;
}

/* Compute the area to the right of an outline by Green's theorem. */
static double area_of(unsigned outline)
{
    struct face_point p[FACE_POINTS_MOST + 2];
    const size_t count = face_read(p, outline);
    double twice = 0;
    for (size_t i = 0, begin = 0; i < count; i++) {
        begin = p[i].begins ? i : begin;
        const struct face_point next = i + 1 < count && !p[i + 1].begins ? p[i + 1] : p[begin];
        const struct face_point *before = &p[i > begin ? i - 1 : i];
        /* A control point counts with half of the ways to its neighbours. */
        const struct face_point from = {(int16_t)((before->x + p[i].x) / 2),
                                        (int16_t)((before->y + p[i].y) / 2), true, false};
        const struct face_point to = {(int16_t)((next.x + p[i].x) / 2),
                                      (int16_t)((next.y + p[i].y) / 2), true, false};
        const struct face_point *a = before->is_on ? before : &from, *b = next.is_on ? &next : &to;
        if (!p[i].is_on)
            twice += (2 * cross(a, &p[i]) + 2 * cross(&p[i], b) + cross(a, b)) / 3;
        else if (next.is_on)
            twice += cross(&p[i], &next);
    }
    return -twice / 2;
}

/* ---- letters ---- */

STORY(small_letters_are_crisp)
{
    static const char *const shape[10] = {"........................", ".#...#..#####..#........",
                                          ".#...#..#......#........", ".#...#..#......#........",
                                          ".#####..####+..#........", ".#+++#..#+++...#........",
                                          ".#...#..#......#........", ".#...#..#......#........",
                                          ".#...#..#####..####+....", "........................"};
    OWNED(canvas_release) struct canvas canvas = canvas_of(30, 20);
    text_draw(&canvas, 3, 4, 8, "HEL", &on_black);
    for (uint32_t y = 0; y < 10; y++)
        for (uint32_t x = 0; x < 24; x++) {
            const uint8_t level = canvas_pixel(&canvas, 3 + x, 3 + y)[0];
            CHECK_INT(level > 180 ? '#' : level > 90 ? '+' : '.', shape[y][x]);
        }
}

/* Edges of strokes move to whole pixels, and no edge moves further. */
STORY(small_letters_are_as_wide_as_they_are)
{
    enum { FAR = GLYPH_ONE * 3 / 4 };
    for (unsigned outline = 0; outline < FACE_OUTLINES; outline++) {
        struct face_point p[FACE_POINTS_MOST];
        const size_t count = face_read(p, outline);
        for (uint32_t tall = 7; tall <= 16; tall++)
            for (int64_t left = 0; left < GLYPH_ONE; left += 50) {
                struct glyph glyph;
                int64_t least[2] = {INT32_MAX, INT32_MAX}, most[2] = {INT32_MIN, INT32_MIN};
                glyph_make(&glyph, outline, tall, left, 0);
                for (size_t i = 0; i < count; i++) /* the curve stays within its control points */
                    for (int k = 0; k <= p[i].is_on; k++) {
                        const int64_t x = left + glyph_scaled(p[i].x, tall);
                        least[k] = x < least[k] ? x : least[k];
                        most[k] = x > most[k] ? x : most[k];
                    }
                CHECK(!count || (glyph.least.x > least[0] - FAR && glyph.least.x < least[1] + FAR &&
                                 glyph.most.x > most[1] - FAR && glyph.most.x < most[0] + FAR));
            }
    }
}

/* Overlapping contours, as the bar of a D, count twice in the area. */
STORY(ink_is_what_the_outline_covers)
{
    enum { TALL = 83 };
    const double scale = (double)TALL / FACE_CAPITAL;
    OWNED(canvas_release) struct canvas canvas = canvas_of(320, 180);
    int whole = 0;
    for (unsigned outline = 0; outline < FACE_OUTLINES; outline++) {
        canvas_box(&canvas, 0, 0, 320, 180, on_black.outline);
        draw_glyph(&canvas, outline, TALL);
        const double area = area_of(outline) * scale * scale, ink = inked(&canvas);
        whole += fabs(ink - area) < 0.02 * area + 1;
        CHECK(ink < 1.02 * area + 1 && ink > 0.75 * area - 1);
    }
    CHECK(whole > FACE_OUTLINES * 9 / 10);
}

STORY(no_two_letters_are_the_same)
{
    struct canvas canvas[95];
    for (uint32_t i = 0; i < 95; i++) {
        canvas[i] = canvas_of(24, 24);
        text_draw(&canvas[i], 6, 8, 8, (char[2]){(char)(' ' + i), '\0'}, &on_black);
    }
    for (uint32_t a = 0; a < 95; a++) {
        for (uint32_t b = 0; b < a; b++)
            CHECK_WITH(!is_same(&canvas[a], &canvas[b]), "%c and %c", ' ' + a, ' ' + b);
    }
    for (uint32_t i = 0; i < 95; i++)
        canvas_release(&canvas[i]);
}

STORY(the_face_has_what_european_names_need)
{
    static const char names[] = "ÀÉÎÕÜßçøæœŁőžŞğİıĦħŵŷȘțẞΆΈΩάέήίόύώϊςσφθμЀЖЯйщёіїђљѝ"
                                "°±²³µ·½×÷–—‘’“”„†•…‰′″€™−≤≥≈∞→←";
    struct face_point point[FACE_POINTS_MOST];
    uint32_t code;
    for (const char *at = names; *at; at += utf8_read(at, strlen(at), &code)) {
        CHECK(utf8_read(at, strlen(at), &code) > 1);
        CHECK(face_find(code) > 0 && face_read(point, face_find(code)) > 3);
    }
    for (code = 0x21; code < 0x180; code++)
        CHECK_INT(face_find(code) > 0, (code < 0x7f || code > 0x9f) && code != 0xad);
}

STORY(outlines_begin_end_and_stay_in_reach)
{
    for (unsigned outline = 0; outline < FACE_OUTLINES; outline++) {
        struct face_point p[FACE_POINTS_MOST];
        const size_t count = face_read(p, outline);
        CHECK(face_advance(outline) >= 0 && face_advance(outline) < 1400); /* 0: a mark */
        for (size_t i = 0; i < count; i++) {
            CHECK(p[i].x > -400 && p[i].x < 1400 && p[i].y > -400 && p[i].y < 1200);
            CHECK((i > 0 || p[i].begins) && (!p[i].begins || p[i].is_on));
        }
    }
}

/* ---- what is no letter ---- */

STORY(what_the_face_lacks_is_a_box)
{
    static const char *const lacking[] = {"日", "\xff", "\x80", "\x01", "\U0001F9E0", "\u0301"};
    OWNED(canvas_release) struct canvas box = canvas_of(40, 40), other = canvas_of(40, 40);
    struct face_point p[2][FACE_POINTS_MOST];
    text_draw(&box, 9, 9, 8, "\x7f", &on_black);
    CHECK(inked(&box) > 10);
    for (size_t i = 0; i < sizeof lacking / sizeof *lacking; i++) {
        canvas_box(&other, 0, 0, 40, 40, on_black.outline);
        text_draw(&other, 9, 9, 8, lacking[i], &on_black);
        CHECK(is_same(&box, &other));
    }
    const size_t points = face_read(p[0], 0);
    for (unsigned outline = 1; outline < FACE_OUTLINES; outline++)
        CHECK(face_read(p[1], outline) != points || memcmp(p[0], p[1], points * sizeof **p) != 0);
    CHECK_INT(text_width("\xe2\x80\x8b", 20),
              text_width("\xff\xff\xff", 20)); /* invisible: drawn as bytes */
}

STORY(any_bytes_are_drawn_within_their_width)
{
    uint64_t random = 4711;
    OWNED(canvas_release) struct canvas canvas = canvas_of(90, 40), untouched = canvas_of(90, 40);
    for (int round = 0; round < 4000; round++) {
        char words[64] = "";
        const uint32_t tall = 1 + (uint32_t)check_below(&random, 20);
        const size_t length = check_below(&random, sizeof words - 4);
        for (size_t i = 0; i < length; i++)
            words[i] = (char)(1 + check_below(&random, 255));
        words[length] = '\0';
        const int64_t columns = (int64_t)check_below(&random, 300), wide = text_width(words, tall);
        text_draw(&canvas, (int64_t)check_below(&random, 200) - 100,
                  (int64_t)check_below(&random, 100) - 50, tall, words, &red);
        if (strchr(words, '\n'))
            continue;
        text_draw(&untouched, 95 + 2 * tall, 0, tall, words, &red);
        text_draw(&untouched, -wide - 2 * (int64_t)tall - 5, 0, tall, words, &red);
        text_cut(words, sizeof words, tall, columns);
        CHECK(text_width(words, tall) <= (wide < columns ? wide : columns));
        CHECK(strlen(words) < sizeof words);
    }
    canvas_box(&canvas, 0, 0, 90, 40, on_black.outline);
    CHECK(is_same(&canvas, &untouched));
}

STORY(long_names_end_in_dots_at_a_whole_letter)
{
    char name[32] = "Übergröße des Gyrus", tight[8] = "abcdefg", none[8] = "Wide";
    text_cut(name, sizeof name, 20, 10000);
    CHECK_TEXT(name, "Übergröße des Gyrus");
    text_cut(name, sizeof name, 20, text_width("Übergrö…", 20) + 1);
    CHECK_TEXT(name, "Übergrö…");
    text_cut(tight, sizeof tight, 20, text_width(tight, 20) - 1);
    CHECK_TEXT(tight, "abcd…"); /* without room for more bytes */
    text_cut(none, sizeof none, 20, 20);
    CHECK_TEXT(none, "");
}

/* ---- sizes ---- */

STORY(capitals_are_as_tall_as_asked_for)
{
    for (uint32_t tall = 4; tall <= 200; tall += 7) {
        OWNED(canvas_release) struct canvas canvas = canvas_of(300, 300);
        uint32_t first = 300, last = 0;
        draw_glyph(&canvas, face_find('H'), tall);
        for (uint32_t y = 0; y < 300; y++)
            for (uint32_t x = 0; x < 300; x++)
                if (canvas_pixel(&canvas, x, y)[0] > 0) {
                    first = y < first ? y : first;
                    last = y;
                }
        CHECK_INT(last + 1 - first, tall);
        CHECK_INT(last + 1, 3 * tall / 2);
    }
    CHECK_INT(text_width("", 30), 0);
    CHECK(text_width("brain", 60) > 2 * text_width("brain", 30) - 3);
    CHECK(text_width("brain", 60) < 2 * text_width("brain", 30) + 3);
    CHECK(text_width("AV", 100) < text_width("A", 100) + text_width("V", 100) - 3); /* kerning */
}

STORY(sizes_follow_the_picture)
{
    static const uint32_t side[] = {48, 256, 512, 2048, 4096, 8192};
    static const uint32_t tall[] = {8, 8, 11, 45, 91, 182};
    for (int i = 0; i < 6; i++)
        CHECK_INT(notes_tall(side[i]), tall[i]);
    CHECK_INT(text_halo(8), 1);
    CHECK_INT(text_halo(45), 5);
    CHECK(notes_tall_letters(8192) <= GLYPH_TALL_MOST);
    CHECK_INT(notes_tall_letters(48), 8);
}

/* ---- where it is drawn ---- */

STORY(a_halo_tells_ink_from_any_ground)
{
    static const struct ink white = {{255, 255, 255}, {0, 0, 0}};
    for (uint32_t tall = 7; tall < 60; tall += 13) {
        OWNED(canvas_release) struct canvas canvas = canvas_of(90, 80);
        canvas_box(&canvas, 0, 0, 90, 80, white.rgb);
        text_draw(&canvas, 20, 10, tall, "H", &white);
        uint32_t changes = 0;
        for (uint32_t x = 1; x < 90; x++) { /* ground, halo, stem, halo, and so on */
            const bool dark = canvas_pixel(&canvas, x, 10 + tall / 4)[0] < 128;
            changes += dark != (canvas_pixel(&canvas, x - 1, 10 + tall / 4)[0] < 128);
        }
        CHECK_INT(changes, 8);
    }
}

STORY(a_halo_does_not_cover_the_letter_before)
{
    OWNED(canvas_release) struct canvas alone = canvas_of(60, 40), pair = canvas_of(60, 40);
    text_draw(&alone, 5, 8, 20, "l", &on_black);
    text_draw(&pair, 5, 8, 20, "ll", &on_black);
    for (size_t i = 0; i < 60 * 40; i++)
        CHECK(pair.rgba[4 * i] >= alone.rgba[4 * i]);
}

STORY(a_line_feed_begins_a_line)
{
    OWNED(canvas_release) struct canvas canvas = canvas_of(40, 60), apart = canvas_of(40, 60);
    text_draw(&canvas, 3, 5, 9, "ab\ncd", &on_black);
    text_draw(&apart, 3, 5, 9, "ab", &on_black);
    text_draw(&apart, 3, 5 + text_line(9), 9, "cd", &on_black);
    CHECK(is_same(&canvas, &apart));
}

/* Drawn into a part, at and beyond all its edges, the text is the same as without edges, and
 * nothing around it changes. */
STORY(what_falls_beyond_the_edges_is_not_drawn)
{
    OWNED(canvas_release) struct canvas canvas = canvas_of(60, 60), whole = canvas_of(60, 60);
    const struct canvas part = canvas_part(&canvas, 20, 20, 20, 20);
    for (int64_t y = -30; y < 40; y += 3)
        for (int64_t x = -30; x < 40; x += 3) {
            text_draw(&part, x, y, 15, "W@", &red);
            text_draw(&whole, x + 20, y + 20, 15, "W@", &red);
        }
    text_draw(&part, INT32_MAX, INT32_MIN, 15, "W@", &red);
    text_draw(&part, INT64_MIN / 1024, INT64_MAX / 1024, 15, "W@", &red);
    for (uint32_t y = 0; y < 60; y++)
        for (uint32_t x = 0; x < 60; x++) {
            const bool inside = x >= 20 && x < 40 && y >= 20 && y < 40;
            const uint8_t *pixel = canvas_pixel(&canvas, x, y);
            CHECK(memcmp(pixel, inside ? canvas_pixel(&whole, x, y) : (uint8_t[4]){0, 0, 0, 255},
                         4) == 0);
        }
}

/* The ground is neither ink nor outline, so that every changed pixel is visible. */
STORY(a_canvas_remembers_where_its_words_are)
{
    static const uint8_t ground[3] = {90, 255, 90};
    OWNED(canvas_release) struct canvas canvas;
    CHECK(canvas_init(&canvas, 60, 60, CANVAS_NOTES, NULL) == OK);
    canvas_box(&canvas, 0, 0, 60, 60, ground);
    const struct canvas part = canvas_part(&canvas, 20, 30, 40, 30);
    text_draw(&part, -5, -5, 14, "W@j", &red);
    text_draw(&part, 15, 20, 7, "edge", &red);
    int marked = 0;
    for (uint32_t i = 0; i < 60 * 60; i++) {
        CHECK(canvas.words[i] || memcmp(canvas.rgba + 4 * i, ground, 3) == 0);
        marked += canvas.words[i];
    }
    CHECK(marked > 300 && marked < 1200);
}

/* ---- light ---- */

STORY(light_adds_up)
{
    for (uint32_t share = 1; share <= 255; share++) {
        uint8_t pixel[4] = {0, 77, 255, 255}, clear[4] = {0}, again[4];
        canvas_blend(pixel, (const uint8_t[3]){255, 77, 0}, share);
        CHECK(abs(pixel[0] * pixel[0] - (int)share * 255) <= 2 * 255);
        CHECK(pixel[1] == 77 && pixel[3] == 255);
        canvas_blend(clear, red.rgb, share);
        CHECK(memcmp(clear, red.rgb, 3) == 0 && clear[3] == share);
        /* Drawing first and compositing later is the same as drawing directly. */
        memcpy(again, pixel, 4);
        canvas_blend(pixel, red.rgb, share);
        canvas_lay_over(clear, again, 1);
        CHECK(memcmp(pixel, clear, 4) == 0);
    }
}

/* ---- everywhere the same ---- */

STORY(every_machine_draws_the_same)
{
    OWNED(canvas_release) struct canvas canvas = canvas_of(512, 512);
    uint64_t digest = 0;
    for (unsigned outline = 0; outline < FACE_OUTLINES; outline++) {
        struct glyph glyph;
        const uint32_t tall = 7 + outline % 53;
        glyph_make(&glyph, outline, tall, outline * 1999 % 100000, 70 + outline % 400);
        glyph_draw(&canvas, &glyph, GLYPH_ONE + outline, red.outline);
        glyph_draw(&canvas, &glyph, 0, outline % 2 ? red.rgb : on_black.outline);
        digest += hash_mix_at(outline, canvas_digest(&canvas));
    }
    CHECK_INT(digest, -171425511483953982);
}

STORY(a_digest_knows_every_pixel)
{
    static const uint32_t sides[3][2] = {{4, 3}, {3, 4}, {5, 3}};
    uint64_t seen[3 * 16];
    size_t count = 0;
    for (int i = 0; i < 3; i++) {
        OWNED(canvas_release) struct canvas canvas = canvas_of(sides[i][0], sides[i][1]);
        seen[count++] = canvas_digest(&canvas);
        for (uint32_t p = 0; p < sides[i][0] * sides[i][1]; p++) {
            canvas_dot(&canvas, p % sides[i][0], p / sides[i][0], red.rgb);
            seen[count++] = canvas_digest(&canvas);
        }
    }
    for (size_t a = 0; a < count; a++)
        for (size_t b = 0; b < a; b++)
            CHECK(seen[a] != seen[b]);
}
