/* SPDX-License-Identifier: MIT */
/*
 * Work that is stopped: a watch with `.context = &looks, .poll = stop_after_looks` goes on at the
 * next `looks` looks at it, and stops at the one after them. Stories try 0, 1, 2, ... until what
 * they are about comes to its end.
 */
#ifndef TESTS_STOPPING_H
#define TESTS_STOPPING_H

#include "base/watch.h"

static inline bool stop_after_looks(void *context, const char *what, uint64_t done, uint64_t total)
{
    (void)what, (void)done, (void)total;
    return --*(int *)context < 0;
}

#endif
