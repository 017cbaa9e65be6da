#include "tui/prompt/line_recall.h"

#include <string.h>

#include "tui/cells.h"

enum { SUGGESTIONS_TRIED = 50 }; /* lines that begin so, newest first */

/* ---- one line after another ---- */

/* Shows entry `place`; the line of today waits in the draft meanwhile. */
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
    line_change(l, 0, l->text.length, text, strlen(text), step);
}

/* Lines shown one after another are one step. */
static enum line_step step_after(const struct line *l, enum line_last before)
{
    return before == LAST_RECALLED && l->place < l->history->count ? STEP_OVER : STEP_NEW;
}

static bool is_entry(const struct line *l, size_t place)
{
    return strcmp(l->history->line[place], buf_text(&l->text)) == 0;
}

/* What the lines to be looked through begin with, from now on. */
static void begin_browsing(struct line *l)
{
    if (l->place < l->history->count && !is_entry(l, l->place))
        l->place = l->history->count;
    buf_clear(&l->prefix);
    buf_add(&l->prefix, buf_text(&l->text), l->cursor);
}

static bool is_wanted(const struct line *l, size_t place)
{
    return strncmp(l->history->line[place], buf_text(&l->prefix), l->prefix.length) == 0 &&
           !is_entry(l, place);
}

static size_t older(const struct line *l)
{
    for (size_t place = l->place; place-- > 0;)
        if (is_wanted(l, place))
            return place;
    return l->place;
}

static size_t newer(const struct line *l)
{
    size_t place = l->place;
    do
        place++;
    while (place < l->history->count && !is_wanted(l, place));
    return place;
}

/* ---- last words ---- */

/* The last word of a line, with its quotes. */
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

static void cite(struct line *l, bool again)
{
    size_t place = again ? l->cited : l->history->count, length;
    if (place == 0)
        return;
    const char *word = last_word(l->history->line[--place], &length);
    l->cited = place;
    l->cited_at = again ? l->cited_at : l->cursor;
    line_change(l, l->cited_at, l->cursor, word, length, again ? STEP_OVER : STEP_NEW);
}

void line_recall(struct line *l, enum line_action action, enum line_last before)
{
    const bool again = before == LAST_RECALLED;
    const enum line_step step = step_after(l, before);
    l->last = action == LINE_CITE ? LAST_CITED : LAST_RECALLED;
    if (action != LINE_CITE && !again)
        begin_browsing(l);
    if (action == LINE_CITE)
        cite(l, before == LAST_CITED);
    else if (action == LINE_OLDER)
        show_entry(l, older(l), step);
    else if (action == LINE_NEWER)
        show_entry(l, newer(l), step);
    else
        show_entry(l, action == LINE_OLDEST ? 0 : l->history->count, step);
}

/* ---- search ---- */

/* Looks for the wanted text from entry `place` on towards the oldest. */
static void search_from(struct line *l, size_t place)
{
    const char *wanted = buf_text(&l->wanted);
    for (size_t i = place + 1; i-- > 0;) {
        const char *found = i < l->history->count ? strstr(l->history->line[i], wanted) : NULL;
        if (found) {
            show_entry(l, i, step_after(l, l->last));
            l->cursor = (size_t)(found - l->history->line[i]);
            l->last = LAST_RECALLED;
            l->search_failed = false;
            return;
        }
    }
    l->search_failed = true;
}

void line_search_begin(struct line *l)
{
    l->last = LAST_OTHER;
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
        show_entry(l, l->history->count, step_after(l, l->last));
    l->last = LAST_OTHER;
}

/* ---- suggestions ---- */

/* The rest would begin with a character, not with a mark upon the last one typed. */
static bool goes_on(const char *rest)
{
    uint32_t point;
    if (*rest == '\0')
        return false;
    char_read(rest, strlen(rest), &point);
    return point == CHAR_BROKEN || char_width(point) > 0;
}

const char *line_suggestion(const struct line *l, line_knows_function *knows, void *context)
{
    const size_t length = l->text.length;
    unsigned tried = 0;
    if (length == 0 || l->cursor < length)
        return "";
    for (size_t i = l->history->count; i-- > 0 && tried < SUGGESTIONS_TRIED;) {
        const char *entry = l->history->line[i];
        if (strncmp(entry, l->text.data, length) != 0 || !goes_on(entry + length))
            continue;
        if (knows(context, entry))
            return entry + length;
        tried++;
    }
    return "";
}

/* The end of the first word of what is suggested. */
static size_t first_word(const struct line *l, const char *rest)
{
    struct line whole = {.cursor = l->cursor};
    buf_add(&whole.text, buf_text(&l->text), l->text.length);
    buf_add_text(&whole.text, rest);
    const size_t end = whole.text.failed ? l->cursor : line_word_right(&whole, l->cursor);
    buf_release(&whole.text);
    return end - l->cursor;
}

bool line_take_suggestion(struct line *l, const char *rest, enum line_action action)
{
    if (*rest == '\0' || (action != LINE_RIGHT && action != LINE_END && action != LINE_WORD_RIGHT))
        return false;
    const size_t length = action == LINE_WORD_RIGHT ? first_word(l, rest) : strlen(rest);
    line_replace(l, l->cursor, l->cursor, rest, length);
    return true;
}
