#include "render/cover.h"

#include <string.h>

#include "render/sweep.h"
#include "render/walk.h"

enum { WORD = 64, SIDE = 1 << BORDER_BLOCK_BITS };

struct covering {
    const struct rendition *r;
    const struct border *border;
    struct sweep sweep;
    size_t words; /* of a row of `uncovered` */
};

/* Of 64 pixels from column x on, those of a footprint, which has some of them. */
static inline uint64_t word_mask(struct footprint f, int32_t x)
{
    const uint64_t all = ~UINT64_C(0);
    const uint64_t from = x < f.left ? all << (f.left - x) : all;
    return x + WORD - 1 > f.right ? from & all >> (x + WORD - 1 - f.right) : from;
}

static bool is_covered(const struct covering *c, struct footprint f)
{
    uint64_t left = 0;
    for (int32_t x = f.left & -WORD; x <= f.right; x += WORD) {
        const uint64_t mask = word_mask(f, x);
        for (int32_t y = f.top; y <= f.bottom && !left; y++)
            left = c->r->uncovered[(size_t)y * c->words + (size_t)x / WORD] & mask;
    }
    return !left;
}

/* ---- a cube ---- */

/* Gives the cube those of some pixels, from column x on in row y, whose ray is in it; the others
 * are given back. */
static inline uint64_t cover_pixels(const struct covering *c, uint32_t cell, const int64_t near[3],
                                    int32_t x, int32_t y, uint64_t pixels)
{
    const struct camera *camera = c->sweep.camera;
    const int64_t *A = camera->A, *B = camera->B, *T = camera->T;
    const size_t row = (size_t)y * c->r->width;
    uint64_t others = pixels;
    for (; pixels; pixels &= pixels - 1) {
        const int64_t column = x + __builtin_ctzll(pixels);
        const int64_t near0 = near[0] + column * A[0] + y * B[0];
        const int64_t near1 = near[1] + column * A[1] + y * B[1];
        const int64_t near2 = near[2] + column * A[2] + y * B[2];
        const int64_t first = most_of(near0, near1, near2);
        if (first < least_of(near0 + T[0], near1 + T[1], near2 + T[2])) {
            c->r->cube.depth[row + (size_t)column] = first;
            c->r->cube.cell[row + (size_t)column] = cell;
            others ^= pixels & -pixels;
        }
    }
    return others;
}

static inline void cover_faces(struct covering *c, uint32_t cell, unsigned faces)
{
    int64_t near[3];
    const struct footprint f = sweep_to(&c->sweep, cell, faces, near);
    for (int32_t x = f.left & -WORD; x <= f.right; x += WORD) {
        const uint64_t mask = word_mask(f, x);
        uint64_t *word = c->r->uncovered + (size_t)f.top * c->words + (size_t)x / WORD;
        for (int32_t y = f.top; y <= f.bottom; y++, word += c->words) {
            const uint64_t left = *word & mask;
            if (left)
                *word ^= left ^ cover_pixels(c, cell, near, x, y, left);
        }
    }
}

/* ---- blocks ---- */

/* Number i of so many in the order of the camera. */
static inline uint32_t in_order(const struct camera *camera, int a, uint32_t i, uint32_t count)
{
    return camera->flip[a] ? count - 1 - i : i;
}

/* A pixel shows a face whose neighbour is not solid: one of the three towards us. So voxels without
 * such a face are left out, and of the others, such faces are looked at alone. */
static void cover_row(struct covering *c, struct place first, uint32_t cell, unsigned hull)
{
    const struct camera *camera = c->sweep.camera;
    unsigned open[3], left = 0;
    for (int a = 0; a < 3; a++) {
        const uint32_t beside = cell + (uint32_t)camera->toward[a];
        open[a] = hull & ~(unsigned)border_bits_at(c->border->solid, beside);
        left |= open[a];
    }
    if (left)
        sweep_at_row(&c->sweep, first.y, first.z);
    for (unsigned bit; left; left &= ~(1u << bit)) {
        bit = (unsigned)(camera->flip[0] ? 31 - __builtin_clz(left) : __builtin_ctz(left));
        cover_faces(c, cell + bit,
                    (open[0] >> bit & 1) | (open[1] >> bit & 1) << 1 | (open[2] >> bit & 1) << 2);
    }
}

