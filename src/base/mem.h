/* SPDX-License-Identifier: MIT */
/*
 * Memory: sizes multiplied by one checked helper, and large arrays on huge pages.
 *
 * Every allocation can fail and returns NULL; the caller reports with fault_memory.
 */
#ifndef BASE_MEM_H
#define BASE_MEM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* out = a * b; false (and out untouched) where the product does not fit. */
bool size_multiply(size_t a, size_t b, size_t *out);

/* For tests: asked before every allocation of this file; false makes it fail. NULL allows all. */
extern bool (*mem_allows)(size_t bytes);

/* One zeroed object of `bytes`, or NULL. Freed by free(). */
void *mem_new(size_t bytes);

/* An uninitialised array of `count` items of `size` bytes, or NULL; a large one also where the
 * machine has not the memory (mem_available), under a limit one of 1 MB. Freed by free(). */
void *mem_array(size_t count, size_t size);

/* Several such arrays, in one block of memory: freed by free() of the first. */
struct mem_part {
    void *array; /* points at the pointer that is set */
    size_t count, size;
};
bool mem_parts(const struct mem_part *part, size_t parts);

/* Whether the machine has the memory for arrays of so many bytes together, which are not touched
 * yet; true for less than is checked, as above. */
bool mem_is_there(size_t bytes);

/* Grows `array` (NULL at first) to hold at least `needed` items, at least doubling where the
 * machine has the memory. On failure returns false and leaves array and capacity as they were.
 * `array` points at the pointer. */
bool mem_grow(void *array, size_t *capacity, size_t needed, size_t size);

/* `bytes` of zeroed memory on huge pages where the kernel has them, or NULL. Freed by
 * mem_pages_free with the same size. Untouched pages cost nothing, so there may be more of them
 * than the machine has memory. */
void *mem_pages(size_t bytes);
void mem_pages_free(void *pages, size_t bytes);

/* Whether they may be touched; they are when they are new. A process that touches others is ended
 * by the kernel. */
void mem_pages_allow(void *pages, size_t bytes, bool allowed);

/* Gives the memory of the first `bytes` back; they are zero when touched again. */
void mem_pages_forget(void *pages, size_t bytes);

/* Before there are threads: all of them shall take memory from one heap, the only one whose end
 * glibc gives back. */
void mem_begin(void);

/* Gives back what has been freed and lies between what is used, where the C library keeps it: at
 * most once in 10 seconds, which takes some milliseconds. */
void mem_give_back(void);

/* Bytes of physical memory of this machine that can be had without swapping, as the kernel
 * estimates it; SIZE_MAX where it does not say. No more than a limit leaves. */
size_t mem_available(void);

/* Bytes of physical memory that this process holds, or another; 0 where the kernel does not say. */
size_t mem_held(void);
size_t mem_held_by(int process);

/* Whether the kernel can hold a process of this build to an amount: the sanitisers of addresses and
 * of threads reserve terabytes. gcc and clang say differently that one is there. */
#if defined __SANITIZE_ADDRESS__ || defined __SANITIZE_THREAD__
enum { MEM_MAY_BE_LIMITED = false };
#elif defined __has_feature
enum { MEM_MAY_BE_LIMITED = !__has_feature(address_sanitizer) && !__has_feature(thread_sanitizer) };
#else
enum { MEM_MAY_BE_LIMITED = true };
#endif

/* From now on no more than so many are to be held: mem_available says what that leaves. */
void mem_limit(size_t bytes);

#endif
