/* SPDX-License-Identifier: MIT */
/*
 * The graph of a journal: what is drawn of journals made by hand, and of hostile ones.
 */
#include <stdlib.h>

#include "base/clock.h"
#include "journal/graph.h"
#include "journal/record.h"
#include "tests/check.h"

/* A journal under construction; records are "command" and "key=value key=value". */
struct made {
    struct buf bytes;
    struct record_chain chain;
    size_t records;
};

static void begin(struct made *made)
{
    *made = (struct made){.chain = record_chain_zero};
    record_header(&made->bytes, 3);
}

static void add(struct made *made, const char *command, const char *words)
{
    struct buf header = {0};
    if (!made->records)
        record_header(&header, 3);
    const struct record record = {.number = ++made->records, .command = command, .result = words};
    CHECK(record_encode(&made->bytes, &made->chain, buf_text(&header), "", &record, NULL) == OK);
    buf_release(&header);
}

/* The records of a NULL-ended list of pairs. */
static void make(struct made *made, const char *const *pair)
{
    begin(made);
    for (; *pair; pair += 2)
        add(made, pair[0], pair[1]);
}

static void check_drawing(const char *const *pair, bool unicode, const char *expected)
{
    struct made made;
    struct buf out = {0};
    struct fault fault = {0};
    make(&made, pair);
    CHECK(graph_draw(&out, buf_text(&made.bytes), made.bytes.length, unicode, &fault) == OK);
    CHECK_TEXT(buf_text(&out), expected);
    CHECK_TEXT(fault.text, "");
    buf_release(&out);
    buf_release(&made.bytes);
}

static const char *const forked[] = {
    "open s.nii", "scene=1",       "seed 2,3,4 1", "seeds=1",     "branch low",
    "branch=low", "seed 6,10,8 2", "seeds=2",      "run",         "forest=1",
    "goto 2",     "at=2",          "branch high",  "branch=high", "seed 6,10,7 2",
    "seeds=2",    "goto 5",        "at=5",         "view 30",     "",
    NULL,
};

STORY(a_journal_without_alternatives_is_a_straight_line)
{
    check_drawing((const char *const[]){"open s.nii", "scene=1", "seed 2,3,4 1", "seeds=1", "run",
                                        "forest=1 labels=2", NULL},
                  false,
                  "* 1 open s.nii\n"
                  "* 2 seed 2,3,4 1\n"
                  "@ 3 (main, present) run\n");
}

STORY(what_was_undone_hangs_aside_and_what_came_instead_goes_on)
{
    check_drawing((const char *const[]){"open s.nii", "", "seed 2,3,4 1", "", "undo", "at=1",
                                        "seed 2,3,5 1", "", "undo", "at=1", "redo", "at=4", "run",
                                        "", "undo", "at=4", NULL},
                  false,
                  "* 1 open s.nii\n"
                  "|\\\n"
                  "| * 2 seed 2,3,4 1\n"
                  "| (3 undo: at 1)\n"
                  "@ 4 (present) seed 2,3,5 1\n"
                  "| (5 undo: at 1)\n"
                  "| (6 redo: at 4)\n"
                  "* 7 (main) run\n"
                  "(8 undo: at 4)\n");
}

STORY(alternatives_have_their_names_at_their_tips)
{
    check_drawing(forked, false,
                  "* 1 open s.nii\n"
                  "* 2 (main) seed 2,3,4 1\n"
                  "|\\\n"
                  "| * 3 branch low\n"
                  "| * 4 seed 6,10,8 2\n"
                  "| * 5 run\n"
                  "| | (6 goto 2: at 2)\n"
                  "* | 7 branch high\n"
                  "* | 8 (high) seed 6,10,7 2\n"
                  "  | (9 goto 5: at 5)\n"
                  "  @ 10 (low, present) view 30\n");
}

STORY(the_same_in_unicode)
{
    check_drawing(forked, true,
                  "● 1 open s.nii\n"
                  "● 2 (main) seed 2,3,4 1\n"
                  "├─╮\n"
                  "│ ● 3 branch low\n"
                  "│ ● 4 seed 6,10,8 2\n"
                  "│ ● 5 run\n"
                  "│ │ (6 goto 2: at 2)\n"
                  "● │ 7 branch high\n"
                  "● │ 8 (high) seed 6,10,7 2\n"
                  "  │ (9 goto 5: at 5)\n"
                  "  ◆ 10 (low, present) view 30\n");
}