/* The pixels that cubes of a block may cover: its middle is half a voxel from one of them. */
static struct footprint footprint_of(const struct camera *camera, struct place first)
{
    enum { MIDDLE = SIDE / 2 - 1 };
    struct projection seen =
        project(camera, (struct place){first.x + MIDDLE, first.y + MIDDLE, first.z + MIDDLE});
    int64_t reach[2];
    for (int k = 0; k < 2; k++) {
        reach[k] = SIDE * camera->reach[k];
        for (int a = 0; a < 3; a++)
            seen.centre[k] += (camera->flip[a] ? -1 : 1) * camera->column[k][a] / 2;
    }
    return footprint_at(camera, seen.centre[0], seen.centre[1], reach);
}

/* Whether it does not even touch the edge of the picture. */
static bool is_within(const struct camera *camera, struct footprint f)
{
    const int32_t right = (int32_t)camera->view.width - 1,
                  bottom = (int32_t)camera->view.height - 1;
    return f.left > 0 && f.top > 0 && f.right < right && f.bottom < bottom;
}

static uint32_t voxels_along(const struct grid *grid, int a, uint32_t first)
{
    return grid->size[a] - first < SIDE ? grid->size[a] - first : SIDE;
}

static void cover_block(struct covering *c, struct place first)
{
    const struct camera *camera = c->sweep.camera;
    const struct grid *grid = &camera->scene->grid;
    const struct footprint f = footprint_of(camera, first);
    if (is_covered(c, f))
        return;
    c->sweep.is_within = is_within(camera, f);
    const uint32_t rows = voxels_along(grid, 1, first.y), planes = voxels_along(grid, 2, first.z);
    const unsigned all = (1u << voxels_along(grid, 0, first.x)) - 1;
    for (uint32_t k = 0; k < planes; k++)
        for (uint32_t j = 0; j < rows; j++) {
            const struct place p = {first.x, first.y + in_order(camera, 1, j, rows),
                                    first.z + in_order(camera, 2, k, planes)};
            const uint32_t cell = grid_cell(grid, p.x, p.y, p.z);
            const unsigned hull = (unsigned)border_bits_at(c->border->hull, cell) & all;
            if (hull)
                cover_row(c, p, cell, hull);
        }
}

/* ---- all of them ---- */

static void cover_plane(struct covering *c, uint32_t z, const uint32_t blocks[3])
{
    const uint8_t *occupied = c->border->occupied + (size_t)z * blocks[1] * blocks[0];
    for (uint32_t i = 0; i < blocks[1]; i++)
        for (uint32_t j = 0; j < blocks[0]; j++) {
            const uint32_t y = in_order(c->sweep.camera, 1, i, blocks[1]);
            const uint32_t x = in_order(c->sweep.camera, 0, j, blocks[0]);
            if (occupied[(size_t)y * blocks[0] + x])
                cover_block(c, (struct place){x * SIDE, y * SIDE, z * SIDE});
        }
}

void cover_by_border(struct task *task, struct rendition *r, const struct camera *camera,
                     const struct border *border)
{
    const struct grid *grid = &border->scene->grid;
    struct covering c = {.r = r, .border = border, .words = rendition_words(r)};
    uint32_t blocks[3];
    for (int a = 0; a < 3; a++)
        blocks[a] = walk_blocks(grid, a, BORDER_BLOCK_BITS);
    sweep_init(&c.sweep, camera);
    rendition_clear(r);
    memset(r->uncovered, UINT8_MAX, r->height * c.words * sizeof *r->uncovered);
    for (uint32_t i = 0; i < blocks[2] && task_advance(task, grid->cells / blocks[2]); i++)
        cover_plane(&c, in_order(camera, 2, i, blocks[2]), blocks);
}
