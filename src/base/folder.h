/*
 * Folders: those of plain files, as golden images lie in, copied whole or not at all; and new ones,
 * for files that are to be found there, or for what is only passing.
 */
#ifndef BASE_FOLDER_H
#define BASE_FOLDER_H

#include "base/buf.h"
#include "base/err.h"

/* Makes the folder `to`, which must not exist, with a copy of every regular file in `from`, each
 * synced; folders within are left out. On failure there is no `to`. */
enum err folder_copy(const char *from, const char *to, struct fault *fault);

/* Removes a folder that folder_copy made. */
void folder_discard(const char *path);

/* Makes the folder and those above it that are not there, for their owner alone. Fine when it
 * exists. */
enum err folder_make_private(const char *path, struct fault *fault);

/* path = a new folder below `below`, or where that is NULL, below $TMPDIR or else /tmp, which
 * no other user can open. On failure `path` is empty. */
enum err folder_fresh(struct buf *path, const char *below, struct fault *fault);

/* The same of one that stays if anything is in it when file_release_folder is called; where this
 * process is killed before, a later one that makes such a folder removes it. */
enum err folder_held(struct buf *path, struct fault *fault);

/* The same for what is only passing, and is to be removed: where this process is killed before, a
 * later one that makes such a folder there does that (base/file_draft.h). */
enum err folder_passing(struct buf *path, const char *below, struct fault *fault);

/* Removes a file, or a folder with all that is below it on the same file system; what a link leads
 * to stays. */
void folder_remove(const char *path);

#endif
