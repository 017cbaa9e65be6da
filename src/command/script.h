/*
 * Scripts: the lines of a file or pipe, carried out one after the other.
 *
 * Nothing here prints: a `struct printer` takes the lines.
 */
#ifndef COMMAND_SCRIPT_H
#define COMMAND_SCRIPT_H

#include <stdio.h>

#include "command/interpreter.h"

/* One line without its line feed; false at the end. Of a line that is too long for any command so
 * much is read that it stays too long. */
bool script_read_line(FILE *input, struct buf *line);

/* Whether a line goes into the journal with the command that follows: a comment or a blank line,
 * but no header of a journal. */
bool script_is_comment(const char *line);

struct printer {
    void *context;
    void (*print)(void *context, const char *text);          /* whole lines, to standard output */
    void (*warn)(void *context, const char *text);           /* whole lines, to standard error */
    void (*show)(void *context, struct interpreter *interp); /* the picture; may be NULL */
    /* Before a line is read, which may take any time, and after; may be NULL. */
    void (*waits)(void *context, bool waits);
};

/* Carries out the lines of `input`, whose name is `name` in messages. Each command is acknowledged
 * by "ok N COMMAND", once it is record N, by "ok - COMMAND" where it is none; its answer follows,
 * indented. The first error ends the run, unless `keep_going`; where the session's watch stops a
 * command, or is found to stop between two, it ends in any case: ERR_CANCELLED. *stopped is the
 * line that it ended at then, 0 where it came to the end. Result lines of a journal are skipped. */
enum err script_run(struct interpreter *interp, FILE *input, const char *name, bool keep_going,
                    const struct printer *printer, size_t *stopped, struct fault *fault);

/* "ok N COMMAND" or "ok - COMMAND", and the answer, for a command that was just carried out. */
void script_acknowledge(const struct interpreter *interp, const struct reply *reply,
                        const struct printer *printer);

#endif
