#include "render/rendition.h"

#include <string.h>

enum {
    COLOURS = 4,
    PAIR = 2 * COLOURS,
    NOT_FRESH = TILE_STALE | TILE_LIT | TILE_SHADED | TILE_EMPTY | TILE_STANDS,
    TILES_SHARED = 1024, /* from so many on it is worth waking another thread */
};

/* The colours of two pixels, squared, of which roots are taken at once where the machine can. */
typedef uint16_t lanes __attribute__((vector_size(2 * PAIR)));

/* Rounded down, bit by bit. */
static inline lanes roots_of(lanes squares)
{
    lanes root = {0};
    for (uint16_t bit = 128; bit; bit = bit >> 1) {
        const lanes next = root | bit;
        root |= (lanes)(next * next <= squares) & bit;
    }
    return root;
}

/* Of some pixels: what lies nearest, the sum of alpha, and sums of squares of colours by alpha. */
struct mean {
    size_t nearest;
    uint64_t alpha, squares[COLOURS - 1];
};

static inline void add_to_mean(struct mean *mean, const struct rendition *fine, size_t at)
{
    const uint8_t *rgba = fine->rgba + COLOURS * at;
    mean->nearest = fine->depth[at] < fine->depth[mean->nearest] ? at : mean->nearest;
    mean->alpha += rgba[3];
    for (int k = 0; k < COLOURS - 1; k++)
        mean->squares[k] += (uint32_t)rgba[3] * rgba[k] * rgba[k];
}

/* Of a box of pixels. */
static inline struct mean mean_of(const struct rendition *fine, size_t first, uint32_t width,
                                  uint32_t height)
{
    struct mean mean = {.nearest = first};
    for (uint32_t j = 0; j < height; j++)
        for (uint32_t i = 0; i < width; i++)
            add_to_mean(&mean, fine, first + (size_t)j * fine->width + i);
    return mean;
}

/* The mean square of a colour; dividing 32 bits takes a third of the time. */
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

/* All of a pixel but its colour, of which the squares are given back. */
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

/* `count` pixels beside each other, at most a tile's. */
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

/* Of `count` pixels beside each other the samples that stand for them, the first of which is here.
 */
static inline void take_row(struct rendition *out, size_t to, uint32_t count,
                            const struct rendition *fine, size_t first, uint32_t samples)
{
    for (uint32_t x = 0; x < count; x++) {
        const size_t from = first + (size_t)x * samples;
        out->depth[to + x] = fine->depth[from];
        out->cell[to + x] = fine->cell[from];
        out->label[to + x] = fine->label[from];
        memcpy(out->normal + 4 * (to + x), fine->normal + 4 * from, 4 * sizeof *out->normal);
        memcpy(out->rgba + COLOURS * (to + x), fine->rgba + COLOURS * from, COLOURS);
    }
}

static inline void reduce_tile(struct rendition *out, const struct rendition *fine, size_t tile,
                               uint32_t samples)
{
    const uint32_t side = TILE / samples, left = (uint32_t)(tile % fine->tiles_x) * side;
    const uint32_t top = (uint32_t)(tile / fine->tiles_x) * side;
    const uint32_t width = out->width - left < side ? out->width - left : side;
    const enum tile_state state = (enum tile_state)fine->stale[tile];
    const size_t stands = (samples / 2) * ((size_t)fine->width + 1);
    for (uint32_t y = top; y < top + side && y < out->height; y++) {
        const size_t to = (size_t)y * out->width + left;
        const size_t first = ((size_t)y * fine->width + left) * samples;
        if (state == TILE_EMPTY)
            rendition_empty(out, to, width);
        else if (state == TILE_STANDS)
            take_row(out, to, width, fine, first + stands, samples);
        else
            reduce_row(out, to, width, fine, first, samples);
    }
}

static void reduce_rows(struct rendition *out, struct rendition *fine, uint32_t samples,
                        size_t first, size_t end)
{
    const size_t after = end * fine->tiles_x;
    size_t tile = rendition_tile(fine, first * fine->tiles_x, after, NOT_FRESH);
    for (; tile < after; tile = rendition_tile(fine, tile + 1, after, NOT_FRESH)) {
        if (samples == 4) /* written out, so that loops of so many rounds are compiled */
            reduce_tile(out, fine, tile, 4);
        else if (samples == 2)
            reduce_tile(out, fine, tile, 2);
        else
            reduce_tile(out, fine, tile, samples);
        fine->stale[tile] = TILE_FRESH;
    }
}

void rendition_reduce(struct rendition *out, struct rendition *fine, uint32_t samples)
{
    reduce_rows(out, fine, samples, 0, fine->tiles_y);
}

/* ---- by several threads ---- */

struct reducing {
    struct rendition *out, *fine;
    uint32_t samples;
    struct team *team;
};

static void reduce_share(void *context, unsigned thread)
{
    const struct reducing *r = context;
    const struct share rows = team_share(r->team, thread, r->fine->tiles_y);
    reduce_rows(r->out, r->fine, r->samples, rows.first, rows.end);
}

void rendition_reduce_shared(struct rendition *out, struct rendition *fine, uint32_t samples,
                             struct team *team)
{
    if (rendition_count(fine, NOT_FRESH) < TILES_SHARED)
        team = NULL;
    struct reducing reducing = {out, fine, samples, team};
    team_run(team, reduce_share, &reducing);
}
