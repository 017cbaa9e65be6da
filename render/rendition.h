/* SPDX-License-Identifier: MIT */
/*
 * The rendition: the voxel, depth and colour of each pixel.
 *
 * A pixel's key is depth and voxel, and the least wins. So the map is a function of the visible
 * voxels and of the view, and the four ways to compute it (render/projection.h) agree in every
 * pixel.
 *
 * Invariant R1: depths and voxels equal the result of any of the four, and the rest follows from
 * them; an empty pixel has DEPTH_NONE, CELL_NONE, and after shading label 0, colour 0 and normal 0.
 * If the scene itself is put behind objects (render/mip.h), empty pixels have its colour.
 */
#ifndef RENDER_RENDITION_H
#define RENDER_RENDITION_H

#include <stdint.h>

#include "base/err.h"
#include "base/team.h"
#include "render/border.h"
#include "render/view.h"

#define DEPTH_NONE INT64_MAX

enum { TILE = 8 }; /* side, in pixels, of the squares that become stale and are shaded as a unit */

/* A set of pixels or samples of a tile: bit y * TILE + x. */
typedef uint64_t tile_mask;

/* States of a tile, as bits, so that several can be searched for. */
enum tile_state {
    TILE_FRESH = 0,
    TILE_STALE = 1,  /* to be shaded, */
    TILE_LIT = 2,    /* then its edges to be drawn, if the look has edges, */
    TILE_SHADED = 4, /* then, if it has samples, to be reduced; */
    TILE_EMPTY = 8,  /* shows nothing; to be reduced too */
};

struct rendition {
    uint32_t width, height;
    int64_t *depth;  /* [height][width], of the visible surface: 2^CROSSING_PIXEL_BITS to a pixel,
                       with the number of its triangle (render/projection.h) */
    uint32_t *cell;  /* the visible voxel; with layers, that of the largest share */
    uint8_t *label;  /* its label */
    uint8_t *rgba;   /* [height][width][4], sRGB, not multiplied by alpha; alpha is 255 where
                       something opaque is seen, and 0 for empty pixels */
    int16_t *normal; /* [height][width][4], outward along voxel axes, length 2^14 in the world; the
                        fourth is 0; all 0 for empty pixels */
    uint8_t *stale;  /* [tiles_y][tiles_x], enum tile_state */
    bool *blank;     /* likewise: all but depths and voxels are as rendition_empty leaves them, even
                        while the tile is stale */
    int64_t *far;    /* likewise: the largest depth of its pixels when `is_drawn` was last */
    bool *is_drawn;  /* cleared: a pixel may be nearer since */
    uint32_t tiles_x, tiles_y;
    struct layers *layers; /* borrowed; NULL if all objects are opaque (render/layers.h) */
};

enum err rendition_init(struct rendition *rendition, uint32_t width, uint32_t height,
                        struct fault *fault);
void rendition_release(struct rendition *rendition);

size_t rendition_bytes(const struct rendition *rendition);

/* Move *tile to the first tile from it on, row by row, in one of these states; false, with *tile at
 * `end`, if no tile before that is in one. */
bool rendition_tile(const struct rendition *rendition, size_t *tile, size_t end, unsigned states);

/* Return the number of tiles in one of these states. */
size_t rendition_count(const struct rendition *rendition, unsigned states);

/* The pixels of a tile; right and bottom are excluded. */
struct tile_bounds {
    uint32_t left, top, right, bottom;
};
static inline struct tile_bounds rendition_bounds(const struct rendition *rendition, size_t tile)
{
    const uint32_t left = (uint32_t)(tile % rendition->tiles_x) * TILE;
    const uint32_t top = (uint32_t)(tile / rendition->tiles_x) * TILE;
    const uint32_t width = rendition->width, height = rendition->height;
    return (struct tile_bounds){left, top, left + TILE < width ? left + TILE : width,
                                top + TILE < height ? top + TILE : height};
}

/* The visible surfaces at pixels of a tile: one for each, or several layers. */
struct tile_pixels {
    unsigned count;
    uint32_t x[TILE * TILE], y[TILE * TILE];
    int64_t depth[TILE * TILE];
    uint32_t cell[TILE * TILE];
    uint8_t label[TILE * TILE];
};

/* Return the part of `height` rows from row `top` on, a multiple of TILE; borrows the maps, and the
 * layers if they begin with the same row. */
struct rendition rendition_rows(const struct rendition *rendition, uint32_t top, uint32_t height);

/* Copy the first `height` rows to another rendition of the same width, which may share the maps. */
void rendition_copy(struct rendition *to, const struct rendition *from, uint32_t height);

/* Clear all pixels and mark every tile stale; labels, colours and normals are left to shading,
 * unless they are blank. */
void rendition_clear(struct rendition *rendition);

/* Clear a tile and mark it stale. */
void rendition_clear_tile(struct rendition *rendition, size_t tile);

/* Set `count` pixels, from number `first` on, to shaded empty ones. */
void rendition_empty(struct rendition *rendition, size_t first, size_t count);

/* A box of pixels, both ends included. Empty if left > right or top > bottom. */
struct footprint {
    int32_t left, top, right, bottom;
};

/* Mark stale the tiles of a footprint's pixels, and of pixels up to `pixels` away. */
void rendition_mark_stale(struct rendition *rendition, struct footprint footprint, int pixels);

/* Reduce samples x samples pixels of `fine` to each pixel of `out`: depth, voxel, label and normal
 * of the nearest; the mean colour, averaged as squares, which is close to physical light, weighted
 * by alpha; and the mean alpha. `samples` divides TILE. Only tiles of `fine` that are not fresh are
 * reduced, and become fresh. By a team, or NULL. */
void rendition_reduce(struct rendition *out, struct rendition *fine, uint32_t samples,
                      struct team *team);

/* The same for one pixel that represents a box of others, which may be partly covered: compute its
 * colour and alpha, and return the nearest pixel of the box. */
size_t rendition_mean(uint8_t rgba[4], const struct rendition *rendition, uint32_t left,
                      uint32_t top, uint32_t width, uint32_t height);

/* Return a sum mod 2^64, over pixels, of a mix of everything the rendition holds. */
uint64_t rendition_digest(const struct rendition *rendition);
/* The parts of that sum: the start for a picture of this size, and the contribution of its rows
 * from row `top` on. */
uint64_t rendition_digest_begin(uint32_t width, uint32_t height);
uint64_t rendition_digest_rows(const struct rendition *rows, uint32_t top);

#endif
