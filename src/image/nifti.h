/*
 * NIfTI: scenes in, label and cost maps out.
 *
 * Single files are read, NIfTI-1 and NIfTI-2, plain or gzip (told by content, not by name), both
 * byte orders. Intensities are held as 16 bits whatever the file holds; geometry.slope and
 * .intercept lead back to real values, the file's own scl_slope and scl_inter included:
 *
 *     uint8, uint16   as they are
 *     int16           less the least value found, where that is negative
 *     float32         linear, least .. greatest found -> 0 .. 65535, halves rounded up
 *                     (a constant image is 0 everywhere)
 *
 * Where the voxels lie: the sform if its code is positive and its matrix can be inverted, else the
 * qform likewise, else pixdim along the axes. xyzt_units (metres, millimetres, micrometres) applies
 * to all three; without it they are millimetres. Of pixdim the sign is dropped and 0 means 1 (what
 * other readers do); not a number, or outside 1 nm .. 4 m, is refused.
 *
 * Nothing a file claims is believed before it is checked: no more is allocated than the size of the
 * file can account for (a deflate stream grows at most 1032-fold), and no more is inflated than the
 * header, its extensions and the voxels (and 64 kB after them, to reach the checksum of a gzip).
 *
 * From: nifti1.h and nifti2.h at https://nifti.nimh.nih.gov, whose field names are used below.
 */
#ifndef IMAGE_NIFTI_H
#define IMAGE_NIFTI_H

#include <stdint.h>

#include "base/err.h"
#include "base/file.h"
#include "base/watch.h"
#include "image/geometry.h"

struct volume {
    uint32_t size[3];
    uint16_t *intensity; /* [z][y][x], x fastest */
    struct geometry geometry;
};

/* Reads the scene in `path`, under a watch (or NULL). It takes two bytes a voxel, four while
 * float32 is read, and as much as the file where a gzip is inflated whole (image/inflate.h). On
 * failure *out is empty and the words say what was wrong and what was expected: ERR_INPUT for
 * content, ERR_LIMIT, ERR_IO, ERR_MEMORY, ERR_CANCELLED. */
enum err nifti_read(struct volume *out, const char *path, struct watch *watch, struct fault *fault);
void volume_release(struct volume *volume);

/* What the header of `path` says; of voxels of a type that is not read too, as those of the root
 * map that `save` writes. Others are refused where nifti_read would refuse the header. */
struct nifti_facts {
    uint32_t size[3];
    struct geometry geometry; /* but for slope and intercept */
    const char *type;         /* of voxels, "int16" */
    unsigned version;         /* of NIfTI, 1 or 2 */
    bool big_endian;
};
enum err nifti_about(struct nifti_facts *out, const char *path, struct fault *fault);

/* The size of the scene in `path`, from its header alone; refuses what nifti_read would refuse
 * before it reads a voxel. */
enum err nifti_size(uint32_t size[3], const char *path, struct fault *fault);

enum nifti_type { NIFTI_UINT8, NIFTI_UINT16, NIFTI_UINT32 };

/* Writes a map of `size` voxels, little-endian, as `path`, which ends in .nii or .nii.gz; whole or
 * not at all, as where the watch (or NULL) stops it. `row` is asked for the rows in file order, y
 * faster than z, and fills size[0] values of the type. `description` is cut to what the header
 * holds (79 bytes). The same values give the same bytes: a gzip file carries no time and no name.
 *
 * The sform is to_mm, under the code it was read with (or the qform's, or 1). The qform is written
 * where it can say the same; a sheared matrix has none. NIfTI-1, or NIfTI-2 where a side is longer
 * than the 32767 voxels that NIfTI-1 can tell. */
enum err nifti_write(const char *path, enum file_mode mode, const uint32_t size[3],
                     const struct geometry *geometry, enum nifti_type type, const char *description,
                     void (*row)(void *context, uint32_t y, uint32_t z, void *values),
                     void *context, struct watch *watch, struct fault *fault);

#endif
