/*
 * Pairs: a header in one file and its voxels in another beside it, A.hdr and A.img, as ANALYZE and
 * NIfTI have them. Either may be gzip, as A.hdr.gz and A.img.gz, and either names the pair.
 */
#ifndef IMAGE_PAIR_H
#define IMAGE_PAIR_H

#include <stdbool.h>

#include "base/buf.h"
#include "base/err.h"
#include "image/source.h"

#define PAIR_HEADERS ".hdr|.hdr.gz"
#define PAIR_VOXELS  ".img|.img.gz"

/* `other` is the path of the file that makes a pair with `path`: of two, the one that is packed as
 * `path` is. Where there is none, false, and `other` is the path that it would have; "" for a name
 * that is of no pair. */
bool pair_other(struct buf *other, const char *path);

/* Refuses a path, of a file that begins with the header of a pair, that is not called as such. */
enum err pair_check_header(const char *path, struct fault *fault);

/* From one file of a pair, which was opened, to the header, or from there to the voxels. ERR_INPUT
 * or ERR_IO where there is none; then the source is where it was. */
enum err pair_go_to_header(struct volume_source *source, struct fault *fault);
enum err pair_go_to_voxels(struct volume_source *source, struct fault *fault);

#endif
