/* SPDX-License-Identifier: MIT */
/* Relaxation against a plain model, which is written from the words of engine/relax.h and
 * shares nothing with it: fields of 64 bits, one array each, all distances by flooding, one voxel
 * after another. */
#include "engine/doubt.h"
#include "engine/relax.h"
#include "tests/finish_fails.h"

enum { LONG = 60, SHORT = 8, MOST = LONG * SHORT * SHORT, LABELS = 5 };
enum { WIDE = 240, PLATE = WIDE * WIDE * 2 }; /* voxels of a plate, in which changes are local */

DRAW_FROM(0)

/* Each team in turn, between rounds without one: threads that are more than the cores take their
 * time to meet, as often as there are sweeps. */
static struct team *team_for(int round)
{
    return round % 4 ? NULL : team_of[round / 4 % TEAMS];
}

/* ---- the model: voxels [z][y][x] one after another ---- */

struct volume {
    int size[3], count;
    int label[MOST], grey[MOST]; /* intensities */
    bool stays[MOST], is_outside[MOST];
};

/* The neighbouring voxel, or -1 outside the scene. */
static int beside(const struct volume *v, int at, int way)
{
    static const int step[6][3] = {{0, 0, -1}, {0, -1, 0}, {-1, 0, 0},
                                   {1, 0, 0},  {0, 1, 0},  {0, 0, 1}};
    const int x = at % v->size[0] + step[way][0], y = at / v->size[0] % v->size[1] + step[way][1],
              z = at / v->size[0] / v->size[1] + step[way][2];
    return x < 0 || y < 0 || z < 0 || x >= v->size[0] || y >= v->size[1] || z >= v->size[2]
               ? -1
               : (z * v->size[1] + y) * v->size[0] + x;
}

/* Steps to a voxel on the other side of the label's border; above 1000 for none. */
static void model_far(const struct volume *v, int label, int far[MOST])
{
    for (int i = 0; i < v->count; i++)
        far[i] = 9999;
    for (int round = 1; round <= FINISH_BAND_MOST + 1; round++)
        for (int i = 0; i < v->count; i++)
            for (int way = 0; way < 6; way++) {
                const int n = beside(v, i, way);
                if (n < 0 || far[i] < round)
                    continue;
                const bool crosses = (v->label[n] == label) != (v->label[i] == label);
                if (round == 1 ? crosses : far[n] == round - 1)
                    far[i] = round;
            }
}

/* 65536 exp(-400 (d/255)^2) by its series, to be compared with a table of integers. */
static int64_t model_through(int d)
{
    const double power = 400.0 * d * d / (255.0 * 255.0) / 64;
    double exponential = 1;
    for (int i = 30; i > 0; i--)
        exponential = 1 - power / i * exponential;
    for (int i = 0; i < 6; i++)
        exponential *= exponential;
    const int64_t through = (int64_t)(65536 * exponential + 0.5);
    return d > 41 || through < 1 ? 1 : through;
}

static int64_t round_half_even(int64_t a, int64_t by)
{
    const int64_t sign = a < 0 ? -1 : 1, whole = sign * a / by, rest = sign * a % by;
    return sign * (whole + (2 * rest > by || (2 * rest == by && whole % 2)));
}

static int compare_ints(const void *a, const void *b)
{
    return *(const int *)a - *(const int *)b;
}

/* 2^16 greys for a difference of one intensity: by the intensities of the band, sorted. */
static int64_t model_scale(const struct volume *v, const int far[MOST], int reach)
{
    static int sorted[MOST];
    int count = 0, range = 1;
    for (int i = 0; i < v->count; i++)
        if (far[i] <= reach)
            sorted[count++] = v->grey[i];
    qsort(sorted, (size_t)count, sizeof *sorted, compare_ints);
    if (count > 0) /* at most 2 % of them are below the one, and at least 98 % up to the other */
        range = sorted[(98 * count + 99) / 100 - 1] - sorted[2 * count / 100];
    return (255 << 16) / (range > 0 ? range : 1);
}

