/* SPDX-License-Identifier: MIT */
/*
 * A hand that draws around a piece of a slice, as a user does with pen or mouse.
 *
 * The outline goes through the centres of the piece's outermost voxels, once around. The hand is
 * off it by a smooth random way: nearly normal along each axis, with a standard deviation of so
 * many tenths of a voxel at every place, anew every HAND_TREMOR voxels and weighed between these.
 * What is drawn goes from voxel to voxel, within the slice, and is simplified as the pilot does it
 * (base/polyline.h): to a polygon that stays within half a voxel.
 *
 * What that costs is said in two ways: the length of the polygon in voxels, for who drags; and for
 * who clicks, the corners of one that stays within one voxel and a half of what is drawn.
 *
 * Plain IEEE arithmetic and no library but sqrt, so the same on every machine.
 */
#ifndef TESTS_BENCH_EFFORT_HAND_H
#define TESTS_BENCH_EFFORT_HAND_H

#include <stddef.h>
#include <stdint.h>

#include "base/err.h"
#include "base/polyline.h"

enum { HAND_TREMOR = 8 };

/* A slice, or a piece of one: what is 0 is not of it. */
struct hand_slice {
    uint32_t size[2];
    uint8_t *voxel; /* [y][x] */
};

struct hand_place {
    double at[2];
};

/* {0} is of nothing. */
struct hand_outline {
    struct polyline line; /* x, y, 0; of a piece of one voxel one corner, of a thin one maybe two */
    double path;
    unsigned clicks;
    struct hand_place *place; /* what it is made of: as it is drawn */
    size_t count, capacity;
};
void hand_outline_release(struct hand_outline *outline);

/* Of a piece that hangs together, in place of the former outline; *random goes on. ERR_MEMORY. */
enum err hand_draw(struct hand_outline *outline, const struct hand_slice *piece, unsigned tenths,
                   uint64_t *random, struct fault *fault);

/* The next number of a stream. */
uint64_t hand_random(uint64_t *random);

#endif
