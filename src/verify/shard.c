#include "verify/shard.h"

#include "base/file.h"
#include "base/hash.h"
#include "base/scan.h"
#include "journal/journal.h"

bool shard_read(struct shard *shard, const char *text)
{
    int64_t number, of;
    const char *at = text;
    if (!scan_integer(&at, 1, SHARDS_MOST, &number) || !scan_text(&at, "/") ||
        !scan_integer(&at, number, SHARDS_MOST, &of) || *at)
        return false;
    *shard = (struct shard){(unsigned)number, (unsigned)of};
    return true;
}

bool shard_has(const struct shard *shard, const char *path)
{
    struct buf bytes = {0};
    char hex[SHA256_HEX];
    uint64_t first;
    bool has = true;
    if (!file_read(&bytes, path, JOURNAL_BYTES_MAX, NULL)) {
        const char *at = hex;
        sha256_bytes_hex(hex, buf_text(&bytes), bytes.length);
        hex[16] = '\0';
        has = !scan_hex(&at, 16, &first) || first % shard->of == shard->number - 1;
    }
    buf_release(&bytes);
    return has;
}

static void move_to(char **list, size_t to, size_t from)
{
    char *moved = list[from];
    for (size_t i = from; i > to; i--)
        list[i] = list[i - 1];
    list[to] = moved;
}

size_t shard_choose(const struct shard *shard, char **path, char **other, size_t count)
{
    size_t chosen = 0;
    for (size_t i = 0; i < count; i++) {
        if (!shard_has(shard, path[i]))
            continue;
        move_to(path, chosen, i);
        if (other)
            move_to(other, chosen, i);
        chosen++;
    }
    return chosen;
}
