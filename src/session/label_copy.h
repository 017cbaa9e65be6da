/*
 * Copies of label maps: what a command has taken from a file that somebody else may move, change or
 * delete, as the result of a learned model. The copy lies beside the journal, in the folder of its
 * golden images, and goes with it; so a replay needs neither the file nor the model.
 *
 * A copy holds labels 0..255, and 65535 in voxels of regions that were not chosen, as uint16 on the
 * scene's grid, and nothing that the file said besides. Its name is the digest of those numbers,
 * which the command records:
 *
 *     study.golden/labels-0123456789abcdef0123456789abcdef.nii.gz
 */
#ifndef SESSION_LABEL_COPY_H
#define SESSION_LABEL_COPY_H

#include <stdbool.h>

#include "base/buf.h"
#include "image/volume.h"

enum { LABEL_COPY_DIGEST = 33 }; /* 32 digits and NUL: 128 bits of SHA-256 */

/* Of a map as map_choose leaves it: over its sides as 32 bits each, then its labels, x fastest, as
 * 16 bits; all little-endian. */
enum err label_copy_digest(char digest[LABEL_COPY_DIGEST], const struct volume *map,
                           struct watch *watch, struct fault *fault); /* ERR_CANCELLED */
bool label_copy_is_digest(const char *text);

/* Adds the name of a copy in its folder. */
void label_copy_name(struct buf *out, const char *digest);

/* Writes it, at the place of `geometry`; there is none yet. The errors of volume_write. */
enum err label_copy_write(const char *path, const struct volume *map,
                          const struct geometry *geometry, struct watch *watch,
                          struct fault *fault);

#endif
