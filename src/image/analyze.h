/*
 * ANALYZE 7.5: the format that NIfTI-1 grew from, whose header has the same length.
 *
 * Sizes, type, spacing and offset are where NIfTI has them. Where NIfTI has the place of voxels in
 * the patient, ANALYZE has names, dates and numbers of the patient, and one byte, `orient`, which
 * most programs write without looking. So its orientation is unknown.
 *
 *     byte 56     4 characters: the unit of length, "mm" where there is none
 *     byte 112    float32: what SPM multiplies the values by; 0 for none
 *     byte 116    float32: what SPM 2 adds to them
 *     byte 252    orient: 0 to 5
 *
 * From: Mayo Clinic, ANALYZE 7.5 File Format; spm_hread.m and spm_type.m of SPM99 and SPM2.
 */
#ifndef IMAGE_ANALYZE_H
#define IMAGE_ANALYZE_H

#include "image/nifti_header.h"

/* Makes of what nifti_header_decode found in `bytes` what ANALYZE means by it, with a note on what
 * it leaves open. */
void analyze_take(struct nifti_header *header, const uint8_t *bytes,
                  char notes[VOLUME_NOTES_BYTES]);

#endif
