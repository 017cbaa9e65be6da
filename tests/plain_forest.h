/* SPDX-License-Identifier: MIT */
/* A plain solution of the equation of engine/forest.h, by Dijkstra's algorithm without a queue. It
 * shares no code with the engine: seeds and reaches are those that the test has recorded. And
 * sessions of random edits that are compared with it, and with a run from scratch. */
#ifndef TESTS_PLAIN_FOREST_H
#define TESTS_PLAIN_FOREST_H

#include "tests/border_check.h"
#include "tests/stopping.h"
#include "tests/world.h"
#include "engine/roi.h"

enum { CELLS_MOST = 12 * 12 * 12, REACHES = 6 };

/* The reaches of a world: plain_reach[n - 1] has number n. */
static struct reach plain_reach[REACHES];

struct plain {
    uint32_t cost, hops, root; /* cost UINT32_MAX: none */
};

static inline bool is_less(const struct plain *a, const struct plain *b)
{
    return a->cost != b->cost   ? a->cost < b->cost
           : a->hops != b->hops ? a->hops < b->hops
                                : a->root < b->root;
}

static const struct plain nothing = {UINT32_MAX, UINT32_MAX, UINT32_MAX};

/* The seeds, as the test itself remembers them. */
struct planted {
    int16_t label[CELLS_MOST]; /* or EDIT_ERASE */
    uint16_t reach[CELLS_MOST];
};

static inline bool plainly_allowed(const struct planted *planted, uint32_t root,
                                   const int32_t at[3])
{
    const unsigned number = planted->reach[root];
    if (!number)
        return true;
    const struct reach *reach = &plain_reach[number - 1];
    double sum = 0; /* exact: small numbers */
    for (int a = 0; a < 3; a++) {
        const double way = ((double)at[a] - reach->centre[a]) * reach->unit[a];
        sum += way * way;
    }
    return reach->radius >= 0 && sum <= (double)reach->radius * (double)reach->radius;
}

static inline uint32_t plain_weight(const struct world *w, uint32_t s, uint32_t t, int label)
{
    const struct arc_rule *rule = forest_arcs(w->forest);
    const struct cell *cell = w->scene->cell;
    const int64_t from = cell[s].intensity, to = cell[t].intensity;
    if (rule->kind == ARC_TARGET)
        return cell[t].weight;
    if (rule->kind == ARC_DIFFERENCE)
        return (uint32_t)llabs(from - to);
    const int64_t a = from > to ? rule->polarity[label] : -rule->polarity[label];
    const int64_t weight = llabs(from - to) * (100 + a) / 100;
    return (uint32_t)(weight < 65535 ? weight : 65535);
}

/* What s offers t along the arc. */
static inline struct plain plain_offer(const struct world *w, const struct planted *planted,
                                       const struct plain *key, uint32_t s, uint32_t t,
                                       const int32_t at[3])
{
    const struct plain from = key[s];
    if (from.cost == UINT32_MAX || !plainly_allowed(planted, from.root, at))
        return nothing;
    const uint32_t weight = plain_weight(w, s, t, planted->label[from.root]);
    return weight > from.cost ? (struct plain){weight, 0, from.root}
                              : (struct plain){from.cost, from.hops + 1, from.root};
}

/* Cells with a key that is not served yet. */
struct plain_waiting {
    uint32_t cell[CELLS_MOST];
    size_t count;
};

/* Offers what s has to each neighbour. */
static inline void offer_around(const struct world *w, const struct planted *planted,
                                struct plain *key, uint32_t s, struct plain_waiting *waiting)
{
    const struct grid *g = &w->scene->grid;
    const bool corners = forest_adjacency(w->forest)->count == 26;
    const struct place p = grid_place(g, s);
    for (int32_t z = -1; z <= 1; z++)
        for (int32_t y = -1; y <= 1; y++)
            for (int32_t x = -1; x <= 1; x++) {
                const int moved = (x != 0) + (y != 0) + (z != 0);
                const int32_t n[3] = {(int32_t)p.x + x, (int32_t)p.y + y, (int32_t)p.z + z};
                if (!moved || (moved > 1 && !corners) || !grid_contains(g, n[0], n[1], n[2]))
                    continue;
                const uint32_t t = grid_cell(g, (uint32_t)n[0], (uint32_t)n[1], (uint32_t)n[2]);
                const struct plain offer = plain_offer(w, planted, key, s, t, n);
                if (w->scene->cell[t].flags & CELL_OUTSIDE || !is_less(&offer, &key[t]))
                    continue;
                if (key[t].cost == UINT32_MAX)
                    waiting->cell[waiting->count++] = t;
                key[t] = offer;
            }
}

