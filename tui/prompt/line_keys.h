/* SPDX-License-Identifier: MIT */
/*
 * THE table of the keys of the prompt: dispatch, `help keys` and tui/README.md come from it.
 *
 * A row names its keys as people do, "Ctrl-F, Right", and that is what an event is compared with:
 * no key is written twice. A key after another one is a word more, "Ctrl-X Ctrl-E". Shift, and what
 * else is held with a key that no row names so, is passed over: Shift-Left is Left.
 */
#ifndef TUI_PROMPT_LINE_KEYS_H
#define TUI_PROMPT_LINE_KEYS_H

#include <stdbool.h>

#include "base/buf.h"
#include "tui/keys.h"
#include "tui/prompt/line.h"

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

#endif
