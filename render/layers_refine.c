#include "render/layers_refine.h"

#include "render/normal.h"
#include "render/patch.h"
#include "render/seams.h"
#include "render/walk.h"

enum {
    CORNERS = 4,
    LEAST = 4,     /* pixels a side of a patch */
    FLAT_PART = 8, /* of a voxel: so far from its corners' plane may the middle be */
};

/* ---- along a ray ---- */

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

/* Whether a surface is further than a gap from where the ray has left the same label. That is
 * looked for where it may matter alone. */
static bool is_layer(struct passage *p, const struct run *run, uint8_t label, int64_t depth)
{
    const int64_t voxel = refine_width(p->refiner), gap = LAYERS_GAP * voxel + voxel / 2;
    if (!run->has_layer || depth > run->left + REFINE_END * voxel + gap)
        return true;
    return depth > run->layer + gap &&
           depth > refine_end(p->refiner, label, p->x, p->y, run->left) + gap;
}

/* Where a ray comes to a voxel that is solid for a label. */
static void come_to(struct passage *p, const struct walk *walk, uint8_t label)
{
    struct run *run = &p->run[label];
    if (run->last < p->first)
        *run = (struct run){.until = INT64_MIN};
    else if (run->last + 1 < p->cube && run->is_found && run->until < walk->at) {
        /* Once the ray has been in a cube that is not solid for the label. */
        const int64_t inside = run->until + refine_width(p->refiner) / 4;
        run->is_found = false;
        run->has_layer = true;
        run->layer = run->until;
        run->left = run->at > inside ? run->at : inside;
    }
    run->last = p->cube;
    run->at = walk->at;
    if (run->is_found || walk->at <= run->until)
        return;
    int64_t depth = walk->at;
    uint32_t cell = walk->cell;
    run->is_found = refine_label(p->refiner, label, p->x, p->y, &depth, &cell);
    run->until = depth;
    if (run->is_found && is_layer(p, run, label, depth)) {
        const bool is_opaque = p->refiner->border->opacity[label] == BORDER_OPAQUE;
        layers_put(p->layers, (size_t)p->y * p->layers->width + p->x, depth, cell, label,
                   is_opaque);
        if (is_opaque && depth < p->opaque)
            p->opaque = depth;
    }
}

/* What the ray has come through without an edge was all of one label, if that of anything. */
static void come_from(struct passage *p, const struct walk *walk)
{
    const struct border *border = p->refiner->border;
    const uint32_t before = walk->cell + (uint32_t)p->refiner->camera->toward[walk->at & 3];
    if (!border_shows(border, before))
        return;
    struct run *run = &p->run[seams_label(p->refiner->seams, before)];
    run->last = p->cube - 1;
}

/* To the next voxel that is an edge, maybe this one; false where the ray leaves the scene. */
static bool go_to_edge(struct passage *p, struct walk *walk)
{
    const struct seams *seams = p->refiner->seams;
    struct walk here = *walk; /* in registers */
    bool is_within = true;
    while (is_within && !seams_is_edge(seams, here.cell)) {
        p->cube++;
        is_within = seams_is_near(seams, here.cell) ? walk_on(&here) : walk_leap(&here, &p->leap);
    }
    *walk = here;
    return is_within;
}

/* Layers of a pixel, whose first cube is at this depth. */
static void passage_walk(struct passage *p, uint32_t x, uint32_t y, int64_t from)
{
    struct walk walk;
    p->x = x, p->y = y;
    p->opaque = INT64_MAX;
    p->first = p->cube += 2;
    if (!walk_begin(&walk, p->refiner->camera, 0, x, y, from))
        return;
    for (uint32_t before = p->cube; go_to_edge(p, &walk) && walk.at <= p->opaque;
         before = p->cube) {
        if (p->cube > before)
            come_from(p, &walk);
        const struct solid solid = refine_solid(p->refiner, walk.cell);
        for (int i = 0; i < solid.labels; i++)
            come_to(p, &walk, solid.label[i]);
        p->cube++;
        if (!walk_on(&walk))
            return;
    }
}

/* ---- tiles ---- */

struct refining {
    const struct rendition *r;
    struct passage passage;
    uint32_t left, top;
    int64_t voxel;  /* its width in pixels */
    tile_mask done; /* which pixels of the tile have their layers */
};

static inline tile_mask bit_of(uint32_t x, uint32_t y)
{
    return (tile_mask)1 << (y * TILE + x);
}

static size_t walk_pixel(struct refining *f, uint32_t x, uint32_t y)
{
    const size_t pixel = (size_t)(f->top + y) * f->r->width + f->left + x;
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

static bool refine_whole(struct refining *f, uint32_t left, uint32_t top, uint32_t side)
{
    struct patch patch = {.left = left, .top = top, .side = side};
    if (side > f->voxel)
        return false;
    const uint32_t last = patch.side - 1, half = patch.side / 2;
    for (uint32_t i = 0; i < CORNERS; i++)
        patch.corner[i] = walk_pixel(f, patch.left + (i & 1) * last, patch.top + (i >> 1) * last);
    patch.middle = walk_pixel(f, patch.left + half, patch.top + half);
    if (!take_surfaces(f, &patch))
        return false;
    for (uint32_t y = 0; y < patch.side; y++)
        for (uint32_t x = 0; x < patch.side; x++) {
            const tile_mask bit = bit_of(patch.left + x, patch.top + y);
            if (!(f->done & bit) && fill_pixel(f, &patch, x, y))
                f->done |= bit;
        }
    walk_pixels(f, patch.left, patch.top, patch.side, patch.side);
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