/* The least waiting key is final, since all later offers are above it. It is searched for among all
 * that wait. */
static inline void solve(const struct world *w, const struct planted *planted, struct plain *key)
{
    static struct plain_waiting waiting;
    for (uint32_t c = 0; c < w->scene->grid.cells; c++) {
        const bool is_seed = planted->label[c] != EDIT_ERASE;
        key[c] = is_seed ? (struct plain){0, 0, c} : nothing;
        if (is_seed)
            waiting.cell[waiting.count++] = c;
    }
    while (waiting.count > 0) {
        size_t best = 0;
        for (size_t i = 1; i < waiting.count; i++)
            if (is_less(&key[waiting.cell[i]], &key[waiting.cell[best]]))
                best = i;
        const uint32_t s = waiting.cell[best];
        waiting.cell[best] = waiting.cell[--waiting.count];
        offer_around(w, planted, key, s, &waiting);
    }
}

/* True if keys and labels are the plain solution: its costs are the textbook's f_max costs if no
 * seed has a reach. */
static inline bool equals_plain(const struct world *w, const struct planted *planted,
                                struct plain key[CELLS_MOST])
{
    const struct grid *g = &w->scene->grid;
    bool same = true;
    solve(w, planted, key);
    for (size_t c = 0; c < g->cells; c++) {
        const struct cell *cell = w->scene->cell + c;
        if (cell->flags & (CELL_RIM | CELL_OUTSIDE))
            same &= cell->key == 0 && cell->label == 0;
        else if (key[c].cost == UINT32_MAX)
            same &= cell->key == KEY_NONE && cell->label == 0;
        else
            same &= cell->key == key_make(key[c].cost, key[c].hops, key[c].root) &&
                    cell->label == planted->label[key[c].root];
    }
    return same;
}

static inline size_t refused(const struct world *w)
{
    size_t voxels = 99;
    CHECK(forest_count_refused(w->forest, &voxels, NULL) == OK);
    return voxels;
}

/* Voxels without a key next to one that has a key, or next to such a voxel. */
static inline size_t plain_refused(const struct world *w, const struct plain *key)
{
    static bool out[CELLS_MOST];
    const struct adjacency *adjacency = forest_adjacency(w->forest);
    const struct grid *g = &w->scene->grid;
    size_t count = 0;
    memset(out, 0, sizeof out);
    for (bool changes = true; changes;) {
        changes = false;
        for (size_t c = 0; c < g->cells; c++) {
            if (out[c] || key[c].cost != UINT32_MAX ||
                w->scene->cell[c].flags & (CELL_RIM | CELL_OUTSIDE))
                continue;
            bool beside = false;
            for (unsigned i = 0; i < adjacency->count; i++) {
                const size_t n = c + (size_t)adjacency->offset[i];
                beside |= out[n] || key[n].cost != UINT32_MAX;
            }
            changes |= out[c] = beside;
            count += beside;
        }
    }
    return count;
}

static inline bool equals_oracle(const struct world *w, const struct planted *planted)
{
    static struct plain key[CELLS_MOST];
    const bool same = equals_plain(w, planted, key);
    return same && refused(w) == (forest_limited_seeds(w->forest) ? plain_refused(w, key) : 0);
}

/* ---- random edits ---- */

enum { LABELS = 4 };
enum texture { FLAT, FLAT_HIGH, NOISY, STEEP, GRADIENT, TEXTURES };

static unsigned plain_reaches; /* of the world */

static inline void paint(struct world *w, enum texture texture, uint32_t levels, uint64_t *random)
{
    static const struct weight_choice morph = {WEIGHT_MORPH, 1};
    for (size_t i = 0; i < w->scene->grid.cells; i++) {
        struct cell *cell = w->scene->cell + i;
        const uint32_t r = (uint32_t)check_random(random);
        if (cell->flags & CELL_RIM)
            continue;
        cell->intensity = (uint16_t)check_below(random, levels);
        cell->weight = (uint16_t)(texture == FLAT        ? 0
                                  : texture == FLAT_HIGH ? 65535
                                  : texture == NOISY     ? r % 4
                                                         : r);
    }
    if (texture == GRADIENT)
        weight_compute(w->scene, forest_adjacency(w->forest), &morph, &(struct weight_work){0});
}

