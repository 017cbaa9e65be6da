/* SPDX-License-Identifier: MIT */
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
#ifndef BASE_FILE_LINES_H
#define BASE_FILE_LINES_H

#include <stddef.h>

#include "base/buf.h"
#include "base/err.h"

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
