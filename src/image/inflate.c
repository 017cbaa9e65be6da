#include "image/inflate.h"

#include <errno.h>
#include <libdeflate.h>
#include <stdlib.h>
#include <unistd.h>

#include "base/mem.h"

enum { TRAILER = 8 }; /* checksum and length, little-endian, 32 bits each */

static bool read_all(uint8_t *out, size_t length, int fd)
{
    size_t done = 0;
    while (done < length) {
        const ssize_t n = pread(fd, out + done, length - done, (off_t)done);
        if (n == 0 || (n < 0 && errno != EINTR))
            return false;
        done += n > 0 ? (size_t)n : 0;
    }
    return true;
}

/* The length that a gzip file claims at its end: before all else, for it tells most others apart.
 */
static bool claims(size_t length, int fd, uint64_t packed)
{
    uint8_t end[4];
    uint32_t claimed = 0;
    if (packed < TRAILER || pread(fd, end, sizeof end, (off_t)(packed - sizeof end)) != sizeof end)
        return false;
    for (unsigned i = 0; i < sizeof end; i++)
        claimed |= (uint32_t)end[i] << 8 * i;
    return length == claimed;
}

static bool inflate_bytes(void *out, size_t length, const uint8_t *bytes, size_t packed)
{
    struct libdeflate_decompressor *d = libdeflate_alloc_decompressor();
    size_t taken = 0;
    if (!d)
        return false;
    const enum libdeflate_result result =
        libdeflate_gzip_decompress_ex(d, bytes, packed, out, length, &taken, NULL);
    libdeflate_free_decompressor(d);
    return result == LIBDEFLATE_SUCCESS && taken == packed;
}

bool inflate_file(void *out, size_t length, int fd, uint64_t packed)
{
    if (packed > INFLATE_PACKED_MOST || length > INFLATE_MOST || !claims(length, fd, packed))
        return false;
    uint8_t *bytes = mem_array((size_t)packed, 1);
    const bool inflated = bytes && read_all(bytes, (size_t)packed, fd) &&
                          inflate_bytes(out, length, bytes, (size_t)packed);
    free(bytes);
    return inflated;
}
