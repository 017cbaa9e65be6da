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

/* ---- the table of keys (line_keys.c) ---- */

/*
 * THE table of the keys of the prompt: dispatch, `help keys` and tui/README.md come from it.
 *
 * A row names its keys as people do, "Ctrl-F, Right", and that is what an event is compared with:
 * no key is written twice. A key after another one is a word more, "Ctrl-X Ctrl-E". Shift, and what
 * else is held with a key that no row names so, is passed over: Shift-Left is Left.
 */
/* What a key does: changes the line by an enum line_action, or something for the editor. */
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
 * Drawing the line being edited: prompt, text and cursor over as many rows as they need; and what
 * stands below it: the candidates for a word, and a caret under what is wrong.
 *
 *     CSI nA CR CSI J   prompt text   CSI nA CR CSI nC       all of a redraw, in one write
 *
 * Rows break where the terminal breaks them: at the right margin, a wide character early. After a
 * character in the last column terminals wait with the wrap, so when the text ends there, CR LF
 * makes it happen. When there are more rows than the terminal has, those around the cursor show.
 * What is no printable UTF-8 is drawn as \xNN, and takes four columns. A hint goes no further than
 * the row of the cursor; of what stands below, as much shows as there are rows. Pure: bytes out.
 */
/* What stands on the screen: `struct line_drawing d = {0}` is nothing, cursor at a line's start. */
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
    const char *below;     /* lines that stand below, safe to print and narrower than the screen,
                              each ended by a line feed; NULL for none */
};

void line_draw(struct line_drawing *drawing, const struct line_content *content, unsigned columns,
               unsigned rows, struct buf *out);

/* ---- candidates ---- */

/* Whole words, each ended by a line feed, with a tab and what it means before that where there is
 * something to say; and what all of the words begin with. */
struct candidates {
    const char *words;
    size_t count;
    size_t notes;      /* lines that begin with a tab: they are shown, and are no words */
    const char *first; /* the first of them, */
    size_t common;     /* and how many bytes of it all begin with, whole characters */
};

struct candidates candidates_of(const char *words);

/* Adds the list in lines that end in CR LF, for a terminal of so many columns and rows, of which
 * the list leaves three. Candidates stand in columns, read downwards, without what is the same in
 * all of them up to a slash, and without quotes:
 *
 *     scans/a b.nii  ->  a b.nii   masks/
 *     scans/ch2.nii      ch2.nii
 *
 * Where words have a meaning and there are rows for all of them, each has one of its own, with what
 * fits of the meaning beside it:
 *
 *     seed       plant a seed, a ball of seeds, or a stroke
 *     seed-file  plant the seeds of a .csv list or a label map
 *
 * Notes stand below these, what they are about in the place of the word.
 *
 * For what does not fit the screen there is one line: "and 214 more". */
void candidates_list(const struct candidates *c, unsigned columns, unsigned rows, struct buf *out);

/* ---- the caret ---- */

/*     ch2> sede 1,1,1 2                 ch2> a line that did not fit, and so was wrapped ..
 *          ^                            ...seed 100,100,50 liver radius=2...
 *                                                          ^
 */
struct caret {
    const char *prompt, *text; /* the line as it was typed */
    size_t at;                 /* the byte of `text` that is wrong, or one after its end */
    bool below;                /* what is added stands right below it */
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
