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
    struct finish_box box[256]; /* where labels lie, */
    struct finish_box all;      /* and where their fields do */
    struct relax_field field;   /* of the label at hand */
    uint8_t label;
    size_t voxels;  /* of `all`, of each of which: */
    uint32_t *best; /* the greatest rank; 0 where no band has come to */
    int32_t *sum;   /* of all fields */
};

/* What is compared: the value; then whether it is the voxel's own label; then the smaller label. */
static uint32_t rank_of(int32_t value, bool is_own, uint8_t label)
{
    return (uint32_t)value << 9 | (uint32_t)is_own << 8 | (255u - label);
}

/* ---- which label wins ---- */

/* A voxel of `all` among its voxels. */
static size_t place_in_all(const struct relaxing *r, uint32_t x, uint32_t y, uint32_t z)
{
    const struct finish_box *b = &r->all;
    const size_t row = (size_t)(z - b->first[2]) * (b->last[1] - b->first[1] + 1) + y - b->first[1];
    return row * (b->last[0] - b->first[0] + 1) + x - b->first[0];
}

static void rank_part(void *context, unsigned worker)
{
    const struct relaxing *r = context;
    const struct relax_field *f = &r->field;
    const struct share planes = team_share(r->work->team, worker, f->size[2]);
    struct task task = task_begin_part(r->work->scene->watch, "relaxed labels", 0, worker);
    for (uint32_t z = (uint32_t)planes.first; z < planes.end; z++)
        for (uint32_t y = 0; y < f->size[1] && task_advance(&task, f->size[0]); y++) {
            const uint32_t *at = f->box.first;
            const uint32_t cell = grid_cell(&f->scene->grid, at[0], at[1] + y, at[2] + z);
            const size_t place = place_in_all(r, at[0], at[1] + y, at[2] + z);
            for (uint32_t x = 0; x < f->size[0]; x++) {
                if (!relax_is_in_band(f, x, y, z))
                    continue;
                const int32_t value = relax_value(f, x, y, z);
                const uint32_t rank =
                    rank_of(value, r->work->label[cell + x] == r->label, r->label);
                uint32_t *best = &r->best[place + x];
                *best = rank > *best ? rank : *best;
                r->sum[place + x] += value;
            }
        }
}

/* Of `count` voxels, the first of which is this cell, and has this place in `all`. */
static void choose(const struct relaxing *r, uint32_t cell, size_t place, uint32_t count)
{
    const uint8_t *label = r->work->label + cell;
    uint8_t *next = r->work->next + cell;
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t best = r->best[place + i];
        const int32_t left = RELAX_ONE - r->sum[place + i];
        const uint32_t rest = rank_of(left > 0 ? left : 0, label[i] == 0, 0);
        const uint8_t wins = (uint8_t)(255 - ((rest > best ? rest : best) & 255));
        const bool moves =
            best && (finish_is_for(r->step, label[i]) || finish_is_for(r->step, wins));
        next[i] = moves ? wins : label[i];
    }
}

static void choose_part(void *context, unsigned worker)
{
    const struct relaxing *r = context;
    const struct finish_work *work = r->work;
    const struct grid *grid = &work->scene->grid;
    const uint32_t *first = r->all.first, *last = r->all.last;
    const struct slab slab = grid_slab(grid, worker, team_size(work->team));
    struct task task = task_begin_part(work->scene->watch, "relaxed labels", 0, worker);
    for (uint32_t z = slab.first; z < slab.end; z++)
        for (uint32_t y = 0; y < grid->size[1] && task_advance(&task, grid->size[0]); y++) {
            const struct span row = grid_row(grid, y, z);
            memcpy(work->next + row.first, work->label + row.first, row.end - row.first);
            if (r->voxels && y >= first[1] && y <= last[1] && z >= first[2] && z <= last[2])
                choose(r, row.first + first[0], place_in_all(r, first[0], y, z),
                       last[0] - first[0] + 1);
        }
}

/* Where fields will lie, and memory for what is known of the voxels there. */
static enum err find_all(struct relaxing *r, struct fault *fault)
{
    const enum err err = finish_find_boxes(r->box, r->work, "relaxed labels", fault);
    if (err)
        return err;
    struct finish_box labels = r->box[1];
    for (unsigned label = 2; label < 256; label++)
        finish_box_include(&labels, &r->box[label]);
    if (finish_box_is_empty(&labels))
        return OK;
    r->all = relax_box_around(&r->work->scene->grid, &labels);
    r->voxels = place_in_all(r, r->all.last[0], r->all.last[1], r->all.last[2]) + 1;
    r->best = mem_pages(r->voxels * sizeof *r->best);
    r->sum = mem_pages(r->voxels * sizeof *r->sum);
    return r->best && r->sum ? OK : fault_memory(fault, "relaxed labels");
}

static enum err relax_label(struct relaxing *r, unsigned label, struct fault *fault)
{
    struct finish_work *work = r->work;
    r->label = (uint8_t)label;
    const enum err err =
        relax_field_init(&r->field, work, r->label, &r->box[label], &r->greys, fault);
    if (err)
        return err;
    relax_field_sweep(&r->field, r->step->argument, work->team);
    team_run(work->team, rank_part, r);
    relax_field_release(&r->field);
    return watch_fault(work->scene->watch, fault);
}

static enum err relax(struct relaxing *r, struct fault *fault)
{
    struct finish_work *work = r->work;
    enum err err = find_all(r, fault);
    if (!err)
        relax_find_greys(&r->greys, work->scene, work->team);
    for (unsigned label = 1; label < 256 && !err; label++)
        if (!finish_box_is_empty(&r->box[label]))
            err = relax_label(r, label, fault);
    if (!err)
        team_run(work->team, choose_part, r);
    return err ? err : watch_fault(work->scene->watch, fault);
}

enum err finish_relax(struct finish_work *work, const struct finish_step *step, struct fault *fault)
{
    struct relaxing *r = mem_new(sizeof *r);
    if (!r) {
        finish_take_next(work);
        return fault_memory(fault, "relaxed labels");
    }
    *r = (struct relaxing){.work = work, .step = step};
    const enum err err = relax(r, fault);
    mem_pages_free(r->best, r->voxels * sizeof *r->best);
    mem_pages_free(r->sum, r->voxels * sizeof *r->sum);
    free(r);
    finish_take_next(work);
    return err;
}
