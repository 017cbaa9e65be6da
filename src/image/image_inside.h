/* SPDX-License-Identifier: MIT */
/* Declarations that no other room includes. */
#ifndef IMAGE_IMAGE_INSIDE_H
#define IMAGE_IMAGE_INSIDE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/err.h"
#include "image/volume_format.h"

/*
 * Parts: a box of a volume, or one voxel for each block of it, selected while the file is read.
 *
 * This opens a scene that is larger than memory. The file is read from its beginning to the end of
 * the box (plane by plane if it is not packed), and memory holds only the part and one plane.
 *
 *     crop     the voxels first..last along each axis of the file
 *     reduce   N x N x N voxels become one, starting at the first voxel of the box: the mean of the
 *              finite ones, halves of whole numbers rounded up; or, for labels, the voxel in the
 *              middle (for an even N, the one before it). Incomplete blocks at the end of an axis
 *              are left out; an axis of fewer than N voxels is not reduced.
 *
 * A voxel of the part has the position of the middle of its block.
 */

/* Replace the size and the place in the header by those of the part in header->choice, and note
 * voxels that are left out. ERR_USAGE if the box is not in the volume; ERR_LIMIT if the part, or
 * the whole, is larger than a grid holds. */
enum err part_choose(struct volume_header *header, struct fault *fault);

/* Return true if the choice is a part of the volume. */
static inline bool part_is_less(const struct volume_header *header)
{
    return header->choice.has_crop || header->choice.reduce > 1;
}

/* Read the numbers of the part, in the type and byte order of the file, from the volume at byte
 * `offset`. */
enum err part_read(void *to, const struct volume_header *header, uint64_t offset,
                   struct volume_source *source, struct watch *watch, struct fault *fault);

/*
 * Quantisation: convert the numbers of a file to the 16 bits of a scene, with the way back.
 *
 *     uint8, uint16     unchanged
 *     int8, int16       minus the least value, if that is negative
 *     32 and 64 bits,   unchanged, or minus the least value, if they then fit 16 bits: exact;
 *     whole numbers     otherwise divided by the least whole number that makes them fit, halves
 *                       rounded up, with a note and `volume.is_coarse`: unusable as map of regions
 *     float32, float64  like whole numbers if all are whole and fit 16 bits: exact; otherwise
 *                       linear, least .. greatest -> 0 .. 65535, halves rounded up (a constant
 *                       image is 0 everywhere). NaN and infinite voxels have the least value, or 0
 *                       if no value is below; a note counts them
 *
 * If a few outliers would use up the levels of all other numbers (defined in quantise.c), the scale
 * is linear over the core without them, and numbers beyond the scale are clamped to its ends and
 * counted in a note:
 *
 *     core              numbers without the outliers, low .. high; W = high - low
 *     scale             low - W .. high + W, but not beyond the least and the greatest
 *     1 .. 65534        the levels within the scale. Whole numbers are divided by the least whole
 *                       number that makes the core fit; the scale then uses all remaining levels
 *     0, 65535          all numbers below, and above; NaN is 0 too, below every number
 *
 * With choice.by_extremes no scale is cut. Whole numbers of 32 and 64 bits that do not fit 16 bits,
 * with 65534 distinct ones at most and no negative one, are then the ranks of these numbers and 0,
 * with volume.value: a map of labels with large numbers.
 */

/* Convert the numbers at volume->intensity, of header->type and in its byte order, to intensities
 * in place; numbers of one byte are in the upper half of the array. Slope and intercept of the
 * volume map intensities to the real values of header->geometry. Unusable if the watch (or NULL)
 * stops. ERR_MEMORY. */
enum err quantise(struct volume *volume, const struct volume_header *header, struct watch *watch,
                  struct fault *fault);

/*
 * Straighten: resample a volume with sheared axes, as from a scanner with a tilted gantry, to a
 * grid with axes at right angles.
 *
 * The two axes that are nearest to a right angle keep their plane: the rows and columns of slices.
 * Slices along the third axis are shifted in their planes until they are aligned; slices are never
 * mixed. Values are interpolated linearly between two or four pixels, in integers, halves rounded
 * up. Shifts are computed once, to 2^-30 of a voxel, and everything after that is integers, so that
 * a journal has the same result on every machine.
 *
 * The result covers all shifted slices. A voxel with no pixel within half a voxel has the least
 * value of the volume; a note counts these voxels.
 */

