/* SPDX-License-Identifier: MIT */
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
#ifndef IMAGE_STRAIGHTEN_H
#define IMAGE_STRAIGHTEN_H

#include "image/volume_format.h"

/* How large a volume of this size and place becomes. ERR_LIMIT where that is more than a grid holds
 * or eight times the voxels. */
enum err straighten_size(uint32_t out[3], const uint32_t size[3], const struct geometry *geometry,
                         struct fault *fault);

/* The volume, straightened; as it is, with a note, where its axes stand at right angles. Watched.
 * ERR_MEMORY, ERR_CANCELLED or the errors above: it is as it was then. */
enum err straighten(struct volume *volume, struct watch *watch, struct fault *fault);

#endif
