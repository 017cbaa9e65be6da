/* SPDX-License-Identifier: MIT */
/* What programs begin and end with: an interpreter as the options want it, and the walls around a
 * journal that may be a stranger's. */
#ifndef PROGRAM_BEGIN_H
#define PROGRAM_BEGIN_H

#include "command/interpreter.h"
#include "image/volume_format.h"
#include "program/program.h"

/* With the scene, folder and journal of the options. Lines about a journal that is resumed go to
 * standard error. To be released, whatever is returned. */
enum err begin_interpreter(struct interpreter *interp, const struct options *o,
                           struct fault *fault);

/* Has a large scene that is opened from now on wait for the first command that looks at it: for
 * programs that carry out commands one by one, and look at voxels in no other way. */
void begin_to_wait(struct interpreter *interp);

/* The scene or journal that a session is to begin with, or NULL, and whether it is a journal, which
 * is resumed then. ERR_USAGE, ERR_INPUT and ERR_IO for options that do not go with it. */
enum err begin_check(const struct options *o, const char **first, bool *resumes,
                     struct fault *fault);

/* The volume of a file of the command line, by its number there from 0, as --volume has it. */
struct volume_choice begin_volume(const struct options *o, size_t which);

/* NAME-N.iftty for the first N that is free here: where a session records that begins with `first`,
 * or with NULL, and was given no journal. */
void begin_journal_name(struct buf *journal, const char *first);

/* Syncs what the journal has not synced yet, when a session ends that ends with `err`. */
enum err end_journal(struct interpreter *interp, enum err err, struct fault *fault);

/* Before anything is carried out that a journal says: the limits of the options, and the kernel's
 * walls. `written` is a folder that may be written, or NULL. */
enum err begin_confined(const struct options *o, const char *journal, const char *written,
                        struct fault *fault);

/* The same in the process that verifies one journal, where `context` is the options. */
enum err begin_one(void *context, const char *journal, struct fault *fault);

#endif
