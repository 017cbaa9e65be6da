/* Words in pictures: every letter is there, is itself, and stays within the canvas. */
#include "check.h"

#include "render/text.h"

static const uint8_t ink[3] = {200, 100, 50};

static struct canvas canvas_of(uint32_t width, uint32_t height)
{
    struct canvas canvas;
    CHECK(canvas_init(&canvas, width, height, false, NULL) == OK);
    return canvas;
}

static bool is_inked(const struct canvas *canvas, uint32_t x, uint32_t y)
{
    return memcmp(canvas_pixel(canvas, x, y), ink, 3) == 0;
}

static bool is_drawn_as(const struct canvas *canvas, uint32_t left, uint32_t top,
                        const char *const rows[], uint32_t count)
{
    bool same = true;
    for (uint32_t y = 0; y < count; y++)
        for (uint32_t x = 0; rows[y][x]; x++)
            same &= is_inked(canvas, left + x, top + y) == (rows[y][x] == '#');
    return same;
}

STORY(letters_look_as_drawn_here)
{
    static const char *const rag[] = {
        "####.............", "#...#............", "#...#..###...####",
        "####......#.#...#", "#.#....####.#...#", "#..#..#...#..####",
        "#...#..####.....#", "................#", ".............###.",
    };
    struct canvas canvas = canvas_of(30, 20);
    text_draw(&canvas, 3, 4, 1, "Rag", ink);
    CHECK(is_drawn_as(&canvas, 3, 4, rag, 9));
    canvas_release(&canvas);
}

STORY(other_sizes_are_whole_multiples)
{
    struct canvas small = canvas_of(80, 12), large = canvas_of(240, 36);
    text_draw(&small, 2, 2, 1, "3.5 mm\x80", ink);
    text_draw(&large, 6, 6, 3, "3.5 mm\x80", ink);
    bool same = true;
    for (uint32_t y = 0; y < 36; y++)
        for (uint32_t x = 0; x < 240; x++)
            same &= is_inked(&large, x, y) == is_inked(&small, x / 3, y / 3);
    CHECK(same);
    canvas_release(&small);
    canvas_release(&large);
}

STORY(no_two_letters_are_the_same)
{
    struct canvas canvas = canvas_of(6 * 96, 9);
    char all[96];
    for (int i = 0; i < 95; i++)
        all[i] = (char)(' ' + i);
    all[95] = '\0';
    text_draw(&canvas, 0, 0, 1, all, ink);
    for (uint32_t a = 0; a < 95; a++)
        for (uint32_t b = 0; b < a; b++) {
            bool same = true;
            for (uint32_t y = 0; y < 9; y++)
                for (uint32_t x = 0; x < 6; x++)
                    same &= is_inked(&canvas, 6 * a + x, y) == is_inked(&canvas, 6 * b + x, y);
            if (!CHECK(!same))
                printf("#   %c and %c\n", all[a], all[b]);
        }
    canvas_release(&canvas);
}

STORY(letters_stand_apart)
{
    struct canvas canvas = canvas_of(6 * 95, 12);
    char all[96] = {0};
    for (int i = 0; i < 95; i++)
        all[i] = (char)(' ' + i);
    text_draw(&canvas, 0, 1, 1, all, ink);
    for (uint32_t i = 0; i < 95; i++)
        for (uint32_t y = 0; y < 12; y++)
            CHECK(!is_inked(&canvas, 6 * i + 5, y));
    canvas_release(&canvas);
}

STORY(an_outline_tells_ink_from_any_ground)
{
    static const uint8_t white[3] = {255, 255, 255};
    struct canvas canvas = canvas_of(20, 20);
    canvas_box(&canvas, 0, 0, 20, 20, white);
    text_draw(&canvas, 6, 6, 1, "I", ink);
    /* Every pixel beside ink is ink or black; nothing further off is touched. */
    for (int y = 1; y < 19; y++)
        for (int x = 1; x < 19; x++) {
            bool beside = false;
            for (int k = 0; k < 9; k++)
                beside |= is_inked(&canvas, (uint32_t)(x + k % 3 - 1), (uint32_t)(y + k / 3 - 1));
            const uint8_t *p = canvas_pixel(&canvas, (size_t)x, (size_t)y);
            CHECK(is_inked(&canvas, (uint32_t)x, (uint32_t)y) || p[0] == (beside ? 0 : 255));
        }
    canvas_release(&canvas);
}

