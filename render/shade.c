#include "render/shade.h"

#include <string.h>

#include "render/edge.h"
#include "render/layers.h"
#include "render/light.h"
#include "render/meeting.h"
#include "render/normal.h"
#include "render/patch.h"
#include "render/refine.h"

enum {
    EDGE = LIGHT_UNIT * 35 / 100, /* what an edge leaves of a colour */
    STAIRS_SEEN = 4,              /* pixels to a voxel, from which on faces of voxels are stairs */
};

struct look look_default(uint32_t number)
{
    return (struct look){
        .number = number, .light = {-25000, 30000}, .cue_percent = 30, .samples = 1};
}

void shader_release(struct shader *shader)
{
    for (int i = 0; i < TEAM_MOST; i++) {
        field_release(&shader->part[i].shown);
        field_release(&shader->part[i].scene);
        shader->part[i] = (struct shader_part){0};
    }
    seams_release(&shader->seams);
    bricks_release(&shader->bricks);
}

size_t shader_bytes(const struct shader *shader)
{
    size_t bytes = seams_bytes(&shader->seams) + bricks_bytes(&shader->bricks);
    for (int i = 0; i < TEAM_MOST; i++)
        bytes += field_bytes(&shader->part[i].shown) + field_bytes(&shader->part[i].scene);
    return bytes;
}

/* ---- pixels ---- */

