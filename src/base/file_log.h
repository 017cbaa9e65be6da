/* SPDX-License-Identifier: MIT */
/*
 * A file that grows, has one writer, and is synced as its owner wants it.
 *
 * What is promised of an append depends on when the file is synced:
 *   always  its bytes are on the disk when it returns, with all before them; those of one that
 *           `may_wait` are as of `second`;
 *   second  a thread syncs at most a second later: a loss of power may take the last second;
 *   off     whenever the system does, a `file_log_sync` asks for it, or the log is closed.
 * In all three a process that is killed loses nothing: the bytes are the system's by then.
 *
 * Invariants
 *   G1 a failed append is cut off again, so that the file never holds half of it. Nothing is
 *      appended until that cut is on the disk: else bytes that were refused could be back after a
 *      loss of power, or stand after a shorter append;
 *   G2 nothing is appended to a file that is not at its path any more (deleted, moved, replaced),
 *      nor to one that another process has made longer or shorter; the owner, who knows the
 *      content, can ask whether it may have been written to (file_log_was_touched);
 *   G3 a sync that has failed is never repeated and believed: systems forget what they could
 *      not write. What stands after `synced` is written anew (file_log_rewrite) before anything
 *      else is appended;
 *   G4 one writer at a time.
 *
 * Apart from the thread inside, a log belongs to one thread.
 */
#ifndef BASE_FILE_LOG_H
#define BASE_FILE_LOG_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/buf.h"
#include "base/err.h"

/* Their names, in the order of the enum. */
#define FILE_SYNC_WORDS "always|everysec|off"
enum file_sync { FILE_SYNC_ALWAYS, FILE_SYNC_EVERY_SECOND, FILE_SYNC_OFF };

struct file_log;

/* Opens `path` for appending, creating it (and syncing its folder) where `create` is set and
 * refusing an existing one then. Takes the lock: a second writer gets ERR_IO and words that say who
 * holds it. What stands in a file that is opened is synced, whatever became of its last writer.
 * On success *log is to be closed by the caller; it syncs always. */
enum err file_log_open(struct file_log **log, const char *path, bool create, struct fault *fault);

/* Syncs the folder that holds the file: it can be found after a loss of power. */
enum err file_log_sync_folder(const struct file_log *log, struct fault *fault);

/* Appends, and syncs as was asked for; what `may_wait`, where there is a thread to sync it. On
 * failure the file is cut back to its former length; where even that fails it is ragged, and
 * file_log_cut is to be tried again (G1). */
enum err file_log_append(struct file_log *log, const void *bytes, size_t length, bool may_wait,
                         struct fault *fault);

bool file_log_is_ragged(const struct file_log *log);

/* Cuts the file to `length` bytes and syncs. */
enum err file_log_cut(struct file_log *log, uint64_t length, struct fault *fault);

/* All that was appended is on the disk, or ERR_IO; then the log is in doubt (G3). */
enum err file_log_sync(struct file_log *log, struct fault *fault);

/* A sync has failed, this one or that of the thread, and nothing was rewritten since. */
bool file_log_is_in_doubt(struct file_log *log);

/* Writes again what may not be on the disk, and syncs it. `bytes` is the whole content, as it was
 * appended. */
enum err file_log_rewrite(struct file_log *log, const char *bytes, struct fault *fault);

/* From now on syncs so. Towards `always` everything is synced first; on failure it is as it was. */
enum err file_log_set_sync(struct file_log *log, enum file_sync sync, struct fault *fault);

/* Whether the times of the file are others than after the last write of ours: somebody else may
 * have written to it, or the file system has corrected them. file_log_note_times once the content
 * was found to be what it should be. A write within the same tick of the system's clock as ours
 * (4 ms, on some) is not seen. */
bool file_log_was_touched(const struct file_log *log);
void file_log_note_times(struct file_log *log);

/* The file that stands for a lock, where the file system has none; or NULL. */
const char *file_log_lock_file(const struct file_log *log);

uint64_t file_log_length(const struct file_log *log);

/* Syncs what waits, as far as that is possible; call file_log_sync first to know whether it was.
 * NULL is fine. */
void file_log_close(struct file_log *log);

/*
 * The lock of a file that one process writes.
 *
 * It is the system's (flock), which ends with the process, so that a crash leaves nothing stale. A
 * child that is just being started holds it along until it runs its own program: so it is waited
 * for, FILE_LOCK_PATIENCE_MS and no longer.
 *
 * Some file systems have no locks (NFS without its lock daemon, some of FUSE). There a file
 * FILE.lock is made, which must not exist, and names its process (base/file.h) and machine. One
 * whose process has ended, as far as that can be seen from here, is taken away; another is left,
 * with words that name it.
 */

enum { FILE_LOCK_PATIENCE_MS = 250 };

struct file_lock {
    char *path; /* of FILE.lock, where that is the lock, or NULL */
};

/* Locks the open file, which lies at `path`. ERR_IO, with words that say who holds it. */
enum err file_lock_take(struct file_lock *lock, int fd, const char *path, struct fault *fault);

/* Fine where it was not taken. The system's lock goes with the descriptor. */
void file_lock_release(struct file_lock *lock);

/*
 * A file of lines that several processes append to at once, such as a history. A line is written,
 * not synced: no caller is promised that it is on the disk.
 *
 * Invariants
 *   I1 a line is appended whole, and on a line of its own, whatever other processes do meanwhile
 *      or left half done.
 *   I2 no line is lost but by trimming, which removes the oldest. Both append and trim hold a lock
 *      of the system, and after waiting for it check that the file is still the one at the path.
 *   I3 a process that holds the lock and does not go on (it was stopped) delays a line by
 *      file_lines_patience_ms and no more. The line is then appended without the lock, and once
 *      more where the file at the path has changed after that; trimming copies what was appended
 *      to the old file while it wrote the new one. So a line may then be there twice, never not.
 *      (What remains: a process that trims is stopped for longer than that, and then killed
 *      between its renaming and its copying.)
 *   I4 a file that is made is for its owner alone; what is no regular file is refused (ERR_INPUT).
 *   I5 where the file system has no locks, appending is as in I3, and one process at a time trims:
 *      the one that has made FILE.lock (base/file_log.h).
 */

/* How long a lock is waited for. A test shortens it. */
extern unsigned file_lines_patience_ms;

/* `line` has no line feed. The file is made where there is none. */
enum err file_lines_append(const char *path, const char *line, size_t length, struct fault *fault);

/* The whole lines among the last `bytes_most` bytes; none where there is no file. */
enum err file_lines_read(struct buf *out, const char *path, size_t bytes_most, struct fault *fault);

/* Removes all but the last `lines_most` lines, of at most `bytes_most` bytes; a smaller file is
 * left as it is, and so is one whose lock cannot be had. */
enum err file_lines_trim(const char *path, size_t lines_most, size_t bytes_most,
                         struct fault *fault);

/* The last `lines` lines of a text. */
const char *file_lines_last(const char *text, size_t length, size_t lines);

#endif
