/*
 * The sweep: where in the picture the faces of each voxel may be seen, for voxels in the order of
 * their cells.
 *
 * What is seen of a voxel is linear in its place, so most of it follows from the voxel before by
 * additions. Splatting puts the result into depth buffers (render/projection.c,
 * render/layers.c).
 */
#ifndef RENDER_SWEEP_H
#define RENDER_SWEEP_H

#include "render/rendition.h"

/* A cube as the camera sees it: where its three near planes are crossed by the ray of pixel 0,0,
 * and where its centre falls, in pixels times 2^30. Linear in the cube's position. */
struct projection {
    int64_t near[3];
    int64_t centre[2];
};

static inline struct projection project(const struct camera *camera, struct place p)
{
    const uint32_t at[3] = {p.x, p.y, p.z};
    struct projection seen = {{0, 0, 0}, {camera->centre[0], camera->centre[1]}};
    for (int a = 0; a < 3; a++) {
        int64_t n = camera->flip[a] ? (int64_t)camera->scene->grid.size[a] - 1 - at[a] : at[a];
        seen.near[a] = camera_crossing(camera, a, n, 0, 0);
        seen.centre[0] += n * camera->column[0][a];
        seen.centre[1] += n * camera->column[1][a];
    }
    return seen;
}

static inline int32_t sweep_within(int64_t v, int64_t least, int64_t most)
{
    return (int32_t)(v < least ? least : v > most ? most : v);
}

enum { SWEEP_ROUND_UP = (1 << 30) - 1 };

/* The pixels between two places each way, of which the former are rounded up. */
static inline struct footprint footprint_between(const struct camera *camera, int64_t left,
                                                 int64_t top, int64_t right, int64_t bottom)
{
    const int64_t w = camera->view.width, h = camera->view.height;
    return (struct footprint){sweep_within(left >> 30, 0, w), sweep_within(top >> 30, 0, h),
                              sweep_within(right >> 30, -1, w - 1),
                              sweep_within(bottom >> 30, -1, h - 1)};
}

/* Pixels within `reach` of a place in the picture. */
static inline struct footprint footprint_at(const struct camera *camera, int64_t x, int64_t y,
                                            const int64_t reach[2])
{
    return footprint_between(camera, x - reach[0] + SWEEP_ROUND_UP, y - reach[1] + SWEEP_ROUND_UP,
                             x + reach[0], y + reach[1]);
}

/* The pixels that the cube of a voxel may cover, within the picture, widened to what the cubes
 * of voxels up to `around` steps away may cover. */
static inline struct footprint splat_footprint(const struct camera *camera, uint32_t cell,
                                               int around)
{
    const struct projection seen = project(camera, grid_place(&camera->scene->grid, cell));
    const int64_t reach[2] = {(2 * around + 1) * camera->reach[0],
                              (2 * around + 1) * camera->reach[1]};
    return footprint_at(camera, seen.centre[0], seen.centre[1], reach);
}

/* ---- rows of voxels ---- */

/* The near faces of a cube that may be seen, bit a for that across axis a, and from where to where
 * their footprint lies, from the cube's centre. */
enum { NEAR_FACES = 3, FACE_SETS = 1 << NEAR_FACES };

struct face_set {
    int64_t from[2], to[2]; /* the former is rounded up */
};

/* A face is a parallelogram: half a cube nearer along its axis, and half a cube each way along the
 * others. */
static inline struct face_set face_set_of(const struct camera *camera, unsigned faces)
{
    struct face_set set;
    for (int k = 0; k < 2; k++) {
        int64_t left = INT64_MAX, right = INT64_MIN;
        for (int a = 0; a < 3; a++) {
            if (!(faces >> a & 1))
                continue;
            const int64_t size =
                camera->column[k][a] < 0 ? -camera->column[k][a] : camera->column[k][a];
            const int64_t middle = -camera->column[k][a] / 2;
            const int64_t reach = camera->reach[k] - size / 2;
            left = middle - reach < left ? middle - reach : left;
            right = middle + reach > right ? middle + reach : right;
        }
        const int64_t middle = left + (right - left) / 2, reach = (right - left) / 2 + 1;
        set.from[k] = middle - reach + SWEEP_ROUND_UP;
        set.to[k] = middle + reach;
    }
    return set;
}

/* Goes through the rows of cells, from any to one further on in either order. */
struct sweep {
    const struct camera *camera;
    struct face_set set[FACE_SETS];
    uint32_t first, end;    /* cells of the row at hand, from voxel 0 to after its last, */
    bool is_within;         /* whether all pixels that its cubes may cover are in the picture, */
    struct projection seen; /* and what is seen of its voxel 0 */
    struct projection along_x, along_y; /* what one voxel along x or y adds */
};

static inline struct projection projection_between(const struct camera *camera, int a)
{
    const int64_t n = camera->flip[a] ? -1 : 1;
    struct projection seen = {{0, 0, 0}, {n * camera->column[0][a], n * camera->column[1][a]}};
    seen.near[a] = n * camera->T[a];
    return seen;
}

