/* SPDX-License-Identifier: MIT */
/*
 * Read a line at the terminal: keys in, line drawn, until Enter.
 *
 * After a line with the cursor at its end possible continuations are shown in grey; they are not
 * part of the line. First comes the suggestion, the rest of an older line (line.h), which Right,
 * End and Alt-F accept; then the usage after it, as provided by the host.
 *
 * All available input is read before the line is drawn, and a bracketed paste to its end, so that a
 * large paste costs one redraw. A line feed in it submits; the rest stays for the next line.
 */
#ifndef TUI_PROMPT_LINE_EDIT_H
#define TUI_PROMPT_LINE_EDIT_H

#include <stdbool.h>
#include <stddef.h>

#include "base/buf.h"
#include "base/err.h"
#include "tui/keys.h"
#include "tui/prompt/line.h"

/* ---- the table of keys (line_keys.c) ---- */

/*
 * THE table of the keys of the prompt: dispatch, `help keys` and tui/README.md use it.
 *
 * A row names its keys as people do, "Ctrl-F, Right", and an event is compared with that: no key is
 * written twice. A key after another one is a word more, "Ctrl-X Ctrl-E". Shift, and other
 * modifiers that no row names with a key, are ignored: Shift-Left is Left.
 */
/* Action of a key: a change of the line by an enum line_action, or one of the editor. */
enum line_duty {
    DUTY_NONE = LINE_ACTIONS,
    DUTY_SUBMIT,
    DUTY_COMPLETE,
    DUTY_SEARCH,
    DUTY_DELETE_OR_END, /* LINE_DELETE, and the end of an empty line */
    DUTY_ABANDON,
    DUTY_CLEAR,
    DUTY_STOP,
    DUTY_OTHER_EDITOR,
    DUTY_HOST_LINE,
    DUTY_MORE /* no more than the beginning of keys in a row */
};

enum { LINE_KEYS_MOST = 40 }; /* bytes of "Ctrl-X Ctrl-E" and the like */

/* The enum line_action or enum line_duty of a key. `before` holds the keys that it comes after, ""
 * at first, and is brought up to date. */
unsigned line_key_find(const struct key_event *event, char before[LINE_KEYS_MOST]);

/* Adds the table, in lines of at most 80 columns. */
void line_keys_page(struct buf *out);

/* ---- drawing (line_draw.c) ---- */

/*
 * Drawing of the line being edited: prompt, text and cursor over several rows; and below it the
 * candidates for a word, and a caret under an error.
 *
 *     CSI nA CR CSI J   prompt text   CSI nA CR CSI nC       a redraw, in one write
 *
 * Rows break where the terminal breaks them: at the right margin, a wide character early. After a
 * character in the last column terminals delay the wrap, so if the text ends there, CR LF forces
 * it. If there are more rows than the terminal has, the rows around the cursor are shown. Bytes
 * that are not printable UTF-8 are drawn as \xNN, four columns wide. A hint ends in the row of the
 * cursor; lines below are limited by the rows left. Pure: bytes out.
 */
/* The drawing on the screen: `struct line_drawing d = {0}` is empty, with the cursor at a line's
 * start. */
struct line_drawing {
    size_t cells; /* from the start of the first row shown to the cursor */
    unsigned row; /* the cursor's, 0 is the first row shown */
};

struct line_content {
    const char *prompt;
    const char *text;
    size_t length, cursor; /* in bytes of text */
    const char *hint;      /* after the text, where the cursor is; safe to print, or NULL */
    const char *grey;      /* CSI .. m that makes it so */
    const char *below;     /* lines below, safe to print, each with a line feed; or NULL */
};

void line_draw(struct line_drawing *drawing, const struct line_content *content, unsigned columns,
               unsigned rows, struct buf *out);

/* ---- candidates ---- */

/* Whole words, each ended by a line feed, optionally with a tab and a meaning before it; and their
 * common prefix. */
