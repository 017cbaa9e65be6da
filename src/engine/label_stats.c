/* SPDX-License-Identifier: MIT */
#include "engine/label_stats.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "engine/components.h"

/* ---- counts ---- */

/* Limit of each worker's counters, if all labels are in use. */
enum { BYTES_OF_WORKERS = 64 << 20 };

/* Counters of each label: first those of intensities, then of planes across x, y, z. NULL if the
 * label has had no voxel so far. */
typedef uint32_t *counters[256];

struct label_counts {
    const struct scene *scene;
    size_t plane[3], length; /* first counters of planes, and the number of all counters */
    struct change_log log;
    counters of;
};

static void release_counters(counters of)
{
    for (unsigned label = 0; label < 256; label++) {
        free(of[label]);
        of[label] = NULL;
    }
}

/* Counters of a label, created on demand; NULL without memory. Label 0 has no counters. */
static uint32_t *counters_of(const struct label_counts *counts, counters of, unsigned label)
{
    if (!of[label])
        of[label] = mem_new(counts->length * sizeof **of);
    return of[label];
}

/* Add 1, or -1, voxel. */
static void count_voxel(const struct label_counts *counts, unsigned label, uint32_t cell,
                        uint32_t by)
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

static bool follow_log(struct label_counts *counts)
{
    struct task task = task_begin(counts->scene->watch, "counting", counts->log.count);
    for (size_t i = 0; i < counts->log.count && task_advance(&task, 1); i++) {
        const struct change *change = &counts->log.item[i];
        if (change->label && !counters_of(counts, counts->of, change->label))
            return false;
        count_voxel(counts, change->former_label, change->cell, UINT32_MAX);
        count_voxel(counts, change->label, change->cell, 1);
    }
    return true;
}

/* A recount, by some workers of a team. */
struct counting {
    struct label_counts *counts;
    const struct labels *labels;
    struct team *team;
    unsigned workers; /* workers that count voxels; the others are idle, as memory is limited */
    struct {
        uint16_t most; /* the highest intensity */
        bool lacks_memory;
        counters of;
    } part[TEAM_MOST];
};

static void find_highest(void *context, unsigned worker)
{
    struct counting *counting = context;
    const struct scene *scene = counting->counts->scene;
    struct grid_walk w = scene_walk(scene, "counting", counting->team, worker);
    uint16_t most = 0;
    while (grid_walk_next(&w))
        for (uint32_t c = w.row.first; c < w.row.end; c++) {
            scene_fetch_ahead(scene, c);
            most = scene->cell[c].intensity > most ? scene->cell[c].intensity : most;
        }
    counting->part[worker].most = most;
}

/* Count a row by its runs of one label; false without memory. */
static bool count_row(struct counting *counting, counters of, const struct grid_walk *w)
{
    const struct label_counts *counts = counting->counts;
    for (uint32_t c = w->row.first; c < w->row.end;) {
        const uint32_t first = c;
        const uint8_t label = labels_at(counting->labels, c);
        uint32_t *counter = label ? counters_of(counts, of, label) : NULL;
        if (label && !counter)
            return false;
        for (; c < w->row.end && labels_at(counting->labels, c) == label; c++) {
            scene_fetch_ahead(counts->scene, c);
            if (!label)
                continue;
            counter[counts->scene->cell[c].intensity]++;
            counter[counts->plane[0] + (c - w->row.first)]++;
        }
        if (!label)
            continue;
        counter[counts->plane[1] + w->y] += c - first;
        counter[counts->plane[2] + w->z] += c - first;
    }
    return true;
}

static void count_part(void *context, unsigned worker)
{
    struct counting *counting = context;
    const struct scene *scene = counting->counts->scene;
    if (worker >= counting->workers)
        return;
    struct grid_walk w = grid_walk(&scene->grid, scene->watch, "counting",
                                   grid_slab(&scene->grid, worker, counting->workers), worker);
    while (!counting->part[worker].lacks_memory && grid_walk_next(&w))
        counting->part[worker].lacks_memory = !count_row(counting, counting->part[worker].of, &w);
}

/* The counters of the first worker become the counts, and those of the others are added. */
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

