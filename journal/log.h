/*
 * What can be said of a journal without running it: its commands alone, and whether it is whole.
 */
#ifndef JOURNAL_LOG_H
#define JOURNAL_LOG_H

#include "journal/record.h"

/* Adds the commands of a journal or script to `out`, a line each, with their comments and blank
 * lines; header, result lines and a torn tail are left out. What comes out is a script. The bytes
 * are those of the file: use buf_add_safe where they go to a terminal. ERR_INPUT for damage (what
 * was read until there is in `out`), ERR_MEMORY. */
enum err journal_script(struct buf *out, const char *bytes, size_t length, struct fault *fault);

enum journal_state {
    JOURNAL_INTACT,
    JOURNAL_SCRIPT, /* no header and no results: there is nothing to check */
    JOURNAL_TORN,
    JOURNAL_EDITED, /* it can be read, but from `number` on it is not as it was written */
    JOURNAL_DAMAGED /* it cannot be read from `number` on */
};

struct journal_condition {
    enum journal_state state;
    size_t records;            /* sound ones, or commands of a script */
    struct record_chain chain; /* of the last of them */
    unsigned semantics;
    size_t number;   /* where it is not intact: the first record that is not, */
    size_t line;     /* its line */
    uint64_t offset; /* and byte */
    char text[512];  /* the same in words, safe to print */
};

/* OK for what is intact or a script, ERR_CHECK for all else, with the words in fault as well. */
enum err journal_check(struct journal_condition *condition, const char *bytes, size_t length,
                       struct fault *fault);

#endif
