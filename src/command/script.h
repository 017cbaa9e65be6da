/* SPDX-License-Identifier: MIT */
/*
 * Scripts: the lines of a file or pipe, carried out one after the other.
 *
 * Nothing here prints: a `struct printer` takes the lines.
 *
 * A run that was interrupted goes on after its last record. A session has one scene, so a script
 * that opens one can add nothing to a journal that has its scene already: it must be the script
 * that the journal was recorded from. Its lines are then taken one by one beside the records, in
 * canonical form, names of labels as they were there; a line that led to the next record is not
 * carried out again. After the last record the script goes on as any other. Where a line and the
 * record differ, nothing is carried out at all: somebody has changed one of them.
 *
 *     script                  journal
 *     open a.nii              open a.nii weight=morph       what a record adds (`added`)
 *     seed 1,2,3 liver        seed 1,2,3 2
 *     stats                   run for=stats                 what a question has applied
 *     zoom fit                zoom 2.5 at=9,9,9             what it came to (`comes_to`)
 *     seed 4,5,6 liver                                      goes on here
 */
#ifndef COMMAND_SCRIPT_H
#define COMMAND_SCRIPT_H

#include <stdio.h>

#include "command/interpreter.h"

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

/* Whether the rest of `input`, or all from where it stands, opens a scene; it is put back to where
 * it stood. False also where that cannot be done: *knows says which. */
bool script_opens_scene(FILE *input, bool *knows);

/* "ok N COMMAND" or "ok - COMMAND", and the answer, for a command that was just carried out. */
void script_acknowledge(const struct interpreter *interp, const struct reply *reply,
                        const struct printer *printer);

#endif
