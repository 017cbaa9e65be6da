#include "render/shade.h"

#include <string.h>

#include "render/fixed.h"

enum {
    WIDTH = 2 * SHADE_RADIUS + 1,
    ROWS = 1 << WIDTH, /* patterns of shown voxels along x */
    UNIT = 1 << 15,    /* 1 of a brightness */
    AMBIENT = UNIT / 5,
    DIFFUSE = UNIT - AMBIENT,
    SPECULAR = 70,       /* of 255, where the light is mirrored into the eye */
    SHINE = 5,           /* squarings: the exponent is 2^5 */
    CUE = UNIT * 3 / 10, /* how much darker the far end of the scene is */
};

/* Binomial weights, and the same times the offset: smoothing, and its derivative. */
static const int smooth[WIDTH] = {1, 6, 15, 20, 15, 6, 1};
static const int slope[WIDTH] = {-3, -12, -15, 0, 15, 12, 3};

/* Both sums for each pattern of seven voxels in a row, bit 0 the first: the smoothed one in the
 * low half, never negative, the derivative in the high half, so that one product weighs both. */
struct row_sums {
    int64_t of[ROWS];
};

static void fill_row_sums(struct row_sums *sums)
{
    for (unsigned bits = 0; bits < ROWS; bits++) {
        int64_t s = 0, d = 0;
        for (int i = 0; i < WIDTH; i++)
            if (bits >> i & 1) {
                s += smooth[i];
                d += slope[i];
            }
        sums->of[bits] = d * (INT64_C(1) << 32) + s;
    }
}

static inline int64_t low_half(int64_t both)
{
    return both & 0xFFFFFFFF;
}

static inline int64_t high_half(int64_t both)
{
    return both >> 32;
}

/* Light and the half-way vector of Blinn's variant, along voxel axes, times 2^14. */
struct lamp {
    int32_t light[3], half[3];
    int32_t scale[3]; /* unit / spacing times 2^12: gradients per voxel to gradients per length */
    int64_t front, depth_range; /* of the scene, in crossings */
};

static void lamp_init(struct lamp *lamp, const struct camera *camera)
{
    int64_t half[3];
    uint64_t squares = 0;
    int64_t reach = 0;
    for (int a = 0; a < 3; a++) {
        /* 0.36 to the left, 0.48 up, 0.80 towards the viewer: a unit vector. */
        int64_t light = (-36 * (int64_t)camera->right[a] + 48 * (int64_t)camera->up[a] -
                         80 * (int64_t)camera->ahead[a]) /
                        100;
        lamp->light[a] = (int32_t)(light >> 16);
        half[a] = (light - camera->ahead[a]) >> 16;
        squares += (uint64_t)(half[a] * half[a]);
        lamp->scale[a] = (int32_t)((camera->unit_nm << 12) / (int64_t)camera->scene->spacing_nm[a]);
        /* Half the scene's length along this axis, seen along the ray. */
        int64_t pixels = (int64_t)camera->scene->grid.size[a] * camera->view.zoom *
                         (int64_t)(camera->scene->spacing_nm[a] / (uint32_t)camera->unit_nm) / 1000;
        reach += pixels * (camera->ahead[a] < 0 ? -camera->ahead[a] : camera->ahead[a]) >> 31;
    }
    int64_t length = fixed_root(squares);
    for (int a = 0; a < 3; a++)
        lamp->half[a] = (int32_t)(half[a] * (1 << 14) / length);
    lamp->front = -(reach << 26);
    lamp->depth_range = (reach + 1) << 27;
}

/* Seven shown bits along x around `at`, those beyond the row masked. */
static inline unsigned row_bits(const struct border *border, uint32_t at, unsigned mask)
{
    const uint32_t first = at - SHADE_RADIUS;
    const unsigned shift = first & 63;
    const uint64_t *word = border->shown + (first >> 6);
    uint64_t bits = word[0] >> shift;
    if (shift > 64 - WIDTH)
        bits |= word[1] << (64 - shift);
    return (unsigned)bits & mask;
}

/* Which of the seven places around `at` lie within 0..size - 1. */
static unsigned places_inside(int64_t at, int64_t size)
{
    unsigned mask = 0;
    for (int i = 0; i < WIDTH; i++)
        mask |= (unsigned)(at + i - SHADE_RADIUS >= 0 && at + i - SHADE_RADIUS < size) << i;
    return mask;
}

/* Minus the gradient of what is shown, per unit of length: outward, of no particular length. */
static void normal_at(const struct border *border, const struct row_sums *sums,
                      const struct lamp *lamp, uint32_t at, int64_t normal[3])
{
    const struct grid *grid = &border->scene->grid;
    const struct place p = grid_place(grid, at);
    const unsigned in_x = places_inside(p.x, grid->size[0]);
    const unsigned in_y = places_inside(p.y, grid->size[1]);
    const unsigned in_z = places_inside(p.z, grid->size[2]);
    int64_t g[3] = {0, 0, 0};
    for (int z = 0; z < WIDTH; z++) {
        if (!(in_z >> z & 1))
            continue;
        ptrdiff_t row =
            (ptrdiff_t)at + (z - SHADE_RADIUS) * grid->step[2] - SHADE_RADIUS * grid->step[1];
        int64_t smoothed = 0, along_y = 0; /* over y, both halves; and its derivative */
        for (int y = 0; y < WIDTH; y++, row += grid->step[1]) {
            if (!(in_y >> y & 1))
                continue;
            int64_t both = sums->of[row_bits(border, (uint32_t)row, in_x)];
            smoothed += smooth[y] * both;
            along_y += slope[y] * low_half(both);
        }
        g[0] += smooth[z] * high_half(smoothed);
        g[1] += smooth[z] * along_y;
        g[2] += slope[z] * low_half(smoothed);
    }
    for (int a = 0; a < 3; a++)
        normal[a] = -g[a] * lamp->scale[a];
}

