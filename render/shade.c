#include "render/shade.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "render/edge.h"
#include "render/layers_refine.h"
#include "render/light.h"
#include "render/occlusion.h"
#include "render/patch.h"
#include "render/seams.h"

enum {
    EDGE = LIGHT_UNIT * 35 / 100, /* what an edge leaves of a colour */
    STAIRS_SEEN = 4,              /* pixels to a voxel, from which on faces of voxels are stairs */
};

/* Each thread has its own fields. */
struct shader_part {
    struct field shown, scene;
};
struct shader_store {
    struct shader_part part[TEAM_MOST];
    struct seams seams;   /* for layers (render/layers.h) and creases */
    struct bricks bricks; /* for ambient occlusion */
};

void shader_release(struct shader *shader)
{
    struct shader_store *store = shader->store;
    for (int i = 0; i < TEAM_MOST && store; i++) {
        field_release(&store->part[i].shown);
        field_release(&store->part[i].scene);
    }
    if (store) {
        seams_release(&store->seams);
        bricks_release(&store->bricks);
    }
    free(store);
    shader->store = NULL;
}

size_t shader_bytes(const struct shader *shader)
{
    const struct shader_store *store = shader->store;
    size_t bytes = store ? seams_bytes(&store->seams) + bricks_bytes(&store->bricks) : 0;
    for (int i = 0; i < TEAM_MOST && store; i++)
        bytes += field_bytes(&store->part[i].shown) + field_bytes(&store->part[i].scene);
    return bytes;
}

static enum err make_store(struct shader *shader, struct fault *fault)
{
    if (!shader->store)
        shader->store = mem_new(sizeof *shader->store);
    return shader->store ? OK : fault_memory(fault, "shading");
}

/* ---- pixels ---- */

/* All that colours depend on besides the pixel. */
struct shading {
    const struct camera *camera;
    const struct border *border;
    const struct look *look;
    const struct palette *palette;
    bool is_refined;
    struct refiner refiner; /* where the rendition is refined, */
    struct solids solids;   /* what it stores */
    bool has_patches;       /* with patches; */
    uint32_t samples;       /* of which one may stand for samples x samples; */
    uint32_t block;         /* and in blocks of so many tiles a side */
    struct normals normals;
    struct light light;
    struct occluder occluder;
    bool occludes;     /* light is occluded, by these bricks */
    bool cuts;         /* something is cut away, */
    int32_t window[2]; /* and where it was, these intensities are black and white */
};

/* Whether lines are drawn over the colours that pixels have; in look 1 they are a part of these. */
static bool draws_edges(const struct look *look)
{
    return look->edges && look->number > LOOK_FIRST;
}

/* Whether a pixel shows a face of its voxel beyond which an object was cut away. */
static bool is_cut_open(const struct rendition *r, const struct shading *s, size_t pixel)
{
    const unsigned axis = r->depth[pixel] & 3;
    if (!s->cuts || axis == REFINE_WITHIN)
        return false;
    return s->is_refined ||
           border_is_cut(s->border, r->cell[pixel] + (uint32_t)s->camera->toward[axis]);
}

/* The scene there: as bright from every side, so that it reads like a slice. */
static void shade_cut_face(uint8_t rgba[4], const struct shading *s, uint32_t cell,
                           const uint8_t colour[3], int64_t cue)
{
    const int64_t width = (int64_t)s->window[1] - s->window[0];
    const int64_t above = (int64_t)s->camera->scene->cell[cell].intensity - s->window[0];
    const int64_t share = width ? above * 255 / width : 0;
    const int64_t grey = share < 0 ? 0 : share > 255 ? 255 : share;
    uint8_t tinted[3];
    for (int k = 0; k < 3; k++)
        tinted[k] = (uint8_t)((3 * grey + colour[k] + 2) / 4);
    light_flat(rgba, tinted, cue);
}

