#include "tui/prompt/line.h"

#include <stdint.h>
#include <string.h>

#include "tui/cells.h"

void line_init(struct line *l, const struct line_history *history)
{
    *l = (struct line){.history = history, .place = history->count};
}

void line_release(struct line *l)
{
    buf_release(&l->text);
    buf_release(&l->killed);
    buf_release(&l->draft);
    buf_release(&l->wanted);
}

void line_clear(struct line *l)
{
    bool failed = l->text.failed;
    buf_clear(&l->text);
    buf_clear(&l->draft);
    buf_clear(&l->wanted);
    l->text.failed = failed;
    l->cursor = 0;
    l->killing = l->searching = l->search_failed = false;
    l->place = l->history->count;
}

/* ---- where characters and words are ---- */

static uint32_t point_at(const struct line *l, size_t at, size_t *bytes)
{
    uint32_t point;
    *bytes = char_read(l->text.data + at, l->text.length - at, &point);
    return point;
}

/* The end of the character at `at` with the marks upon it. */
static size_t next(const struct line *l, size_t at)
{
    size_t bytes;
    if (at >= l->text.length)
        return l->text.length;
    point_at(l, at, &bytes);
    at += bytes;
    while (at < l->text.length && char_width(point_at(l, at, &bytes)) == 0)
        at += bytes;
    return at;
}

static size_t previous(const struct line *l, size_t at)
{
    size_t bytes = 1;
    while (at > 0) {
        size_t end = at--;
        while (at > 0 && end - at < 4 && (l->text.data[at] & 0xC0) == 0x80)
            at--;
        uint32_t point = point_at(l, at, &bytes);
        if (at + bytes != end) { /* a broken sequence goes byte by byte */
            at = end - 1;
            break;
        }
        if (point == CHAR_BROKEN || char_width(point) > 0)
            break;
    }
    return at;
}

