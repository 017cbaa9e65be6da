/* SPDX-License-Identifier: MIT */
/*
 * Find the known word that a misspelt word was meant to be.
 *
 * The distance counts letters left out, added, replaced or swapped with their neighbour: at most
 * one in a word of three to five bytes, two in a word of up to eight, three in a longer one. Case
 * is ignored. A prefix of two bytes or more, in the same case, has distance 1.
 *
 *     struct near near = near_to("sede");
 *     near_try(&near, "seed", 4);        for each known word
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
    unsigned mistakes; /* distance of the words found */
    size_t count;
    struct {
        const char *word;
        size_t length;
    } found[NEAR_MOST + 1]; /* if full, no word is offered: too many are equally near */
};

/* Words are borrowed. Trying a word twice counts once. */
struct near near_to(const char *word);
void near_try(struct near *near, const char *known, size_t length);
void near_try_choices(struct near *near, const char *choices); /* "a|b|c" */

/* If the word is one of the choices, `known` is the only word offered. */
void near_lead(struct near *near, const char *choices, const char *known);

/* Add "; did you mean a, b or c?" to the words of a fault, each word followed by `ending`, "=" for
 * keys; nothing if no word is near, or too many are. Return its code; ERR_USAGE without a fault. */
enum err near_append(const struct near *near, const char *ending, struct fault *fault);

/* Add those of the choices that are near a word. */
enum err near_append_choices(const char *word, const char *choices, struct fault *fault);

/* Add the words that near_append has put into the text, each ended by NUL. */
void near_offered(struct buf *out, const char *text);

#endif
