/* SPDX-License-Identifier: MIT */
/*
 * Connected components of labels.
 *
 * A component is a maximal set of voxels of one label, label 0 too, connected by faces. A voxel
 * that no seed reaches has label 0, like the background.
 *
 * Algorithm: runs of equal labels along rows are joined with touching runs of the rows before, in
 * 16 bytes a run. The numbers of components do not depend on the order of work: they have the order
 * of their first cells.
 */
#ifndef ENGINE_COMPONENTS_H
#define ENGINE_COMPONENTS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/err.h"
#include "base/watch.h"
#include "engine/grid.h"

#define RUN_NONE UINT32_MAX

/* Voxels first..end-1 of a row. */
struct component_run {
    uint32_t first, end; /* cells */
    uint32_t component;
    uint32_t next; /* the next run of the component, or RUN_NONE */
};

struct component {
    uint32_t voxels;
    uint32_t run; /* its first run, which begins with its lowest cell */
    uint8_t label;
    bool at_edge; /* has a voxel at the edge of the scene */
};

/* {0} is empty. */
struct components {
    struct component *item;
    size_t count, capacity;
    struct component_run *run;
    size_t runs, run_capacity;
};

/* Find the components of label[grid->cells] (0 in the rim). ERR_MEMORY, ERR_CANCELLED. The caller
 * releases the result, also on error. */
enum err components_find(struct components *components, const struct grid *grid,
                         const uint8_t *label, struct watch *watch, struct fault *fault);
void components_release(struct components *components);

#endif