static void model_move(const struct volume *v, int64_t scale, int64_t u[MOST], int at)
{
    int64_t c[6], sum = 0, moved = 0;
    for (int way = 0; way < 6; way++) {
        const int n = beside(v, at, way);
        c[way] = n < 0 || v->is_outside[n]
                     ? 0
                     : model_through((int)((abs(v->grey[n] - v->grey[at]) * scale + 32768) >> 16));
        sum += c[way];
    }
    for (int way = 0; way < 6 && sum > 0; way++)
        if (c[way])
            moved += c[way] * ((INT64_C(1536) << 32) / sum) / (INT64_C(1) << 32) *
                     (u[beside(v, at, way)] - u[at]);
    u[at] += round_half_even(moved, 1024);
    u[at] = u[at] < 0 ? 0 : u[at] > RELAX_ONE ? RELAX_ONE : u[at];
}

static void model_field(const struct volume *v, int label, int sweeps, int reach, int64_t u[MOST],
                        int far[MOST])
{
    model_far(v, label, far);
    for (int i = 0; i < v->count; i++)
        u[i] = v->label[i] == label ? RELAX_ONE : 0;
    const int64_t scale = model_scale(v, far, reach);
    for (int half = 0; half < 2 * sweeps; half++)
        for (int i = 0; i < v->count; i++) {
            const int row = i / v->size[0];
            const bool is_even = (i % v->size[0] + row % v->size[1] + row / v->size[1]) % 2 == 0;
            if (is_even == (half % 2 == 0) && far[i] <= reach && !v->stays[i] && !v->is_outside[i])
                model_move(v, scale, u, i);
        }
}

/* The label that a voxel gets. Fields of labels whose band does not contain the voxel are
 * ignored. */
static int model_winner(const struct volume *v, int64_t u[LABELS][MOST], int far[LABELS][MOST],
                        int reach, int at)
{
    int64_t rest = RELAX_ONE;
    int best = 0;
    bool any = false;
    for (int label = 1; label < LABELS; label++)
        if (far[label][at] <= reach) {
            rest -= u[label][at];
            any = true;
        }
    u[0][at] = rest < 0 ? 0 : rest;
    far[0][at] = 0;
    for (int label = 1; label < LABELS; label++)
        if (far[label][at] <= reach &&
            (u[label][at] > u[best][at] || (u[label][at] == u[best][at] && label == v->label[at])))
            best = label;
    if (v->label[at] == 0 && u[0][at] == u[best][at])
        best = 0;
    return any ? best : v->label[at];
}

static void model(const struct volume *v, const struct finish_step *step, int made[MOST])
{
    static int64_t u[LABELS][MOST];
    static int far[LABELS][MOST];
    for (int label = 1; label < LABELS; label++)
        model_field(v, label, (int)step->argument, (int)step->reach, u[label], far[label]);
    for (int i = 0; i < v->count; i++) {
        const int winner = model_winner(v, u, far, (int)step->reach, i);
        const bool may = step->label == FINISH_ALL_LABELS || winner == (int)step->label ||
                         v->label[i] == (int)step->label;
        made[i] = may ? winner : v->label[i];
    }
}

/* ---- random scenes ---- */

