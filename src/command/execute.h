/* SPDX-License-Identifier: MIT */
/*
 * The one way in for commands.
 *
 * Keyboard, script and replay all call interpreter_execute. A command is carried out, recorded (if
 * it changes something), and only then acknowledged; when the record cannot be written, the session
 * is taken back to before it, and so it is where the session's watch stops it.
 */
#ifndef COMMAND_EXECUTE_H
#define COMMAND_EXECUTE_H

#include "command/interpreter.h"

/* Carries one line out. `reply` is cleared first. An empty line or a comment does nothing, and
 * leaves reply->canonical empty. On error nothing has changed.
 *
 * What shows, writes or answers from labels (COMMAND_ANSWERS) first applies the edits that wait. A
 * question, which has no record, then has that of a run, RUN_FOR and its name. */
#define RUN_FOR "run for="
enum err interpreter_execute(struct interpreter *interp, const char *line, struct reply *reply,
                             struct fault *fault);
/* ---- sketches ---- */

/* Carries out a command of those that can be sketched (else ERR_USAGE) without recording it, so
 * that one sees what a pen draws before it is lifted: then the one command comes that all of it
 * stands for. No other command finds the sketch in place: it is dropped first, and the session is
 * what it was before, bit for bit. */
enum err interpreter_sketch(struct interpreter *interp, const char *line, struct fault *fault);

/* Fine where there is none. ERR_MEMORY leaves it in place. */
enum err interpreter_drop_sketch(struct interpreter *interp, struct fault *fault);

/* Adds one line that names the labels that the finish deletes, halves or breaks, where pictures
 * show finished labels, those are made, and no answer has named the label since it was last whole.
 * ERR_MEMORY, ERR_CANCELLED: then the next call looks again. */
enum err interpreter_write_losses(struct interpreter *interp, struct watch *watch, struct buf *out,
                                  struct fault *fault);

/* ---- looked at ---- */

/* Carries out a command that changes how one looks, or asks, and nothing else: it is in no journal
 * and no history, and the session's segmentation stays as it is. ERR_USAGE for any other. */
enum err interpreter_look(struct interpreter *interp, const char *line, struct reply *reply,
                          struct fault *fault);

/* Journals that are gone on with. */

/* Resumes the journal at `path`, and goes on recording there. Resuming skims: every
 * command changes seeds and settings, the forest is computed once, and compared with what the last
 * record says of it. Where that is not the same, the commands are carried out and compared one by
 * one, to say which of them differs. `told` gets lines for the user. */
enum err interpreter_resume_journal(struct interpreter *interp, const char *path, struct buf *told,
                                    struct fault *fault);

#endif
