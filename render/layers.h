/* SPDX-License-Identifier: MIT */
/*
 * Layers: what each pixel shows where some of the objects are translucent.
 *
 * Each translucent object has a surface of its own, and all opaque ones have one together
 * (render/mesh.h). Where the ray of a pixel comes into one of them is a layer of the pixel; where
 * it leaves one is none, so an object is as dense as its front. A pixel holds its nearest
 * LAYERS_MOST translucent layers that lie before the first opaque one, and that one: however many
 * surfaces are before it, an opaque object is seen. Layers have keys, as pixels have
 * (render/projection.h), so they are a function of what is shown and of the view, in whatever order
 * triangles are drawn.
 *
 * Colour. Each layer is shaded as the one surface of an opaque picture would be, with the normal
 * that the object has by itself. From the nearest on it takes its share of the light that is left;
 * shares of squared colours add up, which is near to what light does, until less than a 256th is
 * left, which goes to the last. What is left at the end is alpha, and the colour is that of what
 * was added alone: it is not multiplied by alpha.
 *
 * Depth, voxel, label and normal of the pixel are those of the layer that has the largest share,
 * the nearest of several: what is seen best there. Behind a pale shell that is what is in it.
 */
#ifndef RENDER_LAYERS_H
#define RENDER_LAYERS_H

#include "render/rendition.h"

enum { LAYERS_MOST = 8 };

struct layer {
    int64_t depth;
    uint32_t cell;
    uint8_t label; /* 0: the pixel has no layer of that number */
};

struct layers {
    uint32_t width, height; /* 0 where there is no memory yet */
    size_t plane;           /* pixels from a layer to the next */

    /* [height][width]: the first opaque one; DEPTH_NONE, CELL_NONE and 0 where there is none */
    struct layer *last;

    /* [LAYERS_MOST][height][width]: the nearest translucent ones before that, from the nearest on;
     * so memory of layers that no pixel has is never touched */
    struct layer *layer;
    uint8_t *count; /* [height][width] */

    uint8_t *root; /* of squares, to the nearest */
};

/* A new one is zeroed. */
void layers_release(struct layers *layers);
size_t layers_bytes(const struct layers *layers);

/* To be called before a rendition is made of what a border shows: where an object is translucent,
 * the rendition takes these layers, which are its own from now on and outlive it; else it has none.
 * ERR_MEMORY. */
enum err layers_take(struct layers *layers, struct rendition *rendition,
                     const struct border *border, struct fault *fault);

/* Those of the rows of the rendition from one on, to be drawn into; borrows the maps. */
struct layers layers_rows(const struct layers *layers, uint32_t top);

/* ---- layers of a pixel ---- */

void layers_put_none(struct layers *layers, size_t pixel);

/* From the nearest on, number 0, to the opaque one, which is the last. */
static inline struct layer layers_at(const struct layers *l, size_t pixel, unsigned number)
{
    return number < l->count[pixel] ? l->layer[number * l->plane + pixel] : l->last[pixel];
}

/* One more: the opaque one, if it is nearer than that so far, or one of the others, unless it is
 * there already. */
void layers_put(struct layers *layers, size_t pixel, struct layer layer, bool is_opaque);

/* ---- shading ---- */

/* Whether a tile shows nothing. */
bool layers_are_none(const struct layers *layers, struct tile_bounds tile);

/* A tile in the making. */
struct blend {
    const struct border *border;
    struct tile_bounds tile;
    unsigned at, number; /* the next pixel of the tile, and the next layer of it; */
    uint32_t left, most; /* of its light, of 2^16, and the largest share so far */
    struct {             /* of each layer that was taken: */
        unsigned of;     /* whose it is, */
        uint32_t share;  /* what of the light is, */
        bool is_seen;    /* and whether that is more than of those before it */
    } taken[TILE * TILE];
    struct {
        uint32_t all, squares[3]; /* shares so far, and those of squares of colours */
    } sum[TILE * TILE];
};

void blend_begin(struct blend *blend, const struct rendition *rendition,
                 const struct border *border, struct tile_bounds tile);
/* The next layers, for the caller to shade them: pixel by pixel, each from the nearest on. False
 * after the last. */
bool blend_take(struct blend *blend, struct rendition *rendition, struct tile_pixels *pixels);
/* Adds the colour of a layer that was taken; whether the pixel is to have its normal, unless that
 * is said of a later one too. */
bool blend_add(struct blend *blend, unsigned which, const uint8_t rgb[3]);
void blend_end(const struct blend *blend, struct rendition *rendition);

#endif
