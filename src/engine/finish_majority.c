/* SPDX-License-Identifier: MIT */
/*
 * The majority filter. Most voxels lie in the middle of one label: where a cube holds one label
 * alone nothing is counted, and that is seen for eight voxels at once. Elsewhere a count of labels
 * slides along the row.
 */
#include "engine/finish.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

struct filter {
    const struct finish_work *work;
    const struct finish_step *step;
    uint32_t reach[3];
    uint8_t *varied; /* [workers][varied_bytes], of the row at hand */
    size_t varied_bytes;
};

/* The rows that the cubes of a row's voxels reach over. */
struct rows {
    uint32_t y, z; /* the row */
    uint32_t first_y, last_y, first_z, last_z;
};

static uint32_t below(uint32_t at, uint32_t reach)
{
    return at < reach ? 0 : at - reach;
}

static uint32_t above(uint32_t at, uint32_t reach, uint32_t size)
{
    return size - 1 - at < reach ? size - 1 : at + reach;
}

static struct rows rows_around(const struct filter *f, uint32_t y, uint32_t z)
{
    const uint32_t *size = f->work->scene->grid.size;
    return (struct rows){y,
                         z,
                         below(y, f->reach[1]),
                         above(y, f->reach[1], size[1]),
                         below(z, f->reach[2]),
                         above(z, f->reach[2], size[2])};
}

/* ---- where labels vary ---- */

static uint64_t eight(const uint8_t *at)
{
    uint64_t bytes;
    memcpy(&bytes, at, sizeof bytes);
    return bytes;
}

/* varied[x] is not 0 where a voxel at x of one of the rows has not the label of this row's, or the
 * next voxel of this row has not. */
static void find_varied(const struct filter *f, const struct rows *rows, uint8_t *varied)
{
    const struct grid *grid = &f->work->scene->grid;
    const uint8_t *label = f->work->label, *here = label + grid_cell(grid, 0, rows->y, rows->z);
    const uint32_t length = grid->size[0];
    for (uint32_t x = 0; x < length; x += 8) {
        const uint64_t own = eight(here + x);
        uint64_t differs = own ^ eight(here + x + 1);
        for (uint32_t z = rows->first_z; z <= rows->last_z; z++)
            for (uint32_t y = rows->first_y; y <= rows->last_y; y++)
                differs |= own ^ eight(label + grid_cell(grid, x, y, z));
        memcpy(varied + x, &differs, sizeof differs);
    }
    memset(varied + length - 1, 0, 8);
    for (uint32_t z = rows->first_z; z <= rows->last_z; z++)
        for (uint32_t y = rows->first_y; y <= rows->last_y; y++)
            varied[length - 1] |=
                (uint8_t)(here[length - 1] ^ label[grid_cell(grid, length - 1, y, z)]);
}

/* ---- counting ---- */

/* Of the labels in a cube, and those that were in it since it was counted from nothing. */
struct votes {
    uint32_t count[256];
    uint8_t seen[256];
    unsigned seens;
    bool is_seen[256];
    uint32_t first, end; /* the columns that are counted */
};

static void votes_clear(struct votes *votes)
{
    for (unsigned i = 0; i < votes->seens; i++) {
        votes->count[votes->seen[i]] = 0;
        votes->is_seen[votes->seen[i]] = false;
    }
    votes->seens = 0;
    votes->first = votes->end = 0;
}

/* The columns first..end-1, from those that are counted. */
static void slide_votes(struct votes *votes, const struct filter *f, const struct rows *rows,
                        uint32_t first, uint32_t end)
{
    if (votes->end <= first) {
        votes_clear(votes);
        votes->first = votes->end = first;
    }
    while (votes->end < end) {
        const uint32_t x = votes->end++;
        for (uint32_t z = rows->first_z; z <= rows->last_z; z++)
            for (uint32_t y = rows->first_y; y <= rows->last_y; y++) {
                const uint8_t label = f->work->label[grid_cell(&f->work->scene->grid, x, y, z)];
                votes->count[label]++;
                if (!votes->is_seen[label])
                    votes->seen[votes->seens++] = label;
                votes->is_seen[label] = true;
            }
    }
    while (votes->first < first) {
        const uint32_t x = votes->first++;
        for (uint32_t z = rows->first_z; z <= rows->last_z; z++)
            for (uint32_t y = rows->first_y; y <= rows->last_y; y++)
                votes->count[f->work->label[grid_cell(&f->work->scene->grid, x, y, z)]]--;
    }
}

