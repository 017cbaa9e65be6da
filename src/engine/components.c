/* SPDX-License-Identifier: MIT */
#include "engine/components.h"

#include <stdlib.h>

#include "base/mem.h"

/* State while runs are joined: following `component` leads to the first run of each set of joined
 * runs, never to a later run. */
struct finding {
    struct components *found;
    const struct grid *grid;
    const uint8_t *label;
    size_t *row; /* the first run of each row of voxels, and the end of the last row */
};

void components_release(struct components *components)
{
    free(components->item);
    free(components->run);
    *components = (struct components){0};
}

/* ---- runs ---- */

static bool add_row(struct finding *f, struct span row)
{
    struct components *found = f->found;
    for (uint32_t first = row.first, end; first < row.end; first = end) {
        const uint32_t run = (uint32_t)found->runs;
        for (end = first + 1; end < row.end && f->label[end] == f->label[first];)
            end++;
        if (!mem_grow(&found->run, &found->run_capacity, found->runs + 1, sizeof *found->run))
            return false;
        found->run[found->runs++] = (struct component_run){first, end, run, RUN_NONE};
    }
    return true;
}

/* ---- joining ---- */

static uint32_t first_of(struct component_run *run, uint32_t at)
{
    while (run[at].component != at)
        at = run[at].component = run[run[at].component].component;
    return at;
}

/* Join the runs of a row with those of the row that is `back` rows, and `step` cells, before it. */
static void join_rows(struct finding *f, size_t row, size_t back, uint32_t step)
{
    struct component_run *run = f->found->run;
    size_t here = f->row[row], there = f->row[row - back];
    while (here < f->row[row + 1] && there < f->row[row - back + 1]) {
        const uint32_t end = run[here].end, other = run[there].end + step;
        if (f->label[run[here].first] == f->label[run[there].first]) {
            const uint32_t a = first_of(run, (uint32_t)here), b = first_of(run, (uint32_t)there);
            run[a < b ? b : a].component = a < b ? a : b;
        }
        here += end <= other;
        there += other <= end;
    }
}

static enum err find_runs(struct finding *f, struct watch *watch, struct fault *fault)
{
    struct grid_walk w = grid_rows(f->grid, watch, "components");
    for (size_t row = 0; grid_walk_next(&w); row++) {
        f->row[row] = f->found->runs;
        if (!add_row(f, w.row))
            return fault_memory(fault, "components");
        f->row[row + 1] = f->found->runs;
        if (w.y > 0)
            join_rows(f, row, 1, (uint32_t)f->grid->step[1]);
        if (w.z > 0)
            join_rows(f, row, f->grid->size[1], (uint32_t)f->grid->step[2]);
    }
    return watch_fault(watch, fault);
}

/* ---- components ---- */

/* Number the components and count their voxels. Until here each run leads to a lower one, from here
 * on to its component; runs are linked last to first. */
static enum err count(struct finding *f, struct watch *watch, struct fault *fault)
{
    struct components *found = f->found;
    const uint32_t *size = f->grid->size;
    struct task task = task_begin(watch, "components", 2 * found->runs);
    for (size_t i = 0; i < found->runs && task_advance(&task, 1); i++) {
        struct component_run *run = found->run + i;
        if (run->component != i) { /* a lower one, which leads to its component already */
            run->component = found->run[run->component].component;
        } else {
            if (!mem_grow(&found->item, &found->capacity, found->count + 1, sizeof *found->item))
                return fault_memory(fault, "components");
            run->component = (uint32_t)found->count;
            found->item[found->count++] =
                (struct component){0, RUN_NONE, f->label[run->first], false};
        }
        struct component *item = found->item + run->component;
        const uint32_t voxels = run->end - run->first;
        item->voxels += voxels;
        if (!item->at_edge) {
            const struct place p = grid_place(f->grid, run->first);
            item->at_edge = p.x == 0 || p.x + voxels == size[0] || p.y == 0 || p.y + 1 == size[1] ||
                            p.z == 0 || p.z + 1 == size[2];
        }
    }
    for (size_t i = found->runs; i-- > 0 && task_advance(&task, 1);) {
        struct component *item = found->item + found->run[i].component;
        found->run[i].next = item->run;
        item->run = (uint32_t)i;
    }
    return watch_fault(watch, fault);
}

enum err components_find(struct components *components, const struct grid *grid,
                         const uint8_t *label, struct watch *watch, struct fault *fault)
{
    const size_t rows = (size_t)grid->size[1] * grid->size[2];
    OWNED(mem_release) size_t *row = mem_array(rows + 1, sizeof *row);
    struct finding finding = {components, grid, label, row};
    *components = (struct components){0};
    TRY(row ? find_runs(&finding, watch, fault) : fault_memory(fault, "components"));
    return count(&finding, watch, fault);
}
