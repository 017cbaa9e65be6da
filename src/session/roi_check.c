#include "session/roi_check.h"

#include <stdlib.h>

#include "base/mem.h"

/* Orders pointers to edits by cell, and those of one cell by their place in the list. */
static int compare_edits(const void *a, const void *b)
{
    const struct edit *const *x = a, *const *y = b;
    if ((*x)->cell != (*y)->cell)
        return (*x)->cell < (*y)->cell ? -1 : 1;
    return *x < *y ? -1 : *x > *y;
}

/* Voxels outside where a run would plant a seed. */
static enum err count_waiting(const struct roi *roi, const struct scene *scene,
                              const struct edit *pending, size_t pendings, size_t *waiting,
                              struct fault *fault)
{
    const struct edit **edit = mem_array(pendings, sizeof *edit);
    size_t count = 0;
    if (!edit)
        return fault_memory(fault, "a region of interest");
    for (size_t i = 0; i < pendings; i++)
        if (!roi_holds(roi, scene, pending[i].cell))
            edit[count++] = &pending[i];
    qsort(edit, count, sizeof *edit, compare_edits);
    *waiting = 0;
    for (size_t i = 0; i < count; i++)
        *waiting +=
            edit[i]->label != EDIT_ERASE && (i + 1 == count || edit[i + 1]->cell != edit[i]->cell);
    free(edit);
    return OK;
}

enum err roi_check(const struct roi *roi, const struct scene *scene, const struct edit *pending,
                   size_t pendings, struct fault *fault)
{
    size_t waiting = 0;
    enum err err = count_waiting(roi, scene, pending, pendings, &waiting, fault);
    if (err)
        return err;
    const struct roi_tally tally = roi_tally(roi, scene);
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

void roi_range(struct roi *roi, const struct geometry *geometry, const int64_t thousandths[2])
{
    roi->low = UINT16_MAX;
    roi->high = 0;
    for (int32_t i = 0; i <= UINT16_MAX; i++) {
        const double value = geometry_value(geometry, i);
        if (value < (double)thousandths[0] / 1000 || value > (double)thousandths[1] / 1000)
            continue;
        roi->low = i < roi->low ? (uint16_t)i : roi->low;
        roi->high = (uint16_t)i;
    }
}
