/* SPDX-License-Identifier: MIT */
#include "base/hash.h"

#include <nettle/sha2.h>

void sha256_hex(char *out, struct sha256_ctx *sha, size_t bytes)
{
    static const char digit[] = "0123456789abcdef";
    uint8_t digest[SHA256_DIGEST_SIZE];
    sha256_digest(sha, bytes, digest);
    for (size_t i = 0; i < bytes; i++) {
        *out++ = digit[digest[i] >> 4];
        *out++ = digit[digest[i] & 15];
    }
    *out = '\0';
}

void sha256_bytes_hex(char out[SHA256_HEX], const void *bytes, size_t length)
{
    struct sha256_ctx sha;
    sha256_init(&sha);
    sha256_update(&sha, length, bytes);
    sha256_hex(out, &sha, SHA256_DIGEST_SIZE);
}
