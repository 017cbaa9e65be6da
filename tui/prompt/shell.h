/* SPDX-License-Identifier: MIT */
/* Programs of the user's choice, which have the terminal while they run: $EDITOR, $PAGER. */
#ifndef TUI_PROMPT_SHELL_H
#define TUI_PROMPT_SHELL_H

#include <stdbool.h>

#include "base/buf.h"
#include "base/err.h"

/* Runs a command of the shell, with an argument "$1" and a text on its standard input, or NULL, and
 * waits for its end: *status is that of waitpid. Ctrl-C and Ctrl-\ are for the command alone. It
 * need not read all of the text. ERR_IO where it cannot be started. */
enum err shell_run(const char *command, const char *argument, const struct buf *input, int *status,
                   struct fault *fault);

/* Return true if a status means that the shell has no such command, or cannot run it. */
bool shell_has_none(int status);

#endif
