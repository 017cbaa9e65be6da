#include "render/rendition.h"

#include "render/fixed.h"

/* A cube as the camera sees it: where its three near planes are crossed by the ray of pixel 0,0,
 * and where its centre falls, in pixels times 2^30. Linear in the cube's position. */
struct sight {
    int64_t near[3];
    int64_t centre[2];
};

static struct sight sight_of(const struct camera *camera, struct place p)
{
    const uint32_t at[3] = {p.x, p.y, p.z};
    struct sight sight = {{0, 0, 0}, {camera->centre[0], camera->centre[1]}};
    for (int a = 0; a < 3; a++) {
        int64_t n = camera->flip[a] ? (int64_t)camera->scene->grid.size[a] - 1 - at[a] : at[a];
        sight.near[a] = camera_crossing(camera, a, n, 0, 0);
        sight.centre[0] += n * camera->column[0][a];
        sight.centre[1] += n * camera->column[1][a];
    }
    return sight;
}

/* The same, `steps` voxels further along x. */
static inline struct sight sight_along(const struct camera *camera, const struct sight *from,
                                       int64_t steps)
{
    struct sight sight = *from;
    int64_t n = camera->flip[0] ? -steps : steps;
    sight.near[0] += n * camera->T[0];
    sight.centre[0] += n * camera->column[0][0];
    sight.centre[1] += n * camera->column[1][0];
    return sight;
}

static inline int32_t within(int64_t v, int64_t least, int64_t most)
{
    return (int32_t)(v < least ? least : v > most ? most : v);
}

/* Pixels within `cubes` half-widths of a cube around a centre. */
static inline struct footprint footprint_at(const struct camera *camera, const int64_t centre[2],
                                            int64_t cubes)
{
    const int64_t round_up = (INT64_C(1) << 30) - 1;
    const int64_t rx = cubes * camera->reach[0], ry = cubes * camera->reach[1];
    const int64_t w = camera->view.width, h = camera->view.height;
    return (struct footprint){within((centre[0] - rx + round_up) >> 30, 0, w),
                              within((centre[1] - ry + round_up) >> 30, 0, h),
                              within((centre[0] + rx) >> 30, -1, w - 1),
                              within((centre[1] + ry) >> 30, -1, h - 1)};
}

struct footprint splat_footprint(const struct camera *camera, uint32_t cell, int around)
{
    struct sight sight = sight_of(camera, grid_place(&camera->scene->grid, cell));
    return footprint_at(camera, sight.centre, 2 * around + 1);
}

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

/* Puts a cube into every pixel of its footprint whose ray is in it. */
static inline void splat_cube(struct rendition *r, const struct camera *camera, uint32_t cell,
                              const struct sight *sight)
{
    const struct footprint f = footprint_at(camera, sight->centre, 1);
    const int64_t *T = camera->T, *A = camera->A, *B = camera->B;
    for (int32_t y = f.top; y <= f.bottom; y++) {
        int64_t near0 = sight->near[0] + f.left * A[0] + y * B[0];
        int64_t near1 = sight->near[1] + f.left * A[1] + y * B[1];
        int64_t near2 = sight->near[2] + f.left * A[2] + y * B[2];
        size_t pixel = (size_t)y * r->width + (size_t)f.left;
        for (int32_t x = f.left; x <= f.right; x++, pixel++) {
            int64_t near = most_of(near0, near1, near2);
            int64_t far = least_of(near0 + T[0], near1 + T[1], near2 + T[2]);
            if (near < far && near < r->depth[pixel]) {
                r->depth[pixel] = near;
                r->cell[pixel] = cell;
            }
            near0 += A[0];
            near1 += A[1];
            near2 += A[2];
        }
    }
}

void splat_voxel(struct rendition *r, const struct camera *camera, uint32_t cell)
{
    struct sight sight = sight_of(camera, grid_place(&camera->scene->grid, cell));
    splat_cube(r, camera, cell, &sight);
}

/* A visible voxel shows a face whose neighbour is not shown: one of the three towards us. */
static inline bool faces_viewer(const struct camera *camera, const struct border *border,
                                uint32_t cell)
{
    return !border_shows(border, (uint32_t)(cell + camera->toward[0])) ||
           !border_shows(border, (uint32_t)(cell + camera->toward[1])) ||
           !border_shows(border, (uint32_t)(cell + camera->toward[2]));
}

/* Splats the cells of a bit set, in their order. */
static void splat_bits(struct rendition *r, const struct camera *camera,
                       const struct border *border, const uint64_t *bits, bool front_only)
{
    const struct grid *grid = &camera->scene->grid;
    struct sight row = {{0, 0, 0}, {0, 0}}; /* of the first voxel of the row at hand */
    uint32_t row_first = 0, row_end = 0;
    rendition_clear(r);
    struct task task = task_begin(border->scene->watch, "rendition", grid->cells);
    for (size_t w = 0; w < border->words && task_advance(&task, 64); w++)
        for (uint64_t word = bits[w]; word; word &= word - 1) {
            uint32_t cell = (uint32_t)(w * 64) + (uint32_t)__builtin_ctzll(word);
            if (front_only && !faces_viewer(camera, border, cell))
                continue;
            if (cell >= row_end) {
                struct place p = grid_place(grid, cell);
                row_first = cell - p.x;
                row_end = row_first + grid->size[0];
                row = sight_of(camera, (struct place){0, p.y, p.z});
            }
            struct sight sight = sight_along(camera, &row, cell - row_first);
            splat_cube(r, camera, cell, &sight);
        }
}

void splat_scene(struct rendition *r, const struct camera *camera, const struct border *border)
{
    splat_bits(r, camera, border, border->shown, false);
}

void splat_border(struct rendition *r, const struct camera *camera, const struct border *border)
{
    splat_bits(r, camera, border, border->border, true);
}
