/* SPDX-License-Identifier: MIT */
/* The pager of the prompt, without a terminal: keys go in, and what it draws comes to stand on a
 * screen of our own. */
#include "tests/check.h"
#include "tests/screen.h"
#include "tui/prompt/pager.h"

static struct screen screen;
static struct pager pager;
static struct buf text;

static void begin(unsigned columns, unsigned rows)
{
    pager_release(&pager);
    memset(&screen, 0, sizeof screen);
    screen_resize(&screen, columns, rows);
    pager_init(&pager, buf_text(&text), text.length);
}

static void begin_numbers(unsigned count, unsigned columns, unsigned rows)
{
    buf_clear(&text);
    for (unsigned i = 1; i <= count; i++)
        buf_printf(&text, "row %u\n", i);
    begin(columns, rows);
}

static void draw(void)
{
    struct buf out = {0};
    CHECK(pager_fit(&pager, screen.columns, screen.rows));
    pager_draw(&pager, &out);
    screen_write(&screen, buf_text(&out), out.length);
    buf_release(&out);
}

/* False when a key of these has left. */
static bool press(const char *bytes)
{
    struct keys keys = {0};
    struct key_event event;
    bool stays = true;
    for (; *bytes && stays; bytes++)
        if (keys_feed(&keys, (uint8_t)*bytes, &event))
            stays = pager_key(&pager, &event);
    if (stays && keys_waiting(&keys) && keys_time_out(&keys, &event))
        stays = pager_key(&pager, &event);
    draw();
    return stays;
}

#define SEE(row, text) CHECK_TEXT(screen_row(&screen, row), text)

