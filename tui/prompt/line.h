/* SPDX-License-Identifier: MIT */
/*
 * The line being typed: text, cursor, what keys do to them, undo, and older lines that come into
 * it. Pure; drawing and the terminal are in line_edit.h.
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
#include "base/err.h"

/* ---- the lines entered before ---- */

/*
 * The lines entered before, oldest first, and the file that stores them between sessions.
 *
 * Not stored: empty lines, a line that begins with a blank, a repetition of the line before, and
 * lines longer than LINE_HISTORY_LONGEST. The file is plain text, a line each, mode 0600. Each line
 * is appended to it when it is entered, so that a session that is killed has lost none, and many
 * sessions at once store the lines of all (base/file_log.h). It is trimmed to the last
 * LINE_HISTORY_MOST lines now and then.
 *
 * Lines of the file that hold control characters are passed over.
 */
enum {
    LINE_HISTORY_MOST = 10000,
    LINE_HISTORY_LONGEST = 4096,
    LINE_HISTORY_BYTES_MOST = 4 << 20 /* of the file: no more of it is read, or stored */
};

struct line_history {
    char **line; /* line[0] is the oldest */
    size_t count, capacity;
    size_t appended; /* to the file, since it was trimmed */
};

/* `struct line_history h = {0}` is empty and ready. */
void line_history_release(struct line_history *h);

/* Whether it was stored. Without memory the line is forgotten: a history is not worth an error. */
bool line_history_add(struct line_history *h, const char *text, size_t length);

/* Where the file lies: $IFTTY_HISTORY, else below $XDG_STATE_HOME, else ~/.local/state/iftty. False
 * where there is to be none: the first is empty, or nothing says where. */
bool line_history_path(struct buf *path);

/* Reads the file into an empty history; one that is not there is empty. */
enum err line_history_load(struct line_history *h, const char *path, struct fault *fault);

/* Appends the latest line, which line_history_add has stored. Folders that are not there are
 * made. */
enum err line_history_append(struct line_history *h, const char *path, struct fault *fault);

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
