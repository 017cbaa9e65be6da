/* SPDX-License-Identifier: MIT */
/*
 * Commands without the words that may name a person.
 *
 * A file becomes "scene" (the one that `open` opens) or "file-N", with its ending, where that is of
 * a format, and, in a turntable, its %03d; the same file keeps the same name. Free text (the
 * description of a series, the name of a data set, names of files to skip) is left out with its
 * key. Numbers, choices, digests and the names of labels, landmarks, branches and golden images
 * stay, since other commands use them.
 *
 * The table of commands decides (is_kept of session/setting.h): a word stays only where its row
 * says so. A word that no parameter takes is left as a number or becomes a file.
 */
#ifndef COMMAND_ANONYMISE_H
#define COMMAND_ANONYMISE_H

#include "base/buf.h"

struct anonymiser {
    struct buf names; /* of files met so far, in order, each ended by NUL */
};
void anonymiser_release(struct anonymiser *anonymiser);

/* Adds a command of a journal or script, without its line feed. */
void anonymise_command(struct anonymiser *anonymiser, struct buf *out, const char *command);

#endif
