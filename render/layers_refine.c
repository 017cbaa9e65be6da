/*
 * Refined layers, tile by tile.
 *
 * In patches, as render/patch.h has them, the rays of the corners and of one in the middle are
 * walked alone: where these have layers of the same labels in the same order, each of them flat,
 * those of the pixels between lie between them.
 */
#include "render/normal.h"
#include "render/passage.h"
#include "render/patch.h"

enum {
    CORNERS = 4,
    LEAST = 4,     /* pixels a side of a patch */
    FLAT_PART = 8, /* of a voxel: so far from its corners' plane may the middle be */
};

struct refining {
    const struct rendition *r;
    struct passage passage;
    uint32_t left, top;
    int64_t voxel;  /* its width in pixels */
    tile_mask done; /* which pixels of the tile have their layers */
};

static size_t pixel_of(const struct refining *f, uint32_t x, uint32_t y)
{
    return (size_t)(f->top + y) * f->r->width + f->left + x;
}

static inline tile_mask bit_of(uint32_t x, uint32_t y)
{
    return (tile_mask)1 << (y * TILE + x);
}

static size_t walk_pixel(struct refining *f, uint32_t x, uint32_t y)
{
    const size_t pixel = pixel_of(f, x, y);
    if (f->done & bit_of(x, y))
        return pixel;
    f->done |= bit_of(x, y);
    layers_put_none(f->passage.layers, pixel);
    if (f->r->cube.cell[pixel] != CELL_NONE)
        passage_walk(&f->passage, f->left + x, f->top + y, f->r->cube.depth[pixel]);
    return pixel;
}

static void walk_pixels(struct refining *f, uint32_t left, uint32_t top, uint32_t width,
                        uint32_t height)
{
    for (uint32_t y = top; y < top + height; y++)
        for (uint32_t x = left; x < left + width; x++)
            walk_pixel(f, x, y);
}

/* ---- patches ---- */

struct surface {
    uint8_t label;
    bool is_opaque;
    int64_t depth[CORNERS];
};

struct patch {
    uint32_t left, top, side; /* within the tile */
    size_t corner[CORNERS], middle;
    struct surface surface[LAYERS_MOST + 1];
    unsigned surfaces;
};

static void walk_corners(struct refining *f, struct patch *patch)
{
    const uint32_t last = patch->side - 1, half = patch->side / 2;
    for (uint32_t i = 0; i < CORNERS; i++)
        patch->corner[i] =
            walk_pixel(f, patch->left + (i & 1) * last, patch->top + (i >> 1) * last);
    patch->middle = walk_pixel(f, patch->left + half, patch->top + half);
}

static bool are_alike(const struct layer *a, const struct layer *b)
{
    return a->label == b->label && (a->depth & 3) == REFINE_WITHIN &&
           (b->depth & 3) == REFINE_WITHIN;
}

/* The surface of the layer in the middle of this number: whether all corners have it too, and it is
 * flat. */
static bool take_surface(const struct refining *f, struct patch *patch, const struct layer *middle)
{
    const unsigned number = patch->surfaces++;
    struct surface *surface = &patch->surface[number];
    for (int i = 0; i < CORNERS; i++) {
        const struct layer layer = layers_at(f->passage.layers, patch->corner[i], number);
        surface->depth[i] = layer.depth;
        if (!are_alike(&layer, middle))
            return false;
    }
    surface->label = middle->label;
    surface->is_opaque = f->passage.refiner->border->opacity[middle->label] == BORDER_OPAQUE;
    const int64_t most = (f->voxel << CROSSING_PIXEL_BITS) / FLAT_PART;
    const uint32_t half = patch->side / 2;
    const int64_t off = middle->depth - patch_between(surface->depth, patch->side, half, half);
    return off <= most && off >= -most;
}

/* Whether that is so of all layers, to the opaque one. */
static bool take_surfaces(const struct refining *f, struct patch *patch)
{
    const struct layers *l = f->passage.layers;
    for (;;) {
        const struct layer middle = layers_at(l, patch->middle, patch->surfaces);
        if (middle.label == 0)
            break;
        if (!take_surface(f, patch, &middle))
            return false;
        if (patch->surface[patch->surfaces - 1].is_opaque)
            return true;
    }
    for (int i = 0; i < CORNERS; i++)
        if (layers_at(l, patch->corner[i], patch->surfaces).label != 0)
            return false;
    return true;
}

/* False where one of the surfaces is that of no voxel there. */
static bool fill_pixel(struct refining *f, const struct patch *patch, uint32_t x, uint32_t y)
{
    struct layers *l = f->passage.layers;
    const uint32_t column = f->left + patch->left + x, row = f->top + patch->top + y;
    const size_t pixel = (size_t)row * f->r->width + column;
    layers_put_none(l, pixel);
    for (unsigned i = 0; i < patch->surfaces; i++) {
        const struct surface *surface = &patch->surface[i];
        const int64_t depth = patch_between(surface->depth, patch->side, x, y);
        const uint32_t cell =
            refine_label_voxel(f->passage.refiner, surface->label, depth, column, row);
        if (cell == CELL_NONE)
            return false;
        layers_put(l, pixel, depth, cell, surface->label, surface->is_opaque);
    }
    return true;
}

static void fill(struct refining *f, const struct patch *patch)
{
    for (uint32_t y = 0; y < patch->side; y++)
        for (uint32_t x = 0; x < patch->side; x++) {
            const tile_mask bit = bit_of(patch->left + x, patch->top + y);
            if (!(f->done & bit) && fill_pixel(f, patch, x, y))
                f->done |= bit;
        }
    walk_pixels(f, patch->left, patch->top, patch->side, patch->side);
}

static bool refine_whole(struct refining *f, uint32_t left, uint32_t top, uint32_t side)
{
    struct patch patch = {.left = left, .top = top, .side = side};
    if (side > f->voxel)
        return false;
    walk_corners(f, &patch);
    if (!take_surfaces(f, &patch))
        return false;
    fill(f, &patch);
    return true;
}

static void refine_patch(struct refining *f, uint32_t left, uint32_t top, uint32_t side)
{
    const uint32_t half = side / 2;
    if (refine_whole(f, left, top, side))
        return;
    for (uint32_t i = 0; i < 4 && half >= LEAST; i++)
        refine_patch(f, left + (i & 1) * half, top + (i >> 1) * half, half);
    walk_pixels(f, left, top, side, side);
}

void layers_refine(struct rendition *r, struct refiner *refiner, struct footprint tile)
{
    struct refining f = {.r = r,
                         .passage = {.layers = r->layers,
                                     .refiner = refiner,
                                     .leap = leap_of(refiner->camera, SEAMS_NEAR)},
                         .left = (uint32_t)tile.left,
                         .top = (uint32_t)tile.top,
                         .voxel = normal_stride(refiner->camera)};
    const uint32_t width = (uint32_t)(tile.right - tile.left) + 1;
    const uint32_t height = (uint32_t)(tile.bottom - tile.top) + 1;
    if (width == TILE && height == TILE)
        refine_patch(&f, 0, 0, TILE);
    else
        walk_pixels(&f, 0, 0, width, height);
}
