/* SPDX-License-Identifier: MIT */
#include "engine/label_stats.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

enum { REACH = 2, AROUND = 124 };

/* A voxel that makes a pair with the one in the middle. */
struct neighbour {
    int32_t step[3]; /* voxels */
    ptrdiff_t offset;
};

typedef uint64_t pair_counts[256][PAIR_KINDS];

struct label_pairs {
    const struct scene *scene;
    uint32_t step[3];
    ptrdiff_t cells[3];              /* of a step */
    struct neighbour around[AROUND]; /* in the order of their kinds */
    uint8_t first[PAIR_KINDS + 1];   /* those of a kind, from 1 on, begin here */
    struct change_log log;
    uint8_t *label; /* [cells] as seen last */
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

/* ---- making ---- */

static int kind_of(int x, int y, int z)
{
    return abs(x) + 3 * abs(y) + 9 * abs(z);
}

enum err label_pairs_new(struct label_pairs **out, const struct scene *scene, struct fault *fault)
{
    struct label_pairs *pairs = mem_new(sizeof *pairs);
    if (pairs)
        pairs->label = mem_pages(scene->grid.cells);
    if (!pairs || !pairs->label) {
        free(pairs);
        return fault_memory(fault, "labels");
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
    *out = pairs;
    return OK;
}

void label_pairs_free(struct label_pairs *pairs)
{
    if (!pairs)
        return;
    mem_pages_free(pairs->label, pairs->scene->grid.cells);
    change_log_release(&pairs->log);
    free(pairs);
}

size_t label_pairs_memory(const struct label_pairs *pairs)
{
    return pairs ? sizeof *pairs + pairs->scene->grid.cells +
                       pairs->log.capacity * sizeof *pairs->log.item
                 : 0;
}

/* ---- following ---- */

static bool is_inside(const struct label_pairs *pairs, const struct place *at)
{
    const uint32_t place[3] = {at->x, at->y, at->z};
    for (int a = 0; a < 3; a++)
        if (place[a] < REACH * pairs->step[a] ||
            place[a] + REACH * pairs->step[a] >= pairs->scene->grid.size[a])
            return false;
    return true;
}

/* Of the eight bytes from here: 1 for each that is `label`, else 0. */
static uint64_t equal_bytes(const uint8_t *byte, uint8_t label)
{
    const uint64_t ones = UINT64_C(0x0101010101010101), low = 127 * ones;
    uint64_t word;
    memcpy(&word, byte, sizeof word);
    word ^= ones * label;
    return ~(((word & low) + low) | word | low) >> 7;
}

/* The pairs that a voxel makes with its label come, or go. */
static void add_voxel(struct label_pairs *pairs, uint32_t cell, const struct place *at, bool comes)
{
    const uint8_t label = pairs->label[cell];
    uint32_t found[PAIR_KINDS] = {0};
    if (!label)
        return;
    if (!is_inside(pairs, at)) {
        const struct grid *grid = &pairs->scene->grid;
        found[0] = 1;
        for (int kind = 1; kind < PAIR_KINDS; kind++)
            for (unsigned i = pairs->first[kind]; i < pairs->first[kind + 1]; i++) {
                const struct neighbour *n = &pairs->around[i];
                if (grid_contains(grid, at->x + (int64_t)n->step[0], at->y + (int64_t)n->step[1],
                                  at->z + (int64_t)n->step[2]))
                    found[kind] += (pairs->label + cell)[n->offset] == label;
            }
    } else if (pairs->step[0] == 1) {
        /* All neighbours are in the scene. A step along x is one voxel, so the five that count in a
         * row are among eight consecutive bytes. */
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
    } else {
        /* The same, where a step along x is several voxels. */
        const ptrdiff_t *step = pairs->cells;
        for (int z = -REACH; z <= REACH; z++)
            for (int y = -REACH; y <= REACH; y++) {
                const uint8_t *row = pairs->label + cell + z * step[2] + y * step[1];
                uint32_t *of = &found[kind_of(0, y, z)];
                of[0] += *row == label;
                for (int x = 1; x <= REACH; x++)
                    of[x] += (uint32_t)(row[-x * step[0]] == label) + (row[x * step[0]] == label);
            }
    }
    for (int kind = 0; kind < PAIR_KINDS; kind++)
        pairs->count[label][kind] += comes ? found[kind] : -(uint64_t)found[kind];
}

void label_pairs_follow(struct label_pairs *pairs, const struct changes *changes)
{
    if (pairs)
        change_log_add(&pairs->log, changes, pairs->scene->grid.voxels);
}

void label_pairs_forget(struct label_pairs *pairs)
{
    if (pairs)
        change_log_give_up(&pairs->log);
}

/* ---- counting all ---- */

struct counting {
    struct label_pairs *pairs;
    struct team *team;
    pair_counts *part; /* of each worker */
};

/* How many of `count` bytes are `label`. */
static uint32_t count_equal(const uint8_t *byte, uint32_t count, uint8_t label)
{
    uint32_t equal = 0;
    for (; count >= 8; count -= 8, byte += 8)
        equal += (uint32_t)(equal_bytes(byte, label) * UINT64_C(0x0101010101010101) >> 56);
    for (; count > 0; count--)
        equal += *byte++ == label;
    return equal;
}

/* The pairs of the voxels x..end-1 of a row with those that lie so far from them. */
static uint32_t pairs_of(const struct label_pairs *pairs, struct span run, const struct place *at,
                         const struct neighbour *n)
{
    const uint32_t *size = pairs->scene->grid.size;
    const int64_t y = at->y + (int64_t)n->step[1], z = at->z + (int64_t)n->step[2];
    const int64_t beyond = size[0] - (int64_t)n->step[0], x = at->x, end = x + run.end - run.first;
    const int64_t from = x < -n->step[0] ? -n->step[0] : x, to = end < beyond ? end : beyond;
    if (y < 0 || y >= size[1] || z < 0 || z >= size[2] || from >= to)
        return 0;
    const uint8_t *label = pairs->label + run.first;
    return count_equal(label + (from - x) + n->offset, (uint32_t)(to - from), *label);
}

static uint64_t add_row(const struct label_pairs *pairs, pair_counts count, uint32_t y, uint32_t z)
{
    const struct span row = grid_row(&pairs->scene->grid, y, z);
    uint64_t looked = row.end - row.first;
    for (struct span run = {row.first, row.first}; run.first < row.end; run.first = run.end) {
        const uint8_t label = pairs->label[run.first];
        while (run.end < row.end && pairs->label[run.end] == label)
            run.end++;
        if (label) {
            /* Of both voxels of a pair, by the one that comes first. */
            const struct place *at = &(const struct place){run.first - row.first, y, z};
            count[label][0] += run.end - run.first;
            for (int kind = 1; kind < PAIR_KINDS; kind++)
                for (unsigned i = pairs->first[kind]; i < pairs->first[kind + 1]; i++)
                    if (pairs->around[i].offset > 0)
                        count[label][kind] += pairs_of(pairs, run, at, &pairs->around[i]);
            looked += 2 * (uint64_t)(run.end - run.first);
        }
    }
    return looked;
}

static void count_part(void *context, unsigned worker)
{
    struct counting *counting = context;
    const struct scene *scene = counting->pairs->scene;
    const struct slab slab = grid_slab(&scene->grid, worker, team_size(counting->team));
    struct task task = task_begin_part(scene->watch, "surface", 0, worker);
    for (uint32_t z = slab.first; z < slab.end; z++)
        for (uint32_t y = 0; y < scene->grid.size[1]; y++)
            if (!task_advance(&task, add_row(counting->pairs, counting->part[worker], y, z)))
                return;
}

static enum err count_all(struct label_pairs *pairs, const struct labels *labels, struct team *team,
                          struct fault *fault)
{
    struct counting counting = {pairs, team, NULL};
    counting.part = mem_array(team_size(team), sizeof *counting.part);
    if (!counting.part)
        return fault_memory(fault, "a surface");
    memset(counting.part, 0, team_size(team) * sizeof *counting.part);
    labels_copy(labels, pairs->label, team);
    team_run(team, count_part, &counting);
    memset(pairs->count, 0, sizeof pairs->count);
    for (unsigned worker = 0; worker < team_size(team); worker++)
        for (unsigned label = 0; label < 256; label++)
            for (int kind = 0; kind < PAIR_KINDS; kind++)
                pairs->count[label][kind] += counting.part[worker][label][kind];
    free(counting.part);
    return OK;
}

enum err label_pairs_refresh(struct label_pairs *pairs, const struct labels *labels,
                             struct team *team, struct fault *fault)
{
    enum err err = OK;
    if (pairs->log.follows) {
        struct task task = task_begin(pairs->scene->watch, "surface", pairs->log.count);
        for (size_t i = 0; i < pairs->log.count && task_advance(&task, 2); i++) {
            const struct change *change = &pairs->log.item[i];
            const struct place at = grid_place(&pairs->scene->grid, change->cell);
            add_voxel(pairs, change->cell, &at, false);
            pairs->label[change->cell] = change->label;
            add_voxel(pairs, change->cell, &at, true);
        }
    } else {
        err = count_all(pairs, labels, team, fault);
    }
    return change_log_settle(&pairs->log, err ? err : watch_fault(pairs->scene->watch, fault));
}

const uint64_t *label_pairs_of(const struct label_pairs *pairs, unsigned label)
{
    return pairs->count[label];
}

const uint8_t *label_pairs_labels(const struct label_pairs *pairs)
{
    return pairs->label;
}
