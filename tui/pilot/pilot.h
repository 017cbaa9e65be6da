/* SPDX-License-Identifier: MIT */
/*
 * The pilot: the whole screen, driven by keys. Three slices, the rendition, a cross-hair.
 *
 * The pilot knows no scene: a host says where the cross-hair is and draws the picture. Each key
 * that changes something becomes the line of a command that a user could have typed, which the host
 * carries out and records: so what was done here replays like any other session. The keys are the
 * table in tui/pilot/pilot_key_table.c. A click takes the cross-hair there; dragging draws while
 * the pen is down. Ctrl-C cancels a command.
 *
 * Invariants
 *   P1 what is on screen is made of what the host says after the last command, never of what a key
 *      was meant to do;
 *   P2 all keys that have arrived are carried out before anything is drawn, and nothing is drawn
 *      before the line has carried the frames before (tui/pilot/flow.h): frames are dropped, never
 *      queued, and the newest state always comes;
 *   P3 what is pasted is never keys: it goes to the line that `:` asks for, and waits there for
 *      Enter. What is pasted while a page of text is shown goes nowhere.
 */
#ifndef TUI_PILOT_PILOT_H
#define TUI_PILOT_PILOT_H

#include "tui/pilot/pilot_keys.h"
#include "tui/probe.h"
#include "tui/prompt/line_edit.h"

/* Begins as the state says, which stays as it is left. Runs until q, `finished`, or the end of the
 * input, which *ended says then. The terminal is open and raw, and is so afterwards; what was typed
 * ahead stays in editor->input. */
enum err pilot_run(const struct pilot_host *host, struct pilot_state *state,
                   struct terminal_facts *facts, struct line_editor *editor, bool *ended,
                   struct fault *fault);

#endif
