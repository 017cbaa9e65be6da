/* SPDX-License-Identifier: MIT */
/* Relaxation: fields that are stored between edits, fields that are recomputed, and the step. */
#include "engine/relax.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

enum { MATTERS = CELL_SEED | CELL_OUTSIDE };

size_t relax_kept_memory(const struct relax_kept *kept)
{
    return kept->bytes + 3 * kept->cells;
}

static void forget(struct relax_kept *kept, unsigned label)
{
    struct relax_stored *field = kept->field[label];
    kept->field[label] = NULL;
    kept->changed[label] = finish_box_none();
    if (field)
        kept->bytes -= field->bytes;
    mem_pages_free(field, field ? field->bytes : 0);
}

void relax_kept_release(struct relax_kept *kept)
{
    for (unsigned label = 0; label < 256; label++)
        forget(kept, label);
    mem_pages_free(kept->label, kept->cells);
    mem_pages_free(kept->stays, kept->cells);
    mem_pages_free(kept->result, kept->cells);
    *kept = (struct relax_kept){0};
}

static struct finish_box all_of(const struct scene *scene)
{
    const uint32_t *size = scene->grid.size;
    return (struct finish_box){{0}, {size[0] - 1, size[1] - 1, size[2] - 1}};
}

/* ---- comparison with the stored state ---- */

/* Result of each worker of the team. */
struct compared {
    struct finish_box changed[256]; /* by label: voxels that may change its field */
    struct finish_box moved;        /* voxels that entered or left the region of interest */
};

struct comparing {
    struct relax_kept *kept;
    const struct finish_work *work;
    const struct relax_field *field; /* [256]: stored fields */
    struct compared *by;
};

/* True if a former seed is at rest in a field: its neighbours are at rest and on the same side of
 * the label's border. */
static bool is_initial_around(const struct comparing *c, unsigned label, uint32_t at,
                              const uint32_t p[3])
{
    const ptrdiff_t *step = c->work->scene->grid.step;
    const uint8_t *of = c->work->label + at;
    bool rests = true;
    for (int way = 0; way < 6 && rests; way++) {
        const int a = way / 2, by = way % 2 ? 1 : -1;
        uint32_t q[3] = {p[0], p[1], p[2]};
        q[a] += (uint32_t)by;
        rests = (of[0] == label) == (of[by * step[a]] == label) &&
                relax_field_is_initial(&c->field[label], q[0], q[1], q[2]);
    }
    return rests;
}

/* A voxel became a seed, or is no seed any more: mark the fields that move it. */
static void follow_seed(const struct comparing *c, struct finish_box changed[256], bool is_seed,
                        uint32_t at, const struct finish_box *here)
{
    const uint32_t *p = here->first;
    for (unsigned label = 1; label < 256; label++)
        if (c->kept->field[label] && !finish_box_contains(&changed[label], here) &&
            (!relax_field_is_initial(&c->field[label], p[0], p[1], p[2]) ||
             (!is_seed && !is_initial_around(c, label, at, p))))
            finish_box_include(&changed[label], here);
}

static void compare_part(void *context, unsigned worker)
{
    const struct comparing *c = context;
    const struct scene *scene = c->work->scene;
    struct compared *by = &c->by[worker];
    const uint32_t some = 16; /* voxels that are compared at once */
    const uint8_t *labels = c->work->label;
    uint8_t *label = c->kept->label, *stays = c->kept->stays;
    struct grid_walk w = scene_walk(scene, "relaxed labels", c->work->team, worker);
    while (grid_walk_next(&w))
        for (uint32_t at = w.row.first; at < w.row.end; at++) {
            const struct cell *cell = scene->cell + at;
            if (at + some <= w.row.end && memcmp(labels + at, label + at, some) == 0) {
                unsigned differs = 0;
                for (uint32_t i = 0; i < some; i++)
                    differs |= (cell[i].flags & MATTERS) ^ (unsigned)stays[at + i];
                if (!differs) {
                    at += some - 1;
                    continue;
                }
            }
            const uint8_t now = labels[at], flags = cell->flags & MATTERS;
            if (now == label[at] && flags == stays[at])
                continue;
            const uint32_t x = at - w.row.first;
            const struct finish_box here = {{x, w.y, w.z}, {x, w.y, w.z}};
            if (now != label[at]) {
                finish_box_include(&by->changed[now], &here);
                finish_box_include(&by->changed[label[at]], &here);
            }
            if ((flags ^ stays[at]) == CELL_SEED)
                follow_seed(c, by->changed, flags & CELL_SEED, at, &here);
            else if (flags != stays[at])
                finish_box_include(&by->moved, &here);
            label[at] = now;
            stays[at] = flags;
        }
}

