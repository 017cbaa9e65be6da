/* SPDX-License-Identifier: MIT */
#include "tui/prompt/pager.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/mem.h"
#include "tui/cells.h"
#include "tui/term.h"

void pager_init(struct pager *p, const char *text, size_t length)
{
    *p = (struct pager){.text = text, .length = length};
}

void pager_release(struct pager *p)
{
    buf_release(&p->wrapped);
    buf_release(&p->wanted);
    free(p->row);
    *p = (struct pager){0};
}

void pager_turn_to(struct pager *p, const char *text, size_t length)
{
    p->text = text;
    p->length = length;
    p->rows = p->top = 0;
}

/* ---- rows ---- */

static bool is_colour(const char *text)
{
    return *text == '\033';
}

static bool add_row(struct pager *p, const struct pager_row *row)
{
    if (!mem_grow(&p->row, &p->capacity, p->rows + 1, sizeof *p->row))
        return false;
    p->row[p->rows++] = *row;
    return true;
}

/* The rows of wrapped[start..end), which has no line feeds; *colour is in force there, and then. */
static bool cut(struct pager *p, size_t line, size_t start, size_t end, size_t *colour)
{
    struct pager_row row = {start, 0, line, *colour};
    size_t used = 0, cells;
    for (size_t at = start, n; at < end; at += n) {
        const char *text = p->wrapped.data + at;
        n = cells_next(text, end - at, &cells);
        if (used + cells > p->columns) {
            if (!add_row(p, &row))
                return false;
            row = (struct pager_row){at, 0, line, *colour};
            used = 0;
        }
        if (is_colour(text)) /* ESC[m and ESC[0m take it away */
            *colour = n == 3 || (n == 4 && text[2] == '0') ? SIZE_MAX : at;
        used += cells;
        row.length += n;
    }
    return add_row(p, &row);
}

/* The rows of the line text[from..to). */
static bool wrap(struct pager *p, size_t from, size_t to, size_t *colour)
{
    const struct buf line = {.data = (char *)(uintptr_t)(p->text + from), .length = to - from};
    size_t at = p->wrapped.length;
    cells_wrap(&p->wrapped, &line, p->columns);
    if (p->wrapped.failed)
        return false;
    for (const char *end; at <= p->wrapped.length; at = (size_t)(end - p->wrapped.data) + 2) {
        const char *start = buf_text(&p->wrapped) + at;
        end = strstr(start, "\r\n");
        if (!end)
            return cut(p, from, at, p->wrapped.length, colour);
        if (!cut(p, from, at, (size_t)(end - p->wrapped.data), colour))
            return false;
    }
    return true;
}

static size_t page(const struct pager *p)
{
    return p->height > 1 ? p->height - 1 : 1;
}

static void go_to(struct pager *p, size_t row)
{
    const size_t last = p->rows > page(p) ? p->rows - page(p) : 0;
    p->top = row < last ? row : last;
}

/* The first row of the line that holds this byte of the text. */
static size_t row_of(const struct pager *p, size_t at)
{
    size_t row = 0;
    for (size_t i = 0; i < p->rows && p->row[i].line <= at; i++)
        if (p->row[i].line != p->row[row].line)
            row = i;
    return row;
}

bool pager_fit(struct pager *p, unsigned columns, unsigned height)
{
    const size_t line = p->rows ? p->row[p->top].line : 0;
    p->height = height;
    if (p->rows && columns == p->columns) {
        go_to(p, p->top);
        return true;
    }
    size_t colour = SIZE_MAX;
    p->columns = columns;
    p->rows = 0;
    buf_clear(&p->wrapped);
    for (size_t from = 0; from < p->length;) {
        const char *feed = memchr(p->text + from, '\n', p->length - from);
        const size_t to = feed ? (size_t)(feed - p->text) : p->length;
        if (!wrap(p, from, to, &colour))
            return false;
        from = to + 1;
    }
    go_to(p, row_of(p, line));
    return true;
}

bool pager_is_needed(const struct pager *p)
{
    return p->rows > page(p);
}

/* ---- search ---- */

static bool matches(const struct pager *p, const char *text, size_t length)
{
    const size_t wanted = p->wanted.length;
    return wanted > 0 && wanted <= length && strncasecmp(text, p->wanted.data, wanted) == 0;
}

