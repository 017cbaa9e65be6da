/* SPDX-License-Identifier: MIT */
/*
 * The file layer: the one place that writes and syncs. Files that grow are base/file_log.h.
 *
 * A whole file appears under its name complete, or not at all. What is written goes into a draft, a
 * file of a temporary name in the same folder, which is synced, renamed, and the folder synced;
 * content that a library or another program writes does so by file_draft and file_publish. A draft
 * of a process that was killed stays, until some process writes into that folder, which clears it
 * away.
 *
 * Invariants
 *   D1 nothing that exists is overwritten unless the caller asked for it (FILE_REPLACE);
 *   D2 at every moment, and after a loss of power, the name leads to what was there before (or to
 *      nothing) or to the whole new file;
 *   D3 only regular files and folders of the same user are cleared away whose names are those of
 *      drafts, and whose process has ended (base/file.h); where nobody can say, after a day
 *      without a change.
 *
 * Where D1 needs a name to be new, the system is asked to rename without replacing. File systems
 * that cannot (FUSE, NFS, 9p) are given a second name for the draft instead (a hard link), which
 * fails as well where the name is taken. Where there are no hard links either, an empty file is
 * made under the name, if there is none, and the draft renamed over it: D1 holds, and D2 but for
 * that moment, in which a kill or a loss of power leaves an empty file.
 */
#ifndef BASE_FILE_H
#define BASE_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

#include "base/buf.h"
#include "base/err.h"

enum file_mode { FILE_KEEP, FILE_REPLACE };

/* Reads the whole of `path` into `out` (cleared first). More than `limit` bytes, a folder or a
 * device is refused. */
enum err file_read(struct buf *out, const char *path, size_t limit, struct fault *fault);

/* Opens a regular file, of so many bytes; one that `flags` make is for its owner alone. Does not
 * wait for the other end of a pipe, as one may lie there. */
enum err file_open(int *fd, uint64_t *bytes, const char *path, int flags, struct fault *fault);

/* Reads `length` bytes from `from` on: how many there were, or -1 and errno. */
ssize_t file_read_at(int fd, void *to, size_t length, uint64_t from);

/* Writes `length` bytes as `path`, whole or not at all. FILE_KEEP refuses an existing path. */
enum err file_write(const char *path, const void *bytes, size_t length, enum file_mode mode,
                    struct fault *fault);

/* Writes them as PATH.KIND-N, under the first such name that is free, which `name` is then: what
 * `path` held before something was cut off or replaced. */
enum err file_write_beside(struct buf *name, const char *path, const char *kind, const void *bytes,
                           size_t length, struct fault *fault);

bool file_exists(const char *path);
bool file_is_missing(const char *path); /* nothing has that name, as far as one may look */
bool file_begins_with(const char *path, const char *text); /* a regular file that can be read */
bool file_is_folder(const char *path);

/* The part of `path` after its last slash, and the folder before it ("." where there is none). */
const char *file_name(const char *path);
void file_folder(struct buf *out, const char *path);

/* The ending of its name that is one of "a|b|c", in capitals or not, with something before it; NULL
 * where it has none of them. */
const char *file_ending(const char *path, const char *endings);
bool file_is_named(const char *path, const char *endings);

/* out = `name`, which is below the home folder where it begins with "~/", or as it stands where
 * there is none. */
void file_from_home(struct buf *out, const char *name);
bool file_is_from_home(const char *name);

/* Whether both paths lead to one file or folder that is there. */
bool file_is_same(const char *a, const char *b);

/* Whether both are regular files of the same bytes. */
bool file_holds_same(const char *a, const char *b);

/* out = `path`, or what it leads to, where it is a link. */
void file_real(struct buf *out, const char *path);

/* out = the whole path without links that `path` leads to, whether there is a file or not. */
void file_settle(struct buf *out, const char *path);

/* The folder of the running program. */
enum err file_program_folder(struct buf *out, struct fault *fault);

/* ---- drafts ---- */

/* Whether a file may be written under this name, as far as that is known before: its folder is
 * there, it is no folder itself, and under FILE_KEEP there is none. */
enum err file_may_write(const char *path, enum file_mode mode, struct fault *fault);

/* Fills `draft` with a free temporary name beside `path` that has its extension, where it may be
 * written. Clears away what others left in that folder. */
enum err file_draft(struct buf *draft, const char *path, enum file_mode mode, struct fault *fault);

/* Syncs the draft and gives it its name. On failure there is no draft. */
enum err file_publish(const char *draft, const char *path, enum file_mode mode,
                      struct fault *fault);
