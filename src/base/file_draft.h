/*
 * Publishing: a whole file appears under its name complete, or not at all.
 *
 * What is written goes into a draft, a file of a temporary name in the same folder, which is
 * synced, renamed, and the folder synced. A draft of a process that was killed stays, until some
 * process writes into that folder, which clears it away.
 *
 * Invariants
 *   D1 nothing that exists is overwritten unless the caller asked for it (FILE_REPLACE);
 *   D2 at every moment, and after a loss of power, the name leads to what was there before (or to
 *      nothing) or to the whole new file;
 *   D3 only regular files and folders of the same user are cleared away whose names are those of
 *      drafts, and whose process has ended (base/owner.h); where nobody can say, after a day
 *      without a change.
 *
 * Where D1 needs a name to be new, the system is asked to rename without replacing. File systems
 * that cannot (FUSE, NFS, 9p) are given a second name for the draft instead (a hard link), which
 * fails as well where the name is taken. Where there are no hard links either, an empty file is
 * made under the name, if there is none, and the draft renamed over it: D1 holds, and D2 but for
 * that moment, in which a kill or a loss of power leaves an empty file.
 */
#ifndef BASE_FILE_DRAFT_H
#define BASE_FILE_DRAFT_H

#include "base/file.h"

/* Whether a file may be written under this name, as far as that is known before: its folder is
 * there, it is no folder itself, and under FILE_KEEP there is none. */
enum err file_may_write(const char *path, enum file_mode mode, struct fault *fault);

/* Fills `draft` with a free temporary name beside `path` that has its extension, where it may be
 * written. Clears away what others left in that folder. */
enum err file_draft(struct buf *draft, const char *path, enum file_mode mode, struct fault *fault);

/* Makes a folder with such a name in `folder`, for its owner alone: for what is only passing. On
 * failure `draft` is empty. */
enum err file_draft_folder(struct buf *draft, const char *folder, struct fault *fault);

/* Makes a folder `iftty-XXXXXX` in `folder`, for its owner alone, that is to stay if anything is in
 * it when the process is done: until file_release_folder it has an empty file in it whose name says
 * which process holds it. Clears away those there whose processes were killed before (D3). On
 * failure `path` is empty. */
enum err file_hold_folder(struct buf *path, const char *folder, struct fault *fault);

/* From now on it stays, unless it is empty: then it goes. True where it stays. */
bool file_release_folder(const char *path);

/* Syncs the draft and gives it its name. On failure there is no draft. */
enum err file_publish(const char *draft, const char *path, enum file_mode mode,
                      struct fault *fault);
void file_discard(const char *draft);

/* A second name for what `path` holds now (a copy, where there are no hard links), so that it
 * outlives being replaced; and back again. The caller discards a backup that is not needed. */
enum err file_backup(struct buf *backup, const char *path, struct fault *fault);
enum err file_restore(const char *backup, const char *path, struct fault *fault);

/* Clears away the drafts in a folder whose processes have ended (D3). */
void file_sweep(const char *folder);

#endif
