/* SPDX-License-Identifier: MIT */
/* The steps on the neighbourhood of each voxel: majority, open and close. */
#include "engine/finish.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "engine/brush.h"

/*
 * The majority filter. Most voxels are far from any border: a cube with one label only needs no
 * count, which is tested for eight voxels at once. Elsewhere a histogram of labels slides along the
 * row.
 */

struct filter {
    const struct finish_work *work;
    const struct finish_step *step;
    uint32_t reach[3];
    uint8_t *varied; /* [workers][varied_bytes], for the current row */
    size_t varied_bytes;
};

/* The rows that intersect the cubes of a row's voxels. */
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
    return (struct rows){.y = y,
                         .z = z,
                         .first_y = below(y, f->reach[1]),
                         .last_y = above(y, f->reach[1], size[1]),
                         .first_z = below(z, f->reach[2]),
                         .last_z = above(z, f->reach[2], size[2])};
}

/* ---- rows with several labels ---- */

static uint64_t eight(const uint8_t *at)
{
    uint64_t bytes;
    memcpy(&bytes, at, sizeof bytes);
    return bytes;
}

/* Set varied[x] to a non-zero value if a voxel at x of one of the rows differs from this row's, or
 * this row's next voxel does. */
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

/* ---- histogram ---- */

/* Histogram of the labels in a cube, and the labels that it has contained since it was cleared. */
struct votes {
    uint32_t count[256];
    uint8_t seen[256];
    unsigned seens;
    bool is_seen[256];
    uint32_t first, end; /* the columns in the histogram */
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

/* Slide the histogram to the columns first..end-1. */
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

/* Write the labels of the voxels x..end-1, whose cubes may contain several labels. */
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
    const uint32_t length = f->work->scene->grid.size[0], reach = f->reach[0];
    const uint64_t side = (2 * (uint64_t)f->reach[1] + 1) * (2 * (uint64_t)f->reach[2] + 1);
    uint8_t *varied = f->varied + worker * f->varied_bytes;
    struct votes votes = {.seens = 0};
    struct grid_walk w = scene_walk(f->work->scene, "majority of labels", f->work->team, worker);
    w.task.total = 0; /* some rows need more time */
    while (grid_walk_next(&w)) {
        const struct rows rows = rows_around(f, w.y, w.z);
        memcpy(f->work->next + w.row.first, f->work->label + w.row.first, length);
        votes_clear(&votes);
        /* Vote only where labels vary: varied[] is set for columns from x - reach to x + reach. */
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
        task_advance(&w.task, (length + voted * 8) * side / 64);
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
    uint8_t *const made = work->next;
    work->next = work->label;
    work->label = made;
    return watch_fault(work->scene->watch, fault);
}

/*
 * Opening and closing by a ball. Closing a label is opening its complement, so one function serves
 * both: it finds the voxels of a set that no ball inside the set covers. The step removes them.
 *
 *     left out     the voxels of the scene that are not in the set
 *     centres      of the balls inside the set: no voxel left out is in the ball around them
 *     covered      the voxels in a ball around a centre
 *     lost         in the set, and not covered
 *
 * Sets are bits, and a ball is a list of rows of voxels, so that 64 voxels are processed at once.
 * Labels are processed one after another, each in the rows that contain it, and those around.
 */

struct shape {
    struct finish_work *work;
    struct brush brush;
    bool opens;                 /* else closes */
    size_t words;               /* words in a row; bits beyond the row are 0 */
    uint64_t *left;             /* [rows of the scene][words]: voxels left out */
    uint64_t *ball;             /* likewise: centres */
    uint64_t *room;             /* [workers][2][words] */
    struct finish_box box[256]; /* bounding boxes of labels */
    unsigned label;             /* current label */

