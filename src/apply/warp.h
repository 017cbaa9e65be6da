/* SPDX-License-Identifier: MIT */
/*
 * A procedure's labels brought to another scene, and what of them is planted there.
 *
 *     warped    each voxel of the scene takes the label of the procedure's voxel that is nearest
 *               to where the pull leads: voxel -> its world -> the procedure's world -> voxel. One
 *               that leads beyond the procedure's grid has none, and nothing is planted there
 *     eroded    a voxel stays a seed where it is `depth_mm` or more from the voxels at the border
 *               of its label, by their centres; the edge of the scene is no border. Of an
 *               object so small that fewer than a tenth of its voxels would be left, the depth is
 *               what leaves a tenth: so it keeps seeds, and they are its innermost voxels
 *     gated     a seed of an object is dropped where its intensity is not one that the object had.
 *               The object's percentiles 10 and 90 in the procedure stand for those of its warped
 *               voxels here; what lies below the lower one, or above the higher one, by more than
 *               `gate` times what lies between them, is off. No image of the procedure is needed
 *               for that. The background has no intensity of its own and is not gated
 *
 * Floating point, and fine: what comes of it is written into a map, and no replay makes it anew.
 */
#ifndef APPLY_WARP_H
#define APPLY_WARP_H

#include "apply/procedure.h"

/* Values of a map of seeds: 0 for none, 1..255 for seeds of those labels, and: */
enum { SEEDS_BACKGROUND = 256, SEEDS_DROPPED = 256 }; /* label + SEEDS_DROPPED: it was dropped */

enum { WARP_NONE = UINT16_MAX };

struct warped {
    uint16_t *label; /* [z][y][x] 0..255, or WARP_NONE; then what warp_seeds makes of it */
    size_t voxels;
    struct percentiles percentiles;     /* of labels as they were warped */
    double depth_mm[256];               /* by which each was eroded */
    double within[256][2];              /* real values that its seeds have; low above high: any */
    uint64_t eroded[256], dropped[256]; /* seeds before the gate, and of those dropped by it */
};
void warped_release(struct warped *warped);

/* Labels alone. `warped` is to be released whatever is returned. ERR_INPUT where the scene and the
 * procedure have no voxel in common, ERR_MEMORY, ERR_CANCELLED. */
enum err warp_labels(struct warped *warped, const struct procedure *procedure,
                     const struct session *session, const struct affine *pull, struct fault *fault);

/* What is within the gate, of each label, by the percentiles of both. */
void warp_find_gates(struct warped *warped, const struct procedure *procedure, double gate);

/* Makes of the labels a map of seeds. ERR_MEMORY, ERR_CANCELLED. */
enum err warp_seeds(struct warped *warped, const struct session *session, double depth_mm,
                    struct fault *fault);

/* Whether a real value is within a range, or that is of any (low above high). */
static inline bool warp_may_have(const double within[2], double value)
{
    return within[0] > within[1] || (value >= within[0] && value <= within[1]);
}

#endif