struct candidates {
    const char *words;
    size_t count;
    size_t notes;      /* lines that begin with a tab: they are shown, and are no words */
    const char *first; /* the first of them, */
    size_t common;     /* and how many bytes of it all begin with, whole characters */
};

struct candidates candidates_of(const char *words);

/*
 * Add the list in lines that end in CR LF, for a terminal of `columns` x `rows`; the list leaves
 * three rows free. Candidates are in columns, read downwards, without their common path up to a
 * slash, and without quotes:
 *
 *     scans/a b.nii  ->  a b.nii   masks/
 *     scans/ch2.nii      ch2.nii
 *
 * If words have a meaning and there are rows for all of them, each has its own row, with as much of
 * the meaning as fits:
 *
 *     seed       plant a seed, a ball of seeds, or a stroke
 *     seed-file  plant the seeds of a .csv list or a label map
 *
 * Notes follow below, with their topic in the place of the word.
 *
 * Candidates that do not fit the screen are counted in a last line: "and 214 more".
 */
void candidates_list(const struct candidates *c, unsigned columns, unsigned rows, struct buf *out);

/* ---- the caret ---- */

/*     ch2> sede 1,1,1 2                 ch2> a line that did not fit, and so was wrapped ..
 *          ^                            ...seed 100,100,50 liver radius=2...
 *                                                          ^
 */
struct caret {
    const char *prompt, *text; /* the line as it was typed */
    size_t at;                 /* the byte of `text` that is wrong, or one after its end */
    bool below;                /* the addition follows directly below the line */
    bool coloured;
};

/* Adds a line with a caret, below as much of the line as fits where that is needed. In less than 8
 * columns nothing is added. */
void caret_add(struct buf *out, const struct caret *caret, unsigned columns);

/* ---- the editor ---- */

/* Fills `candidates` with whole words, one a line, for the word that begins at *word_start and ends
 * at the cursor. */
typedef void line_complete_function(void *context, const char *line, size_t cursor,
                                    struct buf *candidates, size_t *word_start);

/* Add candidates that contain the piece, for the first word of a line; lines that begin with a tab
 * are notes, not words: a tab, the topic, a tab, the text. */
typedef void line_find_function(void *context, const char *piece, struct buf *candidates);

/* Add the usage after the line, safe to print. */
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
    bool is_one_line;     /* a line feed in a paste is a blank; Escape empties and submits it */
    bool lone_escape;     /* the last byte was an ESC that nothing followed for a while */
    bool unanswered;      /* the terminal was asked and may still answer */
    bool after_return;    /* a CR ended the last line of a paste: an LF after it is ignored */
    unsigned answers_due; /* DA1 questions sent, not answered yet */
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
    const char *line_of_ctrl_o; /* submitted in place of the typed text, or NULL */
    void *context;
};

void line_editor_init(struct line_editor *e, line_complete_function *complete, void *context);
void line_editor_release(struct line_editor *e);

/* Call for each byte before keys_feed: a slow connection may cut an answer of the terminal right
 * after its ESC, which was then mistaken for the Escape key. */
void line_editor_mend(struct line_editor *e, uint8_t byte);

/* For other readers of the editor's input, as the pager: the next key of the bytes read, and the
 * key of bytes that were followed by nothing in time; false if there is no key. */
bool line_editor_next(struct line_editor *e, struct key_event *event);
bool line_editor_time_out(struct line_editor *e, struct key_event *event);

/* The terminal has said something: perhaps an answer that was due. */
void line_editor_reply(struct line_editor *e);

/* Wait for due answers: the next program at the terminal would read them as keys. */
void line_editor_take_answers(struct line_editor *e);

/* Wait for them, then stop as Ctrl-Z does; return when the process continues. */
void line_editor_suspend(struct line_editor *e);

/* Read a line at the terminal, which is open and raw, and add it to the history. News are shown
 * above the line. The line is e->line.text, until the next call. *ended is set at Ctrl-D on an
 * empty line or when the terminal is gone. */
enum err line_edit(struct line_editor *e, const char *prompt, bool *ended, struct fault *fault);

#endif
