/* SPDX-License-Identifier: MIT */
/*
 * Confinement: from now on this process and all processes it starts can reach only the files it
 * names, and no network; a decoder may make only a short list of kernel calls. Neither can be
 * undone.
 *
 * It protects against errors in our own checks of names, and against a decoder controlled by a
 * hostile file. Landlock restricts files where the kernel has it (Linux 5.13; versions 1 to 6 of
 * its interface, each restricting a little more). It is the second defence: a kernel without
 * Landlock confines nothing and reports that here, so callers check names as well.
 *
 * Seccomp restricts calls; all others fail with EPERM. A controlled decoder cannot start a program
 * or process, has no network, and cannot trace, read or signal another process; writable memory
 * never becomes executable.
 */
#ifndef BASE_CONFINE_H
#define BASE_CONFINE_H

#include <stdbool.h>
#include <stddef.h>

enum confine_right {
    CONFINE_READ = 1,  /* files and folders */
    CONFINE_RUN = 2,   /* start programs */
    CONFINE_WRITE = 4, /* make, write, rename and remove files and folders; no devices, no links */
    CONFINE_EMPTY = 8, /* remove empty folders */
    CONFINE_DEVICE = 16, /* write to a device that is there */
};

/* A file, or a folder with all below it. A missing place is ignored. */
struct confine_place {
    const char *path;
    unsigned rights; /* enum confine_right */
};

/* Return the version of the kernel's Landlock interface, 0 if it has none. */
int confine_version(void);

/* Confine the calling thread and all threads and programs it starts from now on. False, with
 * nothing changed, if the kernel cannot. */
bool confine_to(const struct confine_place *place, size_t places);

/* Calls in addition to those for the decoder's memory, the time, and descriptors that it holds
 * already. confine_to restricts which files it can open. */
enum confine_calls {
    CONFINE_OPEN = 1,    /* open files and folders, and read their status */
    CONFINE_CHANGE = 2,  /* lengthen, rename and remove files; make folders */
    CONFINE_THREADS = 4, /* start threads */
};

/* Return true if this kernel has seccomp and the list is known for this processor. */
bool confine_knows_calls(void);

/* From now on, allow the calling thread and those it starts these calls alone. False if the kernel
 * cannot. */
bool confine_calls(unsigned kinds);

/*
 * Examine the file of an untrusted name, inside one folder only.
 *
 * The name is resolved by openat2 with RESOLVE_BENEATH, or, if the kernel has no openat2, step by
 * step without following links. The file itself is examined, not its name. Nothing is opened for
 * reading: no device is touched, and no pipe blocks.
 */

enum path_kind {
    PATH_IS_FILE,    /* a regular file */
    PATH_IS_MISSING, /* no such file, or it cannot be reached */
    PATH_IS_OUTSIDE, /* the name, or a link on its way, leads out of the folder */
    PATH_IS_FOLDER,
    PATH_IS_SPECIAL, /* a device, pipe or socket */
};

/* True for a relative name without ".." in it. */
bool path_is_inside(const char *name);

/* Find out the kind of `name` below `folder`. */
enum path_kind path_kind_below(const char *folder, const char *name);

/* For tests: true resolves step by step even if the kernel has openat2. */
extern bool path_without_openat2;

#endif
