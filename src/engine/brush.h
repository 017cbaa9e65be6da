/* SPDX-License-Identifier: MIT */
/*
 * A brush: the ball that seeds are painted with, and that labels are opened and closed by.
 */
#ifndef ENGINE_BRUSH_H
#define ENGINE_BRUSH_H

#include <stddef.h>
#include <stdint.h>

#include "base/err.h"

/* Voxels from its middle along each axis: of a full ball, and of one that will be hollow. */
enum { BRUSH_REACH_MOST = 128, BRUSH_HOLLOW_REACH_MOST = 512 };

/* A ball, as rows of voxels around its middle; a hollow one is its shell. */
struct brush {
    int reach[3];
    struct brush_row *row;
    size_t rows;
};
struct brush_row {
    int16_t y, z, half; /* from x - half to x + half, */
    int16_t hole;       /* but for x - hole to x + hole; -1 for no hole */
};

/* The ball (dx unit[0])^2 + (dy unit[1])^2 + (dz unit[2])^2 <= radius^2: in voxels with units of 1,
 * in nanometres with the spacing as units. A radius of 0..10^9. ERR_LIMIT for one that reaches
 * more voxels than `most`. */
enum err brush_init(struct brush *brush, const uint32_t unit[3], int64_t radius, int most,
                    struct fault *fault);

/* Keeps the voxels that have one of so many neighbours, 6 or 26, outside the ball. No way between
 * such neighbours leads from the hole out of the ball but through what is kept. ERR_MEMORY leaves
 * the ball full. */
enum err brush_hollow(struct brush *brush, unsigned neighbours, struct fault *fault);
void brush_release(struct brush *brush);

#endif
