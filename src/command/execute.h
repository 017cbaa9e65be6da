/* SPDX-License-Identifier: MIT */
/*
 * The single entry point for commands.
 *
 * Prompt, scripts, the pilot and replay all call interpreter_execute. A command is executed,
 * recorded (if it changes something), and only then acknowledged. If the record cannot be written,
 * or the session's watch stops the command, the session is restored to its state before.
 */
#ifndef COMMAND_EXECUTE_H
#define COMMAND_EXECUTE_H

#include "command/interpreter.h"

/* Execute one line. `reply` is cleared first. An empty line or a comment does nothing and leaves
 * reply->canonical empty. On error nothing has changed.
 *
 * Commands that show, write or answer from labels (COMMAND_ANSWERS) first apply the pending edits.
 * A question has no record; if it applied edits, a run is recorded: RUN_FOR and its name. */
#define RUN_FOR "run for="
enum err interpreter_execute(struct interpreter *interp, const char *line, struct reply *reply,
                             struct fault *fault);

/* ---- sketches ---- */

/* Execute a command that can be sketched (else ERR_USAGE) without recording it, to show the line of
 * a pen before it is lifted; a single command for all of it follows. Before any other command the
 * sketch is dropped, and the session is restored bit for bit. */
enum err interpreter_sketch(struct interpreter *interp, const char *line, struct fault *fault);

/* Drop the sketch, if there is one. ERR_MEMORY leaves it in place. */
enum err interpreter_drop_sketch(struct interpreter *interp, struct fault *fault);

/* Add one line with the labels that the finish deletes, halves or breaks, if pictures show finished
 * labels, these have been computed, and no answer has named the label since it was last whole.
 * After ERR_MEMORY or ERR_CANCELLED the next call tries again. */
enum err interpreter_write_losses(struct interpreter *interp, struct watch *watch, struct buf *out,
                                  struct fault *fault);

/* ---- questions and views that are not recorded ---- */

/* Execute a command that only changes the view or answers a question. It is in no journal and no
 * history, and the segmentation does not change. ERR_USAGE for any other command. */
enum err interpreter_look(struct interpreter *interp, const char *line, struct reply *reply,
                          struct fault *fault);

/* ---- resuming journals ---- */

/* Resume the journal at `path` and continue recording there. Resuming skims: commands only change
 * seeds and settings; the forest is computed once and compared with the last record about it. If
 * they differ, all commands are executed and compared one by one to find the first that differs.
 * `told` receives lines for the user. */
enum err interpreter_resume_journal(struct interpreter *interp, const char *path, struct buf *told,
                                    struct fault *fault);

#endif
