/* SPDX-License-Identifier: MIT */
/* Journals that are gone on with. */
#ifndef COMMAND_RESUME_H
#define COMMAND_RESUME_H

#include "command/interpreter.h"

/* Resumes the journal at `path`, and goes on recording there. Resuming skims: every
 * command changes seeds and settings, the forest is computed once, and compared with what the last
 * record says of it. Where that is not the same, the commands are carried out and compared one by
 * one, to say which of them differs. `told` gets lines for the user. */
enum err interpreter_resume_journal(struct interpreter *interp, const char *path, struct buf *told,
                                    struct fault *fault);

/* The same with every command carried out and compared. */
enum err interpreter_resume_in_full(struct interpreter *interp, const char *path, struct buf *told,
                                    struct fault *fault);

#endif
