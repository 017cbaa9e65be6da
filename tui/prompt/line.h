/* SPDX-License-Identifier: MIT */
/*
 * The line being typed: text, cursor, what keys do to them, undo, and older lines that come into
 * it. Pure; drawing is line_draw.h, the terminal line_edit.h.
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

/* ---- undo ---- */

/*
 * What was done to a line, so that it can be taken back step by step, the last step first.
 *
 * A step says where the text changed, how much was added there, and holds what was removed: taking
 * it back puts that in the place of what was added. What is typed up to the next word is one step,
 * and so are characters erased one after another, and older lines looked through.
 *
 * Bounded: the oldest steps go when there are LINE_UNDO_MOST, or what they hold is more than
 * LINE_UNDO_BYTES. A step that cannot be held, for its size or for the lack of memory, takes all
 * before it along, since they would no longer fit the text.
 */
enum { LINE_UNDO_MOST = 1000, LINE_UNDO_BYTES = 1 << 20 };

struct line_undo {
    struct line_change {
        size_t at;             /* bytes before it in the text */
        size_t removed, added; /* bytes */
        size_t cursor;         /* before the change */
    } * change;                /* the oldest first */
    size_t count, capacity;
    struct buf removed; /* by all of them, in their order */
};

/* ---- the line ---- */

/* What was done last, which the same done again goes on with. */
enum line_last { LAST_OTHER, LAST_TYPED, LAST_ERASED, LAST_KILLED, LAST_RECALLED, LAST_CITED };

enum { LINE_FOUND_MOST = 200 };

struct line {
    struct buf text;
    size_t cursor; /* in bytes */
    struct line_undo undo;
    enum line_last last;
    struct buf killed;
    const struct line_history *history;
    size_t place;      /* the history entry shown; history->count for the line of today */
    struct buf draft;  /* the line of today while an older one is shown */
    struct buf prefix; /* what the lines looked through begin with */
    size_t cited;      /* the history entry whose last word was inserted last, */
    size_t cited_at;   /* and where in the text */
    bool searching;
    bool search_failed;
    struct buf wanted;             /* what is searched for */
    size_t found[LINE_FOUND_MOST]; /* the history entries that hold it, each text once, the newest
                                      first, */
    size_t founds, chosen;         /* and which of them is shown; founds for none */
};

/* In this order: moves, removals, kills, letters of a word, the rest. */
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
    LINE_UPPER, /* to the end of the word, where the cursor goes */
    LINE_LOWER,
    LINE_CAPITAL, /* its first letter upper, the rest lower */
    LINE_YANK,
    LINE_TRANSPOSE, /* the two characters around the cursor; at the end, the two before it */
    LINE_UNDO,
    LINE_OLDER, /* of the lines that begin with what stands before the cursor */
    LINE_NEWER,
    LINE_OLDEST,
    LINE_NEWEST,
    LINE_CITE, /* the last word of the line before; again, of the one before that */
    LINE_ACTIONS
};

/* `history` (may be empty) outlives the line. */
void line_init(struct line *l, const struct line_history *history);
void line_release(struct line *l);

/* Empty again, back from the history; the kill buffer stays. */
void line_clear(struct line *l);

/* Inserts what is typed at the cursor, which moves after it. */
void line_insert(struct line *l, const char *bytes, size_t length);

/* The same with what is pasted, all of which is undone as one. */
void line_paste(struct line *l, const char *bytes, size_t length);

/* Puts `bytes` in the place of text[from..to); the cursor goes after them. */
void line_replace(struct line *l, size_t from, size_t to, const char *bytes, size_t length);

void line_act(struct line *l, enum line_action action);

/* ---- older lines ---- */

/*
 * Older lines come into the line being edited: one after another, by search, by their last words,
 * or as a suggestion of how it may go on. Pure.
 *
 * The lines looked through with LINE_OLDER and LINE_NEWER begin with what stood before the cursor
 * when that began. One that is the same as what is shown is passed over. An older line that has
 * been changed is the line of today.
 */

/* Search through the history: a list of the lines that hold what is wanted, all at first, which
 * narrows as that is typed. The one that is chosen is shown as the text. */
void line_search_begin(struct line *l);
void line_search_add(struct line *l, const char *bytes, size_t length);
void line_search_erase(struct line *l);
void line_search_older(struct line *l);          /* the next one of the list, */
void line_search_newer(struct line *l);          /* or the one before */
void line_search_end(struct line *l, bool keep); /* the entry stays, or the old line comes back */

/* Whether a line of the history would do now what it did: a name that it needs may be gone. */
typedef bool line_knows_function(void *context, const char *text);

/* What is suggested: the rest of the newest line that begins with the text, is longer, and is
 * known. "" where there is none, for an empty line, or where the cursor is not at the end; it may
 * hold what is not safe to print. It lives as long as the history does not change. */
const char *line_suggestion(const struct line *l, line_knows_function *knows, void *context);

/* Takes a suggestion, or the next word of it, as LINE_RIGHT, LINE_END or LINE_WORD_RIGHT at the end
 * of the line do; false for another action, or for "". */
bool line_take_suggestion(struct line *l, const char *rest, enum line_action action);

#endif
