/* SPDX-License-Identifier: MIT */
/*
 * Remove the words of commands that may name a person.
 *
 * A file becomes "scene" (the one opened by `open`) or "file-N", with its ending if that is a known
 * format, and with %03d in a turntable; the same file keeps the same name. Free text (the
 * description of a series, the name of a data set, names of files to skip) is left out with its
 * key. Numbers, choices, digests and the names of labels, landmarks, branches and golden images are
 * kept, since other commands use them.
 *
 * The table of commands decides (is_kept of session/setting.h): a word is kept only if its row says
 * so. A word that fits no parameter is kept if it is a number, and else becomes a file.
 */
#ifndef COMMAND_ANONYMISE_H
#define COMMAND_ANONYMISE_H

#include "base/buf.h"

/* Add a command of a journal or script, without its line feed. `names` is empty for the first one;
 * it keeps the files in order of appearance, each ended by NUL. */
void anonymise_command(struct buf *names, struct buf *out, const char *command);

#endif
