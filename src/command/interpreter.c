/* SPDX-License-Identifier: MIT */
#include "command/interpreter.h"

#include "image/image_helper.h"
#include "image/picture_writer.h"
#include "journal/journal.h"

enum err interpreter_init(struct interpreter *interp, struct fault *fault)
{
    *interp = (struct interpreter){0};
    history_init(&interp->history);
    const enum err err = session_new(&interp->session, fault);
    return err ? err : image_helper_new(&interp->helper, NULL, fault);
}

enum err interpreter_write_beside(struct interpreter *interp, struct fault *fault)
{
    return picture_writer_new(&interp->writer, NULL, fault);
}

void interpreter_release(struct interpreter *interp)
{
    picture_job_free(interp->job);
    picture_writer_free(interp->writer);
    journal_close(interp->journal);
    image_helper_free(interp->helper);
    history_release(&interp->history);
    session_free(interp->session);
    buf_release(&interp->home);
    buf_release(&interp->written);
    buf_release(&interp->made);
    buf_release(&interp->placed);
    canvas_release(&interp->shown);
    *interp = (struct interpreter){0};
}

void interpreter_show(struct interpreter *interp, const struct canvas *picture)
{
    canvas_release(&interp->shown);
    interp->shown = *picture;
    interp->shows_picture = true;
}

void reply_clear(struct reply *reply)
{
    buf_clear(&reply->text);
    buf_clear(&reply->words);
    buf_clear(&reply->canonical);
    buf_clear(&reply->list);
    buf_clear(&reply->files);
}

void reply_release(struct reply *reply)
{
    buf_release(&reply->text);
    buf_release(&reply->words);
    buf_release(&reply->canonical);
    buf_release(&reply->list);
    buf_release(&reply->files);
}

/* ---- its journal ---- */

enum err interpreter_set_home(struct interpreter *interp, const char *path, struct fault *fault)
{
    buf_clear(&interp->home);
    buf_add_text(&interp->home, path);
    return interp->home.failed ? fault_memory(fault, "a path") : OK;
}

bool interpreter_is_journal(const char *path)
{
    return file_begins_with(path, RECORD_HEADER);
}

enum err interpreter_create_journal(struct interpreter *interp, const char *path,
                                    struct fault *fault)
{
    enum err err = interpreter_set_home(interp, path, fault);
    if (!err)
        err = journal_create(&interp->journal, path, session_semantics(interp->session), fault);
    if (err)
        return err;
    err = journal_set_sync(interp->journal, interp->sync, fault);
    if (err) { /* no thread can be had: as if it had not been begun */
        journal_close(interp->journal);
        interp->journal = NULL;
        file_discard(path);
    }
    return err;
}

void interpreter_tell_lock(const struct interpreter *interp, struct buf *told)
{
    const char *lock = interp->journal ? journal_lock_file(interp->journal) : NULL;
    if (!lock)
        return;
    buf_add_text(told, "the file system has no locks: ");
    buf_add_safe_text(told, lock);
    buf_add_text(told, " keeps other sessions from writing, until this one ends\n");
}
