#include "session/label_copy.h"

#include <endian.h>
#include <nettle/sha2.h>
#include <string.h>

#include "base/hash.h"

enum { PIECE = 4096 };

enum err label_copy_digest(char digest[LABEL_COPY_DIGEST], const struct volume *map,
                           struct watch *watch, struct fault *fault)
{
    const size_t voxels = (size_t)map->size[0] * map->size[1] * map->size[2];
    struct sha256_ctx sha;
    uint32_t size[3];
    uint16_t piece[PIECE];
    struct task task = task_begin(watch, "digest of the labels", voxels);
    for (int a = 0; a < 3; a++)
        size[a] = htole32(map->size[a]);
    sha256_init(&sha);
    sha256_update(&sha, sizeof size, (const uint8_t *)size);
    for (size_t i = 0; i < voxels && task_advance(&task, PIECE);) {
        size_t n = 0;
        while (n < PIECE && i < voxels)
            piece[n++] = htole16(map->intensity[i++]);
        sha256_update(&sha, n * sizeof *piece, (const uint8_t *)piece);
    }
    sha256_hex(digest, &sha, (LABEL_COPY_DIGEST - 1) / 2);
    return watch_fault(watch, fault);
}

bool label_copy_is_digest(const char *text)
{
    return strlen(text) == LABEL_COPY_DIGEST - 1 &&
           strspn(text, "0123456789abcdef") == LABEL_COPY_DIGEST - 1;
}

void label_copy_name(struct buf *out, const char *digest)
{
    buf_printf(out, "labels-%s.nii.gz", digest);
}

static void copy_row(void *context, uint32_t y, uint32_t z, void *values)
{
    const struct volume *map = context;
    const size_t row = map->size[0];
    memcpy(values, map->intensity + row * (y + (size_t)map->size[1] * z), row * sizeof(uint16_t));
}

enum err label_copy_write(const char *path, const struct volume *map,
                          const struct geometry *geometry, struct watch *watch, struct fault *fault)
{
    const struct volume_map copy = {.size = map->size,
                                    .geometry = geometry,
                                    .type = VOXEL_UINT16,
                                    .description = "iftty labels, copied",
                                    .row = copy_row,
                                    .context = (void *)(uintptr_t)map};
    return volume_write(path, FILE_KEEP, &copy, watch, fault);
}
