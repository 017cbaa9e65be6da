/* SPDX-License-Identifier: MIT */
/* Orphan golden images: files in a journal's folder of golden images that it does not name, and
 * PNGs there beside which no golden image lies. Drafts, whose names begin with a dot, are none. */
#ifndef VERIFY_ORPHAN_H
#define VERIFY_ORPHAN_H

#include "command/interpreter.h"
#include "verify/name_list.h"

/* The names of all, as "third.exr", after a replay, by which the interpreter knows those that the
 * journal gives; none where there is no such folder. What a `golden` that was killed has left
 * (command/golden_judge.h) is passed over with a line of comment in `lines`, or, where that is
 * NULL, is one of them. ERR_IO, ERR_MEMORY. To be released, whatever is returned. */
enum err orphan_find(struct name_list *orphans, const struct interpreter *interp,
                     const char *journal_path, struct buf *lines, struct fault *fault);

/* ERR_CHECK with the first of them, where there are any. */
enum err orphan_judge(const struct name_list *orphans, const char *journal_path,
                      struct fault *fault);

/* Both. */
enum err orphan_check(const struct interpreter *interp, const char *journal_path, struct buf *lines,
                      struct fault *fault);

/* Removes one that orphan_find has named, and the PNG beside it. */
enum err orphan_remove(const char *journal_path, const char *orphan, struct fault *fault);

#endif