/* The cosine between a normal of any length and a unit vector times 2^14; UNIT is 1. */
static int64_t cosine_to(const int64_t normal[3], int64_t length, const int32_t direction[3])
{
    int64_t dot = normal[0] * direction[0] + normal[1] * direction[1] + normal[2] * direction[2];
    return dot <= 0 ? 0 : dot * 2 / length;
}

static void colour_pixel(uint8_t rgba[4], const uint8_t base[3], int64_t brightness, int64_t gloss,
                         int64_t cue)
{
    for (int k = 0; k < 3; k++) {
        int64_t v = (base[k] * brightness / UNIT + gloss) * cue / UNIT;
        rgba[k] = (uint8_t)(v > 255 ? 255 : v);
    }
    rgba[3] = 255;
}

/* Brightness and gloss of one voxel: pixels of one voxel share them. */
struct reflection {
    uint32_t cell;
    int64_t brightness, gloss;
};

static void reflect(struct reflection *out, const struct border *border,
                    const struct row_sums *sums, const struct lamp *lamp, uint32_t cell)
{
    int64_t normal[3];
    normal_at(border, sums, lamp, cell, normal);
    int64_t length = fixed_root(
        (uint64_t)(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]));
    out->cell = cell;
    out->brightness = UNIT; /* a voxel as thick as thin shows no side: face the light */
    out->gloss = 0;
    if (length == 0)
        return;
    int64_t mirror = cosine_to(normal, length, lamp->half);
    for (int i = 0; i < SHINE; i++)
        mirror = mirror * mirror / UNIT;
    out->brightness = AMBIENT + DIFFUSE * cosine_to(normal, length, lamp->light) / UNIT;
    out->gloss = SPECULAR * mirror / UNIT;
}

static void shade_pixel(struct rendition *r, size_t pixel, const struct lamp *lamp,
                        const struct reflection *seen, const struct palette *palette)
{
    int64_t behind = r->depth[pixel] - lamp->front;
    behind = behind < 0 ? 0 : behind > lamp->depth_range ? lamp->depth_range : behind;
    int64_t cue = UNIT - CUE * (behind >> 15) / ((lamp->depth_range >> 15) + 1);
    colour_pixel(r->rgba + 4 * pixel, palette->rgb[r->label[pixel]], seen->brightness, seen->gloss,
                 cue);
}

static void shade_tile(struct rendition *r, uint32_t tile_x, uint32_t tile_y,
                       const struct border *border, const struct row_sums *sums,
                       const struct lamp *lamp, const struct palette *palette)
{
    uint32_t right = (tile_x + 1) * TILE < r->width ? (tile_x + 1) * TILE : r->width;
    uint32_t bottom = (tile_y + 1) * TILE < r->height ? (tile_y + 1) * TILE : r->height;
    struct reflection seen = {.cell = CELL_NONE};
    for (uint32_t y = tile_y * TILE; y < bottom; y++)
        for (uint32_t x = tile_x * TILE; x < right; x++) {
            size_t pixel = (size_t)y * r->width + x;
            if (r->cell[pixel] == CELL_NONE) {
                r->label[pixel] = 0;
                memset(r->rgba + 4 * pixel, 0, 4);
                continue;
            }
            if (seen.cell != r->cell[pixel])
                reflect(&seen, border, sums, lamp, r->cell[pixel]);
            r->label[pixel] = border->scene->cell[r->cell[pixel]].label;
            shade_pixel(r, pixel, lamp, &seen, palette);
        }
}

void shade(struct rendition *r, const struct camera *camera, const struct border *border,
           const struct palette *palette)
{
    struct row_sums sums;
    struct lamp lamp;
    fill_row_sums(&sums);
    lamp_init(&lamp, camera);
    struct task task = task_begin(border->scene->watch, "shading", (uint64_t)r->width * r->height);
    for (uint32_t y = 0; y < r->tiles_y && task_advance(&task, TILE * r->width); y++)
        for (uint32_t x = 0; x < r->tiles_x; x++) {
            uint8_t *stale = r->stale + (size_t)y * r->tiles_x + x;
            if (*stale)
                shade_tile(r, x, y, border, &sums, &lamp, palette);
            *stale = 0;
        }
}

void palette_default(struct palette *palette)
{
    /* Sky, amber, green, rose, violet, sand, teal, brick: told apart by lightness as well. */
    static const uint8_t hue[8][3] = {{214, 178, 150}, {86, 180, 233},  {240, 200, 66},
                                      {0, 158, 115},   {204, 121, 167}, {230, 130, 40},
                                      {130, 130, 220}, {190, 190, 190}};
    memset(palette, 0, sizeof *palette);
    for (int label = 1; label < 256; label++) {
        const uint8_t *base = hue[(label - 1) % 8];
        int dim = (label - 1) / 8 % 4; /* further rounds are darker */
        for (int k = 0; k < 3; k++)
            palette->rgb[label][k] = (uint8_t)(base[k] * (8 - dim) / 8);
    }
}
