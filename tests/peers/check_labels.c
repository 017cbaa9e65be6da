/* SPDX-License-Identifier: MIT */
/* Which labellings are optimal: check_labels FOLDER MARKERS NAME=LABELS[,COSTS]...
 *
 * A plain flood, level by level, that shares no code with the engine. At level w the voxels of
 * weight w enter; voxels without a marker that have entered and touch are one pool (union-find),
 * and a pool holds the set of labels of the markers beside it. The level at which the pool of a
 * voxel first holds a label is the voxel's minimax cost, and the labels it holds at the end of that
 * level are just those that a path of that cost can bring: a path enters every voxel but its first,
 * so the weight of a marker's own voxel does not count, and it passes over no other marker, which
 * keeps its own label at cost 0.
 *
 * ITK, vigra and scikit-image begin at a marker with the gradient of its own voxel. So the flood is
 * done twice: "free", where a marker has entered before all else, and "own", where it enters at its
 * own weight, like other voxels.
 *
 * Prints for every labelling, of which the first is iftty's:
 *
 *     NAME voxels=N same=N ties=N worse_free=N worse_own=N wrong=N
 *
 * voxels without a marker; those with the label that iftty gives; those with another, at the same
 * cost; those whose label cannot be had at the least cost, of either kind; and of all voxels those
 * whose cost is not the flood's. Status 1 where a labelling that has costs is wrong or worse_free
 * at some voxel. */
#include "base/mem.h"
#include "tests/peers/worker.h"

enum { LABELLINGS_MOST = 8, WORDS = 4, LEVELS = UINT16_MAX + 1 };
#define NO_VOXEL UINT32_MAX

struct labelling {
    const char *name;
    uint8_t *label; /* [voxels], label + 1; 0 for none */
    uint16_t *cost; /* [voxels], or NULL */
    size_t same, ties, worse_free, worse_own, wrong;
};

/* A pool, by its representative voxel in union-find. */
struct pool {
    uint64_t label[WORDS]; /* bit l: label l touches it */
    uint32_t first, last;  /* its voxels whose cost is not known yet, linked by `next` */
};

struct flood {
    const struct worker *scene;
    bool free; /* markers enter before all else */
    uint32_t *order, *parent, *next;
    struct pool *pool;
    bool *entered;
    uint16_t *cost; /* filled at the end */
    struct labelling *labelling;
    size_t labellings;
};

static uint32_t find(struct flood *flood, uint32_t at)
{
    while (flood->parent[at] != at)
        at = flood->parent[at] = flood->parent[flood->parent[at]];
    return at;
}

static void unite(struct flood *flood, uint32_t a, uint32_t b)
{
    a = find(flood, a);
    b = find(flood, b);
    if (a == b)
        return;
    struct pool *to = &flood->pool[a], *from = &flood->pool[b];
    flood->parent[b] = a;
    for (int i = 0; i < WORDS; i++)
        to->label[i] |= from->label[i];
    if (from->first == NO_VOXEL)
        return;
    if (to->first == NO_VOXEL)
        to->first = from->first;
    else
        flood->next[to->last] = from->first;
    to->last = from->last;
}

static bool holds(const struct pool *pool, uint8_t label)
{
    return pool->label[label >> 6] >> (label & 63) & 1;
}

/* List the face neighbours of a voxel, and return their number. */
static int neighbours(const struct worker *scene, uint32_t at, uint32_t beside[6])
{
    int count = 0;
    uint32_t step = 1, place = at;
    for (int a = 0; a < 3; a++) {
        const uint32_t along = place % scene->size[a];
        if (along > 0)
            beside[count++] = at - step;
        if (along + 1 < scene->size[a])
            beside[count++] = at + step;
        place /= scene->size[a];
        step *= scene->size[a];
    }
    return count;
}

