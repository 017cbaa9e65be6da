#include "render/rendition.h"

#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "base/mem.h"

enum err rendition_init(struct rendition *r, uint32_t width, uint32_t height, struct fault *fault)
{
    size_t pixels = (size_t)width * height;
    *r = (struct rendition){.width = width, .height = height};
    r->tiles_x = (width + TILE - 1) / TILE;
    r->tiles_y = (height + TILE - 1) / TILE;
    r->depth = r->cube.depth = mem_array(pixels, sizeof *r->depth);
    r->cell = r->cube.cell = mem_array(pixels, sizeof *r->cell);
    r->label = mem_array(pixels, sizeof *r->label);
    r->rgba = mem_array(pixels, 4);
    r->normal = mem_array(pixels, 4 * sizeof *r->normal);
    r->stale = mem_array((size_t)r->tiles_x * r->tiles_y, 1);
    r->blank = mem_new((size_t)r->tiles_x * r->tiles_y * sizeof *r->blank);
    r->uncovered = mem_array(height * rendition_words(r), sizeof *r->uncovered);
    if (!r->depth || !r->cell || !r->label || !r->rgba || !r->normal || !r->stale || !r->blank ||
        !r->uncovered) {
        rendition_release(r);
        return fault_memory(fault, "a rendition");
    }
    rendition_clear(r);
    return OK;
}

static void drop_refined(struct rendition *r)
{
    if (rendition_is_refined(r)) {
        free(r->depth);
        free(r->cell);
    }
    r->depth = r->cube.depth;
    r->cell = r->cube.cell;
}

enum err rendition_refined(struct rendition *r, bool is_refined, struct fault *fault)
{
    const size_t pixels = (size_t)r->width * r->height;
    if (is_refined == rendition_is_refined(r))
        return OK;
    drop_refined(r);
    memset(r->blank, 0, (size_t)r->tiles_x * r->tiles_y * sizeof *r->blank);
    if (!is_refined)
        return OK;
    int64_t *depth = mem_array(pixels, sizeof *depth);
    uint32_t *cell = mem_array(pixels, sizeof *cell);
    if (!depth || !cell) {
        free(depth);
        free(cell);
        return fault_memory(fault, "a rendition");
    }
    r->depth = depth;
    r->cell = cell;
    return OK;
}

void rendition_release(struct rendition *r)
{
    drop_refined(r);
    free(r->depth);
    free(r->cell);
    free(r->label);
    free(r->rgba);
    free(r->normal);
    free(r->stale);
    free(r->blank);
    free(r->uncovered);
    *r = (struct rendition){0};
}

size_t rendition_bytes(const struct rendition *r)
{
    const size_t map = sizeof *r->depth + sizeof *r->cell;
    const size_t maps = rendition_is_refined(r) ? 2 * map : map;
    const size_t a_pixel = maps + 1 + 4 + 4 * sizeof *r->normal;
    const size_t a_tile = sizeof *r->stale + sizeof *r->blank;
    return (size_t)r->width * r->height * a_pixel + (size_t)r->tiles_x * r->tiles_y * a_tile +
           r->height * rendition_words(r) * sizeof *r->uncovered;
}

/* After an edit most tiles are fresh: they are passed over eight at a time. */
size_t rendition_tile(const struct rendition *r, size_t tile, size_t end, unsigned states)
{
    const uint64_t of_each = UINT64_C(0x0101010101010101) * states;
    for (uint64_t eight; tile + sizeof eight <= end; tile += sizeof eight) {
        memcpy(&eight, r->stale + tile, sizeof eight);
        if (eight & of_each)
            break;
    }
    while (tile < end && !(r->stale[tile] & states))
        tile++;
    return tile;
}

size_t rendition_count(const struct rendition *r, unsigned states)
{
    const size_t all = (size_t)r->tiles_x * r->tiles_y;
    size_t count = 0;
    for (size_t i = rendition_tile(r, 0, all, states); i < all;
         i = rendition_tile(r, i + 1, all, states))
        count++;
    return count;
}

struct rendition rendition_rows(const struct rendition *r, uint32_t top, uint32_t height)
{
    const size_t first = (size_t)top * r->width;
    struct rendition rows = *r;
    rows.height = height;
    rows.cube.depth += first;
    rows.cube.cell += first;
    rows.depth += first;
    rows.cell += first;
    rows.label += first;
    rows.rgba += 4 * first;
    rows.normal += 4 * first;
    rows.stale += (size_t)(top / TILE) * r->tiles_x;
    rows.blank += (size_t)(top / TILE) * r->tiles_x;
    rows.uncovered += top * rendition_words(r);
    rows.tiles_y = (height + TILE - 1) / TILE;
    rows.layers = top ? NULL : r->layers;
    return rows;
}

void rendition_clear(struct rendition *r)
{
    size_t pixels = (size_t)r->width * r->height;
    for (size_t i = 0; i < pixels; i++)
        r->cube.depth[i] = DEPTH_NONE;
    memset(r->cube.cell, UINT8_MAX, pixels * sizeof *r->cube.cell); /* CELL_NONE */
    memset(r->stale, TILE_STALE, (size_t)r->tiles_x * r->tiles_y);
}

void rendition_empty(struct rendition *r, size_t first, size_t count)
{
    for (size_t pixel = first; pixel < first + count; pixel++) {
        r->depth[pixel] = DEPTH_NONE;
        r->cell[pixel] = CELL_NONE;
    }
    memset(r->label + first, 0, count);
    memset(r->rgba + 4 * first, 0, 4 * count);
    memset(r->normal + 4 * first, 0, 4 * count * sizeof *r->normal);
}

static int32_t within(int32_t v, uint32_t size)
{
    return v < 0 ? 0 : v >= (int32_t)size ? (int32_t)size - 1 : v;
}

void rendition_mark_stale(struct rendition *r, struct footprint f, int pixels)
{
    if (f.left > f.right || f.top > f.bottom)
        return;
    f.left = within(f.left - pixels, r->width), f.right = within(f.right + pixels, r->width);
    f.top = within(f.top - pixels, r->height), f.bottom = within(f.bottom + pixels, r->height);
    for (int32_t y = f.top / TILE; y <= f.bottom / TILE; y++)
        memset(r->stale + (size_t)y * r->tiles_x + f.left / TILE, TILE_STALE,
               (size_t)(f.right / TILE - f.left / TILE + 1));
}

uint64_t rendition_digest_begin(uint32_t width, uint32_t height)
{
    return hash_mix_at(width, height);
}

uint64_t rendition_digest_rows(const struct rendition *r, uint32_t top)
{
    const size_t first = (size_t)top * r->width;
    uint64_t sum = 0;
    for (size_t i = 0; i < (size_t)r->width * r->height; i++) {
        const uint8_t *c = r->rgba + 4 * i;
        if (r->cell[i] == CELL_NONE && !c[3])
            continue;
        uint64_t colour = (uint64_t)c[0] << 24 | (uint64_t)c[1] << 16 | (uint64_t)c[2] << 8 | c[3];
        uint64_t seen = hash_mix_at(r->cell[i], (uint64_t)r->depth[i]);
        sum += hash_mix_at(first + i, seen ^ hash_mix(colour << 8 | r->label[i]));
    }
    return sum;
}

uint64_t rendition_digest(const struct rendition *r)
{
    return rendition_digest_begin(r->width, r->height) + rendition_digest_rows(r, 0);
}
