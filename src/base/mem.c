/* SPDX-License-Identifier: MIT */
#include "base/mem.h"

#include <malloc.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "base/clock.h"

enum {
    HUGE_FROM = 8 << 20,    /* below, clearing a huge page costs more than it saves */
    LARGE_FROM = 256 << 20, /* below, the memory of the machine is not checked */
    COUNTED_FROM = 1 << 20, /* below, the limit is not checked */
};

static const uint64_t TRIM_INTERVAL_NS = UINT64_C(10000000000); /* minimum interval */

bool (*mem_allows)(size_t bytes);

static size_t limit = SIZE_MAX;

static bool is_allowed(size_t bytes)
{
    return !mem_allows || mem_allows(bytes);
}

/* The kernel hands out addresses without memory behind them, and kills processes that use them. */
bool mem_has_room(size_t bytes)
{
    const size_t from = limit == SIZE_MAX ? LARGE_FROM : COUNTED_FROM;
    return bytes < from || bytes <= mem_available();
}

void *mem_new(size_t bytes)
{
    return is_allowed(bytes) ? calloc(1, bytes) : NULL;
}

void mem_release(void *pointer)
{
    void *memory;
    memcpy(&memory, pointer, sizeof memory);
    free(memory);
}

void stream_release(FILE **stream)
{
    if (*stream)
        fclose(*stream);
}

bool size_multiply(size_t a, size_t b, size_t *out)
{
    size_t product;
    if (__builtin_mul_overflow(a, b, &product))
        return false;
    *out = product;
    return true;
}

void *mem_array(size_t count, size_t size)
{
    size_t bytes;
    if (!size_multiply(count, size, &bytes) || !is_allowed(bytes) || !mem_has_room(bytes))
        return NULL;
    return malloc(bytes ? bytes : 1);
}

bool mem_parts(const struct mem_part *part, size_t parts)
{
    const size_t aligned = _Alignof(max_align_t);
    size_t end = 0, bytes;
    for (size_t i = 0; i < parts; i++)
        if (!size_multiply(part[i].count, part[i].size, &bytes) || bytes > SIZE_MAX / 4 ||
            end > SIZE_MAX / 4)
            return false;
        else
            end += (bytes + aligned - 1) / aligned * aligned;
    char *at = mem_array(end, 1);
    for (size_t i = 0; i < parts && at; i++) {
        memcpy(part[i].array, &at, sizeof at);
        at += (part[i].count * part[i].size + aligned - 1) / aligned * aligned;
    }
    return at != NULL;
}

bool mem_grow(void *array, size_t *capacity, size_t needed, size_t size)
{
    if (needed <= *capacity)
        return true;
    size_t wanted = *capacity < 16 ? 16 : *capacity;
    while (wanted < needed)
        if (!size_multiply(wanted, 2, &wanted))
            return false;
    size_t bytes;
    void *former;
    memcpy(&former, array, sizeof former);
    if (!size_multiply(wanted, size, &bytes) || !is_allowed(bytes))
        return false;
    if (!mem_has_room(bytes - *capacity * size)) { /* an eighth more than needed may still fit */
        wanted = needed + needed / 8;
        if (!size_multiply(wanted, size, &bytes) || !mem_has_room(bytes - *capacity * size))
            return false;
    }
    void *larger = realloc(former, bytes);
    if (!larger)
        return false;
    memcpy(array, &larger, sizeof larger);
    *capacity = wanted;
    return true;
}

void *mem_pages(size_t bytes)
{
    if (!is_allowed(bytes))
        return NULL;
    void *pages = mmap(NULL, bytes ? bytes : 1, PROT_READ | PROT_WRITE,
                       MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (pages == MAP_FAILED)
        return NULL;
    if (bytes >= HUGE_FROM)
        madvise(pages, bytes, MADV_HUGEPAGE); /* a hint: small pages work as well, only slower */
    return pages;
}

void mem_pages_free(void *pages, size_t bytes)
{
    if (pages)
        munmap(pages, bytes ? bytes : 1);
}

void mem_pages_allow(void *pages, size_t bytes, bool allowed)
{
    mprotect(pages, bytes ? bytes : 1, allowed ? PROT_READ | PROT_WRITE : PROT_NONE);
}

bool mem_pages_resize(void *array, size_t from, size_t to)
{
    void *former, *pages;
    memcpy(&former, array, sizeof former);
    if (to > from && !is_allowed(to - from))
        return false;
#ifdef __SANITIZE_THREAD__
    /* ThreadSanitizer does not see mremap: it would report another thread's later use of the former
     * addresses as a race. */
    pages = mem_pages(to);
    if (!pages)
        return false;
    memcpy(pages, former, from < to ? from : to);
    mem_pages_free(former, from);
#else
    pages = mremap(former, from, to, MREMAP_MAYMOVE);
    if (pages == MAP_FAILED)
        return false;
#endif
    if (from < HUGE_FROM && to >= HUGE_FROM)
        madvise(pages, to, MADV_HUGEPAGE);
    memcpy(array, &pages, sizeof pages);
    return true;
}

void mem_begin(void)
{
#ifdef __GLIBC__
    mallopt(M_ARENA_MAX, 1);
#endif
}

void mem_trim(void)
{
#ifdef __GLIBC__
    static _Atomic uint64_t due;
    const uint64_t now = clock_ns();
    if (now < atomic_load(&due))
        return;
    atomic_store(&due, now + TRIM_INTERVAL_NS);
    malloc_trim(0);
#endif
}

void mem_limit(size_t bytes)
{
    limit = bytes;
}

size_t mem_held_by(int process)
{
    char statm[40];
    unsigned long all, resident = 0;
    snprintf(statm, sizeof statm, "/proc/%d/statm", process);
    OWNED(stream_release) FILE *file = fopen(statm, "re");
    if (file && fscanf(file, "%lu %lu", &all, &resident) != 2)
        resident = 0;
    return resident * (size_t)sysconf(_SC_PAGESIZE);
}

size_t mem_held(void)
{
    return mem_held_by(getpid());
}

size_t mem_available(void)
{
    OWNED(stream_release) FILE *file = fopen("/proc/meminfo", "re");
    char line[128];
    unsigned long long kib;
    size_t bytes = SIZE_MAX;
    while (file && fgets(line, sizeof line, file))
        if (sscanf(line, "MemAvailable: %llu kB", &kib) == 1 && kib < SIZE_MAX / 1024)
            bytes = (size_t)kib * 1024;
    if (limit == SIZE_MAX)
        return bytes;
    const size_t held = mem_held(), left = held < limit ? limit - held : 0;
    return bytes < left ? bytes : left;
}