STORY(keys_go_through_a_text)
{
    begin_numbers(100, 40, 10);
    draw();
    CHECK(pager_is_needed(&pager));
    SEE(0, "row 1");
    SEE(8, "row 9");
    SEE(9, "1-9 of 100  q: leave, Space, b, / n N,");
    static const struct {
        const char *keys, *first;
    } cases[] = {
        {" ", "row 10"},       {"b", "row 1"},          {"b", "row 1"},
        {"\033[6~", "row 10"}, {"\033[5~", "row 1"},    {"j\r\033[B", "row 4"},
        {"k\033[A", "row 2"},  {"G", "row 92"},         {"  j\006", "row 92"},
        {"\002", "row 83"},    {"g", "row 1"},          {"\033[F", "row 92"},
        {"<", "row 1"},        {"\033[H>", "row 92"},   {"zZ1\t\033[2~", "row 92"},
        {"\033[Hj", "row 2"},  {"\033x\033q", "row 2"}, {"\302\240\303\244", "row 2"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        CHECK(press(cases[i].keys));
        SEE(0, cases[i].first);
    }
    CHECK(!press("q") && !press("\003") && !press("\004") && !press("\033"));
}

/* The caller gives a text of what is wanted, as it is typed. */
STORY(what_is_wanted_may_be_another_text)
{
    begin_numbers(9, 60, 10);
    pager.filters = true;
    draw();
    SEE(9, "/ shows what has a word in it; any other key leaves");
    CHECK(press("/ki"));
    SEE(9, "/ki");
    CHECK_TEXT(buf_text(&pager.wanted), "ki");
    pager_turn_to(&pager, "Kidney\n", 7);
    CHECK(press("d"));
    SEE(0, "Kidney");
    SEE(1, "");
    CHECK(press("\r") && !pager.asks && !pager.failed);
    CHECK_TEXT(buf_text(&pager.wanted), "kid");
    CHECK(press("/x\033"));
    CHECK_TEXT(buf_text(&pager.wanted), "");
    CHECK(press("j") && !press("i"));
}

STORY(words_are_searched_on_and_back)
{
    buf_clear(&text);
    for (unsigned i = 1; i <= 60; i++)
        buf_printf(&text, "%s %u\n", i % 20 ? "line" : "Kidney \346\234\254", i);
    begin(30, 8);
    draw();
    press("/kid");
    SEE(7, "/kid");
    CHECK_INT(screen.column, 4);
    press("n\177\177nq"); /* a letter is a letter */
    SEE(7, "/kinq");
    press("\177\177dNEY\r");
    SEE(0, "Kidney \346\234\254 20");
    press("n");
    SEE(0, "Kidney \346\234\254 40");
    press("N");
    SEE(0, "Kidney \346\234\254 20");
    press("N");
    SEE(7, "not found: kidNEY");
    SEE(0, "Kidney \346\234\254 20");
    press("n");
    press("n");
    SEE(6, "Kidney \346\234\254 60"); /* on the last page */
    press("g/\346\234\254\r");
    SEE(0, "Kidney \346\234\254 20");
    press("/zzz\033"); /* given up */
    SEE(7, "20-26 of 60  q: leave, Space,");
    press("n");
    SEE(0, "Kidney \346\234\254 20");
    press("/\r"); /* nothing wanted, nothing found */
    SEE(0, "Kidney \346\234\254 20");
    CHECK(press("/a\177\177"));
    CHECK(press("/a\003"));
    CHECK(!press("\003"));
}

STORY(another_size_keeps_the_line_at_the_top)
{
    buf_clear(&text);
    for (unsigned i = 1; i <= 40; i++)
        buf_printf(&text, "%02u  some words that fit or not, %02u\n", i, i);
    begin(60, 10);
    draw();
    press("  ");
    SEE(0, "19  some words that fit or not, 19");
    screen_resize(&screen, 20, 5);
    draw();
    SEE(0, "19  some words that");
    SEE(1, "    fit or not, 19");
    SEE(4, "37-40 of 80  q: lea");
    press("j");
    SEE(0, "    fit or not, 19");
    screen_resize(&screen, 60, 60);
    draw();
    SEE(0, "01  some words that fit or not, 01"); /* all of it fits */
    CHECK(!pager_is_needed(&pager));
}

STORY(colours_stay_with_their_rows)
{
    buf_clear(&text);
    buf_add_text(&text, "plain\n\033[38;5;244mgrey words that go on, and on\nand on\033[m plain\n"
                        "plain\n");
    begin(20, 3);
    draw();
    CHECK(!screen.cell[0][0].grey && screen.cell[1][0].grey && screen.cell[1][15].grey);
    press("j");
    press("j"); /* rows that begin in grey */
    SEE(0, "on, and on");
    SEE(1, "and on plain");
    CHECK(screen.cell[0][0].grey && screen.cell[1][0].grey && !screen.cell[1][8].grey);
    CHECK(!screen.grey);
    press("j");
    SEE(1, "plain");
    CHECK(screen.cell[0][0].grey && !screen.cell[1][0].grey);
}

STORY(what_was_looked_at_is_left_as_lines)
{
    struct buf out = {0};
    begin_numbers(9, 20, 4);
    draw();
    press("/row\r");
    pager_print(&pager, &out);
    CHECK_TEXT(buf_text(&out), "row 2\r\nrow 3\r\nrow 4\r\n");
    buf_release(&out);
}

/* The cells of a row of the screen, wide ones counted twice. */
static size_t cells_of(unsigned row)
{
    const char *shown = screen_row(&screen, row);
    return cells_width(shown, strlen(shown));
}

static void add_random_line(uint64_t *random)
{
    static const char *const piece[] = {"word ",
                                        "a",
                                        "\346\234\254",
                                        "e\314\201",
                                        "  ",
                                        "\033[31m",
                                        "\033[m",
                                        "a-word-that-is-wider-than-most",
                                        "\360\237\247\240",
                                        "\033[38;5;244m"};
    for (uint32_t n = check_below(random, 20); n; n--)
        buf_add_text(&text, piece[check_below(random, 10)]);
    buf_add_char(&text, '\n');
}

STORY(random_keys_texts_and_sizes_leave_a_screen_as_drawn_afresh)
{
    static const char *const keys[] = {" ",
                                       "b",
                                       "j",
                                       "k",
                                       "G",
                                       "g",
                                       "/",
                                       "n",
                                       "N",
                                       "a",
                                       "wo",
                                       "\r",
                                       "\177",
                                       "\033",
                                       "\346\234\254",
                                       "\033[B",
                                       "\033[5~",
                                       "\001",
                                       "\033[<0;1;1M",
                                       "\t"};
    uint64_t random = 3;
    for (int round = 0; round < 200; round++) {
        buf_clear(&text);
        for (uint32_t n = 1 + check_below(&random, 60); n; n--)
            add_random_line(&random);
        begin(12 + check_below(&random, 60), 4 + check_below(&random, 30));
        draw();
        for (int i = 0; i < 40; i++) {
            if (check_below(&random, 8) == 0)
                screen_resize(&screen, 1 + check_below(&random, 70), 1 + check_below(&random, 30));
            press(keys[check_below(&random, 20)]);
            CHECK(pager.top < pager.rows && !screen.grey && screen.row + 1 == screen.rows);
            static struct screen before;
            before = screen;
            memset(screen.cell, 0, sizeof screen.cell);
            draw();
            for (unsigned y = 0; y < screen.rows && screen.columns > 1; y++) {
                CHECK_TEXT(screen_row(&before, y), screen_row(&screen, y));
                CHECK(cells_of(y) <= screen.columns);
            }
        }
    }
}

int main(void)
{
    const int status = check_run();
    pager_release(&pager);
    buf_release(&text);
    return status;
}
