/* SPDX-License-Identifier: MIT */
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
#ifndef IMAGE_QUANTISE_H
#define IMAGE_QUANTISE_H

#include "image/volume_format.h"

/* Turns the numbers at volume->intensity, of header->type and in its byte order, into intensities
 * in their place; of one byte a voxel they stand in the upper half of the array. Slope and
 * intercept of the volume lead to what header->geometry's make of the numbers. Watched: of no use
 * where the watch (or NULL) stops it. ERR_MEMORY. */
enum err quantise(struct volume *volume, const struct volume_header *header, struct watch *watch,
                  struct fault *fault);

#endif
