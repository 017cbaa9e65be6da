/* SPDX-License-Identifier: MIT */
#include "render/mip.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "base/least.h"

enum { INTENSITIES = UINT16_MAX + 1, WHITE = 255 };

/* ---- rays ---- */

/*
 * The walk of a pixel's ray through the scene, from cube to cube.
 *
 * It proceeds from crossing to crossing in the order of (t, axis). At crossing `at` the ray is in
 * the cube whose flipped position along axis b is the number of planes of b, after plane 0, crossed
 * so far. Cubes are voxels, or blocks of 2^bits voxels a side counted from voxel 0: a walk of
 * blocks finds the blocks that are worth a walk of voxels.
 */
struct walk {
    int64_t at;                /* the crossing where the ray entered the cube */
    uint32_t cell;             /* the cube's voxel, or the number of the block, x fastest */
    uint32_t step[3];          /* from there to the next one along each axis */
    int64_t next[3], apart[3]; /* crossings of the next planes, and the distance between planes */
    int64_t end;               /* the crossing where the ray leaves the scene's cubes */
};

/* Return the blocks along an axis; the last one may extend beyond the scene. */
static uint32_t blocks_along(const struct grid *grid, int a, unsigned bits)
{
    return ((grid->size[a] - 1) >> bits) + 1;
}

/* Begin in the cube where the ray is at `from`, or where it enters the scene if that is later;
 * INT64_MIN starts before the scene. False if the ray misses it. */
static inline bool walk_begin(struct walk *walk, const struct camera *camera, unsigned bits,
                              uint32_t column, uint32_t row, int64_t from)
{
    const struct grid *grid = &camera->scene->grid;
    int64_t first[3], at = from;
    uint32_t step = 1;
    for (int a = 0; a < 3; a++) {
        first[a] = camera_crossing(camera, a, 0, column, row);
        at = first[a] > at ? first[a] : at;
    }
    walk->at = at;
    walk->cell = bits ? 0 : grid_cell(grid, 0, 0, 0);
    walk->end = INT64_MAX;
    for (int a = 0; a < 3; a++) {
        const int64_t cubes = blocks_along(grid, a, bits), apart = camera->T[a] * (1 << bits);
        if (camera->flip[a]) /* the first block begins before the scene */
            first[a] -= ((cubes << bits) - grid->size[a]) * camera->T[a];
        const int64_t n = (at - first[a]) / apart, end = first[a] + cubes * apart;
        if (n >= cubes)
            return false;
        walk->apart[a] = apart;
        walk->next[a] = first[a] + (n + 1) * apart;
        walk->end = end < walk->end ? end : walk->end;
        const uint32_t beyond = bits ? step : (uint32_t)grid->step[a];
        walk->step[a] = camera->flip[a] ? -beyond : beyond;
        walk->cell += (uint32_t)(camera->flip[a] ? cubes - 1 - n : n) * beyond;
        step *= (uint32_t)cubes;
    }
    return true;
}

/* Return the crossing where the ray leaves the cube. */
static inline int64_t walk_leaves(const struct walk *walk)
{
    const int64_t next = walk->next[0] < walk->next[1] ? walk->next[0] : walk->next[1];
    return next < walk->next[2] ? next : walk->next[2];
}

static inline void walk_cross(struct walk *walk, int a, int64_t at)
{
    const int64_t is_crossed = -(int64_t)(walk->next[a] == at);
    walk->next[a] += walk->apart[a] & is_crossed;
    walk->cell += walk->step[a] & (uint32_t)is_crossed;
}

/* Advance to the next cube; false when the ray leaves the scene. The axis is unpredictable, so
 * there is no branch for it. */
static inline bool walk_on(struct walk *walk)
{
    const int64_t at = walk_leaves(walk);
    if (at == walk->end)
        return false;
    walk->at = at;
    walk_cross(walk, 0, at);
    walk_cross(walk, 1, at);
    walk_cross(walk, 2, at);
    return true;
}

/* ---- memory ---- */

void mip_release(struct mip *mip)
{
    free(mip->grey);
    free(mip->brightness);
    *mip = (struct mip){0};
}

size_t mip_bytes(const struct mip *mip)
{
    return mip->bytes + (size_t)mip->view.width * mip->view.height;
}

/* Work shared by a team. */
struct drawing {
    struct mip *mip;
    const struct camera *camera;
    struct team *team;
    uint8_t grey_of[INTENSITIES];
};

