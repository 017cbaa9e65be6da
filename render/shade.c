/* SPDX-License-Identifier: MIT */
#include "render/shade.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "render/edge.h"
#include "render/light.h"
#include "render/occlusion.h"

enum { EDGE = LIGHT_UNIT * 35 / 100 }; /* part of a colour left by an edge */

void shader_release(struct shader *shader)
{
    if (shader->bricks)
        bricks_release(shader->bricks);
    free(shader->bricks);
    shader->bricks = NULL;
}

size_t shader_bytes(const struct shader *shader)
{
    return shader->bricks ? bricks_bytes(shader->bricks) : 0;
}

enum mesh_kind shade_kind(const struct look *look)
{
    return (look->mode == SHADE_CUBES ? MESH_CUBES : MESH_SMOOTH) |
           (look->creases ? MESH_APART : MESH_SMOOTH);
}

/* There is no occlusion with translucent objects. */
static bool occludes(const struct look *look, const struct border *border)
{
    return look->ao_percent > 0 && !border_is_translucent(border);
}

enum err shader_prepare(struct shader *shader, const struct border *border, const struct look *look,
                        struct fault *fault)
{
    if (!occludes(look, border))
        return OK;
    if (!shader->bricks)
        shader->bricks = mem_new(sizeof *shader->bricks);
    return shader->bricks ? bricks_update(shader->bricks, border, fault)
                          : fault_memory(fault, "shading");
}

struct shade_reach shade_reach(const struct look *look, const struct camera *camera)
{
    return (struct shade_reach){.voxels = look->ao_percent > 0 ? occlusion_reach(camera->scene) : 0,
                                .pixels = look->edges ? edge_reach(camera, look->samples) : 0};
}

/* ---- pixels ---- */

/* Everything that colours depend on except the pixel. */
struct shading {
    const struct camera *camera;
    const struct border *border;
    const struct look *look;
    const struct palette *palette;
    struct normals normals;
    struct light light;
    struct occluder occluder;
    bool occludes;     /* ambient light is occluded */
    bool has_pixels;   /* one sample may represent a pixel */
    int32_t window[2]; /* intensities shown as black and white on cut faces */
};

static void shading_init(struct shading *s, const struct camera *camera, const struct mesh *mesh,
                         const struct palette *palette, const struct look *look,
                         const struct shader *shader)
{
    *s = (struct shading){.camera = camera,
                          .border = mesh->border,
                          .look = look,
                          .palette = palette,
                          .occludes = occludes(look, mesh->border),
                          .window = {shader->window[0], shader->window[1]}};
    normals_init(&s->normals, camera, mesh);
    light_init(&s->light, camera, look->light, look->cue_percent);
    if (s->occludes)
        occluder_init(&s->occluder, shader->bricks, camera, look->ao_percent);
    s->has_pixels = look->samples > 1 && normal_stride(camera) >= look->samples;
}

/* Return true if the neighbour beyond a closed face, counted from 1, was cut away; otherwise the
 * scene ends there. */
static bool is_cut_open(const struct shading *s, uint32_t cell, unsigned open)
{
    const ptrdiff_t step = s->camera->scene->grid.step[(open - 1) / 2];
    return open && border_is_cut(s->border, cell + (uint32_t)((open - 1) & 1 ? step : -step));
}

/* The pixels of a tile that a thread shades at a time, and the results. */
struct tile_shading {
    const struct shading *s;
    struct triangles triangles;
    struct tile_pixels pixels;
    struct directions normals; /* the pixels' normals, */
    struct lit lit;            /* and their colours */
};

