/* SPDX-License-Identifier: MIT */
/*
 * The graph of a surface net (net.h): the vertices of a box and of its surroundings that its net
 * depends on, with their links.
 *
 * Vertices are numbered by level, and within a level by cube. The level of a cube says how long a
 * calculation that ends in the box needs it: each pass reads links of one step, so it processes one
 * level less than the pass before; its vertices are the first ones, up to a number.
 *
 *     level   steps of a cube outside those of the box,    needed for
 *             along one axis, and along all together
 *     0       0, 0                                         the net
 *     1 2 3   1 2 3, 1 2 3                                 passes of volumes and normals
 *     4       4, 4                                         volumes and areas, by quads
 *     5       5, 7                                         positions of those quads' corners
 *     6 7 8   6 7 8, 8 9 10                                passes of positions
 */
#ifndef ENGINE_NET_GRAPH_H
#define ENGINE_NET_GRAPH_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "engine/net_source.h"

/*
 * Cubes of surface nets: the vertices of a cube, their initial positions, and the corners through
 * which they are linked with vertices of adjacent cubes (net.h).
 *
 * The corner c of a cube is the voxel at x + (c & 1), y + (c >> 1 & 1), z + (c >> 2). A mask of
 * corners has bit c for it.
 */

enum {
    NET_CORNERS = 8,
    NET_PARTS = 4,   /* parts of air in a cube, at most */
    NET_NATURAL = 8, /* air that is not closed is next to the object */
    NET_UNLINKED = UINT8_MAX,
};

/* A part of a cube's air: corners outside the object that are connected by faces. */
struct net_part {
    uint8_t air;        /* its corners */
    uint8_t lock;       /* bit a: closed air along axis a, where the vertex is fixed; NET_NATURAL */
    int8_t normal[3];   /* faces along each axis minus those against it */
    int16_t start[3];   /* mean of its crossings, from the middle, 2^-NET_BITS voxels */
    uint8_t link[3][2]; /* corners at the low side of each axis through which it is linked */
};

struct net_cube {
    uint32_t count;
    struct net_part part[NET_PARTS];
};

/* All 256 cubes without closed corners, by their air; computed once, for any thread. */
const struct net_cube *net_cubes(void);

enum {
    NET_SLOTS = 6,       /* links of a vertex in the first table */
    NET_LINKS_MOST = 12, /* a face of a cube has two at most */
    NET_LEVELS = 9,
    NET_TERMS = 5, /* level of quads' terms, plus 1 */
    NET_STEP = 60, /* voxels from a word of bits to the next */
};

/* Vector of x, y and z, or other numbers. */
typedef int32_t net_lanes __attribute__((vector_size(16)));

/* Memory of a graph, reused between boxes. */
enum net_store {
    NET_VOXEL,
    NET_BITS_IN,
    NET_BITS_CLOSED,
    NET_FIRST,
    NET_CELL,
    NET_PLACE,
    NET_LINK,
    NET_DEGREE,
    NET_HEAD,
    NET_MORE,
    NET_LINE,
    NET_LINES,
    NET_BORDER,
    NET_AT,
    NET_LANES_0,
    NET_LANES_1,
    NET_PUSH,
    NET_SUM,
    NET_BOTH_0,
    NET_BOTH_1,
    NET_BOTH_2,
    NET_BOTH_3,
    NET_USED,
    NET_STORES,
};

struct net_scratch {
    struct {
        void *items;
        size_t bytes;
    } store[NET_STORES];
};

/* Reserve `count` items of `size` bytes, their contents undefined; NULL without memory. */
void *net_store(struct net_scratch *scratch, enum net_store which, size_t count, size_t size);

/* A link beyond NET_SLOTS. */
struct net_more {
    int32_t to, next; /* next link of the same vertex, or -1 */
};

struct net_place {
    int16_t x, y, z; /* position of a cube in the box with its margin */
    uint8_t lock;    /* net_part.lock */
    uint8_t air;
};

