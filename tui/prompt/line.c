#include "tui/prompt/line.h"

#include <stdint.h>
#include <string.h>

#include "tui/cells.h"
#include "tui/prompt/line_recall.h"

void line_init(struct line *l, const struct line_history *history)
{
    *l = (struct line){.history = history, .place = history->count};
}

void line_release(struct line *l)
{
    buf_release(&l->text);
    line_undo_release(&l->undo);
    buf_release(&l->killed);
    buf_release(&l->draft);
    buf_release(&l->prefix);
    buf_release(&l->wanted);
}

void line_clear(struct line *l)
{
    bool failed = l->text.failed;
    buf_clear(&l->text);
    buf_clear(&l->draft);
    buf_clear(&l->wanted);
    l->text.failed = failed;
    line_undo_clear(&l->undo);
    l->cursor = 0;
    l->last = LAST_OTHER;
    l->searching = l->search_failed = false;
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
size_t line_next(const struct line *l, size_t at)
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

size_t line_word_right(const struct line *l, size_t at)
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

void line_change(struct line *l, size_t from, size_t to, const char *bytes, size_t length,
                 enum line_step step)
{
    const size_t rest = l->text.length - to;
    const struct line_change change = {from, to - from, length, l->cursor};
    if (length > to - from && !buf_reserve(&l->text, length - (to - from)))
        return;
    if (!l->text.data || (from == to && length == 0))
        return;
    line_undo_note(&l->undo, &change, l->text.data + from, step);
    memmove(l->text.data + from + length, l->text.data + to, rest);
    if (length > 0)
        memcpy(l->text.data + from, bytes, length);
    l->text.length = from + length + rest;
    l->text.data[l->text.length] = '\0';
    l->cursor = from + length;
}

void line_replace(struct line *l, size_t from, size_t to, const char *bytes, size_t length)
{
    l->last = LAST_OTHER;
    line_change(l, from, to, bytes, length, STEP_NEW);
}

static void insert(struct line *l, const char *bytes, size_t length, bool joins)
{
    joins &= l->last == LAST_TYPED;
    l->last = LAST_TYPED;
    line_change(l, l->cursor, l->cursor, bytes, length, joins ? STEP_TYPED : STEP_NEW);
}

/* A word is a step, with the blanks after it. */
void line_insert(struct line *l, const char *bytes, size_t length)
{
    const bool begins_word =
        l->cursor > 0 && l->text.data[l->cursor - 1] == ' ' && length > 0 && bytes[0] != ' ';
    insert(l, bytes, length, !begins_word);
}

void line_paste(struct line *l, const char *bytes, size_t length)
{
    insert(l, bytes, length, true);
}

/* Once more is the same step. */
static void erase(struct line *l, size_t from, size_t to, bool again)
{
    l->last = LAST_ERASED;
    line_change(l, from, to, "", 0, again ? STEP_ERASED : STEP_NEW);
}

static void undo(struct line *l)
{
    struct line_change change;
    const char *removed;
    if (!line_undo_take(&l->undo, &change, &removed))
        return;
    struct line_undo kept = l->undo; /* what is taken back is no step */
    l->undo = (struct line_undo){0};
    line_change(l, change.at, change.at + change.added, removed, change.removed, STEP_NEW);
    line_undo_release(&l->undo);
    l->undo = kept;
    l->cursor = change.cursor;
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
    line_change(l, from, to, "", 0, STEP_NEW);
}

static void transpose(struct line *l)
{
    size_t middle = l->cursor;
    if (middle == l->text.length)
        middle = previous(l, middle);
    size_t from = previous(l, middle), to = line_next(l, middle);
    struct buf swapped = {0};
    if (from == middle || middle == to)
        return;
    buf_add(&swapped, l->text.data + middle, to - middle);
    buf_add(&swapped, l->text.data + from, middle - from);
    if (!swapped.failed)
        line_change(l, from, to, swapped.data, swapped.length, STEP_NEW);
    buf_release(&swapped);
}

/* Other letters up to the end of the word; a letter that has no other stays. */
static void change_letters(struct line *l, enum line_action action)
{
    const size_t end = line_word_right(l, l->cursor);
    struct buf changed = {0};
    bool is_first = true;
    for (size_t at = l->cursor, bytes; at < end; at += bytes) {
        char letter[CHAR_BYTES_MOST];
        const uint32_t point = point_at(l, at, &bytes);
        const bool upper = action == LINE_UPPER || (action == LINE_CAPITAL && is_first);
        if (point == CHAR_BROKEN)
            buf_add(&changed, l->text.data + at, bytes);
        else
            buf_add(&changed, letter, char_write(letter, char_letter(point, upper)));
        is_first &= !is_word(l, at);
    }
    if (!changed.failed)
        line_change(l, l->cursor, end, buf_text(&changed), changed.length, STEP_NEW);
    buf_release(&changed);
}

/* Where an action leads the cursor, or up to where it takes text away. */
static size_t (*const target_of[])(const struct line *, size_t) = {
    [LINE_LEFT] = previous,
    [LINE_RIGHT] = line_next,
    [LINE_WORD_LEFT] = word_left,
    [LINE_WORD_RIGHT] = line_word_right,
    [LINE_HOME] = start,
    [LINE_END] = end,
    [LINE_ERASE] = previous,
    [LINE_DELETE] = line_next,
    [LINE_KILL_TO_END] = end,
    [LINE_KILL_TO_START] = start,
    [LINE_KILL_BLANK_LEFT] = blank_left,
    [LINE_KILL_WORD_LEFT] = word_left,
    [LINE_KILL_WORD_RIGHT] = line_word_right,
};

/* What changes the text or the cursor by where an action leads. */
static void move(struct line *l, enum line_action action, enum line_last before)
{
    const size_t at = l->cursor, to = target_of[action](l, at);
    const size_t low = to < at ? to : at, high = to < at ? at : to;
    if (action <= LINE_END) {
        l->cursor = to;
    } else if (action <= LINE_DELETE) {
        erase(l, low, high, before == LAST_ERASED);
    } else {
        l->last = LAST_KILLED;
        kill_range(l, low, high, before == LAST_KILLED);
    }
}

void line_act(struct line *l, enum line_action action)
{
    const enum line_last before = l->last;
    l->last = LAST_OTHER;
    if (action <= LINE_KILL_WORD_RIGHT)
        move(l, action, before);
    else if (action <= LINE_CAPITAL)
        change_letters(l, action);
    else if (action == LINE_YANK)
        line_change(l, l->cursor, l->cursor, buf_text(&l->killed), l->killed.length, STEP_NEW);
    else if (action == LINE_TRANSPOSE)
        transpose(l);
    else if (action == LINE_UNDO)
        undo(l);
    else
        line_recall(l, action, before);
}
