/* SPDX-License-Identifier: MIT */
/* Scenes, weights, forests and regions of interest. */
#include "tests/matrix/works.h"

#include "base/hash.h"
#include "engine/labels.h"
#include "engine/roi.h"
#include "tests/surface_check.h"

static const struct {
    const char *name;
    struct weight_choice choice;
} weights[] = {{"morph-1", {WEIGHT_MORPH, 1}},         {"morph-3", {WEIGHT_MORPH, 3}},
               {"sobel", {WEIGHT_SOBEL, 0}},           {"gauss-0.5", {WEIGHT_GAUSS, 500}},
               {"gauss-1.7", {WEIGHT_GAUSS, 1700}},    {"gauss-8", {WEIGHT_GAUSS, 8000}},
               {"difference", {WEIGHT_DIFFERENCE, 0}}, {"polarity", {WEIGHT_POLARITY, 0}}};

/* Order of the trees of a forest, which its digests do not cover. */
static uint64_t predecessors_digest(const struct forest *forest)
{
    const struct scene *scene = forest_scene(forest);
    uint64_t sum = 0;
    for (uint32_t c = 0; c < scene->grid.cells; c++)
        if (cell_is_reached(&scene->cell[c]))
            sum += hash_mix_at(c, forest_predecessor(forest, c));
    return sum;
}

static void tell_forest(const struct forest *forest, const char *name, unsigned adjacency,
                        const char *when)
{
    struct fault fault;
    must_hold(forest_check(forest, &fault), "the forest");
    tell(forest_digest(forest), "forest/%s/%u/%s/keys", name, adjacency, when);
    tell(forest_label_digest(forest), "forest/%s/%u/%s/labels", name, adjacency, when);
    tell(predecessors_digest(forest), "forest/%s/%u/%s/predecessors", name, adjacency, when);
}

static void weigh(struct forest *forest, struct scene *scene, const struct weight_choice *choice,
                  struct team *team)
{
    OWNED(weight_work_release) struct weight_work work = {.team = team};
    struct arc_rule arcs = {.kind = weight_arcs(choice->kind)};
    struct fault fault;
    for (int label = 0; label < 6; label++)
        arcs.polarity[label] = (int8_t)(40 * label - 100);
    must(weight_work_reserve(&work, &scene->grid, choice, &fault), &fault, "room for weights");
    weight_compute(scene, forest_adjacency(forest), choice, &work);
    forest_set_arcs(forest, &arcs);
    must(forest_rebuild(forest, &fault), &fault, "a forest from nothing");
}

/* Grown from nothing; a third erased and replanted with other labels, bit by bit; taken back. */
static void edit_forest(struct forest *forest, const char *name, unsigned adjacency)
{
    struct edit edit[WORKS_SEEDS], other;
    struct fault fault;
    works_edits(edit, forest_scene(forest), 7);
    must(forest_edit(forest, edit, WORKS_SEEDS, &fault), &fault, "the seeds");
    tell_forest(forest, name, adjacency, "planted");
    for (int i = 0; i < WORKS_SEEDS; i += 3) {
        other = (struct edit){edit[i].cell, (int16_t)(i % 2 ? EDIT_ERASE : (i + 1) % 6), 0};
        must(forest_edit(forest, &other, 1, &fault), &fault, "an edit");
        const struct changes changes = forest_changes(forest);
        tell(changes.everything ? 0 : changes.count, "forest/%s/%u/changes-%d", name, adjacency, i);
    }
    tell_forest(forest, name, adjacency, "edited");
    const struct seed_changes seeds = forest_seed_changes(forest);
    must(forest_edit(forest, seeds.before, seeds.count, &fault), &fault, "taking back");
    tell_forest(forest, name, adjacency, "reverted");
    must(forest_rebuild(forest, &fault), &fault, "a forest from nothing");
    tell_forest(forest, name, adjacency, "rebuilt");
}

static void forests(struct team *team, unsigned adjacency)
{
    for (size_t i = 0; i < sizeof weights / sizeof weights[0]; i++) {
        OWNED(scene_drop) struct scene *scene = works_scene();
        OWNED(forest_drop) struct forest *forest = NULL;
        struct fault fault;
        must(forest_new(&forest, scene, adjacency, &fault), &fault, "a forest");
        must(forest_set_team(forest, team, &fault), &fault, "a forest's team");
        weigh(forest, scene, &weights[i].choice, team);
        tell(weight_digest(scene, forest_arcs(forest), team), "weight/%s/%u", weights[i].name,
             adjacency);
        edit_forest(forest, weights[i].name, adjacency);
    }
}

