/* SPDX-License-Identifier: MIT */
/*
 * Choices: a few words in one text, "a|b|c", as a table or an error line has them. Each has
 * a number, from 0.
 */
#ifndef BASE_CHOICE_H
#define BASE_CHOICE_H

#include <stdbool.h>
#include <stddef.h>

/* A part of the text that it was found in; no NUL ends it. */
struct choice {
    const char *word;
    size_t length;
};

/* Takes the choice at *cursor and advances past it; false at the end of the text. */
bool choice_next(struct choice *out, const char **cursor);

/* Which choice a word is, to the letter; -1 for none. */
int choice_find(const char *choices, const char *word);

/* The choice of this number; the last one where there are not so many. */
struct choice choice_at(const char *choices, unsigned number);

#endif
