/*
 * What can be counted of each label: voxels, where they lie, their intensities, and how they hang
 * together. Of labels of any kind (engine/labels.h), by a thread team; counted when asked for.
 *
 * A change of some voxels changes components, holes and medians in ways that no list of changes
 * says, and the rest takes less than half the time of these: so it is counted with them, and an
 * edit does nothing for it (session/tally.h has the voxels alone, of which pilot and prompt say
 * more after each edit). All are integers, and the same for any number of threads.
 */
#ifndef ENGINE_LABEL_STATS_H
#define ENGINE_LABEL_STATS_H

#include "base/team.h"
#include "engine/labels.h"

struct label_stats {
    uint64_t voxels; /* where there are none, the rest is of no meaning */
    uint64_t sum[3]; /* of positions along x, y, z */
    uint32_t first[3], last[3];
    uint64_t intensity, intensity_squares; /* sums */
    uint16_t least, most;
    uint16_t middle[2];  /* the two intensities in the middle, which are one of an odd number */
    uint64_t cosines[3]; /* engine/label_surface.h */
    uint32_t components; /* pieces that hang together by faces; of label 0 too */
    uint32_t holes;      /* what is enclosed: components of voxels of other labels, all as one, with
                             no voxel at the edge of the scene; 0 of label 0 */
};

/* Of each label. ERR_MEMORY, or ERR_CANCELLED by the scene's watch. */
enum err label_stats_find(struct label_stats stats[256], const struct labels *labels,
                          struct team *team, struct fault *fault);

#endif
