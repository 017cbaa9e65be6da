/* Orphan golden images: files in a journal's folder of golden images that it does not name. */
#ifndef VERIFY_ORPHAN_H
#define VERIFY_ORPHAN_H

#include "base/buf.h"
#include "base/err.h"

/* `named` holds the names that the journal gives, each ended by NUL. ERR_CHECK with the first
 * orphan (in the order of their names) and how many there are; OK for none, or where there is no
 * such folder. Drafts, whose names begin with a dot, are no golden images. */
enum err orphan_check(const char *journal_path, const struct buf *named, struct fault *fault);

#endif