/* Join a voxel and a neighbour that have both entered. */
static void meet(struct flood *flood, uint32_t a, uint32_t b)
{
    const uint8_t *marker = flood->scene->marker;
    if (marker[a] && marker[b])
        return;
    if (!marker[a] && !marker[b]) {
        unite(flood, a, b);
        return;
    }
    const uint8_t label = marker[a] ? marker[a] : marker[b];
    flood->pool[find(flood, marker[a] ? b : a)].label[label >> 6] |= UINT64_C(1) << (label & 63);
}

static void enter(struct flood *flood, uint32_t at)
{
    uint32_t beside[6];
    const int count = neighbours(flood->scene, at, beside);
    flood->entered[at] = true;
    for (int i = 0; i < count; i++)
        if (flood->entered[beside[i]])
            meet(flood, at, beside[i]);
}

/* The cost of a voxel is known, and which labels attain it. */
static void judge(struct flood *flood, uint32_t at, const struct pool *pool)
{
    const uint8_t ours = flood->labelling[0].label[at];
    for (size_t i = 0; i < flood->labellings; i++) {
        struct labelling *labelling = &flood->labelling[i];
        const uint8_t label = labelling->label[at];
        const bool attains = holds(pool, label);
        if (!flood->free) {
            labelling->worse_own += !attains;
            continue;
        }
        labelling->worse_free += !attains;
        labelling->same += label == ours;
        labelling->ties += label != ours && attains;
    }
}

/* At the end of a level, settle the pool of a voxel that entered, or the pools next to a marker
 * that did. */
static void settle(struct flood *flood, uint32_t at, uint16_t level)
{
    struct pool *pool = &flood->pool[find(flood, at)];
    if (!(pool->label[0] | pool->label[1] | pool->label[2] | pool->label[3]))
        return;
    for (uint32_t v = pool->first; v != NO_VOXEL; v = flood->next[v]) {
        flood->cost[v] = level;
        judge(flood, v, pool);
    }
    pool->first = NO_VOXEL;
}

static void settle_around(struct flood *flood, uint32_t at, uint16_t level)
{
    uint32_t beside[6];
    if (!flood->scene->marker[at]) {
        settle(flood, at, level);
        return;
    }
    const int count = neighbours(flood->scene, at, beside);
    for (int i = 0; i < count; i++)
        if (flood->entered[beside[i]] && !flood->scene->marker[beside[i]])
            settle(flood, beside[i], level);
}

static uint16_t level_of(const struct flood *flood, size_t voxel)
{
    return flood->free && flood->scene->marker[voxel] ? 0 : flood->scene->gradient[voxel];
}

/* Sorts the voxels by level; level l is order[end[l - 1]] up to order[end[l]]. */
static void sort_levels(struct flood *flood, uint32_t end[LEVELS])
{
    static uint32_t next[LEVELS];
    uint32_t sum = 0;
    const size_t voxels = flood->scene->voxels;
    memset(next, 0, sizeof next);
    for (size_t i = 0; i < voxels; i++)
        next[level_of(flood, i)]++;
    for (int level = 0; level < LEVELS; level++) {
        const uint32_t count = next[level];
        next[level] = sum;
        end[level] = sum += count;
    }
    for (size_t i = 0; i < voxels; i++)
        flood->order[next[level_of(flood, i)]++] = (uint32_t)i;
}

static void flood_all(struct flood *flood)
{
    static uint32_t end[LEVELS];
    uint32_t begin = 0;
    for (uint32_t i = 0; i < flood->scene->voxels; i++) {
        const bool marked = flood->scene->marker[i];
        flood->parent[i] = i;
        flood->next[i] = NO_VOXEL;
        flood->pool[i] = (struct pool){{0}, marked ? NO_VOXEL : i, i};
        flood->entered[i] = false;
        flood->cost[i] = 0;
    }
    sort_levels(flood, end);
    for (int level = 0; level < LEVELS; begin = end[level++]) {
        for (uint32_t i = begin; i < end[level]; i++)
            enter(flood, flood->order[i]);
        for (uint32_t i = begin; i < end[level]; i++)
            settle_around(flood, flood->order[i], (uint16_t)level);
    }
}