static void shade_pixels(struct tile_shading *t)
{
    const struct shading *s = t->s;
    const struct tile_pixels *p = &t->pixels;
    struct directions *normals = &t->normals;
    struct lit *lit = &t->lit;
    uint8_t open[NORMALISED];
    normals_of(normals, open, &s->normals, &t->triangles, p);
    for (unsigned i = 0; i < p->count; i++) {
        const int16_t normal[3] = {normals->along[0][i], normals->along[1][i],
                                   normals->along[2][i]};
        lit->cue[i] = (uint16_t)light_cue(&s->light, p->depth[i]);
        lit->open[i] = s->occludes
                           ? occluder_light(&s->occluder, normal, p->depth[i], p->x[i], p->y[i])
                           : LIGHT_UNIT;
        for (int k = 0; k < 3; k++)
            lit->colour[k][i] = s->palette->rgb[p->label[i]][k];
    }
    light_surfaces(lit, &s->light, normals);
    for (unsigned i = 0; i < p->count; i++) {
        if (!open[i] || !is_cut_open(s, p->cell[i], open[i]))
            continue;
        /* Shade the cut face of the scene equally from every side, so that it reads like a slice.
         * */
        const int64_t width = (int64_t)s->window[1] - s->window[0];
        const int64_t above = (int64_t)s->camera->scene->cell[p->cell[i]].intensity - s->window[0];
        const int64_t share = width ? above * 255 / width : 0;
        const int64_t grey = share < 0 ? 0 : share > 255 ? 255 : share;
        for (int k = 0; k < 3; k++) {
            const int64_t tinted = (3 * grey + s->palette->rgb[p->label[i]][k] + 2) / 4;
            lit->colour[k][i] = (uint8_t)(tinted * lit->cue[i] >> LIGHT_UNIT_BITS);
        }
    }
}

static inline void put_normal(struct rendition *r, size_t pixel, const struct directions *normals,
                              unsigned i)
{
    const int16_t normal[4] = {normals->along[0][i], normals->along[1][i], normals->along[2][i]};
    memcpy(r->normal + 4 * pixel, normal, sizeof normal);
}

/* ---- tiles ---- */

/* Set the labels of a tile, and clear its empty pixels. */
static void label_tile(struct rendition *r, const struct border *border, struct tile_bounds tile)
{
    uint32_t last = CELL_NONE;
    uint8_t label = 0;
    for (uint32_t y = tile.top; y < tile.bottom; y++)
        for (uint32_t x = tile.left; x < tile.right; x++) {
            const size_t pixel = (size_t)y * r->width + x;
            const uint32_t cell = r->cell[pixel];
            if (cell != last)
                label = cell == CELL_NONE ? 0 : labels_at(&border->labels, cell);
            last = cell;
            r->label[pixel] = label;
            if (cell == CELL_NONE)
                rendition_empty(r, pixel, 1);
        }
}

/* Return true if a tile is empty. */
static bool is_bare(const struct rendition *r, struct tile_bounds tile)
{
    uint32_t all = CELL_NONE; /* all bits set */
    for (uint32_t y = tile.top; y < tile.bottom; y++) {
        const uint32_t *cell = r->cell + (size_t)y * r->width + tile.left;
        for (uint32_t x = 0; x < tile.right - tile.left; x++)
            all &= cell[x];
    }
    return all == CELL_NONE;
}

/* Labels of layers are set when they are blended. */
static void label_tiles(struct rendition *r, size_t first, size_t end, const struct shading *s)
{
    for (size_t i = first; rendition_tile(r, &i, end, TILE_STALE); i++) {
        const struct tile_bounds tile = rendition_bounds(r, i);
        const bool bare = r->layers ? layers_are_none(r->layers, tile) : is_bare(r, tile);
        if (bare && !r->blank[i])
            for (uint32_t y = tile.top; y < tile.bottom; y++)
                rendition_empty(r, (size_t)y * r->width + tile.left, tile.right - tile.left);
        r->blank[i] = bare;
        if (bare)
            r->stale[i] = TILE_EMPTY;
        else if (!r->layers)
            label_tile(r, s->border, tile);
    }
}

static void shade_mask(struct rendition *r, struct tile_shading *t, struct tile_bounds tile,
                       tile_mask mask)
{
    const struct tile_pixels *p = &t->pixels;
    const struct lit *lit = &t->lit;
    /* Collect the pixels of the mask that show something. */
    const tile_mask wide = (1u << (tile.right - tile.left)) - 1;
    t->pixels.count = 0;
    for (uint32_t y = tile.top; y < tile.bottom; y++, mask >>= TILE)
        for (tile_mask row = mask & wide; row; row &= row - 1) {
            const uint32_t x = tile.left + (uint32_t)__builtin_ctzll(row);
            const size_t pixel = (size_t)y * r->width + x;
            if (r->cell[pixel] == CELL_NONE)
                continue;
            t->pixels.x[t->pixels.count] = x;
            t->pixels.y[t->pixels.count] = y;
            t->pixels.depth[t->pixels.count] = r->depth[pixel];
            t->pixels.cell[t->pixels.count] = r->cell[pixel];
            t->pixels.label[t->pixels.count++] = r->label[pixel];
        }
    if (p->count == 0)
        return;
    shade_pixels(t);
    for (unsigned i = 0; i < p->count; i++) {
        const size_t pixel = (size_t)p->y[i] * r->width + p->x[i];
        const uint8_t rgba[4] = {lit->colour[0][i], lit->colour[1][i], lit->colour[2][i], 255};
        memcpy(r->rgba + 4 * pixel, rgba, sizeof rgba);
        put_normal(r, pixel, &t->normals, i);
    }
}

