/* SPDX-License-Identifier: MIT */
/*
 * The mesh: the surface of what a border shows (engine/net.h), in bricks of 8x8x8 voxels, kept up
 * to date like the border.
 *
 * All opaque objects together have one net, so that none has a wall against another; each
 * translucent one has a net of its own. A brick holds the quads of its own voxels, and their
 * vertices, whichever net they are of: so it is drawn without a look at others.
 *
 * After an edit, mesh_note marks what lies near its changes; after a recount of the border,
 * mesh_update finds what has become another by itself. Quads that are marked are made anew, and
 * nothing else is looked at.
 *
 * Invariants
 *   M1 after mesh_update, bricks are a function of what the border shows, of its labels and
 *      opacities, whatever order edits came in; quads of a brick are in the order of voxel and
 *      face;
 *   M2 along each axis, a vertex lies at most MESH_BEYOND outside the centres of the voxels of its
 *      brick.
 */
#ifndef RENDER_MESH_H
#define RENDER_MESH_H

#include "base/team.h"
#include "engine/net.h"
#include "render/border.h"

enum {
    MESH_SIDE = 1 << BORDER_BLOCK_BITS,  /* voxels a side of a brick */
    MESH_BEYOND = NET_ONE + NET_ONE / 4, /* in 2^-NET_BITS voxels */
    MESH_ROWS = MESH_SIDE * MESH_SIDE,
    MESH_FACES = 8, /* keys of a voxel, of which 6 are in use */
};

struct mesh_vertex {
    int32_t at[3];     /* from the centre of the brick's first voxel, in 2^-NET_BITS voxels */
    int16_t normal[4]; /* engine/net.h; the fourth is 0, so that bytes can be compared */
};

struct mesh_quad {
    uint16_t corner[4]; /* the two triangles are 0 1 2 and 0 2 3 */
    uint16_t key;       /* mesh_key */
    uint8_t label;
    bool is_closed; /* engine/net.h */
};

/* One piece of memory, with its vertices and quads. */
struct mesh_brick {
    uint32_t vertices, quads;
    struct mesh_vertex *vertex;
    struct mesh_quad *quad;
    uint16_t row[MESH_ROWS + 1]; /* the first quad of each row of voxels */
};

/* Voxels from `first` to before `end`; none where these are the same. */
struct mesh_box {
    uint32_t first[3], end[3];
};

enum mesh_kind {
    MESH_SMOOTH,
    MESH_APART = 1, /* each object has a net of its own */
    MESH_CUBES = 2, /* vertices stay at the corners of voxels; or both */
};

struct mesh {
    const struct border *border; /* whose it is as of a version; NULL: of none */
    uint32_t version;
    enum mesh_kind kind;
    uint8_t opacity[256]; /* of the border, then; and whether labels were visible */
    bool visible[256];
    bool is_cut;               /* likewise: whether something was cut away */
    bool is_lost;              /* labels have become others since, in a way that no list says */
    uint32_t size[3], bricks;  /* bricks along each axis, and in all */
    struct mesh_brick **brick; /* [z][y][x]; NULL where nothing is seen */
    uint32_t regions;
    struct mesh_box *stale; /* [z][y][x] of regions of 64x64x64 voxels: quads to be made anew */
    bool is_stale;          /* whether any may be */
    size_t bytes;
    struct net_scratch *scratch[TEAM_MOST]; /* of each thread; NULL where there is none yet */
};

/* A new one is zeroed. */
void mesh_release(struct mesh *mesh);

/* With what each thread keeps from one update to the next, which is no more than so many bytes. */
enum { MESH_SCRATCH_MOST = 16 << 20 };
size_t mesh_bytes(const struct mesh *mesh);

/* After border_update with these changes: each change of its labels is to be told. */
void mesh_note(struct mesh *mesh, const struct border *border, const struct changes *changes);

/* Told of each brick that is replaced, before it is: what was there is `mesh->brick[number]`, what
 * comes is `next`; either may be NULL. */
struct mesh_listener {
    void (*replaces)(void *context, const struct mesh *mesh, uint32_t number,
                     const struct mesh_brick *next);
    void *context;
};

/* Makes it that of the border as it is now. ERR_MEMORY, and what the watch says: it is as it was,
 * or without quads where it was another border's, and stays to be updated. `listener` may be
 * NULL. */
enum err mesh_update(struct mesh *mesh, const struct border *border, enum mesh_kind kind,
                     struct team *team, const struct mesh_listener *listener, struct fault *fault);

/* Whether that would find nothing to do. */
bool mesh_is_current(const struct mesh *mesh, const struct border *border, enum mesh_kind kind);

/* Of a face of a voxel, in its brick: that of x comes before that of y, and z last. */
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

/* The voxel that is the first one of a brick. */
void mesh_first(const struct mesh *mesh, uint32_t number, uint32_t first[3]);

/* The quad of a face of a voxel, and its brick; NULL where there is none. */
const struct mesh_quad *mesh_find(const struct mesh *mesh, const struct mesh_brick **brick,
                                  struct place voxel, unsigned face);

#endif