/* Pixels that show something; those from `known` on have their normals. */
static void shade_pixels(struct rendition *r, struct shading *s, struct tile_pixels *pixels,
                         unsigned known)
{
    const bool has_dark_edges = s->look->edges && !draws_edges(s->look) && !r->layers;
    struct directions normals;
    struct lit lit = {0};
    const unsigned all = pixels->count;
    pixels->count = known;
    if (known > 0)
        normals_of(&normals, &s->normals, r, pixels);
    pixels->count = all;
    for (unsigned i = known; i < all; i++)
        for (unsigned a = 0; a < 3; a++)
            normals.along[a][i] =
                r->normal[4 * ((size_t)pixels->y[i] * r->width + pixels->x[i]) + a];
    for (unsigned i = 0; i < pixels->count; i++) {
        const uint32_t x = pixels->x[i], y = pixels->y[i];
        const size_t pixel = (size_t)y * r->width + x;
        const int64_t cue = light_cue(&s->light, r->depth[pixel]);
        const bool is_dark = has_dark_edges && edge_hides(r, x, y);
        lit.cue[i] = (uint16_t)(is_dark ? cue * EDGE >> LIGHT_UNIT_BITS : cue);
        lit.open[i] = LIGHT_UNIT;
        for (int k = 0; k < 3; k++)
            lit.colour[k][i] = s->palette->rgb[r->label[pixel]][k];
    }
    for (unsigned i = 0; i < pixels->count && s->occludes; i++) {
        const uint32_t x = pixels->x[i], y = pixels->y[i];
        const int16_t normal[3] = {normals.along[0][i], normals.along[1][i], normals.along[2][i]};
        lit.open[i] =
            occluder_leaves(&s->occluder, normal, r->depth[(size_t)y * r->width + x], x, y);
    }
    light_surfaces(&lit, &s->light, &normals);
    for (unsigned i = 0; i < pixels->count; i++) {
        const size_t pixel = (size_t)pixels->y[i] * r->width + pixels->x[i];
        const int16_t normal[4] = {normals.along[0][i], normals.along[1][i], normals.along[2][i]};
        const uint8_t rgba[4] = {lit.colour[0][i], lit.colour[1][i], lit.colour[2][i], 255};
        memcpy(r->normal + 4 * pixel, normal, sizeof normal);
        memcpy(r->rgba + 4 * pixel, rgba, sizeof rgba);
        if (is_cut_open(r, s, pixel))
            shade_cut_face(r->rgba + 4 * pixel, s, r->cell[pixel], s->palette->rgb[r->label[pixel]],
                           lit.cue[i]);
    }
}

/* ---- tiles ---- */

struct tile {
    uint32_t left, top, right, bottom; /* right and bottom are beyond it */
};

static struct tile tile_at(const struct rendition *r, size_t number)
{
    const uint32_t x = (uint32_t)(number % r->tiles_x), y = (uint32_t)(number / r->tiles_x);
    const uint32_t right = (x + 1) * TILE, bottom = (y + 1) * TILE;
    return (struct tile){x * TILE, y * TILE, right < r->width ? right : r->width,
                         bottom < r->height ? bottom : r->height};
}

static struct footprint footprint_of(struct tile tile)
{
    return (struct footprint){(int32_t)tile.left, (int32_t)tile.top, (int32_t)tile.right - 1,
                              (int32_t)tile.bottom - 1};
}

/* Labels of a tile. Empty pixels get no colour and no normal; true where all of them are empty. */
static bool label_tile(struct rendition *r, const struct border *border, struct tile tile)
{
    const struct labels *labels = &border->labels;
    bool is_empty = true;
    uint32_t last = CELL_NONE;
    uint8_t label = 0;
    if (r->layers)
        return layers_pick(r, border, footprint_of(tile));
    /* Voxels beside each other in a picture lie far apart in memory. */
    uint32_t latest = CELL_NONE;
    for (uint32_t y = tile.top; y < tile.bottom; y++)
        for (uint32_t x = tile.left; x < tile.right; x++) {
            const uint32_t voxel = r->cell[(size_t)y * r->width + x];
            if (voxel != CELL_NONE && voxel != latest)
                __builtin_prefetch(labels->scene->cell + voxel);
            latest = voxel;
        }
    for (uint32_t y = tile.top; y < tile.bottom; y++) {
        const size_t row = (size_t)y * r->width;
        for (size_t pixel = row + tile.left; pixel < row + tile.right; pixel++) {
            const uint32_t cell = r->cell[pixel];
            is_empty = is_empty && cell == CELL_NONE;
            if (cell != last)
                label = cell == CELL_NONE ? 0 : labels_at(labels, cell);
            last = cell;
            r->label[pixel] = label;
            if (cell != CELL_NONE)
                continue;
            memset(r->rgba + 4 * pixel, 0, 4);
            memset(r->normal + 4 * pixel, 0, 4 * sizeof *r->normal);
        }
    }
    return is_empty;
}

