/* SPDX-License-Identifier: MIT */
/*
 * Doubt: in which slice it is least certain where a label ends, by the fields of relaxation
 * (engine/relax.h).
 *
 * A field says 1 in the label and 0 elsewhere, and between where the scene does not tell. The doubt
 * of a voxel is 4u(1 - u): 0 where u is 0 or 1, and DOUBT_VOXEL where it is half; so sums are
 * volumes, in voxels, of what is wholly in doubt. That of a slice is the sum over its voxels; of
 * all labels, over all of their fields, in which a border between two labels counts for both.
 *
 * The fields are of the labels as the first `relax` of a list finds them, with its sweeps; or as
 * the whole list leaves them where it has none, with the usual sweeps.
 *
 * All of it is a function of the forest's labels, seeds, the scene and the list, in integers.
 */
#ifndef ENGINE_DOUBT_H
#define ENGINE_DOUBT_H

#include "engine/finish.h"

enum { DOUBT_VOXEL = 1 << 20 };

/* {0} is of nothing. */
struct doubt {
    uint32_t size[3];   /* of the scene */
    uint64_t *slice[3]; /* [size[axis]]: of slices across x, y, z */
    uint64_t all;       /* of the scene: what the slices across each axis come to */
};

/* Of a label 1..255, or FINISH_ALL_LABELS. ERR_MEMORY, ERR_LIMIT (finish_check), ERR_CANCELLED by
 * the scene's watch; then of nothing. */
enum err doubt_find(struct doubt *doubt, const struct finish_list *list, const struct scene *scene,
                    struct team *team, unsigned label, struct fault *fault);
void doubt_release(struct doubt *doubt);

/* The slice with the most doubt: its axis, and where along that. Of equals that of the lower axis,
 * and the lower one. False where there is no doubt. */
bool doubt_worst(const struct doubt *doubt, unsigned *axis, uint32_t *at);

#endif
