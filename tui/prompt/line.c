/* SPDX-License-Identifier: MIT */
#include "tui/prompt/line.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "base/safe.h"
#include "tui/cells.h"

/* ---- undo ---- */

/* Join a change to the last step, if it fits that, or begin a new step. */
enum line_step {
    STEP_NEW,
    STEP_TYPED,  /* added where the last addition ended */
    STEP_ERASED, /* removed right before or right after the last removal */
    STEP_OVER    /* in place of everything that the last step added */
};

static void line_undo_release(struct line_undo *u)
{
    free(u->change);
    buf_release(&u->removed);
    *u = (struct line_undo){0};
}

/* Insert bytes before the last `tail` bytes of the stored ones. */
static void store_removed(struct line_undo *u, size_t tail, const char *bytes, size_t length)
{
    char *end = buf_reserve(&u->removed, length);
    if (!end)
        return;
    memmove(end - tail + length, end - tail, tail);
    memcpy(end - tail, bytes, length);
    u->removed.length += length;
    u->removed.data[u->removed.length] = '\0';
}

/* Make the change a part of the last step; return false if it is not adjacent to it. */
static bool join_step(struct line_undo *u, const struct line_change *c, const char *removed,
                      enum line_step step)
{
    struct line_change *last = u->count ? &u->change[u->count - 1] : NULL;
    if (step == STEP_NEW || !last)
        return false;
    if (step == STEP_TYPED && c->removed == 0 && c->at == last->at + last->added) {
        last->added += c->added;
    } else if (step == STEP_OVER && c->at == last->at && c->removed == last->added) {
        last->added = c->added;
    } else if (step == STEP_ERASED && c->added + last->added == 0 &&
               (c->at == last->at || c->at + c->removed == last->at)) {
        store_removed(u, c->at == last->at ? 0 : last->removed, removed, c->removed);
        last->removed += c->removed;
        last->at = c->at;
    } else {
        return false;
    }
    return true;
}

static void line_undo_note(struct line_undo *u, const struct line_change *change,
                           const char *removed, enum line_step step)
{
    if (!join_step(u, change, removed, step)) {
        if (!mem_grow(&u->change, &u->capacity, u->count + 1, sizeof *u->change)) {
            line_undo_release(u);
            return;
        }
        u->change[u->count++] = *change;
        if (change->removed > 0)
            store_removed(u, 0, removed, change->removed);
    }
    if (u->removed.failed)
        line_undo_release(u);
    while (u->count > LINE_UNDO_MOST || u->removed.length > LINE_UNDO_BYTES) {
        const size_t oldest = u->change[0].removed; /* bytes */
        memmove(u->change, u->change + 1, --u->count * sizeof *u->change);
        u->removed.length -= oldest;
        if (oldest > 0)
            memmove(u->removed.data, u->removed.data + oldest, u->removed.length + 1);
    }
}

/* ---- the line ---- */

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
    line_undo_release(&l->undo);
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

