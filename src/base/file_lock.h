/* SPDX-License-Identifier: MIT */
/*
 * The lock of a file that one process writes.
 *
 * It is the system's (flock), which ends with the process, so that a crash leaves nothing stale. A
 * child that is just being started holds it along until it runs its own program: so it is waited
 * for, FILE_LOCK_PATIENCE_MS and no longer.
 *
 * Some file systems have no locks (NFS without its lock daemon, some of FUSE). There a file
 * FILE.lock is made, which must not exist, and names its process (base/owner.h) and machine. One
 * whose process has ended, as far as that can be seen from here, is taken away; another is left,
 * with words that name it.
 */
#ifndef BASE_FILE_LOCK_H
#define BASE_FILE_LOCK_H

#include <stdbool.h>

#include "base/err.h"

enum { FILE_LOCK_PATIENCE_MS = 250 };

struct file_lock {
    char *path; /* of FILE.lock, where that is the lock, or NULL */
};

/* Locks the open file, which lies at `path`. ERR_IO, with words that say who holds it. */
enum err file_lock_take(struct file_lock *lock, int fd, const char *path, struct fault *fault);

/* Fine where it was not taken. The system's lock goes with the descriptor. */
void file_lock_release(struct file_lock *lock);

#endif
