/*
 * Keys that were typed while a command is carried out: they are taken when it has ended, in their
 * order, and until then shown as far as they only move the cross-hair.
 */
#ifndef TUI_PILOT_TYPED_AHEAD_H
#define TUI_PILOT_TYPED_AHEAD_H

#include "tui/pilot/pilot_keys.h"

enum { TYPED_AHEAD_MOST = 128 };

/* {0} is empty. */
struct typed_ahead {
    struct key_event event[TYPED_AHEAD_MOST];
    size_t count, taken;
};

/* Whether there is room for another; it is not asked for after a paste, whose text is kept once. */
bool typed_ahead_has_room(const struct typed_ahead *ahead);
void typed_ahead_add(struct typed_ahead *ahead, const struct key_event *event);

/* The first of them, which goes; false where there is none. */
bool typed_ahead_take(struct typed_ahead *ahead, struct key_event *event);

/* Has the host show the cross-hair where those keys will lead, and `state` what they will make of
 * it, up to the first that does anything else. */
void typed_ahead_show(const struct typed_ahead *ahead, struct pilot_state *state,
                      const struct pilot_host *host);

#endif
