/* SPDX-License-Identifier: MIT */
/*
 * The journals that are verified: those that a user names, and in place of a folder all journals in
 * it and below.
 *
 * A file is a journal by the ending ".iftty", in any letter case. Hidden folders are entered. Links
 * to folders are not, since they may lead out or in a circle: a line names each.
 */
#ifndef VERIFY_JOURNALS_BELOW_H
#define VERIFY_JOURNALS_BELOW_H

#include "base/err.h"
#include "command/script.h"

/* Begins as {0}. */
struct journal_list {
    char **path;
    size_t count, capacity;
};

/* Adds the paths in their order, those below a folder in the order of their names. ERR_CHECK for a
 * folder without journals, ERR_IO for one that cannot be read, ERR_LIMIT, ERR_MEMORY. */
enum err journals_find(struct journal_list *journals, char *const *path, size_t count,
                       const struct printer *printer, struct fault *fault);
void journals_release(struct journal_list *journals);

#endif
