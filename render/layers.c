#include "render/layers.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "render/seams.h"
#include "render/sweep.h"
#include "render/walk.h"

/* ---- memory ---- */

enum { SQUARES = 255 * 255 + 1 };

void layers_release(struct layers *l)
{
    rendition_release(&l->pass);
    free(l->last_depth);
    free(l->last_cell);
    free(l->last_label);
    free(l->count);
    free(l->depth);
    free(l->cell);
    free(l->label);
    free(l->root);
    *l = (struct layers){0};
}

size_t layers_bytes(const struct layers *l)
{
    const size_t one = sizeof *l->depth + sizeof *l->cell + sizeof *l->label;
    const size_t a_pixel = sizeof *l->count + (LAYERS_MOST + 1) * one;
    return rendition_bytes(&l->pass) + (size_t)l->width * l->height * a_pixel +
           (l->root ? SQUARES : 0);
}

static enum err make_room(struct layers *l, uint32_t width, uint32_t height, struct fault *fault)
{
    const size_t pixels = (size_t)width * height;
    if (l->width == width && l->height == height)
        return OK;
    layers_release(l);
    const enum err err = rendition_init(&l->pass, width, height, fault);
    l->last_depth = mem_array(pixels, sizeof *l->last_depth);
    l->last_cell = mem_array(pixels, sizeof *l->last_cell);
    l->last_label = mem_array(pixels, sizeof *l->last_label);
    l->count = mem_array(pixels, sizeof *l->count);
    l->depth = mem_array(pixels, LAYERS_MOST * sizeof *l->depth);
    l->cell = mem_array(pixels, LAYERS_MOST * sizeof *l->cell);
    l->label = mem_array(pixels, LAYERS_MOST * sizeof *l->label);
    l->root = mem_array(SQUARES, 1);
    if (err || !l->last_depth || !l->last_cell || !l->last_label || !l->count || !l->depth ||
        !l->cell || !l->label || !l->root) {
        layers_release(l);
        return err ? err : fault_memory(fault, "translucent objects");
    }
    l->width = width;
    l->height = height;
    /* Those of level^2 - level + 1 to level^2 + level are nearest to the level. */
    for (uint32_t square = 0, level = 0; square < SQUARES; square++) {
        level += square > level * level + level;
        l->root[square] = (uint8_t)level;
    }
    return OK;
}

enum err layers_take(struct layers *l, struct rendition *r, const struct border *border,
                     struct seams *seams, bool are_refined, struct fault *fault)
{
    r->layers = NULL;
    if (!border_is_translucent(border))
        return OK;
    enum err err = make_room(l, r->width, r->height, fault);
    if (!err)
        err = seams_count(seams, border, fault);
    l->seams = seams;
    l->are_refined = are_refined && border->has_skin;
    if (!err)
        r->layers = l->pass.layers = l;
    return err;
}

struct layers layers_rows(const struct layers *l, uint32_t top)
{
    const size_t first = (size_t)top * l->width;
    struct layers rows = *l;
    rows.last_depth += first;
    rows.last_cell += first;
    rows.last_label += first;
    rows.count += first;
    rows.depth += LAYERS_MOST * first;
    rows.cell += LAYERS_MOST * first;
    rows.label += LAYERS_MOST * first;
    return rows;
}

void layers_put_none(struct layers *l, size_t pixel)
{
    l->last_depth[pixel] = DEPTH_NONE;
    l->last_cell[pixel] = CELL_NONE;
    l->last_label[pixel] = 0;
    l->count[pixel] = 0;
}

void layers_clear(struct rendition *r)
{
    rendition_clear(r);
    for (size_t pixel = 0; pixel < (size_t)r->width * r->height; pixel++)
        layers_put_none(r->layers, pixel);
}

/* ---- layers of a pixel ---- */

static void put_last(struct layers *l, size_t pixel, int64_t depth, uint32_t cell, uint8_t label)
{
    l->last_depth[pixel] = depth;
    l->last_cell[pixel] = cell;
    l->last_label[pixel] = label;
}

/* Among the translucent ones, which are in order of depth, and stay so. */
static void put_among(struct layers *l, size_t pixel, int64_t depth, uint32_t cell, uint8_t label)
{
    const size_t first = pixel * LAYERS_MOST;
    size_t n = l->count[pixel];
    if (n == LAYERS_MOST && l->depth[first + --n] < depth)
        return;
    l->count[pixel] = (uint8_t)(n + 1);
    for (; n > 0 && l->depth[first + n - 1] > depth; n--) {
        l->depth[first + n] = l->depth[first + n - 1];
        l->cell[first + n] = l->cell[first + n - 1];
        l->label[first + n] = l->label[first + n - 1];
    }
    l->depth[first + n] = depth;
    l->cell[first + n] = cell;
    l->label[first + n] = label;
}

