/* SPDX-License-Identifier: MIT */
/* The plain driver: replay NAME TIMES FILE... hands each file to the target NAME, every beginning
 * of it at up to 200 places, and TIMES as many changed copies as targets.c says, the same each time
 * and others for each file. Without a target of that name it prints the names of all. */
#include "tests/fuzz/fuzz.h"

#include "base/buf.h"
#include "base/file.h"
#include "tests/check.h"

enum { CUTS = 200, FILE_MOST = 1 << 20 };

/* A copy of the exact size, so that AddressSanitizer sees a read behind its end. */
static void hand_over(const struct fuzz_target *target, const char *bytes, size_t length)
{
    OWNED(mem_release) uint8_t *copy = malloc(length ? length : 1);
    HOLDS(copy);
    if (length)
        memcpy(copy, bytes, length);
    target->read(copy, length);
}

static void replay(const struct fuzz_target *target, const char *path, uint64_t random,
                   unsigned changes)
{
    OWNED(buf_release) struct buf bytes = {0}, copy = {0};
    struct fault fault;
    HOLDS(file_read(&bytes, path, FILE_MOST, &fault) == OK);
    hand_over(target, bytes.data, bytes.length);
    for (size_t at = 0; at < bytes.length; at += 1 + bytes.length / CUTS)
        hand_over(target, bytes.data, at);
    for (unsigned i = 0; bytes.length && i < changes; i++) {
        buf_clear(&copy);
        buf_add(&copy, bytes.data, bytes.length);
        /* One to four bytes become others: any, or a limit of their width. */
        static const char limit[] = {0, 1, 0x7F, (char)0x80, (char)0xFF, '\n', ' ', '='};
        for (uint32_t n = 1 + check_below(&random, 4); n; n--) {
            const uint32_t at = check_below(&random, (uint32_t)copy.length);
            const uint32_t any = check_below(&random, 256),
                           which = check_below(&random, sizeof limit);
            copy.data[at] = check_below(&random, 2) ? (char)any : limit[which];
        }
        hand_over(target, copy.data, copy.length);
    }
}

int main(int count, char **word)
{
    const struct fuzz_target *target = fuzz_find(count > 1 ? word[1] : "");
    if (!target || count < 4)
        return 2;
    const unsigned changes = target->changes * (unsigned)strtoul(word[2], NULL, 10);
    for (int i = 3; i < count; i++)
        replay(target, word[i], (uint64_t)i - 1, changes);
    printf("%d files\n", count - 3);
    return 0;
}
