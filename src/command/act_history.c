/* Commands that go to other states of the segmentation: undo, redo, goto, branch, history. */
#include "command/act.h"

#include <string.h>

#include "session/semantics.h"

enum { LISTED = 20 };

/* The number and the words of the command that led to a point. */
static void write_point(struct buf *out, const struct history *history, uint32_t at)
{
    const struct point *point = history->point + at;
    buf_printf(out, "%zu ", point->record);
    buf_add_safe_excerpt(out, point->command, strlen(point->command));
}

/* Where the session is now, for user and journal. */
static void write_arrival(const struct act *act, uint32_t to, uint32_t branch)
{
    const struct history *history = &act->interp->history;
    struct reply *reply = act->reply;
    buf_printf(&reply->words, "at=%zu on=%s", history->point[to].record,
               history->branch[branch].name);
    buf_add_text(&reply->text, "after ");
    write_point(&reply->text, history, to);
    const size_t waits = session_pendings(act->session);
    if (waits > 0)
        buf_printf(&reply->text, ", %zu edit%s waiting for `run`%s", waits, plural(waits),
                   session_outlook(act->session)->runs_by_itself ? " or the next edit" : "");
    buf_add_char(&reply->text, '\n');
}

/* Where the tip of the branch stays ahead, or behind. */
static void write_tip(const struct act *act, uint32_t to, uint32_t branch)
{
    const struct history *history = &act->interp->history;
    const struct branch *on = history->branch + branch;
    if (history->moves_tip || on->point == to)
        return;
    buf_printf(&act->reply->text, "%s stays at record %zu: `goto %s` leads back\n", on->name,
               history->point[on->point].record, on->name);
}

static enum err go(const struct act *act, uint32_t to, uint32_t branch, bool moves_tip)
{
    struct history *history = &act->interp->history;
    const bool has_tips = semantics_has(session_semantics(act->session), MEANING_BRANCH_TIPS);
    enum err err =
        history_go(history, act->session, to, branch, moves_tip || !has_tips, act->fault);
    if (err)
        return err;
    write_arrival(act, to, branch);
    write_tip(act, to, branch);
    return OK;
}

/* "undone: 12 seed 90,33,60 2", the latest of them first, of at most some. */
static void write_undone(const struct history *history, uint32_t to, struct reply *reply)
{
    unsigned count = 0;
    for (uint32_t at = history->present; at != to; at = history->point[at].parent) {
        if (++count > LISTED)
            continue;
        buf_add_text(&reply->text, "undone: ");
        write_point(&reply->text, history, at);
        buf_add_char(&reply->text, '\n');
    }
    if (count > LISTED)
        buf_printf(&reply->text, "and %u before these\n", count - LISTED);
}

static size_t wanted(const struct act *act)
{
    return (size_t)act_number_or(act, "COUNT", 1);
}

static void write_fewer(const struct act *act, size_t count, const char *what)
{
    if (count < wanted(act))
        buf_printf(&act->reply->text, "only %zu command%s could be %s, not %zu\n", count,
                   plural(count), what, wanted(act));
}

enum err act_undo(const struct act *act)
{
    const struct history *history = &act->interp->history;
    uint32_t to;
    size_t count = wanted(act);
    enum err err = history_before(history, &count, &to, act->fault);
    if (err)
        return err;
    write_fewer(act, count, "undone");
    write_undone(history, to, act->reply);
    return go(act, to, history->on, history_is_at_tip(history));
}

enum err act_redo(const struct act *act)
{
    const struct history *history = &act->interp->history;
    uint32_t to;
    size_t count = wanted(act);
    enum err err = history_after(history, &count, &to, act->fault);
    if (err)
        return err;
    write_fewer(act, count, "done again");
    return go(act, to, history->on, history_is_at_tip(history));
}

enum err act_goto(const struct act *act)
{
    uint32_t to, branch;
    enum err err =
        history_find(&act->interp->history, act_text(act, "PLACE"), &to, &branch, act->fault);
    return err ? err : go(act, to, branch, false);
}

enum err act_branch(const struct act *act)
{
    const char *name = act_text(act, "NAME");
    enum err err = act_check_name(name, BRANCH_NAME_BYTES, false, act->fault);
    if (!err)
        err = history_branch(&act->interp->history, name, act->fault);
    if (!err)
        buf_printf(&act->reply->words, "branch=%s", name);
    return err;
}

/* A line for each of the last `count` points, the latest last, and for the branches. */
enum err act_history(const struct act *act)
{
    const struct history *history = &act->interp->history;
    const size_t count = (size_t)act_number_or(act, "COUNT", LISTED);
    const size_t first = history->points > count ? history->points - count : 0;
    for (size_t i = first; i < history->points; i++) {
        const struct point *point = history->point + i;
        buf_add_text(&act->reply->text, i == history->present ? "* " : "  ");
        write_point(&act->reply->text, history, (uint32_t)i);
        if (i > 0 && point->parent + 1 != i)
            buf_printf(&act->reply->text, "   (from %zu)", history->point[point->parent].record);
        for (size_t b = 0; b < history->branches; b++)
            if (history->branch[b].point == i && history->branches > 1)
                buf_printf(&act->reply->text, "   [%s]", history->branch[b].name);
        buf_add_char(&act->reply->text, '\n');
    }
    return OK;
}
