/* SPDX-License-Identifier: MIT */
/* Growth that is confined to voxels of chosen labels: in a forest of its own, over the box around
 * these voxels, so that the forest of the session stays as it is. */
#include "session/session.h"

#include "base/mem.h"
#include "session/markers.h"
#include "session/paint.h"
#include "session/setting.h"

/* The box, as a scene with a forest. */
struct confined {
    const struct session *session;
    const struct label_set *takes;
    int16_t label;
    uint32_t low[3];
    struct scene *scene;
    struct forest *forest;
    struct edits edits;
};

/* The box around some voxels and their neighbours. */
static enum err make_box(struct confined *c, const struct voxels *within, struct fault *fault)
{
    const struct grid *grid = &c->session->scene->grid;
    uint32_t high[3] = {0}, size[3];
    for (int a = 0; a < 3; a++)
        c->low[a] = UINT32_MAX;
    for (size_t i = 0; i < within->count; i++) {
        uint32_t at[3];
        grid_find(grid, within->cell[i], at);
        for (int a = 0; a < 3; a++) {
            c->low[a] = at[a] < c->low[a] ? at[a] : c->low[a];
            high[a] = at[a] > high[a] ? at[a] : high[a];
        }
    }
    for (int a = 0; a < 3; a++) {
        c->low[a] -= c->low[a] > 0;
        high[a] += high[a] + 1 < grid->size[a];
        size[a] = high[a] - c->low[a] + 1;
    }
    return scene_new(&c->scene, size, NULL, c->session->watch, fault);
}

static uint32_t in_box(const struct confined *c, uint32_t cell)
{
    uint32_t at[3];
    grid_find(&c->session->scene->grid, cell, at);
    return grid_cell(&c->scene->grid, at[0] - c->low[0], at[1] - c->low[1], at[2] - c->low[2]);
}

/* The tree may enter voxels of `within` that have a chosen label. Of these labels, seeds that users
 * planted there hold it back, and so do the voxels around. */
static bool may_enter(const struct confined *c, uint32_t cell)
{
    const struct cell *at = c->session->scene->cell + cell;
    return !(at->flags & (CELL_OUTSIDE | CELL_RIM)) && label_set_has(c->takes, at->label);
}

/* Copy a row of the box: voxels of chosen labels are seeds until they are freed; others belong to
 * no tree. */
static void copy_row(struct confined *c, uint32_t y, uint32_t z, struct span row)
{
    const struct scene *from = c->session->scene;
    uint32_t cell = grid_cell(&from->grid, c->low[0], c->low[1] + y, c->low[2] + z);
    for (uint32_t to = row.first; to < row.end; to++, cell++) {
        c->scene->cell[to].weight = from->cell[cell].weight;
        c->scene->cell[to].intensity = from->cell[cell].intensity;
        if (may_enter(c, cell))
            continue;
        c->scene->cell[to].flags |= CELL_OUTSIDE;
        c->scene->cell[to].key = 0;
    }
}

static enum err add_seeds(struct confined *c, const struct voxels *seeds,
                          const struct voxels *within, struct fault *fault)
{
    const struct session *session = c->session;
    const struct scene *from = session->scene;
    OWNED(mem_release) bool *is_within = mem_new(c->scene->grid.cells);
    if (!is_within)
        return fault_memory(fault, "a tree");
    for (size_t i = 0; i < within->count; i++)
        is_within[in_box(c, within->cell[i])] = true;
    for (struct grid_walk w = scene_walk(c->scene, "a tree", NULL, 0); grid_walk_next(&w);) {
        uint32_t cell = grid_cell(&from->grid, c->low[0], c->low[1] + w.y, c->low[2] + w.z);
        for (uint32_t to = w.row.first; to < w.row.end; to++, cell++) {
            const bool holds = !is_within[to] || (from->cell[cell].flags & CELL_SEED &&
                                                  markers_show(&session->markers, cell));
            if (may_enter(c, cell) && holds)
                TRY(edits_add(&c->edits, (struct edit){to, from->cell[cell].label, 0}, fault));
        }
    }
    for (size_t i = 0; i < seeds->count; i++)
        if (may_enter(c, seeds->cell[i]))
            TRY(edits_add(&c->edits, (struct edit){in_box(c, seeds->cell[i]), c->label, 0}, fault));
    return OK;
}

/* Collect the seeds in voxels of chosen labels, and voxels whose label the tree changes. */
static enum err collect_grown(struct confined *c, const struct voxels *seeds,
                              const struct voxels *within, struct voxels *grown,
                              struct fault *fault)
{
    size_t next = 0;
    grown->cell = mem_array(within->count, sizeof *grown->cell);
    if (!grown->cell)
        return fault_memory(fault, "a tree");
    for (size_t i = 0; i < within->count; i++) {
        const uint32_t cell = within->cell[i];
        const bool is_seed = next < seeds->count && seeds->cell[next] == cell;
        const struct cell *at = c->scene->cell + in_box(c, cell);
        next += is_seed;
        if (may_enter(c, cell) && cell_is_reached(at) && at->label == c->label &&
            (is_seed || c->session->scene->cell[cell].label != c->label))
            grown->cell[grown->count++] = cell;
    }
    return OK;
}

static void confined_release(struct confined *c)
{
    edits_release(&c->edits);
    forest_free(c->forest);
    scene_free(c->scene);
}

enum err session_grow_confined(const struct session *session, const struct label_set *takes,
                               int16_t label, const struct voxels *seeds,
                               const struct voxels *within, struct voxels *grown,
                               struct fault *fault)
{
    OWNED(confined_release)
    struct confined c = {.session = session, .takes = takes, .label = label};
    if (!within->count)
        return OK;
    TRY(make_box(&c, within, fault));
    for (struct grid_walk w = scene_walk(c.scene, "a tree", NULL, 0); grid_walk_next(&w);)
        copy_row(&c, w.y, w.z, w.row);
    TRY(forest_new(&c.forest, c.scene, session->now.kept.adjacency, fault));
    forest_set_arcs(c.forest, forest_arcs(session->forest));
    TRY(forest_rebuild(c.forest, fault));
    TRY(add_seeds(&c, seeds, within, fault));
    TRY(forest_edit(c.forest, edits_first(&c.edits), edits_count(&c.edits), fault));
    TRY(collect_grown(&c, seeds, within, grown, fault));
    return watch_fault(session->watch, fault);
}
