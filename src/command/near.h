/* SPDX-License-Identifier: MIT */
/*
 * Which of the words that are known a misspelt one was meant to be.
 *
 * Words are near by the letters that were left out, typed needlessly, mistaken, or swapped with
 * their neighbour: one in a word of three to five bytes, two in one of up to eight, three in a
 * longer one. Capitals count for small letters. The beginning of a word, from two bytes on, is as
 * near as one mistake.
 *
 *     struct near near = near_to("sede");
 *     near_try(&near, "seed", 4);        each that is known
 *     near_append(&near, "", fault);     "; did you mean seed?", or nothing
 */
#ifndef COMMAND_NEAR_H
#define COMMAND_NEAR_H

#include <stddef.h>

#include "base/buf.h"
#include "base/err.h"

enum { NEAR_MOST = 3, NEAR_BYTES_MOST = 63 };

struct near {
    const char *word;
    unsigned mistakes; /* of those found, fewer than of any other */
    size_t count;
    struct {
        const char *word;
        size_t length;
    } found[NEAR_MOST + 1]; /* where there is one more, none is offered: too many are as near */
};

/* What is tried is borrowed, as the word is; twice the same counts once. */
struct near near_to(const char *word);
void near_try(struct near *near, const char *known, size_t length);
void near_try_choices(struct near *near, const char *choices); /* "a|b|c" */

/* Where the word is one of the choices, `known` was meant, and nothing else that is tried. */
void near_lead(struct near *near, const char *choices, const char *known);

/* Adds "; did you mean a, b or c?" to the words of a fault, each word followed by `ending`: "=" for
 * keys; nothing where no word is near, or too many. Returns its code. */
enum err near_append(const struct near *near, const char *ending, struct fault *fault);

/* The other way: adds the words that near_append has put into such a text, each ended by NUL. */
void near_offered(struct buf *out, const char *text);

#endif
