/* SPDX-License-Identifier: MIT */
#include "render/edge.h"

#include "render/light.h"

enum {
    DEPTH_BITS = 26 - 8, /* dropped from depths of 4 * 2^24 to a pixel, to leave 256 */
    STEEPEST = 16 * 256, /* steepest slope that may explain a depth */
    FOLD_VOXELS = 3,
    ROUGH = 5, /* unexplained difference of depths, in half voxels */
};

/* Normals at 65 degrees are a fold: 1 - cos 65, where 2^28 is 1. */
static const int64_t FOLD_LEAST = (INT64_C(1) << 28) * 577 / 1000;

static int64_t fold_of(const struct camera *camera)
{
    return FOLD_VOXELS * normal_stride(camera);
}

int edge_reach(const struct camera *camera, uint32_t samples)
{
    return (int)(fold_of(camera) + 2 * samples);
}

void edges_init(struct edges *edges, const struct rendition *rendition, const struct camera *camera,
                uint32_t samples)
{
    *edges = (struct edges){rendition, camera, samples, 256, fold_of(camera), {{{0}}}};
    for (int i = 0; i < 2 * TILE; i++)
        edges->run[i / TILE][i % TILE].line = -1;
    for (int a = 0; a < 3; a++) {
        const int64_t side = (int64_t)camera->view.zoom * 256 / VIEW_ZOOM_ONE *
                             (camera->scene->spacing_nm[a] / camera->unit_nm);
        edges->voxel = side > edges->voxel ? side : edges->voxel;
    }
}

/* ---- two pixels ---- */

/* A direction across the picture: step to the right and down, and its length in 256ths. */
struct way {
    int64_t right, down, length;
};

static bool step(const struct edges *edges, size_t *to, uint32_t x, uint32_t y,
                 const struct way *way, int64_t steps)
{
    const int64_t column = x + steps * way->right, row = y + steps * way->down;
    if (column < 0 || row < 0 || column >= edges->rendition->width ||
        row >= edges->rendition->height)
        return false;
    *to = (size_t)row * edges->rendition->width + (size_t)column;
    return true;
}

static int64_t dot30(const int16_t normal[3], const int32_t direction[3])
{
    int64_t sum = 0;
    for (int a = 0; a < 3; a++)
        sum += (int64_t)normal[a] * direction[a];
    return sum >> 30;
}

/* Return the slope of the surface at a pixel along a direction, in 256ths; at least 0. */
static int64_t slope_at(const struct edges *edges, size_t pixel, const struct way *way)
{
    const int16_t *normal = edges->rendition->normal + 4 * pixel;
    const int64_t toward = -dot30(normal, edges->camera->ahead);
    const int64_t along = way->right * dot30(normal, edges->camera->right) -
                          way->down * dot30(normal, edges->camera->up);
    if (along <= 0)
        return 0;
    const int64_t fall = along * 65536 / way->length;
    return toward <= fall / STEEPEST ? STEEPEST : fall / toward;
}

/* Return true if `back`, `steps` steps from `front`, is further behind it than the flatter of the
 * two slopes explains, with an allowance for the roughness of voxels. */
static bool is_behind(const struct edges *edges, size_t front, size_t back, const struct way *way,
                      int64_t steps)
{
    const int64_t *depth = edges->rendition->depth;
    if (depth[front] == DEPTH_NONE || depth[back] == DEPTH_NONE)
        return depth[front] < depth[back]; /* the background is behind everything */
    const int64_t fall = (depth[back] - depth[front]) >> DEPTH_BITS;
    if (fall <= edges->voxel * ROUGH / 2)
        return false;
    const int64_t one = slope_at(edges, front, way), other = slope_at(edges, back, way);
    const int64_t slope = one < other ? one : other;
    return fall > ((steps * way->length + edges->voxel) * slope >> 8) + edges->voxel * ROUGH / 2;
}

static struct way reversed(const struct way *way)
{
    return (struct way){-way->right, -way->down, way->length};
}

/* ---- hiding ---- */

/* Return true if a pixel has a dark line because of another. */
static bool is_dark(const struct edges *edges, size_t here, size_t there, const struct way *way,
                    int64_t steps)
{
    const struct rendition *r = edges->rendition;
    const struct way back = reversed(way);
    return is_behind(edges, here, there, way, steps) ||
           (r->label[here] < r->label[there] && !is_behind(edges, there, here, &back, steps));
}

