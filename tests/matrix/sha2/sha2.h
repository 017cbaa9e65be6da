/*
 * SHA-256 by the names of libmd's <sha2.h>, for machines that libmd is not installed for. On the
 * machine that builds, libmd itself is used, so the list of works compares the two as well.
 *
 * From: FIPS 180-4, whose names are used. Integers only, bytes in the order of the standard.
 */
#ifndef TESTS_MATRIX_SHA2_H
#define TESTS_MATRIX_SHA2_H

#include <stddef.h>
#include <stdint.h>

/* The members that src/base/hash.c looks at have libmd's names. */
typedef struct sha2_state {
    struct {
        uint32_t st32[8];
    } state;
    uint64_t bitcount[1]; /* so far; the last bytes of them, less than a block, wait in `block` */
    uint8_t block[64];
} SHA2_CTX;

void SHA256Init(SHA2_CTX *state);
void SHA256Update(SHA2_CTX *state, const uint8_t *bytes, size_t length);
void SHA256Final(uint8_t digest[32], SHA2_CTX *state);

#endif
