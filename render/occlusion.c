/* SPDX-License-Identifier: MIT */
#include "render/occlusion.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "render/light.h"

enum {
    COARSEST = 16,  /* upper limit of the unit of the points' distances, in smallest spacings */
    FULL_BITS = 4,  /* BRICK_FULL to the 4096 of a brick */
    GRADUAL = 6000, /* part of LIGHT_UNIT: smaller occlusions are reduced gradually */
};

/* The points along the normal, the nearest first: distance in quarters of a brick; largest fullness
 * at a flat surface, of 4096; and occlusion by full surroundings, of LIGHT_UNIT. Fullness at the
 * surface measures how hollow it is; the distant points detect the other side of a sulcus. */
static const struct {
    int32_t away, flat, weight;
} points[OCCLUSION_POINTS] = {{0, 2112, 24000}, {3, 896, 40000}, {7, 130, 50000}};

/* ---- the bricks ---- */

/* Return the size of a brick along an axis: at most six smallest spacings. */
static unsigned brick_bits(const struct scene *scene, int a)
{
    const uint64_t least = view_unit(scene);
    unsigned bits = BRICK_BITS;
    while (bits > 0 && (uint64_t)scene->spacing_nm[a] << bits > 6 * least)
        bits--;
    return bits;
}

static size_t in_plane(const struct bricks *bricks)
{
    return (size_t)bricks->size[0] * bricks->size[1];
}

void bricks_release(struct bricks *bricks)
{
    free(bricks->full);
    *bricks = (struct bricks){0};
}

size_t bricks_bytes(const struct bricks *bricks)
{
    return in_plane(bricks) * (bricks->size[2] * 3 + 2 * sizeof *bricks->room) + bricks->size[2];
}

static enum err make_room(struct bricks *bricks, const struct border *border, struct fault *fault)
{
    bricks_release(bricks);
    for (int a = 0; a < 3; a++) {
        bricks->bits[a] = brick_bits(border->scene, a);
        bricks->size[a] =
            ((border->scene->grid.size[a] - 1) >> bricks->bits[a]) + 2 + 2 * BRICK_RIM;
    }
    const size_t plane = in_plane(bricks), all = plane * bricks->size[2];
    const struct mem_part parts[] = {{&bricks->full, all, sizeof *bricks->full},
                                     {&bricks->room, 2 * plane, sizeof *bricks->room},
                                     {&bricks->count, all, sizeof *bricks->count},
                                     {&bricks->stale, bricks->size[2], sizeof *bricks->stale}};
    if (!mem_parts(parts, sizeof parts / sizeof *parts)) {
        bricks_release(bricks);
        return fault_memory(fault, "ambient occlusion");
    }
    memset(bricks->full, 0, all * sizeof *bricks->full);
    memset(bricks->room, 0, 2 * plane * sizeof *bricks->room);
    memset(bricks->count, 0, all * sizeof *bricks->count);
    return OK;
}

/* Return the planes of voxels of a plane of bricks. */
static struct span planes_of(const struct bricks *bricks, uint32_t z)
{
    const uint32_t side = 1u << bricks->bits[2], all = bricks->border->scene->grid.size[2];
    const uint32_t first = (z - BRICK_RIM) * side;
    return (struct span){first, all - first < side ? all : first + side};
}

/* Return true if a word of any of its voxels has changed since. */
static bool is_stale(const struct bricks *bricks, uint32_t z)
{
    const struct border *border = bricks->border;
    const struct grid *grid = &border->scene->grid;
    const struct span planes = planes_of(bricks, z);
    const size_t first = grid_row(grid, 0, planes.first).first >> 6;
    const size_t last = grid_row(grid, grid->size[1] - 1, planes.end - 1).end >> 6;
    for (size_t w = first; w <= last; w++)
        if (border->changed[w] > bricks->version)
            return true;
    return false;
}

