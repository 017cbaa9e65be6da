/*
 * Hashing: a 64-bit mix for sums over voxels, and SHA-256 for chains, files and scenes.
 *
 * SHA-256 is libmd's, which takes 6.6 ns a byte; on x86 processors that have instructions for it,
 * whole blocks are taken by those (base/hash_x86.c) in a tenth of the time, with the same digest.
 */
#ifndef BASE_HASH_H
#define BASE_HASH_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* A strong mix of 64 bits: every input bit reaches every output bit, and it is a bijection.
 * (Two rounds of multiply and shift with the constants of MurmurHash3's 64-bit finaliser.) */
static inline uint64_t hash_mix(uint64_t x)
{
    x ^= x >> 33;
    x *= UINT64_C(0xff51afd7ed558ccd);
    x ^= x >> 33;
    x *= UINT64_C(0xc4ceb9fe1a85ec53);
    x ^= x >> 33;
    return x;
}

/* The mix of a place, for digests that are sums mod 2^64 over places: near places with near
 * contents do not cancel. */
static inline uint64_t hash_place(uint64_t place)
{
    return hash_mix(place + UINT64_C(0x9e3779b97f4a7c15));
}

/* The mix of a place and what it holds. */
static inline uint64_t hash_mix_at(uint64_t place, uint64_t content)
{
    return hash_mix(content ^ hash_place(place));
}

enum { SHA256_BYTES = 32, SHA256_HEX = 65 };

struct sha256 {
    uint64_t opaque[28]; /* room for libmd's SHA2_CTX */
};

void sha256_init(struct sha256 *s);
void sha256_add(struct sha256 *s, const void *bytes, size_t length);
void sha256_end(struct sha256 *s, uint8_t digest[SHA256_BYTES]);

/* Takes `blocks` blocks of 64 bytes into the eight words of `state`. False, and nothing is done,
 * where the processor has no instructions for it. */
bool sha256_blocks_fast(uint32_t state[8], const uint8_t *bytes, size_t blocks);

/* For tests: true has libmd do it all. */
extern bool sha256_is_plain;

/* Lower-case hexadecimal of `length` bytes, ended by NUL; `out` holds 2 * length + 1. */
void hash_hex(char *out, const uint8_t *bytes, size_t length);

#endif
