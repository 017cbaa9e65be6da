/* SPDX-License-Identifier: MIT */
/*
 * Read a line at the terminal: keys in, line drawn, until Enter.
 *
 * After a line with the cursor at its end possible continuations are shown in grey; they are not
 * part of the line. First comes the suggestion, the rest of an older line (line.h), which Right,
 * End and Alt-F accept; then the usage after it, as provided by the host.
 *
 * All available input is read before the line is drawn, and a bracketed paste to its end, so that a
 * large paste costs one redraw. Nothing pasted runs by itself: of several lines the last one is
 * edited, the others are held, shown above it. Enter then returns all of them, one for each call;
 * Ctrl-C drops them.
 */
#ifndef TUI_PROMPT_LINE_EDIT_H
#define TUI_PROMPT_LINE_EDIT_H

#include <stdbool.h>
#include <stddef.h>

#include "base/buf.h"
#include "base/err.h"
#include "tui/keys.h"
#include "tui/picture/graphics.h"
#include "tui/prompt/line.h"

/* ---- the table of keys (line_keys.c) ---- */

/*
 * THE table of the keys of the prompt: dispatch, `help keys` and tui/README.md use it.
 *
 * A row names its keys as users do, "Ctrl-F, Right", and the name of an event is compared with
 * that, so each key is written once. A sequence of two keys is two words, "Ctrl-X Ctrl-E". Shift,
 * and other modifiers that no row names with a key, are ignored: Shift-Left is Left.
 */
/* Action of a key: a change of the line by an enum line_action, or one of the editor; and the
 * action that remains to be done after it. */
enum line_editor_act {
    DUTY_NONE = LINE_ACTIONS,
    DUTY_SUBMIT,
    DUTY_COMPLETE,
    DUTY_SEARCH,
    DUTY_DELETE_OR_END, /* LINE_DELETE; on an empty line, the end of input */
    DUTY_ABANDON,
    DUTY_CLEAR,
    DUTY_STOP,
    DUTY_OTHER_EDITOR,
    DUTY_HOST_LINE,
    DUTY_MORE, /* the first key of a sequence */
    /* not of keys: */
    DUTY_HOLD, /* a pasted line has ended */
    DUTY_END,
    DUTY_GONE, /* the terminal is gone */
    DUTY_NEWS
};

enum { LINE_KEYS_MOST = 40 }; /* bytes of the longest name, "Ctrl-X Ctrl-E" for example */

/* Return the enum line_action or enum line_editor_act of a key. `before` holds the first key of a
 * sequence, "" at first, and is updated. */
unsigned line_key_find(const struct key_event *event, char before[LINE_KEYS_MOST]);

/* Add the table, in lines of at most 80 columns. */
void line_keys_page(struct buf *out);

/* ---- drawing (line_draw.c) ---- */

/*
 * Drawing of the line being edited: prompt, text and cursor over several rows; below it the
 * candidates for a word, and a caret under an error.
 *
 *     CSI nA CR CSI J   prompt text   CSI nA CR CSI nC       a redraw, in one write
 *
 * Rows break where the terminal breaks them: at the right margin, one column early before a wide
 * character. After a character in the last column terminals delay the wrap, so if the text ends
 * there, CR LF forces it. If there are more rows than the terminal has, the rows around the cursor
 * are shown. Bytes that are not printable UTF-8 are drawn as \xNN, four columns wide. A hint ends
 * in the row of the cursor; lines below are limited by the rows left. Pure: bytes out.
 */
/* The drawing on the screen: `struct line_drawing d = {0}` is empty, with the cursor at a line's
 * start. */
struct line_drawing {
    size_t cells; /* from the start of the first row shown to the cursor */
    unsigned row; /* row of the cursor; 0 is the first row shown */
};

struct line_content {
    const char *prompt;
    const char *text;
    size_t length, cursor; /* in bytes of text */
    const char *hint;      /* after the text, where the cursor is; safe to print, or NULL */
    const char *grey;      /* CSI .. m, the colour of the hint */
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
    size_t notes;      /* lines that begin with a tab: shown, but no candidates */
    const char *first; /* the first candidate, */
    size_t common;     /* and the bytes, in whole characters, of the prefix common to all */
};

struct candidates candidates_of(const char *words);

