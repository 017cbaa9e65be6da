/*
 * What a decoder may ask of the kernel: a short list of calls, by seccomp; others fail with EPERM.
 *
 * Whatever takes the decoder over starts no program and no process, has no network, and neither
 * traces, reads nor signals another process; memory that can be written never becomes a program.
 * Which files it opens is not said here (confine.h). It cannot be taken back.
 */
#ifndef CONFINE_CONFINE_CALLS_H
#define CONFINE_CONFINE_CALLS_H

#include <stdbool.h>

/* Beside those for its own memory, the time, and the descriptors that it holds already: */
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

#endif