STORY(a_lane_branches_off_past_others)
{
    static const char *const pair[] = {"a", "",       "b",      "",     "goto 1", "at=1",   "c",
                                       "",  "goto 2", "at=2",   "d",    "",       "goto 1", "at=1",
                                       "e", "",       "goto 4", "at=4", "f",      "",       NULL};
    check_drawing(pair, false,
                  "* 1 a\n"
                  "|\\\n"
                  "| * 2 b\n"
                  "| | (3 goto 1: at 1)\n"
                  "|-|\\\n"
                  "| | * 4 c\n"
                  "| | | (5 goto 2: at 2)\n"
                  "| * | 6 d\n"
                  "|   | (7 goto 1: at 1)\n"
                  "*   | 8 e\n"
                  "    | (9 goto 4: at 4)\n"
                  "    @ 10 (main, present) f\n");
    struct made made;
    struct buf out = {0};
    make(&made, pair);
    CHECK(graph_draw(&out, buf_text(&made.bytes), made.bytes.length, true, NULL) == OK);
    CHECK_HAS(buf_text(&out), "├─│─╮\n│ │ ● 4 c\n");
    buf_release(&out);
    buf_release(&made.bytes);
}

STORY(the_beginning_is_drawn_where_it_matters)
{
    check_drawing((const char *const[]){NULL}, false, "@ 0 (present) the beginning\n");
    check_drawing((const char *const[]){"open a", "", "undo", "at=0", NULL}, false,
                  "@ 0 (present) the beginning\n"
                  "* 1 (main) open a\n"
                  "(2 undo: at 0)\n");
    check_drawing((const char *const[]){"open a", "", "undo", "at=0", "branch b", "branch=b",
                                        "open b", "", NULL},
                  false,
                  "* 0 the beginning\n"
                  "|\\\n"
                  "| * 1 (main) open a\n"
                  "| (2 undo: at 0)\n"
                  "* 3 branch b\n"
                  "@ 4 (b, present) open b\n");
}

STORY(a_note_that_leads_to_a_note_leads_to_where_that_led)
{
    check_drawing((const char *const[]){"a", "", "b", "", "undo", "at=1", "c", "", "goto 3", "at=3",
                                        "branch n", "branch=n at=4", NULL},
                  false,
                  "* 1 a\n"
                  "|\\\n"
                  "| * 2 b\n"
                  "| (3 undo: at 1)\n"
                  "* 4 (main) c\n"
                  "| (5 goto 3: at 1)\n"
                  "@ 6 (n, present) branch n\n");
}

STORY(nothing_in_a_journal_reaches_the_terminal_as_it_is)
{
    check_drawing((const char *const[]){"branch \xC2\x9B"
                                        "2J",
                                        "branch=\xE2\x80\xAE"
                                        "a\xFF",
                                        NULL},
                  false, "@ 1 (\\xe2\\x80\\xaea\\xff, present) branch \\xc2\\x9b2J\n");
}

static void check_refused(const char *words, const char *said)
{
    struct made made;
    struct buf out = {0};
    struct fault fault = {0};
    make(&made, (const char *const[]){"a", "", "b", words, "c", "", NULL});
    CHECK(graph_draw(&out, buf_text(&made.bytes), made.bytes.length, false, &fault) == ERR_INPUT);
    CHECK_HAS(fault.text, said);
    CHECK_INT(out.length, 0);
    buf_release(&out);
    buf_release(&made.bytes);
}

STORY(nonsense_is_refused_in_one_line)
{
    check_refused("at=2", "record 2, line 4: at=2: expected the number of a record before it");
    check_refused("at=-1", "at=-1");
    check_refused("at=1x", "at=1x");
    check_refused("at=99999999999999999999", "at=99999999999999999999");
    check_refused("at=\xC2\x9B"
                  "2J",
                  "at=\\xc2\\x9b2J");
    struct buf out = {0};
    struct fault fault = {0};
    CHECK(graph_draw(&out, "open a\nundo\n", 12, false, &fault) == ERR_INPUT);
    CHECK_HAS(fault.text, "this is a script");
    CHECK(graph_draw(&out, "# iftty journal 9 semantics 3\n", 30, false, &fault) == ERR_INPUT);
    const char damaged[] = "# iftty journal 1 semantics 3\n= 1 x\n";
    CHECK(graph_draw(&out, damaged, sizeof damaged - 1, false, &fault) == ERR_INPUT);
    CHECK_INT(out.length, 0);
}

