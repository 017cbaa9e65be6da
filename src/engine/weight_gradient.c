/* SPDX-License-Identifier: MIT */
#include "engine/weight_gradient.h"

#include <assert.h>

#include "base/least.h"
#include "engine/weight.h"

/* ---- sobel ---- */

/* For one row, with one extra value at each end: its neighbourhood along y and z smoothed along
 * both, or smoothed along one and differentiated along the other. */
struct slopes {
    int32_t *level, *along_y, *along_z;
};

static uint64_t sobel_bytes(const struct grid *grid, uint32_t argument)
{
    (void)argument;
    return 3 * ((uint64_t)grid->size[0] + 2) * sizeof(int32_t);
}

static void slopes_of_row(struct slopes *s, const struct scene *scene, uint32_t y, uint32_t z)
{
    const struct grid *grid = &scene->grid;
    const uint32_t width = grid->size[0];
    const struct cell *row[3][3]; /* [z][y] */
    for (int k = 0; k < 3; k++)
        for (int j = 0; j < 3; j++)
            row[k][j] =
                scene->cell + grid_cell(grid, 0, grid_held((int64_t)y + j - 1, grid->size[1]),
                                        grid_held((int64_t)z + k - 1, grid->size[2]));
    for (uint32_t x = 0; x < width; x++) {
        int32_t smooth[3], slope[3]; /* along y, of each z */
        for (int k = 0; k < 3; k++) {
            const int32_t a = row[k][0][x].intensity, b = row[k][1][x].intensity;
            const int32_t c = row[k][2][x].intensity;
            smooth[k] = a + 2 * b + c;
            slope[k] = c - a;
        }
        s->level[x + 1] = smooth[0] + 2 * smooth[1] + smooth[2];
        s->along_y[x + 1] = slope[0] + 2 * slope[1] + slope[2];
        s->along_z[x + 1] = smooth[2] - smooth[0];
    }
    int32_t *const values[3] = {s->level, s->along_y, s->along_z};
    for (int k = 0; k < 3; k++) {
        values[k][0] = values[k][1];
        values[k][width + 1] = values[k][width];
    }
}

static void sobel_weigh(struct scene *scene, const struct adjacency *adjacency, uint32_t argument,
                        struct slab slab, void *work)
{
    (void)adjacency, (void)argument;
    const struct grid *grid = &scene->grid;
    const size_t length = (size_t)grid->size[0] + 2;
    int32_t *rows = work;
    struct slopes slopes = {rows, rows + length, rows + 2 * length};
    struct grid_walk w = grid_walk(grid, scene->watch, "weights", slab, slab.first);
    while (grid_walk_next(&w)) {
        slopes_of_row(&slopes, scene, w.y, w.z);
        for (uint32_t x = 0; x < grid->size[0]; x++) {
            /* No part exceeds 16 * 65535 < 2^20, so the squares add up to less than 2^42. */
            const int32_t *a = slopes.along_y + x, *b = slopes.along_z + x;
            const int64_t gx = slopes.level[x + 2] - slopes.level[x];
            const int64_t gy = a[0] + 2 * a[1] + a[2];
            const int64_t gz = b[0] + 2 * b[1] + b[2];
            const uint32_t slope = square_root((uint64_t)(gx * gx + gy * gy + gz * gz)) / 16;
            scene->cell[w.row.first + x].weight =
                (uint16_t)(slope < WEIGHT_MOST ? slope : WEIGHT_MOST);
        }
    }
}

const struct weight_method sobel_weight = {
    .arcs = ARC_TARGET, .bytes = sobel_bytes, .weigh = sobel_weigh};

/* ---- the Gaussian ---- */

static uint64_t exp_of_minus(uint64_t x)
{
    const uint64_t one = UINT64_C(1) << 32, one_over_e = 1580030169;
    const uint64_t fraction = x & (one - 1);
    uint64_t p = one;
    for (uint64_t i = 12; i > 0; i--)
        p = one - (fraction * p >> 32) / i;
    for (x >>= 32; x > 0; x--)
        p = p * one_over_e >> 32;
    return p;
}

void gauss_init(struct gauss *gauss, uint32_t sigma_thousandths)
{
    const uint64_t sigma = sigma_thousandths;
    uint64_t e[GAUSS_RADIUS_MOST + 1], sum = 0;
    assert(sigma >= SIGMA_LEAST && sigma <= SIGMA_MOST);
    *gauss = (struct gauss){.radius = (uint32_t)((3 * sigma + 999) / 1000)};
    for (uint64_t k = 0; k <= gauss->radius; k++) { /* k^2 10^6 2^32 < 2^62 */
        e[k] = exp_of_minus((k * k * 1000000 << 32) / (2 * sigma * sigma));
        sum += k ? 2 * e[k] : e[k];
    }
    gauss->weight[0] = GAUSS_SUM;
    for (uint32_t k = 1; k <= gauss->radius; k++) {
        gauss->weight[k] = (uint32_t)((e[k] * GAUSS_SUM + sum / 2) / sum);
        gauss->weight[0] -= 2 * gauss->weight[k];
    }
}

