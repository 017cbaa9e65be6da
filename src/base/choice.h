/* SPDX-License-Identifier: MIT */
/*
 * Choices: a few words in one text, "a|b|c", as a table or an error line has them. Each has
 * a number, from 0.
 */
#ifndef BASE_CHOICE_H
#define BASE_CHOICE_H

#include <stdbool.h>
#include <stddef.h>
#include <string.h>

/* A part of the text that it was found in; no NUL ends it. */
struct choice {
    const char *word;
    size_t length;
};

/* Takes the choice at *cursor and advances past it; false at the end of the text. */
static inline bool choice_next(struct choice *out, const char **cursor)
{
    if (**cursor == '\0')
        return false;
    *out = (struct choice){*cursor, strcspn(*cursor, "|")};
    *cursor += out->length;
    *cursor += **cursor == '|';
    return true;
}

/* Which choice a word is, to the letter; -1 for none. */
static inline int choice_find(const char *choices, const char *word)
{
    const size_t length = strlen(word);
    struct choice choice;
    for (int i = 0; choice_next(&choice, &choices); i++)
        if (choice.length == length && memcmp(choice.word, word, length) == 0)
            return i;
    return -1;
}

/* The choice of this number; the last one where there are not so many. */
static inline struct choice choice_at(const char *choices, unsigned number)
{
    struct choice choice = {choices, 0};
    for (unsigned i = 0; i <= number && choice_next(&choice, &choices); i++)
        continue;
    return choice;
}

#endif
