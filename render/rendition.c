/* SPDX-License-Identifier: MIT */
#include "render/rendition.h"

#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "base/mem.h"

enum err rendition_init(struct rendition *r, uint32_t width, uint32_t height, struct fault *fault)
{
    *r = (struct rendition){.width = width, .height = height};
    r->tiles_x = (width + TILE - 1) / TILE;
    r->tiles_y = (height + TILE - 1) / TILE;
    const size_t pixels = (size_t)width * height, tiles = (size_t)r->tiles_x * r->tiles_y;
    const struct mem_part parts[] = {
        {&r->depth, pixels, sizeof *r->depth},       {&r->cell, pixels, sizeof *r->cell},
        {&r->label, pixels, sizeof *r->label},       {&r->rgba, pixels, 4 * sizeof *r->rgba},
        {&r->normal, pixels, 4 * sizeof *r->normal}, {&r->stale, tiles, sizeof *r->stale},
        {&r->blank, tiles, sizeof *r->blank},        {&r->far, tiles, sizeof *r->far},
        {&r->is_drawn, tiles, sizeof *r->is_drawn}};
    if (!mem_parts(parts, sizeof parts / sizeof *parts)) {
        rendition_release(r);
        return fault_memory(fault, "a rendition");
    }
    memset(r->blank, false, tiles * sizeof *r->blank);
    rendition_clear(r);
    return OK;
}

void rendition_release(struct rendition *r)
{
    free(r->depth);
    *r = (struct rendition){0};
}

size_t rendition_bytes(const struct rendition *r)
{
    const size_t a_pixel = sizeof *r->depth + sizeof *r->cell + 1 + 4 + 4 * sizeof *r->normal;
    const size_t a_tile =
        sizeof *r->stale + sizeof *r->blank + sizeof *r->far + sizeof *r->is_drawn;
    return (size_t)r->width * r->height * a_pixel + (size_t)r->tiles_x * r->tiles_y * a_tile;
}

/* After an edit most tiles are fresh, so eight are skipped at a time. */
bool rendition_tile(const struct rendition *r, size_t *tile, size_t end, unsigned states)
{
    const uint64_t of_each = UINT64_C(0x0101010101010101) * states;
    for (uint64_t eight; *tile + sizeof eight <= end; *tile += sizeof eight) {
        memcpy(&eight, r->stale + *tile, sizeof eight);
        if (eight & of_each)
            break;
    }
    while (*tile < end && !(r->stale[*tile] & states))
        ++*tile;
    return *tile < end;
}

size_t rendition_count(const struct rendition *r, unsigned states)
{
    const size_t all = (size_t)r->tiles_x * r->tiles_y;
    size_t count = 0;
    for (size_t i = 0; rendition_tile(r, &i, all, states); i++)
        count++;
    return count;
}

struct rendition rendition_rows(const struct rendition *r, uint32_t top, uint32_t height)
{
    const size_t first = (size_t)top * r->width;
    struct rendition rows = *r;
    rows.height = height;
    rows.depth += first;
    rows.cell += first;
    rows.label += first;
    rows.rgba += 4 * first;
    rows.normal += 4 * first;
    rows.stale += (size_t)(top / TILE) * r->tiles_x;
    rows.blank += (size_t)(top / TILE) * r->tiles_x;
    rows.far += (size_t)(top / TILE) * r->tiles_x;
    rows.is_drawn += (size_t)(top / TILE) * r->tiles_x;
    rows.tiles_y = (height + TILE - 1) / TILE;
    rows.layers = top ? NULL : r->layers;
    return rows;
}

void rendition_copy(struct rendition *to, const struct rendition *from, uint32_t height)
{
    const size_t pixels = (size_t)height * from->width;
    const size_t tiles = (size_t)((height + TILE - 1) / TILE) * from->tiles_x;
    memmove(to->depth, from->depth, pixels * sizeof *to->depth);
    memmove(to->cell, from->cell, pixels * sizeof *to->cell);
    memmove(to->label, from->label, pixels);
    memmove(to->rgba, from->rgba, 4 * pixels);
    memmove(to->normal, from->normal, 4 * pixels * sizeof *to->normal);
    memmove(to->stale, from->stale, tiles);
    memmove(to->blank, from->blank, tiles * sizeof *to->blank);
}