void layers_put(struct layers *l, size_t pixel, int64_t depth, uint32_t cell, uint8_t label,
                bool is_opaque)
{
    if (!is_opaque)
        put_among(l, pixel, depth, cell, label);
    else if (depth < l->last_depth[pixel])
        put_last(l, pixel, depth, cell, label);
}

/* ---- the ray walk: what layers are ---- */

/* Labels of the cubes that a ray has been in, the latest in the lowest byte. */
static bool is_recent(uint64_t labels, uint8_t label)
{
    for (int i = 0; i <= LAYERS_GAP; i++, labels >>= 8)
        if ((uint8_t)labels == label)
            return true;
    return false;
}

void layers_walk(struct layers *l, const struct camera *camera, const struct border *border,
                 size_t pixel)
{
    struct walk walk;
    uint64_t before = 0;
    const uint32_t column = (uint32_t)(pixel % l->width), row = (uint32_t)(pixel / l->width);
    layers_put_none(l, pixel);
    if (!walk_begin(&walk, camera, 0, column, row, INT64_MIN))
        return;
    do {
        const uint8_t label =
            border_shows(border, walk.cell) ? labels_at(&border->labels, walk.cell) : 0;
        if (label && border->opacity[label] == BORDER_OPAQUE) {
            put_last(l, pixel, walk.at, walk.cell, label);
            return;
        }
        if (label && label != (uint8_t)before && !is_recent(before, label))
            put_among(l, pixel, walk.at, walk.cell, label);
        before = before << 8 | label;
    } while (walk_on(&walk));
}

/* ---- splatting ---- */

/* Some near faces of a cube, each of which begins a run. */
struct faces {
    uint32_t cell;
    unsigned axes; /* bit a: the one across axis a */
    uint8_t label;
};

/* Whether the ray of a pixel, before it comes into a cube with these near crossings, was in one of
 * the label at most LAYERS_GAP cubes before. */
static bool is_near_run(const struct layers *l, const struct camera *camera,
                        const struct border *border, const struct faces *faces,
                        const int64_t crossing[3], int32_t x, int32_t y)
{
    int64_t near[3] = {crossing[0], crossing[1], crossing[2]};
    uint32_t cell = faces->cell;
    for (int i = 0; i <= LAYERS_GAP; i++) {
        int a = near[0] > near[1] ? 0 : 1;
        a = near[a] > near[2] ? a : 2;
        near[a] -= camera->T[a];
        if (near[a] < camera_crossing(camera, a, 0, x, y))
            return false;
        cell += (uint32_t)camera->toward[a];
        if (border_shows(border, cell) && seams_label(l->seams, cell) == faces->label)
            return true;
    }
    return false;
}

static void splat_faces(struct layers *l, struct sweep *sweep, const struct border *border,
                        struct faces faces)
{
    const struct camera *camera = sweep->camera;
    const bool is_opaque = border->opacity[faces.label] == BORDER_OPAQUE;
    const int64_t *T = camera->T, *A = camera->A, *B = camera->B;
    int64_t near[3];
    const struct footprint f = sweep_to(sweep, faces.cell, faces.axes, near);
    for (int32_t y = f.top; y <= f.bottom; y++) {
        int64_t near0 = near[0] + f.left * A[0] + y * B[0];
        int64_t near1 = near[1] + f.left * A[1] + y * B[1];
        int64_t near2 = near[2] + f.left * A[2] + y * B[2];
        size_t pixel = (size_t)y * l->width + (size_t)f.left;
        for (int32_t x = f.left; x <= f.right; x++, pixel++) {
            const int64_t first = most_of(near0, near1, near2);
            if (first < l->last_depth[pixel] &&
                first < least_of(near0 + T[0], near1 + T[1], near2 + T[2]) &&
                faces.axes >> (first & 3) & 1 &&
                (is_opaque || !is_near_run(l, camera, border, &faces,
                                           (const int64_t[]){near0, near1, near2}, x, y)))
                layers_put(l, pixel, first, faces.cell, faces.label, is_opaque);
            near0 += A[0], near1 += A[1], near2 += A[2];
        }
    }
}

void layers_splat_scene(struct rendition *r, const struct camera *camera,
                        const struct border *border)
{
    struct sweep sweep;
    sweep_init(&sweep, camera);
    layers_clear(r);
    struct task task = task_begin(border->scene->watch, "rendition", border->scene->grid.cells);
    for (size_t w = 0; w < border->words && task_advance(&task, 64); w++)
        for (uint64_t word = border->shown[w]; word; word &= word - 1) {
            const uint32_t cell = (uint32_t)(w * 64) + (uint32_t)__builtin_ctzll(word);
            const uint8_t label = labels_at(&border->labels, cell);
            /* The near faces that begin a run, by the labels on both sides. */
            unsigned axes = 0;
            for (int a = 0; a < 3; a++) {
                const uint32_t before = cell + (uint32_t)camera->toward[a];
                const bool goes_on =
                    border_shows(border, before) && labels_at(&border->labels, before) == label;
                axes |= (unsigned)!goes_on << a;
            }
            if (axes)
                splat_faces(r->layers, &sweep, border, (struct faces){cell, axes, label});
        }
}