    /* Applied to each of these rows along y and z. */
    void (*make)(const struct shape *s, uint32_t y, uint32_t z, uint64_t *room);
    uint32_t first[2], last[2];
};

static uint64_t *row_of(const struct shape *s, uint64_t *sheet, uint32_t y, uint32_t z)
{
    return sheet + ((size_t)z * s->work->scene->grid.size[1] + y) * s->words;
}

/* ---- rows of bits ---- */

static uint64_t last_mask(const struct shape *s)
{
    const unsigned bits = s->work->scene->grid.size[0] % 64;
    return bits ? (UINT64_C(1) << bits) - 1 : UINT64_MAX;
}

/* Set `out` to the voxels of the row that are in a ball around a voxel of `in`. */
static void cover_row(const struct shape *s, uint64_t *in, uint32_t y, uint32_t z, uint64_t *out,
                      uint64_t *room)
{
    const size_t words = s->words;
    const uint32_t *size = s->work->scene->grid.size;
    memset(out, 0, words * sizeof *out);
    for (size_t i = 0; i < s->brush.rows; i++) {
        const struct brush_row *ball = &s->brush.row[i];
        const int64_t at_y = (int64_t)y + ball->y, at_z = (int64_t)z + ball->z;
        if (at_y < 0 || at_y >= size[1] || at_z < 0 || at_z >= size[2])
            continue;
        const uint64_t *from = row_of(s, in, (uint32_t)at_y, (uint32_t)at_z);
        uint64_t any = 0;
        for (size_t w = 0; w < words; w++)
            any |= from[w];
        if (!any)
            continue;
        memcpy(room, from, words * sizeof *room);
        /* Spread each bit to all within `half`. */
        const unsigned half = (unsigned)ball->half;
        for (unsigned reach = 0; reach < half;) {
            const unsigned left = half - reach, steps = left < 2 * reach + 1 ? left : 2 * reach + 1;
            /* Spread each bit to the `steps` before and after it, fewer than 64. */
            uint64_t before = 0;
            for (size_t w = 0; w < words; w++) {
                const uint64_t here = room[w], after = w + 1 < words ? room[w + 1] : 0;
                room[w] = here | here << steps | here >> steps | before >> (64 - steps) |
                          after << (64 - steps);
                before = here;
            }
            reach += steps;
        }
        for (size_t w = 0; w < words; w++)
            out[w] |= room[w];
    }
    out[words - 1] &= last_mask(s);
}

static void invert_row(const struct shape *s, uint64_t *row)
{
    for (size_t w = 0; w < s->words; w++)
        row[w] = ~row[w];
    row[s->words - 1] &= last_mask(s);
}

/* Find the voxels left out: all other labels, or, when closing, the label. */
static void leave_out(const struct shape *s, uint32_t y, uint32_t z, uint64_t *room)
{
    const struct grid *grid = &s->work->scene->grid;
    const uint8_t *label = s->work->label + grid_cell(grid, 0, y, z);
    uint64_t *left = row_of(s, s->left, y, z);
    (void)room;
    memset(left, 0, s->words * sizeof *left);
    for (uint32_t x = 0; x < grid->size[0]; x++)
        left[x / 64] |= (uint64_t)((label[x] == s->label) != s->opens) << x % 64;
}

static void find_centres(const struct shape *s, uint32_t y, uint32_t z, uint64_t *room)
{
    uint64_t *ball = row_of(s, s->ball, y, z);
    cover_row(s, s->left, y, z, ball, room);
    invert_row(s, ball);
}

/* Write the label that the voxel loses, or is assigned, into work->next. */
static void note_lost(const struct shape *s, uint32_t y, uint32_t z, uint64_t *room)
{
    const struct grid *grid = &s->work->scene->grid;
    const size_t row = grid_cell(grid, 0, y, z);
    const uint8_t *label = s->work->label + row;
    const uint64_t *left = row_of(s, s->left, y, z);
    uint8_t *next = s->work->next + row;
    uint64_t *lost = room + s->words;
    cover_row(s, s->ball, y, z, lost, room);
    invert_row(s, lost);
    for (size_t w = 0; w < s->words; w++)
        for (uint64_t bits = lost[w] & ~left[w]; bits; bits &= bits - 1) {
            const size_t x = w * 64 + (size_t)__builtin_ctzll(bits);
            if ((s->opens || label[x] == 0) && !next[x])
                next[x] = (uint8_t)s->label;
        }
}

static void sweep_part(void *context, unsigned worker)
{
    const struct shape *s = context;
    const struct share share = team_share(s->work->team, worker, s->last[1] - s->first[1] + 1);
    const uint64_t cost = s->words * (s->brush.rows + 64);
    struct task task = task_begin_part(s->work->scene->watch, "shape of labels", 0, worker);
    for (size_t i = share.first; i < share.end; i++)
        for (uint32_t y = s->first[0]; y <= s->last[0] && task_advance(&task, cost); y++)
            s->make(s, y, s->first[1] + (uint32_t)i, s->room + worker * 2 * s->words);
}

/* Process the rows that contain the label, and those around them up to `times` balls away. */
static void sweep_rows(struct shape *s, uint32_t times,
                       void (*make)(const struct shape *, uint32_t, uint32_t, uint64_t *))
{
    const struct finish_box *box = &s->box[s->label];
    s->make = make;
    for (int a = 0; a < 2; a++) {
        const uint32_t by = times * (uint32_t)s->brush.reach[a + 1];
        s->first[a] = below(box->first[a + 1], by);
        s->last[a] = above(box->last[a + 1], by, s->work->scene->grid.size[a + 1]);
    }
    team_run(s->work->team, sweep_part, s);
}

static enum err shape_init(struct shape *s, struct finish_work *work,
                           const struct finish_step *step, bool opens, struct fault *fault)
{
    static const uint32_t voxel[3] = {1, 1, 1};
    const struct scene *scene = work->scene;
    const size_t rows = (size_t)scene->grid.size[1] * scene->grid.size[2];
    *s = (struct shape){.work = work, .opens = opens, .words = (scene->grid.size[0] + 63) / 64};
    TRY(brush_init(&s->brush, step->in_nm ? scene->spacing_nm : voxel, step->argument,
                   BRUSH_REACH_MOST, fault));
    s->left = mem_array(rows, s->words * sizeof *s->left);
    s->ball = mem_array(rows, s->words * sizeof *s->ball);
    s->room = mem_array(team_size(work->team), 2 * s->words * sizeof *s->room);
    return s->left && s->ball && s->room ? finish_find_boxes(s->box, work, "shape of labels", fault)
                                         : fault_memory(fault, "finished labels");
}

/* Set work->next to the label that each voxel loses, or is assigned, and else to 0. */
static enum err find_lost(struct finish_work *work, const struct finish_step *step, bool opens,
                          struct fault *fault)
{
    struct shape s;
    enum err err = shape_init(&s, work, step, opens, fault);
    finish_clear(work);
    for (s.label = 1; !err && s.label < 256; s.label++) {
        if (!finish_is_for(step, s.label) || finish_box_is_empty(&s.box[s.label]))
            continue;
        sweep_rows(&s, 3, leave_out);
        sweep_rows(&s, 2, find_centres);
        sweep_rows(&s, 1, note_lost);
        err = watch_fault(work->scene->watch, fault);
    }
    brush_release(&s.brush);
    free(s.left);
    free(s.ball);
    free(s.room);
    return err ? err : watch_fault(work->scene->watch, fault);
}

enum err finish_open(struct finish_work *work, const struct finish_step *step, struct fault *fault)
{
    const enum err err = find_lost(work, step, true, fault);
    return err ? err : finish_reassign(work, work->next, step, fault);
}

enum err finish_close(struct finish_work *work, const struct finish_step *step, struct fault *fault)
{
    const struct grid *grid = &work->scene->grid;
    enum err err = find_lost(work, step, false, fault);
    struct task task = task_begin(work->scene->watch, "shape of labels", grid->voxels);
    for (size_t c = 0; !err && c < grid->cells; c++) {
        if (work->next[c])
            work->label[c] = work->next[c];
        if (!task_advance(&task, 1))
            break;
    }
    return err ? err : watch_fault(work->scene->watch, fault);
}
