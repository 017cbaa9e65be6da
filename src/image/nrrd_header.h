/* SPDX-License-Identifier: MIT */
/*
 * The header of a NRRD whose voxels follow it in the same file, as far as it is certain what it
 * says.
 *
 * teem has a loose format: numbers may have anything after them, fields several names, and ITK
 * makes of them what it does. So nothing is refused here. A header is taken, and then says what ITK
 * 5.2 says of it, to the last bit; or it is left to ITK, which then reads it, or knows why not:
 * where voxels lie in other files, are text, are no three spatial axes of numbers; where a field is
 * unknown, comes twice or too early, contradicts another, or has a value that is not plain.
 *
 * Of left-anterior-superior ITK 5.2 turns the wrong axis, x to the right where y goes to the back:
 * iftty-volume puts that right, and this is what it says then. Names of the space that have blanks
 * in them are none of the patient for iftty-volume, which matters nowhere but there: they are left
 * to it.
 *
 * From: https://teem.sourceforge.net/nrrd/format.html, and NrrdIO in ITK 5.2.
 */
#ifndef IMAGE_NRRD_HEADER_H
#define IMAGE_NRRD_HEADER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "image/volume_format.h"

/* The first bytes of any. */
#define NRRD_MAGIC "NRRD000"

/* What ITK's client looks at, and no more. */
enum { NRRD_HEADER_MOST = (1 << 20) - 1 };

struct nrrd_header {
    uint32_t size[3];
    enum voxel_type type;
    bool big_endian, is_packed; /* one gzip stream of the voxels, or the voxels */
    uint64_t offset;            /* of their first byte in the file */
    double to_mm[3][4];         /* to the world, as far as the header says it: */
    bool knows_spacing, knows_place;
};

/* How long the header is at the beginning of these bytes, with the empty line that ends it; 0 where
 * it goes on. */
size_t nrrd_header_length(const char *bytes, size_t length);

/* Takes it, of so many bytes, which are changed; false where it is left to ITK. */
bool nrrd_header_read(struct nrrd_header *out, char *bytes, size_t length);

#endif