static void take_pixels(struct tile_pixels *pixels, const struct rendition *r, struct tile tile,
                        tile_mask mask)
{
    const tile_mask wide = (1u << (tile.right - tile.left)) - 1;
    for (uint32_t y = tile.top; y < tile.bottom; y++, mask >>= TILE)
        for (tile_mask row = mask & wide; row; row &= row - 1) {
            const uint32_t x = tile.left + (uint32_t)__builtin_ctzll(row);
            if (r->cell[(size_t)y * r->width + x] == CELL_NONE)
                continue;
            pixels->x[pixels->count] = x;
            pixels->y[pixels->count++] = y;
        }
}

/* Some pixels, of which some have their normals. */
static void shade_tile(struct rendition *r, struct shading *s, struct tile tile, tile_mask mask,
                       tile_mask has_normal)
{
    struct tile_pixels pixels;
    pixels.count = 0;
    take_pixels(&pixels, r, tile, mask & ~has_normal);
    const unsigned known = pixels.count;
    take_pixels(&pixels, r, tile, mask & has_normal);
    if (pixels.count)
        shade_pixels(r, s, &pixels, known);
}

/* Whether no ray of a tile comes to a cube. */
static bool is_bare(const struct rendition *r, struct tile tile)
{
    uint32_t all = CELL_NONE; /* which has all bits set */
    for (uint32_t y = tile.top; y < tile.bottom; y++) {
        const uint32_t *cell = r->cube.cell + (size_t)y * r->width + tile.left;
        for (uint32_t x = 0; x < tile.right - tile.left; x++)
            all &= cell[x];
    }
    return all == CELL_NONE;
}

static struct patches patches_at(struct rendition *r, struct shading *s, struct tile tile)
{
    return (struct patches){.r = r,
                            .refiner = &s->refiner,
                            .normals = &s->normals,
                            .left = tile.left,
                            .top = tile.top,
                            .side = s->block * TILE,
                            .samples = s->samples,
                            .has_lattice = s->look->number > LOOK_THIRD};
}

static void refine_pixels(struct rendition *r, struct shading *s, struct tile tile)
{
    if (r->layers) {
        layers_refine(r, &s->refiner, footprint_of(tile));
        return;
    }
    for (uint32_t y = tile.top; y < tile.bottom; y++)
        for (uint32_t x = tile.left; x < tile.right; x++)
            refine_pixel(r, &s->refiner, x, y);
}

static struct patched *patched_at(struct patches *p, struct tile tile)
{
    return &p->tile[(tile.top - p->top) / TILE][(tile.left - p->left) / TILE];
}

/* What a map has of samples that stand for pixels, for all samples of these. */
static void spread(void *map, size_t each, const struct rendition *r, struct tile tile,
                   tile_mask stands, uint32_t samples)
{
    char *first = (char *)map + ((size_t)tile.top * r->width + tile.left) * each;
    for (; stands; stands &= stands - 1) {
        const unsigned bit = (unsigned)__builtin_ctzll(stands);
        const char *from = first + (bit / TILE * (size_t)r->width + bit % TILE) * each;
        const uint32_t left = bit % TILE / samples * samples, top = bit / TILE / samples * samples;
        for (uint32_t y = top; y < top + samples; y++)
            for (uint32_t x = left; x < left + samples; x++)
                memmove(first + (y * (size_t)r->width + x) * each, from, each);
    }
}

