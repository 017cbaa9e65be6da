/* Fixed-point helpers of the renderer: integers only, the same on every machine. */
#ifndef RENDER_FIXED_H
#define RENDER_FIXED_H

#include <stdint.h>

/* 2^45 over the square root of v, for v of 2^28..2^32 - 1, right to 18 bits: a chord of the curve
 * and two steps of Newton's. */
static inline int64_t fixed_inverse_root(uint64_t v)
{
    const int64_t one = INT64_C(1) << 30;
    const int doubled = v < (UINT64_C(1) << 30);
    const int64_t x = (int64_t)(doubled ? v << 2 : v); /* 1..4, times 2^30 */
    int64_t r = x < 2 * one ? (one * 163 - x * 37) >> 7 : (one * 114 - x * 13) >> 7;
    for (int i = 0; i < 2; i++)
        r = r * (3 * one - (x * (r * r >> 30) >> 30)) >> 31;
    return r << doubled;
}

/* a * b / 2^30, rounded to nearest. */
static inline int64_t fixed_mul30(int64_t a, int64_t b)
{
    return (a * b + (INT64_C(1) << 29)) >> 30;
}

/* Halves and other shifts of negative numbers round down, as gcc and clang define it. */
_Static_assert((INT64_C(-3) >> 1) == -2, "right shifts must be arithmetic");

#endif