/* A mask of two voxels in three, in runs, and a range; the forest again inside. */
static void excludes(struct team *team)
{
    static const struct weight_choice morph = {WEIGHT_MORPH, 1};
    OWNED(scene_drop) struct scene *scene = works_scene();
    OWNED(forest_drop) struct forest *forest = NULL;
    struct edit edit[WORKS_SEEDS];
    struct fault fault;
    OWNED(mem_release) uint64_t *bits = mem_new(mask_bytes(&scene->grid));
    struct roi roi = {bits, 20, 210, 0};
    size_t count = 0;
    must_hold(bits != NULL, "room for a mask");
    for (uint32_t c = 0; c < scene->grid.cells; c++)
        if (!(scene->cell[c].flags & CELL_RIM) && c / 37 % 3)
            bits[c >> 6] |= UINT64_C(1) << (c & 63);
    must(forest_new(&forest, scene, 6, &fault), &fault, "a forest");
    must(forest_set_team(forest, team, &fault), &fault, "a forest's team");
    const struct roi_tally tally = roi_tally(&roi, scene);
    tell(tally.digest, "roi/outside");
    tell(tally.inside, "roi/inside");
    roi_apply(&roi, scene);
    weigh(forest, scene, &morph, team);
    works_edits(edit, scene, 11);
    for (int i = 0; i < WORKS_SEEDS; i++)
        if (roi_holds(&roi, scene, edit[i].cell))
            edit[count++] = edit[i];
    must(forest_edit(forest, edit, count, &fault), &fault, "the seeds");
    tell_forest(forest, "inside-roi", 6, "planted");
}

/* Two seeds in three end within a distance; every other is erased, or planted again without. */
static void limits(struct team *team)
{
    static const struct weight_choice morph = {WEIGHT_MORPH, 1};
    OWNED(scene_drop) struct scene *scene = works_scene();
    OWNED(forest_drop) struct forest *forest = NULL;
    struct edit edit[WORKS_SEEDS];
    struct fault fault;
    size_t refused;
    must(forest_new(&forest, scene, 6, &fault), &fault, "a forest");
    must(forest_set_team(forest, team, &fault), &fault, "a forest's team");
    weigh(forest, scene, &morph, team);
    works_edits(edit, scene, 13);
    for (unsigned i = 0; i < WORKS_SEEDS; i++) {
        const struct place p = grid_place(&scene->grid, edit[i].cell);
        const struct reach reach = {{p.x, p.y, p.z}, {2, 3, 2}, 4 + i % 29};
        if (i % 3)
            must(forest_add_reach(forest, &reach, &edit[i].reach, &fault), &fault, "a reach");
    }
    must(forest_edit(forest, edit, WORKS_SEEDS, &fault), &fault, "the seeds");
    tell_forest(forest, "limited", 6, "planted");
    for (unsigned i = 0; i < WORKS_SEEDS; i += 2)
        edit[i] = (struct edit){edit[i].cell, i % 3 ? EDIT_ERASE : edit[i].label, 0};
    must(forest_edit(forest, edit, WORKS_SEEDS, &fault), &fault, "an edit");
    tell_forest(forest, "limited", 6, "edited");
    must(forest_count_refused(forest, &refused, &fault), &fault, "voxels out of reach");
    tell(refused, "forest/limited/6/refused");
}

/* ---- surfaces ---- */

static void labels_row(void *context, uint32_t y, uint32_t z, uint8_t *label)
{
    const struct labels *labels = context;
    labels_copy_row(labels, grid_row(&labels->scene->grid, y, z), label);
}

static void tell_surface(const struct surface *surface, const char *name)
{
    uint64_t points = 0, triangles = 0;
    for (size_t i = 0; i < 3 * surface->points; i++)
        points += hash_mix_at((uint32_t)i, surface->point[i / 3].at[i % 3]);
    for (size_t i = 0; i < 3 * surface->triangles; i++)
        triangles += hash_mix_at((uint32_t)i, surface->triangle[i / 3].point[i % 3]);
    tell(points, "surface/%s/points", name);
    tell(triangles, "surface/%s/triangles", name);
    tell((uint64_t)surface_volume(surface, &surface->part[0]), "surface/%s/volume", name);
}

/* Of a forest: faces of voxels, the net, and the net with fewer triangles. */
static void surfaces(struct team *team)
{
    static const struct weight_choice morph = {WEIGHT_MORPH, 1};
    OWNED(scene_drop) struct scene *scene = works_scene();
    struct labels labels = labels_of_forest(scene);
    const struct surface_source source = {scene->grid.size, labels_row, &labels};
    OWNED(forest_drop) struct forest *forest = NULL;
    struct edit edit[WORKS_SEEDS];
    struct fault fault;
    struct surface_choice choice = {.is_cubes = true};
    memset(choice.wanted, true, sizeof choice.wanted);
    must(forest_new(&forest, scene, 6, &fault), &fault, "a forest");
    weigh(forest, scene, &morph, team);
    works_edits(edit, scene, 7);
    must(forest_edit(forest, edit, WORKS_SEEDS, &fault), &fault, "the seeds");
    for (int turn = 0; turn < 2; turn++, choice.is_cubes = false) {
        OWNED(surface_drop) struct surface *surface;
        must(surface_new(&surface, &source, &choice, NULL, &fault), &fault, "a surface");
        tell_surface(surface, turn ? "smooth" : "plain");
        must(surface_reduce(surface, surface->triangles / 5, NULL, &fault), &fault, "fewer");
        tell_surface(surface, turn ? "smooth-few" : "plain-few");
    }
}

void works_engine(struct team *team)
{
    struct scene *scene = works_scene(), *doubled = NULL;
    struct fault fault;
    tell(scene_digest(scene), "scene/geom");
    for (unsigned axes = 1; axes < 8; axes++) {
        must(scene_new_interpolated(&doubled, scene, axes, NULL, &fault), &fault, "a scene");
        tell(scene_digest(doubled), "scene/interpolated-%u", axes);
        scene_free(doubled);
    }
    scene_free(scene);
    forests(team, 6);
    forests(team, 26);
    excludes(team);
    limits(team);
    surfaces(team);
}