static inline void sweep_init(struct sweep *sweep, const struct camera *camera)
{
    *sweep = (struct sweep){.camera = camera};
    sweep->along_x = projection_between(camera, 0);
    sweep->along_y = projection_between(camera, 1);
    for (unsigned faces = 1; faces < FACE_SETS; faces++)
        sweep->set[faces] = face_set_of(camera, faces);
}

/* To the row of voxels (., y, z), all but whether it is within the picture. */
static inline void sweep_at_row(struct sweep *sweep, uint32_t y, uint32_t z)
{
    const struct span row = grid_row(&sweep->camera->scene->grid, y, z);
    sweep->first = row.first;
    sweep->end = row.end;
    sweep->seen = project(sweep->camera, (struct place){0, y, z});
}

/* Where pixels that cubes of the row at hand may cover lie along a side of the picture: those of
 * cells `from` to `to` of it, counted from its first. */
static inline void sweep_reach(const struct sweep *sweep, int k, int64_t from, int64_t to,
                               int64_t reach[2])
{
    const int64_t first = sweep->seen.centre[k], along = sweep->along_x.centre[k];
    const int64_t a = first + from * along, b = first + to * along;
    const int64_t around = sweep->camera->reach[k] + 2; /* a face's is rounded up */
    reach[0] = (a < b ? a : b) - around;
    reach[1] = (a > b ? a : b) + around;
}

/* Most rows with something to show lie beside the one before: then nothing is divided. */
static inline void sweep_to_row(struct sweep *sweep, uint32_t cell)
{
    const struct grid *grid = &sweep->camera->scene->grid;
    const uint32_t next = sweep->first + (uint32_t)grid->step[1];
    if (cell >= next && cell < next + grid->size[0] && sweep->first) {
        sweep->first = next;
        sweep->end = next + grid->size[0];
        sweep->seen.near[1] += sweep->along_y.near[1];
        for (int k = 0; k < 2; k++)
            sweep->seen.centre[k] += sweep->along_y.centre[k];
    } else {
        const struct place p = grid_place(grid, cell);
        sweep_at_row(sweep, p.y, p.z);
    }
    const uint32_t extent[2] = {sweep->camera->view.width, sweep->camera->view.height};
    sweep->is_within = true;
    for (int k = 0; k < 2; k++) {
        int64_t reach[2];
        sweep_reach(sweep, k, 0, (int64_t)(sweep->end - sweep->first) - 1, reach);
        sweep->is_within &= reach[0] >= 0 && reach[1] < ((int64_t)extent[k] - 1) << 30;
    }
}

/* Which pixels the cell's faces may cover; all of them are the cube. `near` is where the three near
 * planes of the cube are crossed by the ray of pixel 0,0. */
static inline struct footprint sweep_to(struct sweep *sweep, uint32_t cell, unsigned faces,
                                        int64_t near[3])
{
    if (cell >= sweep->end || cell < sweep->first)
        sweep_to_row(sweep, cell);
    const struct face_set *set = &sweep->set[faces];
    const struct projection *row = &sweep->seen, *along = &sweep->along_x;
    const int64_t x = cell - sweep->first;
    near[0] = row->near[0] + x * along->near[0];
    near[1] = row->near[1];
    near[2] = row->near[2];
    const int64_t column = row->centre[0] + x * along->centre[0];
    const int64_t line = row->centre[1] + x * along->centre[1];
    const int64_t left = column + set->from[0], right = column + set->to[0];
    const int64_t top = line + set->from[1], bottom = line + set->to[1];
    if (!sweep->is_within)
        return footprint_between(sweep->camera, left, top, right, bottom);
    return (struct footprint){(int32_t)(left >> 30), (int32_t)(top >> 30), (int32_t)(right >> 30),
                              (int32_t)(bottom >> 30)};
}

/* Takes the cells of the first row there are out of a word of them, which is not 0, the sweep to
 * that row, and gives those back; 0 where the picture shows none, as it may be a part of one. */
static inline uint64_t sweep_take_row(struct sweep *sweep, size_t w, uint64_t *word)
{
    const uint32_t at = (uint32_t)(w * 64), first = at + (uint32_t)__builtin_ctzll(*word);
    if (first >= sweep->end || first < sweep->first)
        sweep_to_row(sweep, first);
    const uint64_t beyond = sweep->end < at + 64 ? ~UINT64_C(0) << (sweep->end - at) : 0;
    const uint64_t row = *word & ~beyond;
    *word &= beyond;
    const uint32_t last = at + 63 - (uint32_t)__builtin_clzll(row);
    const uint32_t extent[2] = {sweep->camera->view.width, sweep->camera->view.height};
    for (int k = 0; k < 2 && !sweep->is_within; k++) {
        int64_t reach[2];
        sweep_reach(sweep, k, first - sweep->first, last - sweep->first, reach);
        if (reach[1] < 0 || reach[0] > (int64_t)extent[k] << 30)
            return 0;
    }
    return row;
}

/* ---- cubes ---- */

static inline int64_t most_of(int64_t a, int64_t b, int64_t c)
{
    int64_t m = a > b ? a : b;
    return m > c ? m : c;
}

static inline int64_t least_of(int64_t a, int64_t b, int64_t c)
{
    int64_t m = a < b ? a : b;
    return m < c ? m : c;
}

#endif
