/* SPDX-License-Identifier: MIT */
/*
 * Reading a line at the terminal: keys in, line drawn, until Enter.
 *
 * The keys are in line_keys.c.
 *
 * After a line with the cursor at its end stands in grey how it may go on; that is no part of the
 * line. First comes what is suggested, the rest of an older line (line.h), which Right, End
 * and Alt-F there take; then what may follow all that, as the host says.
 *
 * All that has arrived is taken in before the line is drawn, and a bracketed paste to its end, so
 * that a large paste costs one redraw. A line feed in it submits, the rest stays for the next line.
 */
#ifndef TUI_PROMPT_LINE_EDIT_H
#define TUI_PROMPT_LINE_EDIT_H

#include <stdbool.h>
#include <stddef.h>

#include "base/buf.h"
#include "base/err.h"
#include "tui/keys.h"
#include "tui/prompt/line.h"
#include "tui/prompt/line_draw.h"
#include "tui/prompt/line_keys.h"

/* Fills `candidates` with whole words, one a line, for the word that begins at *word_start and ends
 * at the cursor. */
typedef void line_complete_function(void *context, const char *line, size_t cursor,
                                    struct buf *candidates, size_t *word_start);

/* Adds to those words of a line's first word what has it as a piece; lines that begin with a tab
 * are told, and no words: a tab, what it is about, a tab, what there is to say. */
typedef void line_find_function(void *context, const char *piece, struct buf *candidates);

/* Adds what may follow the line, safe to print. */
typedef void line_hint_function(void *context, const char *line, size_t length, struct buf *out);

/* Adds lines that are to be shown now, safe to print, each ended by a line feed. */
typedef void line_news_function(void *context, struct buf *out);

struct line_editor {
    struct line_history history;
    bool stored; /* the last line is in the history now */
    struct line line;
    struct keys keys;
    struct buf input; /* bytes read; those before `taken` are done with */
    size_t taken;
    bool pasting;
    char keys_before[LINE_KEYS_MOST]; /* that wait for another, as Ctrl-X does */
    bool is_one_line;  /* a line feed in a paste is a blank; Escape empties and submits it */
    bool lone_escape;  /* the last byte was an ESC that nothing followed for a while */
    bool unanswered;   /* the terminal was asked and has not answered: what it says may come yet */
    bool after_return; /* of CR LF in a paste, the LF says nothing new */
    unsigned answers_due;          /* DA1 questions sent, not answered yet */
    void (*answered)(void *asker); /* called at other answers to DA1 that come meanwhile; or NULL */
    void *asker;
    struct line_drawing drawing;
    line_complete_function *complete; /* may be NULL */
    line_find_function *find;         /* may be NULL: asked where no word begins as the first one
                                         does, and for one line amid a screen in any case */
    line_hint_function *hint;         /* may be NULL: asked wherever the cursor is at the end */
    line_knows_function *knows;       /* may be NULL: nothing is suggested */
    const char *grey;                 /* in which hints are drawn, CSI .. m */
    bool submits;                     /* the line is drawn for the last time: without a hint */
    line_news_function *news;         /* may be NULL; else asked when news_descriptor is readable */
    int news_descriptor;
    const char *pager;          /* words of $PAGER, or NULL (pager.h) */
    const char *line_of_ctrl_o; /* submitted in place of what was typed, or NULL */
    void *context;
};

void line_editor_init(struct line_editor *e, line_complete_function *complete, void *context);
void line_editor_release(struct line_editor *e);

/* Takes each byte before keys_feed does: a slow connection may cut an answer of the terminal
 * right after its ESC, which was taken for the Escape key then. */
void line_editor_mend(struct line_editor *e, uint8_t byte);

/* For others who read the editor's input, as a pager does: the next key of what has been read,
 * and the one that bytes are which nothing followed in time; false where there is none. */
bool line_editor_next(struct line_editor *e, struct key_event *event);
bool line_editor_time_out(struct line_editor *e, struct key_event *event);

/* The terminal has said something: perhaps an answer that was due. */
void line_editor_reply(struct line_editor *e);

/* Waits for the answers that are due: what has the terminal next would take them for keys. */
void line_editor_take_answers(struct line_editor *e);

/* Stops as Ctrl-Z does, when they have come; returns when it goes on. */
void line_editor_suspend(struct line_editor *e);

/* Reads a line at the terminal, which is open and raw, and adds it to the history. News that come
 * meanwhile stand above the line. The line is then
 * e->line.text, until the next call. *ended is set at Ctrl-D on an empty line or when the terminal
 * has gone. */
enum err line_edit(struct line_editor *e, const char *prompt, bool *ended, struct fault *fault);

#endif
