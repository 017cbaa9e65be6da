/* SPDX-License-Identifier: MIT */
/*
 * The prompt: reads lines, hands them to a host, prints what comes back. Knows no command.
 *
 * At a terminal (standard input and output both) there are line editing, completion, history and
 * pictures; with TERM=dumb a prompt alone. Otherwise lines are read from standard input as they
 * are, output goes to standard output and errors to standard error, without any escape sequence.
 *
 * While a command runs, the terminal makes signals of Ctrl-C and Ctrl-Z. A host that can cancel
 * handles SIGINT before repl_run; otherwise Ctrl-C ends the program, with the terminal restored.
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

/* Output text is printed as it is: names in it have been escaped by the host. */
struct repl_host {
    void *context;
    /* What the session begins with, such as loading a scene: called once, when the prompt has been
     * shown already, so that nobody waits for it. What is typed meanwhile waits. An error ends
     * repl_run with it. May be NULL. */
    enum err (*begin)(void *context, struct buf *output, struct fault *fault);
    /* Adds the prompt, "ch2> ". */
    void (*prompt)(void *context, struct buf *out);
    /* Does what `line` (not blank) says; adds text to print to `output`, with an error too. */
    enum err (*execute)(void *context, const char *line, struct buf *output, struct fault *fault);
    /* As of the line editor; may be NULL. Hints, and suggestions with them, are shown at a terminal
     * with colours. */
    line_complete_function *complete;
    line_find_function *find;
    line_hint_function *hint;
    line_knows_function *knows;
    /* True once after a command made a picture to show; its pixels stay until the next execute.
     * Asked only at a terminal. May be NULL. */
    bool (*picture)(void *context, struct image_view *out);
    /* On what has happened beside the commands: asked when news_descriptor is readable, while a
     * line is edited, and before a plain prompt. May be NULL. */
    line_news_function *news;
    int news_descriptor;
    /* True once after a command that asked for the whole screen, and what runs there, with the
     * terminal open and raw: until it gives the prompt back, or *ended. Ctrl-O does the command
     * `screen_line`. NULL where there is no such thing. */
    bool (*wants_screen)(void *context);
    enum err (*screen)(void *context, struct terminal_facts *facts, struct line_editor *editor,
                       bool *ended, struct fault *fault);
    const char *screen_line;
    /* Adds what is to be read once it has given the prompt back. May be NULL. */
    void (*after_screen)(void *context, struct buf *output);
    /* Whether the session is over; asked after every command. */
    bool (*finished)(void *context);
};

struct repl_options {
    struct graphics_wish graphics; /* one, whatever the terminal says; {0}: it decides */
    const char *history_path;      /* NULL: no history file */
    bool pages; /* at a terminal, what is longer than the screen is shown by pages (pager.h), */
    const char *pager;         /* or by the user's pager, the words of $PAGER; NULL for none */
    const struct theme *theme; /* NULL: the one of dark terminals */
};

/* Runs until the host is finished or the input ends. Errors of commands are printed in one line
 * and do not end it. Returns OK at a terminal, unless the terminal fails; with plain input the code
 * of the first command that failed, with fault->text empty since it has been printed. */
enum err repl_run(const struct repl_host *host, const struct repl_options *options,
                  struct fault *fault);

/* Outside repl_run: gives the whole screen to `screen`, as of struct repl_host, and restores
 * everything. ERR_USAGE where there is no terminal that can show it. */
enum err give_screen_once(const struct repl_host *host, struct graphics_wish wish,
                          struct fault *fault);

/* Outside repl_run: asks the terminal what it can, shows the picture at the cursor, which must be
 * at the start of a line, and restores everything. False, with nothing written, where standard
 * output is no terminal or cannot show it, or this is a background job. */
bool show_picture_once(struct graphics_wish wish, const struct image_view *view);

#endif
