/* SPDX-License-Identifier: MIT */
/* Commands that go to other states of the segmentation: undo, redo, goto, branch, history; and
 * commands about the journal: its file, and when it is synced. */
#include "command/golden_files.h"
#include "command/act.h"

#include <string.h>

#include "base/file.h"
#include "base/mem.h"
#include "journal/golden.h"
#include "journal/journal.h"

enum { LISTED = 20 };

/* Add the number and the words of the command that led to a point. */
static void write_point(struct buf *out, const struct history *history, uint32_t at)
{
    const struct point *point = history->point + at;
    buf_printf(out, "%zu ", point->record);
    buf_add_safe_excerpt(out, point->command, strlen(point->command));
}

/* Go to a point, and report it in the answer and in the words of the record. */
static enum err go_to_point(const struct act *act, uint32_t to, uint32_t branch, bool moves_tip)
{
    struct history *history = &act->interp->history;
    const struct branch *on = history->branch + branch;
    struct reply *reply = act->reply;
    TRY(history_go(history, act->session, to, branch, moves_tip, act->fault));
    buf_printf(&reply->words, "at=%zu on=%s", history->point[to].record, on->name);
    buf_add_text(&reply->text, "after ");
    write_point(&reply->text, history, to);
    const size_t waits = session_pendings(act->session);
    if (waits > 0)
        buf_printf(&reply->text, ", %zu edit%s pending until `run`%s", waits, plural(waits),
                   act->session->now.outlook.runs_by_itself ? " or the next edit" : "");
    buf_add_char(&reply->text, '\n');
    if (!history->moves_tip && on->point != to) /* the tip of the branch does not move */
        buf_printf(&reply->text, "%s stays at record %zu: `goto %s` leads back\n", on->name,
                   history->point[on->point].record, on->name);
    return OK;
}

/* Go back or forward by COUNT commands, or to the first or last. */
static enum err go_by(const struct act *act, bool back)
{
    const struct history *history = &act->interp->history;
    const size_t wanted = (size_t)act_number_or(act, "COUNT", 1);
    size_t count = wanted;
    uint32_t to;
    TRY(history_step(history, back, &count, &to, act->fault));
    if (count < wanted)
        buf_printf(&act->reply->text, "only %zu command%s could be %s, not %zu\n", count,
                   plural(count), back ? "undone" : "done again", wanted);
    /* Add lines "undone: 12 seed 90,33,60 2", the latest first. */
    size_t undone = 0;
    for (uint32_t at = history->present; back && at != to; at = history->point[at].parent) {
        if (++undone > LISTED)
            continue;
        buf_add_text(&act->reply->text, "undone: ");
        write_point(&act->reply->text, history, at);
        buf_add_char(&act->reply->text, '\n');
    }
    if (undone > LISTED)
        buf_printf(&act->reply->text, "and %zu before these\n", undone - LISTED);
    const bool is_at_tip = history->branch[history->on].point == history->present;
    return go_to_point(act, to, history->on, is_at_tip);
}

enum err act_undo(const struct act *act)
{
    return go_by(act, true);
}

enum err act_redo(const struct act *act)
{
    return go_by(act, false);
}

enum err act_goto(const struct act *act)
{
    uint32_t to, branch;
    TRY(history_find(&act->interp->history, act_text(act, "PLACE"), &to, &branch, act->fault));
    return go_to_point(act, to, branch, false);
}

enum err act_branch(const struct act *act)
{
    const char *name = act_text(act, "NAME");
    TRY(act_check_name(name, BRANCH_NAME_BYTES, act->fault));
    TRY(history_branch(&act->interp->history, name, act->fault));
    buf_printf(&act->reply->words, "branch=%s", name);
    return OK;
}

/* Add a line for each of the last `count` points, the latest last, with branches. */
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

/* ---- the journal: these commands are not recorded in it ---- */

/* Copy the golden images next to a journal. `made` is the path of the new folder, or empty without
 * golden images. */
