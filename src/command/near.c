/* SPDX-License-Identifier: MIT */
#include "command/near.h"

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "base/choice.h"
#include "base/least.h"
#include "base/mem.h"

/* Largest distance for a word of this length. */
static unsigned limit_for(size_t length)
{
    return length < 3 ? 0 : length < 6 ? 1 : length < 9 ? 2 : 3;
}

struct near near_to(const char *word)
{
    return (struct near){.word = word, .mistakes = limit_for(strlen(word)) + 1};
}

static char small(char c)
{
    return c >= 'A' && c <= 'Z' ? (char)(c - 'A' + 'a') : c;
}

/* Compute the distance of `a` and `b` by the table of distances of their prefixes, keeping
 * three rows. No byte is edited twice. */
static unsigned mistakes_between(const char *a, size_t a_length, const char *b, size_t b_length)
{
    unsigned row[3][NEAR_BYTES_MOST + 1] = {{0}};
    unsigned *two_up = row[0], *up = row[1], *now = row[2];
    for (size_t j = 0; j <= b_length; j++)
        up[j] = (unsigned)j;
    for (size_t i = 1; i <= a_length; i++) {
        now[0] = (unsigned)i;
        for (size_t j = 1; j <= b_length; j++) {
            const char x = small(a[i - 1]), y = small(b[j - 1]);
            now[j] = least(least(up[j], now[j - 1]) + 1, up[j - 1] + (x != y));
            if (i > 1 && j > 1 && x == small(b[j - 2]) && y == small(a[i - 2]))
                now[j] = least(now[j], two_up[j - 2] + 1);
        }
        unsigned *const free_row = two_up;
        two_up = up;
        up = now;
        now = free_row;
    }
    return up[b_length];
}

static unsigned mistakes_of(const char *word, const char *known, size_t length)
{
    const size_t typed = strlen(word), limit = limit_for(typed);
    const bool begins = typed >= 2 && typed < length && memcmp(known, word, typed) == 0;
    unsigned mistakes = begins ? 1 : UINT32_MAX;
    if (typed <= NEAR_BYTES_MOST && length <= NEAR_BYTES_MOST && typed <= length + limit &&
        length <= typed + limit && limit > 0) {
        const unsigned between = mistakes_between(word, typed, known, length);
        mistakes = least(mistakes, between <= limit ? between : UINT32_MAX);
    }
    return mistakes;
}

void near_try(struct near *near, const char *known, size_t length)
{
    const unsigned mistakes = length ? mistakes_of(near->word, known, length) : UINT32_MAX;
    if (mistakes == UINT32_MAX || (near->count > 0 && mistakes > near->mistakes))
        return;
    if (near->count == 0 || mistakes < near->mistakes)
        near->count = 0;
    near->mistakes = mistakes;
    for (size_t i = 0; i < near->count; i++)
        if (near->found[i].length == length && memcmp(near->found[i].word, known, length) == 0)
            return;
    if (near->count <= NEAR_MOST) {
        near->found[near->count].word = known;
        near->found[near->count++].length = length;
    }
}

void near_try_choices(struct near *near, const char *choices)
{
    struct choice choice;
    while (choice_next(&choice, &choices))
        near_try(near, choice.word, choice.length);
}

void near_lead(struct near *near, const char *choices, const char *known)
{
    if (choice_find(choices, near->word) < 0)
        return;
    near->mistakes = 0;
    near->count = 1;
    near->found[0].word = known;
    near->found[0].length = strlen(known);
}

#define OFFER "; did you mean "

enum err near_append(const struct near *near, const char *ending, struct fault *fault)
{
    OWNED(buf_release) struct buf words = {0};
    if (!fault)
        return ERR_USAGE;
    const size_t count = near->count > NEAR_MOST ? 0 : near->count;
    for (size_t i = 0; i < count; i++) {
        buf_add_text(&words, i == 0 ? OFFER : i + 1 == count ? " or " : ", ");
        buf_add_safe(&words, near->found[i].word, near->found[i].length);
        buf_add_text(&words, ending);
    }
    buf_add_text(&words, count ? "?" : "");
    if (!words.failed)
        fault_append(fault, buf_text(&words));
    return fault->code;
}

enum err near_append_choices(const char *word, const char *choices, struct fault *fault)
{
    struct near near = near_to(word);
    near_try_choices(&near, choices);
    return near_append(&near, "", fault);
}

void near_offered(struct buf *out, const char *text)
{
    const char *at = strstr(text, OFFER);
    if (!at || !strchr(at, '?'))
        return;
    at += strlen(OFFER);
    while (*at != '?') {
        const char *end = at;
        while (*end != '?' && strncmp(end, ", ", 2) != 0 && strncmp(end, " or ", 4) != 0)
            end++;
        buf_add(out, at, (size_t)(end - at));
        buf_add_char(out, '\0');
        at = *end == '?' ? end : end + (*end == ',' ? 2 : 4);
    }
}
