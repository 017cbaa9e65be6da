/* SPDX-License-Identifier: MIT */
#include "engine/label_stats.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "engine/components.h"

/* What one worker counts may take so much, if all labels are in use. */
enum { BYTES_OF_WORKERS = 64 << 20 };

/* Counters of each label: first those of intensities, then of planes across x, y, z. NULL where the
 * label has had no voxel so far. */
typedef uint32_t *counters[256];

struct label_counts {
    const struct scene *scene;
    size_t plane[3], length; /* where counters of planes begin, and their number in all */
    struct change_log log;
    counters of;
};

/* ---- counters ---- */

static void release_counters(counters of)
{
    for (unsigned label = 0; label < 256; label++) {
        free(of[label]);
        of[label] = NULL;
    }
}

/* Those of a label, or NULL where memory runs out. Label 0 has none. */
static uint32_t *counters_of(const struct label_counts *counts, counters of, unsigned label)
{
    if (!of[label])
        of[label] = mem_new(counts->length * sizeof **of);
    return of[label];
}

/* One voxel more, or, by -1, one less. */
static void add_voxel(const struct label_counts *counts, unsigned label, uint32_t cell, uint32_t by)
{
    const struct place at = grid_place(&counts->scene->grid, cell);
    uint32_t *counter = counts->of[label];
    if (!label)
        return;
    counter[counts->scene->cell[cell].intensity] += by;
    counter[counts->plane[0] + at.x] += by;
    counter[counts->plane[1] + at.y] += by;
    counter[counts->plane[2] + at.z] += by;
}

/* ---- following ---- */

static bool follow_log(struct label_counts *counts)
{
    struct task task = task_begin(counts->scene->watch, "counting", counts->log.count);
    for (size_t i = 0; i < counts->log.count && task_advance(&task, 1); i++) {
        const struct change *change = &counts->log.item[i];
        if (change->label && !counters_of(counts, counts->of, change->label))
            return false;
        add_voxel(counts, change->former_label, change->cell, UINT32_MAX);
        add_voxel(counts, change->label, change->cell, 1);
    }
    return true;
}

/* ---- counting all ---- */

struct counting {
    const struct label_counts *counts;
    const struct labels *labels;
    unsigned workers; /* that share the work */
    struct {
        uint16_t most;
        bool lacks_memory;
        counters of;
    } part[TEAM_MOST];
};

/* The highest intensity of some planes. */
static void look_at_part(void *context, unsigned worker)
{
    struct counting *counting = context;
    const struct scene *scene = counting->counts->scene;
    const struct slab slab = grid_slab(&scene->grid, worker, counting->workers);
    struct task task =
        task_begin_part(scene->watch, "counting", slab_voxels(&scene->grid, slab), worker);
    uint16_t most = 0;
    for (uint32_t z = slab.first; z < slab.end; z++)
        for (uint32_t y = 0; y < scene->grid.size[1]; y++) {
            const struct span row = grid_row(&scene->grid, y, z);
            for (uint32_t c = row.first; c < row.end; c++) {
                scene_fetch_ahead(scene, c);
                most = scene->cell[c].intensity > most ? scene->cell[c].intensity : most;
            }
            if (!task_advance(&task, scene->grid.size[0]))
                return;
        }
    counting->part[worker].most = most;
}

/* Intensities are those of the scene, whatever its labels: they are looked at once. */
static enum err find_length(struct counting *counting, struct label_counts *counts,
                            struct team *team, struct fault *fault)
{
    const uint32_t *size = counts->scene->grid.size;
    size_t intensities = 1;
    counting->workers = team_size(team);
    team_run(team, look_at_part, counting);
    if (watch_stops(counts->scene->watch))
        return watch_fault(counts->scene->watch, fault);
    for (unsigned worker = 0; worker < team_size(team); worker++)
        if (counting->part[worker].most >= intensities)
            intensities = counting->part[worker].most + (size_t)1;
    counts->plane[0] = intensities;
    counts->plane[1] = counts->plane[0] + size[0];
    counts->plane[2] = counts->plane[1] + size[1];
    counts->length = counts->plane[2] + size[2];
    return OK;
}

/* Voxels of one label that lie side by side. */
static bool add_run(struct counting *counting, counters of, struct span run, const struct place *at)
{
    const struct label_counts *counts = counting->counts;
    const uint8_t label = labels_at(counting->labels, run.first);
    uint32_t *counter = counters_of(counts, of, label);
    if (!counter)
        return false;
    for (uint32_t c = run.first; c < run.end; c++) {
        counter[counts->scene->cell[c].intensity]++;
        counter[counts->plane[0] + at->x + (c - run.first)]++;
    }
    counter[counts->plane[1] + at->y] += run.end - run.first;
    counter[counts->plane[2] + at->z] += run.end - run.first;
    return true;
}

