#include "render/rendition.h"

#include "render/fixed.h"

/* The position of a cell along the camera's flipped axes. */
static void flipped_place(const struct camera *camera, struct place p, int64_t n[3])
{
    const uint32_t at[3] = {p.x, p.y, p.z};
    for (int a = 0; a < 3; a++)
        n[a] = camera->flip[a] ? (int64_t)camera->scene->grid.size[a] - 1 - at[a] : at[a];
}

/* Pixels within `cubes` half-widths of a cube around the centre of the one at n. */
static struct footprint footprint_at(const struct camera *camera, const int64_t n[3], int64_t cubes)
{
    int64_t first[2], last[2];
    const int64_t most[2] = {(int64_t)camera->view.width - 1, (int64_t)camera->view.height - 1};
    for (int k = 0; k < 2; k++) {
        const int64_t *column = camera->column[k];
        int64_t centre = camera->centre[k] + n[0] * column[0] + n[1] * column[1] + n[2] * column[2];
        int64_t reach = cubes * camera->reach[k];
        first[k] = (centre - reach + ((INT64_C(1) << 30) - 1)) >> 30;
        last[k] = (centre + reach) >> 30;
        first[k] = first[k] < 0 ? 0 : first[k];
        last[k] = last[k] > most[k] ? most[k] : last[k];
    }
    if (first[0] > last[0] || first[1] > last[1])
        return (struct footprint){0, 0, -1, -1};
    return (struct footprint){(int32_t)first[0], (int32_t)first[1], (int32_t)last[0],
                              (int32_t)last[1]};
}

struct footprint splat_footprint(const struct camera *camera, uint32_t cell, int around)
{
    int64_t n[3];
    flipped_place(camera, grid_place(&camera->scene->grid, cell), n);
    return footprint_at(camera, n, 2 * around + 1);
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

/* Puts the cube at n into every pixel of its footprint whose ray is in it. */
static inline void splat_cube(struct rendition *r, const struct camera *camera, uint32_t cell,
                              const int64_t n[3])
{
    const struct footprint f = footprint_at(camera, n, 1);
    const int64_t *T = camera->T, *A = camera->A;
    for (int32_t y = f.top; y <= f.bottom; y++) {
        int64_t near0 = camera_crossing(camera, 0, n[0], f.left, y);
        int64_t near1 = camera_crossing(camera, 1, n[1], f.left, y);
        int64_t near2 = camera_crossing(camera, 2, n[2], f.left, y);
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
    int64_t n[3];
    flipped_place(camera, grid_place(&camera->scene->grid, cell), n);
    splat_cube(r, camera, cell, n);
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
    struct place p = {0, 0, 0};
    uint32_t row_end = 0; /* the cell behind the row of p */
    rendition_clear(r);
    for (size_t w = 0; w < border->words; w++)
        for (uint64_t word = bits[w]; word; word &= word - 1) {
            uint32_t cell = (uint32_t)(w * 64) + (uint32_t)__builtin_ctzll(word);
            if (front_only && !faces_viewer(camera, border, cell))
                continue;
            if (cell >= row_end) {
                p = grid_place(grid, cell);
                row_end = grid_row(grid, p.y, p.z).end;
            }
            p.x = cell - (row_end - grid->size[0]);
            int64_t n[3];
            flipped_place(camera, p, n);
            splat_cube(r, camera, cell, n);
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