/* Refines a tile and shades it. */
static enum tile_state refine_tile(struct rendition *r, struct shading *s, struct tile tile,
                                   struct patches *p)
{
    const bool is_whole = tile.right - tile.left == TILE && tile.bottom - tile.top == TILE;
    if (s->has_patches && is_whole) {
        patches_refine_tile(p, tile.left - p->left, tile.top - p->top);
        /* A tile of patches, of which this is known: the state that it is in then. */
        const struct patched *known = patched_at(p, tile);
        const tile_mask covered = patches_covered(known->stands, s->samples);
        if (!~covered) {
            shade_tile(r, s, tile, known->stands, known->has_normal);
            return TILE_STANDS;
        }
        spread(r->depth, sizeof *r->depth, r, tile, known->stands, s->samples);
        spread(r->cell, sizeof *r->cell, r, tile, known->stands, s->samples);
        label_tile(r, s->border, tile);
        shade_tile(r, s, tile, ~covered | known->stands, known->has_normal);
        spread(r->normal, 4 * sizeof *r->normal, r, tile, known->stands, s->samples);
        spread(r->rgba, 4, r, tile, known->stands, s->samples);
        return TILE_SHADED;
    }
    refine_pixels(r, s, tile);
    label_tile(r, s->border, tile);
    shade_tile(r, s, tile, ~(tile_mask)0, 0);
    return TILE_SHADED;
}

/* Where objects are translucent: layer by layer, from the nearest on. Edges are those of the layers
 * that count. */
static void blend_tile(struct rendition *r, struct shading *s, struct tile tile)
{
    struct blend blend;
    blend_begin(&blend, r, s->border, footprint_of(tile));
    for (tile_mask pixels = blend_next(&blend); pixels; pixels = blend_next(&blend)) {
        shade_tile(&r->layers->pass, s, tile, pixels, 0);
        blend_add(&blend, r);
    }
    blend_end(&blend, r);
    const bool has_edges = s->look->edges && !draws_edges(s->look);
    for (uint32_t y = tile.top; has_edges && y < tile.bottom; y++)
        for (uint32_t x = tile.left; x < tile.right; x++)
            for (size_t k = 0; k < 3 && edge_hides(r, x, y); k++) {
                uint8_t *level = r->rgba + 4 * ((size_t)y * r->width + x) + k;
                *level = (uint8_t)(*level * EDGE >> LIGHT_UNIT_BITS);
            }
}

/* Whether what a pixel looks like depends on depths and labels of pixels around. */
static bool looks_around(const struct look *look)
{
    return look->edges || look->mode == SHADE_DEPTH;
}

/* Refined tiles wait until they are shaded, where they may: fields are at hand then. */
static bool waits(const struct rendition *r, const struct shading *s)
{
    return rendition_is_refined(r) && !looks_around(s->look);
}

/* Surfaces of samples: then what is empty is not looked at (render/rendition.h). */
static bool is_reduced(const struct rendition *r, const struct shading *s)
{
    return rendition_is_refined(r) && s->samples > 1;
}

/* Tiles have numbers, row by row: those from `first` to before `end`. */
static void label_tiles(struct rendition *r, size_t first, size_t end, struct shading *s)
{
    for (size_t i = rendition_tile(r, first, end, TILE_STALE); i < end;
         i = rendition_tile(r, i + 1, end, TILE_STALE)) {
        const struct tile tile = tile_at(r, i);
        const bool bare = !r->layers && is_bare(r, tile);
        if (bare && !is_reduced(r, s) && !r->blank[i])
            for (uint32_t y = tile.top; y < tile.bottom; y++)
                rendition_empty(r, (size_t)y * r->width + tile.left, tile.right - tile.left);
        r->blank[i] = bare && (r->blank[i] || !is_reduced(r, s));
        if (!bare && waits(r, s))
            continue;
        if (!bare && rendition_is_refined(r))
            refine_pixels(r, s, tile);
        if (bare || label_tile(r, s->border, tile))
            r->stale[i] = TILE_EMPTY;
    }
}

