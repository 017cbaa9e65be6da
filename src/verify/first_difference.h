/*
 * The first command in which two journals differ. Nothing is carried out.
 *
 * Commands alone are compared: comments, results and digests may differ (for those there is
 * `verify --bisect`). A journal holds commands in canonical form. Those of a script are compared
 * word by word, however they are spaced and quoted, and those that no journal records (a question,
 * say) are skipped, so that a script and the journal it made are the same.
 */
#ifndef VERIFY_FIRST_DIFFERENCE_H
#define VERIFY_FIRST_DIFFERENCE_H

#include <stdbool.h>
#include <stddef.h>

#include "base/buf.h"
#include "base/err.h"

struct first_difference {
    bool is_there;
    size_t same; /* commands before it that are the same, or all */
    struct {
        bool goes_on;        /* it has a command there: */
        size_t number, line; /* in its file, from 1 */
        struct buf command;  /* its words, as the file holds them: not safe to print */
    } side[2];
};

/* `first` begins as {0}, and is to be released whatever is returned. Commands after number `last`
 * are not compared; 0 for all. ERR_INPUT for what cannot be read, with the name of its file,
 * ERR_MEMORY. A torn tail is left alone. */
enum err first_difference_find(struct first_difference *first, const char *const name[2],
                               const struct buf bytes[2], size_t last, struct fault *fault);
void first_difference_release(struct first_difference *first);

#endif
