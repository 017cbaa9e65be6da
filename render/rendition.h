/* SPDX-License-Identifier: MIT */
/*
 * The rendition: which voxel each pixel shows, at what depth, and in what colour.
 *
 * A pixel's key is depth and voxel, and the least wins. So the map is a function of what is shown
 * and of the view, and the four ways of making it (render/projection.h) agree in every pixel.
 *
 * Invariant R1: depths and voxels are what any of the four gives, and the rest follows from them; a
 * pixel that shows nothing has DEPTH_NONE, CELL_NONE, and once it is shaded label 0, colour 0 and
 * normal 0.
 * Where the scene itself is put behind objects (render/mip.h), it has a colour.
 */
#ifndef RENDER_RENDITION_H
#define RENDER_RENDITION_H

#include <stdint.h>

#include "base/err.h"
#include "base/team.h"
#include "render/border.h"
#include "render/view.h"

#define DEPTH_NONE INT64_MAX

enum { TILE = 8 }; /* side, in pixels, of the squares that are marked stale and shaded at once */

/* Some pixels of a tile, or samples: bit y * TILE + x. */
typedef uint64_t tile_mask;

/* One bit each, so that one can ask for several. */
enum tile_state {
    TILE_FRESH = 0,
    TILE_STALE = 1,  /* waits to be shaded; */
    TILE_LIT = 2,    /* then for its edges, where it has any; */
    TILE_SHADED = 4, /* then, where it is of samples, to be reduced, */
    TILE_EMPTY = 8,  /* as does one that shows nothing, */
};

struct rendition {
    uint32_t width, height;
    int64_t *depth; /* [height][width], of what is seen: 2^CROSSING_PIXEL_BITS to a pixel, and which
                       triangle that is (render/projection.h) */
    uint32_t *cell; /* of the visible voxel; with layers, of the one that counts */
    uint8_t *label; /* of that voxel */
    uint8_t *rgba;  /* [height][width][4], sRGB, not multiplied by alpha; alpha is 255 where
                        something opaque is seen, and 0 where nothing is */
    int16_t *normal; /* [height][width][4], outward along voxel axes, length 2^14 in the world; the
                        fourth is 0, as is all where nothing is seen */
    uint8_t *stale;  /* [tiles_y][tiles_x], enum tile_state */
    bool *blank;     /* likewise: all but depths and voxels are as rendition_empty leaves them, also
                        while the tile is stale */
    int64_t *far;    /* likewise: the furthest depth that a pixel has, as of when `is_drawn` was */
    bool *is_drawn;  /* cleared: a pixel may have become nearer since */
    uint32_t tiles_x, tiles_y;
    struct layers *layers; /* borrowed; NULL where all objects are opaque (render/layers.h) */
};

enum err rendition_init(struct rendition *rendition, uint32_t width, uint32_t height,
                        struct fault *fault);
void rendition_release(struct rendition *rendition);

size_t rendition_bytes(const struct rendition *rendition);

/* The next tile from number `tile` on, row by row, that is in one of these states; `end`, where
 * there is none before that. */
size_t rendition_tile(const struct rendition *rendition, size_t tile, size_t end, unsigned states);

/* How many tiles are in one of these states. */
size_t rendition_count(const struct rendition *rendition, unsigned states);

/* The pixels of a tile; right and bottom are beyond it. */
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

/* What is seen at some pixels of a tile: of each once, or of several layers. */
struct tile_pixels {
    unsigned count;
    uint32_t x[TILE * TILE], y[TILE * TILE];
    int64_t depth[TILE * TILE];
    uint32_t cell[TILE * TILE];
    uint8_t label[TILE * TILE];
};

/* The part of `height` rows from row `top` on, a multiple of TILE; borrows the maps, and the
 * layers where they begin with the same row. */
struct rendition rendition_rows(const struct rendition *rendition, uint32_t top, uint32_t height);

/* What is shown in the first `height` rows of one goes to those of another of its width, which may
 * be of the same maps. */
void rendition_copy(struct rendition *to, const struct rendition *from, uint32_t height);

/* Nothing is seen, and every tile is stale; labels, colours and normals are for shading to make,
 * but where they are blank. */
void rendition_clear(struct rendition *rendition);

/* Nothing is seen in a tile, and it is stale. */
void rendition_clear_tile(struct rendition *rendition, size_t tile);

/* Shaded pixels of which nothing is seen: `count` of them, from number `first` on. */
void rendition_empty(struct rendition *rendition, size_t first, size_t count);

/* Some pixels of a picture, both ends included. Empty where left > right or top > bottom. */
struct footprint {
    int32_t left, top, right, bottom;
};

/* Marks the tiles of the pixels of a footprint, and of those up to `pixels` away. */
void rendition_mark_stale(struct rendition *rendition, struct footprint footprint, int pixels);

/* Makes each pixel of `out` of samples x samples pixels of `fine`, which is so much larger: the
 * nearest one's depth, voxel, label and normal; the mean colour, taken of squares, which is near to
 * what light does, and each weighted by its alpha; and the mean alpha. `samples` divides TILE. Only
 * tiles of `fine` that are not fresh are looked at, and then are. By a team, or NULL. */
void rendition_reduce(struct rendition *out, struct rendition *fine, uint32_t samples,
                      struct team *team);

/* The same for one pixel that stands for a box of others, which may be covered in part: its colour
 * and alpha; the pixel of the box that lies nearest is given back. */
size_t rendition_mean(uint8_t rgba[4], const struct rendition *rendition, uint32_t left,
                      uint32_t top, uint32_t width, uint32_t height);

/* A sum mod 2^64 over pixels of a mix of everything the rendition holds. */
uint64_t rendition_digest(const struct rendition *rendition);
/* What the digest of a picture of this size is the sum of: this, and what its rows add to it; these
 * are those from row `top` on. */
uint64_t rendition_digest_begin(uint32_t width, uint32_t height);
uint64_t rendition_digest_rows(const struct rendition *rows, uint32_t top);

#endif
