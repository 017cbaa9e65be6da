#include "render/layers.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

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
                     struct fault *fault)
{
    r->layers = NULL;
    if (!border_is_translucent(border))
        return OK;
    const enum err err = make_room(l, r->width, r->height, fault);
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

void layers_clear_tile(struct rendition *r, size_t tile)
{
    const struct tile_bounds t = rendition_bounds(r, tile);
    rendition_clear_tile(r, tile);
    for (uint32_t y = t.top; y < t.bottom; y++)
        for (uint32_t x = t.left; x < t.right; x++)
            layers_put_none(r->layers, (size_t)y * r->width + x);
}

/* ---- layers of a pixel ---- */

/* Whether one key comes before another. */
static bool is_nearer(int64_t depth, uint32_t cell, int64_t than, uint32_t than_cell)
{
    return depth < than || (depth == than && cell < than_cell);
}

/* Among the translucent ones, which are in order, and stay so. */
static void put_among(struct layers *l, size_t pixel, int64_t depth, uint32_t cell, uint8_t label)
{
    int64_t *const depths = l->depth + pixel * LAYERS_MOST;
    uint32_t *const cells = l->cell + pixel * LAYERS_MOST;
    uint8_t *const labels = l->label + pixel * LAYERS_MOST;
    size_t n = l->count[pixel], at = 0;
    while (at < n && is_nearer(depths[at], cells[at], depth, cell))
        at++;
    if (at == LAYERS_MOST || (at < n && depths[at] == depth && cells[at] == cell))
        return;
    n += n < LAYERS_MOST;
    memmove(depths + at + 1, depths + at, (n - at - 1) * sizeof *depths);
    memmove(cells + at + 1, cells + at, (n - at - 1) * sizeof *cells);
    memmove(labels + at + 1, labels + at, n - at - 1);
    depths[at] = depth;
    cells[at] = cell;
    labels[at] = label;
    l->count[pixel] = (uint8_t)n;
}

void layers_put(struct layers *l, size_t pixel, int64_t depth, uint32_t cell, uint8_t label,
                bool is_opaque)
{
    if (!is_opaque) {
        put_among(l, pixel, depth, cell, label);
    } else if (is_nearer(depth, cell, l->last_depth[pixel], l->last_cell[pixel])) {
        l->last_depth[pixel] = depth;
        l->last_cell[pixel] = cell;
        l->last_label[pixel] = label;
    }
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

bool layers_pick(struct rendition *r, const struct border *border, struct tile_bounds tile)
{
    bool is_empty = true;
    for (uint32_t y = tile.top; y < tile.bottom; y++)
        for (uint32_t x = tile.left; x < tile.right; x++) {
            const size_t pixel = (size_t)y * r->width + x;
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
    const size_t x = blend->tile.left + number % TILE;
    const size_t y = blend->tile.top + number / TILE;
    return y * blend->layers->width + x;
}

void blend_begin(struct blend *blend, struct rendition *r, const struct border *border,
                 struct tile_bounds tile)
{
    *blend = (struct blend){.layers = r->layers, .border = border, .tile = tile};
    for (uint32_t y = tile.top; y < tile.bottom; y++)
        for (uint32_t x = tile.left; x < tile.right; x++) {
            const tile_mask is_shown = r->label[(size_t)y * r->width + x] != 0;
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
