#include "engine/label_counts.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

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

static void release(counters of)
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

enum err label_counts_new(struct label_counts **out, const struct scene *scene, struct fault *fault)
{
    struct label_counts *counts = mem_new(sizeof *counts);
    if (!counts)
        return fault_memory(fault, "counts of labels");
    counts->scene = scene;
    *out = counts;
    return OK;
}

void label_counts_free(struct label_counts *counts)
{
    if (!counts)
        return;
    release(counts->of);
    change_log_release(&counts->log);
    free(counts);
}

size_t label_counts_memory(const struct label_counts *counts)
{
    if (!counts)
        return 0;
    size_t bytes = sizeof *counts + counts->log.capacity * sizeof *counts->log.item;
    for (unsigned label = 0; label < 256; label++)
        bytes += counts->of[label] ? counts->length * sizeof **counts->of : 0;
    return bytes;
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

void label_counts_follow(struct label_counts *counts, const struct changes *changes)
{
    if (counts)
        change_log_add(&counts->log, changes, counts->scene->grid.voxels);
}

void label_counts_forget(struct label_counts *counts)
{
    if (counts)
        change_log_give_up(&counts->log);
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
static bool gather(struct label_counts *counts, struct counting *counting)
{
    bool fits = true;
    release(counts->of);
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

/* As many workers as memory allows: a scene of 16 bits has 256 kB of counters a label. */
static unsigned workers_for(const struct label_counts *counts, const struct team *team)
{
    const size_t fit = BYTES_OF_WORKERS / (256 * counts->length * sizeof **counts->of);
    return fit < 1 ? 1 : fit < team_size(team) ? (unsigned)fit : team_size(team);
}

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
        counting->workers = workers_for(counts, team);
        team_run(team, count_part, counting);
        err = gather(counts, counting) ? OK : fault_memory(fault, "counts of labels");
    }
    free(counting);
    return err;
}

enum err label_counts_refresh(struct label_counts *counts, const struct labels *labels,
                              struct team *team, struct fault *fault)
{
    enum err err = OK;
    if (!counts->log.follows)
        err = count_all(counts, labels, team, fault);
    else if (!follow_log(counts))
        err = fault_memory(fault, "counts of labels");
    return change_log_settle(&counts->log, err ? err : watch_fault(counts->scene->watch, fault));
}

/* ---- sums ---- */

/* Counters of planes: how many voxels there are, the sum of their positions, the first and the
 * last. */
static uint64_t sum_planes(const uint32_t *counter, uint32_t planes, uint64_t *sum, uint32_t *first,
                           uint32_t *last)
{
    uint64_t voxels = 0;
    for (uint32_t i = 0; i < planes; i++) {
        if (!counter[i])
            continue;
        *first = voxels ? *first : i;
        *last = i;
        *sum += (uint64_t)counter[i] * i;
        voxels += counter[i];
    }
    return voxels;
}

static void sum_intensities(struct label_sums *sums, const uint32_t *counter, size_t intensities)
{
    const uint64_t rank[2] = {(sums->voxels - 1) / 2, sums->voxels / 2};
    uint64_t below = 0;
    for (size_t i = 0; i < intensities; i++) {
        if (!counter[i])
            continue;
        sums->least = below ? sums->least : (uint16_t)i;
        sums->most = (uint16_t)i;
        for (int m = 0; m < 2; m++)
            if (rank[m] >= below && rank[m] < below + counter[i])
                sums->middle[m] = (uint16_t)i;
        sums->intensity += (uint64_t)counter[i] * i;
        sums->intensity_squares += (uint64_t)counter[i] * i * i;
        below += counter[i];
    }
}

struct label_sums label_counts_sum(const struct label_counts *counts, unsigned label)
{
    const uint32_t *counter = counts->of[label];
    struct label_sums sums = {.voxels = 0};
    for (int a = 0; counter && a < 3; a++)
        sums.voxels = sum_planes(counter + counts->plane[a], counts->scene->grid.size[a],
                                 &sums.sum[a], &sums.first[a], &sums.last[a]);
    if (sums.voxels)
        sum_intensities(&sums, counter, counts->plane[0]);
    return sums;
}
