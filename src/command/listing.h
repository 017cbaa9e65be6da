/*
 * The names in a folder, for completion: those that begin as something typed does.
 *
 * Only names that a command can hold: no control characters, nothing that is not UTF-8. A name that
 * begins with a dot only for who typed the dot.
 */
#ifndef COMMAND_LISTING_H
#define COMMAND_LISTING_H

#include <stddef.h>

#include "base/buf.h"

enum { LISTING_MOST = 20000 }; /* names; a larger folder is listed in part */

struct listing {
    struct buf store;  /* the names, each ended by NUL; a folder's ends in / */
    const char **name; /* numbers in them in order */
    size_t count;
};

/* Without memory, or where the folder cannot be read, an empty one. Released by the caller. */
void listing_read(struct listing *listing, const char *folder, const char *begin);
void listing_release(struct listing *listing);

#endif
