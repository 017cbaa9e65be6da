#include "engine/contour.h"

#include <stddef.h>

/* Of lines that `stride` voxels side by side begin, those voxels that are in the set with both
 * neighbours along the line. */
static void erode_lines(uint8_t *out, const uint8_t *in, size_t length, size_t stride,
                        const bool ends[2], struct task *task)
{
    for (size_t i = 0; i < length && task_advance(task, stride); i++) {
        const uint8_t *at = in + i * stride;
        const uint8_t first = i > 0 || ends[0] ? 255 : 0,
                      last = i + 1 < length || ends[1] ? 255 : 0;
        const uint8_t *before = i > 0 ? at - stride : at,
                      *after = i + 1 < length ? at + stride : at;
        for (size_t k = 0; k < stride; k++)
            out[i * stride + k] = at[k] & before[k] & after[k] & first & last;
    }
}

static void erode_along(uint8_t *out, const uint8_t *in, const struct contour_box *box, int axis,
                        struct watch *watch)
{
    size_t stride = 1, voxels = 1;
    for (int a = 0; a < 3; a++) {
        stride *= a < axis ? box->size[a] : 1;
        voxels *= box->size[a];
    }
    const size_t sheet = stride * box->size[axis];
    struct task task = task_begin(watch, "contours", voxels);
    for (size_t i = 0; i < voxels; i += sheet)
        erode_lines(out + i, in + i, box->size[axis], stride, box->ends[axis], &task);
}

/* A voxel whose 26 neighbours are all in the set is left by an erosion along each axis in turn. */
void contour_find(uint8_t *contour, const uint8_t *set, uint8_t *room,
                  const struct contour_box *box, struct watch *watch)
{
    const size_t voxels = (size_t)box->size[0] * box->size[1] * box->size[2];
    erode_along(contour, set, box, 0, watch);
    erode_along(room, contour, box, 1, watch);
    erode_along(contour, room, box, 2, watch);
    for (size_t i = 0; i < voxels; i++)
        contour[i] = set[i] & (uint8_t)~contour[i];
}
