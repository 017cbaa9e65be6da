/*
 * The step that lets labels settle on the edges of the scene. Each label but 0 has a field
 * (engine/relax_field.h); that of label 0 is what all others leave of RELAX_ONE, or nothing. A
 * voxel of some band takes the label of the greatest, of several its own if that is one of them, or
 * the smallest. So one field is made at a time, and of each voxel only the best so far is kept.
 */
#include "engine/finish.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "engine/relax_field.h"

struct relaxing {
    struct finish_work *work;
    const struct finish_step *step;
    struct relax_greys greys;
    struct relax_box box[256]; /* of each label, */
    bool has[256];             /* that some voxel has */
    struct relax_field field;  /* of the label at hand */
    uint8_t label;
    uint32_t *best; /* [cells]: the greatest rank; 0 where no band has come to */
    int32_t *sum;   /* [cells]: of all fields */
};

/* What is compared: the value; then whether it is the voxel's own label; then the smaller label. */
static uint32_t rank_of(int32_t value, bool is_own, uint8_t label)
{
    return (uint32_t)value << 9 | (uint32_t)is_own << 8 | (255u - label);
}

/* ---- where labels lie ---- */

static void add_run(struct relaxing *r, uint8_t label, uint32_t x, uint32_t last, uint32_t y,
                    uint32_t z)
{
    struct relax_box *box = &r->box[label];
    const uint32_t first[3] = {x, y, z}, end[3] = {last, y, z};
    for (int a = 0; a < 3; a++) {
        box->first[a] = r->has[label] && box->first[a] < first[a] ? box->first[a] : first[a];
        box->last[a] = r->has[label] && box->last[a] > end[a] ? box->last[a] : end[a];
    }
    r->has[label] = true;
}

static void find_boxes(struct relaxing *r)
{
    const struct grid *grid = &r->work->scene->grid;
    struct task task = task_begin(r->work->scene->watch, "relaxed labels", grid->voxels);
    for (uint32_t z = 0; z < grid->size[2]; z++)
        for (uint32_t y = 0; y < grid->size[1] && task_advance(&task, grid->size[0]); y++) {
            const uint8_t *row = r->work->label + grid_cell(grid, 0, y, z);
            for (uint32_t x = 0, end; x < grid->size[0]; x = end) {
                for (end = x + 1; end < grid->size[0] && row[end] == row[x];)
                    end++;
                add_run(r, row[x], x, end - 1, y, z);
            }
        }
}

/* ---- which label wins ---- */

static void rank_part(void *context, unsigned worker)
{
    const struct relaxing *r = context;
    const struct relax_field *f = &r->field;
    const struct share planes = team_share(r->work->team, worker, f->size[2]);
    struct task task = task_begin_part(r->work->scene->watch, "relaxed labels", 0, worker);
    for (uint32_t z = (uint32_t)planes.first; z < planes.end; z++)
        for (uint32_t y = 0; y < f->size[1] && task_advance(&task, f->size[0]); y++) {
            const uint32_t cell = grid_cell(&f->scene->grid, f->box.first[0], f->box.first[1] + y,
                                            f->box.first[2] + z);
            for (uint32_t x = 0; x < f->size[0]; x++) {
                if (!relax_is_in_band(f, x, y, z))
                    continue;
                const int32_t value = relax_value(f, x, y, z);
                const uint32_t rank =
                    rank_of(value, r->work->label[cell + x] == r->label, r->label);
                r->best[cell + x] = rank > r->best[cell + x] ? rank : r->best[cell + x];
                r->sum[cell + x] += value;
            }
        }
}

static void choose_part(void *context, unsigned worker)
{
    const struct relaxing *r = context;
    const struct finish_work *work = r->work;
    const struct grid *grid = &work->scene->grid;
    const struct slab slab = grid_slab(grid, worker, team_size(work->team));
    struct task task = task_begin_part(work->scene->watch, "relaxed labels", 0, worker);
    for (uint32_t z = slab.first; z < slab.end; z++)
        for (uint32_t y = 0; y < grid->size[1] && task_advance(&task, grid->size[0]); y++) {
            const struct span row = grid_row(grid, y, z);
            for (uint32_t c = row.first; c < row.end; c++) {
                const uint8_t own = work->label[c];
                const int32_t left = RELAX_ONE - r->sum[c];
                const uint32_t rest = rank_of(left > 0 ? left : 0, own == 0, 0);
                const uint8_t label =
                    (uint8_t)(255 - ((rest > r->best[c] ? rest : r->best[c]) & 255));
                const bool moves =
                    r->best[c] && (finish_is_for(r->step, own) || finish_is_for(r->step, label));
                work->next[c] = moves ? label : own;
            }
        }
}

static enum err relax(struct relaxing *r, struct fault *fault)
{
    struct finish_work *work = r->work;
    enum err err = OK;
    find_boxes(r);
    relax_find_greys(&r->greys, work->scene);
    for (unsigned label = 1; label < 256 && !err; label++) {
        if (!r->has[label])
            continue;
        r->label = (uint8_t)label;
        err = relax_field_init(&r->field, work->scene, work->label, r->label, &r->box[label],
                               &r->greys, work->team, fault);
        if (!err) {
            relax_field_sweep(&r->field, r->step->argument, work->team);
            team_run(work->team, rank_part, r);
            relax_field_release(&r->field);
            err = watch_fault(work->scene->watch, fault);
        }
    }
    if (!err)
        team_run(work->team, choose_part, r);
    return err ? err : watch_fault(work->scene->watch, fault);
}

enum err finish_relax(struct finish_work *work, const struct finish_step *step, struct fault *fault)
{
    const size_t cells = work->scene->grid.cells;
    struct relaxing *r = mem_new(sizeof *r);
    enum err err = OK;
    if (r) {
        *r = (struct relaxing){.work = work, .step = step};
        r->best = mem_pages(cells * sizeof *r->best);
        r->sum = mem_pages(cells * sizeof *r->sum);
    }
    if (!r || !r->best || !r->sum)
        err = fault_memory(fault, "relaxed labels");
    else
        err = relax(r, fault);
    if (r) {
        mem_pages_free(r->best, cells * sizeof *r->best);
        mem_pages_free(r->sum, cells * sizeof *r->sum);
    }
    free(r);
    finish_take_next(work);
    return err;
}