static bool holds(const struct pager *p, size_t row)
{
    const struct pager_row *r = &p->row[row];
    for (size_t i = 0; i < r->length; i++)
        if (matches(p, p->wrapped.data + r->start + i, r->length - i))
            return true;
    return false;
}

/* From the row after the top one on, or back from the one before it. */
static void search(struct pager *p, bool back)
{
    for (size_t i = p->top; back ? i-- > 0 : ++i < p->rows;)
        if (holds(p, i)) {
            p->failed = false;
            go_to(p, i);
            return;
        }
    p->failed = p->wanted.length > 0;
}

/* ---- keys ---- */

static void search_key(struct pager *p, const struct key_event *event)
{
    if (event->key == KEY_CHARACTER && event->modifiers == 0) {
        buf_add(&p->wanted, event->text, event->length);
    } else if (event->key == KEY_BACKSPACE && p->wanted.length > 0) {
        char_erase(&p->wanted);
    } else if (event->key == KEY_ENTER) {
        p->asks = false;
        if (!p->filters)
            search(p, false);
    } else if (event->key != KEY_OTHER) {
        p->asks = false;
        buf_clear(&p->wanted);
    }
}

/* What a key that is held alone, or with Ctrl, is as a letter; 0 for none. */
static char letter_of(const struct key_event *event)
{
    switch (event->key) {
    case KEY_CHARACTER:
        if (event->modifiers == 0)
            return event->point < 128 ? (char)event->point : '\0';
        if (event->modifiers != KEY_CONTROL)
            return '\0';
        return event->point == 'c' || event->point == 'd'   ? 'q'
               : event->point == 'f' || event->point == 'b' ? (char)event->point
                                                            : '\0';
    case KEY_ESCAPE:
        return 'q';
    case KEY_PAGE_DOWN:
        return 'f';
    case KEY_PAGE_UP:
        return 'b';
    case KEY_ENTER:
    case KEY_DOWN:
        return 'j';
    case KEY_UP:
        return 'k';
    case KEY_HOME:
        return 'g';
    case KEY_END:
        return 'G';
    default:
        return '\0';
    }
}

bool pager_key(struct pager *p, const struct key_event *event)
{
    if (p->asks) {
        search_key(p, event);
        return true;
    }
    p->failed = false;
    switch (letter_of(event)) {
    case 'q':
        return false;
    case ' ':
    case 'f':
        go_to(p, p->top + page(p));
        break;
    case 'b':
        go_to(p, p->top > page(p) ? p->top - page(p) : 0);
        break;
    case 'j':
        go_to(p, p->top + 1);
        break;
    case 'k':
        go_to(p, p->top > 0 ? p->top - 1 : 0);
        break;
    case 'g':
    case '<':
        go_to(p, 0);
        break;
    case 'G':
    case '>':
        go_to(p, p->rows);
        break;
    case '/':
        buf_clear(&p->wanted);
        p->asks = true;
        break;
    case 'n':
    case 'N':
        search(p, letter_of(event) == 'N');
        break;
    default:
        return !p->filters;
    }
    return true;
}

/* ---- drawing ---- */

/* Matches are drawn in reverse. */
static void add_row_text(const struct pager *p, size_t number, bool marks, struct buf *out)
{
    const struct pager_row *row = &p->row[number];
    const char *text = p->wrapped.data + row->start;
    size_t cells, marked = 0; /* bytes of a match still to come */
    bool coloured = row->colour != SIZE_MAX;
    if (coloured)
        buf_add(out, p->wrapped.data + row->colour,
                cells_next(p->wrapped.data + row->colour, row->start - row->colour, &cells));
    for (size_t at = 0, n; at < row->length; at += n) {
        n = cells_next(text + at, row->length - at, &cells);
        if (marks && marked == 0 && matches(p, text + at, row->length - at)) {
            marked = p->wanted.length;
            buf_add_text(out, "\033[7m");
        }
        coloured |= is_colour(text + at);
        buf_add(out, text + at, n);
        if (marked > 0 && (marked = marked > n ? marked - n : 0) == 0)
            buf_add_text(out, "\033[27m");
    }
    if (coloured)
        buf_add_text(out, "\033[m");
}

