/* SPDX-License-Identifier: MIT */
/*
 * The pilot: the whole screen, driven by keys. Three slices, the rendition, a cross-hair.
 *
 * The pilot knows no scene: a host reports the cross-hair and draws the picture. Each key that
 * changes something becomes a command that a user could have typed, which the host carries out and
 * records: so a session in the pilot replays like any other. The keys are the table in
 * tui/pilot/pilot_key_table.c. A click moves the cross-hair; dragging draws while the pen is down.
 * Ctrl-C cancels a command.
 *
 * Invariants
 *   P1 the screen shows the state that the host reports after the last command, never an expected
 *      effect of a key;
 *   P2 all available keys are carried out before anything is drawn, and nothing is drawn before the
 *      line has carried the frames before (tui/pilot/flow.h): frames are dropped, never queued, and
 *      the newest state is always drawn;
 *   P3 pasted text is never keys: it is inserted into the line of `:`, and waits there for Enter.
 *      Text pasted while a page is shown is dropped.
 */
#ifndef TUI_PILOT_PILOT_H
#define TUI_PILOT_PILOT_H

#include "tui/pilot/pilot_keys.h"
#include "tui/probe.h"
#include "tui/prompt/line_edit.h"

/* Start with the state, which is kept for the next call. Run until q, `finished`, or the end of the
 * input, which sets *ended. The terminal is open and raw before and after; unread input stays in
 * editor->input. */
enum err pilot_run(const struct pilot_host *host, struct pilot_state *state,
                   struct terminal_facts *facts, struct line_editor *editor, bool *ended,
                   struct fault *fault);

#endif
