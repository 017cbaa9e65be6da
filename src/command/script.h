/* SPDX-License-Identifier: MIT */
/*
 * Scripts: the lines of a file or pipe, executed in order.
 *
 * Nothing here prints: a `struct printer` receives the lines.
 *
 * An interrupted run continues after its last record. A session has one scene, so a script that
 * opens a scene cannot be added to a journal that already has one: it must be the script that the
 * journal was recorded from. Its lines are compared with the records in canonical form, with the
 * names that labels had at that record; a line that led to the next record is not executed again.
 * After the last record the script continues as usual. If a line and its record differ, nothing is
 * executed: one of the files was changed.
 *
 *     script                  journal
 *     open a.nii              open a.nii weight=morph       added by the record (`added`)
 *     seed 1,2,3 liver        seed 1,2,3 2
 *     stats                   run for=stats                 edits applied by a question
 *     zoom fit                zoom 2.5 at=9,9,9             result of the command (`comes_to`)
 *     seed 4,5,6 liver                                      continues here
 */
#ifndef COMMAND_SCRIPT_H
#define COMMAND_SCRIPT_H

#include <stdio.h>

#include "command/interpreter.h"

struct printer {
    void *context;
    void (*print)(void *context, const char *text);          /* whole lines, to standard output */
    void (*warn)(void *context, const char *text);           /* whole lines, to standard error */
    void (*show)(void *context, struct interpreter *interp); /* shows the picture; may be NULL */
    /* Called before and after reading a line, which may take any time; may be NULL. */
    void (*waits)(void *context, bool waits);
};

/* Execute the lines of `input`, which messages call `name`. Each command is acknowledged by "ok N
 * COMMAND", if it is record N, or by "ok - COMMAND"; its answer follows, indented. The first error
 * ends the run, unless `keep_going`. If the session's watch stops, the run ends in any case:
 * ERR_CANCELLED. *stopped is the line at which the run ended, 0 at the end of the script. Result
 * lines of a journal are skipped. Return the first error. */
enum err script_run(struct interpreter *interp, FILE *input, const char *name, bool keep_going,
                    const struct printer *printer, size_t *stopped, struct fault *fault);

/* True if the rest of `input` opens a scene; the position of `input` is restored. False also if
 * that is impossible; *knows is false then. */
bool script_opens_scene(FILE *input, bool *knows);

/* Print "ok N COMMAND" or "ok - COMMAND", and the answer of a command that was just executed. */
void script_acknowledge(const struct interpreter *interp, const struct reply *reply,
                        const struct printer *printer);

#endif