/* ---- samples ---- */

/* Return true if all samples of a pixel show one object with a slope of at most 4: one of them is
 * shaded for all. */
static bool is_one(const struct rendition *r, size_t first, uint32_t samples)
{
    int64_t near = INT64_MAX, far = INT64_MIN;
    for (uint32_t y = 0; y < samples; y++)
        for (uint32_t x = 0; x < samples; x++) {
            const size_t at = first + (size_t)y * r->width + x;
            if (r->cell[at] == CELL_NONE || r->label[at] != r->label[first])
                return false;
            near = r->depth[at] < near ? r->depth[at] : near;
            far = r->depth[at] > far ? r->depth[at] : far;
        }
    return (far - near) >> CROSSING_PIXEL_BITS < 4 * (int64_t)samples;
}

/* Shade a tile of samples; for pixels that show one surface, only the sample after the middle. Cut
 * faces show voxels, which are no smaller than pixels here. */
static void shade_samples(struct rendition *r, struct tile_shading *t, struct tile_bounds tile)
{
    const uint32_t samples = t->s->look->samples, half = samples / 2;
    tile_mask all = ~(tile_mask)0, one = 0; /* samples to shade; samples that represent a pixel */
    tile_mask box = 0;
    for (uint32_t y = 0; y < samples; y++)
        box |= (((tile_mask)1 << samples) - 1) << (y * TILE);
    for (uint32_t y = 0; y + samples <= tile.bottom - tile.top; y += samples)
        for (uint32_t x = 0; x + samples <= tile.right - tile.left; x += samples) {
            const size_t first = (size_t)(tile.top + y) * r->width + tile.left + x;
            if (!is_one(r, first, samples))
                continue;
            const unsigned bit = (y + half) * TILE + x + half;
            all &= ~(box << (y * TILE + x));
            one |= (tile_mask)1 << bit;
        }
    shade_mask(r, t, tile, all | one);
    for (; one; one &= one - 1) {
        const unsigned bit = (unsigned)__builtin_ctzll(one);
        const uint32_t x = tile.left + bit % TILE, y = tile.top + bit / TILE;
        /* Copy the colour and normal of the sample to all samples of its pixel. */
        const size_t from = (size_t)y * r->width + x;
        const size_t first = from - half * ((size_t)r->width + 1);
        uint8_t rgba[4];
        int16_t normal[4];
        memcpy(rgba, r->rgba + 4 * from, sizeof rgba);
        memcpy(normal, r->normal + 4 * from, sizeof normal);
        for (uint32_t j = 0; j < samples; j++)
            for (uint32_t i = 0; i < samples; i++) {
                const size_t at = first + (size_t)j * r->width + i;
                memcpy(r->rgba + 4 * at, rgba, sizeof rgba);
                memcpy(r->normal + 4 * at, normal, sizeof normal);
            }
    }
}

/* Shade all layers of a tile's pixels. */
static void blend_tile(struct rendition *r, struct tile_shading *t, struct tile_bounds tile)
{
    const struct tile_pixels *p = &t->pixels;
    const struct lit *lit = &t->lit;
    struct blend blend;
    blend_begin(&blend, r, t->s->border, tile);
    while (blend_next(&blend, r, &t->pixels)) {
        shade_pixels(t);
        for (unsigned i = 0; i < p->count; i++) {
            const size_t pixel = (size_t)p->y[i] * r->width + p->x[i];
            const uint8_t rgb[3] = {lit->colour[0][i], lit->colour[1][i], lit->colour[2][i]};
            if (blend_add(&blend, i, rgb))
                put_normal(r, pixel, &t->normals, i);
        }
    }
    blend_end(&blend, r);
}