static inline void random_arcs(struct world *w, uint64_t *random)
{
    struct arc_rule rule = {.kind = check_below(random, 2) ? ARC_TARGET : check_below(random, 3)};
    for (int label = 0; label < LABELS; label++)
        rule.polarity[label] =
            (int8_t)(check_below(random, 5) ? (int)check_below(random, 201) - 100 : 0);
    forest_set_arcs(w->forest, &rule);
}

/* A world of at most so many voxels a side. If seeds may have a reach, none has in a third of the
 * worlds. */
static inline struct world random_world(uint64_t *random, const uint32_t most[3], bool has_reaches)
{
    struct world w = world_new(1 + check_below(random, most[0]), 1 + check_below(random, most[1]),
                               1 + check_below(random, most[2]), check_below(random, 2) ? 6 : 26);
    const unsigned reaches = has_reaches && check_below(random, 3) ? REACHES : 0;
    paint(&w, check_below(random, TEXTURES), check_below(random, 3) ? 5 : 65536, random);
    random_arcs(&w, random);
    for (plain_reaches = 0; plain_reaches < reaches; plain_reaches++) {
        struct reach *reach = &plain_reach[plain_reaches];
        *reach = (struct reach){.radius = check_below(random, 7)};
        if (plain_reaches == 0 && check_below(random, 3) == 0)
            reach->radius = REACH_EXACT;
        for (int a = 0; a < 3; a++) {
            reach->centre[a] = check_below(random, w.scene->grid.size[a]);
            reach->unit[a] = 1 + (check_below(random, 4) == 0);
        }
        uint16_t number;
        CHECK(forest_add_reach(w.forest, reach, &number, NULL) == OK);
    }
    return w;
}

/* A ball or a few voxels of one marker, erasures, or seeds planted again with another reach. */
static inline size_t random_batch(const struct world *w, struct edit *batch, uint64_t *random)
{
    const struct grid *g = &w->scene->grid;
    size_t count = 0;
    if (check_below(random, 30) == 0) {
        for (uint32_t c = 0; c < g->cells; c++)
            if (w->scene->cell[c].flags & CELL_SEED)
                batch[count++] = (struct edit){c, EDIT_ERASE, 0};
        return count;
    }
    for (uint32_t n = 1 + check_below(random, 4); n > 0; n--) {
        uint32_t at = random_voxel(g, random);
        const struct cell *cell = w->scene->cell + at;
        int16_t label = (int16_t)check_below(random, LABELS);
        const uint32_t what = check_below(random, 6);
        if (what < 3 && cell_is_reached(cell)) { /* the seed whose tree holds the voxel */
            at = key_root(cell->key);
            label = what == 0 ? w->scene->cell[at].label : EDIT_ERASE;
        } else if (what == 2) {
            label = EDIT_ERASE; /* of nothing */
        }
        if (w->scene->cell[at].flags & CELL_OUTSIDE)
            continue;
        const bool has_reach = plain_reaches && check_below(random, 3);
        const uint16_t reach = (uint16_t)(has_reach ? 1 + check_below(random, plain_reaches) : 0);
        batch[count++] = (struct edit){at, label, label == EDIT_ERASE ? 0 : reach};
    }
    return count;
}

static inline void note(struct planted *planted, const struct edit *edit, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        planted->label[edit[i].cell] = edit[i].label;
        planted->reach[edit[i].cell] = edit[i].reach;
    }
}

/* A region of interest of few voxels, most or all, by a mask, a range or both; seeds outside it
 * are removed first. */
