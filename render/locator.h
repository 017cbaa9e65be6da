/*
 * The locator: where along one axis of the scene the point lies that a pixel shows at a depth.
 *
 * (depth - crossing of plane 0) / T, as a product. T is taken to 20 bits first, so the point is off
 * by some 2^-20 of its distance: less than its own last bit.
 */
#ifndef RENDER_LOCATOR_H
#define RENDER_LOCATOR_H

#include "render/view.h"

enum {
    LOCATOR_POINT_BITS = 8, /* of a voxel */
    LOCATOR_BITS = 20,
    LOCATOR_INVERSE_BITS = 44,
};

struct locator {
    int64_t C, A, B;
    unsigned shift;
    int64_t inverse; /* 2^44 / (T >> shift) */
    int32_t most;    /* the far side of the scene */
    bool flip;
};

static inline struct locator locator_of(const struct camera *camera, int a)
{
    struct locator l = {camera->C[a], camera->A[a], camera->B[a], 0, 0, 0, camera->flip[a]};
    while (camera->T[a] >> l.shift >> (LOCATOR_BITS + 1))
        l.shift++;
    l.inverse = (INT64_C(1) << LOCATOR_INVERSE_BITS) / (camera->T[a] >> l.shift);
    l.most = (int32_t)(camera->scene->grid.size[a] << LOCATOR_POINT_BITS);
    return l;
}

/* In 1/256 voxels from the centre of voxel 0, along the scene's axis; on or in the scene. */
static inline int32_t locator_point(const struct locator *l, int64_t depth, uint32_t x, uint32_t y)
{
    const int64_t beyond = depth - (l->C + x * l->A + y * l->B);
    const int64_t flipped =
        (beyond >> l->shift) * l->inverse >> (LOCATOR_INVERSE_BITS - LOCATOR_POINT_BITS);
    const int32_t at = flipped < 0 ? 0 : flipped > l->most ? l->most : (int32_t)flipped;
    return (l->flip ? l->most - at : at) - (1 << (LOCATOR_POINT_BITS - 1));
}

#endif
