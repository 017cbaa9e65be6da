/* SPDX-License-Identifier: MIT */
/*
 * Sorting of millions of numbers under a watch: a radix sort by 16 bits at a time, whose passes can
 * be stopped, unlike qsort.
 */
#ifndef BASE_SORT_H
#define BASE_SORT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/err.h"
#include "base/watch.h"

/* Sort `count` numbers by their upper 32 bits, stably. ERR_MEMORY (it needs as many numbers again),
 * with the numbers unchanged; ERR_CANCELLED, with the numbers undefined. */
enum err sort_by_upper_half(uint64_t *number, size_t count, struct watch *watch,
                            struct fault *fault);

/* Compare two uint64_t, for qsort and bsearch; or two uint32_t, which may begin structures. */
int sort_compare(const void *a, const void *b);
int sort_compare_32(const void *a, const void *b);

/*
 * A map from 64-bit keys to numbers: an open-addressing hash table that grows.
 */

/* {0} is empty. */
struct lookup {
    struct lookup_row *row; /* [rows], a power of 2 */
    size_t rows, used;
};

static const uint32_t LOOKUP_NEW = UINT32_MAX;

/* Return the number of a key, LOOKUP_NEW if it has none yet: the caller then sets it. Valid until
 * the next call. NULL if memory runs out, with the table unchanged. */
uint32_t *lookup_at(struct lookup *lookup, uint64_t key);

/* Remove all keys; the memory is kept. */
void lookup_clear(struct lookup *lookup);
void lookup_release(struct lookup *lookup);

#endif