static void shade_tiles(struct rendition *r, size_t first, size_t end, const struct shading *s,
                        struct task *task)
{
    struct tile_shading t;
    t.s = s;
    triangles_init(&t.triangles);
    memset(&t.lit, 0, sizeof t.lit);
    for (size_t i = first;
         rendition_tile(r, &i, end, TILE_STALE) && task_advance(task, TILE * TILE); i++) {
        const struct tile_bounds tile = rendition_bounds(r, i);
        if (r->layers)
            blend_tile(r, &t, tile);
        else if (s->has_pixels)
            shade_samples(r, &t, tile);
        else
            shade_mask(r, &t, tile, ~(tile_mask)0);
        r->stale[i] = s->look->edges ? TILE_LIT : TILE_SHADED;
    }
}

/* Edges depend on normals of nearby pixels, so they are drawn after shading. */
static void draw_edges(struct rendition *r, size_t first, size_t end, const struct shading *s)
{
    struct edges edges;
    edges_init(&edges, r, s->camera, s->look->samples);
    for (size_t i = first; rendition_tile(r, &i, end, TILE_LIT); i++) {
        const struct tile_bounds tile = rendition_bounds(r, i);
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

/* ---- pictures ---- */

void shade_rows(struct rendition *r, const struct camera *camera, const struct mesh *mesh,
                const struct palette *palette, const struct look *look, const struct shader *shader)
{
    struct shading s;
    struct task task = task_begin_part(camera->scene->watch, NULL, 0, 1);
    const size_t all = (size_t)r->tiles_x * r->tiles_y;
    shading_init(&s, camera, mesh, palette, look, shader);
    label_tiles(r, 0, all, &s);
    shade_tiles(r, 0, all, &s, &task);
}

void shade_edges(struct rendition *r, uint32_t first, uint32_t end, const struct camera *camera,
                 const struct palette *palette, const struct look *look)
{
    const struct shading s = {.camera = camera, .palette = palette, .look = look};
    draw_edges(r, (size_t)first * r->tiles_x, (size_t)end * r->tiles_x, &s);
}

struct sharing {
    struct rendition *rendition;
    const struct shading *shading;
    struct team *team;
};

/* Return the tile after the first `stale` stale ones. */
static size_t tile_after(const struct rendition *r, size_t stale)
{
    const size_t all = (size_t)r->tiles_x * r->tiles_y;
    size_t tile = 0;
    for (; stale > 0 && rendition_tile(r, &tile, all, TILE_STALE); stale--)
        tile++;
    return tile;
}

/* Set the labels of all tiles first, since they are read across tiles; then divide the non-empty
 * tiles equally among threads. */
static void shade_share(void *context, unsigned thread)
{
    const struct sharing *sharing = context;
    struct rendition *r = sharing->rendition;
    struct team *team = sharing->team;
    const struct shading *s = sharing->shading;
    struct task task =
        task_begin_part(s->camera->scene->watch, "shading", (uint64_t)r->width * r->height, thread);
    const struct share rows = team_share(team, thread, r->tiles_y);
    label_tiles(r, rows.first * r->tiles_x, rows.end * r->tiles_x, s);
    team_wait(team);
    const struct share tiles = team_share(team, thread, rendition_count(r, TILE_STALE));
    const size_t first = tile_after(r, tiles.first), end = tile_after(r, tiles.end);
    team_wait(team);
    shade_tiles(r, first, end, s, &task);
    team_wait(team);
    draw_edges(r, first, end, s);
}

/* Waking a thread costs as much as shading some tiles. */
enum { TILES_SHARED = 128 };

enum err shade(struct rendition *r, const struct camera *camera, const struct mesh *mesh,
               const struct palette *palette, const struct look *look, struct shader *shader,
               struct fault *fault)
{
    struct shading s;
    struct team *team = rendition_count(r, TILE_STALE) < TILES_SHARED ? NULL : shader->team;
    struct sharing sharing = {r, &s, team};
    TRY(shader_prepare(shader, mesh->border, look, fault));
    shading_init(&s, camera, mesh, palette, look, shader);
    team_run(team, shade_share, &sharing);
    return OK;
}
