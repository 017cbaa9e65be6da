/*
 * The file layer: the one place that writes and syncs.
 *
 * A whole file appears complete or not at all; base/file_draft.h says how, and does it for content
 * that a library or another program writes. Files that grow are base/file_log.h.
 *
 * Invariants
 *   F1 nothing that exists is overwritten unless the caller asked for it (FILE_REPLACE);
 *   F2 after a failure the target is what it was before.
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
bool file_begins_with(const char *path, const char *text); /* a regular file that can be read */
bool file_is_folder(const char *path);
/* Its name is on the disk, too. Fine when it exists. */
enum err file_make_folder(const char *path, struct fault *fault);

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

/* out = `path`, or what it leads to, where it is a link. */
void file_real(struct buf *out, const char *path);

/* The folder of the running program. */
enum err file_program_folder(struct buf *out, struct fault *fault);

/*
 * The steps that can fail, for the files of the file layer (file_*.c, folder.c) and those that have
 * a library write a draft. Each asks the hook first, so that tests reach every one of them: a
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

#endif