struct net_graph {
    struct net_scratch *scratch;
    int32_t size[3]; /* voxels with the margin */
    int32_t stride;  /* voxels from a row to the next */
    uint16_t *voxel; /* [z][y][x] */
    /* [z][y][word]: bits of voxels of the object. Each word begins NET_STEP voxels after the one
     * before and includes the first voxels of the next. */
    uint64_t *in;
    uint64_t *closed;
    int32_t words;
    bool has_closed, has_labels; /* some voxel is closed; some labels differ */

    /* [z][y][x], by stride, of a cube with vertices: twice the number of the first, plus 1 if it is
     * the only one. */
    int32_t *first;
    int32_t upto[NET_LEVELS]; /* vertices of this level and those before */
    struct net_place *place;
    net_lanes *at;              /* positions, 2^-NET_BITS voxels from the centre of the first */
    net_lanes *push;            /* direction of faces of voxels there: net_part.normal */
    int32_t (*link)[NET_SLOTS]; /* unused entries link to the vertex itself */
    uint8_t *degree;
    int32_t *head; /* first of its links in `more`, if its degree is over NET_SLOTS */
    struct net_more *more;

    /* If labels differ: links along the border between two labels, of levels below 4. */
    int32_t (*line)[2];
    uint8_t *lines; /* number of lines at each vertex; 3: three or more */
    net_lanes
        *border; /* position of the border, at vertices of level 0 with two lines (net_settle.c) */
};

/* Read the box with its margin. False without memory, or for a side of more than 32749 voxels. */
bool net_graph_make(struct net_graph *graph, const struct net_source *source,
                    const int32_t first[3], const uint32_t size[3], struct net_scratch *scratch);

static inline size_t net_index(const struct net_graph *g, int32_t x, int32_t y, int32_t z)
{
    return ((size_t)z * (size_t)g->size[1] + (size_t)y) * (size_t)g->stride + (size_t)x;
}

/* Distance of a voxel, or (`cubes` 1) of a cube, from the box or its cubes, along an axis. */
static inline int32_t net_outside(const struct net_graph *g, int axis, int32_t at, int32_t cubes)
{
    const int32_t low = NET_MARGIN - cubes, high = g->size[axis] - NET_MARGIN - 1;
    return at < low ? low - at : at > high ? at - high : 0;
}

/* Bits of a word for voxels low to high. */
static inline uint64_t net_bits(int32_t word, int32_t low, int32_t high)
{
    low = low > word * NET_STEP ? low - word * NET_STEP : 0;
    high = high < (word + 1) * NET_STEP ? high - word * NET_STEP : NET_STEP - 1;
    return high < low ? 0 : UINT64_MAX >> (63 - high) & UINT64_MAX << low;
}

/* The vertex of a cube whose part has this corner. */
static inline int32_t net_vertex_at(const struct net_graph *g, size_t cube, int corner)
{
    const int32_t first = g->first[cube];
    int32_t v = first >> 1;
    while (!(first & 1) && !(g->place[v].air >> corner & 1))
        v++;
    return v;
}

/*
 * Final positions of the vertices of a surface net, and their normals: the polynomials (net.h).
 */

enum { NET_LOST, NET_BY_PUSH, NET_BY_SQUARE, NET_BY_CUBE, NET_KINDS };

/* Sums over the quads around a vertex. */
struct net_sum {
    int64_t area[4];         /* along x, y and z, 2^(-2 NET_BITS) voxels, doubled */
    int64_t term[NET_KINDS]; /* 2^(-3 NET_BITS) voxels; 48, 8, 16 and 24 times as large */
};

/* Smooth the positions of levels 0 to 5, and find the direction in which each is pushed. *sum is
 * set to 0, for these vertices; it belongs to the scratch memory, as does *normal below. False
 * without memory. */
bool net_smooth(struct net_graph *graph, struct net_sum **sum);

/* Add a quad of natural air to the sums of its corners; `face` is net_quad.face. */
void net_add_quad(const struct net_graph *graph, struct net_sum *sum, const int32_t corner[4],
                  int face);

/* Compute normals and final positions of level 0 from the sums. */
bool net_restore(struct net_graph *graph, const struct net_sum *sum, const uint32_t scale[3],
                 net_lanes **normal);

/* For cubes: set all vertices to the middle, and compute normals of level 0. */
bool net_centre(struct net_graph *graph, const uint32_t scale[3], net_lanes **normal);

#endif
