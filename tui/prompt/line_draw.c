#include "tui/prompt/line_draw.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "base/safe.h"
#include "tui/cells.h"

/* Walks along cells, and writes those in rows first <= row < end. */
struct walk {
    size_t row;
    unsigned column, columns;
    size_t first, end;
    struct buf *out; /* NULL: only measure */
};

static void walk_cell(struct walk *w, const char *bytes, size_t length, unsigned width)
{
    if (w->column + width > w->columns) {
        w->row++;
        w->column = 0;
    }
    if (w->out && w->row >= w->first && w->row < w->end)
        buf_add(w->out, bytes, length);
    w->column += width;
}

/* Draws one character of text and returns its bytes. */
static size_t walk_character(struct walk *w, const char *text, size_t length)
{
    char hex[5];
    uint32_t point;
    size_t bytes = safe_character(text, length);
    if (bytes > 0) {
        char_read(text, length, &point);
        walk_cell(w, text, bytes, char_width(point));
        return bytes;
    }
    snprintf(hex, sizeof hex, "\\x%02x", (unsigned char)*text);
    for (unsigned i = 0; i < 4; i++)
        walk_cell(w, hex + i, 1, 1);
    return 1;
}

static void walk_text(struct walk *w, const char *text, size_t length)
{
    for (size_t i = 0; i < length;)
        i += walk_character(w, text + i, length - i);
}

/* A full row ends on the next one, as after the CR LF that line_draw writes. */
static void walk_wrap(struct walk *w)
{
    if (w->column < w->columns)
        return;
    if (w->out && w->row + 1 < w->end)
        buf_add_text(w->out, "\r\n");
    w->row++;
    w->column = 0;
}

/* Up to the first row of what stands there. After a change of width the terminal may have wrapped
 * it anew or not; the smaller number of rows never reaches up into older output. */
static void go_to_start(const struct line_drawing *d, unsigned columns, struct buf *out)
{
    size_t now = d->cells / columns;
    size_t up = now < d->row ? now : d->row;
    if (up > 0)
        buf_printf(out, "\033[%zuA", up);
    buf_add_text(out, "\r\033[J");
}

static void go_to_cursor(size_t up, unsigned column, struct buf *out)
{
    if (up > 0)
        buf_printf(out, "\033[%zuA", up);
    buf_add_char(out, '\r');
    if (column > 0)
        buf_printf(out, "\033[%uC", column);
}

/* As much of the hint as fits before the last column, where terminals wait with the wrap. */
static bool add_hint(const struct line_content *content, unsigned columns, unsigned column,
                     struct buf *out)
{
    const char *hint = content->hint;
    const size_t length = hint ? strlen(hint) : 0;
    struct walk w = {.columns = UINT32_MAX / 2, .column = column, .end = 1};
    size_t fits = 0;
    while (fits < length) {
        const size_t n = walk_character(&w, hint + fits, length - fits);
        if (w.column >= columns)
            break;
        fits += n;
    }
    if (fits == 0)
        return false;
    buf_add_text(out, content->grey);
    buf_add(out, hint, fits);
    buf_add_text(out, "\033[m");
    return true;
}

void line_draw(struct line_drawing *drawing, const struct line_content *content, unsigned columns,
               unsigned rows, struct buf *out)
{
    struct walk cursor = {.columns = columns}, all;
    walk_text(&cursor, content->prompt, strlen(content->prompt));
    walk_text(&cursor, content->text, content->cursor);
    all = cursor;
    walk_text(&all, content->text + content->cursor, content->length - content->cursor);
    walk_wrap(&all);
    walk_wrap(&cursor);

    size_t first = all.row + 1 > rows ? all.row + 1 - rows : 0;
    if (first > cursor.row)
        first = cursor.row;
    size_t last = all.row < first + rows - 1 ? all.row : first + rows - 1;

    go_to_start(drawing, columns, out);
    struct walk w = {.columns = columns, .first = first, .end = last + 1, .out = out};
    walk_text(&w, content->prompt, strlen(content->prompt));
    walk_text(&w, content->text, content->length);
    walk_wrap(&w);
    const bool hints = add_hint(content, columns, w.column, out);
    if (hints || w.row != cursor.row || w.column != cursor.column)
        go_to_cursor(last - cursor.row, cursor.column, out);
    drawing->row = (unsigned)(cursor.row - first);
    drawing->cells = (size_t)drawing->row * columns + cursor.column;
}
