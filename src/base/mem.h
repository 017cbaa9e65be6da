/* SPDX-License-Identifier: MIT */
/*
 * Memory: one checked multiplication of sizes, and large arrays on huge pages.
 *
 * Every allocation can fail and returns NULL; the caller reports it with fault_memory.
 */
#ifndef BASE_MEM_H
#define BASE_MEM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

/* out = a * b; false (and out unchanged) if the product does not fit. */
bool size_multiply(size_t a, size_t b, size_t *out);

/* For tests: called before every allocation of this file; false makes it fail. NULL allows all. */
extern bool (*mem_allows)(size_t bytes);

/* Release a variable at the end of its scope, after the value of a return was computed. It is
 * initialised where it is declared, or by the next statement:
 *     OWNED(buf_release) struct buf text = {0};
 *     OWNED(mem_release) uint8_t *voxels = mem_array(count, 1); */
#define OWNED(release) __attribute__((cleanup(release)))

/* Free the memory to which the pointer at this address points; close a stream. NULL is ignored. */
void mem_release(void *pointer);
void stream_release(FILE **stream);

/* Return one zeroed object of `bytes`, or NULL. Freed by free(). */
void *mem_new(size_t bytes);

/* Return an uninitialised array of `count` items of `size` bytes, or NULL. A large array also fails
 * if the machine has not that much memory (mem_available); under a limit this applies from 1 MB on.
 * Freed by free(). */
void *mem_array(size_t count, size_t size);

/* Allocate several such arrays in one block of memory, freed by free() of the first. */
struct mem_part {
    void *array; /* address of the pointer to be set */
    size_t count, size;
};
bool mem_parts(const struct mem_part *part, size_t parts);

/* Return true if the machine has the memory for this many bytes in total, not allocated yet. Small
 * amounts are not checked, as above. */
bool mem_has_room(size_t bytes);

/* Grow `array` (NULL at first) to hold at least `needed` items, at least doubling it if the machine
 * has the memory. False on failure, with array and capacity unchanged. `array` is the address of
 * the pointer. */
bool mem_grow(void *array, size_t *capacity, size_t needed, size_t size);

/* Return `bytes` of zeroed memory, on huge pages if the kernel has them, or NULL. Freed by
 * mem_pages_free with the same size. Untouched pages cost nothing, so their sum may exceed the
 * memory of the machine. */
void *mem_pages(size_t bytes);
void mem_pages_free(void *pages, size_t bytes);

/* Allow or deny access to pages; new pages are accessible. The kernel kills a process that
 * touches others. */
void mem_pages_allow(void *pages, size_t bytes, bool allowed);

/* Change the size of pages in bytes (neither 0); they may move. `array` is the address of the
 * pointer. New bytes are zero; removed ones return to the system. False, unchanged, on
 * failure. */
bool mem_pages_resize(void *array, size_t from, size_t to);

/* Call before threads start: makes all threads share one heap, the only one whose end glibc returns
 * to the system. */
void mem_begin(void);

/* Return freed memory between used blocks to the system, if the C library keeps it: at most once in
 * 10 seconds, since it costs some milliseconds. */
void mem_trim(void);

/* Return the bytes of physical memory available without swapping, as the kernel estimates them, or
 * SIZE_MAX if unknown; at most the rest of the limit. */
size_t mem_available(void);

/* Return the bytes of physical memory that this process, or another, holds; 0 if unknown. */
size_t mem_held(void);
size_t mem_held_by(int process);

/* True if the kernel can limit the memory of a process of this build: the address and thread
 * sanitisers reserve terabytes. gcc and clang announce them differently. */
#if defined __SANITIZE_ADDRESS__ || defined __SANITIZE_THREAD__
enum { MEM_MAY_BE_LIMITED = false };
#elif defined __has_feature
enum { MEM_MAY_BE_LIMITED = !__has_feature(address_sanitizer) && !__has_feature(thread_sanitizer) };
#else
enum { MEM_MAY_BE_LIMITED = true };
#endif

/* Limit the memory that this process holds: mem_available returns the rest of it. */
void mem_limit(size_t bytes);

#endif
