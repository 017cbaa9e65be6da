/*
 * A file of lines that several processes append to at once, such as a history. Nobody is told that
 * a line is on the disk, so nothing waits for one.
 *
 * Invariants
 *   I1 a line is appended whole, and on a line of its own, whatever others do meanwhile or left
 *      half done;
 *   I2 trimming keeps the last lines, also those that others append while it is at it: both hold
 *      a lock of the system, and whoever has waited for one looks whether the file is still the
 *      one at the path;
 *   I3 a file that is made is for its owner alone; what is no regular file is refused (ERR_INPUT).
 */
#ifndef BASE_FILE_LINES_H
#define BASE_FILE_LINES_H

#include <stddef.h>

#include "base/buf.h"
#include "base/err.h"

/* `line` has no line feed. The file is made where there is none. */
enum err file_lines_append(const char *path, const char *line, size_t length, struct fault *fault);

/* The whole lines among the last `bytes_most` bytes; none where there is no file. */
enum err file_lines_read(struct buf *out, const char *path, size_t bytes_most, struct fault *fault);

/* Keeps the last `lines_most` lines, of at most `bytes_most` bytes; a smaller file is left as it
 * is, and so is one whose lock cannot be had. */
enum err file_lines_trim(const char *path, size_t lines_most, size_t bytes_most,
                         struct fault *fault);

/* The last `lines` lines of a text. */
const char *file_lines_last(const char *text, size_t length, size_t lines);

#endif
