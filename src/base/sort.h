/* SPDX-License-Identifier: MIT */
/*
 * Sorting of millions of numbers under a watch: by counting, 16 bits at a time, so that each pass
 * is a loop that can be stopped, which qsort is not.
 */
#ifndef BASE_SORT_H
#define BASE_SORT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/err.h"
#include "base/watch.h"

/* Puts `count` numbers in the order of their upper 32 bits; those that are equal there keep their
 * order. ERR_MEMORY, as many numbers again, and they are as they were; ERR_CANCELLED, and they are
 * of no use. */
enum err sort_by_upper_half(uint64_t *number, size_t count, struct watch *watch,
                            struct fault *fault);

/*
 * From 64-bit keys to numbers: an open hash table that grows.
 */

/* {0} is empty. */
struct lookup {
    struct lookup_row *row; /* [rows], a power of 2 */
    size_t rows, used;
};

static const uint32_t LOOKUP_NEW = UINT32_MAX;

/* The number of a key, which is LOOKUP_NEW where it has none yet: the caller then says it. Of use
 * until the next call. NULL where memory runs out, and all is as it was. */
uint32_t *lookup_at(struct lookup *lookup, uint64_t key);

/* No key has a number; the memory is kept. */
void lookup_clear(struct lookup *lookup);
void lookup_release(struct lookup *lookup);

#endif
