/* SPDX-License-Identifier: MIT */
/*
 * Cubes of surface nets: which vertices a cube has, where they begin, and through what they are
 * linked with those of the cubes beside it (net.h).
 *
 * The corner c of a cube is the voxel at x + (c & 1), y + (c >> 1 & 1), z + (c >> 2). A mask of
 * corners has bit c for it.
 */
#ifndef ENGINE_NET_PARTS_H
#define ENGINE_NET_PARTS_H

#include <stdbool.h>
#include <stdint.h>

enum {
    NET_CORNERS = 8,
    NET_PARTS = 4, /* of air in a cube, at most */
    NET_NATURAL = 8,
    NET_UNLINKED = UINT8_MAX,
};

/* A part of a cube's air: corners outside the object that hang together by faces. */
struct net_part {
    uint8_t air;        /* its corners */
    uint8_t lock;       /* bit a: a closed voxel lies beside the object along axis a, where the
                           vertex stays; NET_NATURAL: some other air lies beside the object */
    int8_t normal[3];   /* how many faces look along each axis, less those that look against it */
    int16_t start[3];   /* the mean of its crossings, from the middle, 2^-NET_BITS voxels */
    uint8_t link[3][2]; /* corners at the low side of each axis through which it is linked */
};

struct net_cube {
    uint32_t count;
    struct net_part part[NET_PARTS];
};

/* The cube whose corners outside the object are `air`; some of them are closed. */
void net_cube_init(struct net_cube *cube, uint8_t air, uint8_t closed);

/* All 256 without closed corners, by their air; for any thread, made once. */
const struct net_cube *net_cubes(void);

#endif
