/* SPDX-License-Identifier: MIT */
#include "engine/relax.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

enum { MATTERS = CELL_SEED | CELL_OUTSIDE };

size_t relax_kept_memory(const struct relax_kept *kept)
{
    return kept->bytes + 2 * kept->cells;
}

static void forget(struct relax_kept *kept, unsigned label)
{
    struct relax_stored *field = kept->field[label];
    kept->field[label] = NULL;
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
    *kept = (struct relax_kept){0};
}

/* ---- what has changed ---- */

/* By each worker of the team. */
struct compared {
    bool differs[256];       /* labels whose fields may be others */
    struct finish_box moved; /* voxels outside the region of interest that were not, or were */
};

struct comparing {
    struct relax_kept *kept;
    const struct finish_work *work;
    const struct relax_field *field; /* [256]: those that are kept */
    struct compared *by;
};

/* Whether a voxel that is no seed any more rests in a field as one did: so do those beside it, all
 * on its side of the label's border. */
static bool rests_free(const struct comparing *c, unsigned label, uint32_t at, const uint32_t p[3])
{
    const ptrdiff_t *step = c->work->scene->grid.step;
    const uint8_t *of = c->work->label + at;
    bool rests = true;
    for (int way = 0; way < 6 && rests; way++) {
        const int a = way / 2, by = way % 2 ? 1 : -1;
        uint32_t q[3] = {p[0], p[1], p[2]};
        q[a] += (uint32_t)by;
        rests = (of[0] == label) == (of[by * step[a]] == label) &&
                relax_field_rests(&c->field[label], q[0], q[1], q[2]);
    }
    return rests;
}

/* A voxel that has become a seed, or is none any more: fields differ in which it moves. */
static void follow_seed(const struct comparing *c, bool differs[256], bool is_seed, uint32_t at,
                        const uint32_t p[3])
{
    for (unsigned label = 1; label < 256; label++)
        if (c->kept->field[label] && !differs[label])
            differs[label] = !relax_field_rests(&c->field[label], p[0], p[1], p[2]) ||
                             (!is_seed && !rests_free(c, label, at, p));
}

static void compare_row(const struct comparing *c, struct compared *by, uint32_t y, uint32_t z)
{
    const struct span row = grid_row(&c->work->scene->grid, y, z);
    const struct cell *cell = c->work->scene->cell;
    uint8_t *label = c->kept->label, *stays = c->kept->stays;
    for (uint32_t at = row.first; at < row.end; at++) {
        const uint8_t now = c->work->label[at], flags = cell[at].flags & MATTERS;
        const uint32_t p[3] = {at - row.first, y, z};
        const struct finish_box here = {{p[0], y, z}, {p[0], y, z}};
        if (now != label[at])
            by->differs[now] = by->differs[label[at]] = true;
        if ((flags ^ stays[at]) == CELL_SEED)
            follow_seed(c, by->differs, flags & CELL_SEED, at, p);
        else if (flags != stays[at])
            finish_box_include(&by->moved, &here);
        label[at] = now;
        stays[at] = flags;
    }
}

static void compare_part(void *context, unsigned worker)
{
    const struct comparing *c = context;
    const struct grid *grid = &c->work->scene->grid;
    const struct slab slab = grid_slab(grid, worker, team_size(c->work->team));
    struct task task =
        task_begin_part(c->work->scene->watch, "relaxed labels", slab_voxels(grid, slab), worker);
    for (uint32_t z = slab.first; z < slab.end; z++)
        for (uint32_t y = 0; y < grid->size[1] && task_advance(&task, grid->size[0]); y++)
            compare_row(c, &c->by[worker], y, z);
}

/* Whether voxels in a box, or beside it, are in that of a field. */
static bool reaches(const struct finish_box *field, const struct finish_box *box)
{
    bool meets = !finish_box_is_empty(box);
    for (int a = 0; a < 3 && meets; a++)
        meets = box->last[a] + 1 >= field->first[a] && field->last[a] + 1 >= box->first[a];
    return meets;
}

/* Without memory false. Where the scene's watch stops it, what was not looked at is as it was. */
static bool compare(struct relax_kept *kept, const struct finish_work *work)
{
    const unsigned workers = team_size(work->team);
    struct relax_field *field = mem_new(256 * sizeof *field);
    struct comparing c = {kept, work, field, mem_new(workers * sizeof *c.by)};
    const bool has_room = field && c.by;
    for (unsigned label = 1; has_room && label < 256; label++)
        relax_kept_find(kept, work, (uint8_t)label, &field[label]);
    for (unsigned worker = 0; has_room && worker < workers; worker++)
        c.by[worker].moved = finish_box_none();
    if (has_room)
        team_run(work->team, compare_part, &c);
    for (unsigned worker = 0; has_room && worker < workers; worker++)
        for (unsigned label = 1; label < 256; label++)
            if (c.by[worker].differs[label] || reaches(&field[label].box, &c.by[worker].moved))
                forget(kept, label);
    free(field);
    free(c.by);
    return has_room;
}

/* Of a scene of that many cells, nothing yet. */
static bool begin_keeping(struct relax_kept *kept, size_t cells)
{
    relax_kept_release(kept);
    kept->cells = cells;
    kept->most = cells * sizeof(struct cell);
    kept->label = mem_pages(cells);
    kept->stays = mem_pages(cells);
    return kept->label && kept->stays;
}

void relax_kept_follow(struct relax_kept *kept, const struct finish_work *work, uint32_t sweeps,
                       uint32_t reach)
{
    const size_t cells = work->scene->grid.cells;
    const bool is_new = kept->cells != cells || kept->sweeps != sweeps || kept->reach != reach;
    if ((is_new && !begin_keeping(kept, cells)) || !compare(kept, work)) {
        relax_kept_release(kept);
        return;
    }
    kept->sweeps = sweeps;
    kept->reach = reach;
}

/* ---- fields ---- */

bool relax_kept_find(const struct relax_kept *kept, const struct finish_work *work, uint8_t which,
                     struct relax_field *field)
{
    if (kept->field[which])
        relax_field_read(field, work, which, kept->field[which]);
    return kept->field[which] != NULL;
}

void relax_kept_add(struct relax_kept *kept, const struct relax_field *field)
{
    const size_t bytes = relax_field_stored_bytes(field);
    if (!kept->cells || kept->field[field->which] || kept->bytes + bytes > kept->most)
        return;
    struct relax_stored *stored = mem_pages(bytes);
    if (!stored)
        return;
    relax_field_store(field, stored, bytes);
    kept->field[field->which] = stored;
    kept->bytes += bytes;
}
