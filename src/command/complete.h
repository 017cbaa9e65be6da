/* SPDX-License-Identifier: MIT */
/* What may stand in a command that is being typed, and what may follow (complete.c). */
#ifndef COMMAND_COMPLETE_H
#define COMMAND_COMPLETE_H

#include <stddef.h>

#include "base/buf.h"

struct interpreter;

/* Words that may stand at the end of line[0..cursor), as they are to be typed, each ended by a line
 * feed, with a tab and what it means before that where there is something to say, and where they
 * begin. A folder ends in /, so that its files can follow. Files are those on
 * the disk now; names that a command cannot hold are left out. */
void command_complete(struct buf *out, size_t *word_start, const char *line, size_t cursor,
                      const struct interpreter *interp);

/* What may follow line[0..length), as usage has it: "X,Y,Z LABEL [radius=0..32]" after the name
 * of a command; nothing where that is not known. */
void command_hint(struct buf *out, const char *line, size_t length);

#endif