/* Boxes of labels over each other; intensities in other boxes, with noise. */
static void fill(struct volume *v)
{
    const int long_axis = (int)below(3), noise = (int)below(40);
    const uint32_t labels = 2 + below(LABELS - 1), starts_at = below(2);
    v->count = 1;
    for (int a = 0; a < 3; a++) {
        v->size[a] = 1 + (int)below(a == long_axis ? LONG : SHORT);
        v->count *= v->size[a];
    }
    for (int i = 0; i < v->count; i++) {
        v->label[i] = (int)starts_at;
        v->grey[i] = 0;
        v->stays[i] = below(60) == 0;
        v->is_outside[i] = starts_at && below(30) == 0;
    }
    for (int box = (int)below(9); box > 0; box--) {
        const int label = (int)below(labels), grey = (int)below(200);
        const bool is_label = below(2);
        int first[3], last[3];
        for (int a = 0; a < 3; a++) {
            first[a] = (int)below((uint32_t)v->size[a]);
            last[a] = first[a] + (int)below(a == long_axis ? 20 : 6);
        }
        for (int i = 0; i < v->count; i++) {
            const int at[3] = {i % v->size[0], i / v->size[0] % v->size[1],
                               i / v->size[0] / v->size[1]};
            bool inside = true;
            for (int a = 0; a < 3; a++)
                inside = inside && at[a] >= first[a] && at[a] <= last[a];
            if (inside)
                *(is_label ? &v->label[i] : &v->grey[i]) = is_label ? label : grey;
        }
    }
    for (int i = 0; i < v->count; i++)
        v->grey[i] += (int)below((uint32_t)noise + 1);
    const int times = 1 + (int)below(200); /* up to 16 bits */
    for (int i = 0; i < v->count; i++)
        v->grey[i] *= times;
}

static uint32_t cell_of(const struct volume *v, const struct grid *grid, int i)
{
    return grid_cell(grid, (uint32_t)(i % v->size[0]), (uint32_t)(i / v->size[0] % v->size[1]),
                     (uint32_t)(i / v->size[0] / v->size[1]));
}

static struct scene *scene_of(const struct volume *v)
{
    struct scene *scene;
    const uint32_t size[3] = {(uint32_t)v->size[0], (uint32_t)v->size[1], (uint32_t)v->size[2]};
    if (scene_new(&scene, size, NULL, NULL, NULL) != OK)
        abort();
    for (int i = 0; i < v->count; i++) {
        struct cell *cell = scene->cell + cell_of(v, &scene->grid, i);
        cell->label = (uint8_t)v->label[i];
        cell->intensity = (uint16_t)v->grey[i];
        cell->flags =
            (uint8_t)((v->stays[i] ? CELL_SEED : 0) | (v->is_outside[i] ? CELL_OUTSIDE : 0));
    }
    return scene;
}

/* A volume, and the labels that the model makes of its own. */
struct relaxed {
    struct volume v;
    int made[MOST];
};

static bool agree(const void *expected, const struct scene *scene, const uint8_t *label)
{
    const struct relaxed *relaxed = expected;
    const struct volume *v = &relaxed->v;
    bool same = true;
    for (int i = 0; i < v->count; i++)
        same = same && label[cell_of(v, &scene->grid, i)] == relaxed->made[i];
    return same;
}

/* ---- stories ---- */

STORY(relaxed_labels_are_what_a_plain_model_makes)
{
    static struct relaxed expected;
    const struct volume *v = &expected.v;
    int moved = 0;
    for (int round = 0; round < (int)check_scaled(600); round++) {
        struct finish_list list = {.count = 1};
        uint8_t *label;
        seed = (uint64_t)round;
        fill(&expected.v);
        list.step[0] = (struct finish_step){
            .kind = FINISH_RELAX,
            .label = below(3) ? FINISH_ALL_LABELS : 1 + below(LABELS - 1),
            .argument = 1 + below(20),
            .reach = round % 3 ? 1 + below(FINISH_BAND_MOST) : FINISH_BAND_MOST,
        };
        OWNED(scene_drop) struct scene *scene = scene_of(v);
        model(v, &list.step[0], expected.made);
        CHECK(finish_make(&label, &list, scene, team_for(round), NULL, NULL) == OK);
        CHECK_WITH(agree(&expected, scene, label), "round %d: %dx%dx%d, %u sweeps", round,
                   v->size[0], v->size[1], v->size[2], list.step[0].argument);
        for (int i = 0; i < v->count; i++)
            moved += expected.made[i] != v->label[i];
        mem_pages_free(label, scene->grid.cells);
    }
    CHECK(moved > 600);
}