STORY(a_line_feed_begins_a_line)
{
    struct canvas canvas = canvas_of(40, 40), apart = canvas_of(40, 40);
    text_draw(&canvas, 3, 2, 1, "ab\ncd", ink);
    text_draw(&apart, 3, 2, 1, "ab", ink);
    text_draw(&apart, 3, 13, 1, "cd", ink);
    CHECK(memcmp(canvas.rgba, apart.rgba, (size_t)40 * 40 * 4) == 0);
    canvas_release(&canvas);
    canvas_release(&apart);
    CHECK_INT(text_width("", 3), 0);
    CHECK_INT(text_width("ab", 1), 11);
    CHECK_INT(text_width("ab", 3), 33);
}

/* Drawn into a part, at and beyond all its edges, nothing around it changes. */
STORY(what_falls_beyond_the_edges_is_not_drawn)
{
    struct canvas canvas = canvas_of(60, 60), untouched = canvas_of(60, 60);
    const struct canvas part = canvas_part(&canvas, 20, 20, 20, 20);
    for (int64_t y = -30; y < 40; y += 3)
        for (int64_t x = -30; x < 40; x += 3)
            text_draw(&part, x, y, 2, "W@", ink);
    text_draw(&part, INT32_MAX, INT32_MIN, 2, "W@", ink);
    CHECK(is_inked(&canvas, 20, 20) || is_inked(&canvas, 21, 21));
    canvas_box(&part, -5, -5, 40, 40, (const uint8_t[3]){0, 0, 0});
    CHECK(memcmp(canvas.rgba, untouched.rgba, (size_t)60 * 60 * 4) == 0);
    canvas_release(&canvas);
    canvas_release(&untouched);
}

/* On a ground of neither ink nor outline, so that all that a word changes shows. */
STORY(a_canvas_remembers_where_its_words_are)
{
    static const uint8_t ground[3] = {9, 9, 9};
    struct canvas canvas = canvas_of(60, 60);
    struct fault why;
    CHECK(!canvas_remember(&canvas, &why));
    canvas_box(&canvas, 0, 0, 60, 60, ground);
    const struct canvas part = canvas_part(&canvas, 20, 30, 40, 30);
    text_draw(&part, -5, -5, 2, "W@j", ink);
    text_draw(&part, 15, 20, 1, "edge", ink);
    for (uint32_t i = 0; i < 60 * 60; i++)
        CHECK_INT(canvas.words[i], memcmp(canvas.rgba + 4 * i, ground, 3) != 0);
    canvas_release(&canvas);
}

STORY(a_digest_knows_every_pixel)
{
    static const uint32_t sides[3][2] = {{4, 3}, {3, 4}, {5, 3}};
    uint64_t seen[3 * 16];
    size_t count = 0;
    for (int i = 0; i < 3; i++) {
        struct canvas canvas = canvas_of(sides[i][0], sides[i][1]);
        seen[count++] = canvas_digest(&canvas);
        for (uint32_t p = 0; p < sides[i][0] * sides[i][1]; p++) {
            canvas_dot(&canvas, p % sides[i][0], p / sides[i][0], ink);
            seen[count++] = canvas_digest(&canvas);
        }
        canvas_release(&canvas);
    }
    for (size_t a = 0; a < count; a++)
        for (size_t b = 0; b < a; b++)
            CHECK(seen[a] != seen[b]);
}

int main(void)
{
    return RUN_STORIES(TELL(letters_look_as_drawn_here), TELL(other_sizes_are_whole_multiples),
                       TELL(no_two_letters_are_the_same), TELL(letters_stand_apart),
                       TELL(an_outline_tells_ink_from_any_ground), TELL(a_line_feed_begins_a_line),
                       TELL(what_falls_beyond_the_edges_is_not_drawn),
                       TELL(a_canvas_remembers_where_its_words_are),
                       TELL(a_digest_knows_every_pixel));
}