static bool add_row(struct counting *counting, counters of, uint32_t y, uint32_t z)
{
    const struct span row = grid_row(&counting->counts->scene->grid, y, z);
    for (struct span run = {row.first, row.first}; run.first < row.end; run.first = run.end) {
        const uint8_t label = labels_at(counting->labels, run.first);
        while (run.end < row.end && labels_at(counting->labels, run.end) == label)
            scene_fetch_ahead(counting->counts->scene, run.end++);
        if (label &&
            !add_run(counting, of, run, &(const struct place){run.first - row.first, y, z}))
            return false;
    }
    return true;
}

static void count_part(void *context, unsigned worker)
{
    struct counting *counting = context;
    const struct scene *scene = counting->counts->scene;
    if (worker >= counting->workers)
        return;
    const struct slab slab = grid_slab(&scene->grid, worker, counting->workers);
    struct task task =
        task_begin_part(scene->watch, "counting", slab_voxels(&scene->grid, slab), worker);
    for (uint32_t z = slab.first; z < slab.end; z++)
        for (uint32_t y = 0; y < scene->grid.size[1]; y++) {
            if (!add_row(counting, counting->part[worker].of, y, z))
                counting->part[worker].lacks_memory = true;
            if (counting->part[worker].lacks_memory || !task_advance(&task, scene->grid.size[0]))
                return;
        }
}

/* What the first worker has counted becomes the counts, and what the others have is added. */
static bool gather_counts(struct label_counts *counts, struct counting *counting)
{
    bool fits = true;
    release_counters(counts->of);
    for (unsigned worker = 0; worker < counting->workers; worker++) {
        fits &= !counting->part[worker].lacks_memory;
        for (unsigned label = 0; label < 256; label++) {
            uint32_t *part = counting->part[worker].of[label];
            if (!counts->of[label]) {
                counts->of[label] = part;
                continue;
            }
            for (size_t i = 0; part && i < counts->length; i++)
                counts->of[label][i] += part[i];
            free(part);
        }
    }
    return fits;
}

/* By as many workers as memory allows: a scene of 16 bits has 256 kB of counters a label. */
static enum err count_all(struct label_counts *counts, const struct labels *labels,
                          struct team *team, struct fault *fault)
{
    struct counting *counting = mem_new(sizeof *counting);
    if (!counting)
        return fault_memory(fault, "counts of labels");
    counting->counts = counts;
    counting->labels = labels;
    enum err err = counts->length ? OK : find_length(counting, counts, team, fault);
    if (!err) {
        const size_t fit = BYTES_OF_WORKERS / (256 * counts->length * sizeof **counts->of);
        counting->workers = fit < 1 ? 1 : fit < team_size(team) ? (unsigned)fit : team_size(team);
        team_run(team, count_part, counting);
        err = gather_counts(counts, counting) ? OK : fault_memory(fault, "counts of labels");
    }
    free(counting);
    return err;
}

/* ---- sums ---- */

static struct label_sums sum_counts(const struct label_counts *counts, unsigned label)
{
    const uint32_t *counter = counts->of[label];
    struct label_sums sums = {.voxels = 0};
    for (int a = 0; counter && a < 3; a++) {
        /* Counters of planes: how many voxels there are, the sum of their positions, the first and
         * the last. */
        const uint32_t *count = counter + counts->plane[a];
        uint64_t voxels = 0;
        for (uint32_t i = 0; i < counts->scene->grid.size[a]; i++) {
            if (!count[i])
                continue;
            sums.first[a] = voxels ? sums.first[a] : i;
            sums.last[a] = i;
            sums.sum[a] += (uint64_t)count[i] * i;
            voxels += count[i];
        }
        sums.voxels = voxels;
    }
    if (sums.voxels) {
        const uint64_t rank[2] = {(sums.voxels - 1) / 2, sums.voxels / 2};
        uint64_t below = 0;
        for (size_t i = 0; i < counts->plane[0]; i++) {
            if (!counter[i])
                continue;
            sums.least = below ? sums.least : (uint16_t)i;
            sums.most = (uint16_t)i;
            for (int m = 0; m < 2; m++)
                if (rank[m] >= below && rank[m] < below + counter[i])
                    sums.middle[m] = (uint16_t)i;
            sums.intensity += (uint64_t)counter[i] * i;
            sums.intensity_squares += (uint64_t)counter[i] * i * i;
            below += counter[i];
        }
    }
    return sums;
}

/* ---- components and holes ---- */

struct finding {
    const struct scene *scene;
    const uint8_t *label; /* [cells] */
    struct label_stats *stats;
};

static enum err count_components(struct finding *f, struct fault *fault)
{
    struct components found;
    const enum err err = components_find(&found, &f->scene->grid, f->label, f->scene->watch, fault);
    for (size_t i = 0; !err && i < found.count; i++)
        f->stats[found.item[i].label].components++;
    if (!err)
        components_release(&found);
    return err;
}