/* Computes the labels with and without what is kept. */
static bool agree_again(const struct finish_list *list, const struct scene *scene,
                        struct relax_kept *kept, int round)
{
    uint8_t *label, *again;
    const bool made =
        CHECK(finish_make(&label, list, scene, team_for(round), NULL, NULL) == OK) &&
        CHECK(finish_make(&again, list, scene, team_for(round + 1), kept, NULL) == OK);
    const bool same = made && CHECK(memcmp(label, again, scene->grid.cells) == 0);
    mem_pages_free(label, scene->grid.cells);
    mem_pages_free(again, scene->grid.cells);
    for (int of = 1; of < LABELS; of++) /* stored fields are up to date */
        CHECK(!kept->field[of] || finish_box_is_empty(&kept->changed[of]));
    return same;
}

/* An edit: neighbouring voxels are labelled, seeded or left out, or no longer so; often the same
 * voxels as in an earlier edit. */
static void edit(const struct volume *v, struct scene *scene)
{
    const uint8_t label = (uint8_t)below(LABELS), how = (uint8_t)below(4);
    const uint32_t count = (uint32_t)v->count, at = below(2) ? below(count) : below(4) * count / 4;
    const int first = (int)at, end = first + 1 + (int)(below(2) ? below(6) : 40);
    for (int i = first; i < end && i < v->count; i++) {
        struct cell *cell = &scene->cell[cell_of(v, &scene->grid, i)];
        if (how == 0)
            cell->label = label;
        else
            cell->flags ^= how == 1 ? CELL_SEED : how == 2 ? CELL_OUTSIDE : 0;
    }
}

/* Relaxation stopped at any point, which must leave what is kept valid. */
static void stop(const struct finish_list *list, struct scene *scene, struct relax_kept *kept)
{
    int looks = (int)below(12);
    struct watch watch = {.context = &looks, .poll = stop_after_looks, .step = 1};
    uint8_t *label;
    scene->watch = &watch;
    CHECK(finish_make(&label, list, scene, NULL, kept, NULL) == ERR_CANCELLED);
    scene->watch = NULL;
}

/* Fields that no edit affected are equal to before, and some of them are not computed again. */
STORY(fields_that_are_kept_are_those_that_would_be_made)
{
    static struct volume v;
    size_t kept_fields = 0;
    for (int round = 0; round < (int)check_scaled(20) && check_failures == 0; round++) {
        struct finish_list list = {.count = 1 + (uint32_t)below(2)};
        struct relax_kept kept = {0};
        seed = (uint64_t)round + 9000;
        fill(&v);
        OWNED(scene_drop) struct scene *scene = scene_of(&v);
        list.step[0] = (struct finish_step){.kind = FINISH_RELAX,
                                            .label = FINISH_ALL_LABELS,
                                            .argument = 1 + below(20),
                                            .reach = 1 + below(FINISH_BAND_MOST)};
        list.step[1] = (struct finish_step){.kind = round % 3 ? FINISH_MAJORITY : FINISH_RELAX,
                                            .label = FINISH_ALL_LABELS,
                                            .argument = 1,
                                            .reach = round % 3 ? 0 : 1 + below(4)};
        for (int edits = 0; edits < 12 && agree_again(&list, scene, &kept, round); edits++) {
            edit(&v, scene);
            if (edits % 3 == 2)
                stop(&list, scene, &kept);
            if (edits == 3 || edits == 9)
                list.step[0].label = edits == 3 ? 1 : FINISH_ALL_LABELS;
            if (edits == 5)
                list.step[0].argument++;
            if (edits == 7)
                list.step[0].reach = 1 + below(FINISH_BAND_MOST);
            if (edits == 8)
                kept.most = kept.bytes; /* no more of them */
            CHECK(kept.bytes <= kept.most);
            for (int label = 1; label < 256; label++)
                kept_fields += kept.field[label] != NULL;
        }
        relax_kept_release(&kept);
        CHECK_INT(relax_kept_memory(&kept), 0);
    }
    CHECK(kept_fields > 100);
}

