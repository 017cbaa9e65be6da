/* SPDX-License-Identifier: MIT */
/*
 * Segments of a .seg.nrrd that has several layers, since some of them overlap: each has a layer,
 * which is a volume of the file, and the value of its voxels there.
 *
 *     Segment2_Name:=vessel
 *     Segment2_LabelValue:=1
 *     Segment2_Layer:=1
 *
 * A file without layers, as 3D Slicer wrote it before 4.11, has one segment in each volume, of
 * value 1.
 */
#ifndef IMAGE_NRRD_SEGMENTS_H
#define IMAGE_NRRD_SEGMENTS_H

#include "base/buf.h"
#include "image/volume_format.h"

/* Sets out->contents by the lines of a header: of the volume that out->choice has, or of all. */
void nrrd_segments_tell(struct volume_header *out, const char *bytes, size_t length);

#endif