static inline void random_roi(struct world *w, struct planted *planted, uint64_t *random)
{
    static struct edit batch[CELLS_MOST];
    static uint64_t bits[CELLS_MOST / 64 + 1];
    const uint32_t part = 1 + check_below(random, 10);
    struct roi roi = roi_none();
    size_t count = 0;
    roi.mask = check_below(random, 3) ? bits : NULL;
    memset(bits, 0, sizeof bits);
    for (uint32_t c = 0; c < w->scene->grid.cells; c++)
        bits[c >> 6] |= (uint64_t)(check_below(random, 11) < part) << (c & 63);
    if (check_below(random, 3) == 0) {
        roi.low = w->scene->cell[random_voxel(&w->scene->grid, random)].intensity;
        roi.high = w->scene->cell[random_voxel(&w->scene->grid, random)].intensity;
    }
    for (uint32_t c = 0; c < w->scene->grid.cells; c++)
        if (planted->label[c] != EDIT_ERASE && !roi_holds(&roi, w->scene, c))
            batch[count++] = (struct edit){c, EDIT_ERASE, 0};
    CHECK_INT(roi_tally(&roi, w->scene).seeds_outside, count);
    CHECK(forest_edit(w->forest, batch, count, NULL) == OK);
    note(planted, batch, count);
    roi_apply(&roi, w->scene);
    CHECK(forest_rebuild(w->forest, NULL) == OK);
}

/* An edit that is stopped after some looks, if it is not done by then. */
static inline bool edit_stopped(struct world *w, const struct edit *edit, size_t count, int looks)
{
    struct watch watch = {.context = &looks, .poll = stop_after_looks, .step = 1};
    w->scene->watch = &watch;
    const enum err err = forest_edit(w->forest, edit, count, NULL);
    w->scene->watch = NULL;
    CHECK(err == OK || err == ERR_CANCELLED);
    return err != OK;
}

/* One edit, either undone, or stopped and rolled back; or a rebuild, or one after the edit. False
 * if nothing has changed. */
static inline bool random_edit(struct world *w, struct planted *planted, uint64_t *random)
{
    static struct edit batch[CELLS_MOST];
    static bool was_stopped; /* the edit before: then it has changed nothing that could be undone */
    const struct seed_changes last =
        was_stopped ? (struct seed_changes){0} : forest_seed_changes(w->forest);
    size_t count = random_batch(w, batch, random);
    const uint32_t what = check_below(random, 24);
    if (what == 10) {
        random_arcs(w, random);
        CHECK(forest_rebuild(w->forest, NULL) == OK);
        return true;
    }
    was_stopped = false;
    if (what == 9) {
        random_roi(w, planted, random);
        return true;
    }
    if (what < 5 && last.count > 0 && last.count < CELLS_MOST) {
        count = 0;
        for (size_t i = 0; i < last.count; i++)
            if (!(w->scene->cell[last.before[i].cell].flags & CELL_OUTSIDE))
                batch[count++] = last.before[i];
        CHECK(forest_edit(w->forest, batch, count, NULL) == OK);
    } else if (what < 9) {
        was_stopped = edit_stopped(w, batch, count, (int)check_below(random, 12));
    } else if (what == 11) {
        forest_suspend(w->forest);
        CHECK(forest_edit(w->forest, batch, count, NULL) == OK);
        CHECK(forest_catch_up(w->forest, NULL) == OK);
    } else {
        CHECK(forest_edit(w->forest, batch, count, NULL) == OK);
    }
    if (!was_stopped)
        note(planted, batch, count);
    return !was_stopped;
}

/* The number of voxels that had to do without a tree, over all. */
static size_t holes_seen;

static inline void random_session(uint64_t seed, unsigned steps, bool has_reaches,
                                  struct team *team)
{
    static const uint32_t most[3] = {9, 7, 6};
    static struct planted planted;
    uint64_t random = seed;
    OWNED(world_free) struct world w = random_world(&random, most, has_reaches);
    struct fault fault = {0};
    OWNED(border_release) struct border border;
    CHECK(border_init(&border, w.scene, NULL) == OK);
    CHECK(forest_set_team(w.forest, team, NULL) == OK);
    for (size_t c = 0; c < CELLS_MOST; c++) {
        planted.label[c] = EDIT_ERASE;
        planted.reach[c] = 0;
    }
    for (unsigned step = 0; step < steps; step++) {
        if (random_edit(&w, &planted, &random)) {
            const struct changes changes = forest_changes(w.forest);
            border_update(&border, &changes);
        }
        if (step == 3) {
            border.visible[1] = false;
            border_recount(&border);
        }
        if (!CHECK(equals_oracle(&w, &planted)) ||
            !CHECK(world_equals_scratch(&w, team, plain_reach, plain_reaches)) ||
            !CHECK(forest_check(w.forest, &fault)) || !CHECK(border_check(&border, &fault))) {
            printf("# seed %" PRIu64 " step %u %s\n", seed, step, fault.text);
            break;
        }
        holes_seen += refused(&w);
    }
}

#endif