static const struct way around[4] = {{1, 0, 256}, {0, 1, 256}, {-1, 0, 256}, {0, -1, 256}};

static enum edge hiding_at(const struct edges *edges, uint32_t x, uint32_t y)
{
    const struct rendition *r = edges->rendition;
    const size_t here = (size_t)y * r->width + x;
    enum edge edge = EDGE_NONE;
    for (int i = 0; i < 4; i++)
        for (int64_t steps = 1; steps <= 2 * edges->width; steps++) {
            size_t there;
            if (!step(edges, &there, x, y, &around[i], steps))
                break;
            if (r->cell[there] == CELL_NONE && steps <= edges->width)
                return EDGE_LIGHT;
            if (r->cell[there] == CELL_NONE ||
                (steps <= edges->width && is_dark(edges, here, there, &around[i], steps)))
                edge = EDGE_DARK;
        }
    return edge;
}

/* ---- folds ---- */

/* Return true if a pixel and the next one in a direction show one surface of one object. */
static bool is_joined(const struct edges *edges, uint32_t x, uint32_t y, const struct way *way)
{
    const struct rendition *r = edges->rendition;
    const struct way back = reversed(way);
    const size_t from = (size_t)y * r->width + x;
    size_t to;
    return step(edges, &to, x, y, way, 1) && r->label[to] == r->label[from] &&
           !is_behind(edges, from, to, way, 1) && !is_behind(edges, to, from, &back, 1);
}

/* Return true if a row (0) or column (1) shows one surface for `pixels` pixels to both sides. */
static bool is_one(struct edges *edges, uint32_t x, uint32_t y, int axis, int64_t pixels)
{
    const int64_t at = axis ? y : x, line = axis ? x : y;
    struct edge_run *run = &edges->run[axis][line % TILE];
    if (run->line != line || at < run->first || at > run->last)
        *run = (struct edge_run){line, at, at, false, false};
    while (run->last < at + pixels && !run->ends) {
        const uint32_t place = (uint32_t)run->last;
        run->ends = !is_joined(edges, axis ? x : place, axis ? place : y, &around[axis]);
        run->last += !run->ends;
    }
    while (run->first > at - pixels && !run->begins) {
        const uint32_t place = (uint32_t)run->first;
        run->begins = !is_joined(edges, axis ? x : place, axis ? place : y, &around[axis + 2]);
        run->first -= !run->begins;
    }
    return run->last >= at + pixels && run->first <= at - pixels;
}

/* Return the turn between the normals on both sides of a pixel, where 2^28 is 1; -1 outside the
 * picture. */
static int64_t turn_at(const struct edges *edges, uint32_t x, uint32_t y, int axis)
{
    const struct rendition *r = edges->rendition;
    size_t one, other;
    if (!step(edges, &one, x, y, &around[axis], edges->fold) ||
        !step(edges, &other, x, y, &around[axis + 2], edges->fold))
        return -1;
    int64_t cosine = 0;
    for (int a = 0; a < 3; a++)
        cosine += (int64_t)r->normal[4 * one + (size_t)a] * r->normal[4 * other + (size_t)a];
    return (INT64_C(1) << 28) - cosine;
}

/* Return true at a maximum of the turn, as wide as a line: a line's width to either side it is no
 * larger. All of it must be one surface. */
static bool is_crest(struct edges *edges, uint32_t x, uint32_t y, int axis)
{
    const int64_t turn = turn_at(edges, x, y, axis), width = edges->width;
    if (turn < FOLD_LEAST)
        return false;
    for (int64_t side = -1; side <= 1; side += 2) {
        size_t beside;
        if (!step(edges, &beside, x, y, &around[axis], side * width))
            return false;
        const int64_t there = axis ? turn_at(edges, x, (uint32_t)(y + side * width), axis)
                                   : turn_at(edges, (uint32_t)(x + side * width), y, axis);
        if (there < 0 || there > turn || (there == turn && side < 0))
            return false;
    }
    return is_one(edges, x, y, axis, edges->fold + width);
}

enum edge edge_at(struct edges *edges, uint32_t x, uint32_t y)
{
    const enum edge edge = hiding_at(edges, x, y);
    if (edge == EDGE_NONE && (is_crest(edges, x, y, 0) || is_crest(edges, x, y, 1)))
        return EDGE_DARK;
    return edge;
}
