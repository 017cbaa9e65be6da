/* SPDX-License-Identifier: MIT */
/*
 * The plain driver: fuzz_NAME [CHANGES] FILE... hands each file to the target, every beginning of
 * it at up to 200 places, and CHANGES changed copies, the same each time and others for each file.
 */
#include "tests/fuzz/fuzz.h"

#include <string.h>

#include "base/buf.h"
#include "base/file.h"
#include "tests/check.h"

enum { CUTS = 200, FILE_MOST = 1 << 20 };

/* A copy of the exact size, so that AddressSanitizer sees a read behind its end. */
static void hand_over(const char *bytes, size_t length)
{
    uint8_t *copy = malloc(length ? length : 1);
    HOLDS(copy);
    if (length)
        memcpy(copy, bytes, length);
    LLVMFuzzerTestOneInput(copy, length);
    free(copy);
}

/* One to four bytes become others: any, or a limit of their width. */
static void change(struct buf *bytes, uint64_t *random)
{
    static const char limit[] = {0, 1, 0x7F, (char)0x80, (char)0xFF, '\n', ' ', '='};
    for (uint32_t n = 1 + check_below(random, 4); n; n--) {
        const uint32_t at = check_below(random, (uint32_t)bytes->length);
        const uint32_t any = check_below(random, 256), which = check_below(random, sizeof limit);
        bytes->data[at] = check_below(random, 2) ? (char)any : limit[which];
    }
}

static void replay(const char *path, uint64_t random, unsigned changes)
{
    struct buf bytes = {0}, copy = {0};
    struct fault fault;
    HOLDS(file_read(&bytes, path, FILE_MOST, &fault) == OK);
    hand_over(bytes.data, bytes.length);
    for (size_t at = 0; at < bytes.length; at += 1 + bytes.length / CUTS)
        hand_over(bytes.data, at);
    for (unsigned i = 0; bytes.length && i < changes; i++) {
        buf_clear(&copy);
        buf_add(&copy, bytes.data, bytes.length);
        change(&copy, &random);
        hand_over(copy.data, copy.length);
    }
    buf_release(&copy);
    buf_release(&bytes);
}

int main(int count, char **word)
{
    const unsigned changes = count > 1 ? (unsigned)strtoul(word[1], NULL, 10) : 0;
    for (int i = 2; i < count; i++)
        replay(word[i], (uint64_t)i, changes);
    printf("%d files\n", count - 2);
    return count > 2 ? 0 : 2;
}
