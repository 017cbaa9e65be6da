/* SPDX-License-Identifier: MIT */
/*
 * Hashing: a 64-bit mix for sums over voxels, and SHA-256 for chains, files and scenes.
 *
 * SHA-256 is nettle's (<nettle/sha2.h>), which uses the processor's instructions for it: 14 MB in
 * about 14 milliseconds.
 */
#ifndef BASE_HASH_H
#define BASE_HASH_H

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

/* Mix a place, for digests that are sums mod 2^64 over places, so that near places with similar
 * contents do not cancel. */
static inline uint64_t hash_place(uint64_t place)
{
    return hash_mix(place + UINT64_C(0x9e3779b97f4a7c15));
}

/* Mix a place and its content. */
static inline uint64_t hash_mix_at(uint64_t place, uint64_t content)
{
    return hash_mix(content ^ hash_place(place));
}

enum { SHA256_HEX = 65 };

/* Finish a SHA-256: the first 1..32 `bytes` of its digest, in lower-case hexadecimal, and NUL. */
struct sha256_ctx;
void sha256_hex(char *out, struct sha256_ctx *sha, size_t bytes);

/* The whole digest of `length` bytes. */
void sha256_bytes_hex(char out[SHA256_HEX], const void *bytes, size_t length);

#endif
