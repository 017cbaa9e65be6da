/* SPDX-License-Identifier: MIT */
/*
 * Layers: the surfaces that a pixel shows where some objects are translucent.
 *
 * Each translucent object has a surface of its own, and all opaque ones share one (render/mesh.h).
 * A layer is a point where the pixel's ray enters a surface; exits do not count, so an object is as
 * dense as its front. A pixel holds the nearest LAYERS_MOST translucent layers in front of the
 * first opaque one, and that one: an opaque object is seen through any number of surfaces. Layers
 * have keys, as pixels have (render/projection.h), so they depend on the visible objects and the
 * view, but not on the order in which triangles are drawn.
 *
 * Colour. Each layer is shaded like the single surface of an opaque picture, with the normal of its
 * own object. From the nearest on, each adds its share of the remaining light, and shares of
 * squared colours are added, which is close to physical light; when less than a 256th remains, the
 * last layer adds it. Alpha is the light used, and the colour is not multiplied by it.
 *
 * Depth, voxel, label and normal of the pixel are those of the layer with the largest share, the
 * nearest of equals: the best visible one. Behind a pale shell that is the object inside.
 */
#ifndef RENDER_LAYERS_H
#define RENDER_LAYERS_H

#include "render/rendition.h"

enum { LAYERS_MOST = 8 };

struct layer {
    int64_t depth;
    uint32_t cell;
    uint8_t label; /* 0: no such layer */
};

struct layers {
    uint32_t width, height; /* 0 before memory is allocated */
    size_t plane;           /* pixels from a layer to the next */

    /* [height][width]: the first opaque one; DEPTH_NONE, CELL_NONE and 0 if there is no such layer
     * */
    struct layer *last;

    /* [LAYERS_MOST][height][width]: the translucent ones in front of it, from the nearest on; so
     * the memory of layers that no pixel has is never touched */
    struct layer *layer;
    uint8_t *count; /* [height][width] */

    uint8_t *root; /* roots of squares, rounded */
};

/* A new one is zeroed. */
void layers_release(struct layers *layers);
size_t layers_bytes(const struct layers *layers);

/* Call before a rendition of a border's voxels is made: if an object is translucent, attach these
 * layers, which must outlive the rendition; otherwise detach them. ERR_MEMORY. */
enum err layers_attach(struct layers *layers, struct rendition *rendition,
                       const struct border *border, struct fault *fault);

/* ---- layers of a pixel ---- */

void layers_put_none(struct layers *layers, size_t pixel);

/* Return layer `number`, from the nearest, number 0, to the opaque one, the last. */
static inline struct layer layers_at(const struct layers *l, size_t pixel, unsigned number)
{
    return number < l->count[pixel] ? l->layer[number * l->plane + pixel] : l->last[pixel];
}

/* Insert a layer: the opaque one if it is nearer than the present one, or a translucent one unless
 * it exists already. */
void layers_put(struct layers *layers, size_t pixel, struct layer layer, bool is_opaque);

/* ---- shading ---- */

/* Return true if a tile shows nothing. */
bool layers_are_none(const struct layers *layers, struct tile_bounds tile);

/* A tile being blended. */
struct blend {
    const struct border *border;
    struct tile_bounds tile;
    unsigned at, number; /* the next pixel of the tile, and its next layer */
    uint32_t left, most; /* the pixel's remaining light, of 2^16, and the largest share so far */
    struct {             /* each layer taken: */
        unsigned of;     /* its pixel in the tile */
        uint32_t share;  /* its share of the light */
        bool is_seen;    /* the share is larger than those in front of it */
    } taken[TILE * TILE];
    struct {
        uint32_t all, squares[3]; /* sums of shares, and of shares of squared colours */
    } sum[TILE * TILE];
};

void blend_begin(struct blend *blend, const struct rendition *rendition,
                 const struct border *border, struct tile_bounds tile);
/* Collect the next layers to be shaded: pixel by pixel, each from the nearest on. False after the
 * last. */
bool blend_next(struct blend *blend, struct rendition *rendition, struct tile_pixels *pixels);
/* Add the shaded colour of a layer. True if the pixel gets its normal, unless a later layer returns
 * true too. */
bool blend_add(struct blend *blend, unsigned which, const uint8_t rgb[3]);
void blend_end(const struct blend *blend, struct rendition *rendition);

#endif