static enum err count_holes(struct finding *f, unsigned label, struct fault *fault)
{
    struct watch *watch = f->scene->watch;
    struct components found = {0};
    struct grid box;
    uint32_t corner[3];
    /* The part of the scene that a label takes, and one voxel around it, as a grid of its own: what
     * is around is one with what lies beyond. */
    const struct label_sums *sums = &f->stats[label].sums;
    uint32_t size[3];
    for (int a = 0; a < 3; a++) {
        const uint32_t end = f->scene->grid.size[a] - 1;
        corner[a] = sums->first[a] > 0 ? sums->first[a] - 1 : 0;
        size[a] = (sums->last[a] < end ? sums->last[a] + 1 : end) - corner[a] + 1;
    }
    enum err err = grid_init(&box, size, fault);
    if (err)
        return err;
    /* 1 in voxels of the label, else 0. */
    const struct grid *grid = &f->scene->grid;
    uint8_t *selected = mem_array(box.cells, 1);
    struct task task = task_begin(f->scene->watch, "holes", box.voxels);
    for (uint32_t z = 0; selected && z < box.size[2]; z++)
        for (uint32_t y = 0; y < box.size[1] && task_advance(&task, box.size[0]); y++) {
            const uint8_t *from =
                f->label + grid_cell(grid, corner[0], corner[1] + y, corner[2] + z);
            uint8_t *to = selected + grid_cell(&box, 0, y, z);
            for (uint32_t x = 0; x < box.size[0]; x++)
                to[x] = from[x] == label;
        }
    err = selected ? watch_fault(watch, fault) : fault_memory(fault, "holes");
    if (!err)
        err = components_find(&found, &box, selected, watch, fault);
    f->stats[label].holes = 0;
    for (size_t i = 0; i < found.count; i++)
        f->stats[label].holes += !found.item[i].label && !found.item[i].at_edge;
    components_release(&found);
    free(selected);
    return err;
}

/* ---- what is kept ---- */

void label_measures_release(struct label_measures *measures)
{
    struct label_counts *counts = measures->counts;
    if (counts) {
        release_counters(counts->of);
        change_log_release(&counts->log);
        free(counts);
    }
    label_pairs_free(measures->pairs);
    *measures = (struct label_measures){0};
}

size_t label_measures_memory(const struct label_measures *measures)
{
    const struct label_counts *counts = measures->counts;
    size_t bytes = label_pairs_memory(measures->pairs);
    if (counts)
        bytes += sizeof *counts + counts->log.capacity * sizeof *counts->log.item;
    for (unsigned label = 0; counts && label < 256; label++)
        bytes += counts->of[label] ? counts->length * sizeof **counts->of : 0;
    return bytes;
}

void label_measures_follow(struct label_measures *measures, const struct changes *changes)
{
    struct label_counts *counts = measures->counts;
    if (counts)
        change_log_add(&counts->log, changes, counts->scene->grid.voxels);
    label_pairs_follow(measures->pairs, changes);
}

void label_measures_forget(struct label_measures *measures)
{
    if (measures->counts)
        change_log_give_up(&measures->counts->log);
    label_pairs_forget(measures->pairs);
}

static enum err refresh_counts(struct label_measures *measures, const struct labels *labels,
                               struct team *team, struct fault *fault)
{
    if (!measures->counts)
        measures->counts = mem_new(sizeof *measures->counts);
    struct label_counts *counts = measures->counts;
    if (!counts)
        return fault_memory(fault, "counts of labels");
    counts->scene = labels->scene;
    enum err err = OK;
    if (!counts->log.follows)
        err = count_all(counts, labels, team, fault);
    else if (!follow_log(counts))
        err = fault_memory(fault, "counts of labels");
    return change_log_settle(&counts->log, err ? err : watch_fault(counts->scene->watch, fault));
}

enum err label_measures_sum(struct label_measures *measures, const struct labels *labels,
                            unsigned label, struct team *team, struct label_sums *sums,
                            struct fault *fault)
{
    const enum err err = refresh_counts(measures, labels, team, fault);
    if (!err)
        *sums = sum_counts(measures->counts, label);
    return err;
}

enum err label_stats_find(struct label_stats stats[256], struct label_measures *measures,
                          const struct labels *labels, struct team *team, struct fault *fault)
{
    struct finding f = {.scene = labels->scene, .stats = stats};
    enum err err = refresh_counts(measures, labels, team, fault);
    if (!err && !measures->pairs)
        err = label_pairs_new(&measures->pairs, labels->scene, fault);
    if (!err)
        err = label_pairs_refresh(measures->pairs, labels, team, fault);
    if (err)
        return err;
    f.label = label_pairs_labels(measures->pairs);
    for (unsigned label = 0; label < 256; label++) {
        stats[label] = (struct label_stats){.sums = sum_counts(measures->counts, label)};
        memcpy(stats[label].pairs, label_pairs_of(measures->pairs, label), sizeof stats->pairs);
    }
    err = count_components(&f, fault);
    for (unsigned label = 1; !err && label < 256; label++)
        if (stats[label].sums.voxels)
            err = count_holes(&f, label, fault);
    return err;
}