/* True if a voxel in a box, or next to it, is in the box of a field. */
static bool reaches(const struct finish_box *field, const struct finish_box *box)
{
    bool meets = !finish_box_is_empty(box);
    for (int a = 0; a < 3 && meets; a++)
        meets = box->last[a] + 1 >= field->first[a] && field->last[a] + 1 >= box->first[a];
    return meets;
}

/* Find where stored fields may have changed. False without memory. If the scene's watch stops it,
 * the rest is compared the next time. */
static bool compare(struct relax_kept *kept, const struct finish_work *work)
{
    const unsigned workers = team_size(work->team);
    OWNED(mem_release) struct relax_field *field = mem_new(256 * sizeof *field);
    OWNED(mem_release) struct compared *by = mem_new(workers * sizeof *by);
    struct comparing c = {kept, work, field, by};
    if (!field || !by)
        return false;
    for (unsigned label = 1; label < 256; label++)
        if (kept->field[label])
            relax_field_read(&field[label], work, (uint8_t)label, kept->field[label]);
    for (unsigned worker = 0; worker < workers; worker++) {
        by[worker].moved = finish_box_none();
        for (unsigned label = 0; label < 256; label++)
            by[worker].changed[label] = finish_box_none();
    }
    team_run(work->team, compare_part, &c);
    for (unsigned worker = 0; worker < workers; worker++)
        for (unsigned label = 1; label < 256; label++) {
            finish_box_include(&kept->changed[label], &by[worker].changed[label]);
            if (reaches(&field[label].box, &by[worker].moved))
                finish_box_include(&kept->changed[label], &by[worker].moved);
        }
    return true;
}

/* Find where stored fields differ for these labels and this scene. Without memory all are forgotten
 * and none is stored; if the scene's watch stops it, the next call continues. */
static void follow_labels(struct relax_kept *kept, const struct finish_work *work, uint32_t sweeps,
                          uint32_t reach)
{
    const size_t cells = work->scene->grid.cells;
    if (kept->cells != cells || kept->sweeps != sweeps || kept->reach != reach) {
        relax_kept_release(kept);
        *kept = (struct relax_kept){.cells = cells,
                                    .most = cells * sizeof(struct cell),
                                    .label = mem_pages(cells),
                                    .stays = mem_pages(cells),
                                    .result = mem_pages(cells),
                                    .stale = all_of(work->scene),
                                    .sweeps = sweeps,
                                    .reach = reach};
        for (unsigned label = 0; label < 256; label++)
            forget(kept, label);
    }
    kept->lacks = false;
    if (!kept->label || !kept->stays || !kept->result || !compare(kept, work))
        relax_kept_release(kept);
}

/* Store a field, if there is room. */
static void keep_field(struct relax_kept *kept, struct relax_field *field)
{
    if (!kept->cells || kept->field[field->which])
        return;
    struct relax_stored *stored = relax_field_store(field, kept->most - kept->bytes);
    kept->field[field->which] = stored;
    kept->changed[field->which] = finish_box_none(); /* it was computed for the present labels */
    kept->bytes += stored ? stored->bytes : 0;
    kept->lacks |= !stored;
}

/* ---- one field after another, or several in parallel ---- */

/* A label, and the number of voxels in its bounding box. */
struct item {
    uint8_t label;
    uint64_t voxels;
};

