/* SPDX-License-Identifier: MIT */
/* iftty's engine as a worker. The first run after a reset plants all markers as one edit of an
 * empty forest; each later run is the differential update from the former markers to the present
 * ones.
 *
 * Timed is forest_edit, which keeps the digests up to date too; what border_update takes is noted
 * beside it. As a peer's maps are in memory before its run, so are the scene's cells with their
 * weights, and the list of edits. */
#include "base/mem.h"
#include "render/border.h"
#include "engine/forest.h"
#include "tests/peers/worker.h"

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

static void set_weight(struct worker *worker, size_t voxel, uint32_t cell)
{
    scene->cell[cell].weight = worker->gradient[voxel];
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
    const bool reached = cell->key != KEY_NONE;
    worker->label[voxel] = (uint8_t)(reached ? cell->label + 1 : 0);
    worker->cost[voxel] = (uint8_t)(reached ? key_cost(cell->key) : UINT8_MAX);
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
    enum err err = scene_new(&scene, size, fault);
    if (!err)
        each_voxel(worker, set_weight);
    if (!err)
        err = forest_new(&forest, scene, 6, fault);
    if (!err)
        err = border_init(&border, scene, fault);
    has_border = err == OK;
    return err;
}

static bool run(struct worker *worker)
{
    struct fault fault;
    double ready_ms = worker_clock_ms();
    enum err err = worker->afresh ? begin_afresh(worker, &fault) : OK;
    ready_ms = worker_clock_ms() - ready_ms;
    if (err)
        goto failed;
    edits = 0;
    each_voxel(worker, list_edit);
    const double begin = worker_clock_ms();
    err = forest_edit(forest, edit, edits, &fault);
    const double edited = worker_clock_ms();
    if (err)
        goto failed;
    const struct changes changes = forest_changes(forest);
    const struct forest_stats stats = forest_stats(forest);
    border_update(&border, &changes);
    const double bordered = worker_clock_ms();
    each_voxel(worker, get_label);
    const double read = worker_clock_ms();
    worker->ms = edited - begin;
    snprintf(worker->note, sizeof worker->note,
             " border=%.6f seeds=%zu touched=%llu digest=%016llx ready=%.3f read=%.3f",
             bordered - edited, edits, (unsigned long long)stats.touched,
             (unsigned long long)forest_digest(forest), ready_ms, read - bordered);
    return true;
failed:
    snprintf(worker->note, sizeof worker->note, "%.150s", fault.text);
    return false;
}

int main(int argc, char **argv)
{
    struct worker worker = {0};
    if (argc != 2 || !worker_begin(&worker, argv[1]))
        return 3;
    planted = mem_array(worker.voxels, 1);
    edit = mem_array(worker.voxels, sizeof *edit);
    worker.cost = mem_array(worker.voxels, 1);
    if (!planted || !edit || !worker.cost)
        return 3;
    worker_serve(&worker, run);
    return 0;
}
