#include "render/cover.h"
#include "render/layers.h"
#include "render/sweep.h"

struct footprint splat_footprint(const struct camera *camera, uint32_t cell, int around)
{
    struct projection seen = project(camera, grid_place(&camera->scene->grid, cell));
    const int64_t reach[2] = {(2 * around + 1) * camera->reach[0],
                              (2 * around + 1) * camera->reach[1]};
    return footprint_at(camera, seen.centre[0], seen.centre[1], reach);
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
            int64_t *depth = r->cube.depth + row + x;
            if (first < *depth && first < least_of(near0 + T0, near1 + T1, near2 + T2)) {
                *depth = first;
                r->cube.cell[row + (size_t)x] = cell;
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

/* ---- by several threads ---- */

enum { WORDS_APART = 61, ROWS_MOST = 4 * VIEW_SIDE_MOST / TILE };

struct splatting {
    const struct rendition *rendition;
    const struct camera *camera;
    const struct border *border;
    uint32_t first[TEAM_MOST + 1]; /* rows of tiles of each thread, to those of the next */
};

/* Counts, by row of tiles, some of the border voxels, and adds what clearing a row takes. */
static void count_work(uint32_t work[ROWS_MOST], const struct splatting *s)
{
    const struct grid *grid = &s->camera->scene->grid;
    const int64_t last = (int64_t)s->rendition->tiles_y - 1;
    for (int64_t y = 0; y <= last; y++)
        work[y] = 1 + s->rendition->width / 512;
    for (size_t w = 0; w < s->border->words; w += WORDS_APART) {
        if (!s->border->border[w])
            continue;
        const uint32_t cell = (uint32_t)(w * 64) + (uint32_t)__builtin_ctzll(s->border->border[w]);
        const int64_t row = project(s->camera, grid_place(grid, cell)).centre[1] >> 30;
        if (row >= 0 && row / TILE <= last)
            work[row / TILE]++;
    }
}

/* Each thread has about as much to do, and pixels of its own. */
static void share_rows(struct splatting *s, unsigned threads)
{
    uint32_t work[ROWS_MOST], y = 0;
    uint64_t all = 0, before = 0;
    count_work(work, s);
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
