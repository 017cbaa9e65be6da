/*
 * The line in an editor of the user's choice: $VISUAL, else $EDITOR, on a file that nobody else can
 * read, which is gone afterwards.
 *
 * The words of the variable go to the shell, as `EDITOR="code --wait"` needs it. While the editor
 * runs the terminal is its own, as our caller found it; Ctrl-C and Ctrl-\ are for the editor alone.
 * Line feeds come back as blanks, other control characters not at all, so that nothing is
 * submitted.
 */
#ifndef TUI_PROMPT_OTHER_EDITOR_H
#define TUI_PROMPT_OTHER_EDITOR_H

#include "base/buf.h"
#include "base/err.h"

enum { OTHER_EDITOR_BYTES_MOST = 1 << 20 }; /* that are taken back */

/* Edits `text`, which is open and raw at the terminal before and after. An error leaves the text as
 * it was: ERR_USAGE without an editor, ERR_INPUT where it fails or hands back too much, ERR_IO. */
enum err edit_elsewhere(struct buf *text, struct fault *fault);

#endif
