/* SPDX-License-Identifier: MIT */
/*
 * Where the vertices of a surface net settle, and their normals: the polynomials (net.h).
 */
#ifndef ENGINE_NET_SETTLE_H
#define ENGINE_NET_SETTLE_H

#include "engine/net_graph.h"

enum { NET_LOST, NET_BY_PUSH, NET_BY_SQUARE, NET_BY_CUBE, NET_KINDS };

/* What the quads around a vertex come to. */
struct net_sum {
    int64_t area[4];         /* along x, y and z, 2^(-2 NET_BITS) voxels, twice as large */
    int64_t term[NET_KINDS]; /* 2^(-3 NET_BITS) voxels; 48, 8, 16 and 24 times as large */
};

/* Smooths the places of levels below NET_PLACES, and finds which way each is pushed. Sums are 0. */
bool net_smooth(struct net_graph *graph, struct net_sum **sum);

/* Adds a quad of natural air to the sums of its corners; `face` is net_quad.face. */
void net_add_quad(const struct net_graph *graph, struct net_sum *sum, const int32_t corner[4],
                  int face);

/* From the sums: normals and final places of level 0. */
bool net_restore(struct net_graph *graph, const struct net_sum *sum, const uint32_t scale[3],
                 net_lanes **normal);

/* For cubes: all vertices in the middle, and normals of level 0. */
bool net_centre(struct net_graph *graph, const uint32_t scale[3], net_lanes **normal);

#endif
