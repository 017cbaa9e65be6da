#include "render/projection.h"

#include <string.h>

#include "render/layers.h"
#include "render/seams.h"
#include "render/sweep.h"
#include "render/walk.h"

/* ---- scene projection ---- */

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
            int64_t *depth = r->cube.depth + row + x;
            if (first < *depth && first < least_of(near0 + T0, near1 + T1, near2 + T2)) {
                *depth = first;
                r->cube.cell[row + (size_t)x] = cell;
            }
            near0 += A0, near1 += A1, near2 += A2;
        }
    }
}

void splat_scene(struct rendition *r, const struct camera *camera, const struct border *border)
{
    if (layers_are_projected(r)) {
        layers_splat_scene(r, camera, border);
        return;
    }
    struct sweep sweep;
    sweep_init(&sweep, camera);
    rendition_clear(r);
    struct task task = task_begin(border->scene->watch, "rendition", border->scene->grid.cells);
    for (size_t w = 0; w < border->words && task_advance(&task, 64); w++)
        for (uint64_t word = border->solid[w]; word; word &= word - 1) {
            const uint32_t cell = (uint32_t)(w * 64) + (uint32_t)__builtin_ctzll(word);
            int64_t near[3];
            const struct footprint f = sweep_to(&sweep, cell, FACE_SETS - 1, near);
            splat_cube(r, camera, cell, near, f);
        }
}

/* ---- border projection ---- */

/* A ray runs towards larger numbers along every axis as the camera counts them (render/view.h), and
 * so from cube to cube, and from block to block of cubes. So the order of these numbers, by one
 * axis and where they are the same by the next, is that of cubes along any ray. */

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

static uint32_t voxels_along(const struct grid *grid, int a, uint32_t first)
{
    return grid->size[a] - first < SIDE ? grid->size[a] - first : SIDE;
}

