/* Commands that lead back to former states of the segmentation, and on to others. */
#include "command/act.h"

#include <string.h>

enum { LISTED = 20 };

/* The number and the words of the command that led to a point. */
static void tell_point(struct buf *out, const struct history *history, uint32_t at)
{
    const struct point *point = history->point + at;
    buf_printf(out, "%zu ", point->record);
    buf_add_safe(out, point->command, strlen(point->command));
}

/* Where the session is now, for user and journal. */
static void tell_arrival(const struct interpreter *interp, uint32_t to, uint32_t branch,
                         struct reply *reply)
{
    const struct history *history = &interp->history;
    buf_printf(&reply->words, "at=%zu on=%s", history->point[to].record,
               history->branch[branch].name);
    buf_add_text(&reply->text, "after ");
    tell_point(&reply->text, history, to);
    const size_t waits = interp->session.pendings;
    if (waits > 0)
        buf_printf(&reply->text, ", %zu edit%s waiting for `run`", waits, waits > 1 ? "s" : "");
    buf_add_char(&reply->text, '\n');
}

static enum err go(struct interpreter *interp, uint32_t to, uint32_t branch, struct reply *reply,
                   struct fault *fault)
{
    enum err err = history_go(&interp->history, &interp->session, to, branch, fault);
    if (!err)
        tell_arrival(interp, to, branch, reply);
    return err;
}

/* "undone: 12 seed 90,33,60 2", the latest of them first, of at most some. */
static void tell_undone(const struct history *history, uint32_t to, struct reply *reply)
{
    unsigned told = 0;
    for (uint32_t at = history->present; at != to; at = history->point[at].parent) {
        if (++told > LISTED)
            continue;
        buf_add_text(&reply->text, "undone: ");
        tell_point(&reply->text, history, at);
        buf_add_char(&reply->text, '\n');
    }
    if (told > LISTED)
        buf_printf(&reply->text, "and %u before these\n", told - LISTED);
}

ACT(undo)
{
    uint32_t to;
    const size_t count = value[0].given ? (size_t)value[0].number : 1;
    enum err err = history_before(&interp->history, count, &to, fault);
    if (err)
        return err;
    tell_undone(&interp->history, to, reply);
    return go(interp, to, interp->history.on, reply, fault);
}

ACT(redo)
{
    uint32_t to;
    const size_t count = value[0].given ? (size_t)value[0].number : 1;
    enum err err = history_after(&interp->history, count, &to, fault);
    return err ? err : go(interp, to, interp->history.on, reply, fault);
}

ACT(goto)
{
    uint32_t to, branch;
    enum err err = history_find(&interp->history, value[0].text, &to, &branch, fault);
    return err ? err : go(interp, to, branch, reply, fault);
}

ACT(branch)
{
    const char *name = value[0].text;
    if (!act_name_is_fit(name, BRANCH_NAME_BYTES))
        return fault_set(fault, ERR_USAGE,
                         "NAME: expected a word of at most %d bytes that begins with a letter, "
                         "not %s",
                         BRANCH_NAME_BYTES - 1, name);
    enum err err = history_branch(&interp->history, name, fault);
    if (!err)
        buf_printf(&reply->words, "branch=%s", name);
    return err;
}

/* A line for each of the last `count` points, the latest last, and for the branches. */
ACT(history)
{
    const struct history *history = &interp->history;
    const size_t count = value[0].given ? (size_t)value[0].number : LISTED;
    const size_t first = history->points > count ? history->points - count : 0;
    (void)fault;
    for (size_t i = first; i < history->points; i++) {
        const struct point *point = history->point + i;
        buf_add_text(&reply->text, i == history->present ? "* " : "  ");
        tell_point(&reply->text, history, (uint32_t)i);
        if (i > 0 && point->parent + 1 != i)
            buf_printf(&reply->text, "   (from %zu)", history->point[point->parent].record);
        for (size_t b = 0; b < history->branches; b++)
            if (history->branch[b].point == i && history->branches > 1)
                buf_printf(&reply->text, "   [%s]", history->branch[b].name);
        buf_add_char(&reply->text, '\n');
    }
    return OK;
}
