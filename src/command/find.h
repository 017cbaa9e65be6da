/* SPDX-License-Identifier: MIT */
/*
 * Commands by a piece of what one remembers of them: of a name, as `file` is of seed-file, of a
 * choice, as `cont` of `overlay contour`, of a key, or of the words that say what they do.
 */
#ifndef COMMAND_FIND_H
#define COMMAND_FIND_H

#include <stdbool.h>

#include "base/buf.h"

enum { COMMANDS_FOUND_MOST = 8 };

/* Adds them, the best first, as command_complete does: what is to be typed, a tab, what it means,
 * and a line feed. Not those whose names begin with the piece; where there `are_some`, only what is
 * a piece of a name or of a choice. */
void command_find_by_piece(struct buf *out, const char *piece, bool are_some);

#endif
