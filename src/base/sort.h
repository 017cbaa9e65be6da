/* SPDX-License-Identifier: MIT */
/*
 * Sorting of millions of numbers under a watch: by counting, 16 bits at a time, so that each pass
 * is a loop that can be stopped, which qsort is not.
 */
#ifndef BASE_SORT_H
#define BASE_SORT_H

#include <stddef.h>
#include <stdint.h>

#include "base/err.h"
#include "base/watch.h"

/* Puts `count` numbers in the order of their upper 32 bits; those that are equal there keep their
 * order. ERR_MEMORY, as many numbers again, and they are as they were; ERR_CANCELLED, and they are
 * of no use. */
enum err sort_by_upper_half(uint64_t *number, size_t count, struct watch *watch,
                            struct fault *fault);

#endif
