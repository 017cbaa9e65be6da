/* SPDX-License-Identifier: MIT */
/*
 * Themes: the colours of text, for a terminal that is dark, light, or to have none.
 *
 * Pictures have the colours of labels and greys, whatever the theme. Under `none`, as under
 * NO_COLOR, they are made of characters.
 */
#ifndef TUI_THEME_H
#define TUI_THEME_H

#include <stdbool.h>
#include <stddef.h>

struct theme {
    const char *name;
    const char *hint, *hint_16; /* CSI .. m, in 256 colours and in 16: what may follow a line */
    const char *alarm;          /* what is not to be overlooked */
    const char *heading, *key;  /* of a page of keys */
    bool has_colours;
};

#define THEME_NAMES "dark|light|none"
extern const struct theme theme_dark;

/* The theme of that name, or NULL. */
const struct theme *theme_find(const char *name);

#endif
