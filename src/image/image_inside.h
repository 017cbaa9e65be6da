/* SPDX-License-Identifier: MIT */
/* Declarations of units of this room that no other room includes. */
#ifndef IMAGE_IMAGE_INSIDE_H
#define IMAGE_IMAGE_INSIDE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/err.h"
#include "image/volume_format.h"

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

/* Makes the size and the place of what the header says those of the part that header->choice asks
 * for, and notes what is left out. ERR_USAGE where the box is not in the volume; ERR_LIMIT where
 * the part, or the whole, is larger than a grid holds. */
enum err part_choose(struct volume_header *header, struct fault *fault);

/* Return true if the choice is a part of the volume. */
static inline bool part_is_less(const struct volume_header *header)
{
    return header->choice.has_crop || header->choice.reduce > 1;
}

/* The numbers of the part, of the type of the file and in its byte order, from the volume that
 * begins `offset` bytes after the beginning. */
enum err part_read(void *to, const struct volume_header *header, uint64_t offset,
                   struct volume_source *source, struct watch *watch, struct fault *fault);

/*
 * Quantisation: the numbers of a file as the 16 bits that a scene holds, and the way back.
 *
 *     uint8, uint16     as they are
 *     int8, int16       less the least value found, where that is negative
 *     32 and 64 bits,   as they are, or less the least value, where that makes them fit 16 bits:
 *     whole numbers     exact; else divided by the least whole number that makes them fit, halves
 *                       rounded up, which is noted, and `volume.is_coarse`: no map of regions
 *     float32, float64  as whole numbers are, where all are whole and fit 16 bits so: exact; else
 *                       linear, least .. greatest found -> 0 .. 65535, halves rounded up (a
 *                       constant image is 0 everywhere); a voxel that is no number or infinite has
 *                       the least value, or 0 where none is below; they are counted in a note
 *
 * Where a few numbers far from all others would take the levels of those (which is when, is in
 * quantise.c), the scale is linear over the rest, and what lies beyond it is put to its ends,
 * counted in a note:
 *
 *     core              the rest, low .. high; W = high - low
 *     scale             low - W .. high + W, but no further than the least and the greatest
 *     1 .. 65534        the levels within it. Whole numbers are divided by the least whole number
 *                       that makes the core fit; then the scale reaches as far as levels are left
 *     0, 65535          what is below, and what is above; no number is 0 as well, below all
 *
 * With choice.by_extremes no scale is cut.
 */

/* Turns the numbers at volume->intensity, of header->type and in its byte order, into intensities
 * in their place; of one byte a voxel they stand in the upper half of the array. Slope and
 * intercept of the volume lead to what header->geometry's make of the numbers. Watched: of no use
 * where the watch (or NULL) stops it. ERR_MEMORY. */
enum err quantise(struct volume *volume, const struct volume_header *header, struct watch *watch,
                  struct fault *fault);

/*
 * Straighten: a volume whose axes are sheared, as those of a scanner whose gantry leans, on a grid
 * of axes at right angles.
 *
 * Two axes stay in their plane, those that are nearest to a right angle: of slices, those of their
 * pixels. Slices along the third are shifted in their planes, until they lie above each other; a
 * slice takes nothing from another. Values are linear between the two or four pixels that a voxel
 * lies between, in integers, halves rounded up. Shifts are worked out once, to 2^-30 of a voxel;
 * from there on it is integers, so that a journal gives the same on every machine.
 *
 * What comes out is as large as the shifted slices together. A voxel of it that no pixel is half a
 * voxel from has the least value of the volume, and such are counted in a note.
 */

/* How large a volume of this size and place becomes. ERR_LIMIT where that is more than a grid holds
 * or eight times the voxels. */
enum err straighten_size(uint32_t out[3], const uint32_t size[3], const struct geometry *geometry,
                         struct fault *fault);

/* The volume, straightened; as it is, with a note, where its axes stand at right angles. Watched.
 * ERR_MEMORY, ERR_CANCELLED or the errors above: it is as it was then. */
enum err straighten(struct volume *volume, struct watch *watch, struct fault *fault);

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

/*
 * The header of a NIfTI file: its fields as plain numbers, and the geometry that they give.
 *
 * NIfTI-1 (348 bytes) and NIfTI-2 (540 bytes) hold the same fields at other places and in other
 * widths; one table of places serves reading and writing both. Decoding believes nothing and
 * refuses nothing but an unknown kind of file: what the numbers are worth is checked by the reader.
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
    int64_t intent_code; /* what the values mean */
    int64_t datatype, bitpix;
    double pixdim[8];
    double vox_offset;
    double scl_slope, scl_inter;
    int64_t xyzt_units;
    int64_t qform_code, sform_code;
    double quatern[3], qoffset[3];
    double srow[3][4];
    char descrip[NIFTI_DESCRIPTION]; /* written only: what a file says here is never shown */
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