/* Compute the size of the result. ERR_LIMIT if it is more than a grid holds or eight times the
 * voxels. */
enum err straighten_size(uint32_t out[3], const uint32_t size[3], const struct geometry *geometry,
                         struct fault *fault);

/* Straighten the volume; if its axes are at right angles, only add a note. ERR_MEMORY,
 * ERR_CANCELLED or the errors above leave it unchanged. */
enum err straighten(struct volume *volume, struct watch *watch, struct fault *fault);

/*
 * The header of a NRRD whose voxels follow it in the same file, if its meaning is certain.
 *
 * teem's format is loose: anything may follow a number, fields have several names, and ITK
 * interprets them in its own way. So nothing is refused here. Either a header is accepted, with the
 * result of ITK 5.2 to the last bit; or it is left to ITK, which reads or refuses it: if voxels are
 * in other files, or are text, or have other than three spatial axes of numbers; if a field is
 * unknown, occurs twice or too early, contradicts another, or has an unusual value.
 *
 * ITK 5.2 flips the wrong axis of left-anterior-superior: x instead of y. iftty-volume corrects
 * this, and the result here is the corrected one. iftty-volume does not recognise names of spaces
 * with blanks, which matters for such files alone: they are left to it.
 *
 * From: https://teem.sourceforge.net/nrrd/format.html, and NrrdIO in ITK 5.2.
 */

/* The first bytes of every file. */
#define NRRD_MAGIC "NRRD000"

/* The length that the client of ITK examines. */
enum { NRRD_HEADER_MOST = (1 << 20) - 1 };

struct nrrd_header {
    uint32_t size[3];
    enum voxel_type type;
    bool big_endian, is_packed; /* packed: the voxels are one gzip stream */
    uint64_t offset;            /* position of their first byte in the file */
    double to_mm[3][4];         /* to the world; its known parts: */
    bool knows_spacing, knows_place;
};

/* Length of the header at the beginning of these bytes, with the empty line that ends it; 0 if its
 * end is not among them. */
size_t nrrd_header_length(const char *bytes, size_t length);

/* Read a header of `length` bytes, which are modified; false if it is left to ITK. */
bool nrrd_header_read(struct nrrd_header *out, char *bytes, size_t length);

/*
 * The header of a NIfTI file: its fields as plain numbers, and the geometry that they define.
 *
 * NIfTI-1 (348 bytes) and NIfTI-2 (540 bytes) store the same fields at different positions and
 * widths; one table serves reading and writing both. Decoding refuses unknown kinds of files alone:
 * the reader checks the numbers.
 */

enum { NIFTI_LEAST_BYTES = 348, NIFTI_MOST_BYTES = 540, NIFTI_DESCRIPTION = 80 };

/* Place of the voxels: after the header in the same file, or in the other file of a pair
 * (image/volume.h), whose header is that of NIfTI or of ANALYZE. */
enum nifti_kind { NIFTI_SINGLE, NIFTI_PAIR, NIFTI_ANALYZE };

struct nifti_header {
    enum nifti_kind kind;
    bool big_endian;
    size_t bytes; /* 348 or 540 */
    int64_t dim[8];
    int64_t intent_code; /* meaning of the values */
    int64_t datatype, bitpix;
    double vox_offset;
    double scl_slope, scl_inter;
    struct geometry_fields fields;
    char descrip[NIFTI_DESCRIPTION]; /* written only: that of a file is never shown */
};

/* Fill ->kind, ->bytes and ->big_endian by the first NIFTI_LEAST_BYTES. ERR_INPUT if sizeof_hdr is
 * that of neither version, or the magic not of NIfTI-2. */
enum err nifti_header_recognise(struct nifti_header *header, const uint8_t *bytes,
                                struct fault *fault);

/* Read the other fields from header->bytes bytes. */
void nifti_header_decode(struct nifti_header *header, const uint8_t *bytes);

/* Write header->bytes bytes, little-endian, for a single file. */
void nifti_header_encode(const struct nifti_header *header, uint8_t *bytes);

/* Convert the header to the geometry of a scene of that size (without slope and intercept), with a
 * note on each missing fact; and the reverse, which may change ->bytes to those of NIfTI-2, so set
 * vox_offset after it. */
void nifti_header_geometry(struct geometry *geometry, char notes[VOLUME_NOTES_BYTES],
                           const struct nifti_header *header, const uint32_t size[3]);
void nifti_header_place(struct nifti_header *header, const struct geometry *geometry);

#endif
