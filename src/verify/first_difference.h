/* SPDX-License-Identifier: MIT */
/*
 * The first record in which two journals differ. Nothing is carried out.
 *
 * FIRST_COMMAND: commands alone are compared; comments, results and digests may differ. A journal
 * holds commands in canonical form. Those of a script are compared word by word, however they are
 * spaced and quoted, and those that no journal records (a question, say) are skipped, so that a
 * script and the journal it made are the same.
 *
 * FIRST_RECORD: commands and results are compared; comments may differ, and so the chains. Both
 * have to be journals, each record of which is as it was written.
 */
#ifndef VERIFY_FIRST_DIFFERENCE_H
#define VERIFY_FIRST_DIFFERENCE_H

#include <stdbool.h>
#include <stddef.h>

#include "base/buf.h"
#include "base/err.h"
#include "command/script.h"

enum first_of { FIRST_COMMAND, FIRST_RECORD };

struct first_difference {
    bool is_there;
    size_t same; /* commands before it that are the same, or all */
    struct {
        bool goes_on;               /* it has a command there: */
        size_t number, line;        /* in its file, from 1 */
        struct buf command, result; /* as the file holds them: not safe to print */
    } side[2];
};

/* `first` begins as {0}, and is to be released whatever is returned. Commands after number `last`
 * are not compared; 0 for all. ERR_INPUT for what cannot be read, or is not sound, with the name of
 * its file, ERR_MEMORY. A torn tail is left alone. */
enum err first_difference_find(struct first_difference *first, enum first_of of,
                               const char *const name[2], const struct buf bytes[2], size_t last,
                               struct fault *fault);

/* The same of the files at `path`. */
enum err first_difference_of_files(struct first_difference *first, enum first_of of,
                                   const char *const name[2], const char *const path[2],
                                   size_t last, struct fault *fault);
void first_difference_release(struct first_difference *first);

/* Prints the first record that differs as TAP of one test. OK when both journals give the same,
 * ERR_CHECK with the first that differs when not, ERR_INPUT for a journal that is not sound. */
enum err bisect_journals(const char *a, const char *b, const struct printer *printer,
                         struct fault *fault);

#endif