/* Add the shown voxels of a row to a row of bricks. */
static void count_row(uint8_t *count, const struct border *border, struct span row, unsigned bits)
{
    const unsigned side = 1u << bits;
    for (uint32_t c = row.first; c < row.end; c += 64) {
        uint64_t word = border_bits_at(border->shown, c);
        if (row.end - c < 64)
            word &= ~(UINT64_MAX << (row.end - c));
        if (bits > 0) /* count the bits of each group of 2^bits in place */
            word =
                (word & UINT64_C(0x5555555555555555)) + (word >> 1 & UINT64_C(0x5555555555555555));
        if (bits > 1)
            word =
                (word & UINT64_C(0x3333333333333333)) + (word >> 2 & UINT64_C(0x3333333333333333));
        for (uint8_t *brick = count; word; word >>= side, brick++)
            *brick = (uint8_t)(*brick + (word & ((1u << side) - 1)));
        count += 64 >> bits;
    }
}

static void count_plane(struct bricks *bricks, uint32_t z)
{
    const struct grid *grid = &bricks->border->scene->grid;
    const struct span planes = planes_of(bricks, z);
    uint8_t *plane = bricks->count + z * in_plane(bricks);
    memset(plane, 0, in_plane(bricks));
    for (uint32_t k = planes.first; k < planes.end; k++)
        for (uint32_t j = 0; j < grid->size[1]; j++) {
            const size_t row = BRICK_RIM + (j >> bricks->bits[1]);
            count_row(plane + row * bricks->size[0] + BRICK_RIM, bricks->border,
                      grid_row(grid, j, k), bricks->bits[0]);
        }
}

/* Smooth by 1 2 1 along each axis, over consecutive rows: the rim around the counts is empty. */
static void smooth_plane(struct bricks *bricks, uint32_t z)
{
    const size_t n = in_plane(bricks), row = bricks->size[0];
    const unsigned full = 3 * BRICK_BITS - bricks->bits[0] - bricks->bits[1] - bricks->bits[2];
    const uint8_t *count = bricks->count + z * n;
    uint16_t *along_z = bricks->room, *along_x = bricks->room + n, *out = bricks->full + z * n;
    for (size_t i = 0; i < n; i++)
        along_z[i] = (uint16_t)((*(count + i - n) + 2 * count[i] + count[i + n]) << full);
    for (size_t i = 1; i + 1 < n; i++)
        along_x[i] = (uint16_t)(along_z[i - 1] + 2 * along_z[i] + along_z[i + 1]);
    for (size_t i = row; i + row < n; i++)
        out[i] = (uint16_t)(along_x[i - row] + 2 * along_x[i] + along_x[i + row]);
}

enum err bricks_update(struct bricks *bricks, const struct border *border, struct fault *fault)
{
    if (bricks->border != border) {
        TRY(make_room(bricks, border, fault));
        bricks->border = border;
    }
    if (bricks->version != border->version) {
        /* Bricks of the rim are never stale, but are smoothed. */
        const uint32_t end = bricks->size[2] - BRICK_RIM - 1;
        memset(bricks->stale, 0, bricks->size[2]);
        for (uint32_t z = BRICK_RIM; z < end; z++) {
            bricks->stale[z] = is_stale(bricks, z);
            if (bricks->stale[z])
                count_plane(bricks, z);
        }
        for (uint32_t z = BRICK_RIM - 1; z <= end; z++)
            if (bricks->stale[z - 1] | bricks->stale[z] | bricks->stale[z + 1])
                smooth_plane(bricks, z);
        bricks->version = bricks->border->version;
    }
    return OK;
}

/* ---- around points ---- */

static inline int32_t between(int32_t from, int32_t to, int32_t part)
{
    return from * 256 + (to - from) * part;
}