/* ---- the scene smoothed, plane by plane ---- */

/*
 * Each plane of intensities is loaded once and stays while a smoothed plane needs it; there are
 * three smoothed planes. Plane z is stored at z modulo the number of slots.
 */
struct smoother {
    const struct scene *scene;
    struct gauss gauss;
    uint32_t width, height, depth;
    size_t plane;
    uint32_t deep;       /* slots for planes of intensities */
    uint32_t loaded;     /* planes up to loaded - 1 are loaded, from the first that is needed */
    uint64_t *sum;       /* [width] */
    uint32_t *along_z;   /* [plane] */
    uint32_t *smoothed;  /* [3][plane] */
    uint32_t *padded;    /* [radius + width + radius] */
    uint16_t *intensity; /* [deep][plane] */
    struct task task;    /* in values multiplied */
};

static void smoother_init(struct smoother *s, const struct grid *grid, uint32_t sigma_thousandths)
{
    *s = (struct smoother){.width = grid->size[0], .height = grid->size[1], .depth = grid->size[2]};
    gauss_init(&s->gauss, sigma_thousandths);
    s->plane = (size_t)s->width * s->height;
    s->deep = 2 * s->gauss.radius + 1 < s->depth ? 2 * s->gauss.radius + 1 : s->depth;
}

/* A plane has less than 2^31 voxels (G1), so this is less than 2^38. */
static uint64_t gauss_bytes(const struct grid *grid, uint32_t sigma_thousandths)
{
    struct smoother s;
    smoother_init(&s, grid, sigma_thousandths);
    return (uint64_t)s.width * sizeof *s.sum + (uint64_t)s.plane * 4 * sizeof *s.smoothed +
           ((uint64_t)s.width + 2 * s.gauss.radius) * sizeof *s.padded +
           (uint64_t)s.plane * s.deep * sizeof *s.intensity;
}

/* Advance the task by a row whose voxels need `each` units. */
static bool row_is_done(struct smoother *s, uint32_t each)
{
    return task_advance(&s->task, (uint64_t)each * s->width);
}

static const uint16_t *intensities(const struct smoother *s, uint32_t y, uint32_t z)
{
    return s->intensity + z % s->deep * s->plane + (size_t)y * s->width;
}

static uint32_t *smoothed(const struct smoother *s, uint32_t y, uint32_t z)
{
    return s->smoothed + z % 3 * s->plane + (size_t)y * s->width;
}

/* At most 65535 * GAUSS_SUM: exact in 32 bits. */
static void smooth_along_z(struct smoother *s, uint32_t y, uint32_t z)
{
    uint32_t *to = s->along_z + (size_t)y * s->width;
    const uint16_t *here = intensities(s, y, z);
    for (uint32_t x = 0; x < s->width; x++)
        to[x] = s->gauss.weight[0] * here[x];
    for (uint32_t k = 1; k <= s->gauss.radius; k++) {
        const uint32_t weight = s->gauss.weight[k];
        const uint16_t *a = intensities(s, y, grid_held((int64_t)z - k, s->depth));
        const uint16_t *b = intensities(s, y, grid_held((int64_t)z + k, s->depth));
        for (uint32_t x = 0; x < s->width; x++)
            to[x] += weight * ((uint32_t)a[x] + b[x]);
    }
}

static uint32_t nearest(uint64_t sum)
{
    return (uint32_t)((sum + GAUSS_SUM / 2) / GAUSS_SUM);
}

/* Smooth a row along y into `padded`, and replicate its ends. */
static void smooth_along_y(struct smoother *s, uint32_t y)
{
    const uint32_t *plane = s->along_z, radius = s->gauss.radius;
    const uint32_t *here = plane + (size_t)y * s->width;
    for (uint32_t x = 0; x < s->width; x++)
        s->sum[x] = (uint64_t)s->gauss.weight[0] * here[x];
    for (uint32_t k = 1; k <= radius; k++) {
        const uint64_t weight = s->gauss.weight[k];
        const uint32_t *a = plane + (size_t)grid_held((int64_t)y - k, s->height) * s->width;
        const uint32_t *b = plane + (size_t)grid_held((int64_t)y + k, s->height) * s->width;
        for (uint32_t x = 0; x < s->width; x++)
            s->sum[x] += weight * ((uint64_t)a[x] + b[x]);
    }
    uint32_t *row = s->padded + radius;
    for (uint32_t x = 0; x < s->width; x++)
        row[x] = nearest(s->sum[x]);
    for (uint32_t k = 0; k < radius; k++) {
        s->padded[k] = row[0];
        row[s->width + k] = row[s->width - 1];
    }
}