static enum err take_goldens_along(struct buf *made, const struct journal *from, const char *to,
                                   struct fault *fault)
{
    const struct buf *bytes = journal_bytes(from);
    OWNED(golden_files_close) struct golden_files source = {.folder = -1};
    enum err err = golden_files_open(&source, journal_path(from), false, fault);
    if (!err)
        err = golden_files_read(&source, buf_text(bytes), bytes->length, fault);
    if (!err)
        err = golden_folder(made, to, fault);
    if (!err && source.folder >= 0)
        err = golden_files_copy(&source, buf_text(made), fault);
    if (err || source.folder < 0)
        buf_clear(made);
    return err;
}

static enum err continue_in(const struct act *act, const char *path)
{
    struct interpreter *interp = act->interp;
    struct fault *fault = act->fault;
    struct buf *former = act_buf(act), *goldens = act_buf(act);
    struct buf *folder = act_buf(act), *former_folder = act_buf(act);
    buf_add_text(former, buf_text(&interp->home));
    file_folder(former_folder, buf_text(former));
    file_folder(folder, path);
    if (arena_failed(&interp->arena)) /* the following steps cannot be undone */
        return fault_memory(fault, "a path");
    if (file_exists(path)) /* checked before anything is copied */
        return fault_set(fault, ERR_IO, "%s exists already and was left alone", path);
    enum err err = take_goldens_along(goldens, interp->journal, path, fault);
    if (!err)
        err = interpreter_set_home(interp, path, fault);
    if (!err)
        err = journal_continue(interp->journal, path, fault);
    if (err && goldens->length)
        folder_remove(buf_text(goldens));
    if (err)
        interpreter_set_home(interp, buf_text(former), NULL);
    /* Records are copied byte for byte, including their names of files. */
    else if (!file_is_same(buf_text(former_folder), buf_text(folder)))
        buf_add_text(&act->reply->text, "files that it has read are named relative to its former "
                                        "folder; --scene FILE names the scene\n");
    return err;
}

/* Copy the whole journal to a new file, with its golden images and labels. */
static enum err record_in(const struct act *act, const char *name)
{
    struct interpreter *interp = act->interp;
    struct buf *path = act_buf(act);
    file_from_home(path, name);
    if (path->failed)
        return fault_memory(act->fault, "a path");
    if (interp->journal)
        return continue_in(act, buf_text(path));
    if (interp->unrecorded > 0)
        return fault_set(act->fault, ERR_USAGE,
                         "%zu command%s came before, without a journal; --journal FILE records "
                         "from the beginning",
                         interp->unrecorded, plural(interp->unrecorded));
    return interpreter_create_journal(interp, buf_text(path), act->fault);
}

enum err act_journal(const struct act *act)
{
    struct interpreter *interp = act->interp;
    struct buf *out = &act->reply->text;
    if (interp->mode != MODE_LIVE)
        return fault_set(
            act->fault, ERR_INPUT,
            "`journal` is not allowed in the script of a journal, which does not contain its file");
    if (act_has(act, "FILE")) {
        TRY(fault_prefix(act->fault, record_in(act, act_text(act, "FILE")),
                         "the journal stays where it was"));
        interp->new_journal = NULL;
    }
    if (!interp->journal) {
        buf_add_text(out, "nothing is recorded yet\n");
        return OK;
    }
    buf_add_safe_text(out, journal_path(interp->journal));
    buf_printf(out, ", %zu record%s%s\n", journal_count(interp->journal),
               plural(journal_count(interp->journal)),
               journal_only_looks(interp->journal) ? ", read-only: nothing is written" : "");
    interpreter_write_lock(interp, out);
    return OK;
}

enum err act_sync(const struct act *act)
{
    static const char *const words[] = {
        "each command is on the disk before it is acknowledged",
        "a loss of power may lose the commands of the last second",
        "a loss of power may lose the commands since the last `sync`"};
    enum err err = OK;
    if (act->interp->mode != MODE_LIVE)
        return OK; /* nothing is written */
    const enum file_sync sync =
        act_has(act, "WHEN") ? (enum file_sync)act_number(act, "WHEN") : act->interp->sync;
    if (act->interp->journal)
        err = act_has(act, "WHEN") ? journal_set_sync(act->interp->journal, sync, act->fault)
                                   : journal_sync(act->interp->journal, act->fault);
    TRY(fault_prefix(act->fault, err, "`journal FILE` continues in another file"));
    act->interp->sync = sync;
    buf_printf(&act->reply->text, "%s\n", words[sync]);
    return OK;
}
