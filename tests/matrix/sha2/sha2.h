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

typedef struct sha2_state {
    uint32_t h[8];
    uint64_t length; /* bytes so far; the last length % 64 of them wait in `block` */
    uint8_t block[64];
} SHA2_CTX;

void SHA256Init(SHA2_CTX *state);
void SHA256Update(SHA2_CTX *state, const uint8_t *bytes, size_t length);
void SHA256Final(uint8_t digest[32], SHA2_CTX *state);

#endif