/* Count by as many workers as memory allows: a scene of 16 bits has 256 kB of counters a label. */
static enum err count_all(struct label_counts *counts, const struct labels *labels,
                          struct team *team, struct fault *fault)
{
    OWNED(mem_release) struct counting *counting = mem_new(sizeof *counting);
    if (!counting)
        return fault_memory(fault, "counts of labels");
    counting->counts = counts;
    counting->labels = labels;
    counting->team = team;
    if (!counts->length) /* intensities do not change with labels: they are scanned once */
        team_run(team, find_highest, counting);
    TRY(watch_fault(counts->scene->watch, fault));
    if (!counts->length) {
        const uint32_t *size = counts->scene->grid.size;
        size_t intensities = 1;
        for (unsigned worker = 0; worker < team_size(team); worker++)
            if (counting->part[worker].most >= intensities)
                intensities = counting->part[worker].most + (size_t)1;
        counts->plane[0] = intensities;
        counts->plane[1] = counts->plane[0] + size[0];
        counts->plane[2] = counts->plane[1] + size[1];
        counts->length = counts->plane[2] + size[2];
    }
    const size_t fit = BYTES_OF_WORKERS / (256 * counts->length * sizeof **counts->of);
    counting->workers = fit < 1 ? 1 : fit < team_size(team) ? (unsigned)fit : team_size(team);
    team_run(team, count_part, counting);
    return gather_counts(counts, counting) ? OK : fault_memory(fault, "counts of labels");
}

