/*
 * The replay of a journal by an interpreter, under the limits for journals that somebody else may
 * have written (sandbox/limits.h), and what its report says in words.
 */
#ifndef VERIFY_REPLAY_FILE_H
#define VERIFY_REPLAY_FILE_H

#include "command/script.h"
#include "journal/replay.h"
#include "verify/timing.h"

/* Carries the journal out and compares the results, and by the interpreter's judge golden images,
 * of records `first` to `last`; 0 for all. Each command is acknowledged, unless `printer` is NULL,
 * and timed, unless `timing` is. `report` begins as {0}, and is to be released whatever is
 * returned. */
enum err replay_file(struct interpreter *interp, const char *path, size_t first, size_t last,
                     const struct printer *printer, struct timing *timing,
                     struct replay_report *report, struct fault *fault);

/* Adds what is wrong as lines that begin with "# ", safe to print; none where all is well. `fault`
 * is that of the replay. */
void replay_describe(struct buf *text, const struct replay_report *report,
                     const struct fault *fault);

/* The program `replay`: acknowledges every command, compares every result, and sums up. */
enum err replay_aloud(struct interpreter *interp, const char *path, const struct printer *printer,
                      struct fault *fault);

#endif
