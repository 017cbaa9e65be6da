/*
 * Voxels as plain numbers, one after another, in a file: how most formats hold them.
 * image/intensities.h says what becomes of them.
 */
#ifndef IMAGE_VOXELS_H
#define IMAGE_VOXELS_H

#include "image/volume.h"

unsigned voxel_bytes(enum voxel_type type);
const char *voxel_type_name(enum voxel_type type); /* "int16" */

/* The type that is read, by its name; false where there is none. */
bool voxel_type_named(enum voxel_type *out, const char *name);

/* That a file of this size can hold the voxels that its header claims, before anything large is
 * allocated. */
enum err voxels_check(const struct volume_header *header, const struct volume_source *source,
                      struct fault *fault);

/* Of a file that is not packed, notes how many bytes come after the last voxel, which is odd, with
 * that advice. */
void voxels_note_rest(struct volume_header *header, const struct volume_source *source,
                      const char *advice);

/* For volume_format.read_voxels. The size has been checked. */
enum err voxels_read(struct volume *volume, const struct volume_header *header,
                     struct volume_source *source, struct watch *watch, struct fault *fault);

/* What of a file is gzip. */
enum packing { PACKED_NOT, PACKED_VOXELS, PACKED_WHOLE };

/* For volume_format.write: `header`, then the voxels, little-endian. */
enum err voxels_write(const char *path, enum file_mode mode, const void *header,
                      size_t header_bytes, enum packing packing, const struct volume_map *map,
                      struct watch *watch, struct fault *fault);

#endif
