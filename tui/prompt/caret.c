#include "tui/prompt/caret.h"

#include <string.h>

#include "base/safe.h"
#include "tui/line_draw.h"

enum { COLUMNS_LEAST = 8 };

static const char cut[] = "...";
enum { CUT = sizeof cut - 1 };

static void add_caret(struct buf *out, size_t column, bool coloured)
{
    buf_printf(out, "%*s%s\n", (int)column, "", coloured ? "\033[31m^\033[m" : "^");
}

static size_t next(const char *text, size_t at, size_t length)
{
    const size_t n = safe_character(text + at, length - at);
    return at + (n ? n : 1);
}

/* Drops characters from the start until no more than `room` columns are before `at`. */
static size_t first_shown(const char *text, size_t at, size_t room)
{
    size_t first = 0;
    while (first < at && line_width(text + first, at - first) > room)
        first = next(text, first, at);
    return first;
}

/* The end of what fits into `room` columns, or of the text where it fits in place of the dots. */
static size_t end_shown(const char *text, size_t first, size_t length, size_t room)
{
    size_t end = first;
    if (line_width(text + first, length - first) <= room + CUT)
        return length;
    while (end < length) {
        const size_t then = next(text, end, length);
        if (line_width(text + first, then - first) > room)
            break;
        end = then;
    }
    return end;
}

/* The part of the line around the place, with the caret below it. */
static void add_excerpt(struct buf *out, const struct caret *caret, size_t at, size_t columns)
{
    const size_t length = strlen(caret->text), room = columns - 1 - 2 * CUT;
    const size_t first = first_shown(caret->text, at, room * 2 / 3);
    const size_t end = end_shown(caret->text, first, length, room);
    const size_t before = line_width(caret->text + first, at - first);
    buf_add_text(out, first > 0 ? cut : "");
    buf_add_safe(out, caret->text + first, end - first);
    buf_add_text(out, end < length ? cut : "");
    buf_add_char(out, '\n');
    add_caret(out, (first > 0 ? CUT : 0) + before, caret->coloured);
}

void caret_add(struct buf *out, const struct caret *caret, unsigned columns)
{
    const size_t length = strlen(caret->text), at = caret->at < length ? caret->at : length;
    const size_t prompt = line_width(caret->prompt, strlen(caret->prompt));
    const size_t behind = caret->at > length ? 1 : 0;
    const size_t column = prompt + line_width(caret->text, at) + behind;
    if (columns < COLUMNS_LEAST)
        return;
    if (caret->below && prompt + line_width(caret->text, length) < columns && column < columns)
        add_caret(out, column, caret->coloured);
    else
        add_excerpt(out, caret, at, columns);
}
