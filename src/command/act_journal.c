/* Commands about the journal: in which file it is, and when it is synced. None of them is
 * recorded: a journal says what was done, not where it is stored. */
#include "command/act.h"

#include "base/file.h"
#include "journal/golden.h"

/* Golden images lie in a folder beside their journal, and so go with it. `made` is the path of the
 * folder that they were copied to, or empty where there are none. */
static enum err take_goldens_along(struct buf *made, const char *from, const char *to,
                                   struct fault *fault)
{
    struct buf source = {0};
    enum err err = golden_folder(&source, from, fault);
    if (!err)
        err = golden_folder(made, to, fault);
    if (!err && file_is_folder(buf_text(&source)))
        err = folder_copy(buf_text(&source), buf_text(made), fault);
    else
        buf_clear(made);
    if (err)
        buf_clear(made);
    buf_release(&source);
    return err;
}

/* Its records are copied byte for byte, and their names with them. */
static void write_folder(struct reply *reply, const char *former, const char *path)
{
    struct buf folder[2] = {{0}, {0}};
    file_folder(&folder[0], former);
    file_folder(&folder[1], path);
    if (!file_is_same(buf_text(&folder[0]), buf_text(&folder[1])))
        buf_add_text(&reply->text, "what it has read so far it names as seen from its former "
                                   "folder; --scene FILE says where the scene is\n");
    buf_release(&folder[0]);
    buf_release(&folder[1]);
}

static enum err continue_in(const struct act *act, const char *path)
{
    struct interpreter *interp = act->interp;
    struct fault *fault = act->fault;
    struct buf former = {0}, goldens = {0};
    enum err err = OK;
    buf_add_text(&former, buf_text(&interp->home));
    if (former.failed)
        err = fault_memory(fault, "a path");
    else if (file_exists(path)) /* said before anything is copied */
        err = fault_set(fault, ERR_IO, "%s exists already and was left alone", path);
    if (!err)
        err = take_goldens_along(&goldens, journal_path(interp->journal), path, fault);
    if (!err)
        err = interpreter_set_home(interp, path, fault);
    if (!err)
        err = journal_continue(interp->journal, path, fault);
    if (!err)
        write_folder(act->reply, buf_text(&former), path);
    if (err && goldens.length)
        folder_remove(buf_text(&goldens));
    if (err && !former.failed)
        interpreter_set_home(interp, buf_text(&former), NULL);
    buf_release(&former);
    buf_release(&goldens);
    return err;
}

/* The whole record so far in a new file, and what lies beside it: golden images, labels. */
static enum err record_in(const struct act *act, const char *path)
{
    struct interpreter *interp = act->interp;
    if (interp->journal)
        return continue_in(act, path);
    if (interp->unrecorded > 0)
        return fault_set(act->fault, ERR_USAGE,
                         "%zu command%s came before, without a journal; --journal FILE records "
                         "from the beginning",
                         interp->unrecorded, plural(interp->unrecorded));
    return interpreter_create_journal(interp, path, act->fault);
}

static void write_journal(const struct interpreter *interp, struct reply *reply)
{
    if (!interp->journal) {
        buf_add_text(&reply->text, "nothing is recorded yet\n");
        return;
    }
    const char *path = journal_path(interp->journal);
    buf_add_safe_text(&reply->text, path);
    buf_printf(&reply->text, ", %zu record%s%s\n", journal_count(interp->journal),
               plural(journal_count(interp->journal)),
               journal_only_looks(interp->journal) ? ", read-only: nothing is written" : "");
    interpreter_tell_lock(interp, &reply->text);
}

enum err act_journal(const struct act *act)
{
    enum err err = OK;
    if (act->interp->mode != MODE_LIVE)
        return fault_set(
            act->fault, ERR_INPUT,
            "`journal` is not for scripts of a journal: where it is stored is no part of it");
    struct buf path = {0};
    if (act_has(act, "FILE")) {
        file_from_home(&path, act_text(act, "FILE"));
        err = path.failed ? fault_memory(act->fault, "a path") : record_in(act, buf_text(&path));
    }
    buf_release(&path);
    if (err)
        return fault_prefix(act->fault, err, "the journal stays where it was");
    if (act_has(act, "FILE"))
        act->interp->new_journal = NULL;
    write_journal(act->interp, act->reply);
    return OK;
}

enum err act_sync(const struct act *act)
{
    static const char *const words[] = {
        "each command is on the disk before it is acknowledged",
        "a loss of power may take the commands of the last second",
        "a loss of power may take what was done since the last `sync`"};
    enum err err = OK;
    if (act->interp->mode != MODE_LIVE)
        return OK; /* nothing is written */
    const enum file_sync sync =
        act_has(act, "WHEN") ? (enum file_sync)act_number(act, "WHEN") : act->interp->sync;
    if (act->interp->journal)
        err = act_has(act, "WHEN") ? journal_set_sync(act->interp->journal, sync, act->fault)
                                   : journal_sync(act->interp->journal, act->fault);
    if (err)
        return fault_prefix(act->fault, err, "`journal FILE` continues in another file");
    act->interp->sync = sync;
    buf_printf(&act->reply->text, "%s\n", words[sync]);
    return OK;
}
