/* SPDX-License-Identifier: MIT */
/* Pages of a text: where they end, and which keys leave. The terminal is in test_prompt_pty. */
#include "tests/check_main.h"
#include "tests/screen.h"
#include "tui/prompt/pager.h"

static struct buf wrapped;

static void wrap(const char *words, unsigned columns)
{
    OWNED(buf_release) struct buf text = {0};
    buf_add_text(&text, words);
    buf_clear(&wrapped);
    cells_wrap(&wrapped, &text, columns);
}

/* The bytes of each page, to the end. */
static void check_pages(unsigned columns, unsigned rows, const char *const *page)
{
    const struct term_size size = {.columns = columns, .rows = rows};
    size_t at = 0;
    for (; *page; page++) {
        const size_t end = pager_page_end(&wrapped, at, &size);
        char shown[200];
        snprintf(shown, sizeof shown, "%.*s", (int)(end - at), buf_text(&wrapped) + at);
        CHECK_TEXT(shown, *page);
        at = end;
    }
    CHECK_INT(at, wrapped.length);
}

STORY(a_page_leaves_a_row_for_more)
{
    wrap("1\n2\n3\n4\n5\n", 20);
    check_pages(20, 4, (const char *const[]){"1\r\n2\r\n3\r\n", "4\r\n5\r\n", NULL});
    check_pages(20, 6, (const char *const[]){"1\r\n2\r\n3\r\n4\r\n5\r\n", NULL});
    check_pages(20, 1, (const char *const[]){"1\r\n", "2\r\n", "3\r\n", "4\r\n", "5\r\n", NULL});
}

STORY(wide_characters_colours_and_long_words_count_as_a_terminal_has_them)
{
    wrap("\033[31mred\033[m\nabcdefghijklm\nend\n", 5); /* the word takes three rows */
    check_pages(5, 5,
                (const char *const[]){"\033[31mred\033[m\r\nabcdefghijklm\r\n", "end\r\n", NULL});
    check_pages(
        5, 4, (const char *const[]){"\033[31mred\033[m\r\n", "abcdefghijklm\r\n", "end\r\n", NULL});
    check_pages(
        5, 2, (const char *const[]){"\033[31mred\033[m\r\n", "abcdefghijklm\r\n", "end\r\n", NULL});
    wrap("\xe6\x9c\xac\xe6\x9c\xac\xe6\x9c\xac\nend\n", 5); /* six cells */
    check_pages(5, 3,
                (const char *const[]){"\xe6\x9c\xac\xe6\x9c\xac\xe6\x9c\xac\r\n", "end\r\n", NULL});
}

static bool leaves(const char *bytes)
{
    struct keys keys = {0};
    struct key_event event = {0};
    bool has_key = false;
    for (; *bytes; bytes++)
        has_key = keys_feed(&keys, (uint8_t)*bytes, &event);
    has_key = has_key || keys_time_out(&keys, &event);
    return CHECK(has_key) && pager_is_left_by(&event);
}

STORY(some_keys_leave_and_others_show_the_next_page)
{
    static const char *const leaving[] = {"q", "Q", "\033", "\003", "\004"};
    static const char *const others[] = {" ", "\r", "j", "c", "\033[B", "\033[6~", "\177"};
    for (size_t i = 0; i < sizeof leaving / sizeof *leaving; i++)
        CHECK(leaves(leaving[i]));
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        CHECK(!leaves(others[i]));
}

/* Any text at any size: each page fits the screen above its last row, but for one long word. */
STORY(a_page_fits_the_screen_whatever_the_text)
{
    static const char *const piece[] = {
        "a", "\xe6\x9c\xac", "\n",    "\033[31m", "\033[m",
        " ", "  ",           "word ", "\n",       "a-long-word-that-is-wide"};
    static struct screen screen;
    uint64_t seed = 5;
    for (int round = 0; round < 300; round++) {
        OWNED(buf_release) struct buf text = {0};
        const struct term_size size = {.columns = 4 + check_below(&seed, 40),
                                       .rows = 2 + check_below(&seed, 20)};
        for (uint64_t n = check_below(&seed, 300); n > 0; n--)
            buf_add_text(&text, piece[check_below(&seed, sizeof piece / sizeof *piece)]);
        buf_clear(&wrapped);
        cells_wrap(&wrapped, &text, size.columns);
        for (size_t at = 0, end; at < wrapped.length; at = end) {
            end = pager_page_end(&wrapped, at, &size);
            if (!CHECK(end > at))
                break;
            memset(&screen, 0, sizeof screen);
            screen_resize(&screen, size.columns, 60);
            screen_write(&screen, buf_text(&wrapped) + at, end - at);
            const char *feed = memchr(buf_text(&wrapped) + at, '\n', end - at);
            const bool is_one = !feed || feed + 1 == buf_text(&wrapped) + end;
            CHECK(is_one || screen.row < size.rows);
        }
    }
}
