/* SPDX-License-Identifier: MIT */
/*
 * From 64-bit keys to numbers: an open hash table that grows.
 */
#ifndef BASE_LOOKUP_H
#define BASE_LOOKUP_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

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
