/* SPDX-License-Identifier: MIT */
#include "tui/prompt/line_edit.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "base/safe.h"
#include "tui/cells.h"

/* A position that moves along cells, and writes those in rows first <= row < end. */
struct walk {
    size_t row;
    unsigned column, columns;
    size_t first, end;
    struct buf *out; /* NULL: measure only */
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

/* Draw one character of text and return its bytes. */
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

/* A full row continues on the next one, as after the CR LF that line_draw writes. */
static void walk_wrap(struct walk *w)
{
    if (w->column < w->columns)
        return;
    if (w->out && w->row + 1 < w->end)
        buf_add_text(w->out, "\r\n");
    w->row++;
    w->column = 0;
}

/* Add as much of the hint as fits before the last column, where terminals delay the wrap. */
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

    /* Move up to the first row of the drawing. After a change of width the terminal may have
     * wrapped it again or not; the smaller number of rows never reaches into older output. */
    const size_t now = drawing->cells / columns;
    const size_t up = now < drawing->row ? now : drawing->row;
    if (up > 0)
        buf_printf(out, "\033[%zuA", up);
    buf_add_text(out, "\r\033[J");
    struct walk w = {.columns = columns, .first = first, .end = last + 1, .out = out};
    walk_text(&w, content->prompt, strlen(content->prompt));
    walk_text(&w, content->text, content->length);
    walk_wrap(&w);
    const bool hints = add_hint(content, columns, w.column, out);
    size_t below = 0; /* lines, limited by the rows left */
    for (const char *at = content->below ? content->below : "";
         *at && below < rows - (last - first + 1); below++) {
        const size_t length = strcspn(at, "\n");
        buf_add_text(out, "\r\n");
        buf_add(out, at, length);
        at += length + (at[length] == '\n');
    }
    if (hints || below || w.row != cursor.row || w.column != cursor.column) {
        if (last + below > cursor.row)
            buf_printf(out, "\033[%zuA", last + below - cursor.row);
        buf_add_char(out, '\r');
        if (cursor.column > 0)
            buf_printf(out, "\033[%uC", cursor.column);
    }
    drawing->row = (unsigned)(cursor.row - first);
    drawing->cells = (size_t)drawing->row * columns + cursor.column;
}

/* ---- candidates ---- */

enum { GAP = 2, ROWS_LEFT = 3, MEANING_LEAST = 8, NOTE_WIDE = 11 };

/* Return the next word from *at on, and move *at past it and its meaning; NULL at the end. */
static const char *take_word(const char **at, size_t *length)
{
    while (**at == '\n' || **at == '\t')
        *at += **at == '\n' ? 1 : strcspn(*at, "\n");
    const char *word = *at;
    *length = strcspn(word, "\t\n");
    *at += strcspn(word, "\n");
    return *length ? word : NULL;
}

struct candidates candidates_of(const char *words)
{
    struct candidates c = {.words = words, .first = words};
    size_t length;
    for (const char *at = words, *word; (word = take_word(&at, &length));) {
        size_t same = 0;
        if (c.count++ == 0) {
            c.first = word;
            c.common = length;
        }
        while (same < c.common && same < length && word[same] == c.first[same])
            same++;
        c.common = same;
    }
    for (const char *at = words; *at; at += strcspn(at, "\n"), at += *at == '\n')
        c.notes += *at == '\t';
    while (c.count > 1 && c.common > 0 && (c.first[c.common] & 0xC0) == 0x80)
        c.common--;
    return c;
}

/* Remove the common path and the quotes from a word. */
static void strip_word(const struct candidates *c, const char **word, size_t *length)
{
    const bool quoted = c->first[0] == '"';
    size_t skip = quoted;
    for (size_t i = 0; i < c->common && i + 1 < *length; i++)
        if (c->first[i] == '/')
            skip = i + 1;
    if (skip >= *length)
        skip = 0;
    *word += skip;
    *length -= skip;
    if (quoted && *length > 1 && (*word)[*length - 1] == '"')
        --*length;
}

static size_t widest(const struct candidates *c)
{
    size_t most = 0, length;
    for (const char *at = c->words, *word; (word = take_word(&at, &length));) {
        strip_word(c, &word, &length);
        const size_t width = cells_width(word, length);
        most = width > most ? width : most;
    }
    return most;
}

/* Return word `number`, as shown. No list has more words than the screen has cells. */
static const char *find_word(const struct candidates *c, size_t number, size_t *length)
{
    const char *at = c->words, *word = take_word(&at, length);
    for (size_t i = 0; word && i < number; i++)
        word = take_word(&at, length);
    if (word)
        strip_word(c, &word, length);
    return word;
}

static size_t next(const char *text, size_t at, size_t length)
{
    const size_t n = safe_character(text + at, length - at);
    return at + (n ? n : 1);
}