static void shade_tiles(struct rendition *r, size_t first, size_t end, struct shading *s,
                        struct task *task)
{
    const enum tile_state next = draws_edges(s->look) ? TILE_LIT : TILE_SHADED;
    for (size_t i = rendition_tile(r, first, end, TILE_STALE);
         i < end && task_advance(task, TILE * TILE);
         i = rendition_tile(r, i + 1, end, TILE_STALE)) {
        const struct tile tile = tile_at(r, i);
        if (waits(r, s) && !r->layers) {
            struct patches p = patches_at(r, s, tile);
            const size_t after = rendition_tile(r, i + 1, end, TILE_STALE);
            if (after < end) /* what it looks at comes to the caches meanwhile */
                refine_fetch(&s->refiner, r, footprint_of(tile_at(r, after)));
            r->stale[i] = (uint8_t)refine_tile(r, s, tile, &p);
            continue;
        }
        if (waits(r, s)) {
            refine_pixels(r, s, tile);
            label_tile(r, s->border, tile);
        }
        if (r->layers)
            blend_tile(r, s, tile);
        else
            shade_tile(r, s, tile, ~(tile_mask)0, 0);
        r->stale[i] = (uint8_t)next;
    }
}

/* ---- blocks of tiles, of which all are stale where one is ---- */

/* Tiles of a picture: side x side of them. */
struct square {
    uint32_t x, y, side;
};

static bool is_all(const struct rendition *r, struct square square, enum tile_state state)
{
    if ((square.x + square.side) * TILE > r->width || (square.y + square.side) * TILE > r->height)
        return false;
    for (uint32_t y = square.y; y < square.y + square.side; y++)
        for (uint32_t x = square.x; x < square.x + square.side; x++)
            if (r->stale[(size_t)y * r->tiles_x + x] != state)
                return false;
    return true;
}

/* In which one sample stands for each pixel. */
static void shade_standing(struct rendition *r, struct shading *s, struct patches *p,
                           struct square square)
{
    struct tile_pixels pixels;
    pixels.count = 0;
    for (uint32_t y = square.y; y < square.y + square.side; y++)
        for (uint32_t x = square.x; x < square.x + square.side; x++) {
            const size_t number = (size_t)y * r->tiles_x + x;
            const struct tile tile = tile_at(r, number);
            take_pixels(&pixels, r, tile, patched_at(p, tile)->stands);
            r->stale[number] = TILE_STANDS;
        }
    shade_pixels(r, s, &pixels, 0);
}

/* As one patch; where it is none, by its quarters. */
static void shade_square(struct rendition *r, struct shading *s, struct patches *p,
                         struct square square)
{
    const uint32_t half = square.side / 2;
    if (square.x >= r->tiles_x || square.y >= r->tiles_y)
        return;
    if (square.side == 1) {
        const size_t number = (size_t)square.y * r->tiles_x + square.x;
        if (r->stale[number] == TILE_STALE)
            r->stale[number] = (uint8_t)refine_tile(r, s, tile_at(r, number), p);
        return;
    }
    if (square.side <= s->samples && square.side * TILE <= s->normals.stride &&
        is_all(r, square, TILE_STALE) &&
        patches_refine_square(p, square.x * TILE - p->left, square.y * TILE - p->top,
                              square.side * TILE)) {
        shade_standing(r, s, p, square);
        return;
    }
    for (unsigned i = 0; i < 4; i++)
        shade_square(r, s, p,
                     (struct square){square.x + (i & 1) * half, square.y + (i >> 1) * half, half});
}

static void mark_blocks(struct rendition *r, uint32_t side)
{
    const size_t all = (size_t)r->tiles_x * r->tiles_y;
    for (size_t i = rendition_tile(r, 0, all, TILE_STALE); i < all;
         i = rendition_tile(r, i + 1, all, TILE_STALE)) {
        const uint32_t x = (uint32_t)(i % r->tiles_x) / side * side;
        const uint32_t y = (uint32_t)(i / r->tiles_x) / side * side;
        const uint32_t wide = r->tiles_x - x < side ? r->tiles_x - x : side;
        for (uint32_t j = y; j < y + side && j < r->tiles_y; j++)
            memset(r->stale + (size_t)j * r->tiles_x + x, TILE_STALE, wide);
    }
}

