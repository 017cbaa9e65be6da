/* SPDX-License-Identifier: MIT */
/* Locks: what is read is written again as the same bytes, and names nothing outside its folder. */
#include "tests/fuzz/fuzz.h"

#include <string.h>

#include "verify/iftty_lock.h"

static void check_names(const struct lock *lock)
{
    for (size_t i = 0; i < lock->count; i++) {
        const char *name = lock->entry[i].name;
        HOLDS(lock_name_is_valid(name));
        HOLDS(*name != '/' && strncmp(name, "../", 3) != 0 && !strstr(name, "/../"));
        HOLDS(i == 0 || strcmp(lock->entry[i - 1].name, name) < 0);
        HOLDS(lock_facts_of(lock, name) == lock->entry[i].facts);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length)
{
    struct lock lock = {0};
    struct buf written = {0}, lines = {0};
    struct fault fault;
    const enum err err = lock_read(&lock, (const char *)bytes, length, &fault);
    HOLDS(err == OK || err == ERR_INPUT);
    if (!err) {
        check_names(&lock);
        buf_printf(&written, "# iftty lock %u\n", lock.version);
        for (size_t i = 0; i < lock.count; i++)
            buf_printf(&written, "journal %s\n%s", lock.entry[i].name, lock.entry[i].facts);
        HOLDS(written.length == length && memcmp(written.data, bytes, length) == 0);
    }
    for (size_t i = 0; i + 1 < lock.count; i++) {
        HOLDS(!lock_differs(&lines, lock.version, lock.entry[i].facts, lock.entry[i].facts));
        lock_differs(&lines, lock.version, lock.entry[i].facts, lock.entry[i + 1].facts);
    }
    lock_release(&lock);
    buf_release(&written);
    buf_release(&lines);
    return 0;
}
