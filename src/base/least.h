/* SPDX-License-Identifier: MIT */
/* The lesser of two numbers. */
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

#endif