void file_discard(const char *draft);

/* The same as FILE_REPLACE for names in a folder that the caller has open: a link that took the
 * place of that folder meanwhile is not followed. */
enum err file_publish_in(int folder, const char *draft, const char *path, struct fault *fault);

/* Gives a file, which is synced, another name in its folder, which has to be free. On failure it
 * has the name that it had. */
enum err file_rename_new(const char *path, const char *name, struct fault *fault);

/* A second name for what `path` holds now (a copy, where there are no hard links), so that it
 * outlives being replaced; and back again. The caller discards a backup that is not needed. */
enum err file_backup(struct buf *backup, const char *path, struct fault *fault);
enum err file_restore(const char *backup, const char *path, struct fault *fault);

/* Clears away the drafts in a folder whose processes have ended (D3). */
void file_sweep(const char *folder);

/* ---- folders ---- */

/* Its name is on the disk, too. Fine when it exists. */
enum err file_make_folder(const char *path, struct fault *fault);

/* Makes the folder and those above it that are not there, for their owner alone. Fine when it
 * exists. */
enum err folder_make_private(const char *path, struct fault *fault);

/* Removes a file, or a folder with all that is below it on the same file system; what a link leads
 * to stays. */
void folder_remove(const char *path);

/* path = a new folder below `below`, or where that is NULL, below $TMPDIR or else /tmp, which
 * no other user can open. On failure `path` is empty. */
enum err folder_fresh(struct buf *path, const char *below, struct fault *fault);

/* The same for what is only passing, and is to be removed: where this process is killed before, a
 * later one that makes such a folder there does that (D3). */
enum err folder_passing(struct buf *path, const char *below, struct fault *fault);

/* The same of one that stays if anything is in it when folder_release is called: until then it has
 * an empty file in it whose name says which process holds it, and where that one is killed before,
 * a later one that makes such a folder there removes it. */
enum err folder_held(struct buf *path, const char *below, struct fault *fault);

/* From now on it stays, unless it is empty: then it goes. True where it stays. */
bool folder_release(const char *path);

/* ---- steps ---- */

/*
 * The steps that can fail, for the files of the file layer (file*.c) and those that have a
 * library write a draft. Each asks the hook first, so that tests reach every one of them: a
 * non-zero answer is the errno the step then fails with. NULL (the default) asks nobody.
 */
enum file_step {
    FILE_STEP_OPEN,
    FILE_STEP_WRITE,
    FILE_STEP_SYNC,
    FILE_STEP_RENAME,
    FILE_STEP_RENAME_NEW, /* to a name that has to be free */
    FILE_STEP_LINK,
    FILE_STEP_LOCK,
    FILE_STEP_CUT,
    FILE_STEP_SYNC_FOLDER /* of the folder that holds `path` */
};
extern int (*file_step_hook)(enum file_step step, const char *path);

/* Asks the hook, and sets errno where the step is to fail. */
bool file_step_fails(enum file_step step, const char *path);

/* A descriptor that no child inherits, or -1 and errno. */
int file_step_open(const char *path, int flags);

/* All of `length` bytes, or false and errno; then some of them may have been written. */
bool file_step_write(int fd, const char *path, const char *bytes, size_t length);

/* What was written to `fd` is on the disk, or false and errno. */
bool file_step_sync(int fd, const char *path);

/* Syncs the folder that holds `path`, so that a new name in it survives. File systems that cannot
 * sync a folder answer EINVAL; there is nothing more to do on those. */
bool file_step_sync_folder(const char *path);

/* Cuts the file to `length` bytes, or false and errno. */
bool file_step_cut(int fd, const char *path, uint64_t length);

/*
 * Which process has made a file, as a word for the file's name: so that another process can say
 * whether it still runs, and clear away what it left when it was killed.
 *
 *     5b1f0e3c2a79d04-4d2-1a2b3c     the system, the process, when that began
 *
 * The first part is three times five digits, made from the names of the machine, from what the
 * system chose when it was started, and from the name space of processes (a container has its own).
 * The process and the moment it began, in hexadecimal, are those of /proc/PID/stat: one that has
 * got the number of an earlier process is not taken for it.
 */

enum owner_state {
    OWNER_LIVES,
    OWNER_IS_GONE,  /* it has ended, or its machine was started again since */
    OWNER_IS_HIDDEN /* on another machine or in another container: nobody can say from here */
};

/* Adds the word of this process. */
void owner_write(struct buf *out);

/* Takes such a word at *cursor, as base/scan.h does, and says what has become of its process. */
bool owner_read(const char **cursor, enum owner_state *state);

#endif
