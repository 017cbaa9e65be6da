/*
 * A brush: the ball that seeds are painted with, and that labels are opened and closed by.
 */
#ifndef ENGINE_BRUSH_H
#define ENGINE_BRUSH_H

#include <stddef.h>
#include <stdint.h>

#include "base/err.h"

enum { BRUSH_REACH_MOST = 128 }; /* voxels from its middle, along each axis */

/* A ball, as rows of voxels around its middle. */
struct brush {
    int reach[3];
    struct brush_row *row;
    size_t rows;
};
struct brush_row {
    int16_t y, z, half; /* from x - half to x + half */
};

/* The ball (dx unit[0])^2 + (dy unit[1])^2 + (dz unit[2])^2 <= radius^2: in voxels with units of 1,
 * in nanometres with the spacing as units. A radius of 0..10^9. ERR_LIMIT for one that reaches
 * farther than BRUSH_REACH_MOST. */
enum err brush_init(struct brush *brush, const uint32_t unit[3], int64_t radius,
                    struct fault *fault);
void brush_release(struct brush *brush);

#endif