/* Every marker keeps its own label at cost 0; one that does not is worse, whatever counts. */
static size_t judge_markers(struct flood *flood)
{
    const struct worker *scene = flood->scene;
    size_t marked = 0;
    for (size_t v = 0; v < scene->voxels; v++)
        for (size_t i = 0; scene->marker[v] && i < flood->labellings; i++) {
            const bool lost = flood->labelling[i].label[v] != scene->marker[v];
            flood->labelling[i].worse_free += lost;
            flood->labelling[i].worse_own += lost;
            marked += i == 0;
        }
    return marked;
}

static size_t costs_wrong(const struct flood *flood, const uint16_t *cost)
{
    size_t wrong = 0;
    for (size_t i = 0; cost && i < flood->scene->voxels; i++)
        wrong += flood->cost[i] != cost[i];
    return wrong;
}

static bool check(struct flood *flood)
{
    flood->free = false;
    flood_all(flood);
    flood->free = true;
    flood_all(flood);
    const size_t marked = judge_markers(flood);
    bool fine = true;
    for (size_t i = 0; i < flood->labellings; i++) {
        const struct labelling *is = &flood->labelling[i];
        const size_t wrong = costs_wrong(flood, is->cost);
        printf("%s voxels=%zu same=%zu ties=%zu worse_free=%zu worse_own=%zu wrong=%zu\n", is->name,
               flood->scene->voxels - marked, is->same, is->ties, is->worse_free, is->worse_own,
               wrong);
        if (!is->cost || wrong + is->worse_free == 0)
            continue;
        fprintf(stderr, "%s: %zu costs are wrong, %zu labels do not attain the least cost\n",
                is->name, wrong, is->worse_free);
        fine = false;
    }
    return fine;
}

/* "NAME=LABELS[,COSTS]" as a labelling. */
static bool read_labelling(struct labelling *labelling, char *argument, size_t voxels)
{
    char *path = strchr(argument, '='), *costs = strchr(argument, ',');
    if (!path)
        return false;
    *path++ = '\0';
    if (costs) {
        *costs++ = '\0';
        labelling->cost = mem_array(voxels, sizeof *labelling->cost);
        if (!labelling->cost || !worker_read(costs, labelling->cost, voxels * sizeof(uint16_t)))
            return false;
    }
    labelling->name = argument;
    labelling->label = mem_array(voxels, 1);
    return labelling->label && worker_read(path, labelling->label, voxels);
}

int main(int argc, char **argv)
{
    struct worker scene = {0};
    struct labelling labelling[LABELLINGS_MOST] = {0};
    const int first = 3;
    if (argc <= first || argc - first > LABELLINGS_MOST || !worker_begin(&scene, argv[1]))
        return 2;
    const size_t voxels = scene.voxels;
    struct flood flood = {
        .scene = &scene,
        .order = mem_array(voxels, sizeof *flood.order),
        .parent = mem_array(voxels, sizeof *flood.parent),
        .next = mem_array(voxels, sizeof *flood.next),
        .pool = mem_array(voxels, sizeof *flood.pool),
        .entered = mem_array(voxels, sizeof *flood.entered),
        .cost = mem_array(voxels, sizeof *flood.cost),
        .labelling = labelling,
    };
    if (!flood.order || !flood.parent || !flood.next || !flood.pool || !flood.entered ||
        !flood.cost || !worker_read(argv[2], scene.marker, voxels)) {
        fprintf(stderr, "cannot read %s, or there is no memory for it\n", argv[2]);
        return 3;
    }
    for (int i = first; i < argc; i++)
        if (!read_labelling(&labelling[flood.labellings++], argv[i], voxels)) {
            fprintf(stderr, "cannot read %s; expected NAME=LABELS[,COSTS]\n", argv[i]);
            return 3;
        }
    return check(&flood) ? 0 : 1;
}
