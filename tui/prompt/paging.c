#include "tui/prompt/paging.h"

#include "tui/prompt/pager.h"
#include "tui/term.h"

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
static bool take_input(struct line_editor *e, struct pager *p)
{
    struct key_event event;
    while (line_editor_next(e, &event))
        if (!take_event(e, p, &event))
            return false;
    return true;
}

static bool wait(struct line_editor *e, struct pager *p)
{
    struct key_event event;
    const bool waiting = keys_waiting(&e->keys);
    switch (term_read(&e->input, waiting ? KEYS_TIMEOUT_MS : -1, -1)) {
    case TERM_BYTES:
        return take_input(e, p);
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

static enum err draw(struct pager *p, struct fault *fault)
{
    struct buf out = {0};
    const struct term_size size = term_size();
    const bool fits = pager_fit(p, size.columns, size.rows);
    pager_draw(p, &out);
    const enum err err = !fits || out.failed ? fault_memory(fault, "a page")
                                             : term_write(buf_text(&out), out.length, fault);
    buf_release(&out);
    return err;
}

static enum err leave(const struct pager *p, struct fault *fault)
{
    struct buf out = {0};
    enum err err = term_change_sequences(TERM_PROMPT_BEGINS, TERM_PROMPT_ENDS, fault);
    pager_print(p, &out);
    if (!err)
        err = out.failed ? fault_memory(fault, "a page")
                         : term_write(buf_text(&out), out.length, fault);
    buf_release(&out);
    return err;
}

static enum err show(struct line_editor *e, struct pager *p, struct fault *fault)
{
    bool stays = true;
    enum err err = term_change_sequences(TERM_PROMPT_BEGINS OTHER_SCREEN,
                                         USUAL_SCREEN TERM_PROMPT_ENDS, fault);
    while (!err && stays) {
        err = draw(p, fault);
        stays = !err && wait(e, p);
    }
    const enum err left = leave(p, err ? NULL : fault);
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