/* The first row of blocks that begins with this tile or after it. */
static uint32_t block_row(const struct rendition *r, size_t tile, uint32_t side)
{
    const size_t row = (size_t)r->tiles_x * side;
    const size_t y = (tile + row - 1) / row * side;
    return y < r->tiles_y ? (uint32_t)y : r->tiles_y;
}

/* Tiles that have waited for it; of blocks those which begin there. */
static void shade_some(struct rendition *r, size_t first, size_t end, struct shading *s,
                       struct task *task)
{
    struct square block = {.side = s->block};
    if (s->block == 1 || !waits(r, s)) {
        shade_tiles(r, first, end, s, task);
        return;
    }
    const uint32_t after = block_row(r, end, s->block);
    for (block.y = block_row(r, first, s->block); block.y < after; block.y += block.side)
        for (block.x = 0; block.x < r->tiles_x; block.x += block.side) {
            const struct tile tile = {.left = block.x * TILE, .top = block.y * TILE};
            struct patches p = patches_at(r, s, tile);
            shade_square(r, s, &p, block);
            if (!task_advance(task, (uint64_t)TILE * TILE * block.side * block.side))
                return;
        }
}

/* Edges look at normals of pixels around, so they come once all are there. */
static void draw_edges(struct rendition *r, size_t first, size_t end, const struct shading *s)
{
    struct edges edges;
    edges_init(&edges, r, s->camera, s->look->samples);
    for (size_t i = rendition_tile(r, first, end, TILE_LIT); i < end;
         i = rendition_tile(r, i + 1, end, TILE_LIT)) {
        const struct tile tile = tile_at(r, i);
        for (uint32_t y = tile.top; y < tile.bottom; y++)
            for (uint32_t x = tile.left; x < tile.right; x++) {
                const size_t pixel = (size_t)y * r->width + x;
                const enum edge edge =
                    r->cell[pixel] == CELL_NONE ? EDGE_NONE : edge_at(&edges, x, y);
                uint8_t *rgba = r->rgba + 4 * pixel;
                for (int k = 0; k < 3 && edge; k++)
                    rgba[k] = edge == EDGE_LIGHT
                                  ? (uint8_t)((s->palette->rgb[r->label[pixel]][k] + 255) / 2)
                                  : (uint8_t)(rgba[k] * EDGE >> LIGHT_UNIT_BITS);
            }
        r->stale[i] = TILE_SHADED;
    }
}

/* Depths are those of the layers that count, and say nothing of the others. */
static enum shade_mode mode_of(const struct look *look, const struct border *border)
{
    const bool knows_depths = !border_is_translucent(border);
    return look->mode == SHADE_DEPTH && !knows_depths ? SHADE_SURFACE : look->mode;
}

/* Whether layers are refined where objects are translucent and the border has a skin. */
static bool refines_layers(const struct look *look, const struct camera *camera)
{
    return look->number > LOOK_THIRD && look_is_refined(look) &&
           normal_stride(camera) >= STAIRS_SEEN;
}

bool shade_refines(const struct look *look, const struct camera *camera,
                   const struct border *border)
{
    return look_is_refined(look) && border->has_skin &&
           (!border_is_translucent(border) || refines_layers(look, camera));
}

/* ---- fields and bricks ---- */

/* Translucent objects let the light in. */
static bool occludes(const struct look *look, const struct border *border)
{
    return look->ao_percent > 0 && !border_is_translucent(border);
}

static enum err prepare(struct field *field, const struct border *border, enum field_kind kind,
                        unsigned threads, struct fault *fault)
{
    if (field->kind == kind && field_fits(field, border, threads))
        return OK;
    field_release(field);
    return field_init(field, border, kind, threads, fault);
}