/* ---- a byte for each voxel ---- */

static void fill_share(void *context, unsigned thread)
{
    const struct drawing *d = context;
    const struct scene *scene = d->mip->of.scene;
    const struct grid *grid = &scene->grid;
    const struct share planes = team_share(d->team, thread, grid->size[2]);
    struct task task = task_begin_part(scene->watch, "intensities", grid->voxels, thread);
    for (uint32_t z = (uint32_t)planes.first; z < planes.end; z++)
        for (uint32_t y = 0; y < grid->size[1] && task_advance(&task, grid->size[0]); y++) {
            const struct span row = grid_row(grid, y, z);
            for (uint32_t c = row.first; c < row.end; c++)
                d->mip->grey[c] = d->grey_of[scene->cell[c].intensity];
        }
}

/* Set voxels that are cut away to black. */
static enum err cut_away(struct mip *mip, struct fault *fault)
{
    const size_t cells = mip->of.scene->grid.cells, words = cells / 64 + 1;
    if (cut_is_none(&mip->of.cut))
        return OK;
    OWNED(mem_release) uint64_t *bits = mem_array(words, sizeof *bits);
    if (!bits)
        return fault_memory(fault, "the cut");
    memset(bits, UINT8_MAX, words * sizeof *bits);
    if (cut_clear(&mip->of.cut, mip->of.scene, bits))
        for (size_t c = 0; c < cells; c++)
            mip->grey[c] = bits[c / 64] >> (c % 64) & 1 ? mip->grey[c] : 0;
    return OK;
}

/* Planes of blocks are distributed to threads. */
static void find_most(void *context, unsigned thread)
{
    const struct drawing *d = context;
    const struct grid *grid = &d->mip->of.scene->grid;
    const uint32_t across = blocks_along(grid, 0, MIP_BLOCK_BITS);
    const uint32_t down = blocks_along(grid, 1, MIP_BLOCK_BITS);
    const struct share planes = team_share(d->team, thread, blocks_along(grid, 2, MIP_BLOCK_BITS));
    for (uint32_t z = (uint32_t)planes.first * MIP_BLOCK;
         z < planes.end * MIP_BLOCK && z < grid->size[2]; z++)
        for (uint32_t y = 0; y < grid->size[1]; y++) {
            const uint8_t *grey = d->mip->grey + grid_row(grid, y, z).first;
            uint8_t *most = d->mip->most + ((size_t)z / MIP_BLOCK * down + y / MIP_BLOCK) * across;
            for (uint32_t x = 0; x < grid->size[0]; x++)
                most[x / MIP_BLOCK] = grey[x] > most[x / MIP_BLOCK] ? grey[x] : most[x / MIP_BLOCK];
        }
}

static enum err take_source(struct drawing *d, const struct mip_source *source, struct fault *fault)
{
    struct mip *mip = d->mip;
    const struct mip_source *of = &mip->of;
    const int32_t *window = source->window;
    if (of->scene == source->scene && of->digest == source->digest && of->window[0] == window[0] &&
        of->window[1] == window[1] && memcmp(&of->cut, &source->cut, sizeof of->cut) == 0)
        return OK;
    mip_release(mip);
    const struct grid *grid = &source->scene->grid;
    size_t blocks = 1;
    for (int a = 0; a < 3; a++)
        blocks *= blocks_along(grid, a, MIP_BLOCK_BITS);
    mip->grey = mem_new(grid->cells + blocks);
    if (!mip->grey)
        return fault_memory(fault, "the scene's brightness");
    mip->most = mip->grey + grid->cells;
    mip->bytes = grid->cells + blocks;
    mip->of = *source;
    for (int64_t i = 0; i < INTENSITIES; i++) {
        const int64_t grey = (i - window[0]) * WHITE / ((int64_t)window[1] - window[0]);
        d->grey_of[i] = (uint8_t)(grey < 0 ? 0 : grey > WHITE ? WHITE : grey);
    }
    team_run(d->team, fill_share, d);
    TRY(cut_away(mip, fault));
    team_run(d->team, find_most, d);
    return watch_fault(source->scene->watch, fault);
}

/* ---- along the rays ---- */

/* The brightest voxel of a ray, and the crossing where the ray enters it. */
struct peak {
    int64_t at;
    uint8_t grey;
};

