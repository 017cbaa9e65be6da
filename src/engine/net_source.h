/* SPDX-License-Identifier: MIT */
/*
 * Input of surface nets: the voxels, and the units of the result (net.h).
 */
#ifndef ENGINE_NET_SOURCE_H
#define ENGINE_NET_SOURCE_H

#include <stdbool.h>
#include <stdint.h>

enum {
    NET_BITS = 14, /* fraction bits of a voxel, in positions of vertices */
    NET_ONE = 1 << NET_BITS,
    NET_NORMAL_BITS = 14, /* length 1 of a normal, in the world */
    NET_MARGIN = 9,       /* voxels around a box that its net depends on */
    NET_CLOSED = 256,     /* a voxel that is cut away, or outside the scene */
};

struct net_scratch;

/* Source of the voxels. `row` fills `count` voxels from (x, y, z) on, which may be outside the
 * scene: 0 for air, the label 1..255 for a voxel of the object, or NET_CLOSED. The label of a voxel
 * with no face to air or NET_CLOSED is not used. */
struct net_source {
    void (*row)(void *context, int32_t x, int32_t y, int32_t z, uint32_t count, uint16_t *voxel);
    void *context;
    uint32_t scale[3];           /* least spacing / spacing of each axis, times 2^12: for normals */
    bool is_cubes;               /* vertices stay at the corners of voxels */
    struct net_scratch *scratch; /* from net_scratch_new, for one thread; or NULL */
};

#endif
