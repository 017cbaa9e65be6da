/*
 * Golden images of commands that were not recorded.
 *
 * `golden` writes its image, whole, before its record: so a record has its golden image, at every
 * moment and after a loss of power. What a kill between the two leaves is a golden image without
 * a record: it is nothing. A verification passes over it, and the session that continues the
 * journal removes it.
 *
 * It is known by what it says itself: which journal it is of, unless the scene is private, and the
 * chain of the record before it. That record is in the journal, and what follows it there, if
 * anything, is no `golden`. All other files are left alone.
 */
#ifndef COMMAND_GOLDEN_LEFTOVER_H
#define COMMAND_GOLDEN_LEFTOVER_H

#include <stdbool.h>

#include "base/buf.h"
#include "base/err.h"

/* Whether the golden image at `path`, which no record of the journal names, is of such a command.
 * `bytes` are those of the journal. */
bool golden_is_leftover(const char *path, const char *journal_path, const char *bytes,
                        size_t length);

/* Removes those, each with its PNG, that lie beside a journal that is being continued, and says so.
 * `named` holds the names that records give, each ended by NUL. */
void golden_remove_leftovers(const char *journal_path, const struct buf *named, const char *bytes,
                             size_t length, struct buf *told);

/* Whether `file` is the NAME.exr of one of these names. */
bool golden_is_named(const struct buf *named, const char *file);

#endif