/* All that colours depend on besides the pixel. */
struct shading {
    const struct camera *camera;
    const struct border *border;
    const struct look *look;
    const struct palette *palette;
    struct refiner refiner; /* where the rendition is refined */
    bool has_patches;       /* with patches */
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
    return rendition_is_refined(r) ||
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

/* What depth, and an edge of look 1, leave of a colour. */
static uint16_t cue_of(const struct rendition *r, const struct shading *s, uint32_t x, uint32_t y)
{
    const int64_t cue = light_cue(&s->light, r->depth[(size_t)y * r->width + x]);
    if (s->look->edges && !draws_edges(s->look) && !r->layers && edge_hides(r, x, y))
        return (uint16_t)(cue * EDGE >> LIGHT_UNIT_BITS);
    return (uint16_t)cue;
}

static void occlude_pixels(struct lit *lit, const struct rendition *r, const struct shading *s,
                           const struct tile_pixels *pixels, const struct directions *normals)
{
    for (unsigned i = 0; i < pixels->count; i++) {
        const uint32_t x = pixels->x[i], y = pixels->y[i];
        const int16_t normal[3] = {normals->along[0][i], normals->along[1][i],
                                   normals->along[2][i]};
        lit->open[i] =
            occluder_leaves(&s->occluder, normal, r->depth[(size_t)y * r->width + x], x, y);
    }
}

/* Normals of pixels, of which those from `known` on have theirs. */
static void take_normals(struct directions *normals, const struct rendition *r, struct shading *s,
                         struct tile_pixels *pixels, unsigned known)
{
    const unsigned all = pixels->count;
    pixels->count = known;
    if (known > 0)
        normals_of(normals, &s->normals, r, pixels);
    pixels->count = all;
    for (unsigned i = known; i < all; i++)
        for (unsigned a = 0; a < 3; a++)
            normals->along[a][i] =
                r->normal[4 * ((size_t)pixels->y[i] * r->width + pixels->x[i]) + a];
}

/* Pixels that show something; those from `known` on have their normals. */
static void shade_pixels(struct rendition *r, struct shading *s, struct tile_pixels *pixels,
                         unsigned known)
{
    struct directions normals;
    struct lit lit = {0};
    take_normals(&normals, r, s, pixels, known);
    for (unsigned i = 0; i < pixels->count; i++) {
        const size_t pixel = (size_t)pixels->y[i] * r->width + pixels->x[i];
        lit.cue[i] = cue_of(r, s, pixels->x[i], pixels->y[i]);
        lit.open[i] = LIGHT_UNIT;
        for (int k = 0; k < 3; k++)
            lit.colour[k][i] = s->palette->rgb[r->label[pixel]][k];
    }
    if (s->occludes)
        occlude_pixels(&lit, r, s, pixels, &normals);
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

static void draw_edge(struct rendition *r, const struct edges *edges, const struct palette *palette,
                      uint32_t x, uint32_t y)
{
    const size_t pixel = (size_t)y * r->width + x;
    const enum edge edge = edge_at(edges, x, y);
    uint8_t *rgba = r->rgba + 4 * pixel;
    for (int k = 0; k < 3 && edge; k++)
        rgba[k] = edge == EDGE_LIGHT ? (uint8_t)((palette->rgb[r->label[pixel]][k] + 255) / 2)
                                     : (uint8_t)(rgba[k] * EDGE >> LIGHT_UNIT_BITS);
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

/* Voxels beside each other in a picture lie far apart in memory. */
static void fetch_cells(const struct rendition *r, const struct scene *scene, struct tile tile)
{
    uint32_t last = CELL_NONE;
    for (uint32_t y = tile.top; y < tile.bottom; y++)
        for (uint32_t x = tile.left; x < tile.right; x++) {
            const uint32_t cell = r->cell[(size_t)y * r->width + x];
            if (cell != CELL_NONE && cell != last)
                __builtin_prefetch(scene->cell + cell);
            last = cell;
        }
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
    fetch_cells(r, labels->scene, tile);
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

static void darken(uint8_t rgba[4])
{
    for (int k = 0; k < 3; k++)
        rgba[k] = (uint8_t)(rgba[k] * EDGE >> LIGHT_UNIT_BITS);
}

static void take_pixels(struct tile_pixels *pixels, const struct rendition *r, struct tile tile,
                        tile_mask mask)
{
    for (uint32_t y = tile.top; y < tile.bottom; y++)
        for (uint32_t x = tile.left; x < tile.right; x++)
            if (mask >> ((y - tile.top) * TILE + x - tile.left) & 1 &&
                r->cell[(size_t)y * r->width + x] != CELL_NONE) {
                pixels->x[pixels->count] = x;
                pixels->y[pixels->count++] = y;
            }
}

/* The pixels of a mask have their normals. */
static void shade_tile(struct rendition *r, struct shading *s, struct tile tile,
                       tile_mask has_normal)
{
    struct tile_pixels pixels;
    pixels.count = 0;
    take_pixels(&pixels, r, tile, ~has_normal);
    const unsigned known = pixels.count;
    take_pixels(&pixels, r, tile, has_normal);
    if (pixels.count)
        shade_pixels(r, s, &pixels, known);
}

/* Whether no ray of a tile comes to a cube. */
static bool is_bare(const struct rendition *r, struct tile tile)
{
    for (uint32_t y = tile.top; y < tile.bottom; y++)
        for (uint32_t x = tile.left; x < tile.right; x++)
            if (r->cube.cell[(size_t)y * r->width + x] != CELL_NONE)
                return false;
    return true;
}

/* Nothing is seen of such a tile. */
static void empty_tile(struct rendition *r, struct tile tile)
{
    for (uint32_t y = tile.top; y < tile.bottom; y++)
        rendition_empty(r, (size_t)y * r->width + tile.left, tile.right - tile.left);
}

/* Which pixels have their normals then. */
static tile_mask refine_tile(struct rendition *r, struct shading *s, struct tile tile)
{
    if (s->has_patches && tile.right - tile.left == TILE && tile.bottom - tile.top == TILE)
        return patches_refine(r, &s->refiner, &s->normals, tile.left, tile.top);
    for (uint32_t y = tile.top; y < tile.bottom; y++)
        for (uint32_t x = tile.left; x < tile.right; x++)
            refine_pixel(r, &s->refiner, x, y);
    return 0;
}

/* Where objects are translucent: layer by layer, from the nearest on. Edges are those of the layers
 * that count. */
static void blend_tile(struct rendition *r, struct shading *s, struct tile tile)
{
    struct blend blend;
    blend_begin(&blend, r, s->border, footprint_of(tile));
    while (blend_next(&blend)) {
        shade_tile(&r->layers->pass, s, tile, 0);
        blend_add(&blend, r);
    }
    blend_end(&blend, r);
    const bool has_edges = s->look->edges && !draws_edges(s->look);
    for (uint32_t y = tile.top; has_edges && y < tile.bottom; y++)
        for (uint32_t x = tile.left; x < tile.right; x++)
            if (edge_hides(r, x, y))
                darken(r->rgba + 4 * ((size_t)y * r->width + x));
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

/* Tiles have numbers, row by row: those from `first` to before `end`. */
static void label_tiles(struct rendition *r, size_t first, size_t end, struct shading *s)
{
    for (size_t i = rendition_tile(r, first, end, TILE_STALE); i < end;
         i = rendition_tile(r, i + 1, end, TILE_STALE)) {
        const struct tile tile = tile_at(r, i);
        const bool bare = rendition_is_refined(r) && is_bare(r, tile);
        if (bare)
            empty_tile(r, tile);
        else if (waits(r, s))
            continue;
        else if (rendition_is_refined(r))
            refine_tile(r, s, tile);
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
        tile_mask has_normal = 0;
        if (waits(r, s)) {
            has_normal = refine_tile(r, s, tile);
            label_tile(r, s->border, tile);
        }
        if (r->layers)
            blend_tile(r, s, tile);
        else
            shade_tile(r, s, tile, has_normal);
        r->stale[i] = (uint8_t)next;
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
            for (uint32_t x = tile.left; x < tile.right; x++)
                if (r->cell[(size_t)y * r->width + x] != CELL_NONE)
                    draw_edge(r, &edges, s->palette, x, y);
        r->stale[i] = TILE_SHADED;
    }
}

/* Depths are those of the layers that count, and say nothing of the others. */
static enum shade_mode mode_of(const struct look *look, const struct border *border)
{
    const bool knows_depths = !border_is_translucent(border);
    return look->mode == SHADE_DEPTH && !knows_depths ? SHADE_SURFACE : look->mode;
}

/* ---- fields and bricks ---- */

/* Translucent objects let the light in. */
static bool occludes(const struct look *look, const struct border *border)
{
    return look->ao_percent > 0 && !border_is_translucent(border);
}

static enum err prepare(struct field *field, bool *has, const struct border *border,
                        enum field_kind kind, unsigned threads, struct fault *fault)
{
    if (*has && field->kind == kind && field_fits(field, border, threads))
        return OK;
    if (*has)
        field_release(field);
    const enum err err = field_init(field, border, kind, threads, fault);
    *has = err == OK;
    return err;
}

enum err shader_prepare(struct shader *shader, unsigned threads, const struct border *border,
                        const struct look *look, struct fault *fault)
{
    const enum shade_mode mode = mode_of(look, border);
    const bool is_refined = shade_refines(look, border);
    const unsigned most = team_size(shader->team);
    enum err err = OK;
    for (unsigned i = 0; i < threads && !err; i++) {
        struct shader_part *part = shader->part + i;
        if (is_refined)
            err = prepare(&part->shown, &part->has_shown, border, FIELD_SURFACE, most, fault);
        else if (mode != SHADE_DEPTH)
            err = prepare(&part->shown, &part->has_shown, border, FIELD_SHOWN, most, fault);
        part->shown.seams = &shader->seams;
        if (!err && mode == SHADE_SCENE)
            err = prepare(&part->scene, &part->has_scene, border, FIELD_SCENE, most, fault);
    }
    if (!err && look->creases)
        err = seams_count(&shader->seams, border, fault);
    return !err && occludes(look, border) ? bricks_take(&shader->bricks, border, fault) : err;
}

/* ---- pictures ---- */

static void shading_init(struct shading *s, const struct camera *camera,
                         const struct border *border, const struct palette *palette,
                         const struct look *look, struct shader *shader)
{
    *s = (struct shading){.camera = camera,
                          .border = border,
                          .look = look,
                          .palette = palette,
                          .occludes = occludes(look, border),
                          .cuts = !cut_is_none(&border->cut),
                          .window = {shader->window[0], shader->window[1]}};
    light_init(&s->light, camera, look->light, look->cue_percent);
    if (look_is_refined(look))
        refiner_init(&s->refiner, camera, border);
    s->refiner.is_close = look->number > LOOK_SECOND;
    s->refiner.meets = look->number > LOOK_SECOND && normal_stride(camera) >= STAIRS_SEEN;
    if (s->occludes)
        occluder_init(&s->occluder, &shader->bricks, camera, look->ao_percent);
    s->has_patches = look->number > LOOK_SECOND && !looks_around(look);
}

/* The fields of a thread are its own. */
static void take_fields(struct shading *s, struct shader_part *part)
{
    normals_init(&s->normals, s->camera, mode_of(s->look, s->border), s->look->number > LOOK_FIRST,
                 &part->shown, &part->scene);
    s->normals.creases = s->look->creases;
    s->refiner.shown.field = &part->shown;
}

void shade_rows(struct rendition *r, uint32_t first, uint32_t end, const struct camera *camera,
                const struct border *border, const struct palette *palette, const struct look *look,
                struct shader *shader, unsigned number)
{
    struct shading s;
    struct task task = task_begin_part(camera->scene->watch, NULL, 0, 1);
    const size_t all = (size_t)r->tiles_x * r->tiles_y;
    shading_init(&s, camera, border, palette, look, shader);
    take_fields(&s, &shader->part[number]);
    label_tiles(r, 0, all, &s);
    if (draws_edges(look)) /* which look at rows around */
        shade_tiles(r, 0, all, &s, &task);
    else
        shade_tiles(r, (size_t)first * r->tiles_x, (size_t)end * r->tiles_x, &s, &task);
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
    take_fields(&s, &sharing->shader->part[thread]);
    label_tiles(r, rows.first * r->tiles_x, rows.end * r->tiles_x, &s);
    team_wait(team);
    const struct share tiles = team_share(team, thread, rendition_count(r, TILE_STALE));
    const size_t first = tile_after(r, tiles.first), end = tile_after(r, tiles.end);
    team_wait(team);
    shade_tiles(r, first, end, &s, &task);
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
    enum err err = shader_prepare(shader, team_size(team), border, look, fault);
    if (!err)
        err = rendition_refined(r, shade_refines(look, border), fault);
    if (err)
        return err;
    shading_init(&s, camera, border, palette, look, shader);
    team_run(team, shade_share, &sharing);
    return OK;
}

bool look_is_refined(const struct look *look)
{
    return look->number > LOOK_FIRST && look->mode != SHADE_CUBES;
}

bool shade_refines(const struct look *look, const struct border *border)
{
    return look_is_refined(look) && border->has_skin && !border_is_translucent(border);
}

struct shade_reach shade_reach(const struct look *look, const struct camera *camera)
{
    /* One step in any case: a face may be cut open, or no more so; a surface belongs to the voxel
     * beside. */
    const int field = look->number > LOOK_FIRST ? NORMAL_REACH : FIELD_REACH;
    const int fit = look->mode == SHADE_DEPTH ? NORMAL_FIT_STEPS * (int)normal_stride(camera) : 0;
    const int depth = look_is_refined(look) ? REFINE_REACH : 1;
    const int label = look->number > LOOK_SECOND ? MEETING_REACH : 1;
    struct shade_reach reach = {look->mode == SHADE_DEPTH ? depth : field,
                                look_is_refined(look) ? label : 0, fit};
    if (look->creases)
        reach.labels = field;
    if (look->ao_percent > 0 && occlusion_reach(camera->scene) > reach.voxels)
        reach.voxels = occlusion_reach(camera->scene);
    if (draws_edges(look))
        reach.pixels += edge_reach(camera, look->samples);
    else if (look->edges && fit == 0)
        reach.pixels = 1;
    return reach;
}
