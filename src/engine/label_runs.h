/*
 * The labels of a scene as runs of equal ones along its rows, to be compared with what they are
 * later. Labels lie together, so that takes little memory: 8 bytes a run, and some hundred thousand
 * runs where a head has four objects.
 */
#ifndef ENGINE_LABEL_RUNS_H
#define ENGINE_LABEL_RUNS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "engine/scene.h"

struct label_run {
    uint32_t end; /* the cell after its last one */
    uint8_t label;
};

/* {0} is of nothing. */
struct label_runs {
    struct label_run *run;
    size_t count, capacity;
    bool taken;
};

/* As labels are now, or, in the middle of an edit, were before it. Where memory runs out, or
 * the scene's watch stops it, nothing is `taken`. */
void label_runs_take(struct label_runs *runs, const struct scene *scene);

/* How many voxels have another label now. Of no use where the scene's watch has stopped it. */
uint64_t label_runs_differences(const struct label_runs *runs, const struct scene *scene);

void label_runs_release(struct label_runs *runs);

#endif
