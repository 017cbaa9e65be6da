/* SPDX-License-Identifier: MIT */
#include "session/piece_seeds.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "engine/components.h"
#include "session/map.h"

void piece_seeds_release(struct piece_seeds *seeds)
{
    free(seeds->cell);
    free(seeds->run);
    free(seeds->piece);
    *seeds = (struct piece_seeds){0};
}

struct work {
    const struct grid *grid;
    const struct piece_choice *choice;
    uint8_t *label; /* [grid->cells], 0 in the rim */
    unsigned spare; /* stands for REGION_NONE; 256: none does */
    uint8_t *depth; /* [grid->cells], rounds until a voxel is gone, up to `most`; and LEFT */
    uint8_t most;
    uint8_t *least; /* by component: the depth of voxels that are left */
    struct components found;
    struct watch *watch;
};

enum {
    LEFT = 128, /* the bit of a voxel that erosion leaves */
    INSIDE = 3, /* steps to a corner neighbour: so much deeper, a voxel has no other neighbours */
};

/* ---- labels ---- */

/* A label that the map has not; 256 for none. */
static unsigned find_spare(const uint16_t *region, size_t voxels, struct watch *watch)
{
    bool is_there[256] = {false};
    unsigned spare = 0;
    struct task task = task_begin(watch, "labels of the map", voxels);
    for (size_t i = 0; i < voxels && task_advance(&task, 1); i++)
        if (region[i] != REGION_NONE)
            is_there[region[i]] = true;
    while (spare < 256 && is_there[spare])
        spare++;
    return spare;
}

static enum err take_labels(struct work *w, const uint16_t *region, struct fault *fault)
{
    const struct grid *grid = w->grid;
    const unsigned spare =
        w->choice->rest == REGION_NONE ? find_spare(region, grid->voxels, w->watch) : 256;
    memset(w->label, 0, grid->cells);
    w->spare = spare;
    struct task task = task_begin(w->watch, "labels of the map", grid->voxels);
    for (uint32_t z = 0; z < grid->size[2]; z++)
        for (uint32_t y = 0; y < grid->size[1] && task_advance(&task, grid->size[0]); y++) {
            const struct span row = grid_row(grid, y, z);
            for (uint32_t c = row.first; c < row.end; c++, region++) {
                const uint16_t label = *region == REGION_NONE ? w->choice->rest : *region;
                if (label == REGION_NONE && spare > 255)
                    return fault_set(fault, ERR_INPUT,
                                     "the map has all labels 0..255, and other regions beside "
                                     "them; choose fewer with regions=; nothing was planted");
                w->label[c] = (uint8_t)(label == REGION_NONE ? spare : label);
            }
        }
    return OK;
}

/* ---- erosion ---- */

/* How deep a voxel may be for the sake of the neighbour that lies `step` away. */
static unsigned depth_beside(const struct work *w, uint32_t cell, ptrdiff_t step, bool is_in_scene)
{
    const uint32_t beside = cell + (uint32_t)step;
    if (!is_in_scene)
        return w->most;
    return w->label[beside] == w->label[cell] ? w->depth[beside] + 1U : 1;
}

/* Over a row, whose neighbours on the side of `way` are done: forwards (-1) or backwards (1). */
static void deepen_row(const struct work *w, uint32_t y, uint32_t z, int way)
{
    const struct grid *grid = w->grid;
    const struct span row = grid_row(grid, y, z);
    const uint32_t length = row.end - row.first;
    const bool has_y = way < 0 ? y > 0 : y + 1 < grid->size[1];
    const bool has_z = way < 0 ? z > 0 : z + 1 < grid->size[2];
    for (uint32_t i = 0; i < length; i++) {
        const uint32_t c = way < 0 ? row.first + i : row.end - 1 - i;
        const unsigned x = depth_beside(w, c, way, i > 0);
        const unsigned v = depth_beside(w, c, way * grid->step[1], has_y);
        const unsigned u = depth_beside(w, c, way * grid->step[2], has_z);
        unsigned least = w->depth[c];
        least = x < least ? x : least;
        least = v < least ? v : least;
        w->depth[c] = (uint8_t)(u < least ? u : least);
    }
}

/* The city-block distance to another label: forwards and backwards (Rosenfeld, Pfaltz 1966). */
static enum err find_depths(struct work *w, struct fault *fault)
{
    const uint32_t *size = w->grid->size;
    const uint32_t rows = size[1] * size[2];
    struct task task = task_begin(w->watch, "erosion", 2 * (uint64_t)w->grid->voxels);
    memset(w->depth, w->most, w->grid->cells);
    for (uint32_t r = 0; r < rows && task_advance(&task, size[0]); r++)
        deepen_row(w, r % size[1], r / size[1], -1);
    for (uint32_t r = rows; r-- > 0 && task_advance(&task, size[0]);)
        deepen_row(w, r % size[1], r / size[1], 1);
    return watch_fault(w->watch, fault);
}

