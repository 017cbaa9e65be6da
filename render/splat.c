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

static inline int32_t within(int64_t v, int64_t least, int64_t most)
{
    return (int32_t)(v < least ? least : v > most ? most : v);
}

/* Pixels within `reach` of a place in the picture. */
static inline struct footprint footprint_at(const struct camera *camera, int64_t x, int64_t y,
                                            const int64_t reach[2])
{
    const int64_t round_up = (INT64_C(1) << 30) - 1;
    const int64_t w = camera->view.width, h = camera->view.height;
    return (struct footprint){within((x - reach[0] + round_up) >> 30, 0, w),
                              within((y - reach[1] + round_up) >> 30, 0, h),
                              within((x + reach[0]) >> 30, -1, w - 1),
                              within((y + reach[1]) >> 30, -1, h - 1)};
}

struct footprint splat_footprint(const struct camera *camera, uint32_t cell, int around)
{
    struct sight sight = sight_of(camera, grid_place(&camera->scene->grid, cell));
    const int64_t reach[2] = {(2 * around + 1) * camera->reach[0],
                              (2 * around + 1) * camera->reach[1]};
    return footprint_at(camera, sight.centre[0], sight.centre[1], reach);
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

/* Puts a cube into every pixel of a footprint whose ray is in it. */
static inline void splat_cube(struct rendition *r, const struct camera *camera, uint32_t cell,
                              const int64_t near[3], struct footprint f)
{
    const int64_t T0 = camera->T[0], T1 = camera->T[1], T2 = camera->T[2];
    const int64_t A0 = camera->A[0], A1 = camera->A[1], A2 = camera->A[2];
    for (int32_t y = f.top; y <= f.bottom; y++) {
        int64_t near0 = near[0] + f.left * A0 + y * camera->B[0];
        int64_t near1 = near[1] + f.left * A1 + y * camera->B[1];
        int64_t near2 = near[2] + f.left * A2 + y * camera->B[2];
        const size_t row = (size_t)y * r->width;
        for (int32_t x = f.left; x <= f.right; x++) {
            const int64_t first = most_of(near0, near1, near2);
            int64_t *depth = r->depth + row + x;
            if (first < *depth && first < least_of(near0 + T0, near1 + T1, near2 + T2)) {
                *depth = first;
                r->cell[row + (size_t)x] = cell;
            }
            near0 += A0, near1 += A1, near2 += A2;
        }
    }
}

void splat_voxel(struct rendition *r, const struct camera *camera, uint32_t cell)
{
    struct sight sight = sight_of(camera, grid_place(&camera->scene->grid, cell));
    splat_cube(r, camera, cell, sight.near, splat_footprint(camera, cell, 0));
}

/* ---- whole sets of voxels ---- */

/* The near faces of a cube that may be seen, bit a for that across axis a, and where their
 * footprint lies from the cube's centre. */
enum { NEAR_FACES = 3, FACE_SETS = 1 << NEAR_FACES };

struct face_set {
    int64_t from_centre[2], reach[2];
};

/* A face is a parallelogram: half a cube nearer along its axis, and half a cube each way along the
 * others. */
static struct face_set face_set_of(const struct camera *camera, unsigned faces)
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
        set.from_centre[k] = left + (right - left) / 2;
        set.reach[k] = (right - left) / 2 + 1;
    }
    return set;
}

/* Goes through rows of cells in their order; `sight` is that of the row's voxel 0. */
struct sweep {
    const struct camera *camera;
    struct face_set set[FACE_SETS];
    struct sight sight;
    uint32_t first, end; /* cells of the row, from voxel 0 to behind its last */
    struct sight along;  /* what one voxel along x adds */
};

static void sweep_init(struct sweep *sweep, const struct camera *camera)
{
    *sweep = (struct sweep){.camera = camera};
    const int64_t n = camera->flip[0] ? -1 : 1;
    sweep->along.near[0] = n * camera->T[0];
    for (int k = 0; k < 2; k++)
        sweep->along.centre[k] = n * camera->column[k][0];
    for (unsigned faces = 1; faces < FACE_SETS; faces++)
        sweep->set[faces] = face_set_of(camera, faces);
}

static void sweep_to_row(struct sweep *sweep, uint32_t cell)
{
    const struct grid *grid = &sweep->camera->scene->grid;
    const struct place p = grid_place(grid, cell);
    sweep->first = cell - p.x;
    sweep->end = sweep->first + grid->size[0];
    sweep->sight = sight_of(sweep->camera, (struct place){0, p.y, p.z});
}

/* Splats the cell's faces; all of them are the cube. */
static inline void sweep_splat(struct sweep *sweep, struct rendition *r, uint32_t cell,
                               unsigned faces)
{
    if (cell >= sweep->end)
        sweep_to_row(sweep, cell);
    const struct face_set *set = &sweep->set[faces];
    const struct sight *row = &sweep->sight, *along = &sweep->along;
    const int64_t x = cell - sweep->first;
    const int64_t near[3] = {row->near[0] + x * along->near[0], row->near[1], row->near[2]};
    const struct footprint f =
        footprint_at(sweep->camera, row->centre[0] + x * along->centre[0] + set->from_centre[0],
                     row->centre[1] + x * along->centre[1] + set->from_centre[1], set->reach);
    splat_cube(r, sweep->camera, cell, near, f);
}

void splat_scene(struct rendition *r, const struct camera *camera, const struct border *border)
{
    struct sweep sweep;
    sweep_init(&sweep, camera);
    rendition_clear(r);
    struct task task = task_begin(border->scene->watch, "rendition", border->scene->grid.cells);
    for (size_t w = 0; w < border->words && task_advance(&task, 64); w++)
        for (uint64_t word = border->shown[w]; word; word &= word - 1)
            sweep_splat(&sweep, r, (uint32_t)(w * 64) + (uint32_t)__builtin_ctzll(word),
                        FACE_SETS - 1);
}

/* A pixel shows a face whose neighbour is not shown: one of the three towards us. So voxels without
 * such a face are left out, and of the others, such faces are splatted alone. */
void splat_border(struct rendition *r, const struct camera *camera, const struct border *border)
{
    struct sweep sweep;
    sweep_init(&sweep, camera);
    rendition_clear(r);
    struct task task = task_begin(border->scene->watch, "rendition", border->scene->grid.cells);
    for (size_t w = 0; w < border->words && task_advance(&task, 64); w++) {
        uint64_t word = border->border[w];
        if (!word)
            continue;
        uint64_t open[NEAR_FACES];
        for (int a = 0; a < NEAR_FACES; a++)
            open[a] = ~border_shown_from(border, (ptrdiff_t)w * 64 + camera->toward[a]);
        for (word &= open[0] | open[1] | open[2]; word; word &= word - 1) {
            const unsigned bit = (unsigned)__builtin_ctzll(word);
            const unsigned faces = (unsigned)((open[0] >> bit & 1) | (open[1] >> bit & 1) << 1 |
                                              (open[2] >> bit & 1) << 2);
            sweep_splat(&sweep, r, (uint32_t)(w * 64) + bit, faces);
        }
    }
}
