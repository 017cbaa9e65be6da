/*
 * The rival of a voxel: the label that would take it, were the seeds of its own label gone, and at
 * what cost, which is C' of engine/margin.h, but for one voxel. It is looked for backwards from the
 * voxel, through voxels of its label, along steps from the least weight up, until what is found
 * costs no more than any further step: little work where borders are near, that of a run where
 * there are none.
 */
#ifndef ENGINE_RIVAL_H
#define ENGINE_RIVAL_H

#include "engine/forest.h"

struct rival {
    bool exists; /* false where no seed of another label reaches the voxel */
    uint32_t cost;
    uint8_t label; /* of several that cost as little, the smallest of those that were looked at */
};

/* Of a voxel that a seed reaches, in a forest without edits under way. ERR_USAGE under
 * ARC_POLARITY, ERR_MEMORY, ERR_CANCELLED by the scene's watch. */
enum err rival_find(struct rival *rival, const struct forest *forest, uint32_t cell,
                    struct fault *fault);

#endif