/* What is left of each component, by the depth of its deepest voxel. */
static void erode(struct work *w, size_t *small)
{
    const uint8_t wanted = (uint8_t)(w->choice->erode + 1);
    struct task task = task_begin(w->watch, "erosion", 2 * (uint64_t)w->found.runs);
    memset(w->least, 0, w->found.count);
    for (size_t i = 0; i < w->found.runs && task_advance(&task, 1); i++) {
        const struct component_run *run = w->found.run + i;
        uint8_t *least = &w->least[run->component];
        for (uint32_t c = run->first; c < run->end && *least < wanted; c++)
            *least = w->depth[c] > *least ? w->depth[c] : *least;
    }
    for (size_t i = 0; i < w->found.count; i++) {
        *small += w->least[i] < wanted && w->found.item[i].label != w->spare &&
                  w->found.item[i].voxels >= w->choice->least;
        w->least[i] = w->least[i] < wanted ? w->least[i] : wanted;
    }
    for (size_t i = 0; i < w->found.runs && task_advance(&task, 1); i++) {
        const struct component_run *run = w->found.run + i;
        for (uint32_t c = run->first; c < run->end; c++)
            w->depth[c] |= w->depth[c] >= w->least[run->component] ? LEFT : 0;
    }
}

/* ---- contours ---- */

/* Of a voxel that is left. */
static bool on_contour(const struct work *w, uint32_t cell, struct place p, uint8_t least)
{
    const struct grid *grid = w->grid;
    if ((w->depth[cell] & ~LEFT) >= least + INSIDE)
        return false;
    for (int z = p.z > 0 ? -1 : 0; z <= (p.z + 1 < grid->size[2]); z++)
        for (int y = p.y > 0 ? -1 : 0; y <= (p.y + 1 < grid->size[1]); y++)
            for (int x = p.x > 0 ? -1 : 0; x <= (p.x + 1 < grid->size[0]); x++) {
                const ptrdiff_t step = x + y * grid->step[1] + z * grid->step[2];
                const uint32_t beside = cell + (uint32_t)step;
                if (w->label[beside] != w->label[cell] || !(w->depth[beside] & LEFT))
                    return true;
            }
    return false;
}

static bool add_cell(struct piece_seeds *seeds, uint32_t cell)
{
    if (!mem_grow(&seeds->cell, &seeds->capacity, seeds->count + 1, sizeof *seeds->cell))
        return false;
    seeds->cell[seeds->count++] = cell;
    return true;
}

/* One that is all of the scene has no contour, and one seed will do. */
static bool add_piece(struct piece_seeds *seeds, const struct work *w,
                      const struct component *component, struct task *task)
{
    const size_t before = seeds->count;
    for (uint32_t r = component->run; r != RUN_NONE && task_advance(task, 1);
         r = w->found.run[r].next) {
        const struct component_run *run = w->found.run + r;
        struct place p = grid_place(w->grid, run->first);
        for (uint32_t c = run->first; c < run->end; c++, p.x++)
            if (w->depth[c] & LEFT && on_contour(w, c, p, w->least[run->component]) &&
                !add_cell(seeds, c))
                return false;
    }
    if (seeds->count == before && !add_cell(seeds, w->found.run[component->run].first))
        return false;
    const bool has_runs = seeds->count - before < component->voxels;
    for (uint32_t r = component->run; has_runs && r != RUN_NONE; r = w->found.run[r].next) {
        const struct component_run *run = w->found.run + r;
        if (!mem_grow(&seeds->run, &seeds->run_capacity, seeds->runs + 1, sizeof *seeds->run))
            return false;
        seeds->run[seeds->runs++] = (struct marker_run){run->first, run->end};
    }
    if (!mem_grow(&seeds->piece, &seeds->piece_capacity, seeds->pieces + 1, sizeof *seeds->piece))
        return false;
    seeds->piece[seeds->pieces++] = (struct piece){seeds->count, seeds->runs, component->label};
    seeds->labels[component->label]++;
    return true;
}

/* ---- all ---- */

static enum err make(struct piece_seeds *seeds, struct work *w, const uint16_t *region,
                     struct fault *fault)
{
    w->label = mem_array(w->grid->cells, 1);
    w->depth = mem_array(w->grid->cells, 1);
    enum err err = w->label && w->depth ? take_labels(w, region, fault)
                                        : fault_memory(fault, "the pieces of a label map");
    if (!err)
        err = components_find(&w->found, w->grid, w->label, w->watch, fault);
    if (!err)
        err = find_depths(w, fault);
    if (err)
        return err;
    w->least = mem_array(w->found.count, 1);
    if (!w->least)
        return fault_memory(fault, "the pieces of a label map");
    erode(w, &seeds->small);
    struct task task = task_begin(w->watch, "seeds of pieces", w->found.runs);
    for (size_t i = 0; i < w->found.count; i++) {
        const struct component *item = w->found.item + i;
        if (item->label == w->spare)
            continue;
        if (item->voxels < w->choice->least)
            seeds->left_out++;
        else if (!add_piece(seeds, w, item, &task))
            return fault_memory(fault, "seeds of pieces");
    }
    return watch_fault(w->watch, fault);
}

enum err piece_seeds_make(struct piece_seeds *seeds, const uint16_t *region,
                          const struct grid *grid, const struct piece_choice *choice,
                          struct watch *watch, struct fault *fault)
{
    struct work work = {.grid = grid,
                        .choice = choice,
                        .most = (uint8_t)(choice->erode + 1 + INSIDE),
                        .watch = watch};
    *seeds = (struct piece_seeds){0};
    const enum err err = make(seeds, &work, region, fault);
    free(work.label);
    free(work.depth);
    free(work.least);
    components_release(&work.found);
    if (err)
        piece_seeds_release(seeds);
    return err;
}
