/* A long answer at the terminal, in a pager of our own (pager.h) on the terminal's other screen. */
#ifndef TUI_PROMPT_PAGING_H
#define TUI_PROMPT_PAGING_H

#include "base/err.h"
#include "tui/prompt/line_edit.h"

/* Shows `text`, lines that are safe to print, until a key that leaves; the page that was looked at
 * last then stands above the prompt. *paged says whether it was shown: not where it fits the
 * screen, nor in a screen of less than 4 rows or 12 columns, nor where somebody has typed on
 * already, whose keys are for the prompt. A paste leaves, and is the prompt's as a whole. The
 * terminal is open and raw. */
enum err page_text(struct line_editor *e, const struct buf *text, bool *paged, struct fault *fault);

#endif
