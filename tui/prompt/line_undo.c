#include "tui/prompt/line_undo.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

void line_undo_clear(struct line_undo *u)
{
    u->count = 0;
    buf_release(&u->removed);
}

void line_undo_release(struct line_undo *u)
{
    free(u->change);
    buf_release(&u->removed);
    *u = (struct line_undo){0};
}

/* Puts bytes before the last `tail` ones of what is held. */
static void hold(struct line_undo *u, size_t tail, const char *bytes, size_t length)
{
    char *end = buf_reserve(&u->removed, length);
    if (!end)
        return;
    memmove(end - tail + length, end - tail, tail);
    memcpy(end - tail, bytes, length);
    u->removed.length += length;
    u->removed.data[u->removed.length] = '\0';
}

/* Makes the change a part of the last step; false where it does not fit that. */
static bool join(struct line_undo *u, const struct line_change *c, const char *removed,
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
        hold(u, c->at == last->at ? 0 : last->removed, removed, c->removed);
        last->removed += c->removed;
        last->at = c->at;
    } else {
        return false;
    }
    return true;
}

static void drop_oldest(struct line_undo *u)
{
    const size_t bytes = u->change[0].removed;
    memmove(u->change, u->change + 1, --u->count * sizeof *u->change);
    u->removed.length -= bytes;
    if (bytes > 0)
        memmove(u->removed.data, u->removed.data + bytes, u->removed.length + 1);
}

void line_undo_note(struct line_undo *u, const struct line_change *change, const char *removed,
                    enum line_step step)
{
    if (!join(u, change, removed, step)) {
        if (!mem_grow(&u->change, &u->capacity, u->count + 1, sizeof *u->change)) {
            line_undo_clear(u);
            return;
        }
        u->change[u->count++] = *change;
        if (change->removed > 0)
            hold(u, 0, removed, change->removed);
    }
    if (u->removed.failed)
        line_undo_clear(u);
    while (u->count > LINE_UNDO_MOST || u->removed.length > LINE_UNDO_BYTES)
        drop_oldest(u);
}

bool line_undo_take(struct line_undo *u, struct line_change *change, const char **removed)
{
    if (u->count == 0)
        return false;
    *change = u->change[--u->count];
    u->removed.length -= change->removed;
    *removed = buf_text(&u->removed) + u->removed.length;
    return true;
}