STORY(a_torn_record_is_not_drawn)
{
    struct made made;
    struct buf out = {0};
    make(&made, (const char *const[]){"a", "", "b", "", NULL});
    CHECK(graph_draw(&out, buf_text(&made.bytes), made.bytes.length - 1, false, NULL) == OK);
    CHECK_TEXT(buf_text(&out), "@ 1 (main, present) a\n");
    buf_release(&out);
    buf_release(&made.bytes);
}

static size_t widest_line(const char *text)
{
    size_t widest = 0;
    for (; *text; text += strcspn(text, "\n") + 1)
        if (strcspn(text, "\n") > widest)
            widest = strcspn(text, "\n");
    return widest;
}

static size_t count_lines(const char *text)
{
    size_t lines = 0;
    for (; *text; text++)
        lines += *text == '\n';
    return lines;
}

/* A hundred thousand records in the shape that `words` makes; draws them. */
static void draw_many(struct buf *out, void (*name)(char *words, size_t size, size_t number))
{
    enum { MANY = 100000 };
    struct made made;
    char words[64];
    begin(&made);
    for (size_t i = 1; i <= MANY; i++) {
        name(words, sizeof words, i);
        add(&made, "c", words);
    }
    const uint64_t start = clock_ns();
    CHECK(graph_draw(out, buf_text(&made.bytes), made.bytes.length, false, NULL) == OK);
    printf("# drawn in %llu ms\n", (unsigned long long)((clock_ns() - start) / 1000000));
    buf_release(&made.bytes);
}

static void name_star(char *words, size_t size, size_t number)
{
    snprintf(words, size, number % 2 || number < 3 ? "" : "at=1");
}

static void name_branches(char *words, size_t size, size_t number)
{
    snprintf(words, size, "branch=b%zu at=%zu", number, number / 2);
}

static void name_scattered(char *words, size_t size, size_t number)
{
    uint64_t state = number;
    words[0] = '\0';
    if (number >= 50000)
        snprintf(words, size, "branch=b at=%llu",
                 (unsigned long long)(check_random(&state) % number));
}

STORY(a_hundred_thousand_records_are_drawn_within_bounds)
{
    struct buf out = {0};
    draw_many(&out, name_star);
    CHECK(count_lines(buf_text(&out)) <= 200000);
    CHECK(widest_line(buf_text(&out)) < 40);
    buf_clear(&out);
    draw_many(&out, name_branches);
    CHECK(count_lines(buf_text(&out)) <= 200000);
    CHECK(widest_line(buf_text(&out)) <= 2 * GRAPH_LANES + 40);
    CHECK_HAS(buf_text(&out), "(after 12345");
    buf_clear(&out);
    draw_many(&out, name_scattered);
    CHECK(count_lines(buf_text(&out)) <= 200000);
    CHECK(widest_line(buf_text(&out)) <= 2 * GRAPH_LANES + 40);
    buf_release(&out);
}

int main(void)
{
    return RUN_STORIES(TELL(a_journal_without_alternatives_is_a_straight_line),
                       TELL(what_was_undone_hangs_aside_and_what_came_instead_goes_on),
                       TELL(alternatives_have_their_names_at_their_tips), TELL(the_same_in_unicode),
                       TELL(a_lane_branches_off_past_others),
                       TELL(the_beginning_is_drawn_where_it_matters),
                       TELL(a_note_that_leads_to_a_note_leads_to_where_that_led),
                       TELL(nothing_in_a_journal_reaches_the_terminal_as_it_is),
                       TELL(nonsense_is_refused_in_one_line), TELL(a_torn_record_is_not_drawn),
                       TELL(a_hundred_thousand_records_are_drawn_within_bounds));
}