/*
 * Add the list in lines that end in CR LF, for a terminal of `columns` x `rows`; the list leaves
 * three rows free. Candidates are in columns, to be read downwards, without quotes and without
 * their common path up to a slash:
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
 * Notes follow below, with their topic in place of the word.
 *
 * A last line counts the candidates that do not fit the screen: "and 214 more".
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

/* Add a line with a caret, and below it as much of the line as fits, if needed. With fewer than 8
 * columns nothing is added. */
void caret_add(struct buf *out, const struct caret *caret, unsigned columns);

/* ---- the editor ---- */

/* Fill `candidates` with whole words, one a line, for the word that begins at *word_start and ends
 * at the cursor. */
typedef void line_complete_function(void *context, const char *line, size_t cursor,
                                    struct buf *candidates, size_t *word_start);

/* Add candidates that contain the piece, for the first word of a line; lines that begin with a tab
 * are notes, not words: a tab, the topic, a tab, the text. */
typedef void line_find_function(void *context, const char *piece, struct buf *candidates);

/* Add the usage after the line, safe to print. */
typedef void line_hint_function(void *context, const char *line, size_t length, struct buf *out);

/* Add lines to be shown now, safe to print, each ended by a line feed. */
typedef void line_news_function(void *context, struct buf *out);

struct line_editor {
    struct line_history history;
    bool stored; /* the last line is in the history */
    struct line line;
    struct keys keys;
    struct buf input; /* bytes read; those before `taken` have been handled */
    size_t taken;
    bool pasting;
    struct buf held; /* lines before the present one that wait for Enter, each with a line feed */
    char keys_before[LINE_KEYS_MOST]; /* the first key of a sequence, Ctrl-X for example */
    bool is_one_line;  /* a line feed in a paste is a blank; Escape empties and submits it */
    bool lone_escape;  /* the last byte was an ESC, and nothing followed in time */
    bool unanswered;   /* the terminal was asked and has not answered yet */
    bool after_return; /* a CR ended the last line of a paste: an LF after it is ignored */
    struct graphics_probe *probe; /* of the terminal, with its facts; NULL: replies do not matter */
    struct terminal_facts *facts;
    unsigned answers_due;          /* DA1 questions sent, not answered yet */
    void (*answered)(void *asker); /* called for other DA1 answers; or NULL */
    void *asker;
    struct line_drawing drawing;
    line_complete_function *complete; /* may be NULL */
    /* May be NULL: called if the first word has no other completion, and always for one line of a
     * full screen. */
    line_find_function *find;
    line_hint_function *hint;   /* may be NULL: called whenever the cursor is at the end */
    line_knows_function *knows; /* may be NULL: nothing is suggested */
    const char *grey;           /* CSI .. m, the colour of hints */
    bool submits;               /* the line is drawn for the last time, without a hint */
    line_news_function *news;   /* may be NULL; called when news_descriptor is readable */
    int news_descriptor;
    const char *pager;          /* the command in $PAGER, or NULL (pager.h) */
    const char *line_of_ctrl_o; /* submitted in place of the typed text, or NULL */
    void *context;
};

/* Begins as {.line.history = &e.history}, with the members above as wanted. */
void line_editor_release(struct line_editor *e);

/* Call for each byte before keys_feed. On a slow line an answer of the terminal may be cut right
 * after its ESC, which was then mistaken for the Escape key. */
void line_editor_rejoin_reply(struct line_editor *e, uint8_t byte);

/* For other readers of the editor's input, such as the pager: get the next key of the bytes read,
 * or the key of bytes that nothing followed in time; return false without a key. */
bool line_editor_next(struct line_editor *e, struct key_event *event);
bool line_editor_time_out(struct line_editor *e, struct key_event *event);

/* Call for each reply of the terminal: it may be an answer that was due, or one of the probe. In
 * that case return true if the screen must be drawn again. */
bool line_editor_reply(struct line_editor *e);

/* Ask the terminal again for its features. */
void line_editor_probe(struct line_editor *e);

/* Wait for due answers: the next program at the terminal would read them as keys. */
void line_editor_take_answers(struct line_editor *e);

/* Wait for due answers, then stop as Ctrl-Z does; return when the process continues. */
void line_editor_suspend(struct line_editor *e);

/* Read a line at the terminal, which is open and raw, and add it to the history. News are shown
 * above the line. The line is e->line.text, until the next call. *ended is set at Ctrl-D on an
 * empty line or when the terminal is gone. */
enum err line_edit(struct line_editor *e, const char *prompt, bool *ended, struct fault *fault);

#endif