static void splat_word(struct rendition *r, struct sweep *sweep, const struct border *border,
                       size_t w)
{
    const struct layers *l = r->layers;
    uint64_t begins[3];
    for (int a = 0; a < 3; a++) {
        const ptrdiff_t step = sweep->camera->toward[a];
        begins[a] = ~border_shown_from(border, (ptrdiff_t)w * 64 + step) |
                    seams_toward(l->seams, w, a, step);
    }
    for (uint64_t word = border->shown[w] & (begins[0] | begins[1] | begins[2]); word;) {
        for (uint64_t row = sweep_take_row(sweep, w, &word); row; row &= row - 1) {
            const unsigned bit = (unsigned)__builtin_ctzll(row);
            const uint32_t cell = (uint32_t)(w * 64) + bit;
            const uint64_t axes =
                (begins[0] >> bit & 1) | (begins[1] >> bit & 1) << 1 | (begins[2] >> bit & 1) << 2;
            splat_faces(r->layers, sweep, border,
                        (struct faces){cell, (unsigned)axes, seams_label(l->seams, cell)});
        }
    }
}

void layers_splat_border(struct task *task, struct rendition *r, const struct camera *camera,
                         const struct border *border)
{
    struct sweep sweep;
    sweep_init(&sweep, camera);
    layers_clear(r);
    for (size_t i = 0; i < border->words && task_advance(task, 64); i++) {
        const size_t w = camera->flip[2] ? border->words - 1 - i : i;
        if (border->shown[w])
            splat_word(r, &sweep, border, w);
    }
}

/* ---- the incremental image ---- */

enum { TO_WALK = LAYERS_MOST + 1 }; /* instead of a count: the pixel is in the list below */

/* Pixels whose layers may be others. */
struct pixels {
    size_t *item;
    size_t count, capacity;
};

static bool note_pixels(struct pixels *pixels, struct layers *l, struct footprint f)
{
    for (int32_t y = f.top; y <= f.bottom; y++)
        for (int32_t x = f.left; x <= f.right; x++) {
            const size_t pixel = (size_t)y * l->width + (size_t)x;
            if (l->count[pixel] == TO_WALK)
                continue;
            if (!mem_grow(&pixels->item, &pixels->capacity, pixels->count + 1,
                          sizeof *pixels->item))
                return false;
            l->count[pixel] = TO_WALK;
            pixels->item[pixels->count++] = pixel;
        }
    return true;
}

/* A layer depends on the labels on both sides of its face alone, which the ray goes through: rays
 * that meet a voxel of another label are walked again, and no other. */
bool layers_follow(struct rendition *r, const struct camera *camera, const struct border *border,
                   const struct changes *changes, struct shade_reach reach)
{
    struct layers *l = r->layers;
    struct pixels pixels = {0};
    bool fits = !changes->everything && !seams_follow(l->seams, border, changes, NULL);
    struct task task = task_begin(camera->scene->watch, "rendition", changes->count);
    for (size_t i = 0; fits && i < changes->count && task_advance(&task, 1); i++) {
        const struct change *c = changes->item + i;
        if (c->label == c->former_label ||
            (!border->visible[c->former_label] && !border->visible[c->label]))
            continue;
        rendition_mark_stale(r, splat_footprint(camera, c->cell, reach.layers), reach.pixels);
        fits = note_pixels(&pixels, l, splat_footprint(camera, c->cell, 0));
    }
    for (size_t i = 0; fits && i < pixels.count; i++)
        layers_walk(l, camera, border, pixels.item[i]);
    free(pixels.item);
    return fits;
}

/* ---- what a pixel shows ---- */

enum { LIGHT_ALL = 1 << 16, LIGHT_LEAST = LIGHT_ALL / 256 };

/* The share of a layer in what is left; less than LIGHT_LEAST is not left over. */
static uint32_t share_of(uint32_t left, unsigned opacity)
{
    const uint32_t share = left * opacity / BORDER_OPAQUE;
    return left - share < LIGHT_LEAST ? left : share;
}

struct layer layers_at(const struct layers *l, size_t pixel, unsigned number)
{
    const size_t at = pixel * LAYERS_MOST + number;
    if (number < l->count[pixel] && l->depth[at] < l->last_depth[pixel])
        return (struct layer){l->depth[at], l->cell[at], l->label[at]};
    return (struct layer){l->last_depth[pixel], l->last_cell[pixel], l->last_label[pixel]};
}

