/* SPDX-License-Identifier: MIT */
/*
 * Confinement: from now on this process and all that it starts can reach only the files that it
 * names, and no network; and a decoder may make a short list of the kernel's calls alone. Neither
 * can be taken back.
 *
 * Protects against: an error in our own checks of names, and a decoder that a hostile file takes
 * over. Files by Landlock, where the kernel has it (Linux 5.13; versions 1 to 6 of its interface,
 * each of which restricts a little more). It is the second defence: the caller checks names as
 * well, since a kernel without Landlock confines nothing, and says so here.
 *
 * Calls by seccomp; others fail with EPERM. Whatever takes the decoder over starts no program and
 * no process, has no network, and neither traces, reads nor signals another process; memory that
 * can be written never becomes a program.
 */
#ifndef CONFINE_CONFINE_H
#define CONFINE_CONFINE_H

#include <stdbool.h>
#include <stddef.h>

enum confine_right {
    CONFINE_READ = 1,  /* files and folders */
    CONFINE_RUN = 2,   /* start programs */
    CONFINE_WRITE = 4, /* make, write, rename and remove files and folders; no devices, no links */
    CONFINE_EMPTY = 8, /* remove empty folders */
    CONFINE_DEVICE = 16, /* write to a device that is there */
};

/* A file, or a folder with all below it. One that is not there is passed over. */
struct confine_place {
    const char *path;
    unsigned rights; /* enum confine_right */
};

/* The version of the kernel's interface, 0 where it has none. */
int confine_version(void);

/* Confines the calling thread and the threads and programs that it starts from now on. False where
 * the kernel does not: nothing has changed then. */
bool confine_to(const struct confine_place *place, size_t places);

/* Calls beside those for a decoder's own memory, the time, and the descriptors that it holds
 * already. Which files it opens is what confine_to says. */
enum confine_calls {
    CONFINE_OPEN = 1,    /* open files and folders, and see what they are */
    CONFINE_CHANGE = 2,  /* lengthen, rename and remove files, make folders */
    CONFINE_THREADS = 4, /* start threads */
};

/* Whether this kernel can, and the list is known for this processor. */
bool confine_knows_calls(void);

/* From now on, the calling thread and those that it starts have these alone. False where that
 * cannot be had. */
bool confine_calls(unsigned kinds);

/*
 * Beneath: what a name that a stranger gives is, below one folder and nowhere else.
 *
 * Resolved by openat2 with RESOLVE_BENEATH, or, where the kernel does not have it, step by step
 * without following any link; what is looked at is the file itself, not its name. Nothing is
 * opened for reading: no device is touched, and no pipe waited for.
 */

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