/* Return the end of the character at `at`, with its combining marks. */
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
        if (at + bytes != end) { /* an invalid sequence counts byte by byte */
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

static size_t end(const struct line *l, size_t at)
{
    (void)at;
    return l->text.length;
}

/* ---- edits ---- */

/* All changes except line_clear are made here. */
static void change_text(struct line *l, size_t from, size_t to, const char *bytes, size_t length,
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
    change_text(l, from, to, bytes, length, STEP_NEW);
}

static void insert(struct line *l, const char *bytes, size_t length, bool joins)
{
    joins &= l->last == LAST_TYPED;
    l->last = LAST_TYPED;
    change_text(l, l->cursor, l->cursor, bytes, length, joins ? STEP_TYPED : STEP_NEW);
}

/* A word, with the blanks after it, is one undo step. */
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

static void undo(struct line *l)
{
    if (l->undo.count == 0)
        return;
    struct line_undo kept = l->undo; /* undoing a step must not store another step */
    const struct line_change change = kept.change[--kept.count];
    kept.removed.length -= change.removed;
    const char *removed = buf_text(&kept.removed) + kept.removed.length;
    l->undo = (struct line_undo){0};
    change_text(l, change.at, change.at + change.added, removed, change.removed, STEP_NEW);
    line_undo_release(&l->undo);
    l->undo = kept;
    l->cursor = change.cursor;
}

/* Remove a range and add it to the kill buffer: before the last kill if the range is before the
 * cursor, after it otherwise. */
static void kill_range(struct line *l, size_t from, size_t to, bool extends)
{
    OWNED(buf_release) struct buf kept = {0};
    bool before = from < l->cursor;
    if (from >= to)
        return;
    if (extends && !before)
        buf_add(&kept, l->killed.data, l->killed.length);
    buf_add(&kept, l->text.data + from, to - from);
    if (extends && before)
        buf_add(&kept, l->killed.data, l->killed.length);
    if (!kept.failed) { /* exchange the two */
        const struct buf former = l->killed;
        l->killed = kept;
        kept = former;
    }
    change_text(l, from, to, "", 0, STEP_NEW);
}

static void transpose(struct line *l)
{
    size_t middle = l->cursor;
    if (middle == l->text.length)
        middle = previous(l, middle);
    size_t from = previous(l, middle), to = next(l, middle);
    OWNED(buf_release) struct buf swapped = {0};
    if (from == middle || middle == to)
        return;
    buf_add(&swapped, l->text.data + middle, to - middle);
    buf_add(&swapped, l->text.data + from, middle - from);
    if (!swapped.failed)
        change_text(l, from, to, swapped.data, swapped.length, STEP_NEW);
}

/* Change the case up to the end of the word; other characters stay as they are. */
static void change_letters(struct line *l, enum line_action action)
{
    const size_t end = word_right(l, l->cursor);
    OWNED(buf_release) struct buf changed = {0};
    bool is_first = true;
    for (size_t at = l->cursor, bytes; at < end; at += bytes) {
        char letter[UTF8_BYTES_MOST];
        const uint32_t point = point_at(l, at, &bytes);
        const bool upper = action == LINE_UPPER || (action == LINE_CAPITAL && is_first);
        if (point == CHAR_BROKEN)
            buf_add(&changed, l->text.data + at, bytes);
        else
            buf_add(&changed, letter, utf8_write(letter, char_letter(point, upper)));
        is_first &= !is_word(l, at);
    }
    if (!changed.failed)
        change_text(l, l->cursor, end, buf_text(&changed), changed.length, STEP_NEW);
}

/* ---- one line after another ---- */

/* Show the history entry `place`; the current line is stored in the draft meanwhile. */
static void show_entry(struct line *l, size_t place, enum line_step step)
{
    if (place == l->place || place > l->history->count)
        return;
    if (l->place == l->history->count) {
        buf_clear(&l->draft);
        buf_add(&l->draft, buf_text(&l->text), l->text.length);
    }
    l->place = place;
    const char *text = place == l->history->count ? buf_text(&l->draft) : l->history->line[place];
    change_text(l, 0, l->text.length, text, strlen(text), step);
}

/* Consecutive browsed lines are one undo step. */
static enum line_step step_after(const struct line *l, enum line_last before)
{
    return before == LAST_RECALLED && l->place < l->history->count ? STEP_OVER : STEP_NEW;
}

static bool is_entry(const struct line *l, size_t place)
{
    return strcmp(l->history->line[place], buf_text(&l->text)) == 0;
}

/* A history entry that was edited becomes the current line. */
static void leave_edited_entry(struct line *l)
{
    if (l->place < l->history->count && !is_entry(l, l->place))
        l->place = l->history->count;
}

static bool is_wanted(const struct line *l, size_t place)
{
    return strncmp(l->history->line[place], buf_text(&l->prefix), l->prefix.length) == 0 &&
           !is_entry(l, place);
}

/* ---- last words ---- */

/* Return the last word of a line, with its quotes. */
static const char *last_word(const char *line, size_t *length)
{
    const char *word = line;
    bool quoted = false, blank = true;
    *length = 0;
    for (const char *at = line; *at; at++) {
        if (blank && *at != ' ')
            word = at;
        blank = *at == ' ' && !quoted;
        if (quoted && *at == '\\' && at[1])
            at++;
        else if (*at == '"')
            quoted = !quoted;
        if (!blank)
            *length = (size_t)(at + 1 - word);
    }
    return word;
}

static void insert_last_word(struct line *l, bool again)
{
    size_t place = again ? l->word_entry : l->history->count, length;
    if (place == 0)
        return;
    const char *word = last_word(l->history->line[--place], &length);
    l->word_entry = place;
    l->word_at = again ? l->word_at : l->cursor;
    change_text(l, l->word_at, l->cursor, word, length, again ? STEP_OVER : STEP_NEW);
}

/* Do LINE_OLDER or an action after it in the enum; `before` is the previous action. */
static void browse(struct line *l, enum line_action action, enum line_last before)
{
    const bool again = before == LAST_RECALLED;
    const enum line_step step = step_after(l, before);
    l->last = action == LINE_LAST_WORD ? LAST_CITED : LAST_RECALLED;
    if (action != LINE_LAST_WORD && !again) { /* set the prefix of the lines to browse */
        leave_edited_entry(l);
        buf_clear(&l->prefix);
        buf_add(&l->prefix, buf_text(&l->text), l->cursor);
    }
    size_t place = l->place;
    if (action == LINE_LAST_WORD) {
        insert_last_word(l, before == LAST_CITED);
    } else if (action == LINE_OLDER) {
        while (place > 0 && !is_wanted(l, place - 1))
            place--;
        show_entry(l, place > 0 ? place - 1 : l->place, step);
    } else if (action == LINE_NEWER) {
        do
            place++;
        while (place < l->history->count && !is_wanted(l, place));
        show_entry(l, place, step);
    } else {
        show_entry(l, action == LINE_OLDEST ? 0 : l->history->count, step);
    }
}

/* ---- actions ---- */

/* Target of an action: the new cursor, or the end of the range to remove. NULL: the start. */
static size_t (*const target_of[])(const struct line *, size_t) = {
    [LINE_LEFT] = previous,
    [LINE_RIGHT] = next,
    [LINE_WORD_LEFT] = word_left,
    [LINE_WORD_RIGHT] = word_right,
    [LINE_END] = end,
    [LINE_ERASE] = previous,
    [LINE_DELETE] = next,
    [LINE_KILL_TO_END] = end,
    [LINE_KILL_BLANK_LEFT] = blank_left,
    [LINE_KILL_WORD_LEFT] = word_left,
    [LINE_KILL_WORD_RIGHT] = word_right,
};

/* Actions that move the cursor or remove text up to a target. */
static void move(struct line *l, enum line_action action, enum line_last before)
{
    const size_t at = l->cursor, to = target_of[action] ? target_of[action](l, at) : 0;
    const size_t low = to < at ? to : at, high = to < at ? at : to;
    if (action <= LINE_END) {
        l->cursor = to;
    } else if (action <= LINE_DELETE) {
        /* A repeated action is part of the same undo step. */
        l->last = LAST_ERASED;
        change_text(l, low, high, "", 0, before == LAST_ERASED ? STEP_ERASED : STEP_NEW);
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
        change_text(l, l->cursor, l->cursor, buf_text(&l->killed), l->killed.length, STEP_NEW);
    else if (action == LINE_TRANSPOSE)
        transpose(l);
    else if (action == LINE_UNDO)
        undo(l);
    else
        browse(l, action, before);
}

/* ---- search ---- */

static void find_all(struct line *l)
{
    l->found_count = 0;
    for (size_t i = l->history->count; i-- > 0 && l->found_count < LINE_FOUND_MOST;) {
        const char *entry = l->history->line[i];
        bool is_found = strstr(entry, buf_text(&l->wanted)) != NULL;
        for (size_t k = 0; is_found && k < l->found_count; k++)
            is_found = strcmp(l->history->line[l->found[k]], entry) != 0;
        if (is_found)
            l->found[l->found_count++] = i;
    }
    l->chosen = l->found_count;
}

static void choose(struct line *l, size_t number)
{
    l->search_failed = number >= l->found_count;
    if (l->search_failed)
        return;
    const char *entry = l->history->line[l->found[number]];
    l->chosen = number;
    show_entry(l, l->found[number], step_after(l, l->last));
    l->cursor = (size_t)(strstr(entry, buf_text(&l->wanted)) - entry);
    l->last = LAST_RECALLED;
}

void line_search_begin(struct line *l)
{
    l->last = LAST_OTHER;
    l->searching = true;
    l->search_failed = false;
    buf_clear(&l->wanted);
    leave_edited_entry(l);
    find_all(l);
}

/* Keep the entry shown while it still matches; otherwise show the next older match. */
void line_search_add(struct line *l, const char *bytes, size_t length)
{
    size_t number = 0;
    buf_add(&l->wanted, bytes, length);
    find_all(l);
    while (number < l->found_count && l->found[number] > l->place)
        number++;
    choose(l, number < l->found_count ? number : 0);
}

/* A shorter text matches more lines: start again at the newest. */
void line_search_erase(struct line *l)
{
    if (l->wanted.length == 0)
        return;
    char_erase(&l->wanted);
    find_all(l);
    l->search_failed = false;
    if (l->wanted.length > 0)
        choose(l, 0);
}

void line_search_older(struct line *l)
{
    choose(l, l->chosen < l->found_count ? l->chosen + 1 : 0);
}

void line_search_newer(struct line *l)
{
    if (l->chosen > 0 && l->chosen < l->found_count)
        choose(l, l->chosen - 1);
}

void line_search_end(struct line *l, bool keep)
{
    l->searching = l->search_failed = false;
    if (!keep)
        show_entry(l, l->history->count, step_after(l, l->last));
    l->last = LAST_OTHER;
}

/* ---- suggestions ---- */

enum { SUGGESTIONS_TRIED = 50 }; /* matching lines to try, newest first */

const char *line_suggestion(const struct line *l, line_knows_function *knows, void *context)
{
    const size_t length = l->text.length;
    unsigned tried = 0;
    if (length == 0 || l->cursor < length)
        return "";
    for (size_t i = l->history->count; i-- > 0 && tried < SUGGESTIONS_TRIED;) {
        const char *entry = l->history->line[i];
        const char *rest = entry + length;
        uint32_t point;
        if (strncmp(entry, l->text.data, length) != 0 || *rest == '\0')
            continue;
        /* The rest must begin with a character, not with a mark that combines with the last one
         * typed. */
        char_read(rest, strlen(rest), &point);
        if (point != CHAR_BROKEN && char_width(point) == 0)
            continue;
        if (knows(context, entry))
            return rest;
        tried++;
    }
    return "";
}

bool line_take_suggestion(struct line *l, const char *rest, enum line_action action)
{
    if (*rest == '\0' || (action != LINE_RIGHT && action != LINE_END && action != LINE_WORD_RIGHT))
        return false;
    size_t length = strlen(rest);
    if (action == LINE_WORD_RIGHT) { /* take the first word of the suggestion */
        struct line whole = {.cursor = l->cursor};
        buf_add(&whole.text, buf_text(&l->text), l->text.length);
        buf_add_text(&whole.text, rest);
        length = whole.text.failed ? 0 : word_right(&whole, l->cursor) - l->cursor;
        buf_release(&whole.text);
    }
    line_replace(l, l->cursor, l->cursor, rest, length);
    return true;
}