void rendition_clear(struct rendition *r)
{
    const size_t pixels = (size_t)r->width * r->height;
    const size_t tiles = (size_t)r->tiles_x * r->tiles_y;
    for (size_t i = 0; i < pixels; i++)
        r->depth[i] = DEPTH_NONE;
    memset(r->cell, UINT8_MAX, pixels * sizeof *r->cell); /* CELL_NONE */
    memset(r->stale, TILE_STALE, tiles);
    for (size_t i = 0; i < tiles; i++)
        r->far[i] = DEPTH_NONE;
    memset(r->is_drawn, false, tiles * sizeof *r->is_drawn);
}

void rendition_clear_tile(struct rendition *r, size_t tile)
{
    const struct tile_bounds t = rendition_bounds(r, tile);
    for (uint32_t y = t.top; y < t.bottom; y++)
        for (uint32_t x = t.left; x < t.right; x++) {
            r->depth[(size_t)y * r->width + x] = DEPTH_NONE;
            r->cell[(size_t)y * r->width + x] = CELL_NONE;
        }
    r->stale[tile] = TILE_STALE;
    r->far[tile] = DEPTH_NONE;
    r->is_drawn[tile] = false;
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

void rendition_mark_stale(struct rendition *r, struct footprint f, int pixels)
{
    if (f.left > f.right || f.top > f.bottom)
        return;
    const uint32_t left = grid_held(f.left - pixels, r->width) / TILE;
    const uint32_t right = grid_held(f.right + pixels, r->width) / TILE;
    const uint32_t bottom = grid_held(f.bottom + pixels, r->height) / TILE;
    for (uint32_t y = grid_held(f.top - pixels, r->height) / TILE; y <= bottom; y++)
        memset(r->stale + (size_t)y * r->tiles_x + left, TILE_STALE, right - left + 1);
}

/* ---- digests ---- */

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

/* ---- samples of a pixel ---- */

enum {
    COLOURS = 4,
    PAIR = 2 * COLOURS,
    NOT_FRESH = TILE_STALE | TILE_LIT | TILE_SHADED | TILE_EMPTY,
    TILES_SHARED = 1024, /* from this number on another thread is worth waking */
};

/* The squared colours of two pixels: their roots are computed in parallel where the machine can. */
typedef uint16_t lanes __attribute__((vector_size(2 * PAIR)));

/* Compute roots, rounded down, bit by bit. */
static inline lanes roots_of(lanes squares)
{
    lanes root = {0};
    for (uint16_t bit = 128; bit; bit = bit >> 1) {
        const lanes next = root | bit;
        root |= (lanes)(next * next <= squares) & bit;
    }
    return root;
}

/* A group of pixels: the nearest, the sum of alpha, and sums of squared colours times alpha. */
struct mean {
    size_t nearest;
    uint64_t alpha, squares[COLOURS - 1];
};

/* Compute it for a box of pixels. */
static inline struct mean mean_of(const struct rendition *fine, size_t first, uint32_t width,
                                  uint32_t height)
{
    uint64_t alpha = 0, red = 0, green = 0, blue = 0; /* locals stay in registers, unlike members */
    size_t nearest = first;
    for (uint32_t j = 0; j < height; j++)
        for (uint32_t i = 0; i < width; i++) {
            const size_t at = first + (size_t)j * fine->width + i;
            const uint8_t *rgba = fine->rgba + COLOURS * at;
            const uint32_t covered = rgba[3];
            nearest = fine->depth[at] < fine->depth[nearest] ? at : nearest;
            alpha += covered;
            red += covered * rgba[0] * rgba[0];
            green += covered * rgba[1] * rgba[1];
            blue += covered * rgba[2] * rgba[2];
        }
    return (struct mean){nearest, alpha, {red, green, blue}};
}

/* Return the mean square of a colour; a 32-bit division is three times as fast. */
static inline uint16_t square_of(const struct mean *mean, int k, uint64_t pixels)
{
    return (uint16_t)(pixels <= 64 ? (uint32_t)mean->squares[k] / (uint32_t)mean->alpha
                                   : mean->squares[k] / mean->alpha);
}

size_t rendition_mean(uint8_t rgba[4], const struct rendition *fine, uint32_t left, uint32_t top,
                      uint32_t width, uint32_t height)
{
    const uint64_t all = (uint64_t)width * height;
    const size_t first = (size_t)top * fine->width + left;
    const struct mean mean = width == 2 && height == 2 ? mean_of(fine, first, 2, 2)
                                                       : mean_of(fine, first, width, height);
    memset(rgba, 0, COLOURS);
    if (mean.alpha == 0)
        return mean.nearest;
    const lanes roots = roots_of(
        (lanes){square_of(&mean, 0, all), square_of(&mean, 1, all), square_of(&mean, 2, all)});
    rgba[0] = (uint8_t)roots[0], rgba[1] = (uint8_t)roots[1], rgba[2] = (uint8_t)roots[2];
    rgba[3] = (uint8_t)((mean.alpha + all / 2) / all);
    return mean.nearest;
}

/* Compute all of a pixel but its colour, whose squares are returned. */
static inline void reduce_pixel(struct rendition *out, size_t to, const struct rendition *fine,
                                size_t first, uint32_t samples, uint16_t squares[COLOURS])
{
    const uint32_t all = samples * samples;
    const struct mean mean = mean_of(fine, first, samples, samples);
    out->depth[to] = fine->depth[mean.nearest];
    out->cell[to] = fine->cell[mean.nearest];
    out->label[to] = fine->label[mean.nearest];
    memcpy(out->normal + 4 * to, fine->normal + 4 * mean.nearest, 4 * sizeof *out->normal);
    out->rgba[COLOURS * to + 3] = (uint8_t)((mean.alpha + all / 2) / all);
    for (int k = 0; k < COLOURS - 1; k++)
        squares[k] = (uint16_t)(mean.alpha == 255 * all ? mean.squares[k] / (255 * all)
                                : mean.alpha            ? mean.squares[k] / mean.alpha
                                                        : 0);
}

/* Reduce `count` adjacent pixels, at most a tile's. */
static inline void reduce_row(struct rendition *out, size_t to, uint32_t count,
                              const struct rendition *fine, size_t first, uint32_t samples)
{
    for (uint32_t x = 0; x < count; x += 2) {
        const uint32_t pixels = count - x < 2 ? 1 : 2;
        uint16_t colour[PAIR] = {0};
        for (uint32_t i = 0; i < pixels; i++)
            reduce_pixel(out, to + x + i, fine, first + (size_t)(x + i) * samples, samples,
                         colour + COLOURS * i);
        lanes v;
        memcpy(&v, colour, sizeof v);
        v = roots_of(v);
        memcpy(colour, &v, sizeof v);
        for (uint32_t i = 0; i < pixels; i++)
            for (uint32_t k = 0; k < COLOURS - 1; k++)
                out->rgba[COLOURS * (to + x + i) + k] = (uint8_t)colour[COLOURS * i + k];
    }
}

static inline void reduce_tile(struct rendition *out, const struct rendition *fine, size_t tile,
                               uint32_t samples)
{
    const uint32_t side = TILE / samples, left = (uint32_t)(tile % fine->tiles_x) * side;
    const uint32_t top = (uint32_t)(tile / fine->tiles_x) * side;
    const uint32_t width = out->width - left < side ? out->width - left : side;
    const bool is_empty = fine->stale[tile] == TILE_EMPTY;
    for (uint32_t y = top; y < top + side && y < out->height; y++) {
        const size_t to = (size_t)y * out->width + left;
        const size_t first = ((size_t)y * fine->width + left) * samples;
        if (is_empty)
            rendition_empty(out, to, width);
        else
            reduce_row(out, to, width, fine, first, samples);
    }
}

struct reducing {
    struct rendition *out, *fine;
    uint32_t samples;
    struct team *team;
};

static void reduce_share(void *context, unsigned thread)
{
    const struct reducing *r = context;
    const struct share rows = team_share(r->team, thread, r->fine->tiles_y);
    const size_t after = rows.end * r->fine->tiles_x;
    size_t tile = rows.first * r->fine->tiles_x;
    for (; rendition_tile(r->fine, &tile, after, NOT_FRESH); tile++) {
        if (r->samples == 4) /* constants, so that the compiler unrolls the loops */
            reduce_tile(r->out, r->fine, tile, 4);
        else if (r->samples == 2)
            reduce_tile(r->out, r->fine, tile, 2);
        else
            reduce_tile(r->out, r->fine, tile, r->samples);
        r->fine->stale[tile] = TILE_FRESH;
    }
}

void rendition_reduce(struct rendition *out, struct rendition *fine, uint32_t samples,
                      struct team *team)
{
    if (rendition_count(fine, NOT_FRESH) < TILES_SHARED)
        team = NULL;
    struct reducing reducing = {out, fine, samples, team};
    team_run(team, reduce_share, &reducing);
}
