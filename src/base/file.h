/* SPDX-License-Identifier: MIT */
/*
 * The file layer: the only code that writes and syncs. Files that grow are in base/file_log.h.
 *
 * A whole file appears under its name complete, or not at all. Content is written to a draft, a
 * file with a temporary name in the same folder, which is synced and renamed; then the folder is
 * synced. Libraries and other programs write drafts too, by file_draft and file_publish. The draft
 * of a killed process stays until another process writes into that folder and removes it.
 *
 * Invariants
 *   D1 nothing that exists is overwritten unless the caller asked for it (FILE_REPLACE);
 *   D2 at every moment, and after a power loss, the name leads to the former content (or to
 *      nothing) or to the whole new file;
 *   D3 only regular files and folders of the same user are removed whose names are those of drafts
 *      and whose process has ended (owner_state, below); if that cannot be known, after a day
 *      without a change.
 *
 * D1 needs a rename that does not replace. File systems that have none (FUSE, NFS, 9p) get a hard
 * link to the draft instead, which fails too if the name exists. Without hard links, an empty file
 * is created under the name, if it is free, and the draft is renamed over it: D1 holds, and so does
 * D2 except in that moment, when a kill or a power loss leaves an empty file.
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

/* Read the whole of `path` into `out` (cleared first). Refuse more than `limit` bytes, folders and
 * devices. */
enum err file_read(struct buf *out, const char *path, size_t limit, struct fault *fault);

/* Open a regular file and return its size. A file that `flags` create is readable by its owner
 * alone. Does not block on a pipe. */
enum err file_open(int *fd, uint64_t *bytes, const char *path, int flags, struct fault *fault);

/* Close a descriptor that is not negative, and make it -1. */
void file_release(int *fd);

/* Read `length` bytes from offset `from`; return the number of bytes read, or -1 and errno. */
ssize_t file_read_at(int fd, void *to, size_t length, uint64_t from);

/* Write `length` bytes as `path`, whole or not at all. FILE_KEEP refuses an existing path. */
enum err file_write(const char *path, const void *bytes, size_t length, enum file_mode mode,
                    struct fault *fault);

/* Write bytes to PATH.KIND-N, with the first N that is free, and return that name: it keeps what
 * `path` held before it was cut or replaced. */
enum err file_write_beside(struct buf *name, const char *path, const char *kind, const void *bytes,
                           size_t length, struct fault *fault);

bool file_exists(const char *path);
bool file_is_missing(const char *path); /* no such name, as far as this process may see */
bool file_begins_with(const char *path, const char *text); /* a regular file that can be read */
bool file_is_folder(const char *path);

/* Return the part of `path` after its last slash, borrowed; out = the folder before it, "." without
 * a slash. */
const char *file_name(const char *path);
void file_folder(struct buf *out, const char *path);

/* Return the ending of its name that is one of "a|b|c", in either case, after at least one other
 * character; NULL if it has none of them. */
const char *file_ending(const char *path, const char *endings);
bool file_is_named(const char *path, const char *endings);

/* out = `name`, with the home folder in place of a leading "~/" if there is one. */
void file_from_home(struct buf *out, const char *name);
bool file_is_from_home(const char *name);

/* Return true if both paths lead to the same existing file or folder. */
bool file_is_same(const char *a, const char *b);

/* Return true if both are regular files with the same bytes. */
bool file_holds_same(const char *a, const char *b);

/* out = `path`, or the target if it is a link. */
void file_real(struct buf *out, const char *path);

/* out = the absolute path without links that `path` leads to, even if no file exists there. */
void file_absolute(struct buf *out, const char *path);

/* Return the folder of the running program. */
enum err file_program_folder(struct buf *out, struct fault *fault);

/* ---- drafts ---- */

/* Check that a file may be written under this name, as far as that is known beforehand: its folder
 * exists, it is not a folder itself, and under FILE_KEEP it does not exist. */
enum err file_may_write(const char *path, enum file_mode mode, struct fault *fault);

/* Fill `draft` with a free temporary name in the folder of `path`, with its extension, if it may be
 * written. Removes abandoned drafts from that folder. */
enum err file_draft(struct buf *draft, const char *path, enum file_mode mode, struct fault *fault);

/* Sync the draft and rename it to its path. On failure the draft is removed. */
enum err file_publish(const char *draft, const char *path, enum file_mode mode,
                      struct fault *fault);
void file_discard(const char *draft);

