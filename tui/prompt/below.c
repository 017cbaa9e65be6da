#include "tui/prompt/below.h"

#include <string.h>

#include "base/safe.h"
#include "tui/cells.h"

/* ---- candidates ---- */

enum { GAP = 2, ROWS_LEFT = 3, MEANING_LEAST = 8 };

/* The next word, from *at on, which moves after it and its meaning; NULL at the end. */
static const char *take(const char **at, size_t *length)
{
    while (**at == '\n')
        ++*at;
    const char *word = *at;
    *length = strcspn(word, "\t\n");
    *at += strcspn(word, "\n");
    return *length ? word : NULL;
}

struct candidates candidates_of(const char *words)
{
    struct candidates c = {.words = words, .first = words};
    size_t length;
    for (const char *at = words, *word; (word = take(&at, &length));) {
        size_t same = 0;
        if (c.count++ == 0) {
            c.first = word;
            c.common = length;
        }
        while (same < c.common && same < length && word[same] == c.first[same])
            same++;
        c.common = same;
    }
    while (c.count > 1 && c.common > 0 && (c.first[c.common] & 0xC0) == 0x80)
        c.common--;
    return c;
}

/* What of a word is shown: not what leads to it. */
static void strip(const struct candidates *c, const char **word, size_t *length)
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
    for (const char *at = c->words, *word; (word = take(&at, &length));) {
        strip(c, &word, &length);
        const size_t width = cells_width(word, length);
        most = width > most ? width : most;
    }
    return most;
}

/* The word of this number, as it is shown. A list has no more of them than the screen has cells. */
static const char *find(const struct candidates *c, size_t number, size_t *length)
{
    const char *at = c->words, *word = take(&at, length);
    for (size_t i = 0; word && i < number; i++)
        word = take(&at, length);
    if (word)
        strip(c, &word, length);
    return word;
}

/* As much of a text as fits, in whole characters that are safe to print. */
static void add_cropped(struct buf *out, const char *text, size_t length, size_t columns)
{
    size_t end = 0, used = 0, bytes;
    while (end < length) {
        bytes = safe_character(text + end, length - end);
        bytes = bytes ? bytes : 1;
        used += cells_width(text + end, bytes);
        if (used > columns)
            break;
        end += bytes;
    }
    buf_add_safe(out, text, end);
}

/* Each word in a row, with its meaning. */
static void list_meanings(const struct candidates *c, size_t stride, unsigned columns,
                          struct buf *out)
{
    size_t length;
    for (const char *at = c->words, *word; (word = take(&at, &length));) {
        const char *meaning = word[length] == '\t' ? word + length + 1 : "";
        strip(c, &word, &length);
        buf_add_safe(out, word, length);
        if (*meaning && *meaning != '\n')
            buf_printf(out, "%*s", (int)(stride - cells_width(word, length)), "");
        add_cropped(out, meaning, strcspn(meaning, "\n"), columns - stride - 1);
        buf_add_text(out, "\r\n");
    }
}

void candidates_list(const struct candidates *c, unsigned columns, unsigned rows, struct buf *out)
{
    const size_t stride = widest(c) + GAP;
    const size_t across = columns / stride > 0 ? columns / stride : 1;
    const size_t most = rows > ROWS_LEFT + 1 ? rows - ROWS_LEFT : 1;
    size_t down = (c->count + across - 1) / across;
    if (strchr(c->words, '\t') && c->count <= most && stride + MEANING_LEAST < columns) {
        list_meanings(c, stride, columns, out);
        return;
    }
    const bool fits = down <= most;
    down = fits ? down : most - (most > 1);
    for (size_t row = 0; row < down; row++) {
        for (size_t column = 0; column < across && column * down + row < c->count; column++) {
            size_t length;
            const char *word = find(c, column * down + row, &length);
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

static size_t next(const char *text, size_t at, size_t length)
{
    const size_t n = safe_character(text + at, length - at);
    return at + (n ? n : 1);
}

/* Drops characters from the start until no more than `room` columns are before `at`. */
static size_t first_shown(const char *text, size_t at, size_t room)
{
    size_t first = 0;
    while (first < at && cells_width(text + first, at - first) > room)
        first = next(text, first, at);
    return first;
}

/* The end of what fits into `room` columns, or of the text where it fits in place of the dots. */
static size_t end_shown(const char *text, size_t first, size_t length, size_t room)
{
    size_t end = first;
    if (cells_width(text + first, length - first) <= room + CUT)
        return length;
    while (end < length) {
        const size_t then = next(text, end, length);
        if (cells_width(text + first, then - first) > room)
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
    const size_t before = cells_width(caret->text + first, at - first);
    buf_add_text(out, first > 0 ? cut : "");
    buf_add_safe(out, caret->text + first, end - first);
    buf_add_text(out, end < length ? cut : "");
    buf_add_char(out, '\n');
    add_caret(out, (first > 0 ? CUT : 0) + before, caret->coloured);
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
    else
        add_excerpt(out, caret, at, columns);
}