struct relaxing {
    const struct finish_work *work;
    struct relax_kept *kept; /* or NULL */
    uint32_t sweeps, reach;
    struct finish_box box[256]; /* boxes of fields; empty for a label without voxels */
    struct item item[255];      /* largest first */
    size_t count;
    struct relax_field field[TEAM_MOST];
    unsigned fields; /* being computed */
};

static int compare_items(const void *a, const void *b)
{
    const struct item *first = a, *second = b;
    return first->voxels != second->voxels ? (first->voxels < second->voxels ? 1 : -1)
                                           : first->label - second->label;
}

static enum err list_labels(struct relaxing *r, unsigned of, struct fault *fault)
{
    const enum err err = finish_find_boxes(r->box, r->work, "relaxed labels", fault);
    const struct finish_box all = all_of(r->work->scene);
    for (unsigned label = 1; label < 256; label++) {
        struct finish_box *box = &r->box[label];
        uint64_t voxels = 1;
        if (finish_box_is_empty(box) || (of != FINISH_ALL_LABELS && of != label))
            continue;
        for (int a = 0; a < 3; a++)
            voxels *= box->last[a] - box->first[a] + 1;
        *box = finish_box_widen(box, r->reach, &all);
        r->item[r->count++] = (struct item){(uint8_t)label, voxels};
    }
    qsort(r->item, r->count, sizeof *r->item, compare_items);
    return err;
}

static void make_one(void *context, unsigned worker)
{
    struct relaxing *r = context;
    if (worker < r->fields)
        relax_field_make(&r->field[worker]);
}

static enum err make_fields(struct relaxing *r, size_t first, struct fault *fault)
{
    struct finish_work work = *r->work;
    /* Relax as many labels as there are threads, one per thread without waiting, if the labels are
     * small and of similar size. Otherwise relax one label with all threads. */
    enum { SMALL = 1 << 20 };
    const unsigned workers = team_size(r->work->team);
    const struct item *item = r->item + first;
    r->fields = first + workers <= r->count && item->voxels <= SMALL &&
                        item[workers - 1].voxels >= item->voxels / 2
                    ? workers
                    : 1;
    work.team = r->fields == 1 ? r->work->team : NULL;
    for (unsigned i = 0; i < r->fields; i++) {
        const uint8_t label = r->item[first + i].label;
        TRY(relax_field_begin(&r->field[i], &work, label, &r->box[label], r->reach, r->sweeps,
                              fault));
        r->field[i].shows = r->fields == 1;
        if (r->fields == 1 && r->kept && r->kept->bytes < r->kept->most / 2)
            r->field[i].room = r->kept->most / 2 - r->kept->bytes;
        r->field[i].worker = i;
    }
    if (r->fields == 1)
        relax_field_make(&r->field[0]);
    else
        team_run(r->work->team, make_one, r);
    return watch_fault(r->work->scene->watch, fault);
}

/* Update a stored field, or forget it if it has to be recomputed. */
static void update_field(struct relaxing *r, unsigned label)
{
    struct relax_kept *kept = r->kept;
    struct relax_stored *stored = kept->field[label];
    if (stored && !finish_box_is_empty(&kept->changed[label]) &&
        !(stored->is_updatable && !finish_box_is_empty(&r->box[label]) &&
          finish_box_contains(&stored->box, &r->box[label]) &&
          relax_field_update(&r->field[0], r->work, (uint8_t)label, stored, r->reach, r->sweeps,
                             &kept->changed[label], &kept->stale)))
        forget(kept, label);
    if (stored && !kept->field[label])
        kept->stale = all_of(r->work->scene);
}

