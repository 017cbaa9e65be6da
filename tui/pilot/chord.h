/* SPDX-License-Identifier: MIT */
/*
 * Keys as words, in the table of keys and in the configuration:
 *
 *     k                    a character
 *     Tab Page-up          a key with a name: Enter, Escape, Space, Left, Home, Delete ..
 *     Ctrl-r Shift-Up      with modifiers; Shift is a part of a character, and not named there
 *     gg 'a                a character after another, its leader
 *     0-9 a-z sa-z         any character from one to another, alone or after a leader
 *     any                  whatever is pressed
 *
 * Words are parted by blanks. Pure.
 */
#ifndef TUI_PILOT_CHORD_H
#define TUI_PILOT_CHORD_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "tui/keys.h"

struct chord {
    uint32_t leader; /* 0 for none */
    enum key key;    /* KEY_PENDING for any */
    unsigned modifiers;
    uint32_t first, last; /* of a KEY_CHARACTER */
};

/* Reads the word of `length` bytes. False for one that names no key. */
bool chord_read(const char *word, size_t length, struct chord *chord);

/* Whether the event, after that leader, is the chord. */
bool chord_fits(const struct chord *chord, uint32_t leader, const struct key_event *event);

/* Whether there is an event that is both, or that is one and begins the other. */
bool chord_clashes(const struct chord *a, const struct chord *b);

/* Goes through words: *at moves past the next one, which *word and *length are then. False at the
 * end. */
bool chord_next(const char **at, const char **word, size_t *length);

#endif
