#include "engine/label_stats.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "engine/components.h"
#include "engine/label_surface.h"

/* What one thread counts. Intensities are counted by their high byte first, and by the low byte
 * then, of those alone whose high byte is that of a middle one. */
struct part {
    struct label_stats stats[256];
    uint32_t high[256][256];
    uint32_t low[256][2][256];
};

struct counting {
    const struct scene *scene;
    const uint8_t *label; /* [cells] */
    struct team *team;
    struct part *part;
    struct label_stats *stats; /* the sums of all parts */
};

/* ---- walking ---- */

/* Calls `add` for each run of equal labels. */
typedef void add_run(struct counting *counting, struct part *part, struct span run, uint32_t x,
                     uint32_t y, uint32_t z);

struct walk {
    struct counting *counting;
    add_run *add;
};

static void walk_row(const struct walk *walk, struct part *part, uint32_t y, uint32_t z)
{
    struct counting *c = walk->counting;
    const struct span row = grid_row(&c->scene->grid, y, z);
    for (struct span run = {row.first, row.first}; run.first < row.end; run.first = run.end) {
        while (run.end < row.end && c->label[run.end] == c->label[run.first])
            run.end++;
        walk->add(c, part, run, run.first - row.first, y, z);
    }
}

static void walk_part(void *context, unsigned worker)
{
    const struct walk *walk = context;
    struct counting *c = walk->counting;
    const struct grid *grid = &c->scene->grid;
    const struct slab slab = grid_slab(grid, worker, team_size(c->team));
    struct task task =
        task_begin_part(c->scene->watch, "counting", slab_voxels(grid, slab), worker);
    for (uint32_t z = slab.first; z < slab.end; z++)
        for (uint32_t y = 0; y < grid->size[1]; y++) {
            walk_row(walk, &c->part[worker], y, z);
            if (!task_advance(&task, grid->size[0]))
                return;
        }
}

static void walk_all(struct counting *counting, add_run *add)
{
    struct walk walk = {counting, add};
    team_run(counting->team, walk_part, &walk);
}

/* ---- counting ---- */

static void extend(struct label_stats *stats, const uint32_t first[3], const uint32_t last[3])
{
    for (int a = 0; a < 3; a++) {
        stats->first[a] = first[a] < stats->first[a] ? first[a] : stats->first[a];
        stats->last[a] = last[a] > stats->last[a] ? last[a] : stats->last[a];
    }
}

static void count_run(struct counting *counting, struct part *part, struct span run, uint32_t x,
                      uint32_t y, uint32_t z)
{
    const uint8_t label = counting->label[run.first];
    struct label_stats *stats = &part->stats[label];
    const uint64_t count = run.end - run.first;
    stats->voxels += count;
    stats->sum[0] += count * (2 * x + count - 1) / 2;
    stats->sum[1] += count * y;
    stats->sum[2] += count * z;
    extend(stats, (const uint32_t[3]){x, y, z}, (const uint32_t[3]){x + (uint32_t)count - 1, y, z});
    for (uint32_t c = run.first; c < run.end; c++) {
        scene_fetch_ahead(counting->scene, c);
        const uint32_t value = counting->scene->cell[c].intensity;
        stats->intensity += value;
        stats->intensity_squares += (uint64_t)value * value;
        stats->least = value < stats->least ? (uint16_t)value : stats->least;
        stats->most = value > stats->most ? (uint16_t)value : stats->most;
        part->high[label][value >> 8]++;
    }
}

static void count_low_bytes(struct counting *counting, struct part *part, struct span run,
                            uint32_t x, uint32_t y, uint32_t z)
{
    const uint8_t label = counting->label[run.first];
    const uint16_t *middle = counting->stats[label].middle;
    const uint32_t high[2] = {middle[0] >> 8, middle[1] >> 8};
    (void)x, (void)y, (void)z;
    for (uint32_t c = run.first; c < run.end; c++) {
        scene_fetch_ahead(counting->scene, c);
        const uint32_t value = counting->scene->cell[c].intensity;
        for (int i = 0; i < 2; i++)
            part->low[label][i][value & 255] += value >> 8 == high[i];
    }
}

static void add_part(struct label_stats *to, const struct label_stats *part)
{
    to->voxels += part->voxels;
    to->intensity += part->intensity;
    to->intensity_squares += part->intensity_squares;
    to->least = part->least < to->least ? part->least : to->least;
    to->most = part->most > to->most ? part->most : to->most;
    for (int a = 0; a < 3; a++)
        to->sum[a] += part->sum[a];
    extend(to, part->first, part->last);
}

