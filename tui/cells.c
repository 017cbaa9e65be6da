/* SPDX-License-Identifier: MIT */
#include "tui/cells.h"

#include <locale.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <wchar.h>
#include <wctype.h>

#include "base/safe.h"

/* ---- characters ---- */

static locale_t utf8; /* (locale_t)0 if the system has none */

static void open_locale(void)
{
    utf8 = newlocale(LC_CTYPE_MASK, "C.UTF-8", (locale_t)0);
}

static bool has_locale(void)
{
    static pthread_once_t once = PTHREAD_ONCE_INIT;
    pthread_once(&once, open_locale);
    return utf8 != (locale_t)0;
}

unsigned char_width(uint32_t point)
{
    enum { FIRST_MARK = 0x300 };
    if (point < FIRST_MARK || !has_locale())
        return 1;
    const locale_t former = uselocale(utf8);
    const int width = wcwidth((wchar_t)point);
    uselocale(former);
    return width < 0 ? 1 : (unsigned)width; /* an unassigned code point has no width */
}

size_t char_read(const char *text, size_t length, uint32_t *point)
{
    const size_t n = utf8_read(text, length, point);
    if (n == 0)
        *point = CHAR_BROKEN;
    return n ? n : 1;
}

void char_erase(struct buf *text)
{
    do
        text->length--;
    while (text->length > 0 && (text->data[text->length] & 0xC0) == 0x80);
    text->data[text->length] = '\0';
}

uint32_t char_letter(uint32_t point, bool upper)
{
    if (!has_locale())
        return point;
    return (uint32_t)(upper ? towupper_l((wint_t)point, utf8) : towlower_l((wint_t)point, utf8));
}

size_t cells_width(const char *text, size_t length)
{
    size_t cells = 0;
    uint32_t point;
    for (size_t i = 0; i < length;) {
        const size_t bytes = safe_character(text + i, length - i);
        if (bytes)
            char_read(text + i, bytes, &point);
        cells += bytes ? char_width(point) : 4;
        i += bytes ? bytes : 1;
    }
    return cells;
}

bool locale_is_utf8(void)
{
    static const char *const name[] = {"LC_ALL", "LC_CTYPE", "LANG"};
    for (size_t i = 0; i < sizeof name / sizeof name[0]; i++) {
        const char *locale = getenv(name[i]);
        if (locale && *locale)
            return strcasestr(locale, "utf-8") || strcasestr(locale, "utf8");
    }
    return false;
}

/* ---- lines that fit ---- */

size_t cells_next(const char *text, size_t length, size_t *cells)
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

void cells_crop(struct buf *out, const char *text, unsigned columns)
{
    while (*text) {
        const size_t length = strcspn(text, "\n");
        size_t bytes = columns ? 0 : length, cells;
        for (size_t used = 0; bytes < length;) {
            const size_t n = cells_next(text + bytes, length - bytes, &cells);
            used += cells;
            if (used > columns)
                break;
            bytes += n;
        }
        buf_add(out, text, bytes);
        if (text[length] == '\n')
            buf_add_char(out, '\n');
        text += length + (text[length] == '\n');
    }
}

size_t cells_fit(const char *line, size_t length, size_t room)
{
    size_t at = strspn(line, " "), used = at, gap = 0, cells;
    while (at < length) {
        if (line[at] == ' ' && used > room)
            return at;
        if (line[at] == ' ' && line[at - 1] != ' ')
            gap = at;
        at += cells_next(line + at, length - at, &cells);
        used += cells;
        if (gap && used > room)
            return gap;
    }
    return length;
}

/* Return the column where the text of a line begins, if that is in its first half, else 0;
 * continuation lines begin there. */
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
    size_t n = cells_fit(line, length, columns);
    buf_add(out, line, n);
    while (n < length) {
        n += strspn(line + n, " ");
        if (n == length)
            return;
        line += n;
        length -= n;
        n = cells_fit(line, length, columns - column);
        buf_printf(out, "\r\n%*s", (int)column, "");
        buf_add(out, line, n);
    }
}

void cells_wrap(struct buf *out, const struct buf *text, unsigned columns)
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

/* ---- themes ---- */

const struct theme theme_dark = {"dark",       "\033[38;5;244m", "\033[90m", "\033[1;97;41m",
                                 "\033[1;36m", "\033[33m",       true};
static const struct theme theme_light = {
    "light", "\033[38;5;242m", "\033[90m", "\033[1;97;41m", "\033[1;34m", "\033[35m", true};
static const struct theme theme_none = {"none", "", "", "\033[7m", "", "", false};

const struct theme *theme_for(const struct theme *chosen, bool is_light)
{
    return chosen ? chosen : is_light ? &theme_light : &theme_dark;
}

const struct theme *theme_find(const char *name)
{
    static const struct theme *const all[] = {&theme_dark, &theme_light, &theme_none};
    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++)
        if (strcmp(all[i]->name, name) == 0)
            return all[i];
    return NULL;
}
