/* SPDX-License-Identifier: MIT */
/*
 * Choices: a few words in one text, "a|b|c", as tables and error lines have them, numbered from 0.
 */
#ifndef BASE_CHOICE_H
#define BASE_CHOICE_H

#include <stdbool.h>
#include <stddef.h>
#include <string.h>

/* A part of the text it was found in, without a terminating NUL. */
struct choice {
    const char *word;
    size_t length;
};

/* Read the choice at *cursor and advance past it; false at the end of the text. */
static inline bool choice_next(struct choice *out, const char **cursor)
{
    if (**cursor == '\0')
        return false;
    *out = (struct choice){*cursor, strcspn(*cursor, "|")};
    *cursor += out->length;
    *cursor += **cursor == '|';
    return true;
}

/* Return the number of the choice that equals a word exactly, or -1. */
static inline int choice_find(const char *choices, const char *word)
{
    const size_t length = strlen(word);
    struct choice choice;
    for (int i = 0; choice_next(&choice, &choices); i++)
        if (choice.length == length && memcmp(choice.word, word, length) == 0)
            return i;
    return -1;
}

/* Return the choice of this number, or the last one if there are fewer. */
static inline struct choice choice_at(const char *choices, unsigned number)
{
    struct choice choice = {choices, 0};
    for (unsigned i = 0; i <= number && choice_next(&choice, &choices); i++)
        continue;
    return choice;
}

#endif