enum err shader_prepare(struct shader *shader, unsigned threads, const struct camera *camera,
                        const struct border *border, const struct look *look, struct fault *fault)
{
    const enum shade_mode mode = mode_of(look, border);
    const bool is_refined = shade_refines(look, camera, border);
    const bool has_layers = is_refined && border_is_translucent(border);
    const enum field_kind kind = !is_refined  ? FIELD_SHOWN
                                 : has_layers ? FIELD_SURFACES
                                              : FIELD_SURFACE;
    const unsigned most = team_size(shader->team);
    enum err err = make_store(shader, fault);
    struct shader_store *store = shader->store;
    for (unsigned i = 0; i < threads && !err; i++) {
        struct shader_part *part = store->part + i;
        if (is_refined || mode != SHADE_DEPTH)
            err = prepare(&part->shown, border, kind, most, fault);
        part->shown.seams = &store->seams;
        if (!err && mode == SHADE_SCENE)
            err = prepare(&part->scene, border, FIELD_SCENE, most, fault);
    }
    if (!err && (look->creases || has_layers))
        err = seams_count(&store->seams, border, fault);
    if (!err && has_layers)
        seams_find_near(&store->seams);
    return !err && occludes(look, border) ? bricks_take(&store->bricks, border, fault) : err;
}

enum err shade_take_layers(struct shader *shader, struct layers *layers,
                           struct rendition *rendition, const struct camera *camera,
                           const struct border *border, const struct look *look,
                           struct fault *fault)
{
    const enum err err = make_store(shader, fault);
    return err ? err
               : layers_take(layers, rendition, border, &shader->store->seams,
                             refines_layers(look, camera), fault);
}

void shade_follow(struct shader *shader, const struct border *border, const struct changes *changes)
{
    if (shader->store)
        seams_follow(&shader->store->seams, border, changes, NULL); /* else shading counts them */
}

/* ---- pictures ---- */

static void shading_init(struct shading *s, const struct camera *camera,
                         const struct border *border, const struct palette *palette,
                         const struct look *look, struct shader *shader)
{
    *s = (struct shading){.camera = camera,
                          .is_refined = shade_refines(look, camera, border),
                          .border = border,
                          .look = look,
                          .palette = palette,
                          .occludes = occludes(look, border),
                          .cuts = !cut_is_none(&border->cut),
                          .window = {shader->window[0], shader->window[1]}};
    light_init(&s->light, camera, look->light, look->cue_percent);
    if (look_is_refined(look))
        refiner_init(&s->refiner, camera, border);
    s->refiner.seams = &shader->store->seams;
    s->refiner.is_close = look->number > LOOK_SECOND;
    s->refiner.meets = look->number > LOOK_SECOND && normal_stride(camera) >= STAIRS_SEEN;
    if (s->occludes)
        occluder_init(&s->occluder, &shader->store->bricks, camera, look->ao_percent);
    s->has_patches =
        look->number > LOOK_SECOND && !looks_around(look) && !border_is_translucent(border);
    s->samples = s->has_patches && look->number > LOOK_THIRD ? look->samples : 1;
    s->block = look->number > LOOK_THIRD && s->has_patches && normal_stride(camera) >= TILE
                   ? PATCH_TILES
                   : 1;
}

/* The fields of a thread are its own. */
static void take_fields(struct shading *s, struct shader_part *part)
{
    normals_init(&s->normals, s->camera, mode_of(s->look, s->border), s->look->number > LOOK_FIRST,
                 &part->shown, &part->scene);
    s->normals.creases = s->look->creases;
    s->refiner.shown = &s->normals.shown;
    s->refiner.solids = &s->solids;
}

void shade_rows(struct rendition *r, uint32_t first, uint32_t end, const struct camera *camera,
                const struct border *border, const struct palette *palette, const struct look *look,
                struct shader *shader, unsigned number)
{
    struct shading s;
    struct task task = task_begin_part(camera->scene->watch, NULL, 0, 1);
    const size_t all = (size_t)r->tiles_x * r->tiles_y;
    shading_init(&s, camera, border, palette, look, shader);
    take_fields(&s, &shader->store->part[number]);
    label_tiles(r, 0, all, &s);
    if (draws_edges(look)) /* which look at rows around */
        shade_tiles(r, 0, all, &s, &task);
    else
        shade_some(r, (size_t)first * r->tiles_x, (size_t)end * r->tiles_x, &s, &task);
    draw_edges(r, (size_t)first * r->tiles_x, (size_t)end * r->tiles_x, &s);
}

