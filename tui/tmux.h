/* SPDX-License-Identifier: MIT */
/*
 * The terminal that tmux is shown in, as tmux describes it: the answer of
 *
 *     tmux display-message -p '#{client_termtype}|#{client_termfeatures}|#{allow-passthrough}'
 *     kitty(0.41.1)|256,RGB,bpaste,ccolour,clipboard,..|off
 *
 * Only a tmux on this machine, the one of $TMUX, can be asked; versions before 3.2 know less.
 */
#ifndef TUI_TMUX_H
#define TUI_TMUX_H

#include <stdbool.h>

#include "base/buf.h"

/* Option allow-passthrough: tmux passes sequences to the terminal outside. */
enum tmux_passing { TMUX_PASSING_UNKNOWN, TMUX_PASSES_NOTHING, TMUX_PASSES };

struct tmux_client {
    char name[64]; /* as reported for XTVERSION; "" if unknown */
    bool has_sixel;
    enum tmux_passing passing;
};

/* Add commands that begin with ESC and end with ESC \, and have no other ESC, for the terminal
 * outside: each as ESC P tmux; and the command with each ESC doubled, and ESC \. */
void tmux_wrap(struct buf *out, const struct buf *commands);

/* Read an answer; members that it does not mention are unknown. */
void tmux_read(struct tmux_client *client, const char *answer);

/* Ask, for at most a second. Return false, with *client zeroed, if there is no answer. */
bool tmux_ask(struct tmux_client *client);

#endif
