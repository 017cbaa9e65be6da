/* SPDX-License-Identifier: MIT */
#include "base/choice.h"

#include <string.h>

bool choice_next(struct choice *out, const char **cursor)
{
    if (**cursor == '\0')
        return false;
    *out = (struct choice){*cursor, strcspn(*cursor, "|")};
    *cursor += out->length;
    *cursor += **cursor == '|';
    return true;
}

int choice_find(const char *choices, const char *word)
{
    const size_t length = strlen(word);
    struct choice choice;
    for (int i = 0; choice_next(&choice, &choices); i++)
        if (choice.length == length && memcmp(choice.word, word, length) == 0)
            return i;
    return -1;
}

struct choice choice_at(const char *choices, unsigned number)
{
    struct choice choice = {choices, 0};
    for (unsigned i = 0; i <= number && choice_next(&choice, &choices); i++)
        ;
    return choice;
}
