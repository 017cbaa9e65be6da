/* SPDX-License-Identifier: MIT */
/*
 * The key of a voxel: (cost, hops, root) from the highest bits down, compared as one integer.
 *
 * cost 0..65535 is the f_max path cost, hops the steps since the cost last rose, root the cell of
 * the seed. A path that ends in s offers its neighbour key_extend(key(s), w), which is always above
 * key(s): that alone makes the forest unique (engine/forest.h).
 */
#ifndef ENGINE_KEY_H
#define ENGINE_KEY_H

#include <stdint.h>

/* Above all others: no seed reaches the voxel. */
#define KEY_NONE UINT64_MAX

/* Hops that no key of a finished forest has: there are none left to add. */
enum { KEY_HOPS_LIMIT = 65535 };

static inline uint64_t key_make(uint32_t cost, uint32_t hops, uint32_t root)
{
    return (uint64_t)cost << 48 | (uint64_t)hops << 32 | root;
}
static inline uint32_t key_cost(uint64_t key)
{
    return (uint32_t)(key >> 48);
}
static inline uint32_t key_hops(uint64_t key)
{
    return (uint32_t)(key >> 32) & 0xFFFF;
}
static inline uint32_t key_root(uint64_t key)
{
    return (uint32_t)key;
}
/* (cost, hops) as one number: keys of one level never offer below their own level. */
static inline uint32_t key_level(uint64_t key)
{
    return (uint32_t)(key >> 32);
}

/* The least key of a level; of a level and those above, counted on without end. */
static inline uint64_t key_level_begin(uint64_t level)
{
    return level > UINT32_MAX ? KEY_NONE : level << 32;
}

/* The parts of key_extend: one hop more at the same cost (none where there is none left, so that
 * the order stays strict), a rise to weight w, and the greater of two keys. */
static inline uint64_t key_hop(uint64_t key)
{
    return key_hops(key) == KEY_HOPS_LIMIT ? KEY_NONE : key + (UINT64_C(1) << 32);
}
static inline uint64_t key_rise(uint32_t w, uint32_t root)
{
    return key_make(w, 0, root);
}
static inline uint64_t key_greater(uint64_t a, uint64_t b)
{
    return a > b ? a : b;
}

/* What a voxel with `key` offers a neighbour of weight w: (w, 0, root) where w is above the cost,
 * else one hop more. The former is the greater key exactly then: so it takes no branch. */
static inline uint64_t key_extend(uint64_t key, uint32_t w)
{
    return key_greater(key_rise(w, key_root(key)), key_hop(key));
}

#endif
