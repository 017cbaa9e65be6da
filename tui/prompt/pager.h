/* SPDX-License-Identifier: MIT */
/*
 * Show a text that is longer than the screen: in the user's pager, else by pages.
 *
 * The shell runs the command in $PAGER, `PAGER="less -R"` for example. LESSSECURE=1 is in its
 * environment, so that less starts no other program and opens no file. Only a session whose journal
 * the user trusts may use it (line_editor.pager); otherwise, and if it cannot be started, pages end
 * in a row "-- more --": q, Escape, Ctrl-C and Ctrl-D leave, any other key shows the next page.
 */
#ifndef TUI_PROMPT_PAGER_H
#define TUI_PROMPT_PAGER_H

#include <stdbool.h>
#include <stddef.h>

#include "base/buf.h"
#include "base/err.h"
#include "tui/prompt/line_edit.h"
#include "tui/term.h"

#define PAGER_MORE "\033[7m-- more --\033[m"

/* Return the end of the page that begins at `at`, before text->length: as many lines of a text
 * wrapped by cells_wrap as fit the screen above its last row, at least one. A word that is wider
 * than the screen has several rows. */
size_t pager_page_end(const struct buf *wrapped, size_t at, const struct term_size *size);

bool pager_is_left_by(const struct key_event *event);

/* Show the text in the user's pager. The terminal is restored meanwhile, and raw again afterwards.
 * Return false without a pager, or if it cannot be started. */
bool pager_run(const char *pager, const struct buf *text);

/* Show `text`, lines that are safe to print, at the prompt. Set *paged to false if nothing was
 * shown: if the text fits the screen, or if keys are waiting, which are for the prompt. A paste
 * leaves the pager and is inserted whole at the prompt. The terminal is open and raw. */
enum err page_text(struct line_editor *e, const struct buf *text, bool *paged, struct fault *fault);

#endif