void pager_draw(const struct pager *p, struct buf *out)
{
    buf_add_text(out, "\033[H");
    for (size_t i = 0; i + 1 < p->height; i++) {
        buf_add_text(out, "\033[K");
        if (p->top + i < p->rows)
            add_row_text(p, p->top + i, true, out);
        buf_add_text(out, "\r\n");
    }
    buf_add_text(out, "\033[K");
    struct buf words = {0};
    const size_t last = p->top + page(p) < p->rows ? p->top + page(p) : p->rows;
    if (p->asks)
        buf_printf(&words, "/%s", buf_text(&p->wanted));
    else if (p->failed)
        buf_printf(&words, "not found: %s", buf_text(&p->wanted));
    else if (p->filters && !pager_is_needed(p))
        buf_printf(&words, "/ shows what has a word in it; any other key leaves");
    else
        buf_printf(&words, "%zu-%zu of %zu  q: leave, Space, b, / n N, g G", p->top + 1, last,
                   p->rows);
    if (!p->asks)
        buf_add_text(out, "\033[7m");
    cells_crop(out, buf_text(&words), p->columns > 1 ? p->columns - 1 : 1);
    buf_add_text(out, "\033[m");
    buf_release(&words);
}

void pager_print(const struct pager *p, struct buf *out)
{
    for (size_t i = p->top; i < p->rows && i < p->top + page(p); i++) {
        add_row_text(p, i, false, out);
        buf_add_text(out, "\r\n");
    }
}

/* ---- at the terminal ---- */

enum { ROWS_LEAST = 4, COLUMNS_LEAST = 12 };

#define OTHER_SCREEN "\033[?1049h"
#define USUAL_SCREEN "\033[m\033[?1049l"

/* False for an event that leaves. */
static bool take_event(struct line_editor *e, struct pager *p, const struct key_event *event)
{
    if (event->key == KEY_REPLY) {
        line_editor_reply(e);
        return true;
    }
    if (event->key == KEY_PASTE_BEGIN)
        e->pasting = true;
    if (event->key == KEY_CHARACTER && event->modifiers == KEY_CONTROL && event->point == 'z') {
        line_editor_suspend(e);
        return true;
    }
    return event->key != KEY_PASTE_BEGIN && pager_key(p, event);
}

/* False when a key leaves, or the terminal has gone. */
static bool wait(struct line_editor *e, struct pager *p)
{
    struct key_event event;
    const bool waiting = keys_waiting(&e->keys);
    bool stays = true;
    switch (term_read(&e->input, waiting ? KEYS_TIMEOUT_MS : -1, -1)) {
    case TERM_BYTES:
        while (stays && line_editor_next(e, &event))
            stays = take_event(e, p, &event);
        return stays;
    case TERM_TIMEOUT:
        return !line_editor_time_out(e, &event) || take_event(e, p, &event);
    case TERM_SIGNAL:
        term_was_continued();
        term_was_resized();
        return true;
    default:
        return false;
    }
}

static enum err show(struct line_editor *e, struct pager *p, struct fault *fault)
{
    struct buf out = {0};
    bool stays = true;
    enum err err = term_change_sequences(TERM_PROMPT_BEGINS OTHER_SCREEN,
                                         USUAL_SCREEN TERM_PROMPT_ENDS, fault);
    while (!err && stays) {
        const struct term_size size = term_size();
        struct buf drawn = {.failed = !pager_fit(p, size.columns, size.rows)};
        pager_draw(p, &drawn);
        err = term_write_text(&drawn, "a page", fault);
        stays = !err && wait(e, p);
    }
    struct fault *const why = err ? NULL : fault;
    enum err left = term_change_sequences(TERM_PROMPT_BEGINS, TERM_PROMPT_ENDS, why);
    pager_print(p, &out);
    if (!left)
        left = term_write_text(&out, "a page", why);
    buf_release(&out);
    return err ? err : left;
}

/* What has been typed meanwhile, once the answers that are due have come. */
static bool is_typed_on(struct line_editor *e)
{
    line_editor_take_answers(e);
    term_read(&e->input, 0, -1);
    return e->pasting || e->taken < e->input.length;
}

enum err page_text(struct line_editor *e, const struct buf *text, bool *paged, struct fault *fault)
{
    struct pager p;
    const struct term_size size = term_size();
    pager_init(&p, buf_text(text), text->length);
    *paged = size.rows >= ROWS_LEAST && size.columns >= COLUMNS_LEAST && !text->failed &&
             pager_fit(&p, size.columns, size.rows) && pager_is_needed(&p) && !is_typed_on(e);
    const enum err err = *paged ? show(e, &p, fault) : OK;
    pager_release(&p);
    return err;
}
