/* SPDX-License-Identifier: MIT */
/* SHA-256 by the names of <nettle/sha2.h>, for machines that nettle is not installed for. On the
 * machine that builds, nettle itself is used, so the list of works compares the two as well.
 *
 * From: FIPS 180-4, whose names are used. Integers only, bytes in the order of the standard. */
#ifndef TESTS_MATRIX_SHA2_H
#define TESTS_MATRIX_SHA2_H

#include <stddef.h>
#include <stdint.h>

enum { SHA256_DIGEST_SIZE = 32 };

struct sha256_ctx {
    uint32_t state[8];
    uint64_t bits; /* so far; the last bytes of them, less than a block, wait in `block` */
    uint8_t block[64];
};

void sha256_init(struct sha256_ctx *ctx);
void sha256_update(struct sha256_ctx *ctx, size_t length, const uint8_t *bytes);
void sha256_digest(struct sha256_ctx *ctx, size_t length, uint8_t *digest);

#endif