static void cover_block(struct covering *c, struct place first)
{
    const struct camera *camera = c->sweep.camera;
    const struct grid *grid = &camera->scene->grid;
    /* The pixels that cubes of a block may cover: its middle is half a voxel from one of them. */
    enum { MIDDLE = SIDE / 2 - 1 };
    struct projection seen =
        project(camera, (struct place){first.x + MIDDLE, first.y + MIDDLE, first.z + MIDDLE});
    int64_t reach[2];
    for (int k = 0; k < 2; k++) {
        reach[k] = SIDE * camera->reach[k];
        for (int a = 0; a < 3; a++)
            seen.centre[k] += (camera->flip[a] ? -1 : 1) * camera->column[k][a] / 2;
    }
    const struct footprint f = footprint_at(camera, seen.centre[0], seen.centre[1], reach);
    const int64_t right = (int64_t)camera->view.width - 1,
                  bottom = (int64_t)camera->view.height - 1;
    if (is_covered(c, f))
        return;
    c->sweep.is_within = f.left > 0 && f.top > 0 && f.right < right && f.bottom < bottom;
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

/* The first cube of each pixel, where no layers are projected. */
static void cover_by_border(struct task *task, struct rendition *r, const struct camera *camera,
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
    for (uint32_t k = 0; k < blocks[2] && task_advance(task, grid->cells / blocks[2]); k++)
        for (uint32_t i = 0; i < blocks[1]; i++)
            for (uint32_t j = 0; j < blocks[0]; j++) {
                const uint32_t z = in_order(camera, 2, k, blocks[2]);
                const uint32_t y = in_order(camera, 1, i, blocks[1]);
                const uint32_t x = in_order(camera, 0, j, blocks[0]);
                if (border->occupied[((size_t)z * blocks[1] + y) * blocks[0] + x])
                    cover_block(&c, (struct place){x * SIDE, y * SIDE, z * SIDE});
            }
}

static void splat_under(struct task *task, struct rendition *r, const struct camera *camera,
                        const struct border *border)
{
    if (layers_are_projected(r))
        layers_splat_border(task, r, camera, border);
    else
        cover_by_border(task, r, camera, border);
}

void splat_border(struct rendition *r, const struct camera *camera, const struct border *border)
{
    struct task task = task_begin(border->scene->watch, "rendition", border->scene->grid.cells);
    splat_under(&task, r, camera, border);
}

void splat_border_quietly(struct rendition *r, const struct camera *camera,
                          const struct border *border)
{
    struct task task = task_begin_part(border->scene->watch, NULL, 0, 1);
    splat_under(&task, r, camera, border);
}

/* ---- the same by several threads ---- */

enum { WORDS_APART = 61, ROWS_MOST = 4 * VIEW_SIDE_MOST / TILE };

struct splatting {
    const struct rendition *rendition;
    const struct camera *camera;
    const struct border *border;
    uint32_t first[TEAM_MOST + 1]; /* rows of tiles of each thread, to those of the next */
};

/* Each thread has about as much to do, and pixels of its own. */
static void share_rows(struct splatting *s, unsigned threads)
{
    uint32_t work[ROWS_MOST], y = 0;
    uint64_t all = 0, before = 0;
    /* Counts, by row of tiles, some of the border voxels, and adds what clearing a row takes. */
    const struct grid *grid = &s->camera->scene->grid;
    const int64_t last = (int64_t)s->rendition->tiles_y - 1;
    for (int64_t i = 0; i <= last; i++)
        work[i] = 1 + s->rendition->width / 512;
    for (size_t w = 0; w < s->border->words; w += WORDS_APART) {
        if (!s->border->border[w])
            continue;
        const uint32_t cell = (uint32_t)(w * 64) + (uint32_t)__builtin_ctzll(s->border->border[w]);
        const int64_t row = project(s->camera, grid_place(grid, cell)).centre[1] >> 30;
        if (row >= 0 && row / TILE <= last)
            work[row / TILE]++;
    }
    for (uint32_t i = 0; i < s->rendition->tiles_y; i++)
        all += work[i];
    for (unsigned i = 1; i < threads; i++) {
        while (y < s->rendition->tiles_y && before + work[y] / 2 < all * i / threads)
            before += work[y++];
        s->first[i] = y;
    }
    s->first[0] = 0;
    s->first[threads] = s->rendition->tiles_y;
}

static void splat_share(void *context, unsigned thread)
{
    const struct splatting *s = context;
    const uint32_t top = s->first[thread] * TILE, end = s->first[thread + 1] * TILE;
    const uint32_t height = (end < s->rendition->height ? end : s->rendition->height) - top;
    if (end <= top)
        return;
    struct rendition part = rendition_rows(s->rendition, top, height);
    struct layers layers;
    if (s->rendition->layers) {
        layers = layers_rows(s->rendition->layers, top);
        part.layers = &layers;
    }
    const struct camera camera = camera_rows(s->camera, top, height);
    struct task task =
        task_begin_part(s->border->scene->watch, "rendition", s->border->scene->grid.cells, thread);
    splat_under(&task, &part, &camera, s->border);
}

void splat_border_shared(struct rendition *r, const struct camera *camera,
                         const struct border *border, struct team *team)
{
    struct splatting s = {.rendition = r, .camera = camera, .border = border};
    if (team_size(team) == 1 || r->tiles_y > ROWS_MOST) {
        splat_border(r, camera, border);
        return;
    }
    share_rows(&s, team_size(team));
    team_run(team, splat_share, &s);
}

/* ---- the ray walk ---- */

/* Most blocks of voxels on its way are empty. */
bool raycast_pixel(const struct camera *camera, const struct border *border, uint32_t column,
                   uint32_t row, int64_t from, int64_t *depth, uint32_t *cell)
{
    struct walk blocks, walk;
    if (!walk_begin(&blocks, camera, BORDER_BLOCK_BITS, column, row, from))
        return false;
    do {
        if (!border->occupied[blocks.cell] || !walk_begin(&walk, camera, 0, column, row, blocks.at))
            continue;
        const int64_t end = walk_leaves(&blocks);
        do {
            if (border_is_solid(border, walk.cell)) {
                *depth = walk.at;
                *cell = walk.cell;
                return true;
            }
        } while (walk_on(&walk) && walk.at < end);
    } while (walk_on(&blocks));
    return false;
}

void raycast(struct rendition *r, const struct camera *camera, const struct border *border)
{
    const bool has_layers = layers_are_projected(r);
    const uint32_t *size = border->scene->grid.size;
    const uint64_t row = r->width * ((uint64_t)size[0] + size[1] + size[2]); /* steps at most */
    if (has_layers)
        layers_clear(r);
    else
        rendition_clear(r);
    struct task task = task_begin(border->scene->watch, "rendition", row * r->height);
    for (uint32_t y = 0; y < r->height && task_advance(&task, row); y++)
        for (uint32_t x = 0; x < r->width; x++) {
            const size_t pixel = (size_t)y * r->width + x;
            if (has_layers)
                layers_walk(r->layers, camera, border, pixel);
            else
                raycast_pixel(camera, border, x, y, INT64_MIN, &r->cube.depth[pixel],
                              &r->cube.cell[pixel]);
        }
}

void splat_voxel(struct rendition *r, const struct camera *camera, uint32_t cell)
{
    struct projection seen = project(camera, grid_place(&camera->scene->grid, cell));
    splat_cube(r, camera, cell, seen.near, splat_footprint(camera, cell, 0));
}