/* Return the end of the whole characters that fit, drawn safely. */
static size_t end_of_fitting(const char *text, size_t length, size_t columns)
{
    size_t end = 0, used = 0;
    while (end < length) {
        const size_t then = next(text, end, length);
        used += cells_width(text + end, then - end);
        if (used > columns)
            break;
        end = then;
    }
    return end;
}

/* A row of a list: a word, then the text up to its line feed, cropped to fit. */
static void list_row(const char *word, size_t length, const char *text, size_t stride,
                     unsigned columns, struct buf *out)
{
    const size_t width = cells_width(word, length), bytes = strcspn(text, "\n");
    buf_add_safe(out, word, length);
    if (bytes > 0)
        buf_printf(out, "%*s", (int)(stride > width ? stride - width : 1), "");
    buf_add_safe(out, text, end_of_fitting(text, bytes, columns - stride - 1));
    buf_add_text(out, "\r\n");
}

/* Each word in a row with its meaning, and the notes below. */
static void list_meanings(const struct candidates *c, size_t stride, unsigned columns,
                          struct buf *out)
{
    size_t length;
    for (const char *at = c->words, *word; (word = take_word(&at, &length));) {
        const char *meaning = word[length] == '\t' ? word + length + 1 : "";
        strip_word(c, &word, &length);
        list_row(word, length, meaning, stride, columns, out);
    }
    for (const char *at = c->words; *at; at += strcspn(at, "\n"), at += *at == '\n') {
        if (*at != '\t')
            continue;
        const char *said = at + 1 + strcspn(at + 1, "\t\n");
        list_row(at + 1, (size_t)(said - at - 1), said + (*said == '\t'), stride, columns, out);
    }
}

void candidates_list(const struct candidates *c, unsigned columns, unsigned rows, struct buf *out)
{
    const size_t wide = widest(c), stride = (wide < NOTE_WIDE && c->notes ? NOTE_WIDE : wide) + GAP;
    const size_t across = columns / stride > 0 ? columns / stride : 1;
    const size_t most = rows > ROWS_LEFT + 1 ? rows - ROWS_LEFT : 1;
    size_t down = (c->count + across - 1) / across;
    if (strchr(c->words, '\t') && c->count + c->notes <= most && stride + MEANING_LEAST < columns) {
        list_meanings(c, stride, columns, out);
        return;
    }
    const bool fits = down <= most;
    down = fits ? down : most - (most > 1);
    for (size_t row = 0; row < down; row++) {
        for (size_t column = 0; column < across && column * down + row < c->count; column++) {
            size_t length;
            const char *word = find_word(c, column * down + row, &length);
            if (!word)
                break;
            buf_add_safe(out, word, length);
            if (column + 1 < across && (column + 1) * down + row < c->count)
                for (size_t w = cells_width(word, length); w < stride; w++)
                    buf_add_char(out, ' ');
        }
        buf_add_text(out, "\r\n");
    }
    if (!fits)
        buf_printf(out, "and %zu more\r\n", c->count - down * across);
}

/* ---- the caret ---- */

enum { COLUMNS_LEAST = 8 };

static const char cut[] = "...";
enum { CUT = sizeof cut - 1 };

static void add_caret(struct buf *out, size_t column, bool coloured)
{
    buf_printf(out, "%*s%s\n", (int)column, "", coloured ? "\033[31m^\033[m" : "^");
}

void caret_add(struct buf *out, const struct caret *caret, unsigned columns)
{
    const size_t length = strlen(caret->text), at = caret->at < length ? caret->at : length;
    const size_t prompt = cells_width(caret->prompt, strlen(caret->prompt));
    const size_t after = caret->at > length ? 1 : 0;
    const size_t column = prompt + cells_width(caret->text, at) + after;
    if (columns < COLUMNS_LEAST)
        return;
    if (caret->below && prompt + cells_width(caret->text, length) < columns && column < columns)
        add_caret(out, column, caret->coloured);
    else {
        const size_t room = columns - 1 - 2 * CUT;
        /* Show at most two thirds of the columns before the marked place. */
        size_t first = 0;
        while (first < at && cells_width(caret->text + first, at - first) > room * 2 / 3)
            first = next(caret->text, first, at);
        const char *shown = caret->text + first;
        const bool fits = cells_width(shown, length - first) <= room + CUT; /* without the dots */
        const size_t end = fits ? length : first + end_of_fitting(shown, length - first, room);
        const size_t before = cells_width(shown, at - first);
        buf_add_text(out, first > 0 ? cut : "");
        buf_add_safe(out, shown, end - first);
        buf_add_text(out, end < length ? cut : "");
        buf_add_char(out, '\n');
        add_caret(out, (first > 0 ? CUT : 0) + before, caret->coloured);
    }
}