struct sharing {
    struct rendition *rendition;
    const struct shading *shading;
    struct shader *shader;
    struct team *team;
};

/* The tile after the first `stale` ones that are. */
static size_t tile_after(const struct rendition *r, size_t stale)
{
    const size_t all = (size_t)r->tiles_x * r->tiles_y;
    size_t tile = 0;
    for (; stale > 0 && tile < all; stale--)
        tile = rendition_tile(r, tile, all, TILE_STALE) + 1;
    return tile;
}

/* Labels of all tiles come first, since those of pixels around are looked at; then each thread has
 * as many tiles that show something as any other. */
static void shade_share(void *context, unsigned thread)
{
    const struct sharing *sharing = context;
    struct rendition *r = sharing->rendition;
    struct team *team = sharing->team;
    struct shading s = *sharing->shading;
    struct task task =
        task_begin_part(s.camera->scene->watch, "shading", (uint64_t)r->width * r->height, thread);
    const struct share rows = team_share(team, thread, r->tiles_y);
    take_fields(&s, &sharing->shader->store->part[thread]);
    label_tiles(r, rows.first * r->tiles_x, rows.end * r->tiles_x, &s);
    team_wait(team);
    const struct share tiles = team_share(team, thread, rendition_count(r, TILE_STALE));
    const size_t first = tile_after(r, tiles.first), end = tile_after(r, tiles.end);
    team_wait(team);
    shade_some(r, first, end, &s, &task);
    team_wait(team);
    draw_edges(r, first, end, &s);
}

/* To wake a thread takes as long as to shade some tiles. */
enum { TILES_SHARED = 128 };

enum err shade(struct rendition *r, const struct camera *camera, const struct border *border,
               const struct palette *palette, const struct look *look, struct shader *shader,
               struct fault *fault)
{
    struct shading s;
    struct team *team = rendition_count(r, TILE_STALE) < TILES_SHARED ? NULL : shader->team;
    struct sharing sharing = {r, &s, shader, team};
    enum err err = shader_prepare(shader, team_size(team), camera, border, look, fault);
    if (!err)
        err = rendition_refined(r, shade_refines(look, camera, border), fault);
    if (err)
        return err;
    shading_init(&s, camera, border, palette, look, shader);
    if (s.block > 1 && waits(r, &s))
        mark_blocks(r, s.block);
    team_run(team, shade_share, &sharing);
    return OK;
}

struct shade_reach shade_reach(const struct look *look, const struct camera *camera)
{
    /* One step in any case: a face may be cut open, or no more so; a surface belongs to the voxel
     * beside. */
    const int field = look->number > LOOK_FIRST ? NORMAL_REACH : FIELD_REACH;
    const int fit = look->mode == SHADE_DEPTH ? NORMAL_FIT_STEPS * (int)normal_stride(camera) : 0;
    const int depth = look_is_refined(look) ? REFINE_REACH : 1;
    const int label = look->number > LOOK_SECOND ? MEETING_REACH : 1;
    struct shade_reach reach = {.voxels = look->mode == SHADE_DEPTH ? depth : field,
                                .labels = look_is_refined(look) ? label : 0,
                                .pixels = fit};
    if (look->creases)
        reach.labels = field;
    if (look->ao_percent > 0 && occlusion_reach(camera->scene) > reach.voxels)
        reach.voxels = occlusion_reach(camera->scene);
    reach.layers = reach.voxels > NORMAL_REACH ? reach.voxels : NORMAL_REACH;
    if (draws_edges(look))
        reach.pixels += edge_reach(camera, look->samples);
    else if (look->edges && fit == 0)
        reach.pixels = 1;
    return reach;
}
