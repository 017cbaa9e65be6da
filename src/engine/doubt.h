/* SPDX-License-Identifier: MIT */
/*
 * Doubt: the slices in which the end of a label is least certain, from the fields of relaxation
 * (engine/relax.h).
 *
 * A field is 1 in the label and 0 elsewhere, and in between where the scene is ambiguous. The doubt
 * of a voxel is 4u(1 - u): 0 for u = 0 or 1, and DOUBT_VOXEL for 1/2; so sums are volumes, in
 * voxels, of fully doubtful tissue. The doubt of a slice is the sum over its voxels; for all
 * labels, the sum over all of their fields, so that a border between two labels counts for both.
 *
 * The fields start from the labels before the first `relax` of a list, with its sweeps; or from the
 * result of a list without `relax`, with the default sweeps. They reach FINISH_BAND_MOST steps from
 * a border, whatever the reach of that `relax`.
 *
 * The result is a function of the forest's labels, seeds, the scene and the list, in integers.
 */
#ifndef ENGINE_DOUBT_H
#define ENGINE_DOUBT_H

#include "engine/finish.h"

enum { DOUBT_VOXEL = 1 << 20 };

/* {0} is empty. */
struct doubt {
    uint32_t size[3];   /* size of the scene */
    uint64_t *slice[3]; /* [size[axis]]: doubt of slices across x, y, z */
    uint64_t all;       /* doubt of the scene, the sum of the slices of each axis */
};

/* Compute the doubt of a label 1..255, or FINISH_ALL_LABELS. ERR_MEMORY, ERR_LIMIT (finish_check),
 * ERR_CANCELLED by the scene's watch; the result is then empty. */
enum err doubt_find(struct doubt *doubt, const struct finish_list *list, const struct scene *scene,
                    struct team *team, unsigned label, struct fault *fault);
void doubt_release(struct doubt *doubt);

/* Find the slice with the most doubt: its axis, and its position along it. Ties: the lower axis,
 * then the lower position. False without any doubt. */
bool doubt_worst(const struct doubt *doubt, unsigned *axis, uint32_t *at);

#endif