/* ---- rows ---- */

/* Writes the labels of the voxels x..end-1, around each of which labels may vary. */
static void vote_on_run(const struct filter *f, const struct rows *rows, struct votes *votes,
                        uint32_t x, uint32_t end)
{
    const struct grid *grid = &f->work->scene->grid;
    const uint32_t reach = f->reach[0], row = grid_cell(grid, 0, rows->y, rows->z);
    for (; x < end; x++) {
        const uint8_t own = f->work->label[row + x];
        slide_votes(votes, f, rows, below(x, reach), above(x, reach, grid->size[0]) + 1);
        uint8_t best = own;
        for (unsigned i = 0; i < votes->seens; i++) {
            const uint8_t label = votes->seen[i];
            const uint32_t count = votes->count[label], most = votes->count[best];
            if (count > most || (count == most && best != own && label < best))
                best = label;
        }
        if (finish_is_for(f->step, own) || finish_is_for(f->step, best))
            f->work->next[row + x] = best;
    }
}

static void filter_part(void *context, unsigned worker)
{
    const struct filter *f = context;
    const struct scene *scene = f->work->scene;
    const struct grid *grid = &scene->grid;
    const struct slab slab = grid_slab(grid, worker, team_size(f->work->team));
    const uint64_t side = (2 * (uint64_t)f->reach[1] + 1) * (2 * (uint64_t)f->reach[2] + 1);
    uint8_t *varied = f->varied + worker * f->varied_bytes;
    struct votes votes = {.seens = 0};
    struct task task =
        task_begin_part(scene->watch, "majority of labels", 0, worker); /* some rows take longer */
    for (uint32_t z = slab.first; z < slab.end; z++)
        for (uint32_t y = 0; y < grid->size[1]; y++) {
            const struct rows rows = rows_around(f, y, z);
            const struct span row = grid_row(grid, y, z);
            memcpy(f->work->next + row.first, f->work->label + row.first, grid->size[0]);
            votes_clear(&votes);
            /* Vote only where labels vary: varied[] has the columns from x - reach to x + reach. */
            const uint32_t length = f->work->scene->grid.size[0], reach = f->reach[0];
            uint64_t voted = 0;
            uint32_t done = 0;
            find_varied(f, &rows, varied);
            for (uint32_t x = 0; x < length; x++) {
                if (x % 8 == 0 && x + 8 <= length && !eight(varied + x)) {
                    x += 7;
                    continue;
                }
                if (!varied[x])
                    continue;
                const uint32_t first = below(x, reach) > done ? below(x, reach) : done;
                const uint32_t end = above(x, reach, length) + 1;
                vote_on_run(f, &rows, &votes, first, end);
                voted += end - first;
                done = end;
            }
            if (!task_advance(&task, grid->size[0] + (grid->size[0] + voted * 8) * side / 64))
                return;
        }
}

enum err finish_majority(struct finish_work *work, const struct finish_step *step,
                         struct fault *fault)
{
    const struct grid *grid = &work->scene->grid;
    struct filter filter = {.work = work, .step = step};
    finish_reach(filter.reach, step, work->scene);
    filter.varied_bytes = ((size_t)grid->size[0] + 16 + 63) / 64 * 64;
    filter.varied = mem_array(filter.varied_bytes, team_size(work->team));
    if (!filter.varied)
        return fault_memory(fault, "finished labels");
    team_run(work->team, filter_part, &filter);
    free(filter.varied);
    finish_take_next(work);
    return watch_fault(work->scene->watch, fault);
}
