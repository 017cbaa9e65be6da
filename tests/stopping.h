/* SPDX-License-Identifier: MIT */
/* A watch that stops: with `.context = &looks, .poll = stop_after_looks` it continues for `looks`
 * looks and stops at the next one. Stories try 0, 1, 2, ... until the work is complete. */
#ifndef TESTS_STOPPING_H
#define TESTS_STOPPING_H

#include "base/watch.h"

static inline bool stop_after_looks(void *context, const char *what, uint64_t done, uint64_t total)
{
    (void)what, (void)done, (void)total;
    return --*(int *)context < 0;
}

#endif
