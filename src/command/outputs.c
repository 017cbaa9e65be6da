/* The interpreter's files that go with a command: they stand or fall with it. */
#include "command/interpreter.h"

#include <string.h>

#include "base/file.h"
#include "sandbox/limits.h"

static bool has_made(const struct interpreter *interp, const char *path)
{
    const char *at = buf_text(&interp->made), *end = at + interp->made.length;
    while (at < end && strcmp(at, path) != 0)
        at += strlen(at) + 1;
    return at < end;
}

void interpreter_note_kept(struct interpreter *interp, const char *path, enum file_mode mode)
{
    interp->keeps = mode == FILE_KEEP && interp->mode == MODE_LIVE && file_exists(path) &&
                    !file_is_folder(path);
}

enum err interpreter_will_write(struct interpreter *interp, const char *path, enum file_mode mode,
                                struct fault *fault)
{
    struct buf backup = {0};
    enum err err = OK;
    if (interpreter_is_wary(interp))
        limits_will_write();
    if (interp->writer && picture_writer_holds(interp->writer, path))
        picture_writer_wait(interp->writer, NULL, NULL); /* one after the other */
    if (interp->journal && interp->mode == MODE_LIVE)
        err = journal_catch_up(interp->journal, fault); /* what led to it is on the disk */
    if (err)
        return err;
    interpreter_note_kept(interp, path, mode);
    if (file_exists(path)) {
        if (mode == FILE_KEEP)
            return OK; /* the writer refuses */
        if (interpreter_is_wary(interp) && !has_made(interp, path))
            return fault_set(
                fault, ERR_IO,
                "%s was there before; a replay replaces only what it has written itself; "
                "it was left alone",
                path);
        err = file_backup(&backup, path, fault);
    }
    const size_t made = interpreter_is_wary(interp) ? strlen(path) + 1 : 0;
    if (!err && (!buf_reserve(&interp->written, strlen(path) + backup.length + 2) ||
                 (made && !buf_reserve(&interp->made, made)))) {
        if (backup.length)
            file_discard(buf_text(&backup));
        interp->made.failed =
            false; /* what it holds is whole; interpreter_settle_files clears the other */
        err = fault_memory(fault, "a file name");
    }
    if (!err) { /* there is room for all */
        buf_add(&interp->made, path, made);
        buf_add(&interp->written, path, strlen(path) + 1);
        buf_add(&interp->written, buf_text(&backup), backup.length + 1);
    }
    buf_release(&backup);
    return err;
}

/* Backups go when the command stands; else files are again what they were. */
void interpreter_settle_files(struct interpreter *interp, bool stands)
{
    const char *at = buf_text(&interp->written), *end = at + interp->written.length;
    while (at < end) {
        const char *path = at, *backup = path + strlen(path) + 1;
        at = backup + strlen(backup) + 1;
        if (stands && *backup)
            file_discard(backup);
        else if (!stands && *backup)
            file_restore(backup, path, NULL);
        else if (!stands)
            file_discard(path);
    }
    buf_clear(&interp->written);
}
