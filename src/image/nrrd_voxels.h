/* SPDX-License-Identifier: MIT */
/*
 * The voxels of a NRRD in the same file, as the bytes that its source has from then on, in the
 * order of this machine: what iftty-volume gives of the same file, and where it refuses one that
 * was cut or is damaged, the same words, with the same count of what can be had.
 */
#ifndef IMAGE_NRRD_VOXELS_H
#define IMAGE_NRRD_VOXELS_H

#include "image/nrrd_header.h"

uint64_t nrrd_voxels_bytes(const struct nrrd_header *header); /* of all, unpacked */

/* Has the source decode them, which owns what it takes; or leaves it as it was, and is OK, where
 * what should be gzip is none, which zlib may take all the same. */
enum err nrrd_voxels_enter(struct volume_source *source, const struct nrrd_header *header,
                           struct fault *fault);
bool nrrd_voxels_are_of(const struct volume_source *source); /* whether it does */

/* For volume_format.begin_voxels of such a source. */
enum err nrrd_voxels_begin(struct volume_source *source, const struct volume_header *header,
                           struct fault *fault);

#endif