/* A plate with two greys in stripes, bands of a label, seeds, and voxels left out. */
static struct scene *plate_of(uint32_t size[3])
{
    struct scene *scene;
    const uint32_t thin = below(3), stripe = 5 + below(40), step = below(3) ? below(30) : 0;
    const uint32_t noise = below(3) ? 4 : 3000; /* then an edit changes the scale */
    for (uint32_t a = 0; a < 3; a++)
        size[a] = a == thin ? 1 + below(2) : WIDE - below(60);
    if (scene_new(&scene, size, NULL, NULL, NULL) != OK)
        abort();
    for (uint32_t z = 0; z < size[2]; z++)
        for (uint32_t y = 0; y < size[1]; y++)
            for (uint32_t x = 0; x < size[0]; x++) {
                struct cell *cell = &scene->cell[grid_cell(&scene->grid, x, y, z)];
                const uint32_t at = x + 2 * y + 3 * z;
                cell->label = at / 2 % 160 > 80;
                cell->intensity =
                    (uint16_t)(at / stripe % 2 * step + below(noise) + 9 * (x + y + z));
                cell->flags = below(80) == 0 ? CELL_SEED : below(200) == 0 ? CELL_OUTSIDE : 0;
            }
    return scene;
}

/* Change some voxels near one place, and return a box around them. */
static struct finish_box change_plate(struct scene *scene, uint8_t *label)
{
    const uint32_t *size = scene->grid.size, how = below(4);
    const struct finish_box all = {{0}, {size[0] - 1, size[1] - 1, size[2] - 1}};
    const uint32_t p[3] = {below(size[0]), below(size[1]), below(size[2])};
    const struct finish_box at = {{p[0], p[1], p[2]}, {p[0], p[1], p[2]}};
    const struct finish_box box = finish_box_widen(&at, below(4), &all);
    for (uint32_t z = box.first[2]; z <= box.last[2]; z++)
        for (uint32_t y = box.first[1]; y <= box.last[1]; y++)
            for (uint32_t x = box.first[0]; x <= box.last[0]; x++) {
                const uint32_t cell = grid_cell(&scene->grid, x, y, z);
                if (how < 2)
                    label[cell] = (uint8_t)how;
                else if (below(3))
                    scene->cell[cell].flags ^= how == 2 ? CELL_SEED : CELL_OUTSIDE;
            }
    return box;
}

/* Values of a stored field at a checkpoint. */
static void values_at(int32_t *u, const struct finish_work *work, const struct relax_stored *stored,
                      uint32_t checkpoint)
{
    const uint32_t *size = work->scene->grid.size;
    struct relax_stored until = *stored;
    struct relax_field field = {0};
    until.checkpoints = checkpoint + 1;
    relax_field_read(&field, work, 1, &until);
    for (uint32_t row = 0; row < size[1] * size[2]; row++, u += size[0]) {
        const uint32_t y = row % size[1], z = row / size[1];
        const uint8_t *label = &work->label[grid_cell(&work->scene->grid, 0, y, z)];
        for (uint32_t x = 0; x < size[0]; x++)
            u[x] = label[x] == 1 ? RELAX_ONE : 0;
        for (struct relax_part part = {0}; relax_field_next(&field, y, z, &part);)
            memcpy(u + part.x, part.value, part.count * sizeof *u);
    }
}

