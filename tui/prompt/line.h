/* SPDX-License-Identifier: MIT */
/*
 * The line being typed: text, cursor, effects of keys, undo, and older lines. Pure; drawing and the
 * terminal are in line_edit.h.
 *
 * Invariants
 *   L1 the text has no control characters, and is UTF-8 if everything inserted is;
 *   L2 the cursor is 0..length and between characters; marks stay with their base;
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
 * The history: lines entered before, oldest first, and the file that stores them between sessions.
 *
 * Not stored: empty lines, a line that begins with a blank, a repetition of the line before, and
 * lines longer than LINE_HISTORY_LONGEST. The file is plain text, one line each, with mode 0600.
 * Each line is appended when it is entered, so a session that is killed loses none, and
 * simultaneous sessions store the lines of all (base/file_log.h). From time to time it is trimmed
 * to the last LINE_HISTORY_MOST lines.
 *
 * Lines of the file that contain control characters are ignored.
 */
enum {
    LINE_HISTORY_MOST = 10000,
    LINE_HISTORY_LONGEST = 4096,
    LINE_HISTORY_BYTES_MOST = 4 << 20 /* read from the file, or stored in it, at most */
};

struct line_history {
    char **line; /* line[0] is the oldest */
    size_t count, capacity;
    size_t appended; /* lines appended to the file since it was trimmed */
};

/* `struct line_history h = {0}` is empty and ready. */
void line_history_release(struct line_history *h);

/* Return true if it was stored. Without memory the line is dropped: a history is not worth an
 * error. */
bool line_history_add(struct line_history *h, const char *text, size_t length);

/* Path of the file: $IFTTY_HISTORY, else below $XDG_STATE_HOME, else ~/.local/state/iftty. False
 * for no file: the first is empty, or none of the variables is set. */
bool line_history_path(struct buf *path);

/* Read the file into an empty history; without a file it stays empty. */
enum err line_history_load(struct line_history *h, const char *path, struct fault *fault);

/* Append the latest line, which line_history_add has stored. Missing folders are created. */
enum err line_history_append(struct line_history *h, const char *path, struct fault *fault);

/* ---- undo ---- */

/*
 * Changes of a line, undone step by step, the last step first.
 *
 * A step stores the position of the change, the length of the added text, and the removed text:
 * undoing it replaces the added text by the removed one. Typing up to the next word is one step,
 * and so are consecutive erased characters, and browsing older lines.
 *
 * Bounded: the oldest steps are dropped beyond LINE_UNDO_MOST steps or LINE_UNDO_BYTES bytes. A
 * step that cannot be stored, for its size or for lack of memory, drops all steps before it, since
 * they would no longer fit the text.
 */
enum { LINE_UNDO_MOST = 1000, LINE_UNDO_BYTES = 1 << 20 };

struct line_undo {
    struct line_change {
        size_t at;             /* bytes before it in the text */
        size_t removed, added; /* bytes */
        size_t cursor;         /* before the change */
    } * change;                /* oldest first */
    size_t count, capacity;
    struct buf removed; /* bytes removed by all of them, in the same order */
};

/* ---- the line ---- */

/* The last action; the same action again continues it. */
enum line_last { LAST_OTHER, LAST_TYPED, LAST_ERASED, LAST_KILLED, LAST_RECALLED, LAST_CITED };

enum { LINE_FOUND_MOST = 200 };

struct line {
    struct buf text;
    size_t cursor; /* in bytes */
    struct line_undo undo;
    enum line_last last;
    struct buf killed;
    const struct line_history *history;
    size_t place;      /* the history entry shown; history->count for the current line */
    struct buf draft;  /* the current line, while an older one is shown */
    struct buf prefix; /* prefix of the lines that are browsed */
    size_t word_entry; /* the history entry whose last word was inserted last, */
    size_t word_at;    /* and its position in the text */
    bool searching;
    bool search_failed;
    struct buf wanted; /* the text to search for */
    size_t found
        [LINE_FOUND_MOST]; /* the history entries that contain it, each text once, newest first, */
    size_t found_count, chosen; /* their number, and the index of the one shown */
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
    LINE_TRANSPOSE, /* exchange the characters around the cursor; at the end, the last two */
    LINE_UNDO,
    LINE_OLDER, /* browse the lines that begin with the text before the cursor */
    LINE_NEWER,
    LINE_OLDEST,
    LINE_NEWEST,
    LINE_LAST_WORD, /* insert the last word of the line before; again, of the one before that */
    LINE_ACTIONS
};

/* A line begins as {.history = h, .place = h->count}; the history may be empty, and must outlive
 * the line. */
void line_release(struct line *l);

/* Empty the line and leave the history; the kill buffer stays. */
void line_clear(struct line *l);

/* Insert typed bytes at the cursor, which moves after them. */
void line_insert(struct line *l, const char *bytes, size_t length);

/* Insert pasted bytes, which are undone as one step. */
void line_paste(struct line *l, const char *bytes, size_t length);

/* Replace text[from..to) by `bytes`; the cursor moves after them. */
void line_replace(struct line *l, size_t from, size_t to, const char *bytes, size_t length);

void line_act(struct line *l, enum line_action action);

/* ---- older lines ---- */

/*
 * Older lines are inserted into the line being edited: by browsing, by search, by their last words,
 * or as a suggestion. Pure.
 *
 * The lines browsed with LINE_OLDER and LINE_NEWER begin with the text before the cursor when
 * browsing began. An entry equal to the shown text is skipped. An older line that has been changed
 * is the current line.
 */

/* Search the history: a list of the lines that contain the wanted text, all at first, which narrows
 * as text is typed. The chosen line is shown as the text. */
void line_search_begin(struct line *l);
void line_search_add(struct line *l, const char *bytes, size_t length);
void line_search_erase(struct line *l);
void line_search_older(struct line *l);          /* show the next match in the list, */
void line_search_newer(struct line *l);          /* or the one before it */
void line_search_end(struct line *l, bool keep); /* keep the entry, or restore the former line */

/* Return true if a line of the history would still work now: a name that it needs may be gone. */
typedef bool line_knows_function(void *context, const char *text);

/* Return the suggestion: the rest of the newest known line that begins with the text and is longer.
 * "" for none, for an empty line, or if the cursor is not at the end; it may contain unsafe
 * characters. Valid until the history changes. */
const char *line_suggestion(const struct line *l, line_knows_function *knows, void *context);

/* Accept a suggestion, or its next word, on LINE_RIGHT, LINE_END or LINE_WORD_RIGHT at the end of
 * the line; false for another action, or for "". */
bool line_take_suggestion(struct line *l, const char *rest, enum line_action action);

#endif