static struct label_sums sum_counts(const struct label_counts *counts, unsigned label)
{
    const uint32_t *counter = counts->of[label];
    struct label_sums sums = {.voxels = 0};
    for (int a = 0; counter && a < 3; a++) {
        /* Counters of planes: number of voxels, sum of their positions, first and last. */
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

/* ---- pairs ---- */

enum { REACH = 2, AROUND = 124 };

/* A voxel that makes a pair with the central one. */
struct neighbour {
    int32_t step[3]; /* in voxels */
    ptrdiff_t offset;
};

typedef uint64_t pair_counts[256][PAIR_KINDS];

struct label_pairs {
    const struct scene *scene;
    uint32_t step[3];
    ptrdiff_t cells[3];              /* cells of a step */
    struct neighbour around[AROUND]; /* sorted by kind */
    uint8_t first[PAIR_KINDS + 1];   /* the first neighbour of each kind, from 1 on */
    struct change_log log;
    uint8_t *label; /* [cells], at the last refresh */
    pair_counts count;
};

void label_pairs_step(uint32_t step[3], const uint32_t spacing_nm[3])
{
    uint64_t widest = 0;
    for (int a = 0; a < 3; a++)
        widest = spacing_nm[a] > widest ? spacing_nm[a] : widest;
    for (int a = 0; a < 3; a++) {
        const uint64_t voxels = (2 * widest + spacing_nm[a]) / (2 * (uint64_t)spacing_nm[a]);
        step[a] = voxels < STEP_MOST ? (uint32_t)voxels : STEP_MOST;
    }
}

static int kind_of(int x, int y, int z)
{
    return abs(x) + 3 * abs(y) + 9 * abs(z);
}

static struct label_pairs *pairs_new(const struct scene *scene)
{
    struct label_pairs *pairs = mem_new(sizeof *pairs);
    if (pairs)
        pairs->label = mem_pages(scene->grid.cells);
    if (!pairs || !pairs->label) {
        free(pairs);
        return NULL;
    }
    pairs->scene = scene;
    label_pairs_step(pairs->step, scene->spacing_nm);
    for (int a = 0; a < 3; a++)
        pairs->cells[a] = (ptrdiff_t)pairs->step[a] * scene->grid.step[a];
    unsigned count = 0;
    for (int kind = 1; kind < PAIR_KINDS; kind++) {
        pairs->first[kind] = (uint8_t)count;
        for (int z = -REACH; z <= REACH; z++)
            for (int y = -REACH; y <= REACH; y++)
                for (int x = -REACH; x <= REACH; x++) {
                    const int step[3] = {x, y, z};
                    if (kind_of(x, y, z) != kind)
                        continue;
                    for (int a = 0; a < 3; a++) {
                        pairs->around[count].step[a] = step[a] * (int)pairs->step[a];
                        pairs->around[count].offset += step[a] * pairs->cells[a];
                    }
                    count++;
                }
    }
    pairs->first[PAIR_KINDS] = (uint8_t)count;
    return pairs;
}

/* Compare the next eight bytes with `label`: 1 for an equal byte, 0 for others. */
static uint64_t equal_bytes(const uint8_t *byte, uint8_t label)
{
    const uint64_t ones = UINT64_C(0x0101010101010101), low = 127 * ones;
    uint64_t word;
    memcpy(&word, byte, sizeof word);
    word ^= ones * label;
    return ~(((word & low) + low) | word | low) >> 7;
}

/* Add or subtract the pairs that a voxel makes with its label. */
static void add_pairs(struct label_pairs *pairs, uint32_t cell, const struct place *at, bool comes)
{
    const struct grid *grid = &pairs->scene->grid;
    const uint8_t label = pairs->label[cell];
    const uint32_t place[3] = {at->x, at->y, at->z};
    uint32_t found[PAIR_KINDS] = {0};
    bool is_inside = true; /* all voxels that it may make a pair with are inside the scene */
    if (!label)
        return;
    for (int a = 0; a < 3; a++)
        is_inside &=
            place[a] >= REACH * pairs->step[a] && place[a] + REACH * pairs->step[a] < grid->size[a];
    if (!is_inside || pairs->step[0] > 1) {
        found[0] = 1;
        for (int kind = 1; kind < PAIR_KINDS; kind++)
            for (unsigned i = pairs->first[kind]; i < pairs->first[kind + 1]; i++) {
                const struct neighbour *n = &pairs->around[i];
                if (is_inside ||
                    grid_contains(grid, at->x + (int64_t)n->step[0], at->y + (int64_t)n->step[1],
                                  at->z + (int64_t)n->step[2]))
                    found[kind] += (pairs->label + cell)[n->offset] == label;
            }
    } else {
        /* A step along x is one voxel, so the five candidates of a row are among eight consecutive
         * bytes. */
        const uint8_t *const middle = pairs->label + cell - REACH;
        for (int z = 0; z <= REACH; z++)
            for (int y = 0; y <= REACH; y++) {
                const ptrdiff_t up = z * pairs->cells[2], along = y * pairs->cells[1];
                uint64_t rows = equal_bytes(middle + up + along, label);
                if (y > 0)
                    rows += equal_bytes(middle + up - along, label);
                if (z > 0)
                    rows += equal_bytes(middle - up + along, label);
                if (y > 0 && z > 0)
                    rows += equal_bytes(middle - up - along, label);
                uint8_t equal[8];
                memcpy(equal, &rows, sizeof equal);
                uint32_t *of = &found[kind_of(0, y, z)];
                of[0] = equal[2];
                of[1] = (uint32_t)equal[1] + equal[3];
                of[2] = (uint32_t)equal[0] + equal[4];
            }
    }
    for (int kind = 0; kind < PAIR_KINDS; kind++)
        pairs->count[label][kind] += comes ? found[kind] : -(uint64_t)found[kind];
}

struct pair_counting {
    struct label_pairs *pairs;
    struct team *team;
    pair_counts *part; /* [workers] */
    struct span *run;  /* runs of one label, without label 0, in the order of cells */
    size_t *row;       /* the first run of each row of voxels, and the end of the last row */
};

/* False without memory. */
static bool find_runs(struct pair_counting *counting)
{
    const uint8_t *label = counting->pairs->label;
    struct grid_walk w = scene_walk(counting->pairs->scene, "surface", NULL, 0);
    size_t runs = 0, capacity = 0;
    for (size_t row = 0; grid_walk_next(&w); counting->row[++row] = runs)
        for (struct span run = {w.row.first, w.row.first}; run.first < w.row.end;
             run.first = run.end) {
            while (run.end < w.row.end && label[run.end] == label[run.first])
                run.end++;
            if (!label[run.first])
                continue;
            if (!mem_grow(&counting->run, &capacity, runs + 1, sizeof *counting->run))
                return false;
            counting->run[runs++] = run;
        }
    return true;
}

/* Add the pairs of voxels in one row with voxels in the row y and z steps from it. Two runs of a
 * label have a pair, x steps apart, for each voxel where they overlap after one of them is moved by
 * x steps. Each pair is counted once, at its first voxel. */
static void add_rows(const struct pair_counting *counting, pair_counts count, size_t row, int y,
                     int z)
{
    const struct label_pairs *pairs = counting->pairs;
    const int64_t step = pairs->step[0], offset = y * pairs->cells[1] + z * pairs->cells[2];
    const ptrdiff_t rows = y * (ptrdiff_t)pairs->step[1] +
                           z * (ptrdiff_t)pairs->step[2] * (ptrdiff_t)pairs->scene->grid.size[1];
    const size_t *const at = counting->row + row, *const other = at + rows;
    const struct span *there = counting->run + other[0], *const last = counting->run + other[1];
    for (size_t i = at[0]; i < at[1]; i++) {
        const struct span *here = counting->run + i;
        const uint8_t label = pairs->label[here->first];
        while (there < last && there->end - offset + REACH * step <= here->first)
            there++;
        for (const struct span *run = there;
             run < last && run->first - offset - REACH * step < here->end; run++) {
            if (pairs->label[run->first] != label)
                continue;
            for (int x = y || z ? -REACH : 0; x <= REACH; x++) {
                const int64_t moved = offset + x * step;
                const int64_t first = run->first - moved, end = run->end - moved;
                const int64_t overlap = (end < here->end ? end : here->end) -
                                        (first > here->first ? first : here->first);
                count[label][kind_of(x, y, z)] += overlap > 0 ? (uint64_t)overlap : 0;
            }
        }
    }
}

static void count_pairs_part(void *context, unsigned worker)
{
    struct pair_counting *counting = context;
    const struct label_pairs *pairs = counting->pairs;
    const struct grid *grid = &pairs->scene->grid;
    struct grid_walk w = scene_walk(pairs->scene, "surface", counting->team, worker);
    w.task.total = 0; /* rows with many runs need more time */
    while (grid_walk_next(&w)) {
        const size_t row = (size_t)w.z * grid->size[1] + w.y;
        for (int z = 0; z <= REACH; z++)
            for (int y = z ? -REACH : 0; y <= REACH; y++)
                if (grid_contains(grid, 0, w.y + (int64_t)y * pairs->step[1],
                                  w.z + (int64_t)z * pairs->step[2]))
                    add_rows(counting, counting->part[worker], row, y, z);
        task_advance(&w.task, counting->row[row + 1] - counting->row[row]);
    }
}

static enum err count_all_pairs(struct label_pairs *pairs, const struct labels *labels,
                                struct team *team, struct fault *fault)
{
    const struct grid *grid = &pairs->scene->grid;
    OWNED(mem_release) pair_counts *part = mem_new(team_size(team) * sizeof *part);
    OWNED(mem_release)
    size_t *row = mem_new(((size_t)grid->size[1] * grid->size[2] + 1) * sizeof *row);
    struct pair_counting counting = {pairs, team, part, NULL, row};
    labels_copy(labels, pairs->label, team);
    const bool fits = part && row && find_runs(&counting);
    if (fits)
        team_run(team, count_pairs_part, &counting);
    free(counting.run);
    if (!fits)
        return fault_memory(fault, "a surface");
    memset(pairs->count, 0, sizeof pairs->count);
    for (unsigned worker = 0; worker < team_size(team); worker++)
        for (unsigned label = 0; label < 256; label++)
            for (int kind = 0; kind < PAIR_KINDS; kind++)
                pairs->count[label][kind] += part[worker][label][kind];
    return OK;
}

enum err label_measures_refresh_pairs(struct label_measures *measures, const struct labels *labels,
                                      struct team *team, struct fault *fault)
{
    const struct scene *scene = labels->scene;
    enum err err = OK;
    if (!measures->pairs)
        measures->pairs = pairs_new(scene);
    struct label_pairs *pairs = measures->pairs;
    if (!pairs)
        return fault_memory(fault, "labels");
    struct task task = task_begin(scene->watch, "surface", pairs->log.count);
    if (!pairs->log.follows)
        err = count_all_pairs(pairs, labels, team, fault);
    for (size_t i = 0; i < pairs->log.count && task_advance(&task, 2); i++) {
        const struct change *change = &pairs->log.item[i];
        const struct place at = grid_place(&scene->grid, change->cell);
        add_pairs(pairs, change->cell, &at, false);
        pairs->label[change->cell] = change->label;
        add_pairs(pairs, change->cell, &at, true);
    }
    return change_log_settle(&pairs->log, err ? err : watch_fault(scene->watch, fault));
}

/* ---- components and holes ---- */

/* Count the holes of a label: components of all other voxels together, without a voxel at the edge
 * of the scene. The search is limited to the label's bounding box plus one voxel around it, which
 * connects to everything outside. */
static enum err count_holes(struct label_stats *stats, const struct scene *scene,
                            const uint8_t *label, unsigned of, struct fault *fault)
{
    const struct grid *grid = &scene->grid;
    const struct label_sums *sums = &stats->sums;
    OWNED(components_release) struct components found = {0};
    struct grid box;
    uint32_t corner[3], size[3];
    for (int a = 0; a < 3; a++) {
        const uint32_t end = grid->size[a] - 1;
        corner[a] = sums->first[a] > 0 ? sums->first[a] - 1 : 0;
        size[a] = (sums->last[a] < end ? sums->last[a] + 1 : end) - corner[a] + 1;
    }
    TRY(grid_init(&box, size, fault));
    /* 1 in voxels of the label, else 0. */
    OWNED(mem_release) uint8_t *selected = mem_array(box.cells, 1);
    struct grid_walk w = grid_rows(&box, scene->watch, "holes");
    while (selected && grid_walk_next(&w)) {
        const uint8_t *from = label + grid_cell(grid, corner[0], corner[1] + w.y, corner[2] + w.z);
        for (uint32_t x = 0; x < box.size[0]; x++)
            selected[w.row.first + x] = from[x] == of;
    }
    TRY(selected ? watch_fault(scene->watch, fault) : fault_memory(fault, "holes"));
    TRY(components_find(&found, &box, selected, scene->watch, fault));
    for (size_t i = 0; i < found.count; i++)
        stats->holes += !found.item[i].label && !found.item[i].at_edge;
    return OK;
}

/* ---- stored counts ---- */

void label_measures_release(struct label_measures *measures)
{
    struct label_counts *counts = measures->counts;
    struct label_pairs *pairs = measures->pairs;
    if (counts) {
        release_counters(counts->of);
        change_log_release(&counts->log);
    }
    if (pairs) {
        mem_pages_free(pairs->label, pairs->scene->grid.cells);
        change_log_release(&pairs->log);
    }
    free(counts);
    free(pairs);
    *measures = (struct label_measures){0};
}

size_t label_measures_memory(const struct label_measures *measures)
{
    const struct label_counts *counts = measures->counts;
    const struct label_pairs *pairs = measures->pairs;
    size_t bytes = 0;
    if (counts)
        bytes += sizeof *counts + counts->log.capacity * sizeof *counts->log.item;
    for (unsigned label = 0; counts && label < 256; label++)
        bytes += counts->of[label] ? counts->length * sizeof **counts->of : 0;
    if (pairs)
        bytes += sizeof *pairs + pairs->scene->grid.cells +
                 pairs->log.capacity * sizeof *pairs->log.item;
    return bytes;
}

void label_measures_follow(struct label_measures *measures, const struct changes *changes)
{
    if (measures->counts)
        change_log_add(&measures->counts->log, changes, measures->counts->scene->grid.voxels);
    if (measures->pairs)
        change_log_add(&measures->pairs->log, changes, measures->pairs->scene->grid.voxels);
}

void label_measures_forget(struct label_measures *measures)
{
    if (measures->counts)
        change_log_give_up(&measures->counts->log);
    if (measures->pairs)
        change_log_give_up(&measures->pairs->log);
}

enum err label_measures_sum(struct label_measures *measures, const struct labels *labels,
                            unsigned label, struct team *team, struct label_sums *sums,
                            struct fault *fault)
{
    TRY(refresh_counts(measures, labels, team, fault));
    *sums = sum_counts(measures->counts, label);
    return OK;
}

enum err label_stats_find(struct label_stats stats[256], struct label_measures *measures,
                          const struct labels *labels, struct team *team, struct fault *fault)
{
    const struct scene *scene = labels->scene;
    OWNED(components_release) struct components found = {0};
    TRY(refresh_counts(measures, labels, team, fault));
    TRY(label_measures_refresh_pairs(measures, labels, team, fault));
    const struct label_pairs *pairs = measures->pairs;
    for (unsigned label = 0; label < 256; label++) {
        stats[label] = (struct label_stats){.sums = sum_counts(measures->counts, label)};
        memcpy(stats[label].pairs, pairs->count[label], sizeof stats->pairs);
    }
    TRY(components_find(&found, &scene->grid, pairs->label, scene->watch, fault));
    for (size_t i = 0; i < found.count; i++)
        stats[found.item[i].label].components++;
    for (unsigned label = 1; label < 256; label++)
        if (stats[label].sums.voxels)
            TRY(count_holes(&stats[label], scene, pairs->label, label, fault));
    return OK;
}
