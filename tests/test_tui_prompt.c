/* SPDX-License-Identifier: MIT */
/* What the prompt draws in addition to the line, without a terminal: bytes in, bytes out. */
#include "tests/check_main.h"
#include "tui/prompt/line_edit.h"

/* ---- the caret ---- */

static const char *caret(const char *prompt, const char *text, size_t at, bool below,
                         unsigned columns)
{
    static char drawn[512];
    OWNED(buf_release) struct buf out = {0};
    const struct caret c = {prompt, text, at, below, false};
    caret_add(&out, &c, columns);
    snprintf(drawn, sizeof drawn, "%s", buf_text(&out));
    return drawn;
}

STORY(the_caret_stands_under_the_first_column_of_the_word)
{
    CHECK_TEXT(caret("s> ", "sede 1,1,1 1", 0, true, 80), "   ^\n");
    CHECK_TEXT(caret("s> ", "seed 1,1,1 x", 11, true, 80), "              ^\n");
    CHECK_TEXT(caret("s> ", "seed 1,1,1", 11, true, 80), "              ^\n"); /* behind the end */
    CHECK_TEXT(caret("s> ", "seed 1,1,1", 99, true, 80), "              ^\n");
    CHECK_TEXT(caret("s> ", "\xe6\x9c\xac\xe6\x9c\xac x", 7, true, 80), "        ^\n"); /* wide */
    CHECK_TEXT(caret("s> ", "e\xcc\x81 x", 4, true, 80),
               "     ^\n"); /* a combining mark takes no column */
    CHECK_TEXT(caret("s> ", "\x01 x", 2, true, 80), "        ^\n"); /* drawn as \x01 */
}

STORY(a_line_that_did_not_fit_or_is_above_other_output_is_shown_around_the_word)
{
    CHECK_TEXT(caret("s> ", "aa bb", 3, true, 9), "      ^\n");
    CHECK_TEXT(caret("s> ", "aaaa bb", 5, true, 10), "...a bb\n     ^\n");
    CHECK_TEXT(caret("ch2> ", "seed 100,100,50 liver radius=2 and more of it", 16, true, 30),
               "...eed 100,100,50 liver ra...\n                  ^\n");
    CHECK_TEXT(caret("ch2> ", "sede 100,100,50 liver radius=2 and more of it", 0, true, 30),
               "sede 100,100,50 liver r...\n^\n");
    CHECK_TEXT(caret("ch2> ", "\xe6\x9c\xac\xe6\x9c\xac\xe6\x9c\xac\xe6\x9c\xac\xe6\x9c\xac x", 16,
                     true, 16),
               "...\xe6\x9c\xac\xe6\x9c\xac x\n        ^\n");
    CHECK_TEXT(caret("s> ", "sede 1", 0, false, 80), "sede 1\n^\n");
    CHECK_TEXT(caret("s> ", "sede\x1b[m 1", 5, false, 80), "sede\\x1b[m 1\n        ^\n");
}

STORY(in_hardly_any_columns_there_is_no_caret)
{
    CHECK_TEXT(caret("s> ", "sede 1", 0, true, 7), "");
    for (unsigned columns = 8; columns < 40; columns++)
        for (size_t at = 0; at < 30; at++) {
            char text[512];
            snprintf(text, sizeof text, "%s",
                     caret("\xe6\x9c\xac> ",
                           "ab \xe6\x9c\xac\xe6\x9c\xac cd\x01 e\xcc\x81 0123456789", at, true,
                           columns));
            const char *last = strrchr(text, '^');
            const char *feed = last ? strchr(text, '\n') : NULL;
            const char *start = feed && feed < last ? feed + 1 : text;
            CHECK(last && (size_t)(last - start) < columns);
        }
}

/* ---- candidates ---- */

static const char *list(const char *words, unsigned columns, unsigned rows)
{
    static char drawn[4096];
    OWNED(buf_release) struct buf out = {0};
    const struct candidates c = candidates_of(words);
    candidates_list(&c, columns, rows, &out);
    snprintf(drawn, sizeof drawn, "%s", buf_text(&out));
    return drawn;
}

STORY(what_all_candidates_begin_with_is_whole_characters)
{
    CHECK_INT(candidates_of("").count, 0);
    CHECK_INT(candidates_of("seed\n").common, 4);
    CHECK_INT(candidates_of("seed\nseed-file\n").common, 4);
    CHECK_INT(candidates_of("seed\nsave\n").common, 1);
    CHECK_INT(candidates_of("b\xc3\xa4\nb\xc3\xb6\n").common, 1);
    CHECK_INT(candidates_of("seed\nrun\n").common, 0);
}

