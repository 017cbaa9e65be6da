/*
 * Who holds the lock on a file: asked of the kernel (/proc/locks) at the moment it matters, so
 * that a crash leaves nothing stale behind. A note in a file beside it would outlive its writer.
 */
#ifndef BASE_HOLDER_H
#define BASE_HOLDER_H

#include <stdbool.h>
#include <sys/stat.h>

#include "base/buf.h"

/* Adds "process 4711 (iftty)" to `out` and returns true where a process of this machine holds an
 * exclusive flock on the file of `status`. False where none can be found: another machine on a
 * shared disk, another container, a system without /proc/locks. */
bool holder_find(struct buf *out, const struct stat *status);

#endif