static const struct label_stats none = {.first = {UINT32_MAX, UINT32_MAX, UINT32_MAX},
                                        .least = UINT16_MAX};

/* The byte at which, counted from the lowest, number `rank` lies; *rank is then within it. */
static unsigned byte_of(const struct counting *counting, uint64_t *rank,
                        const uint32_t *(*count)(const struct part *, unsigned, int),
                        unsigned label, int i)
{
    for (unsigned byte = 0; byte < 256; byte++) {
        uint64_t here = 0;
        for (unsigned worker = 0; worker < team_size(counting->team); worker++)
            here += count(&counting->part[worker], label, i)[byte];
        if (*rank < here)
            return byte;
        *rank -= here;
    }
    return 0;
}

static const uint32_t *high_of(const struct part *part, unsigned label, int i)
{
    (void)i;
    return part->high[label];
}

static const uint32_t *low_of(const struct part *part, unsigned label, int i)
{
    return part->low[label][i];
}

static void find_middle(struct counting *counting)
{
    uint64_t rank[256][2] = {{0}};
    for (unsigned label = 0; label < 256; label++)
        for (int i = 0; i < 2 && counting->stats[label].voxels; i++) {
            rank[label][i] = (counting->stats[label].voxels - 1 + (uint64_t)i) / 2;
            counting->stats[label].middle[i] =
                (uint16_t)(byte_of(counting, &rank[label][i], high_of, label, i) << 8);
        }
    walk_all(counting, count_low_bytes);
    for (unsigned label = 0; label < 256; label++)
        for (int i = 0; i < 2 && counting->stats[label].voxels; i++)
            counting->stats[label].middle[i] |=
                (uint16_t)byte_of(counting, &rank[label][i], low_of, label, i);
}

static enum err count(struct counting *counting, struct fault *fault)
{
    const unsigned workers = team_size(counting->team);
    counting->part = mem_array(workers, sizeof *counting->part);
    if (!counting->part)
        return fault_memory(fault, "counts of labels");
    memset(counting->part, 0, workers * sizeof *counting->part);
    for (unsigned label = 0; label < 256; label++) {
        counting->stats[label] = none;
        for (unsigned worker = 0; worker < workers; worker++)
            counting->part[worker].stats[label] = none;
    }
    walk_all(counting, count_run);
    for (unsigned label = 0; label < 256; label++)
        for (unsigned worker = 0; worker < workers; worker++)
            add_part(&counting->stats[label], &counting->part[worker].stats[label]);
    find_middle(counting);
    free(counting->part);
    return watch_fault(counting->scene->watch, fault);
}

/* ---- components, holes and surfaces ---- */

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
    const struct label_stats *stats = &counting->stats[label];
    uint32_t size[3];
    for (int a = 0; a < 3; a++) {
        const uint32_t end = counting->scene->grid.size[a] - 1;
        corner[a] = stats->first[a] > 0 ? stats->first[a] - 1 : 0;
        size[a] = (stats->last[a] < end ? stats->last[a] + 1 : end) - corner[a] + 1;
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

static enum err find_surfaces(struct counting *counting, struct fault *fault)
{
    struct label_surface surface;
    const enum err err =
        label_surface_find(&surface, counting->label, counting->scene, counting->team, fault);
    for (unsigned label = 0; !err && label < 256; label++)
        memcpy(counting->stats[label].cosines, surface.cosines[label],
               sizeof surface.cosines[label]);
    return err;
}

enum err label_stats_find(struct label_stats stats[256], const struct labels *labels,
                          struct team *team, struct fault *fault)
{
    const size_t cells = labels->scene->grid.cells;
    uint8_t *copy = mem_pages(cells);
    struct counting counting = {
        .scene = labels->scene, .label = copy, .team = team, .stats = stats};
    if (!copy)
        return fault_memory(fault, "labels");
    labels_copy(labels, copy, team);
    enum err err = watch_fault(labels->scene->watch, fault);
    if (!err)
        err = count(&counting, fault);
    if (!err)
        err = count_components(&counting, fault);
    for (unsigned label = 1; !err && label < 256; label++)
        if (stats[label].voxels)
            err = count_holes(&counting, label, fault);
    if (!err)
        err = find_surfaces(&counting, fault);
    mem_pages_free(copy, cells);
    return err;
}