/* Search the voxels of a block for a brighter peak; the ray leaves the block at `end`. */
static struct peak look_into(const struct mip *mip, struct walk walk, int64_t end, struct peak peak)
{
    do
        if (mip->grey[walk.cell] > peak.grey)
            peak = (struct peak){walk.at, mip->grey[walk.cell]};
    while (walk_on(&walk) && walk.at < end);
    return peak;
}

/* Try the peak of the neighbouring ray first: fewer blocks are brighter than that. */
static struct peak brightest(const struct mip *mip, const struct camera *camera, uint32_t x,
                             uint32_t y, struct peak beside)
{
    struct walk blocks, walk;
    struct peak peak = {beside.at, 0};
    if (!walk_begin(&blocks, camera, MIP_BLOCK_BITS, x, y, INT64_MIN))
        return peak;
    if (beside.grey && walk_begin(&walk, camera, 0, x, y, beside.at))
        peak.grey = mip->grey[walk.cell];
    do
        if (mip->most[blocks.cell] > peak.grey && walk_begin(&walk, camera, 0, x, y, blocks.at))
            peak = look_into(mip, walk, walk_leaves(&blocks), peak);
    while (peak.grey < WHITE && walk_on(&blocks));
    return peak;
}

/* Draw every n-th row: rows in the middle take the most time. */
static void walk_share(void *context, unsigned thread)
{
    const struct drawing *d = context;
    const struct view *view = &d->camera->view;
    struct task task = task_begin_part(d->mip->of.scene->watch, "projection",
                                       (uint64_t)view->width * view->height, thread);
    for (uint32_t y = thread; y < view->height && task_advance(&task, view->width);
         y += team_size(d->team)) {
        struct peak peak = {0};
        for (uint32_t x = 0; x < view->width; x++) {
            peak = brightest(d->mip, d->camera, x, y, peak);
            d->mip->brightness[(size_t)y * view->width + x] = peak.grey;
        }
    }
}

enum err mip_draw(struct mip *mip, const struct mip_source *source, const struct camera *camera,
                  struct team *team, struct fault *fault)
{
    struct drawing d = {.mip = mip, .camera = camera, .team = team};
    const struct view *view = &camera->view;
    enum err err = take_source(&d, source, fault);
    if (!err && memcmp(&mip->view, view, sizeof *view) != 0) {
        free(mip->brightness);
        mip->brightness = mem_array((size_t)view->width * view->height, 1);
        if (mip->brightness)
            team_run(team, walk_share, &d);
        mip->view = *view;
        err = mip->brightness ? watch_fault(source->scene->watch, fault)
                              : fault_memory(fault, "a projection");
    }
    if (err)
        mip_release(mip);
    return err;
}

/* ---- behind objects ---- */

/* A colour and its alpha. */
struct tone {
    uint8_t level, alpha;
};

void mip_put_behind(uint8_t *out, const uint8_t *rgba, const uint8_t *brightness, size_t count)
{
    struct tone tone[WHITE + 1];
    /* Translucent below 64, with a brighter level in return. */
    for (uint32_t b = 0; b <= WHITE; b++) {
        const uint32_t alpha = b < 64 ? 4 * b : WHITE;
        const uint32_t level =
            alpha ? square_root(((uint64_t)WHITE * b * b + alpha / 2) / alpha) : 0;
        tone[b] = (struct tone){(uint8_t)level, (uint8_t)alpha};
    }
    for (size_t i = 0; i < count; i++, out += 4, rgba += 4) {
        const struct tone t = tone[brightness[i]];
        const uint8_t grey[4] = {t.level, t.level, t.level, t.alpha};
        if (rgba[3] == 0 || rgba[3] == WHITE)
            memcpy(out, rgba[3] ? rgba : grey, 4);
        else {
            const uint32_t front = WHITE * (uint32_t)rgba[3],
                           behind = (uint32_t)(WHITE - rgba[3]) * t.alpha;
            const uint32_t all = front + behind;
            for (int k = 0; k < 3; k++) {
                const uint64_t light =
                    (uint64_t)front * rgba[k] * rgba[k] + (uint64_t)behind * t.level * t.level;
                out[k] = all ? (uint8_t)square_root(light / all) : 0;
            }
            out[3] = (uint8_t)((all + WHITE / 2) / WHITE);
        }
    }
}
