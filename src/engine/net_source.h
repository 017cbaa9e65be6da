/* SPDX-License-Identifier: MIT */
/*
 * What surface nets are made of: where voxels come from, and the units of the result (net.h).
 */
#ifndef ENGINE_NET_SOURCE_H
#define ENGINE_NET_SOURCE_H

#include <stdbool.h>
#include <stdint.h>

enum {
    NET_BITS = 14, /* of a voxel, in the places of vertices */
    NET_ONE = 1 << NET_BITS,
    NET_NORMAL_BITS = 14, /* 1 of a normal's length, in the world */
    NET_MARGIN = 9,       /* voxels around a box that its net depends on */
    NET_CLOSED = 256,     /* a voxel that is cut away, or outside the scene */
};

struct net_scratch;

/* Where the voxels are. `row` fills `count` voxels from (x, y, z) on, which may lie outside the
 * scene: 0 for air, the label 1..255 for a voxel of the object, or NET_CLOSED. Which label that is
 * counts for nothing where no face of the voxel has air or NET_CLOSED beside it. */
struct net_source {
    void (*row)(void *context, int32_t x, int32_t y, int32_t z, uint32_t count, uint16_t *voxel);
    void *context;
    uint32_t scale[3];           /* least spacing / spacing of each axis, times 2^12: for normals */
    bool is_cubes;               /* vertices stay at the corners of voxels */
    struct net_scratch *scratch; /* of net_scratch_new, of one thread; or NULL */
};

#endif
