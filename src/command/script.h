/*
 * Scripts: the lines of a file or pipe, carried out one after the other.
 *
 * Nothing here prints: a `struct teller` takes the lines.
 */
#ifndef COMMAND_SCRIPT_H
#define COMMAND_SCRIPT_H

#include <stdio.h>

#include "command/interpreter.h"

struct teller {
    void *context;
    void (*say)(void *context, const char *text);      /* whole lines, to standard output */
    void (*complain)(void *context, const char *text); /* whole lines, to standard error */
    void (*picture)(void *context, struct interpreter *interp); /* to be shown; may be NULL */
    /* Before a line is read, which may take any time, and after; may be NULL. */
    void (*waits)(void *context, bool waits);
};

/* Carries out the lines of `input`, whose name is `name` in messages. Each command is acknowledged
 * by "ok N COMMAND", once it is recorded; its answer follows, indented. The first error ends the
 * run, unless `keep_going`; where the session's watch stops a command, or is found to stop between
 * two, it ends in any case: ERR_CANCELLED. Result lines of a journal are skipped. */
enum err script_run(struct interpreter *interp, FILE *input, const char *name, bool keep_going,
                    const struct teller *teller, struct fault *fault);

/* "ok N COMMAND" and the answer, for a command that was just carried out. */
void script_acknowledge(const struct interpreter *interp, const struct reply *reply,
                        const struct teller *teller);

#endif
