#include "engine/label_stats.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "engine/components.h"

struct counting {
    const struct scene *scene;
    const uint8_t *label; /* [cells] */
    struct label_stats *stats;
};

/* ---- components and holes ---- */

static enum err count_components(struct counting *counting, struct fault *fault)
{
    struct components found;
    const enum err err = components_find(&found, &counting->scene->grid, counting->label,
                                         counting->scene->watch, fault);
    for (size_t i = 0; !err && i < found.count; i++)
        counting->stats[found.item[i].label].components++;
    if (!err)
        components_release(&found);
    return err;
}

/* The part of the scene that a label takes, and one voxel around it, as a grid of its own: what is
 * around is one with what lies beyond. */
static enum err box_around(struct grid *box, uint32_t corner[3], const struct counting *counting,
                           unsigned label, struct fault *fault)
{
    const struct label_sums *sums = &counting->stats[label].sums;
    uint32_t size[3];
    for (int a = 0; a < 3; a++) {
        const uint32_t end = counting->scene->grid.size[a] - 1;
        corner[a] = sums->first[a] > 0 ? sums->first[a] - 1 : 0;
        size[a] = (sums->last[a] < end ? sums->last[a] + 1 : end) - corner[a] + 1;
    }
    return grid_init(box, size, fault);
}

/* 1 in voxels of the label, else 0. */
static uint8_t *select_label(const struct grid *box, const uint32_t corner[3],
                             const struct counting *counting, unsigned label)
{
    const struct grid *grid = &counting->scene->grid;
    uint8_t *selected = mem_array(box->cells, 1);
    struct task task = task_begin(counting->scene->watch, "holes", box->voxels);
    for (uint32_t z = 0; selected && z < box->size[2]; z++)
        for (uint32_t y = 0; y < box->size[1] && task_advance(&task, box->size[0]); y++) {
            const uint8_t *from =
                counting->label + grid_cell(grid, corner[0], corner[1] + y, corner[2] + z);
            uint8_t *to = selected + grid_cell(box, 0, y, z);
            for (uint32_t x = 0; x < box->size[0]; x++)
                to[x] = from[x] == label;
        }
    return selected;
}

static enum err count_holes(struct counting *counting, unsigned label, struct fault *fault)
{
    struct watch *watch = counting->scene->watch;
    struct components found = {0};
    struct grid box;
    uint32_t corner[3];
    enum err err = box_around(&box, corner, counting, label, fault);
    if (err)
        return err;
    uint8_t *selected = select_label(&box, corner, counting, label);
    err = selected ? watch_fault(watch, fault) : fault_memory(fault, "holes");
    if (!err)
        err = components_find(&found, &box, selected, watch, fault);
    counting->stats[label].holes = 0;
    for (size_t i = 0; i < found.count; i++)
        counting->stats[label].holes += !found.item[i].label && !found.item[i].at_edge;
    components_release(&found);
    free(selected);
    return err;
}

/* ---- what is kept ---- */

void label_measures_release(struct label_measures *measures)
{
    label_counts_free(measures->counts);
    label_pairs_free(measures->pairs);
    *measures = (struct label_measures){0};
}

size_t label_measures_memory(const struct label_measures *measures)
{
    return label_counts_memory(measures->counts) + label_pairs_memory(measures->pairs);
}

void label_measures_follow(struct label_measures *measures, const struct changes *changes)
{
    label_counts_follow(measures->counts, changes);
    label_pairs_follow(measures->pairs, changes);
}

void label_measures_forget(struct label_measures *measures)
{
    label_counts_forget(measures->counts);
    label_pairs_forget(measures->pairs);
}

static enum err refresh_counts(struct label_measures *measures, const struct labels *labels,
                               struct team *team, struct fault *fault)
{
    enum err err =
        measures->counts ? OK : label_counts_new(&measures->counts, labels->scene, fault);
    return err ? err : label_counts_refresh(measures->counts, labels, team, fault);
}

static enum err refresh_pairs(struct label_measures *measures, const struct labels *labels,
                              struct team *team, struct fault *fault)
{
    enum err err = measures->pairs ? OK : label_pairs_new(&measures->pairs, labels->scene, fault);
    return err ? err : label_pairs_refresh(measures->pairs, labels, team, fault);
}

enum err label_measures_sum(struct label_measures *measures, const struct labels *labels,
                            unsigned label, struct team *team, struct label_sums *sums,
                            struct fault *fault)
{
    const enum err err = refresh_counts(measures, labels, team, fault);
    if (!err)
        *sums = label_counts_sum(measures->counts, label);
    return err;
}

enum err label_stats_find(struct label_stats stats[256], struct label_measures *measures,
                          const struct labels *labels, struct team *team, struct fault *fault)
{
    struct counting counting = {.scene = labels->scene, .stats = stats};
    enum err err = refresh_counts(measures, labels, team, fault);
    if (!err)
        err = refresh_pairs(measures, labels, team, fault);
    if (err)
        return err;
    counting.label = label_pairs_labels(measures->pairs);
    for (unsigned label = 0; label < 256; label++) {
        stats[label] = (struct label_stats){.sums = label_counts_sum(measures->counts, label)};
        memcpy(stats[label].pairs, label_pairs_of(measures->pairs, label), sizeof stats->pairs);
    }
    err = count_components(&counting, fault);
    for (unsigned label = 1; !err && label < 256; label++)
        if (stats[label].sums.voxels)
            err = count_holes(&counting, label, fault);
    return err;
}
