/* SPDX-License-Identifier: MIT */
/*
 * Show a text that is longer than the screen: by the user's pager, else by pages.
 *
 * The pager is the words of $PAGER, for the shell, as in `PAGER="less -R"`. LESSSECURE=1 is in its
 * environment, so that less starts no other program and opens no file. Only a session without a
 * stranger's journal may name one (line_editor.pager); otherwise, and if it cannot be started,
 * pages end in a row "-- more --": q, Escape, Ctrl-C and Ctrl-D leave, any other key shows the next
 * page.
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

/* The end of the page that begins at `at`, before text->length: lines of a text wrapped by
 * cells_wrap that fit the screen above a last row, at least one. A word that is wider than the
 * screen has several rows. */
size_t pager_page_end(const struct buf *wrapped, size_t at, const struct term_size *size);

bool pager_is_left_by(const struct key_event *event);

/* Has the user's pager show the text, at a terminal that is as we found it meanwhile and raw
 * again afterwards. False where there is no pager, or it cannot be started. */
bool pager_run(const char *pager, const struct buf *text);

/* Shows `text`, lines that are safe to print, at the prompt. *paged says whether it was shown: not
 * where it fits the screen, nor where keys are waiting, which are for the prompt. A paste leaves,
 * and is the prompt's as a whole. The terminal is open and raw. */
enum err page_text(struct line_editor *e, const struct buf *text, bool *paged, struct fault *fault);

#endif
