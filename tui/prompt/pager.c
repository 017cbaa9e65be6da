/* SPDX-License-Identifier: MIT */
#include "tui/prompt/pager.h"

#include <string.h>

#include "base/mem.h"
#include "tui/cells.h"
#include "tui/prompt/shell.h"

size_t pager_page_end(const struct buf *wrapped, size_t at, const struct term_size *size)
{
    size_t rows = 0;
    while (at < wrapped->length) {
        const char *line = wrapped->data + at;
        const char *feed = memchr(line, '\n', wrapped->length - at);
        const size_t length = feed ? (size_t)(feed - line) + 1 : wrapped->length - at;
        size_t more = 1, column = 0, cells;
        for (size_t i = 0; i < length && line[i] != '\r'; column += cells) {
            i += cells_next(line + i, length - i, &cells);
            if (column + cells > size->columns) {
                more++;
                column = 0;
            }
        }
        if (rows && rows + more >= size->rows)
            break;
        rows += more;
        at += length;
    }
    return at;
}

bool pager_is_left_by(const struct key_event *event)
{
    if (event->key != KEY_CHARACTER)
        return event->key == KEY_ESCAPE;
    return event->modifiers == KEY_CONTROL ? event->point == 'c' || event->point == 'd'
                                           : event->point == 'q' || event->point == 'Q';
}

bool pager_run(const char *pager, const struct buf *text)
{
    OWNED(buf_release) struct buf command = {0};
    int status = -1;
    if (!pager || !*pager)
        return false;
    buf_printf(&command, "LESSSECURE=1 LESS=${LESS-FRX}; export LESSSECURE LESS; %s", pager);
    if (!command.failed && term_set_mode(TERM_AS_FOUND, NULL) == OK &&
        shell_run(buf_text(&command), NULL, text, &status, NULL) != OK)
        status = -1;
    return term_set_mode(TERM_RAW, NULL) == OK && status >= 0 && !shell_has_none(status);
}

/* ---- at the prompt ---- */

/* Return false for a key that leaves the pager. */
static bool take_event(struct line_editor *e, const struct key_event *event, bool *has_key)
{
    *has_key = event->key != KEY_REPLY && event->key != KEY_OTHER;
    if (event->key == KEY_REPLY)
        line_editor_reply(e);
    if (event->key == KEY_PASTE_BEGIN)
        e->pasting = true;
    if (event->key == KEY_CHARACTER && event->modifiers == KEY_CONTROL && event->point == 'z') {
        line_editor_suspend(e);
        *has_key = false;
        return true;
    }
    return event->key != KEY_PASTE_BEGIN && !pager_is_left_by(event);
}

/* Wait for a key. Return false for one that leaves the pager, or if the terminal is gone. */
static bool await_key(struct line_editor *e)
{
    struct key_event event;
    bool stays = true, has_key = false;
    while (stays && !has_key) {
        if (line_editor_next(e, &event)) {
            stays = take_event(e, &event, &has_key);
            continue;
        }
        switch (term_read(&e->input, keys_waiting(&e->keys) ? KEYS_TIMEOUT_MS : -1, -1)) {
        case TERM_BYTES:
            break;
        case TERM_TIMEOUT:
            stays = !line_editor_time_out(e, &event) || take_event(e, &event, &has_key);
            break;
        case TERM_SIGNAL:
            term_was_continued();
            break;
        default:
            stays = false;
        }
    }
    return stays;
}

static enum err print_pages(struct line_editor *e, const struct buf *wrapped, struct fault *fault)
{
    bool stays = true;
    enum err err = OK;
    for (size_t at = 0, end; !err && stays && at < wrapped->length; at = end) {
        const struct term_size size = term_size();
        struct buf out = {0};
        end = pager_page_end(wrapped, at, &size);
        buf_add(&out, wrapped->data + at, end - at);
        if (end < wrapped->length)
            buf_add_text(&out, PAGER_MORE);
        err = term_write_text(&out, "a page", fault);
        if (err || end == wrapped->length)
            break;
        stays = await_key(e);
        err = term_write("\r\033[K", 4, fault);
    }
    return err;
}

enum err page_text(struct line_editor *e, const struct buf *text, bool *paged, struct fault *fault)
{
    const struct term_size size = term_size();
    OWNED(buf_release) struct buf wrapped = {0};
    enum err err = OK;
    cells_wrap(&wrapped, text, size.columns);
    *paged = !wrapped.failed && pager_page_end(&wrapped, 0, &size) < wrapped.length;
    if (*paged) { /* unless keys were typed meanwhile: they arrive after the answers that are due */
        line_editor_take_answers(e);
        term_read(&e->input, 0, -1);
        *paged = !e->pasting && e->taken == e->input.length && !e->held.length;
    }
    if (*paged && !pager_run(e->pager, text))
        err = print_pages(e, &wrapped, fault);
    return err;
}
