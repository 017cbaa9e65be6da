/* SPDX-License-Identifier: MIT */
/*
 * What `Tab` finds by a piece of a word: commands and choices (command/find.h), each with the key
 * of the pilot that does it, and keys that are no command's.
 */
#ifndef PROGRAM_FINDING_H
#define PROGRAM_FINDING_H

#include "base/buf.h"
#include "tui/pilot/pilot_keys.h"

/* Adds to the words that begin with the piece, as candidates of the line editor, and adds keys to
 * what all of them mean. */
void finding_add(struct buf *words, const char *piece, const struct pilot_setup *setup);

#endif
