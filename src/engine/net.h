/* SPDX-License-Identifier: MIT */
/*
 * Surface nets that keep their volume: the surface that renditions show, `save surface` writes and
 * statistics measure. Integers only; rotating or mirroring the labels rotates or mirrors the net,
 * bit for bit.
 *
 * 1. The centres of eight voxels make a cube. In each cube that has voxels of the object and
 *    others, there is one vertex for each *part of air*: the voxels of the cube outside the
 *    object that are connected by faces. So two sides of a thin wall never share a vertex. A quad
 *    separates each voxel of the object from each of its six face neighbours outside it, and
 *    joins vertices of the four cubes around that face. (Gibson, Constrained elastic surface
 *    nets, 1998, has one vertex a cube.) Its edges are the links; u is the umbrella operator, a
 *    vertex minus the mean of its linked vertices. A vertex begins at the mean of the crossings
 *    halfway between voxels of its cube.
 * 2. Positions: 1 - u (1092 - 960 u + 256 u^2) / 365, Chebyshev's polynomial of three passes, the
 *    least from 1/2 to 2; then clamped to a quarter of a voxel outside the vertex's cube.
 * 3. Volume: the volume lost next to each vertex is restored by pushing it outward, along the
 *    normal of the faces of voxels, so small and thin objects keep their size. LOST is the flux of
 *    the quads' area from the position to the middle of the cube, where the net is that of voxels
 *    as cubes, by Simpson's rule; a push by h adds BY_PUSH h + BY_SQUARE h^2 + BY_CUBE h^3. A
 *    quarter of each quad is added to each corner, divided by links: so u keeps their sum (without
 *    that, 1 to 8 % of volume are lost). All four are filtered by the polynomial of four passes,
 *    1 - u (283360 - 516000 u + 352000 u^2 - 80000 u^3) / 45281, the least from 1/5 to 2; then h is
 *    solved for, and positions are clamped again.
 * 4. Borders between labels: vertices on a border slide along the surface to the place that
 *    net_settle.c finds. Junctions of three labels are fixed.
 * 5. Normals are those of the quads after step 2, weighted by area, filtered by Chebyshev's
 *    polynomial of four passes, the least from 3/4 to 2. Below 3/4 normals of single voxels turn
 *    over. Where the surface is nearly flat, the last pass is stronger, down to 1/4: steps of
 *    voxels ripple there, and nothing turns over.
 *
 * Next to a closed voxel (cut away, or outside the scene), vertices stay on the face between it and
 * the object along that axis: cuts are flat, their rim is a line, every net is closed.
 *
 * Reach: 3 cubes of step 2, 1 for quads, 4 of steps 3 to 5, and the cube itself: 9 voxels.
 *
 * `make bench-surface`: balls and rods keep their radius, .80 .802, 1.10 1.082, 1.50 1.496, 2.37
 * 2.374, 3.19 3.204, 5.09 5.096, 10 10.004; rods 1 1.004, 1.47 1.479, 2.49 2.496, 4 4.006; volume
 * over voxels at worst +2.6 % below radius 2, +1.0 % from 3, +.4 % from 5. Planes ripple by .080
 * voxels; 95 % of the normals of planes and sheets of 1, 2, 3 voxels are within 2.8 degrees, of a
 * ball of 10 within 2.8; without step 5's last sentence 3.5 and 3.1. Attributing flux to corners
 * exactly was no better.
 *
 * Promises
 *   N1 a vertex is a function of the voxels within NET_MARGIN steps along x, y and z of the voxels
 *      of its box, independent of the box;
 *   N2 quads are closed: each edge of a quad is also an edge of another, in the opposite direction.
 */
#ifndef ENGINE_NET_H
#define ENGINE_NET_H

#include <stdbool.h>
#include <stdint.h>

#include "base/err.h"
#include "engine/net_source.h"

struct net_vertex {
    int32_t cube[3];   /* the first voxel of its cube */
    int16_t at[3];     /* relative to the centre of that voxel, in 2^-NET_BITS voxels */
    int16_t normal[3]; /* along voxel axes, outward; 0 for no normal (cuts) */
    uint8_t air;       /* corners of the cube in its part of air: bit x + 2 y + 4 z */
};

struct net_quad {
    uint32_t corner[4]; /* indices of vertices, counter-clockwise seen from outside */
    int32_t voxel[3];
    uint8_t face;   /* 2 * axis + 1 if the neighbour is the next one along the axis */
    uint8_t label;  /* label of the voxel */
    bool is_closed; /* the neighbour is closed */
};

struct net {
    struct net_vertex *vertex; /* sorted by cube, x fastest */
    struct net_quad *quad;     /* sorted by voxel, then face */
    uint32_t vertices, quads;
};

/* Compute the quads of the voxels of a box, and their vertices. On ERR_MEMORY *net is unchanged.
 * The caller releases the net. */
enum err net_make(struct net *net, const struct net_source *source, const int32_t first[3],
                  const uint32_t size[3], struct fault *fault);
void net_release(struct net *net);

/* Choose the diagonal that splits a quad into triangles, from the positions of its corners in
 * 2^-NET_BITS voxels from any origin: 0 from corner 0 to 2, 1 from corner 1 to 3. With d for the
 * result, the triangles are (d, d + 1, d + 2) and (d + 2, d + 3, d), mod 4. It is the shorter
 * diagonal in voxel units; on a tie the one from the lowest cube to the highest, so that a face has
 * the same triangles from both sides. */
unsigned net_diagonal(int32_t corner[4][3], unsigned face);

/* Memory that is reused by calls of net_make; NULL without memory. */
struct net_scratch *net_scratch_new(void);
void net_scratch_free(struct net_scratch *scratch);
size_t net_scratch_bytes(const struct net_scratch *scratch); /* 0 for NULL */

#endif
