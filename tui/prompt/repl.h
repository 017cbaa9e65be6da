/* SPDX-License-Identifier: MIT */
/*
 * The prompt: it reads lines, passes them to a host and prints the output. It knows no command.
 *
 * At a terminal (both standard input and output) it offers line editing, completion, history and
 * pictures; with TERM=dumb only a prompt. Otherwise lines are read from standard input, output is
 * written to standard output and errors to standard error, without any escape sequence.
 *
 * While a command runs, Ctrl-C and Ctrl-Z are signals. A host that can cancel handles SIGINT before
 * repl_run; otherwise Ctrl-C ends the program, with the terminal restored.
 */
#ifndef TUI_PROMPT_REPL_H
#define TUI_PROMPT_REPL_H

#include <stdbool.h>
#include <stddef.h>

#include "base/buf.h"
#include "base/err.h"
#include "tui/picture/graphics.h"
#include "tui/prompt/line_edit.h"
#include "tui/cells.h"

/* Output is printed unchanged: the host has escaped the names in it. */
struct repl_host {
    void *context;
    /* Start the session, by loading a scene for example: called once, after the prompt has been
     * shown. Keys typed meanwhile wait. An error ends repl_run. May be NULL. */
    enum err (*begin)(void *context, struct buf *output, struct fault *fault);
    /* Called once with the facts, which live as long as the terminal is open. May be NULL. */
    void (*terminal)(void *context, const struct terminal_facts *facts);
    /* Add the prompt, "ch2> ". */
    void (*prompt)(void *context, struct buf *out);
    /* Carry out `line`, which is not blank; add text to print to `output`, also after an error. */
    enum err (*execute)(void *context, const char *line, struct buf *output, struct fault *fault);
    /* As in the line editor; may be NULL. Hints and suggestions are shown at a terminal with
     * colours. */
    line_complete_function *complete;
    line_find_function *find;
    line_hint_function *hint;
    line_knows_function *knows;
    /* Return true once after a command that made a picture to show; its pixels are valid until the
     * next execute. Called only at a terminal. May be NULL. */
    bool (*picture)(void *context, struct image_view *out);
    /* Add events that are not caused by commands: called when news_descriptor is readable, while a
     * line is edited, and before a plain prompt. May be NULL. */
    line_news_function *news;
    int news_descriptor;
    /* wants_screen returns true once after a command that asked for the whole screen; screen then
     * runs with the terminal open and raw until it returns to the prompt, or sets *ended. Ctrl-O
     * types the command `screen_line`. NULL without such a screen. */
    bool (*wants_screen)(void *context);
    enum err (*screen)(void *context, struct terminal_facts *facts, struct line_editor *editor,
                       bool *ended, struct fault *fault);
    const char *screen_line;
    /* Add the text to show after the return to the prompt. May be NULL. */
    void (*after_screen)(void *context, struct buf *output);
    /* Return true if the session is over; called after every command. */
    bool (*finished)(void *context);
};

struct repl_options {
    struct graphics_wish graphics; /* a protocol to use; {0}: chosen by the terminal */
    const char *history_path;      /* NULL: no history file */
    bool pages;                    /* at a terminal, long output is shown by pages (pager.h), */
    const char *pager;             /* or by the command in $PAGER; NULL for none */
    const struct theme *theme;     /* NULL: by the background of the terminal */
};

/* Run until the host is finished or the input ends. Errors of commands are printed in one line and
 * do not end the session. At a terminal return OK, unless the terminal fails; with plain input
 * return the code of the first command that failed, with fault->text empty since it has been
 * printed. */
enum err repl_run(const struct repl_host *host, const struct repl_options *options,
                  struct fault *fault);

/* Outside repl_run: run `screen` of struct repl_host on the whole screen, and restore the terminal.
 * ERR_USAGE without a terminal that can show it. */
enum err run_screen_once(const struct repl_host *host, struct graphics_wish wish,
                         struct fault *fault);

/* Outside repl_run: detect the terminal, show the picture at the cursor, which must be at the start
 * of a line, and restore the terminal. Return false, with nothing written, if standard output is no
 * terminal or cannot show it, or if this is a background job. */
bool show_picture_once(struct graphics_wish wish, const struct image_view *view);

#endif