uint32_t bricks_around(const struct bricks *bricks, const int32_t point[3])
{
    const size_t row = bricks->size[0], plane = in_plane(bricks);
    int32_t part[3], at_z[2];
    size_t first[3];
    for (int a = 0; a < 3; a++) {
        const unsigned bits = bricks->bits[a];
        const int64_t centre = ((int64_t)128 << bits) - 128; /* centre of brick 0 */
        const int64_t from = point[a] - centre + ((int64_t)(256 * BRICK_RIM) << bits);
        const int64_t most = ((int64_t)(bricks->size[a] - 1) << (8 + bits)) - 1;
        const int64_t at = from < 0 ? 0 : from > most ? most : from;
        first[a] = (size_t)(at >> (8 + bits));
        part[a] = (int32_t)(at >> bits & 255);
    }
    const uint16_t *at = bricks->full + first[2] * plane + first[1] * row + first[0];
    for (int z = 0; z < 2; z++, at += plane) {
        const int32_t low = between(at[0], at[1], part[0]);
        const int32_t high = between(at[row], at[row + 1], part[0]);
        at_z[z] = between(low, high, part[1]) >> 8;
    }
    return (uint32_t)(between(at_z[0], at_z[1], part[2]) >> (16 - FULL_BITS));
}

/* ---- of pixels ---- */

/* Return the distance of a point from the surface along an axis, in 1/256 voxels. The unit is a
 * quarter of the longest side of a brick, in smallest spacings times 256. */
static int32_t away_along(const struct scene *scene, int point, int a)
{
    const uint64_t least = view_unit(scene);
    uint64_t unit = 256;
    for (int b = 0; b < 3; b++) {
        const uint64_t own =
            (256 * (uint64_t)scene->spacing_nm[b] << brick_bits(scene, b)) / (least << BRICK_BITS);
        unit = own > unit ? own : unit;
    }
    unit = unit < COARSEST * 256 ? unit : COARSEST * 256;
    return (int32_t)(unit * (uint64_t)points[point].away * least / scene->spacing_nm[a]);
}

void occluder_init(struct occluder *occluder, const struct bricks *bricks,
                   const struct camera *camera, uint32_t percent)
{
    *occluder = (struct occluder){.bricks = bricks, .percent = percent};
    for (int a = 0; a < 3; a++) {
        occluder->locator[a] = locator_of(camera, a);
        for (int i = 0; i < OCCLUSION_POINTS; i++)
            occluder->away[i][a] = away_along(camera->scene, i, a);
    }
}

uint16_t occluder_light(const struct occluder *occluder, const int16_t normal[3], int64_t depth,
                        uint32_t x, uint32_t y)
{
    int32_t point[3];
    int64_t sum = 0;
    for (int a = 0; a < 3; a++)
        point[a] = locator_point(&occluder->locator[a], depth, x, y);
    for (int i = 0; i < OCCLUSION_POINTS; i++) {
        int32_t at[3];
        for (int a = 0; a < 3; a++)
            at[a] = point[a] + (int32_t)((int64_t)normal[a] * occluder->away[i][a] >> NORMAL_BITS);
        const int64_t full = bricks_around(occluder->bricks, at);
        sum += (full - (points[i].flat << FULL_BITS)) * points[i].weight;
    }
    sum /= BRICK_FULL;
    const int64_t part = sum <= 0        ? 0
                         : sum < GRADUAL ? sum * sum / (2 * GRADUAL)
                                         : sum - GRADUAL / 2;
    const int64_t occluded = part < LIGHT_UNIT ? part : LIGHT_UNIT;
    return (uint16_t)(LIGHT_UNIT - occluded * occluder->percent / 100);
}

int occlusion_reach(const struct scene *scene)
{
    int reach = 0;
    for (int a = 0; a < 3; a++) {
        /* A brick counts if its centre is within two and a half of its sides. */
        const int away = away_along(scene, OCCLUSION_POINTS - 1, a) / 256 + 1;
        const int own = away + (5 << brick_bits(scene, a)) / 2 + 1;
        reach = own > reach ? own : reach;
    }
    return reach;
}
