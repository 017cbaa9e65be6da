/* SPDX-License-Identifier: MIT */
/* Return the smaller of two numbers. */
#ifndef BASE_LEAST_H
#define BASE_LEAST_H

#include <stdint.h>

static inline uint32_t least(uint32_t a, uint32_t b)
{
    return a < b ? a : b;
}

static inline uint64_t least_64(uint64_t a, uint64_t b)
{
    return a < b ? a : b;
}

/*
 * WIDE: compile several versions of a function and call the one for the present machine. For loops
 * of integers, whose results are the same in each.
 */

#if defined __x86_64__ && defined __gnu_linux__ && !defined __clang__ &&                           \
    !defined __SANITIZE_ADDRESS__ && !defined __SANITIZE_THREAD__
#define WIDE __attribute__((target_clones("avx2", "default")))
#else
#define WIDE
#endif

#endif
