/* SPDX-License-Identifier: MIT */
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
#ifndef BASE_OWNER_H
#define BASE_OWNER_H

#include "base/buf.h"

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