/* Results of the step where fields are updated around edits. */
STORY(labels_around_an_edit_are_those_of_a_whole_step)
{
    size_t updated = 0;
    for (int round = 0; round < (int)check_scaled(24) && check_failures == 0; round++) {
        uint32_t size[3];
        seed = (uint64_t)round + 1700;
        OWNED(scene_drop) struct scene *scene = plate_of(size);
        const size_t cells = scene->grid.cells;
        const struct finish_box all = {{0}, {size[0] - 1, size[1] - 1, size[2] - 1}};
        const struct finish_list list = {
            1, {{FINISH_RELAX, FINISH_ALL_LABELS, 1 + below(20), 0, 1 + below(4)}}};
        struct relax_kept kept = {.cells = cells,
                                  .most = 1 << 28, /* enough for all checkpoints */
                                  .label = mem_pages(cells),
                                  .stays = mem_pages(cells),
                                  .result = mem_pages(cells),
                                  .stale = all,
                                  .sweeps = list.step[0].argument,
                                  .reach = list.step[0].reach};
        OWNED(mem_release) uint8_t *label = mem_new(cells);
        for (int of = 0; of < 256; of++)
            kept.changed[of] = finish_box_none();
        for (size_t i = 0; i < cells; i++)
            label[i] = scene->cell[i].label;
        for (int edits = 0; edits < 6; edits++) {
            if (edits % 3 == 2)
                stop(&list, scene, &kept);
            const struct relax_stored *before = kept.field[1];
            agree_again(&list, scene, &kept, round);
            updated += before && before == kept.field[1];
            change_plate(scene, label);
            for (size_t i = 0; i < cells; i++)
                scene->cell[i].label = label[i];
        }
        /* Labels vanish, whose fields were stored or had no room. */
        kept.most = round % 2 ? 0 : kept.most;
        for (uint8_t vanishes = 1; vanishes < 3; vanishes++) {
            for (size_t i = 0; i < cells; i++)
                if (scene->cell[i].label == vanishes)
                    scene->cell[i].label = i % size[0] < 9 && vanishes == 1 ? 2 : 0;
            agree_again(&list, scene, &kept, round);
        }
        relax_kept_release(&kept);
    }
    CHECK(updated > 20);
}

/* All checkpoints of a field that is updated, and sometimes stopped and continued, are those of a
 * field computed from its beginning. */
STORY(a_field_that_is_updated_is_the_one_that_would_be_made)
{
    static int32_t u[2][PLATE];
    size_t updated = 0, stopped = 0;
    for (int round = 0; round < (int)check_scaled(24) && check_failures == 0; round++) {
        uint32_t size[3];
        seed = (uint64_t)round + 700;
        const uint32_t reach = 1 + below(round % 2 ? 2 : FINISH_BAND_MOST), sweeps = 1 + below(30);
        OWNED(scene_drop) struct scene *scene = plate_of(size);
        const struct finish_box all = {{0}, {size[0] - 1, size[1] - 1, size[2] - 1}};
        const size_t cells = scene->grid.cells;
        struct finish_work work = {.scene = scene, .label = mem_pages(cells)};
        OWNED(relax_field_release) struct relax_field field = {0}, part = {0};
        struct relax_stored *stored = NULL;
        struct finish_box changed = finish_box_none(), stale = changed;
        for (size_t i = 0; i < cells; i++)
            work.label[i] = scene->cell[i].label;
        for (int edits = 0; edits < 6; edits++) {
            int looks = (int)below(60);
            struct watch watch = {.context = &looks, .poll = stop_after_looks, .step = 1};
            const bool stops = below(3) == 0;
            work.team = team_for(round);
            scene->watch = stops ? &watch : NULL;
            if (stored &&
                !relax_field_update(&part, &work, 1, stored, reach, sweeps, &changed, &stale)) {
                mem_pages_free(stored, stored->bytes);
                stored = NULL;
            }
            scene->watch = NULL;
            stopped += stored && stops && watch.stopped;
            work.team = NULL;
            CHECK(relax_field_begin(&field, &work, 1, &all, reach, sweeps, NULL) == OK);
            field.room = 1 << 28;
            relax_field_make(&field);
            struct relax_stored *made = relax_field_store(&field, 0);
            const bool is_updated = stored && finish_box_is_empty(&changed);
            for (uint32_t k = 0; is_updated && k < made->checkpoints; k++) {
                values_at(u[0], &work, stored, k);
                values_at(u[1], &work, made, k);
                CHECK_WITH(memcmp(u[0], u[1], sizeof u[0]) == 0, "round %d, edit %d", round, edits);
            }
            updated += is_updated;
            changed = stored ? changed : finish_box_none();
            if (stored)
                mem_pages_free(made, made->bytes);
            else
                stored = made;
            const struct finish_box now = change_plate(scene, work.label);
            finish_box_include(&changed, &now);
        }
        mem_pages_free(stored, stored->bytes);
        mem_pages_free(work.label, cells);
    }
    CHECK(updated > 30);
    CHECK(stopped > 10);
}

