/* SPDX-License-Identifier: MIT */
/*
 * What a user has written down about prompt and pilot, in $XDG_CONFIG_HOME/iftty/config or
 * ~/.config/iftty/config; IFTTY_CONFIG=FILE names another one, IFTTY_CONFIG= none.
 *
 *     # dark, light or none
 *     theme light
 *     # what the pilot's brush begins with: a label, a radius
 *     brush 3 2
 *     # a window of greys by centre and width: `w` and its number take it
 *     window liver 60 160
 *     # the keys of an action of the pilot (tui/pilot/chord.h)
 *     key undo U Ctrl-u
 *     # long answers at the prompt run over the screen as they are
 *     pager off
 *     # on a slow line no slice is sent before it is wanted
 *     ahead off
 *     # a command for each new session, once it has a scene; `start none` for nothing
 *     start overlay tint
 *
 * A session that no line says a start for begins with CONFIG_USUAL_START: labels settle on edges.
 *
 * It is read where there is a terminal to sit at, and nowhere else: no script, replay or journal
 * depends on it. A line that is not understood is named with its number and left out; so is what
 * is beyond CONFIG_LINES_MOST lines or CONFIG_LINE_MOST bytes in one. Whatever it holds, it moves
 * no cursor and takes no more memory than that.
 */
#ifndef PROGRAM_CONFIG_H
#define PROGRAM_CONFIG_H

#include <stdbool.h>

#include "base/buf.h"
#include "tui/pilot/pilot_keys.h"

enum { CONFIG_BYTES_MOST = 64 << 10, CONFIG_LINE_MOST = 1000, CONFIG_LINES_MOST = 1000 };

/* Over robots' sessions these took 13.8 gestures to what took 20.3 without. */
#define CONFIG_USUAL_START "finish relax\nfinished on\n"

struct config {
    struct pilot_setup setup;
    bool plain_answers; /* no pager */
    bool has_start;     /* a line says what a session begins with */
    struct buf path;
    struct buf start; /* commands, one a line, each after the number of its line and a blank */
    struct buf words; /* lines on what was left out, safe to print */
    size_t line;      /* that is being read, from 1 */
    size_t wrong;     /* lines */
};

/* What holds where nothing is written down. */
void config_init(struct config *config);
void config_release(struct config *config);

/* Finds the file and reads it; none is fine. What is wrong with it is among the words. Where it
 * says no `start`, the usual one is there. */
void config_read(struct config *config);

/* Takes a text in, line by line; `path` is for the words. */
void config_take(struct config *config, const char *text, size_t length);

#endif
