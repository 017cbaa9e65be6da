/* What the prompt draws besides the line itself, without a terminal: bytes in, bytes out. */
#include "tests/check.h"
#include "tui/caret.h"

/* ---- the caret ---- */

static const char *caret(const char *prompt, const char *text, size_t at, bool below,
                         unsigned columns)
{
    static char drawn[512];
    struct buf out = {0};
    const struct caret c = {prompt, text, at, below, false};
    caret_add(&out, &c, columns);
    snprintf(drawn, sizeof drawn, "%s", buf_text(&out));
    buf_release(&out);
    return drawn;
}

STORY(the_caret_stands_under_the_first_column_of_the_word)
{
    CHECK_TEXT(caret("s> ", "sede 1,1,1 1", 0, true, 80), "   ^\n");
    CHECK_TEXT(caret("s> ", "seed 1,1,1 x", 11, true, 80), "              ^\n");
    CHECK_TEXT(caret("s> ", "seed 1,1,1", 11, true, 80), "              ^\n"); /* behind the end */
    CHECK_TEXT(caret("s> ", "seed 1,1,1", 99, true, 80), "              ^\n");
    CHECK_TEXT(caret("s> ", "\xe6\x9c\xac\xe6\x9c\xac x", 7, true, 80), "        ^\n"); /* wide */
    CHECK_TEXT(caret("s> ", "e\xcc\x81 x", 4, true, 80), "     ^\n"); /* a mark takes no column */
    CHECK_TEXT(caret("s> ", "\x01 x", 2, true, 80), "        ^\n");   /* drawn as \x01 */
}

STORY(a_line_that_did_not_fit_is_shown_around_the_word)
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
}

STORY(below_other_output_the_line_is_shown_again)
{
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

int main(void)
{
    return RUN_STORIES(TELL(the_caret_stands_under_the_first_column_of_the_word),
                       TELL(a_line_that_did_not_fit_is_shown_around_the_word),
                       TELL(below_other_output_the_line_is_shown_again),
                       TELL(in_hardly_any_columns_there_is_no_caret));
}