/* Halves are rounded to even, so the share of all other labels is exactly the rest. */
STORY(the_fields_of_an_object_and_of_all_else_are_complements)
{
    static struct volume v;
    for (int round = 0; round < (int)check_scaled(120); round++) {
        seed = (uint64_t)round + 5000;
        fill(&v);
        for (int i = 0; i < v.count; i++)
            v.label[i] = 1 + (v.label[i] & 1);
        OWNED(scene_drop) struct scene *scene = scene_of(&v);
        const struct finish_box all = {
            {0, 0, 0}, {scene->grid.size[0] - 1, scene->grid.size[1] - 1, scene->grid.size[2] - 1}};
        uint8_t *label = mem_pages(scene->grid.cells);
        static int32_t u[2][MOST];
        for (int i = 0; i < v.count; i++)
            label[cell_of(&v, &scene->grid, i)] = (uint8_t)v.label[i];
        for (uint8_t k = 0; k < 2; k++) {
            const struct finish_work work = {
                .scene = scene, .team = team_for(round + k), .label = label};
            OWNED(relax_field_release) struct relax_field field = {0};
            CHECK(relax_field_begin(&field, &work, (uint8_t)(k + 1), &all, FINISH_BAND_MOST, 25,
                                    NULL) == OK);
            relax_field_make(&field);
            for (int i = 0; i < v.count; i++)
                u[k][i] = v.label[i] == k + 1 ? RELAX_ONE : 0;
            for (int row = 0; row < v.size[1] * v.size[2]; row++)
                for (struct relax_part part = {0}; relax_field_next(
                         &field, (uint32_t)(row % v.size[1]), (uint32_t)(row / v.size[1]), &part);)
                    memcpy(&u[k][row * v.size[0] + (int)part.x], part.value,
                           part.count * sizeof part.value[0]);
        }
        bool sums = true;
        for (int i = 0; i < v.count; i++)
            sums = sums && u[0][i] + u[1][i] == RELAX_ONE;
        CHECK(sums);
        mem_pages_free(label, scene->grid.cells);
    }
}

/* ---- doubt ---- */

/* Sums over slices across x, y and z, of a label or all, of labels as they are in `v`. */
static void model_doubt(const struct volume *v, unsigned of, int sweeps, int64_t sum[3][LONG])
{
    static int64_t u[MOST];
    static int far[MOST];
    memset(sum, 0, 3 * LONG * sizeof sum[0][0]);
    for (int label = 1; label < LABELS; label++) {
        if (of != FINISH_ALL_LABELS && of != (unsigned)label)
            continue;
        model_field(v, label, sweeps, FINISH_BAND_MOST, u, far);
        for (int i = 0; i < v->count; i++) {
            const int64_t doubt = 4 * u[i] * (RELAX_ONE - u[i]) / RELAX_ONE;
            sum[0][i % v->size[0]] += doubt;
            sum[1][i / v->size[0] % v->size[1]] += doubt;
            sum[2][i / v->size[0] / v->size[1]] += doubt;
        }
    }
}

/* The worst slice, of a sum that is not 0 throughout. */
static bool is_worst(const struct volume *v, int64_t sum[3][LONG], unsigned axis, uint32_t at)
{
    bool is_first = true;
    for (unsigned a = 0; a < 3; a++)
        for (uint32_t i = 0; i < (uint32_t)v->size[a]; i++)
            is_first = is_first && (a < axis || (a == axis && i < at) ? sum[a][i] < sum[axis][at]
                                                                      : sum[a][i] <= sum[axis][at]);
    return is_first;
}