static bool is_word(const struct line *l, size_t at)
{
    unsigned char c = (unsigned char)l->text.data[at];
    return c >= 0x80 || (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') ||
           (c >= 'A' && c <= 'Z') || c == '_';
}

static size_t word_left(const struct line *l, size_t at)
{
    while (at > 0 && !is_word(l, at - 1))
        at--;
    while (at > 0 && is_word(l, at - 1))
        at--;
    return at;
}

static size_t word_right(const struct line *l, size_t at)
{
    while (at < l->text.length && !is_word(l, at))
        at++;
    while (at < l->text.length && is_word(l, at))
        at++;
    return at;
}

static size_t blank_left(const struct line *l, size_t at)
{
    while (at > 0 && l->text.data[at - 1] == ' ')
        at--;
    while (at > 0 && l->text.data[at - 1] != ' ')
        at--;
    return at;
}

static size_t start(const struct line *l, size_t at)
{
    (void)l;
    (void)at;
    return 0;
}

static size_t end(const struct line *l, size_t at)
{
    (void)at;
    return l->text.length;
}

/* ---- edits ---- */

void line_replace(struct line *l, size_t from, size_t to, const char *bytes, size_t length)
{
    size_t rest = l->text.length - to;
    if (length > to - from && !buf_reserve(&l->text, length - (to - from)))
        return;
    if (!l->text.data)
        return;
    memmove(l->text.data + from + length, l->text.data + to, rest);
    if (length > 0)
        memcpy(l->text.data + from, bytes, length);
    l->text.length = from + length + rest;
    l->text.data[l->text.length] = '\0';
    l->cursor = from + length;
}

void line_insert(struct line *l, const char *bytes, size_t length)
{
    l->killing = false;
    line_replace(l, l->cursor, l->cursor, bytes, length);
}

static void remove_range(struct line *l, size_t from, size_t to)
{
    if (from < to)
        line_replace(l, from, to, "", 0);
}

/* Removes a range and adds it to the kill buffer, before what the last kill put there when it lies
 * before the cursor, after it otherwise. */
static void kill_range(struct line *l, size_t from, size_t to, bool join)
{
    struct buf kept = {0};
    bool before = from < l->cursor;
    if (from >= to)
        return;
    if (join && !before)
        buf_add(&kept, l->killed.data, l->killed.length);
    buf_add(&kept, l->text.data + from, to - from);
    if (join && before)
        buf_add(&kept, l->killed.data, l->killed.length);
    if (!kept.failed) {
        buf_release(&l->killed);
        l->killed = kept;
    } else {
        buf_release(&kept);
    }
    remove_range(l, from, to);
}

static void transpose(struct line *l)
{
    size_t middle = l->cursor;
    if (middle == l->text.length)
        middle = previous(l, middle);
    size_t from = previous(l, middle), to = next(l, middle);
    struct buf swapped = {0};
    if (from == middle || middle == to)
        return;
    buf_add(&swapped, l->text.data + middle, to - middle);
    buf_add(&swapped, l->text.data + from, middle - from);
    if (!swapped.failed)
        line_replace(l, from, to, swapped.data, swapped.length);
    buf_release(&swapped);
}

/* ---- history ---- */

static void set_text(struct line *l, const char *text, size_t length)
{
    line_replace(l, 0, l->text.length, text, length);
}

static void copy_buf(struct buf *to, const struct buf *from)
{
    buf_clear(to);
    buf_add(to, buf_text(from), from->length);
}

/* Shows entry `place`; the line of today waits in the draft meanwhile. */
static void show_entry(struct line *l, size_t place)
{
    if (place == l->place || place > l->history->count)
        return;
    if (l->place == l->history->count)
        copy_buf(&l->draft, &l->text);
    l->place = place;
    if (place == l->history->count)
        set_text(l, buf_text(&l->draft), l->draft.length);
    else
        set_text(l, l->history->line[place], strlen(l->history->line[place]));
}

/* Where an action leads the cursor, or up to where it takes text away. */
static size_t (*const target_of[])(const struct line *, size_t) = {
    [LINE_LEFT] = previous,
    [LINE_RIGHT] = next,
    [LINE_WORD_LEFT] = word_left,
    [LINE_WORD_RIGHT] = word_right,
    [LINE_HOME] = start,
    [LINE_END] = end,
    [LINE_ERASE] = previous,
    [LINE_DELETE] = next,
    [LINE_KILL_TO_END] = end,
    [LINE_KILL_TO_START] = start,
    [LINE_KILL_BLANK_LEFT] = blank_left,
    [LINE_KILL_WORD_LEFT] = word_left,
    [LINE_KILL_WORD_RIGHT] = word_right,
};

void line_act(struct line *l, enum line_action action)
{
    const size_t at = l->cursor, newest = l->history->count;
    const size_t to = action <= LINE_KILL_WORD_RIGHT ? target_of[action](l, at) : at;
    const size_t low = to < at ? to : at, high = to < at ? at : to;
    const bool join = l->killing;
    l->killing = action >= LINE_KILL_TO_END && action <= LINE_KILL_WORD_RIGHT;
    if (action <= LINE_END)
        l->cursor = to;
    else if (action <= LINE_DELETE)
        remove_range(l, low, high);
    else if (action <= LINE_KILL_WORD_RIGHT)
        kill_range(l, low, high, join);
    else if (action == LINE_YANK)
        line_insert(l, buf_text(&l->killed), l->killed.length);
    else if (action == LINE_TRANSPOSE)
        transpose(l);
    else if (action == LINE_OLDER)
        show_entry(l, l->place > 0 ? l->place - 1 : 0);
    else
        show_entry(l, action == LINE_NEWER ? l->place + 1 : action == LINE_OLDEST ? 0 : newest);
}

/* ---- search ---- */

/* Looks for the wanted text from entry `place` on towards the oldest. */
static void search_from(struct line *l, size_t place)
{
    const char *wanted = buf_text(&l->wanted);
    for (size_t i = place + 1; i-- > 0;) {
        const char *found = i < l->history->count ? strstr(l->history->line[i], wanted) : NULL;
        if (found) {
            show_entry(l, i);
            l->cursor = (size_t)(found - l->history->line[i]);
            l->search_failed = false;
            return;
        }
    }
    l->search_failed = true;
}

void line_search_begin(struct line *l)
{
    l->killing = false;
    l->searching = true;
    l->search_failed = false;
    buf_clear(&l->wanted);
}

void line_search_add(struct line *l, const char *bytes, size_t length)
{
    buf_add(&l->wanted, bytes, length);
    search_from(l, l->place);
}

/* A shorter text matches wherever the longer one did, or later; begin at the newest again. */
void line_search_erase(struct line *l)
{
    size_t length = l->wanted.length;
    if (length == 0)
        return;
    do
        length--;
    while (length > 0 && (l->wanted.data[length] & 0xC0) == 0x80);
    l->wanted.length = length;
    l->wanted.data[length] = '\0';
    l->search_failed = false;
    if (length > 0)
        search_from(l, l->history->count);
}

void line_search_again(struct line *l)
{
    if (l->wanted.length > 0 && l->place > 0)
        search_from(l, l->place - 1);
    else
        l->search_failed = l->wanted.length > 0;
}

void line_search_end(struct line *l, bool keep)
{
    l->searching = l->search_failed = false;
    if (!keep)
        show_entry(l, l->history->count);
}
