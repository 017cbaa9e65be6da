/* SPDX-License-Identifier: MIT */
/* How much comes out of packed voxels, before a library fills up what does not, and for the words
 * that say so: of iftty-volume, and of readers of our own. */
#ifndef IMAGE_INFLATED_H
#define IMAGE_INFLATED_H

#include <stdbool.h>
#include <stdint.h>

/* What was packed by gzip or zlib, in one stream or several, `packed` bytes from `from` on in a
 * file that stays open, or up to its end. Returns the bytes that come out, 0 without memory.
 * *ends: up to a checksum that is right, or so far after the `needed` that it does not matter. */
uint64_t inflated_bytes(int fd, uint64_t from, uint64_t packed, uint64_t needed, bool *ends);

/* Of what lacks some, with what comes before it, the bytes that come out, what lacks but bytes, and
 * the needed. */
#define INFLATED_LACKS                                                                             \
    "%scut short or damaged: of its packed voxels %llu bytes can be had%s, and its header "        \
    "promises %llu; fetch it again"
#define INFLATED_CHECKSUM " without their checksum"

/*
 * Files that swell as no honest one does: a megabyte that claims gigabytes.
 *
 * Any gzip may hold a thousand times its bytes, so such a file is a mistake or an attack, unless
 * the user says that it is not. A scene shrinks to a half or a tenth, a label map to a hundredth.
 */

/* Bytes of memory; what takes less is nobody's concern, and what takes more is announced. */
#define SWELLING_FROM UINT64_C(1000000000)

/* Voxels or pixels for each byte of a file. */
enum { SWELLING_MOST = 200 };

/* Whether a file of `on_disk` bytes that claims so many `items`, of which so many bytes of memory
 * would be held, needs a yes. */
static inline bool swelling_needs_yes(uint64_t memory, uint64_t items, uint64_t on_disk)
{
    return memory >= SWELLING_FROM && items / SWELLING_MOST > on_disk;
}

#endif