STORY(the_doubt_of_slices_is_that_of_a_plain_model)
{
    static struct volume v;
    static int64_t sum[3][LONG];
    int doubted = 0;
    for (int round = 0; round < (int)check_scaled(160); round++) {
        struct finish_list list = {0};
        OWNED(doubt_release) struct doubt doubt = {0};
        uint8_t *label;
        seed = (uint64_t)round + 9000;
        fill(&v);
        const unsigned of = below(2) ? FINISH_ALL_LABELS : 1 + below(LABELS - 1);
        const uint32_t sweeps = round % 3 ? 1 + below(20) : finish_table[FINISH_RELAX].usual;
        OWNED(scene_drop) struct scene *scene = scene_of(&v);
        if (below(2))
            list.step[list.count++] =
                (struct finish_step){FINISH_MAJORITY, FINISH_ALL_LABELS, 1, 0, 0};
        CHECK(finish_make(&label, &list, scene, NULL, NULL, NULL) == OK); /* the steps before it */
        for (int i = 0; i < v.count; i++)
            v.label[i] = label[cell_of(&v, &scene->grid, i)];
        if (round % 3) {
            list.step[list.count++] =
                (struct finish_step){FINISH_RELAX, FINISH_ALL_LABELS, sweeps, 0, 2};
            list.step[list.count++] = (struct finish_step){FINISH_RELAX, 1, 1 + below(9), 0, 1};
        }
        model_doubt(&v, of, (int)sweeps, sum);
        if (CHECK(doubt_find(&doubt, &list, scene, team_for(round), of, NULL) == OK)) {
            int64_t all = 0;
            bool same = true;
            for (int a = 0; a < 3; a++)
                for (int i = 0; i < v.size[a]; i++) {
                    same = same && (int64_t)doubt.slice[a][i] == sum[a][i];
                    all += a ? 0 : sum[a][i];
                }
            CHECK(same && (int64_t)doubt.all == all);
            unsigned axis;
            uint32_t at;
            const bool is_any = doubt_worst(&doubt, &axis, &at);
            CHECK(is_any == (all > 0) && (!is_any || is_worst(&v, sum, axis, at)));
            doubted += is_any;
        }
        mem_pages_free(label, scene->grid.cells);
    }
    CHECK(doubted > 40);
}

STORY(doubt_that_cannot_be_found_is_an_error)
{
    static struct volume v;
    const struct finish_list list = {1, {{FINISH_RELAX, FINISH_ALL_LABELS, 3, 0, 5}}};
    enum err err = ERR_MEMORY;
    struct doubt doubt;
    seed = 3;
    fill(&v);
    OWNED(scene_drop) struct scene *scene = scene_of(&v);
    for (size_t n = 0; err == ERR_MEMORY && n < 1000; n++) {
        allow_allocations(n);
        err = doubt_find(&doubt, &list, scene, NULL, FINISH_ALL_LABELS, NULL);
        mem_allows = NULL;
        CHECK((err == OK) == (doubt.slice[0] != NULL));
    }
    CHECK(err == OK && doubt.all > 0);
    doubt_release(&doubt);
    err = ERR_CANCELLED;
    for (int tries = 0; err == ERR_CANCELLED && tries < 100000; tries++) {
        int looks = tries;
        struct watch watch = {.context = &looks, .poll = stop_after_looks, .step = 1};
        scene->watch = &watch;
        err = doubt_find(&doubt, &list, scene, team_of[tries % 4], FINISH_ALL_LABELS, NULL);
        CHECK((err == OK) == (doubt.slice[0] != NULL));
    }
    CHECK(err == OK);
    doubt_release(&doubt);
    scene->watch = NULL;
}

STORY(a_stop_is_heard_wherever_it_comes_and_memory_that_runs_out_is_an_error)
{
    static struct relaxed expected;
    const struct finish_list list = {1, {{FINISH_RELAX, FINISH_ALL_LABELS, 3, 0, 5}}};
    for (int starves = 0; starves < 2; starves++) {
        seed = starves ? 4 : 3;
        fill(&expected.v);
        model(&expected.v, &list.step[0], expected.made);
        OWNED(scene_drop) struct scene *scene = scene_of(&expected.v);
        CHECK(starves ? starve_finish_everywhere(scene, &list, agree, &expected) > 7
                      : stop_finish_everywhere(scene, &list, agree, &expected) > 50);
    }
}
