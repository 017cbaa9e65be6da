/* SPDX-License-Identifier: MIT */
/* Rules that the readers of this process share with those of the helpers: units of length by their
 * names, how many bytes packed voxels inflate to, and which files are refused as bombs. */
#ifndef IMAGE_READER_COMMON_H
#define IMAGE_READER_COMMON_H

#include <stdbool.h>
#include <stdint.h>

/* ---- units ---- */

/* The names, for messages. */
#define LENGTH_UNITS "pm, angstrom, nm, um, mm, cm, dm, m, in"

/* Millimetres in a unit: "um", "\u00b5m" in UTF-8 or Latin-1, "micrometers"; small and capital
 * letters are the same. 0 for an unknown name: a length is never guessed. */
double length_mm(const char *name);

/* ---- packed voxels ---- */

/* Inflate gzip or zlib, one stream or several: `packed` bytes from `from` in an open file, or up to
 * its end. Returns the number of inflated bytes, 0 without memory. *ends: the stream ended with a
 * correct checksum, or continued so far beyond `needed` that its end does not matter. Used before a
 * library fills missing voxels with zeros, and for the message. */
uint64_t inflated_bytes(int fd, uint64_t from, uint64_t packed, uint64_t needed, bool *ends);

/* The message for missing voxels: its prefix, inflated bytes, INFLATED_CHECKSUM or "" (only the
 * checksum is missing), needed bytes. */
#define INFLATED_LACKS                                                                             \
    "%scut short or damaged: of its packed voxels %llu bytes can be had%s, and its header "        \
    "promises %llu; fetch it again"
#define INFLATED_CHECKSUM " without their checksum"

/*
 * Bombs: a file of a megabyte that claims gigabytes. Any gzip may hold a thousand times its bytes,
 * so such a file is a mistake or an attack unless the user accepts it. A scene shrinks to a half or
 * a tenth, a label map to a hundredth.
 */

/* Bytes of memory; smaller files are never refused, larger ones are announced. */
#define SWELLING_FROM UINT64_C(1000000000)

/* Voxels or pixels for each byte of a file. */
enum { SWELLING_MOST = 200 };

/* Return true if a file of `on_disk` bytes that claims `items` voxels or pixels, which take
 * `memory` bytes, needs the user's consent. */
static inline bool swelling_needs_yes(uint64_t memory, uint64_t items, uint64_t on_disk)
{
    return memory >= SWELLING_FROM && items / SWELLING_MOST > on_disk;
}

#endif