/* Pass stored fields to `see` and remove them from the list. */
static enum err see_kept(struct relaxing *r, relax_see *see, void *context, struct fault *fault)
{
    const struct finish_work *work = r->work;
    size_t left = 0;
    for (unsigned label = 1; label < 256; label++)
        update_field(r, label);
    for (size_t i = 0; i < r->count; i++)
        if (!r->kept->field[r->item[i].label])
            r->kept->stale = all_of(work->scene);
    for (size_t i = 0; i < r->count; i++) {
        struct relax_field field = {0};
        const struct item item = r->item[i];
        const struct relax_stored *stored = r->kept->field[item.label];
        if (stored) {
            relax_field_read(&field, work, item.label, stored);
            see(context, &field);
        } else {
            r->item[left++] = item;
        }
    }
    r->count = left;
    return watch_fault(work->scene->watch, fault);
}

enum err relax_each(const struct finish_work *work, unsigned label, uint32_t sweeps, uint32_t reach,
                    relax_see *see, void *context, struct fault *fault)
{
    struct watch *watch = work->scene->watch;
    OWNED(mem_release) struct relaxing *r = mem_new(sizeof *r);
    if (!r)
        return fault_memory(fault, "relaxed labels");
    r->work = work;
    r->sweeps = sweeps;
    r->reach = reach;
    enum err err = list_labels(r, label, fault);
    struct relax_kept *kept = label == FINISH_ALL_LABELS ? work->kept : NULL;
    if (!err && kept) {
        follow_labels(kept, work, sweeps, reach);
        r->kept = kept->cells ? kept : NULL;
    }
    if (!err && r->kept)
        err = see_kept(r, see, context, fault);
    for (size_t i = 0; !err && i < r->count; i += r->fields) {
        err = make_fields(r, i, fault);
        for (unsigned n = 0; !err && n < r->fields; n++) {
            see(context, &r->field[n]);
            if (kept)
                keep_field(kept, &r->field[n]);
        }
        err = err ? err : watch_fault(watch, fault);
        if (!err && watch_wants_show(watch) && !watch->ignores_stop)
            watch_show(watch);
    }
    for (unsigned i = 0; i < TEAM_MOST; i++)
        relax_field_release(&r->field[i]);
    return err ? err : watch_fault(watch, fault);
}

/* ---- the step ---- */

/* State of voxels, [cells], where some field has moved. */
struct ranks {
    struct finish_work *work;
    const struct finish_step *step;
    uint32_t *best; /* the greatest rank of fields */
    int32_t *sum;   /* sum of the fields; includes HAS_OWN after the field of the voxel's label */
    struct span *part;       /* [rows of the scene]: range of x in which fields have moved */
    struct relax_kept *kept; /* with the result of all rows that are not stale, or NULL */
    const struct relax_field *field; /* current field */
};

enum { HAS_OWN = 1 << 30 };

/* Rank of a field: by value; then the voxel's own label first; then the smaller label. */
static uint32_t rank_of(int32_t value, bool is_own, uint8_t label)
{
    return (uint32_t)value << 9 | (uint32_t)is_own << 8 | (255u - label);
}

/* True if the result of a row is not known. */
static bool is_stale(const struct ranks *r, uint32_t y, uint32_t z)
{
    const struct relax_kept *kept = r->kept;
    return !kept || !kept->cells ||
           (y >= kept->stale.first[1] && y <= kept->stale.last[1] && z >= kept->stale.first[2] &&
            z <= kept->stale.last[2]);
}

static void rank_voxels(const struct ranks *r, uint32_t first, const struct relax_part *part)
{
    const uint8_t label = r->field->which;
    for (uint32_t i = 0; i < part->count; i++) {
        const uint32_t cell = first + i;
        const bool is_own = r->work->label[cell] == label;
        const uint32_t rank = rank_of(part->value[i], is_own, label);
        r->best[cell] = rank > r->best[cell] ? rank : r->best[cell];
        r->sum[cell] += part->value[i] + (is_own ? HAS_OWN : 0);
    }
}