STORY(candidates_stand_in_columns_without_what_leads_to_a_file_or_are_told_in_one_line)
{
    CHECK_TEXT(list("one\ntwo\n", 80, 24), "one  two\r\n");
    CHECK_TEXT(list("a\nb\nc\nd\ne\n", 6, 24), "a  d\r\nb  e\r\nc\r\n");
    CHECK_TEXT(list("\xe6\x9c\xac\nb\nc\n", 8, 24), "\xe6\x9c\xac  c\r\nb\r\n");
    CHECK_TEXT(list("longer than the window\nb\n", 8, 24), "longer than the window\r\nb\r\n");
    CHECK_TEXT(list("scans/a.nii\nscans/b.nii\n", 80, 24), "a.nii  b.nii\r\n");
    CHECK_TEXT(list("\"my scans/a.nii\"\n\"my scans/masks/\n", 80, 24), "a.nii   masks/\r\n");
    CHECK_TEXT(list("\"a b\"\n\"a c/\n", 80, 24), "a b   a c/\r\n");
    CHECK_TEXT(list("scans/\nscans/a\n", 80, 24), "scans/  a\r\n");
    OWNED(buf_release) struct buf words = {0};
    for (int i = 0; i < 100; i++)
        buf_printf(&words, "%02d\n", i);
    CHECK_TEXT(list(buf_text(&words), 9, 8),
               "00  04\r\n01  05\r\n02  06\r\n03  07\r\nand 92 more\r\n");
    CHECK_TEXT(list(buf_text(&words), 9, 1), "00  01\r\nand 98 more\r\n");
}

STORY(words_that_mean_something_have_a_row_each_where_there_are_rows)
{
    static const char words[] = "seed\tplant a seed\nseed-file\tplant the seeds\nzoom\n";
    CHECK_INT(candidates_of(words).count, 3);
    CHECK_INT(candidates_of("seed\tplant\nsave\tspare\n").common, 1);
    CHECK_INT(candidates_of("seed\tplant a seed\n").common, 4);
    CHECK_TEXT(list(words, 80, 24),
               "seed       plant a seed\r\nseed-file  plant the seeds\r\nzoom\r\n");
    CHECK_TEXT(list(words, 24, 24),
               "seed       plant a seed\r\nseed-file  plant the se\r\nzoom\r\n");
    CHECK_TEXT(list(words, 18, 24), "seed\r\nseed-file\r\nzoom\r\n"); /* no room for it */
    CHECK_TEXT(list(words, 40, 5), "seed       seed-file  zoom\r\n");
    static const char noted[] = "zoom\tnearer\n\tv\tin the pilot, pen\n\tEscape\tdrop\n";
    CHECK_INT(candidates_of(noted).count, 1); /* notes are no words */
    CHECK_INT(candidates_of(noted).notes, 2);
    CHECK_INT(candidates_of(noted).common, 4);
    CHECK_TEXT(list(noted, 80, 24), "zoom         nearer\r\nv            in the pilot, pen\r\n"
                                    "Escape       drop\r\n");
    CHECK_TEXT(list(noted, 80, 5), "zoom\r\n"); /* no rows for them */
    CHECK_TEXT(list("a\t\033[2J\346\234\254\346\234\254\nb\tx\n", 14, 24),
               "a  \\x1b[2J\346\234\254\r\nb  x\r\n");
}

/* ---- hints ---- */

#define GREY "\033[38;5;244m"

static const char *draw(const char *text, size_t cursor, const char *hint, unsigned columns)
{
    static char drawn[512];
    OWNED(buf_release) struct buf out = {0};
    struct line_drawing drawing = {0};
    const struct line_content content = {"> ", text, strlen(text), cursor, hint, GREY, NULL};
    line_draw(&drawing, &content, columns, 24, &out);
    snprintf(drawn, sizeof drawn, "%s", buf_text(&out));
    return drawn;
}

STORY(a_hint_stands_behind_the_cursor_and_is_cut_before_the_last_column)
{
    CHECK_TEXT(draw("seed", 4, NULL, 80), "\r\033[J> seed");
    CHECK_TEXT(draw("seed", 4, "", 80), "\r\033[J> seed");
    CHECK_TEXT(draw("seed", 4, " X,Y,Z", 80), "\r\033[J> seed" GREY " X,Y,Z\033[m\r\033[6C");
    CHECK_TEXT(draw("seed", 4, " X,Y,Z", 11), "\r\033[J> seed" GREY " X,Y\033[m\r\033[6C");
    CHECK_TEXT(draw("seed", 4, " \xe6\x9c\xac!", 9), "\r\033[J> seed" GREY " \033[m\r\033[6C");
    CHECK_TEXT(draw("seed", 4, " X,Y,Z", 7), "\r\033[J> seed");
    CHECK_TEXT(draw("seed", 4, "X,Y,Z", 6), "\r\033[J> seed\r\n" GREY "X,Y,Z\033[m\r");
}
