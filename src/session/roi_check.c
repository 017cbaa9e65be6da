#include "session/roi_check.h"

#include <stdlib.h>

#include "base/mem.h"
#include "base/sort.h"

/* Voxels outside where a run would plant a seed: the last edit of each decides. */
static enum err count_waiting(const struct roi *roi, const struct scene *scene,
                              const struct edit *pending, size_t pendings, size_t *waiting,
                              struct fault *fault)
{
    uint64_t *rank = mem_array(pendings, sizeof *rank); /* cell and place among the edits */
    size_t count = 0;
    if (!rank)
        return fault_memory(fault, "a region of interest");
    for (size_t i = 0; i < pendings; i++)
        if (!roi_holds(roi, scene, pending[i].cell))
            rank[count++] = (uint64_t)pending[i].cell << 32 | i;
    const enum err err = sort_by_upper_half(rank, count, scene->watch, fault);
    *waiting = 0;
    for (size_t i = 0; !err && i < count; i++)
        *waiting += pending[(uint32_t)rank[i]].label != EDIT_ERASE &&
                    (i + 1 == count || rank[i + 1] >> 32 != rank[i] >> 32);
    free(rank);
    return err;
}

enum err roi_check(const struct roi *roi, const struct scene *scene, const struct edit *pending,
                   size_t pendings, struct fault *fault)
{
    size_t waiting = 0;
    enum err err = count_waiting(roi, scene, pending, pendings, &waiting, fault);
    if (err)
        return err;
    const struct roi_tally tally = roi_tally(roi, scene);
    err = watch_fault(scene->watch, fault);
    if (err)
        return err;
    if (!tally.inside)
        return fault_set(fault, ERR_INPUT,
                         "no voxel of the scene would be inside; nothing has changed");
    if (tally.seeds_outside || waiting)
        return fault_set(fault, ERR_INPUT,
                         "%zu planted and %zu waiting seeds would be outside; remove them and run "
                         "first; nothing has changed",
                         tally.seeds_outside, waiting);
    return OK;
}

struct interval roi_range(struct roi *roi, const struct geometry *geometry,
                          const struct levels *levels, const struct decimal range[2])
{
    const struct interval interval = levels_within(geometry, levels, range);
    roi->low = interval.low;
    roi->high = interval.high;
    return interval;
}
