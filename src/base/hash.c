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
