#include "base/hash.h"

#include <string.h>
#include <sys/types.h>
#include <sha2.h>

_Static_assert(sizeof(SHA2_CTX) <= sizeof(struct sha256), "struct sha256 must hold libmd's state");

enum { SHA256_BLOCK = 64 };

bool sha256_is_plain;

void sha256_init(struct sha256 *s)
{
    SHA256Init((SHA2_CTX *)s->opaque);
}

void sha256_add(struct sha256 *s, const void *bytes, size_t length)
{
    SHA2_CTX *context = (SHA2_CTX *)s->opaque;
    const size_t fast = length / SHA256_BLOCK * SHA256_BLOCK;
    const bool is_between = context->bitcount[0] % (8 * SHA256_BLOCK) == 0; /* two blocks */
    if (fast && is_between && !sha256_is_plain &&
        sha256_blocks_fast(context->state.st32, bytes, fast / SHA256_BLOCK)) {
        context->bitcount[0] += 8 * (uint64_t)fast;
        bytes = (const uint8_t *)bytes + fast;
        length -= fast;
    }
    SHA256Update(context, bytes, length);
}

void sha256_end(struct sha256 *s, uint8_t digest[SHA256_BYTES])
{
    SHA256Final(digest, (SHA2_CTX *)s->opaque);
}

void hash_hex(char *out, const uint8_t *bytes, size_t length)
{
    static const char digit[] = "0123456789abcdef";
    for (size_t i = 0; i < length; i++) {
        *out++ = digit[bytes[i] >> 4];
        *out++ = digit[bytes[i] & 15];
    }
    *out = '\0';
}
