/* SPDX-License-Identifier: MIT */
/*
 * Orphan golden images: pictures in a journal's folder of golden images that none of its records
 * names (command/golden_files.h). Hidden files, drafts among them, are passed over, and so is the
 * image of a `golden` that was killed after the last record, where it and its PNG are what that
 * command draws: it is drawn again.
 */
#ifndef VERIFY_ORPHAN_H
#define VERIFY_ORPHAN_H

#include "command/interpreter.h"

struct orphan_search {
    struct interpreter *interp; /* after a replay of the journal */
    const char *journal;
    bool is_strict;    /* every file that no record names is one, not pictures alone */
    struct buf *lines; /* comments on what is passed over; NULL where orphans are to be removed:
                          then nothing is passed over, and an orphan is no failure */
};

/* Adds the names of all, as "third.exr", each ended by NUL, in their order; none where there is no
 * folder. ERR_CHECK, with the first in words, where there are any. A journal whose folder is a link
 * has none, and a comment says so: ERR_CHECK where that is strict. A journal that is a link fails
 * with ERR_CHECK where golden images are next to the link as well and are not the same. ERR_LIMIT,
 * ERR_IO, ERR_MEMORY: then no names are added. */
enum err orphan_find(struct buf *orphans, const struct orphan_search *search, struct fault *fault);

/* Removes one that orphan_find has named, and of an image its PNG. ERR_CHECK for one that this
 * journal cannot have made, and for a journal that is a link: it is left alone. */
enum err orphan_remove(const char *journal, const char *orphan, struct fault *fault);

#endif
