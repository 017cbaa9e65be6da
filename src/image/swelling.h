/* SPDX-License-Identifier: MIT */
/*
 * Files that swell as no honest one does: a megabyte that claims gigabytes.
 *
 * Any gzip may hold a thousand times its bytes, so such a file is a mistake or an attack, unless
 * the user says that it is not. A scene shrinks to a half or a tenth, a label map to a hundredth.
 */
#ifndef IMAGE_SWELLING_H
#define IMAGE_SWELLING_H

#include <stdbool.h>
#include <stdint.h>

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
