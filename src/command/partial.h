/*
 * A command that is being typed, as far as the cursor: which words are whole, which parameters they
 * fill, and what the word at the cursor is about to be. For completion and hints.
 */
#ifndef COMMAND_PARTIAL_H
#define COMMAND_PARTIAL_H

#include "command/command.h"

struct partial {
    const struct command *command;       /* that the first word names, where it is whole; or NULL */
    unsigned words;                      /* whole ones before the cursor */
    struct value value[PARAMETERS_MOST]; /* only `given` is set: by whole words */

    struct buf word; /* at the cursor, without its quotes; empty after a blank */
    size_t start;    /* the byte of the line where it begins, with the quote that it may have */
    bool quoted;     /* it begins with a quote, */
    bool closed;     /* which has ended: nothing can be added to the word */
    int parameter;   /* that it would fill, or -1 */
    size_t key;      /* bytes of `word` that are "radius=" */
};

/* Reads line[0..cursor). False without memory, in a comment, and after a quote that something else
 * than a blank follows. The caller releases `partial`, whatever comes of it. */
bool partial_read(struct partial *partial, const char *line, size_t cursor);

/* The parameter is given as this word; so nothing more is to be said of it, nor of one that is
 * paired with it and goes without saying. */
void partial_give(struct partial *partial, int parameter, const char *word);
void partial_release(struct partial *partial);

#endif
