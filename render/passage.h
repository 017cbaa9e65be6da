/*
 * The passage: what surfaces of objects a ray comes through, each object by itself.
 *
 * A ray is walked from its first cube on. Voxels are solid for a label where they have it or have a
 * face neighbour that does (render/refine.h). From where the ray comes to such a voxel it is
 * followed to where it comes inside of what has the label: that is a layer, unless the ray has left
 * the same label at most LAYERS_GAP and a half voxels before. Where it does not come inside, it is
 * followed again from where that ended, and else once it has been in a voxel that is not solid for
 * the label. In voxels that are no edge (render/seams.h) nothing begins, and where none is near the
 * ray goes on by several voxels at once.
 */
#ifndef RENDER_PASSAGE_H
#define RENDER_PASSAGE_H

#include "render/layers.h"
#include "render/refine.h"
#include "render/walk.h"

/* What is known of a label along the ray. */
struct run {
    uint32_t last;       /* number of the latest cube that is solid for it, */
    int64_t at;          /* and where the ray comes into that; */
    int64_t until;       /* to this depth the label's surface has been looked for, */
    bool is_found;       /* and it is there; */
    bool has_layer;      /* there is a layer before it, */
    int64_t layer, left; /* here, and the ray leaves it near here */
};

struct passage {
    struct layers *layers;
    struct refiner *refiner;
    struct leap leap;
    uint32_t x, y;
    uint32_t first, cube; /* numbers: of the pixel's first cube, and of this one */
    int64_t opaque;       /* where the ray ends, as far as is known */
    struct run run[256];
};

/* Layers of a pixel, whose first cube is at this depth. A new passage is zeroed but for layers and
 * refiner, which outlive it, and the leap, of SEAMS_NEAR planes. */
void passage_walk(struct passage *passage, uint32_t x, uint32_t y, int64_t from);

#endif
