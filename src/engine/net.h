/*
 * Surface nets that keep their volume: the one surface that renditions show, `save surface` writes
 * and statistics measure. Integers only.
 *
 * The centres of eight voxels make a cube. In each cube that has voxels of the object and others,
 * there is one vertex for each *part of air*: the voxels of the cube outside the object that hang
 * together by faces. So two sides of a thin wall never share a vertex. A quad lies between each
 * voxel of the object and each of its six face neighbours outside it, and joins vertices of the
 * four cubes around that face. (Gibson, Constrained elastic surface nets, 1998, has one vertex a
 * cube.)
 *
 * A vertex begins at the mean of the crossings halfway between voxels of its cube. Three passes of
 * a Chebyshev polynomial of the umbrella operator smooth all of them; none may lie further than a
 * quarter of a voxel outside its cube. What volume that has cost, next to each vertex, is pushed
 * outward again, along the normal that faces of voxels have: so small and thin objects keep their
 * size. Normals are those of the quads, smoothed.
 *
 * Where a voxel beside the object is closed (cut away, or outside the scene), vertices stay on the
 * face between the two along that axis: cuts are flat, their rim is a line, every net is closed.
 *
 * Promises
 *   N1 a vertex is a function of the voxels less than NET_MARGIN steps along x, y and z from its
 *      cube, wherever the box begins and ends;
 *   N2 quads are closed: each edge of one has another that runs along it the other way.
 */
#ifndef ENGINE_NET_H
#define ENGINE_NET_H

#include <stdbool.h>
#include <stdint.h>

#include "base/err.h"

enum {
    NET_BITS = 14, /* of a voxel, in the places of vertices */
    NET_ONE = 1 << NET_BITS,
    NET_NORMAL_BITS = 14, /* 1 of a normal's length, in the world */
    NET_MARGIN = 9,       /* voxels around a box that its net depends on */
    NET_CLOSED = 256,     /* a voxel that is cut away, or outside the scene */
};

/* Where the voxels are. `row` fills `count` voxels from (x, y, z) on, which may lie outside the
 * scene: 0 for air, the label 1..255 for a voxel of the object, or NET_CLOSED. */
struct net_scratch;

struct net_source {
    void (*row)(void *context, int32_t x, int32_t y, int32_t z, uint32_t count, uint16_t *voxel);
    void *context;
    uint32_t scale[3];           /* least spacing / spacing of each axis, times 2^12: for normals */
    bool is_cubes;               /* vertices stay at the corners of voxels */
    struct net_scratch *scratch; /* of net_scratch_new, of one thread; or NULL */
};

struct net_vertex {
    int32_t cube[3];   /* the first voxel of its cube */
    int16_t at[3];     /* from the centre of that voxel, in 2^-NET_BITS voxels */
    int16_t normal[3]; /* along voxel axes, outward; 0 where there is none (cuts) */
    uint8_t air;       /* which corners of the cube are its part: bit x + 2 y + 4 z */
};

struct net_quad {
    uint32_t corner[4]; /* numbers of vertices, counter-clockwise seen from outside */
    int32_t voxel[3];
    uint8_t face;   /* 2 * axis + 1 where the neighbour is the next one along the axis */
    uint8_t label;  /* of the voxel */
    bool is_closed; /* the neighbour is */
};

struct net {
    struct net_vertex *vertex; /* by rising cubes, x fastest */
    struct net_quad *quad;     /* by rising voxels, then faces */
    uint32_t vertices, quads;
};

/* The quads of the voxels of a box, and their vertices. ERR_MEMORY: as it was. The caller releases
 * the net. */
enum err net_make(struct net *net, const struct net_source *source, const int32_t first[3],
                  const uint32_t size[3], struct fault *fault);
void net_release(struct net *net);

/* Where a quad is split into triangles, by the places of its corners in 2^-NET_BITS voxels from
 * anywhere: 0 from corner 0 to 2, 1 from corner 1 to 3. With d for that, they are (d, d + 1, d + 2)
 * and (d + 2, d + 3, d), mod 4. It is the shorter diagonal, in voxels along the axes; of two as
 * long, the one from the lowest cube to the highest, so that a face has the same triangles from
 * both of its sides. */
unsigned net_diagonal(int32_t corner[4][3], unsigned face);
/* Memory that is kept from one net_make to the next; NULL: no memory. */
struct net_scratch *net_scratch_new(void);
void net_scratch_free(struct net_scratch *scratch);

#endif
