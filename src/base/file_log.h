/* SPDX-License-Identifier: MIT */
/*
 * A file that grows, has one writer, and is synced in a mode that its owner sets.
 *
 * The mode decides the guarantee of an append:
 *   always  its bytes and all earlier ones are on the disk when it returns; an append that
 *           `may_wait` is synced as in `second`;
 *   second  a thread syncs within a second: a loss of power may lose the last second;
 *   off     the operating system syncs at any time; file_log_sync and closing the log also sync.
 * In each mode a killed process loses nothing, since the operating system has the bytes.
 *
 * Invariants
 *   G1 a failed append is cut off again, so that the file never has a part of it. Nothing is
 *      appended until this truncation is on the disk: otherwise rejected bytes could reappear after
 *      a loss of power, or remain after a shorter append;
 *   G2 nothing is appended to a file that is no longer at its path (deleted, moved, replaced), nor
 *      to one whose length another process has changed; the owner, who knows the content, can check
 *      for writes (file_log_was_touched);
 *   G3 after a failed sync, a second sync proves nothing, since systems drop pages that they could
 *      not write. The bytes after `synced` are written again (file_log_rewrite) before any append;
 *   G4 one writer at a time.
 *
 * Apart from its own thread, a log is used by one thread.
 */
#ifndef BASE_FILE_LOG_H
#define BASE_FILE_LOG_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/buf.h"
#include "base/err.h"

/* The names of the modes, in the order of the enum. */
#define FILE_SYNC_WORDS "always|everysec|off"
enum file_sync { FILE_SYNC_ALWAYS, FILE_SYNC_EVERY_SECOND, FILE_SYNC_OFF };

struct file_log;

/* Open `path` for appending. With `create` it is created (and its folder synced), and an existing
 * file is refused. Locks the file: a second writer gets ERR_IO and the name of the holder. The
 * content of an existing file is synced, in case its last writer did not. On success the caller
 * closes *log. The mode is `always` at first. */
enum err file_log_open(struct file_log **log, const char *path, bool create, struct fault *fault);

/* Append, and sync according to the mode; a `may_wait` append is synced by the thread if there is
 * one. On failure the file is cut back to its former length; if that fails too it is ragged, and
 * the caller has to call file_log_cut (G1). */
enum err file_log_append(struct file_log *log, const void *bytes, size_t length, bool may_wait,
                         struct fault *fault);

bool file_log_is_ragged(const struct file_log *log);

/* Cut the file to `length` bytes and sync. */
enum err file_log_cut(struct file_log *log, uint64_t length, struct fault *fault);

/* Sync all appended bytes; after ERR_IO the log is in doubt (G3). */
enum err file_log_sync(struct file_log *log, struct fault *fault);

/* Return true if a sync, this one or the thread's, has failed and nothing was rewritten since. */
bool file_log_is_in_doubt(struct file_log *log);

/* Write again and sync the bytes that may not be on the disk. `bytes` is the whole content, as
 * appended. */
enum err file_log_rewrite(struct file_log *log, const char *bytes, struct fault *fault);

/* Change the mode. For `always` everything is synced first; on failure the mode is unchanged. */
enum err file_log_set_sync(struct file_log *log, enum file_sync sync, struct fault *fault);

/* Return true if the times of the file differ from those after our last write: another process may
 * have written to it, or the file system has corrected them. The owner calls file_log_note_times
 * after verifying the content. A write within the same tick of the system's clock as ours (4 ms on
 * some systems) is not detected. */
bool file_log_was_touched(const struct file_log *log);
void file_log_note_times(struct file_log *log);

/* Return the path of the lock file, if the file system has no locks; otherwise NULL. */
const char *file_log_lock_file(const struct file_log *log);

uint64_t file_log_length(const struct file_log *log);

/* Sync unsynced bytes, if possible; call file_log_sync before to learn of a failure. NULL
 * is fine. */
void file_log_close(struct file_log *log);

/*
 * The lock of a file that one process writes.
 *
 * It is the system's lock (flock), which ends with the process, so a crash leaves nothing stale. A
 * child process holds it too until it executes its own program, so we wait for it, up to
 * FILE_LOCK_PATIENCE_MS.
 *
 * Some file systems have no locks (NFS without its lock daemon, some FUSE). There a file FILE.lock
 * is created, which must not exist, and which names its process (owner_write in base/file.h) and
 * machine. It is removed if its process is known to have ended; otherwise it stays, and the error
 * names it.
 */

enum { FILE_LOCK_PATIENCE_MS = 250 };

struct file_lock {
    char *path; /* path of FILE.lock, if that is the lock; otherwise NULL */
};

/* Lock the open file at `path`. ERR_IO, with the name of the holder. */
enum err file_lock_take(struct file_lock *lock, int fd, const char *path, struct fault *fault);

/* Release the lock, if it was taken. The system's lock ends when the descriptor is closed. */
void file_lock_release(struct file_lock *lock);

/*
 * A file of lines that several processes append to at once, such as a history. Lines are written,
 * not synced.
 *
 * Invariants
 *   I1 a line is appended whole, and on a line of its own, whatever other processes do meanwhile or
 *      left unfinished.
 *   I2 no line is lost except by trimming, which removes the oldest. Append and trim hold a system
 *      lock, and after waiting for it check that the file is still the one at the path.
 *   I3 a stopped process that holds the lock delays a line by at most file_lines_patience_ms. The
 *      line is then appended without the lock, and again if the file at the path has changed after
 *      that; trimming copies lines that were appended to the old file while it wrote the new one.
 *      So a line may appear twice, but is never lost. (Exception: a trimming process is stopped for
 *      longer than that, and then killed between its rename and its copy.)
 *   I4 a new file is readable by its owner alone; anything but a regular file is refused
 *      (ERR_INPUT).
 *   I5 without file system locks, appending works as in I3, and one process at a time trims: the
 *      one that created FILE.lock.
 */

/* Time to wait for a lock. Tests shorten it. */
extern unsigned file_lines_patience_ms;

/* Append `line`, which has no line feed. Creates the file if it is missing. */
enum err file_lines_append(const char *path, const char *line, size_t length, struct fault *fault);

/* Read the whole lines among the last `bytes_most` bytes; none if there is no file. */
enum err file_lines_read(struct buf *out, const char *path, size_t bytes_most, struct fault *fault);

/* Remove all but the last `lines_most` lines, of at most `bytes_most` bytes. A smaller file is
 * unchanged, and so is one that cannot be locked. */
enum err file_lines_trim(const char *path, size_t lines_most, size_t bytes_most,
                         struct fault *fault);

/* Return the start of the last `lines` lines of a text. */
const char *file_lines_last(const char *text, size_t length, size_t lines);

#endif