static void smooth_plane(struct smoother *s, uint32_t z)
{
    const uint32_t terms = s->gauss.radius + 1;
    while (s->loaded <= grid_held((int64_t)z + s->gauss.radius, s->depth)) {
        const uint32_t plane = s->loaded++;
        uint16_t *to = s->intensity + plane % s->deep * s->plane;
        for (uint32_t y = 0; y < s->height && row_is_done(s, 1); y++) {
            const struct cell *cell = s->scene->cell + grid_row(&s->scene->grid, y, plane).first;
            for (uint32_t x = 0; x < s->width; x++)
                *to++ = cell[x].intensity;
        }
    }
    for (uint32_t y = 0; y < s->height && row_is_done(s, terms); y++)
        smooth_along_z(s, y, z);
    for (uint32_t y = 0; y < s->height && row_is_done(s, 2 * terms); y++) {
        smooth_along_y(s, y);
        uint32_t *to = smoothed(s, y, z);
        const uint32_t *row = s->padded + s->gauss.radius, *weight = s->gauss.weight;
        for (uint32_t x = 0; x < s->width; x++, row++) {
            uint64_t sum = (uint64_t)weight[0] * *row;
            for (uint32_t k = 1; k <= s->gauss.radius; k++)
                sum += weight[k] * ((uint64_t) * (row - k) + row[k]);
            to[x] = nearest(sum);
        }
    }
}

/* ---- gauss ---- */

/* Square of half a difference: less than 2^62, so that three of them fit 64 bits. */
static uint64_t half_squared(uint32_t a, uint32_t b)
{
    const uint64_t half = (a < b ? b - a : a - b) / 2;
    return half * half;
}

static void gauss_weigh(struct scene *scene, const struct adjacency *adjacency,
                        uint32_t sigma_thousandths, struct slab slab, void *work)
{
    (void)adjacency;
    struct smoother s;
    smoother_init(&s, &scene->grid, sigma_thousandths);
    s.sum = work;
    s.along_z = (uint32_t *)(s.sum + s.width);
    s.smoothed = s.along_z + s.plane;
    s.padded = s.smoothed + 3 * s.plane;
    s.intensity = (uint16_t *)(s.padded + s.width + 2 * s.gauss.radius);
    s.scene = scene;
    s.task = task_begin_part(scene->watch, "weights",
                             (3 * (uint64_t)s.gauss.radius + 5) * slab_voxels(&scene->grid, slab),
                             slab.first);
    const uint32_t first = slab.first > 0 ? slab.first - 1 : 0;
    s.loaded = grid_held((int64_t)first - s.gauss.radius, s.depth);
    for (uint32_t z = first; z <= slab.first; z++)
        smooth_plane(&s, z);
    for (uint32_t z = slab.first; z < slab.end; z++) {
        if (z + 1 < s.depth)
            smooth_plane(&s, z + 1);
        for (uint32_t y = 0; y < s.height; y++) {
            const uint32_t *here = smoothed(&s, y, z);
            const uint32_t *y0 = smoothed(&s, grid_held((int64_t)y - 1, s.height), z);
            const uint32_t *y1 = smoothed(&s, grid_held((int64_t)y + 1, s.height), z);
            const uint32_t *z0 = smoothed(&s, y, grid_held((int64_t)z - 1, s.depth));
            const uint32_t *z1 = smoothed(&s, y, grid_held((int64_t)z + 1, s.depth));
            const uint64_t step = s.gauss.weight[0] + s.gauss.weight[1];
            struct cell *cell = scene->cell + grid_row(&scene->grid, y, z).first;
            for (uint32_t x = 0; x < s.width; x++) {
                const uint64_t sum =
                    half_squared(here[x > 0 ? x - 1 : x], here[x + 1 < s.width ? x + 1 : x]) +
                    half_squared(y0[x], y1[x]) + half_squared(z0[x], z1[x]);
                const uint64_t length = (2 * (uint64_t)square_root(sum) + step / 2) / step;
                cell[x].weight = (uint16_t)(length < WEIGHT_MOST ? length : WEIGHT_MOST);
            }
            if (!row_is_done(&s, 1))
                return;
        }
    }
}

const struct weight_method gauss_weight = {
    .arcs = ARC_TARGET, .bytes = gauss_bytes, .weigh = gauss_weigh};
