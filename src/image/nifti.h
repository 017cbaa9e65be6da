/* SPDX-License-Identifier: MIT */
/*
 * Pairs of NIfTI and ANALYZE: a header in one file and its voxels in another beside it, A.hdr and
 * A.img. Either may be gzip, as A.hdr.gz and A.img.gz, and either names the pair.
 */
#ifndef IMAGE_NIFTI_H
#define IMAGE_NIFTI_H

#include <stdbool.h>

#include "base/buf.h"

#define PAIR_HEADERS ".hdr|.hdr.gz"
#define PAIR_VOXELS  ".img|.img.gz"

/* `other` is the path of the file that makes a pair with `path`: of two, the one that is packed as
 * `path` is. Where there is none, false, and `other` is the path that it would have; "" for a name
 * that is of no pair. */
bool pair_other(struct buf *other, const char *path);

#endif
