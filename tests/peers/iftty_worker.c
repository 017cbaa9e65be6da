/* SPDX-License-Identifier: MIT */
/* iftty's engine as a worker: iftty_worker FOLDER THREADS. The first run after a reset plants all
 * markers as one edit of an empty forest; each later run is the differential update from the former
 * markers to the present ones.
 *
 * The stages: "cells", making the scene's cells from the gradient, and an empty forest, after a
 * reset; "list", finding the edits in the map of markers; "run", forest_edit, which updates the
 * digests too; "border", border_update; and "read", copying the labels out of the cells. */
#include "base/mem.h"
#include "render/border.h"
#include "engine/forest.h"
#include "tests/peers/worker.h"

static struct team *team;
static struct scene *scene;
static struct forest *forest;
static struct border border;
static bool has_border;

/* What is planted now, as markers; edits lead from there to the markers of a run. */
static uint8_t *planted;  /* [voxels] */
static struct edit *edit; /* [voxels] */
static size_t edits;

/* Calls `visit` for every voxel and its cell, in order. */
static void each_voxel(struct worker *worker, void (*visit)(struct worker *, size_t, uint32_t))
{
    size_t voxel = 0;
    for (uint32_t z = 0; z < worker->size[2]; z++)
        for (uint32_t y = 0; y < worker->size[1]; y++) {
            const struct span row = grid_row(&scene->grid, y, z);
            for (uint32_t c = row.first; c < row.end; c++)
                visit(worker, voxel++, c);
        }
}

static void weigh_row(void *context, unsigned thread, uint32_t y, uint32_t z, uint16_t *weight)
{
    const struct worker *worker = context;
    const size_t row = (size_t)z * worker->size[1] + y, size = worker->size[0];
    (void)thread;
    memcpy(weight, worker->gradient + row * size, size * sizeof *weight);
}

static void list_edit(struct worker *worker, size_t voxel, uint32_t cell)
{
    const uint8_t marker = worker->marker[voxel];
    if (marker == planted[voxel])
        return;
    planted[voxel] = marker;
    edit[edits++] = (struct edit){cell, (int16_t)(marker ? marker - 1 : EDIT_ERASE), 0};
}

static void get_label(struct worker *worker, size_t voxel, uint32_t at)
{
    const struct cell *cell = scene->cell + at;
    worker->label[voxel] = (uint8_t)(cell->key != KEY_NONE ? cell->label + 1 : 0);
}

static void get_cost(struct worker *worker, size_t voxel, uint32_t at)
{
    const uint64_t key = scene->cell[at].key;
    worker->cost[voxel] = (uint16_t)(key != KEY_NONE ? key_cost(key) : UINT16_MAX);
}

static enum err begin_afresh(struct worker *worker, struct fault *fault)
{
    if (has_border)
        border_release(&border);
    forest_free(forest);
    scene_free(scene);
    has_border = false;
    forest = NULL;
    memset(planted, 0, worker->voxels);
    const uint32_t size[3] = {worker->size[0], worker->size[1], worker->size[2]};
    worker_stage(worker, NULL);
    enum err err = scene_new_plain(&scene, size, mem_array(worker->voxels, 2), NULL, fault);
    if (!err)
        scene_make_cells(scene, team, weigh_row, worker);
    if (!err)
        err = forest_new(&forest, scene, 6, fault);
    if (!err)
        err = forest_set_team(forest, team, fault);
    worker_stage(worker, "cells");
    if (!err)
        err = border_init(&border, scene, fault);
    has_border = err == OK;
    return err;
}

static bool run(struct worker *worker)
{
    struct fault fault;
    enum err err = worker->afresh ? begin_afresh(worker, &fault) : OK;
    if (err)
        goto failed;
    edits = 0;
    worker_stage(worker, NULL);
    each_voxel(worker, list_edit);
    worker_stage(worker, "list");
    err = forest_edit(forest, edit, edits, &fault);
    worker_stage(worker, "run");
    if (err)
        goto failed;
    const struct changes changes = forest_changes(forest);
    const struct forest_stats stats = forest_stats(forest);
    worker_stage(worker, NULL);
    border_update(&border, &changes);
    worker_stage(worker, "border");
    each_voxel(worker, get_label);
    worker_stage(worker, "read");
    each_voxel(worker, get_cost);
    const size_t used = strlen(worker->note);
    snprintf(worker->note + used, sizeof worker->note - used,
             " seeds=%zu touched=%llu digest=%016llx", edits, (unsigned long long)stats.touched,
             (unsigned long long)forest_digest(forest));
    return true;
failed:
    snprintf(worker->note, sizeof worker->note, "%.150s", fault.text);
    return false;
}

int main(int argc, char **argv)
{
    struct worker worker = {0};
    struct fault fault;
    if (argc != 3 || !worker_begin(&worker, argv[1]) ||
        team_new(&team, (unsigned)atoi(argv[2]), &fault))
        return 3;
    planted = mem_array(worker.voxels, 1);
    edit = mem_array(worker.voxels, sizeof *edit);
    worker.cost = mem_array(worker.voxels, sizeof *worker.cost);
    if (!planted || !edit || !worker.cost)
        return 3;
    worker_serve(&worker, run);
    return 0;
}
