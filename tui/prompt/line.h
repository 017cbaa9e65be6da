/*
 * The line being typed: text, cursor and what keys do to them. Pure; drawing is line_draw.h, the
 * terminal line_edit.h.
 *
 * Invariants
 *   L1 the text has no control characters, and is UTF-8 as far as what was inserted is;
 *   L2 the cursor is 0..length and stands between characters, marks stay with their base;
 *   L3 without memory an edit does nothing and text.failed stays set.
 */
#ifndef TUI_PROMPT_LINE_H
#define TUI_PROMPT_LINE_H

#include <stdbool.h>
#include <stddef.h>

#include "base/buf.h"
#include "tui/prompt/line_history.h"

struct line {
    struct buf text;
    size_t cursor; /* in bytes */
    struct buf killed;
    bool killing; /* the last action was a kill: the next one joins it */
    const struct line_history *history;
    size_t place;     /* the history entry shown; history->count for the line of today */
    struct buf draft; /* the line of today while an older one is shown */
    bool searching;
    bool search_failed;
    struct buf wanted; /* what is searched for */
};

/* In this order: moves, removals, kills, the rest. */
enum line_action {
    LINE_LEFT,
    LINE_RIGHT,
    LINE_WORD_LEFT,
    LINE_WORD_RIGHT,
    LINE_HOME,
    LINE_END,
    LINE_ERASE,       /* the character before the cursor */
    LINE_DELETE,      /* the one after it */
    LINE_KILL_TO_END, /* kills go to the kill buffer, one after another as one */
    LINE_KILL_TO_START,
    LINE_KILL_BLANK_LEFT, /* back to a blank (Ctrl-W) */
    LINE_KILL_WORD_LEFT,
    LINE_KILL_WORD_RIGHT,
    LINE_YANK,
    LINE_TRANSPOSE, /* the two characters around the cursor; at the end, the two before it */
    LINE_OLDER,
    LINE_NEWER,
    LINE_OLDEST,
    LINE_NEWEST
};

/* `history` (may be empty) outlives the line. */
void line_init(struct line *l, const struct line_history *history);
void line_release(struct line *l);

/* Empty again, back from the history; the kill buffer stays. */
void line_clear(struct line *l);

/* Inserts at the cursor, which moves after it. */
void line_insert(struct line *l, const char *bytes, size_t length);

/* Puts `bytes` in the place of text[from..to); the cursor goes after them. */
void line_replace(struct line *l, size_t from, size_t to, const char *bytes, size_t length);

void line_act(struct line *l, enum line_action action);

/* Incremental search backwards through the history. The entry found is shown as the text. */
void line_search_begin(struct line *l);
void line_search_add(struct line *l, const char *bytes, size_t length);
void line_search_erase(struct line *l);
void line_search_again(struct line *l);          /* an older match */
void line_search_end(struct line *l, bool keep); /* the entry stays, or the old line comes back */

#endif
