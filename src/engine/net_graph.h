/* SPDX-License-Identifier: MIT */
/*
 * The graph of a surface net (net.h): the vertices of a box and of what its net depends on around
 * it, with their links.
 *
 * Vertices are numbered by levels, and within a level by rising cubes. The level of a cube says how
 * long a calculation that ends in the box needs it: each pass reads links of one step, so it goes
 * over the levels up to one less than the pass before, which are the first so many vertices.
 *
 *     level   steps of a cube outside those of the box,    needed for
 *             along one axis, and along all together
 *     0       0, 0                                         the net
 *     1 2 3   1 2 3, 1 2 3                                 passes of volumes and normals
 *     4       4, 4                                         volumes and areas, by quads
 *     5       5, 7                                         places of those quads' corners
 *     6 7 8   6 7 8, 8 9 10                                passes of places
 */
#ifndef ENGINE_NET_GRAPH_H
#define ENGINE_NET_GRAPH_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "engine/net_source.h"

/*
 * Cubes of surface nets: which vertices a cube has, where they begin, and through what they are
 * linked with those of the cubes beside it (net.h).
 *
 * The corner c of a cube is the voxel at x + (c & 1), y + (c >> 1 & 1), z + (c >> 2). A mask of
 * corners has bit c for it.
 */

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

/* All 256 without closed corners, by their air; for any thread, made once. */
const struct net_cube *net_cubes(void);

enum {
    NET_SLOTS = 6,       /* links of a vertex, unless it has more */
    NET_LINKS_MOST = 12, /* a face of a cube has two at most */
    NET_LEVELS = 9,
    NET_TERMS = 5,  /* the level of quads' terms, and one */
    NET_PLACES = 6, /* of places of their vertices, and one */
    NET_STEP = 60,  /* voxels from a word of bits to the next */
};

/* Four numbers at once: those of x, y and z, or others. */
typedef int32_t net_lanes __attribute__((vector_size(16)));

/* Memory of a graph, kept between boxes. */
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

/* `count` items of `size` bytes, their contents undefined; NULL: no memory. */
void *net_store(struct net_scratch *scratch, enum net_store which, size_t count, size_t size);

/* A link beyond NET_SLOTS. */
struct net_more {
    int32_t to, next; /* of the same vertex, or -1 */
};

struct net_place {
    int16_t x, y, z; /* of a cube, from the first of the box with its margin */
    uint8_t lock;    /* net_part.lock */
    uint8_t air;
};

struct net_graph {
    struct net_scratch *scratch;
    int32_t size[3]; /* voxels with the margin */
    int32_t stride;  /* voxels from a row to the next */
    uint16_t *voxel; /* [z][y][x] */
    uint64_t *in;    /* [z][y][word]: bits of voxels of the object; each word begins NET_STEP
                        voxels after the one before, and ends with the first of the next ones */
    uint64_t *closed;
    int32_t words;
    bool has_closed, has_labels; /* some voxel is closed; some labels differ */

    int32_t *first; /* [z][y][x], by stride, of a cube that has vertices: twice the number of the
                       first, and 1 where it is the only one */
    int32_t upto[NET_LEVELS]; /* vertices of this level and those before */
    struct net_place *place;
    net_lanes *at;   /* where they begin, 2^-NET_BITS voxels from the centre of the first */
    net_lanes *push; /* which way faces of voxels look there: net_part.normal */
    int32_t (*link)[NET_SLOTS]; /* itself where there are fewer */
    uint8_t *degree;
    int32_t *head; /* of its chain in `more`, where its degree is over NET_SLOTS */
    struct net_more *more;

    /* Where labels differ: links along the border between two labels, of levels below 4. */
    int32_t (*line)[2];
    uint8_t *lines;    /* of each vertex; 3: three or more */
    net_lanes *border; /* where it runs, at vertices of level 0 with two lines (net_settle.c) */
};

/* Reads the box with its margin; false: no memory. */
bool net_graph_make(struct net_graph *graph, const struct net_source *source,
                    const int32_t first[3], const uint32_t size[3], struct net_scratch *scratch);

static inline size_t net_index(const struct net_graph *g, int32_t x, int32_t y, int32_t z)
{
    return ((size_t)z * (size_t)g->size[1] + (size_t)y) * (size_t)g->stride + (size_t)x;
}

/* How far a voxel, or with `cubes` 1 a cube, is outside the box or its cubes, along an axis. */
static inline int32_t net_outside(const struct net_graph *g, int axis, int32_t at, int32_t cubes)
{
    const int32_t low = NET_MARGIN - cubes, high = g->size[axis] - NET_MARGIN - 1;
    return at < low ? low - at : at > high ? at - high : 0;
}

/* Bits of a word that stand for voxels low to high. */
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

/* Its links times what it has, less what they have. */
static inline net_lanes net_apart(const struct net_graph *g, const net_lanes *x, int32_t v)
{
    const int32_t *link = g->link[v];
    net_lanes apart =
        6 * x[v] - (x[link[0]] + x[link[1]] + x[link[2]]) - (x[link[3]] + x[link[4]] + x[link[5]]);
    for (int32_t k = g->degree[v] > NET_SLOTS ? g->head[v] : -1; k >= 0; k = g->more[k].next)
        apart += x[v] - x[g->more[k].to];
    return apart;
}

/*
 * Where the vertices of a surface net settle, and their normals: the polynomials (net.h).
 */

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

/*
 * Where borders between labels run along a surface net (net.h).
 *
 * The parabola of least squares through a vertex of a border and those before and after it, as
 * many on either side, as they lie before anything is smoothed, says where the border is. It
 * neither moves what is straight nor shrinks what is round, and half of a wave of 12 voxels stays.
 * (Savitzky & Golay, Smoothing and differentiation of data, 1964.) It takes the most vertices, up
 * to eight on either side, between which it turns by some 60 degrees at most, so that patches of
 * few voxels keep their area; what lies between yes and no is weighed, or there are hooks.
 *
 * Off the line, root of the mean square, in voxels: on a flat surface .08, in any direction .24, at
 * slopes of 1 in 8, 12, 20 .05, .12, .21. Patches of one voxel keep their area, those of radius 2,
 * 3, 5, 8 .99, .97, .98, 1.00 of it, squares of 3 to 21 voxels 1.00 to 1.01. Eight vertices see too
 * little of a wave of 20: .8 of it stays.
 */

/* Whether a border of two labels runs through a vertex. Where it ends, or meets others, that is
 * held. */
static inline bool net_line_is_at(const struct net_graph *graph, int32_t v)
{
    return graph->has_labels && graph->lines[v] == 2;
}

#endif
