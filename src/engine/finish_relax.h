/* SPDX-License-Identifier: MIT */
/*
 * Relaxation: the step that lets labels settle on the edges of the scene (engine/finish.h).
 *
 * Each label but 0 has a field; that of label 0 is what all others leave of RELAX_ONE, or nothing.
 * A voxel of some band takes the label of the greatest, of several its own if that is one of them,
 * or the smallest. So a few fields are made at a time, and of each voxel only the best so far is
 * kept; and only where some field has moved, since else the label's own is RELAX_ONE, and stays.
 *
 * The field of a label lies in a box around it. Each voxel has a value u, RELAX_ONE in the label
 * and 0 elsewhere at first. Those of the *band* move: voxels from which at most `reach` steps
 * along the axes lead to one on the other side of the label's border. All others keep their value,
 * as do seeds and voxels outside the region of interest.
 *
 * In a half-sweep all voxels of one parity of x + y + z move, each to
 *
 *     u + round((sum over its six neighbours n of w(n) * (u(n) - u)) / 1024),  within 0..RELAX_ONE
 *
 *     w(n) = floor(c(n) * floor(1536 * 2^32 / (sum of c)) / 2^32)
 *
 * where halves round to the even one, so that the field of what is not the label would be exactly
 * RELAX_ONE - u; 1536/1024 is over-relaxation by 24/16. c(n) is the conductance of a difference of
 * intensities, 65536 for none down to 1, by the number of greys in it: 255 greys are the range from
 * the 2nd to the 98th percentile of the intensities in the band, so an edge is one of this label,
 * whatever else is in the scene. Beyond the scene and outside the region of interest it is 0.
 *
 * Voxels of one parity have neighbours of the other alone: so within a half-sweep nothing depends
 * on order, and any number of threads, and any width of vectors, gives the same bits. Nor does it
 * matter how far another plane is, as long as those beside it are as far.
 */
#ifndef ENGINE_FINISH_RELAX_H
#define ENGINE_FINISH_RELAX_H

#include "engine/relax_field.h"

/* Sees a field that is made, by the thread that began, while the others rest. */
typedef void relax_see(void *context, const struct relax_field *field);

/* Makes the field of a label, or FINISH_ALL_LABELS, as work->label has them, and has each seen, in
 * no order. ERR_MEMORY, ERR_CANCELLED by the scene's watch. */
enum err relax_each(const struct finish_work *work, unsigned label, uint32_t sweeps, uint32_t reach,
                    relax_see *see, void *context, struct fault *fault);

#endif
