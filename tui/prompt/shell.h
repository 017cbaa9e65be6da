/* SPDX-License-Identifier: MIT */
/* Programs that the user has chosen, which own the terminal while they run: $EDITOR, $PAGER. */
#ifndef TUI_PROMPT_SHELL_H
#define TUI_PROMPT_SHELL_H

#include <stdbool.h>

#include "base/buf.h"
#include "base/err.h"

/* Run a shell command with an argument "$1", and with a text on its standard input or NULL. Wait
 * for its end: *status is that of waitpid. Ctrl-C and Ctrl-\ affect the command alone. It need not
 * read all of the text. ERR_IO if it cannot be started. */
enum err shell_run(const char *command, const char *argument, const struct buf *input, int *status,
                   struct fault *fault);

/* Return true if a status means that the shell has not found the command, or cannot run it. */
bool shell_has_none(int status);

#endif
