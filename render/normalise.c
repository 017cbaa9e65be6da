#include "render/normalise.h"

#include "base/wide.h"
#include "render/fixed.h"

enum { VECTOR_BITS = 15 }; /* of the longest of a gradient's three parts */

bool normalise_one(int16_t direction[3], const int64_t gradient[3])
{
    uint64_t all = 0;
    for (int a = 0; a < 3; a++)
        all |= (uint64_t)(gradient[a] < 0 ? -gradient[a] : gradient[a]);
    if (all == 0)
        return false;
    const int bits = 64 - __builtin_clzll(all);
    int64_t v[3];
    uint64_t squares = 0;
    for (int a = 0; a < 3; a++) {
        v[a] = bits > VECTOR_BITS ? gradient[a] >> (bits - VECTOR_BITS)
                                  : gradient[a] * (1 << (VECTOR_BITS - bits));
        squares += (uint64_t)(v[a] * v[a]);
    }
    const int64_t inverse = fixed_inverse_root(squares);
    for (int a = 0; a < 3; a++)
        direction[a] = (int16_t)(v[a] * inverse >> (45 - NORMAL_BITS));
    return true;
}

/* ---- many at once ---- */

struct parts {
    uint32_t all[NORMALISED]; /* the bits of all three, without their signs */
    int32_t along[3][NORMALISED];
};

/* The one where all bits of `mask` are set, the other where none is. */
static inline uint32_t chosen(uint32_t mask, uint32_t one, uint32_t other)
{
    return (one & mask) | (other & ~mask);
}

/* By so many bits, where none of the first that many of 31 is in use. */
static inline void shift_left(struct parts *parts, int bits)
{
    for (int i = 0; i < NORMALISED; i++) {
        const uint32_t fits = parts->all[i] >> (31 - bits) ? 0 : UINT32_MAX;
        parts->all[i] = chosen(fits, parts->all[i] << bits, parts->all[i]);
        for (int a = 0; a < 3; a++) {
            const uint32_t part = (uint32_t)parts->along[a][i];
            parts->along[a][i] = (int32_t)chosen(fits, part << bits, part);
        }
    }
}

/* The longest of the three parts comes to take 31 bits, of which the first VECTOR_BITS are left. */
static inline void take_bits(struct directions *v, const struct gradients *gradients)
{
    struct parts parts;
    for (int i = 0; i < NORMALISED; i++) {
        parts.all[i] = 0;
        for (int a = 0; a < 3; a++) {
            const int32_t g = parts.along[a][i] = gradients->along[a][i];
            parts.all[i] |= (uint32_t)(g < 0 ? -g : g);
        }
    }
    shift_left(&parts, 16);
    shift_left(&parts, 8);
    shift_left(&parts, 4);
    shift_left(&parts, 2);
    shift_left(&parts, 1);
    for (int a = 0; a < 3; a++)
        for (int i = 0; i < NORMALISED; i++)
            v->along[a][i] = (int16_t)(parts.along[a][i] >> (31 - VECTOR_BITS));
}

static inline uint32_t times(uint32_t a, uint32_t b, int shift)
{
    return (uint32_t)((uint64_t)a * b >> shift);
}

/* As fixed_inverse_root. */
static inline void find_roots(uint32_t root[NORMALISED], const uint32_t squares[NORMALISED])
{
    const uint32_t one = UINT32_C(1) << 30;
    for (int i = 0; i < NORMALISED; i++) {
        const uint32_t doubled = squares[i] >> 30 ? 0 : UINT32_MAX;
        const uint32_t x = chosen(doubled, squares[i] << 2, squares[i]);
        const uint32_t low = (uint32_t)(((uint64_t)one * 163 - (uint64_t)x * 37) >> 7);
        const uint32_t high = (uint32_t)(((uint64_t)one * 114 - (uint64_t)x * 13) >> 7);
        uint32_t r = chosen(x >> 31 ? UINT32_MAX : 0, high, low);
        r = times(r, 3 * one - times(x, times(r, r, 30), 30), 31);
        r = times(r, 3 * one - times(x, times(r, r, 30), 30), 31);
        root[i] = chosen(doubled, r << 1, r);
    }
}

WIDE void normalise_all(struct directions *directions, const struct gradients *gradients)
{
    struct directions v;
    uint32_t squares[NORMALISED], root[NORMALISED];
    take_bits(&v, gradients);
    for (int i = 0; i < NORMALISED; i++)
        squares[i] = (uint32_t)(v.along[0][i] * v.along[0][i]) +
                     (uint32_t)(v.along[1][i] * v.along[1][i]) +
                     (uint32_t)(v.along[2][i] * v.along[2][i]);
    find_roots(root, squares);
    /* A product of 47 bits, by halves of the root. */
    for (int a = 0; a < 3; a++)
        for (int i = 0; i < NORMALISED; i++) {
            const int32_t part = v.along[a][i];
            const int32_t high = part * (int32_t)(root[i] >> 16);
            const int32_t low = part * (int32_t)(root[i] & 0xffff);
            directions->along[a][i] = (int16_t)((high + (low >> 16)) >> (45 - NORMAL_BITS - 16));
        }
}
