#include "tui/prompt/wrap.h"

#include <string.h>

#include "tui/char_width.h"

/* The bytes and cells of the character, or colour, at `text`. */
static size_t read_one(const char *text, size_t length, size_t *cells)
{
    uint32_t point;
    const char *end = *text == '\033' ? memchr(text, 'm', length) : NULL;
    *cells = 0;
    if (end)
        return (size_t)(end - text) + 1;
    const size_t bytes = char_read(text, length, &point);
    *cells = point == CHAR_BROKEN ? 1 : char_width(point);
    return bytes;
}

/* How many bytes of the line to print in so many cells: up to a blank, or its end. */
static size_t fitting(const char *line, size_t length, size_t room)
{
    size_t at = strspn(line, " "), used = at, gap = 0, cells;
    while (at < length) {
        if (line[at] == ' ' && used > room)
            return at;
        if (line[at] == ' ' && line[at - 1] != ' ')
            gap = at;
        at += read_one(line + at, length - at, &cells);
        used += cells;
        if (gap && used > room)
            return gap;
    }
    return length;
}

/* Where a line's text begins, if that is in its first half: there it goes on. */
static size_t text_column(const char *line, size_t length, size_t columns)
{
    for (size_t at = 0; at + 1 < length && at < columns / 2; at++)
        if (line[at] == ' ' && line[at + 1] == ' ') {
            at += strspn(line + at, " ");
            return at < columns / 2 ? at : 0;
        }
    return 0;
}

static void wrap_line(struct buf *out, const char *line, size_t length, size_t columns)
{
    const size_t column = text_column(line, length, columns);
    size_t n = fitting(line, length, columns);
    buf_add(out, line, n);
    while (n < length) {
        n += strspn(line + n, " ");
        if (n == length)
            return;
        line += n;
        length -= n;
        n = fitting(line, length, columns - column);
        buf_printf(out, "\r\n%*s", (int)column, "");
        buf_add(out, line, n);
    }
}

void wrap_text(struct buf *out, const struct buf *text, unsigned columns)
{
    const char *at = buf_text(text), *end = at + text->length;
    while (at < end) {
        const char *feed = memchr(at, '\n', (size_t)(end - at));
        const char *stop = feed ? feed : end;
        wrap_line(out, at, (size_t)(stop - at), columns);
        if (feed)
            buf_add_text(out, "\r\n");
        at = stop + (feed ? 1 : 0);
    }
    out->failed |= text->failed;
}
