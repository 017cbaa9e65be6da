#include "render/rendition.h"

/* A cube as the camera sees it: where its three near planes are crossed by the ray of pixel 0,0,
 * and where its centre falls, in pixels times 2^30. Linear in the cube's position. */
struct projection {
    int64_t near[3];
    int64_t centre[2];
};

static struct projection project(const struct camera *camera, struct place p)
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
    struct projection seen = project(camera, grid_place(&camera->scene->grid, cell));
    const int64_t reach[2] = {(2 * around + 1) * camera->reach[0],
                              (2 * around + 1) * camera->reach[1]};
    return footprint_at(camera, seen.centre[0], seen.centre[1], reach);
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
    struct projection seen = project(camera, grid_place(&camera->scene->grid, cell));
    splat_cube(r, camera, cell, seen.near, splat_footprint(camera, cell, 0));
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

/* Goes through the rows of cells, from any to one further on in either order. */
struct sweep {
    const struct camera *camera;
    struct face_set set[FACE_SETS];
    uint32_t first, end;    /* cells of the row at hand, from voxel 0 to after its last, */
    struct projection seen; /* and what is seen of its voxel 0 */
    struct projection along_x, along_y; /* what one voxel along x or y adds */
};

static struct projection projection_between(const struct camera *camera, int a)
{
    const int64_t n = camera->flip[a] ? -1 : 1;
    struct projection seen = {{0, 0, 0}, {n * camera->column[0][a], n * camera->column[1][a]}};
    seen.near[a] = n * camera->T[a];
    return seen;
}

static void sweep_init(struct sweep *sweep, const struct camera *camera)
{
    *sweep = (struct sweep){.camera = camera};
    sweep->along_x = projection_between(camera, 0);
    sweep->along_y = projection_between(camera, 1);
    for (unsigned faces = 1; faces < FACE_SETS; faces++)
        sweep->set[faces] = face_set_of(camera, faces);
}

/* Most rows with something to show lie beside the one before: then nothing is divided. */
static void sweep_to_row(struct sweep *sweep, uint32_t cell)
{
    const struct grid *grid = &sweep->camera->scene->grid;
    const uint32_t next = sweep->first + (uint32_t)grid->step[1];
    if (cell >= next && cell < next + grid->size[0] && sweep->first) {
        sweep->first = next;
        sweep->seen.near[1] += sweep->along_y.near[1];
        for (int k = 0; k < 2; k++)
            sweep->seen.centre[k] += sweep->along_y.centre[k];
    } else {
        const struct place p = grid_place(grid, cell);
        sweep->first = cell - p.x;
        sweep->seen = project(sweep->camera, (struct place){0, p.y, p.z});
    }
    sweep->end = sweep->first + grid->size[0];
}

/* Splats the cell's faces; all of them are the cube. */
static inline void sweep_splat(struct sweep *sweep, struct rendition *r, uint32_t cell,
                               unsigned faces)
{
    if (cell >= sweep->end || cell < sweep->first)
        sweep_to_row(sweep, cell);
    const struct face_set *set = &sweep->set[faces];
    const struct projection *row = &sweep->seen, *along = &sweep->along_x;
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
static void splat_border_word(struct sweep *sweep, struct rendition *r, const struct border *border,
                              size_t w)
{
    const ptrdiff_t at = (ptrdiff_t)w * 64;
    const ptrdiff_t *toward = sweep->camera->toward;
    const uint64_t open0 = ~border_shown_from(border, at + toward[0]);
    const uint64_t open1 = ~border_shown_from(border, at + toward[1]);
    const uint64_t open2 = ~border_shown_from(border, at + toward[2]);
    uint64_t word = border->border[w] & (open0 | open1 | open2);
    for (; word; word &= word - 1) {
        const unsigned bit = (unsigned)__builtin_ctzll(word);
        const uint64_t faces =
            (open0 >> bit & 1) | (open1 >> bit & 1) << 1 | (open2 >> bit & 1) << 2;
        sweep_splat(sweep, r, (uint32_t)at + bit, (unsigned)faces);
    }
}

/* What is nearer comes first, as far as planes of voxels go: then most of what is hidden is found
 * to be so by one comparison. */
void splat_border(struct rendition *r, const struct camera *camera, const struct border *border)
{
    struct sweep sweep;
    sweep_init(&sweep, camera);
    rendition_clear(r);
    struct task task = task_begin(border->scene->watch, "rendition", border->scene->grid.cells);
    for (size_t i = 0; i < border->words && task_advance(&task, 64); i++) {
        const size_t w = camera->flip[2] ? border->words - 1 - i : i;
        if (border->border[w])
            splat_border_word(&sweep, r, border, w);
    }
}
