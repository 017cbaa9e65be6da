/*
 * Commands without what names people: comments, and the names of files.
 *
 * A file becomes "scene" (what `open` opens) or "file-N", with its extension and, in a turntable,
 * its %03d; the same file keeps the same name. Every other word with a slash in it is taken for a
 * file too. Labels and golden images are named by the user's own words, and stay.
 */
#ifndef PROGRAM_ANONYMISE_H
#define PROGRAM_ANONYMISE_H

#include "base/buf.h"
#include "base/err.h"

/* Begins as {0}. */
struct anonymiser {
    struct buf names; /* of files met so far, in order, each ended by NUL */
};

void anonymiser_release(struct anonymiser *anonymiser);

/* Adds `command` without such names to `out`. */
void anonymise_command(struct anonymiser *anonymiser, struct buf *out, const char *command);

/* Adds the commands of a journal or script, one a line: journal_script (journal/journal.h) without
 * comments and names. */
enum err anonymise_script(struct buf *out, const char *bytes, size_t length, struct fault *fault);

#endif
