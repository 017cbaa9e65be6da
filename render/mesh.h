/* SPDX-License-Identifier: MIT */
/*
 * The mesh: the surface of the voxels that a border shows (engine/net.h), in bricks of 8x8x8
 * voxels, kept up to date like the border.
 *
 * All opaque objects share one net, so there are no walls between them; each translucent one has a
 * net of its own. A brick holds the quads of its own voxels, and their vertices, of all nets, so
 * that it can be drawn without looking at others.
 *
 * After an edit, mesh_note marks the neighbourhood of its changes; after a recount of the border,
 * mesh_update finds the changes itself. Only marked quads are recomputed.
 *
 * Invariants
 *   M1 after mesh_update, bricks are a function of the voxels that the border shows, their labels
 *      and opacities, whatever the order of edits; quads of a brick are sorted by voxel and face;
 *   M2 along each axis, a vertex is at most MESH_BEYOND outside the centres of the voxels of its
 *      brick.
 */
#ifndef RENDER_MESH_H
#define RENDER_MESH_H

#include "base/team.h"
#include "engine/net.h"
#include "render/border.h"

enum {
    MESH_SIDE = 1 << BORDER_BLOCK_BITS,  /* side of a brick, in voxels */
    MESH_BEYOND = NET_ONE + NET_ONE / 4, /* in 2^-NET_BITS voxels */
    MESH_ROWS = MESH_SIDE * MESH_SIDE,
    MESH_FACES = 8, /* keys of a voxel, 6 of them used */
};

struct mesh_vertex {
    int32_t at[3];     /* from the centre of the brick's first voxel, in 2^-NET_BITS voxels */
    int16_t normal[4]; /* engine/net.h; the fourth is 0, so that memcmp works */
};

struct mesh_quad {
    uint16_t corner[4]; /* the two triangles are 0 1 2 and 0 2 3 */
    uint16_t key;       /* mesh_key */
    uint8_t label;
    bool is_closed; /* engine/net.h */
};

/* One allocation, with its vertices and quads. */
struct mesh_brick {
    uint32_t vertices, quads;
    struct mesh_vertex *vertex;
    struct mesh_quad *quad;
    uint16_t row[MESH_ROWS + 1]; /* the first quad of each row of voxels */
};

/* Voxels from `first` to before `end`; empty if they are equal. */
struct mesh_box {
    uint32_t first[3], end[3];
};

enum mesh_kind {
    MESH_SMOOTH,
    MESH_APART = 1, /* each object has a net of its own */
    MESH_CUBES = 2, /* vertices stay at the corners of voxels; or both */
};

struct mesh {
    const struct border *border; /* the border it was computed from, at `version`; NULL: not
                                    computed */
    uint32_t version;
    enum mesh_kind kind;
    uint8_t opacity[256]; /* copies of the border's opacities and visible labels at that version */
    bool visible[256];
    bool is_cut;               /* likewise: something was cut away */
    bool is_lost;              /* labels have changed since without a list of changes */
    uint32_t size[3], bricks;  /* bricks along each axis, and in all */
    struct mesh_brick **brick; /* [z][y][x]; NULL for empty bricks */
    uint32_t regions;
    struct mesh_box *stale; /* [z][y][x] of regions of 64x64x64 voxels: quads to be recomputed */
    bool is_stale;          /* some box of `stale` may be non-empty */
    size_t bytes;
    struct net_scratch *scratch[TEAM_MOST]; /* for each thread; NULL if not made yet */
};

/* A new one is zeroed. */
void mesh_release(struct mesh *mesh);

/* Bytes of the mesh, including each thread's scratch memory, which is at most MESH_SCRATCH_MOST. */
enum { MESH_SCRATCH_MOST = 16 << 20 };
size_t mesh_bytes(const struct mesh *mesh);

/* Call after each border_update, with the same changes. */
void mesh_note(struct mesh *mesh, const struct border *border, const struct changes *changes);

/* Called for each brick before it is replaced: the old one is `mesh->brick[number]`, the new one is
 * `next`; either may be NULL. */
struct mesh_listener {
    void (*replaces)(void *context, const struct mesh *mesh, uint32_t number,
                     const struct mesh_brick *next);
    void *context;
};

/* Bring the mesh up to date with the border. ERR_MEMORY, or the watch's error: the mesh is
 * unchanged, or without quads if it was another border's, and remains out of date. `listener` may
 * be NULL. */
enum err mesh_update(struct mesh *mesh, const struct border *border, enum mesh_kind kind,
                     struct team *team, const struct mesh_listener *listener, struct fault *fault);

/* Return true if mesh_update has nothing to do. */
bool mesh_is_current(const struct mesh *mesh, const struct border *border, enum mesh_kind kind);

/* The key of a face of a voxel in its brick: x varies fastest, z slowest. */
static inline unsigned mesh_key(struct place voxel, unsigned face)
{
    enum { LAST = MESH_SIDE - 1 };
    const uint32_t row = (voxel.z & LAST) * MESH_SIDE + (voxel.y & LAST);
    return (row * MESH_SIDE + (voxel.x & LAST)) * MESH_FACES + face;
}
/* The voxel of a key, in the brick that begins at `first`. */
static inline struct place mesh_voxel(const uint32_t first[3], unsigned key)
{
    const unsigned at = key / MESH_FACES;
    return (struct place){first[0] + at % MESH_SIDE, first[1] + at / MESH_SIDE % MESH_SIDE,
                          first[2] + at / MESH_ROWS};
}

/* Return the first voxel of a brick. */
void mesh_first(const struct mesh *mesh, uint32_t number, uint32_t first[3]);

/* Return the quad of a face of a voxel, and its brick; NULL if it has none. */
const struct mesh_quad *mesh_find(const struct mesh *mesh, const struct mesh_brick **brick,
                                  struct place voxel, unsigned face);

#endif
