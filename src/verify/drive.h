/*
 * What drives an interpreter without a keyboard: scripts and replays. Verification is in verify.h.
 *
 * Nothing here prints: a `struct teller` takes the lines. Each returns the error that the program's
 * exit status comes from.
 */
#ifndef VERIFY_DRIVE_H
#define VERIFY_DRIVE_H

#include <stdio.h>

#include "command/interpreter.h"
#include "journal/replay.h"

struct teller {
    void *context;
    void (*say)(void *context, const char *text);      /* whole lines, to standard output */
    void (*complain)(void *context, const char *text); /* whole lines, to standard error */
    void (*picture)(void *context, struct interpreter *interp); /* to be shown; may be NULL */
    /* Before a line is read, which may take for ever, and after; may be NULL. */
    void (*waits)(void *context, bool waits);
};

/* Carries out the lines of `input`, whose name is `name` in messages. Each command is acknowledged
 * by "ok N COMMAND", once it is recorded; what it answers follows, indented. The first error ends
 * the run, unless `keep_going`; where the watch of the session stops a command, or is found to stop
 * between two, it ends in any case: ERR_CANCELLED. Result lines of a journal are skipped. */
enum err drive_script(struct interpreter *interp, FILE *input, const char *name, bool keep_going,
                      const struct teller *teller, struct fault *fault);

/* Replays a journal, telling each command, and compares every result. */
enum err drive_replay(struct interpreter *interp, const char *path, const struct teller *teller,
                      struct fault *fault);

/* The same for whoever looks at the report: quietly where `teller` is NULL, comparing results (and,
 * where the interpreter does so, golden images) of records `first` to `last` only; 0 for all. */
enum err drive_file(struct interpreter *interp, const char *path, size_t first, size_t last,
                    const struct teller *teller, struct replay_report *report, struct fault *fault);

/* What the report of a replay says, as lines that begin with "# ", safe to print; none where all is
 * well. `fault` is that of the replay. */
void drive_tell(struct buf *text, const struct replay_report *report, const struct fault *fault);

#endif
