/* SPDX-License-Identifier: MIT */
/*
 * Opening and closing by a ball. To close a label is to open what has not that label, so one piece
 * of work serves both: what of a set no ball in the set covers, which the step takes out of it.
 *
 *     left out     the voxels of the scene that are not in the set
 *     centres      of the balls that lie in the set: no voxel left out is in the ball around them
 *     covered      the voxels in a ball around a centre
 *     lost         in the set, and not covered
 *
 * Sets are bits, and a ball is some rows of voxels, so that 64 voxels are looked at in one step.
 * Labels are done one after another, each in the rows that hold it, and those around.
 */
#include "engine/finish.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "engine/brush.h"

/* Rows first..last of an axis. */
struct rows {
    uint32_t first, last;
};

struct shape {
    struct finish_work *work;
    struct brush brush;
    bool opens;                 /* else closes */
    size_t words;               /* of a row; bits beyond the row are 0 */
    uint64_t *left;             /* [rows of the scene][words]: what is left out */
    uint64_t *ball;             /* likewise: the centres */
    uint64_t *room;             /* [workers][2][words] */
    struct finish_box box[256]; /* where labels lie */
    unsigned label;             /* at hand */
    struct rows rows[2];        /* along y and z that are to be made */
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

/* out: the voxels of the row that are in a ball around one of `in`. */
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
        /* Each bit spreads to all that are at most `half` away. */
        const unsigned half = (unsigned)ball->half;
        for (unsigned reach = 0; reach < half;) {
            const unsigned left = half - reach, steps = left < 2 * reach + 1 ? left : 2 * reach + 1;
            /* Each bit spreads to those `steps` before and after it, fewer than 64. */
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

/* ---- what is done with each row ---- */

/* The voxels left out: of the others, or, where it closes, of the label. */
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

/* Notes in work->next the label that the voxel loses, or gets. */
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

/* ---- all rows ---- */

struct sweep {
    struct shape *shape;
    void (*make)(const struct shape *s, uint32_t y, uint32_t z, uint64_t *room);
};

static void sweep_part(void *context, unsigned worker)
{
    const struct sweep *sweep = context;
    const struct shape *s = sweep->shape;
    const struct share share =
        team_share(s->work->team, worker, s->rows[1].last - s->rows[1].first + 1);
    const uint64_t cost = s->words * (s->brush.rows + 64);
    struct task task = task_begin_part(s->work->scene->watch, "shape of labels", 0, worker);
    for (size_t i = share.first; i < share.end; i++)
        for (uint32_t y = s->rows[0].first; y <= s->rows[0].last; y++) {
            sweep->make(s, y, s->rows[1].first + (uint32_t)i, s->room + worker * 2 * s->words);
            if (!task_advance(&task, cost))
                return;
        }
}

/* In the rows that hold the label, and those around them up to `times` balls away. */
static void sweep_rows(struct shape *s, int times,
                       void (*make)(const struct shape *, uint32_t, uint32_t, uint64_t *))
{
    struct sweep sweep = {s, make};
    for (int a = 0; a < 2; a++) {
        const struct finish_box *box = &s->box[s->label];
        const uint32_t first = box->first[a + 1], last = box->last[a + 1];
        const uint32_t by = (uint32_t)(times * s->brush.reach[a + 1]);
        const uint32_t end = s->work->scene->grid.size[a + 1] - 1;
        s->rows[a].first = first < by ? 0 : first - by;
        s->rows[a].last = end - last < by ? end : last + by;
    }
    team_run(s->work->team, sweep_part, &sweep);
}

/* ---- the step ---- */

static enum err shape_init(struct shape *s, struct finish_work *work,
                           const struct finish_step *step, bool opens, struct fault *fault)
{
    static const uint32_t voxel[3] = {1, 1, 1};
    const struct scene *scene = work->scene;
    const size_t rows = (size_t)scene->grid.size[1] * scene->grid.size[2];
    *s = (struct shape){.work = work, .opens = opens, .words = (scene->grid.size[0] + 63) / 64};
    enum err err = brush_init(&s->brush, step->in_nm ? scene->spacing_nm : voxel, step->argument,
                              BRUSH_REACH_MOST, fault);
    if (err)
        return err;
    s->left = mem_array(rows, s->words * sizeof *s->left);
    s->ball = mem_array(rows, s->words * sizeof *s->ball);
    s->room = mem_array(team_size(work->team), 2 * s->words * sizeof *s->room);
    return s->left && s->ball && s->room ? finish_find_boxes(s->box, work, "shape of labels", fault)
                                         : fault_memory(fault, "finished labels");
}

/* Has work->next hold, of each voxel that a label loses, or gets, that label, and else 0. */
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

static void choose_lost(const struct components *found, const struct finish_step *step, bool *waits)
{
    (void)step;
    for (size_t i = 0; i < found->count; i++)
        waits[i] = found->item[i].label != 0;
}

enum err finish_open(struct finish_work *work, const struct finish_step *step, struct fault *fault)
{
    const enum err err = find_lost(work, step, true, fault);
    return err ? err
               : finish_give_away(work, work->next, choose_lost, step, FINISH_ALL_LABELS, fault);
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