/* The same as with FILE_REPLACE, for names in a folder that the caller has open: it does not follow
 * a link that replaced the folder meanwhile. */
enum err file_publish_in(int folder, const char *draft, const char *path, struct fault *fault);

/* Rename a synced file to a name in its folder that must be free. On failure the old name stays. */
enum err file_rename_new(const char *path, const char *name, struct fault *fault);

/* Keep the present content of `path` under a second name (by a hard link, or by a copy), so that
 * it survives a replacement; and restore it. The caller discards a backup that is not needed. */
enum err file_backup(struct buf *backup, const char *path, struct fault *fault);
enum err file_restore(const char *backup, const char *path, struct fault *fault);

/* Remove the drafts in a folder whose processes have ended (D3). */
void file_sweep(const char *folder);

/* ---- folders ---- */

/* Sync the folder of `path`, so that a new name in it survives. File systems that cannot sync a
 * folder return EINVAL, which counts as success. */
enum err file_sync_folder(const char *path, struct fault *fault);

/* Make a folder and sync its name to the disk. OK if it exists. */
enum err file_make_folder(const char *path, struct fault *fault);

/* Make the folder and its missing parents, for their owner alone. OK if it exists. */
enum err folder_make_private(const char *path, struct fault *fault);

/* Remove a file, or a folder with all below it on the same file system, without following links. */
void folder_remove(const char *path);

/* path = a new folder below `below`, or if that is NULL below $TMPDIR or /tmp, which no other user
 * can open. On failure `path` is empty. */
enum err folder_fresh(struct buf *path, const char *below, struct fault *fault);

/* The same for a temporary folder, which the caller removes: if this process is killed before, a
 * later process that makes such a folder there removes it (D3). */
enum err folder_temporary(struct buf *path, const char *below, struct fault *fault);

/* The same for a folder that is kept if it is not empty when folder_release is called: until then
 * an empty file in it names the process that holds it. If that process is killed, a later one that
 * makes such a folder there removes it. */
enum err folder_held(struct buf *path, const char *below, struct fault *fault);

/* Release the folder: keep it unless it is empty. True if it is kept. */
bool folder_release(const char *path);

/* ---- steps ---- */

/*
 * The steps that can fail, of the file layer (file*.c) and of callers that have a library write a
 * draft. Each step calls the hook first, so that tests reach every one: a non-zero result is the
 * errno with which the step fails. NULL (the default): no hook.
 */
enum file_step {
    FILE_STEP_OPEN,
    FILE_STEP_WRITE,
    FILE_STEP_SYNC,
    FILE_STEP_RENAME,
    FILE_STEP_RENAME_NEW, /* to a name that must be free */
    FILE_STEP_LINK,
    FILE_STEP_LOCK,
    FILE_STEP_CUT,
    FILE_STEP_SYNC_FOLDER /* the folder that holds `path` */
};
extern int (*file_step_hook)(enum file_step step, const char *path);

/* Call the hook; true, with errno set, if the step is to fail. */
bool file_step_fails(enum file_step step, const char *path);

/* Return a descriptor that no child inherits, or -1 and errno. */
int file_step_open(const char *path, int flags);

/* Write all of `length` bytes; false and errno on failure, when some of them may be written. */
bool file_step_write(int fd, const char *path, const char *bytes, size_t length);

/* Sync the content of `fd` to the disk; false and errno on failure. */
bool file_step_sync(int fd, const char *path);

/* Cut the file to `length` bytes; false and errno on failure. */
bool file_step_cut(int fd, const char *path, uint64_t length);

/*
 * The owner of a file: a word in the file's name that identifies the process that made it, so that
 * another process can find out if it still runs, and remove the files of a killed one.
 *
 *     5b1f0e3c2a79d04-4d2-1a2b3c     the system, the process, its start time
 *
 * The first part has three times five digits: hashes of the machine's names, of the boot identifier
 * and of the process name space (each container has its own). Process and start time, in
 * hexadecimal, are those of /proc/PID/stat, so a process with a recycled number is not mistaken for
 * an earlier one.
 */

enum owner_state {
    OWNER_LIVES,
    OWNER_IS_GONE,  /* it has ended, or its machine was restarted since */
    OWNER_IS_HIDDEN /* on another machine or in another container: unknown here */
};

/* Append the word of this process. */
void owner_write(struct buf *out);

/* Read such a word at *cursor, as base/scan.h does, and find out the state of its process. */
bool owner_read(const char **cursor, enum owner_state *state);

#endif