static void rank_part(void *context, unsigned worker)
{
    const struct ranks *r = context;
    const struct relax_field *f = r->field;
    const struct grid *grid = &f->scene->grid;
    const struct share planes = team_share(r->work->team, worker, f->size[2]);
    struct task task = task_begin_part(f->scene->watch, "relaxed labels", 0, worker);
    for (uint32_t z = (uint32_t)planes.first; z < planes.end; z++)
        for (uint32_t y = 0; y < f->size[1] && task_advance(&task, f->size[0]); y++) {
            const uint32_t *at = f->box.first;
            if (!is_stale(r, at[1] + y, at[2] + z))
                continue;
            const uint32_t first = grid_cell(grid, at[0], at[1] + y, at[2] + z);
            struct span *row = &r->part[(size_t)(at[2] + z) * grid->size[1] + at[1] + y];
            for (struct relax_part part = {0}; relax_field_next(f, y, z, &part);) {
                const uint32_t x = at[0] + part.x, end = x + part.count;
                rank_voxels(r, first + part.x, &part);
                row->first = row->first == row->end || x < row->first ? x : row->first;
                row->end = end > row->end ? end : row->end;
            }
        }
}

static void rank_field(void *context, const struct relax_field *field)
{
    struct ranks *r = context;
    r->field = field;
    team_run(r->work->team, rank_part, r);
}

/* Label that is assigned to a voxel. The field of its own label is RELAX_ONE if it has not
 * moved. */
static uint8_t winner_at(const struct ranks *r, uint32_t cell)
{
    const uint8_t own = r->work->label[cell];
    const bool has_own = r->sum[cell] >= HAS_OWN;
    const int32_t sum = r->sum[cell] - (has_own ? HAS_OWN : 0), left = RELAX_ONE - sum;
    if (own != 0 && !has_own)
        return own;
    const uint32_t rest = rank_of(left > 0 ? left : 0, own == 0, 0), best = r->best[cell];
    return (uint8_t)(255 - ((rest > best ? rest : best) & 255));
}

static void choose_part(void *context, unsigned worker)
{
    const struct ranks *r = context;
    const struct scene *scene = r->work->scene;
    struct grid_walk w = scene_walk(scene, "relaxed labels", r->work->team, worker);
    while (grid_walk_next(&w)) {
        const struct span *part = &r->part[(size_t)w.z * scene->grid.size[1] + w.y];
        uint8_t *const result = r->kept && r->kept->cells ? r->kept->result + w.row.first : NULL;
        uint8_t *const row = r->work->label + w.row.first;
        if (!is_stale(r, w.y, w.z))
            memcpy(row, result, scene->grid.size[0]);
        for (uint32_t x = part->first; x < part->end; x++) {
            const uint32_t cell = w.row.first + x;
            uint8_t *label = &r->work->label[cell];
            const uint8_t wins = r->best[cell] ? winner_at(r, cell) : *label;
            if (finish_is_for(r->step, *label) || finish_is_for(r->step, wins))
                *label = wins;
        }
        if (result)
            memcpy(result, row, scene->grid.size[0]);
    }
}

enum err finish_relax(struct finish_work *work, const struct finish_step *step, struct fault *fault)
{
    const struct grid *grid = &work->scene->grid;
    const size_t cells = grid->cells, rows = (size_t)grid->size[1] * grid->size[2];
    const bool is_all = step->label == FINISH_ALL_LABELS;
    struct ranks r = {.work = work, .step = step, .kept = is_all ? work->kept : NULL};
    r.best = mem_pages(cells * sizeof *r.best);
    r.sum = mem_pages(cells * sizeof *r.sum);
    r.part = mem_pages(rows * sizeof *r.part);
    enum err err = r.best && r.sum && r.part ? OK : fault_memory(fault, "relaxed labels");
    if (!err)
        err =
            relax_each(work, FINISH_ALL_LABELS, step->argument, step->reach, rank_field, &r, fault);
    if (!err) {
        team_run(work->team, choose_part, &r);
        err = watch_fault(work->scene->watch, fault);
    }
    if (work->kept && work->kept->cells && !err)
        work->kept->stale = is_all && !work->kept->lacks ? finish_box_none() : all_of(work->scene);
    mem_pages_free(r.best, cells * sizeof *r.best);
    mem_pages_free(r.sum, cells * sizeof *r.sum);
    mem_pages_free(r.part, rows * sizeof *r.part);
    return err;
}
