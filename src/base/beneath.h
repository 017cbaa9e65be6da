/* SPDX-License-Identifier: MIT */
/*
 * Beneath: what a name that a stranger gives is, below one folder and nowhere else.
 *
 * Resolved by openat2 with RESOLVE_BENEATH, or, where the kernel does not have it, step by step
 * without following any link; what is looked at is the file itself, not its name. Nothing is
 * opened for reading: no device is touched, and no pipe waited for.
 */
#ifndef BASE_BENEATH_H
#define BASE_BENEATH_H

#include <stdbool.h>

enum beneath {
    BENEATH_FINE,    /* a regular file */
    BENEATH_MISSING, /* there is none, or it cannot be reached */
    BENEATH_OUTSIDE, /* the name, or a link on the way, leads out of the folder */
    BENEATH_FOLDER,
    BENEATH_NO_FILE, /* a device, pipe or socket */
};

/* True for a relative name without ".." in it. */
bool beneath_is_inside(const char *name);

/* What `name` below `folder` is. */
enum beneath beneath_look(const char *folder, const char *name);

/* For tests: true goes step by step though the kernel has openat2. */
extern bool beneath_without_openat2;

#endif
