/*
 * What drives a desk without a keyboard: scripts, replays, and the verification of journals.
 *
 * Nothing here prints: a `struct teller` takes the lines. Each returns the error that the program's
 * exit status comes from.
 */
#ifndef COMMAND_DRIVE_H
#define COMMAND_DRIVE_H

#include <stdio.h>

#include "command/desk.h"

struct teller {
    void *context;
    void (*say)(void *context, const char *text);      /* whole lines, to standard output */
    void (*complain)(void *context, const char *text); /* whole lines, to standard error */
    void (*picture)(void *context, struct desk *desk); /* to be shown; may be NULL */
    /* Before a line is read, which may take for ever, and after; may be NULL. */
    void (*waits)(void *context, bool waits);
};

/* Carries out the lines of `input`, whose name is `name` in messages. Each command is acknowledged
 * by "ok N COMMAND", once it is recorded; what it answers follows, indented. The first error ends
 * the run, unless `keep_going`; where the watch of the session stops a command, or is found to stop
 * between two, it ends in any case: ERR_CANCELLED. Result lines of a journal are skipped. */
enum err drive_script(struct desk *desk, FILE *input, const char *name, bool keep_going,
                      const struct teller *teller, struct fault *fault);

/* Replays a journal, telling each command, and compares every result. */
enum err drive_replay(struct desk *desk, const char *path, const struct teller *teller,
                      struct fault *fault);

/* Replays journals, each at a desk of its own, and compares every result and golden image. Tells
 * TAP. ERR_CHECK when any differs. */
enum err drive_verify(char *const *paths, int count, const char *scene_path, const char *out_folder,
                      const struct teller *teller, struct fault *fault);

#endif
