/* SPDX-License-Identifier: MIT */
/*
 * The header of a NIfTI file: its fields as plain numbers, and the geometry that they give.
 *
 * NIfTI-1 (348 bytes) and NIfTI-2 (540 bytes) hold the same fields at other places and in other
 * widths; one table of places serves reading and writing both. Decoding believes nothing and
 * refuses nothing but an unknown kind of file: what the numbers are worth is checked by the reader.
 */
#ifndef IMAGE_NIFTI_HEADER_H
#define IMAGE_NIFTI_HEADER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/err.h"
#include "image/volume_format.h"

enum { NIFTI_LEAST_BYTES = 348, NIFTI_MOST_BYTES = 540, NIFTI_DESCRIPTION = 80 };

/* Where the voxels are: after the header in the same file, or in another (nifti.h), whose
 * header says that it is NIfTI's or else is ANALYZE's. */
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

/* Whether a file that begins with these bytes may be NIfTI, or the ANALYZE that it grew from. */
bool nifti_header_is_one(const uint8_t *begin, size_t length);

/* What header begins with these NIFTI_LEAST_BYTES: fills its ->kind, ->bytes and ->big_endian.
 * ERR_INPUT where sizeof_hdr is of none, or the magic not of NIfTI-2. */
enum err nifti_header_recognise(struct nifti_header *header, const uint8_t *bytes,
                                struct fault *fault);

/* The other fields, out of header->bytes bytes. */
void nifti_header_decode(struct nifti_header *header, const uint8_t *bytes);

/* Makes of what was decoded of `bytes` what ANALYZE means by it, with a note on what it leaves
 * open. */
void nifti_header_take_analyze(struct nifti_header *header, const uint8_t *bytes,
                               char notes[VOLUME_NOTES_BYTES]);

/* header->bytes bytes, little-endian, for a single file. */
void nifti_header_encode(const struct nifti_header *header, uint8_t *bytes);

/* What the header says of the place of voxels (not slope and intercept), of a scene of that size,
 * with a note on each thing that it leaves open; and the reverse. */
void nifti_header_geometry(struct geometry *geometry, char notes[VOLUME_NOTES_BYTES],
                           const struct nifti_header *header, const uint32_t size[3]);
/* May make it a NIfTI-2, so vox_offset follows. */
void nifti_header_place(struct nifti_header *header, const struct geometry *geometry);

#endif
