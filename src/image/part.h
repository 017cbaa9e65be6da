/* SPDX-License-Identifier: MIT */
/*
 * Parts: a box of a volume, or one voxel for each block of it, taken while the file is read.
 *
 * A scene larger than memory is opened so. The file is read from its beginning to the end of the
 * box (from plane to plane, where it is not packed), and no more is held than the part and a plane
 * of it.
 *
 *     crop     the voxels first..last along each axis, of those in the file
 *     reduce   N x N x N voxels become one, from the first of the box on: their mean, in whole
 *              numbers halves rounded up, of those that are finite; or, for labels, the one in the
 *              middle (of an even N, the one before it). Voxels at the end of an axis that fill no
 *              block are left out; an axis of fewer than N voxels stays as it is.
 *
 * A voxel of the part lies where the middle of its block does.
 */
#ifndef IMAGE_PART_H
#define IMAGE_PART_H

#include "image/volume_format.h"

/* Makes the size and the place of what the header says those of the part that header->choice asks
 * for, and notes what is left out. ERR_USAGE where the box is not in the volume; ERR_LIMIT where
 * the part, or the whole, is larger than a grid holds. */
enum err part_choose(struct volume_header *header, struct fault *fault);

/* Whether it is less than the whole. */
bool part_is_less(const struct volume_header *header);

/* The numbers of the part, of the type of the file and in its byte order, from the volume that
 * begins `offset` bytes after the beginning. */
enum err part_read(void *to, const struct volume_header *header, uint64_t offset,
                   struct volume_source *source, struct watch *watch, struct fault *fault);

#endif