static struct layer pick(const struct layers *l, const uint8_t opacity[256], size_t pixel)
{
    struct layer found = layers_at(l, pixel, 0);
    uint32_t left = LIGHT_ALL, most = found.label ? share_of(left, opacity[found.label]) : left;
    left -= most;
    for (unsigned number = 1; left > most; number++) {
        const struct layer layer = layers_at(l, pixel, number);
        if (!layer.label)
            break;
        const uint32_t share = share_of(left, opacity[layer.label]);
        found = share > most ? layer : found;
        most = share > most ? share : most;
        left -= share;
    }
    return found;
}

bool layers_pick(struct rendition *r, const struct border *border, struct footprint tile)
{
    bool is_empty = true;
    for (int32_t y = tile.top; y <= tile.bottom; y++)
        for (int32_t x = tile.left; x <= tile.right; x++) {
            const size_t pixel = (size_t)y * r->width + (size_t)x;
            const struct layer layer = pick(r->layers, border->opacity, pixel);
            r->depth[pixel] = layer.depth;
            r->cell[pixel] = layer.cell;
            r->label[pixel] = layer.label;
            is_empty = is_empty && !layer.label;
            if (layer.label)
                continue;
            memset(r->rgba + 4 * pixel, 0, 4);
            memset(r->normal + 4 * pixel, 0, 4 * sizeof *r->normal);
        }
    return is_empty;
}

/* ---- blending ---- */

/* The pixel of a tile that has this number in it. */
static inline size_t pixel_at(const struct blend *blend, unsigned number)
{
    const size_t x = (size_t)blend->tile.left + number % TILE;
    const size_t y = (size_t)blend->tile.top + number / TILE;
    return y * blend->layers->width + x;
}

void blend_begin(struct blend *blend, struct rendition *r, const struct border *border,
                 struct footprint tile)
{
    *blend = (struct blend){.layers = r->layers, .border = border, .tile = tile};
    for (int32_t y = tile.top; y <= tile.bottom; y++)
        for (int32_t x = tile.left; x <= tile.right; x++) {
            const tile_mask is_shown = r->label[(size_t)y * r->width + (size_t)x] != 0;
            blend->shown |= is_shown << ((y - tile.top) * TILE + x - tile.left);
        }
    blend->goes_on = blend->shown;
    for (int i = 0; i < TILE * TILE; i++)
        blend->left[i] = LIGHT_ALL;
}

tile_mask blend_next(struct blend *blend)
{
    struct rendition *pass = &blend->layers->pass;
    for (tile_mask pixels = blend->goes_on; pixels; pixels &= pixels - 1) {
        const size_t pixel = pixel_at(blend, (unsigned)__builtin_ctzll(pixels));
        const struct layer layer = layers_at(blend->layers, pixel, blend->number);
        pass->depth[pixel] = layer.depth;
        pass->cell[pixel] = layer.cell;
        pass->label[pixel] = layer.label;
        if (!layer.label)
            blend->goes_on ^= pixels & -pixels;
    }
    blend->number++;
    return blend->goes_on;
}

void blend_add(struct blend *blend, struct rendition *r)
{
    const struct rendition *pass = &blend->layers->pass;
    for (tile_mask pixels = blend->goes_on; pixels; pixels &= pixels - 1) {
        const unsigned i = (unsigned)__builtin_ctzll(pixels);
        const size_t pixel = pixel_at(blend, i);
        const uint32_t share = share_of(blend->left[i], blend->border->opacity[pass->label[pixel]]);
        for (int k = 0; k < 3; k++) {
            const uint32_t level = pass->rgba[4 * pixel + (size_t)k];
            blend->sum[i][k] += share * level * level;
        }
        blend->left[i] -= share;
        if (pass->depth[pixel] == r->depth[pixel])
            memcpy(r->normal + 4 * pixel, pass->normal + 4 * pixel, 4 * sizeof *r->normal);
        if (!blend->left[i])
            blend->goes_on ^= pixels & -pixels;
    }
}

void blend_end(const struct blend *blend, struct rendition *r)
{
    for (tile_mask pixels = blend->shown; pixels; pixels &= pixels - 1) {
        const unsigned i = (unsigned)__builtin_ctzll(pixels);
        const uint32_t taken = LIGHT_ALL - blend->left[i];
        uint8_t *rgba = r->rgba + 4 * pixel_at(blend, i);
        for (int k = 0; k < 3; k++)
            rgba[k] = taken ? blend->layers->root[blend->sum[i][k] / taken] : 0;
        rgba[3] = (uint8_t)((taken * 255 + LIGHT_ALL / 2) / LIGHT_ALL);
    }
}
