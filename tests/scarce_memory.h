/* SPDX-License-Identifier: MIT */
/* Memory that runs out: allow_allocations(n) lets the next `n` allocations of base/mem succeed and
 * makes all later ones fail, until mem_allows is NULL again. Stories try n = 0, 1, 2, ... until
 * the tested call succeeds. */
#ifndef TESTS_SCARCE_MEMORY_H
#define TESTS_SCARCE_MEMORY_H

#include <stdatomic.h>

#include "base/mem.h"

static atomic_size_t allocations_left; /* threads allocate too */

static inline bool takes_one_allocation(size_t bytes)
{
    (void)bytes;
    size_t left = allocations_left;
    while (left > 0 && !atomic_compare_exchange_weak(&allocations_left, &left, left - 1))
        ;
    return left > 0;
}

static inline void allow_allocations(size_t count)
{
    allocations_left = count;
    mem_allows = takes_one_allocation;
}

/* Lets the allocation after the next `count` fail, and all later ones succeed. */
static inline bool fails_once(size_t bytes)
{
    (void)bytes;
    return allocations_left-- != 0;
}

static inline void fail_allocation(size_t count)
{
    allocations_left = count;
    mem_allows = fails_once;
}

/* Lets all allocations succeed and counts them in `allocations_made`. */
static atomic_size_t allocations_made;

static inline bool counts_allocation(size_t bytes)
{
    (void)bytes;
    allocations_made++;
    return true;
}

static inline void count_allocations(void)
{
    allocations_made = 0;
    mem_allows = counts_allocation;
}

/* Lets the next allocations succeed until they add up to so many bytes; for one thread. */
static size_t bytes_left;

static inline bool takes_bytes(size_t bytes)
{
    const bool fits = bytes <= bytes_left;
    bytes_left -= fits ? bytes : 0;
    return fits;
}

static inline void allow_bytes(size_t bytes)
{
    bytes_left = bytes;
    mem_allows = takes_bytes;
}

#endif
