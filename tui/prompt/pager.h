/* SPDX-License-Identifier: MIT */
/*
 * A text on the screen, page by page: which rows show, what keys do, and how it is drawn.
 *
 *     Space f Ctrl-F PageDown   a page on          /WORDS Enter   search on, in letters of any case
 *     b Ctrl-B PageUp           a page back        n N            the next match, the one before
 *     Enter j Down, k Up        a row              g < Home, G > End
 *     q Escape Ctrl-C Ctrl-D    leave
 *
 * The text is safe to print; colours (CSI .. m) go on from one row to the next. Lines are broken as
 * cells_wrap breaks them, and words that are wider than the screen at its edge, so that a row of
 * ours is a row of the screen. Another size of the screen keeps the line that is at the top. The
 * last row of the screen says where one is. Pure: events in, bytes out; page_text alone is at the
 * terminal.
 *
 * Promises
 *   V1 nothing is drawn beyond the screen, and no row waits with a wrap when the next is drawn;
 *   V2 a row is drawn without the colour of another that does not reach into it;
 *   V3 the top row is one of the text, and the last row is on the last page.
 */
#ifndef TUI_PROMPT_PAGER_H
#define TUI_PROMPT_PAGER_H

#include <stdbool.h>
#include <stddef.h>

#include "base/buf.h"
#include "base/err.h"
#include "tui/prompt/line_edit.h"

struct pager_row {
    size_t start, length; /* in pager.wrapped */
    size_t line;          /* where in the text its line begins */
    size_t colour;        /* in force at its start, a place in pager.wrapped; SIZE_MAX for none */
};

struct pager {
    const char *text;
    size_t length;
    struct buf wrapped;
    struct pager_row *row;
    size_t rows, capacity;
    size_t top;               /* the first row shown */
    unsigned columns, height; /* of the screen */
    bool asks;                /* what to search for is being typed */
    struct buf wanted;
    bool failed; /* the search */
    bool
        filters; /* `/` has the caller give another text, of what is wanted alone: as it is typed */
};

/* The text outlives the pager. */
void pager_init(struct pager *p, const char *text, size_t length);
void pager_release(struct pager *p);

/* Another text in its place, from the top. */
void pager_turn_to(struct pager *p, const char *text, size_t length);

/* For a screen of this size. False without memory. */
bool pager_fit(struct pager *p, unsigned columns, unsigned height);

/* Whether the text and a row below it need more than the screen. */
bool pager_is_needed(const struct pager *p);

/* False for a key that leaves: where it filters, also one that a pager has no use for. */
bool pager_key(struct pager *p, const struct key_event *event);

/* The whole screen, from anywhere on it; and the rows that show, as lines that end in CR LF. */
void pager_draw(const struct pager *p, struct buf *out);
void pager_print(const struct pager *p, struct buf *out);

/* ---- at the terminal, on its other screen ---- */

/* Shows `text`, lines that are safe to print, until a key that leaves; the page that was looked at
 * last then stands above the prompt. *paged says whether it was shown: not where it fits the
 * screen, nor in a screen of less than 4 rows or 12 columns, nor where somebody has typed on
 * already, whose keys are for the prompt. A paste leaves, and is the prompt's as a whole. The
 * terminal is open and raw. */
enum err page_text(struct line_editor *e, const struct buf *text, bool *paged, struct fault *fault);

#endif
