/* SPDX-License-Identifier: MIT */
/* Parts of the benchmarks: seeds of the procedure, the comparison of experiments, reports. No time
 * is checked. */

#include "show/pictures.h"
#include "tests/bench/report.h"
#include "tests/bench/times.h"
#include "session/session.h"
#include "show/draw.h"
#include "tests/folder_main.h"

/* ---- the procedure ---- */

static int compare_cells(const void *a, const void *b)
{
    const struct edit *x = a, *y = b;
    return x->cell < y->cell ? -1 : x->cell > y->cell;
}

/* Intensities of geom for seeds of each label: its noise is 4 up or down. */
static const struct {
    uint16_t least, most;
} band[7] = {{8, 25}, {66, 74}, {116, 124}, {161, 169}, {201, 209}, {28, 34}, {231, 239}};

/* A session, and the seeds of a procedure in its scene. */
struct planted {
    struct session *session;
    struct procedure procedure;
    struct seeds seeds;
};

static void planted_release(struct planted *planted)
{
    seeds_release(&planted->seeds);
    procedure_release(&planted->procedure);
    session_free(planted->session);
}

static struct session *open_geom(struct planted *planted)
{
    CHECK(session_new(&planted->session, NULL) == OK);
    CHECK(session_open(planted->session, "synth:geom", NULL, NULL) == OK);
    return planted->session;
}

static struct seeds *find_seeds(struct planted *planted, const struct volume *atlas)
{
    CHECK(procedure_make(&planted->procedure, planted->session, atlas, NULL) == OK);
    CHECK(procedure_seeds(&planted->seeds, &planted->procedure, planted->session, NULL) == OK);
    return &planted->seeds;
}

STORY(seeds_are_inside_their_objects)
{
    OWNED(planted_release) struct planted planted = {0};
    const struct session *session = open_geom(&planted);
    const struct seeds seeds = *find_seeds(&planted, NULL);
    CHECK_INT(seeds.count, PROCEDURE_SEEDS);
    size_t of_label[PROCEDURE_STEPS][7] = {{0}}, wrong = 0;
    for (size_t i = 0; i < seeds.count; i++) {
        const uint16_t intensity = session->scene->cell[seeds.edit[i].cell].intensity;
        const int16_t label = seeds.edit[i].label;
        if (!CHECK(label >= 0 && label < 7))
            return;
        wrong += intensity < band[label].least || intensity > band[label].most;
        for (int s = 0; s < PROCEDURE_STEPS; s++)
            of_label[s][label] += i < procedure_count[s];
    }
    CHECK_INT(wrong, 0);
    for (int s = 0; s < PROCEDURE_STEPS; s++) /* each step has its share of each label */
        for (int label = 0; label < 7; label++) {
            size_t all = of_label[PROCEDURE_STEPS - 1][label];
            double share = (double)all * procedure_count[s] / PROCEDURE_SEEDS;
            CHECK((double)of_label[s][label] > share - 1.5 &&
                  (double)of_label[s][label] < share + 1.5);
        }
    qsort(seeds.edit, seeds.count, sizeof *seeds.edit, compare_cells);
    for (size_t i = 1; i < seeds.count; i++)
        CHECK(seeds.edit[i].cell > seeds.edit[i - 1].cell);
}

STORY(an_interpolated_scene_has_the_same_seeds)
{
    OWNED(planted_release) struct planted planted = {0};
    OWNED(seeds_release) struct seeds twice = {0};
    struct session *session = open_geom(&planted);
    const struct seeds seeds = *find_seeds(&planted, NULL);
    const struct grid before = session->scene->grid;
    CHECK(session_interpolate(session, 5, NULL) == OK);
    CHECK(procedure_seeds(&twice, &planted.procedure, session, NULL) == OK);
    for (size_t i = 0; i < seeds.count; i++) {
        struct place p = grid_place(&before, seeds.edit[i].cell);
        CHECK_INT(twice.edit[i].cell, grid_cell(&session->scene->grid, 2 * p.x, p.y, 2 * p.z));
        CHECK_INT(twice.edit[i].label, seeds.edit[i].label);
    }
}

/* Columns of 20 by 17 through the bright parts of geom: regions 1..116 of an artificial atlas. */
static uint16_t *made_atlas(const struct scene *scene)
{
    const uint32_t *sides = scene->grid.size;
    uint16_t *region = malloc(scene->grid.voxels * sizeof *region), *at = region;
    for (uint32_t z = 0; region && z < sides[2]; z++)
        for (uint32_t y = 0; y < sides[1]; y++)
            for (uint32_t x = 0; x < sides[0]; x++) {
                uint32_t column = x / 20 * 12 + y / 17;
                bool bright = scene->cell[grid_cell(&scene->grid, x, y, z)].intensity >= 60;
                *at++ = (uint16_t)(bright ? 1 + (column < 116 ? column : 115) : 0);
            }
    return region;
}

STORY(an_atlas_says_which_seeds_are_brain)
{
    OWNED(planted_release) struct planted planted = {0};
    const struct session *session = open_geom(&planted);
    const struct grid *grid = &session->scene->grid;
    const struct volume atlas = {.size = {200, 200, 100}, .intensity = made_atlas(session->scene)};
    const struct seeds seeds = *find_seeds(&planted, &atlas);
    size_t of_label[3] = {0}, wrong = 0;
    for (size_t i = 0; i < seeds.count; i++) {
        const uint32_t cell = seeds.edit[i].cell, voxel = grid_voxel(grid, cell);
        const uint16_t region = atlas.intensity[voxel];
        const int16_t label = seeds.edit[i].label;
        wrong += label != (region == 0 ? 0 : region <= 90 ? 1 : 2);
        wrong += region == 0 && session->scene->cell[cell].intensity >= 20;
        wrong += atlas.intensity[voxel - 1] != region || atlas.intensity[voxel + 200] != region;
        of_label[label]++;
    }
    CHECK_INT(wrong, 0);
    CHECK_INT(of_label[0], 855);
    CHECK_INT(of_label[1], 1000);
    CHECK_INT(of_label[2], 250);
    free(atlas.intensity);
}

STORY(a_map_on_another_grid_or_without_regions_is_refused)
{
    static uint16_t nothing[200 * 200 * 100];
    OWNED(planted_release) struct planted planted = {0};
    const struct session *session = open_geom(&planted);
    struct fault fault = {0};
    struct volume atlas = {.size = {200, 200, 99}, .intensity = nothing};
    CHECK(procedure_make(&planted.procedure, session, &atlas, &fault) == ERR_INPUT);
    CHECK_HAS(fault.text, "the map has 200x200x99 voxels");
    atlas.size[2] = 100;
    CHECK(procedure_make(&planted.procedure, session, &atlas, &fault) == ERR_INPUT);
    CHECK_HAS(fault.text, "the map has no voxel of regions 1-90");
}

/* ---- a trial on a small scene ---- */

static const uint32_t side = 32;

static void scene_row(void *context, uint32_t y, uint32_t z, void *values)
{
    uint8_t *at = values;
    (void)context;
    for (uint32_t x = 0; x < side; x++)
        *at++ = (uint8_t)(x + y + z + (x > 9 ? 40 : 0) + (y > 12 && z < 20 ? 70 : 0));
}

/* Seeds of the first step are spread over one half of the scene, the others are in a corner of the
 * other half, so that they change little. Four labels. */
static struct session *begin(struct planted *planted)
{
    CHECK(session_new(&planted->session, NULL) == OK);
    struct session *session = planted->session;
    struct seeds *seeds = &planted->seeds;
    char path[PATH_MAX];
    const double spacing_mm[3] = {1, 1, 1};
    struct geometry geometry = {.slope = 1, .spacing_nm = {1000000, 1000000, 1000000}};
    snprintf(path, sizeof path, "%s/small.nii", folder);
    geometry_place_plain(&geometry, spacing_mm);
    CHECK(volume_write(path, FILE_REPLACE,
                       &(struct volume_map){(uint32_t[]){side, side, side}, &geometry, VOXEL_UINT8,
                                            "test", scene_row, NULL, NULL, NULL, NULL},
                       NULL, NULL) == OK);
    CHECK(session_open(session, path, NULL, NULL) == OK);
    *seeds = (struct seeds){.edit = malloc(PROCEDURE_SEEDS * sizeof(struct edit))};
    for (uint32_t i = 0; seeds->edit && i < PROCEDURE_SEEDS; i++) {
        const uint32_t early = i * 7919 % (16 * 32 * 32), late = i * 5 % (12 * 12 * 12);
        const uint32_t cell =
            i < procedure_count[0]
                ? grid_cell(&session->scene->grid, 16 + early % 16, early / 16 % 32, early / 512)
                : grid_cell(&session->scene->grid, late % 12, late / 12 % 12, late / 144);
        seeds->edit[seeds->count++] = (struct edit){cell, (int16_t)(i % 4), 0};
    }
    return session;
}

STORY(all_experiments_agree_in_every_step)
{
    OWNED(planted_release) struct planted planted = {0};
    struct session *session = begin(&planted);
    struct fault fault = {0};
    struct trial trial = {.name = "small"};
    if (!CHECK(trial_run(&trial, session, &planted.seeds, PROCEDURE_STEPS, 2, NULL, &fault) == OK))
        printf("#   %s\n", fault.text);
    CHECK_INT(trial.compared, PROCEDURE_STEPS * (2 * EXPERIMENTS - 1));
    CHECK_INT(trial.steps, PROCEDURE_STEPS);
    CHECK_INT(forest_seeds(session->forest), PROCEDURE_SEEDS);
    const struct trial_step *last = &trial.step[PROCEDURE_STEPS - 1];
    CHECK_INT(last->seeds, PROCEDURE_SEEDS);
    CHECK(last->keys == forest_digest(session->forest));
    CHECK(last->labels == forest_label_digest(session->forest));
    CHECK_INT(last->border_voxels, border_count(&session->border));
    CHECK(session_render(session, RENDER_RAY, NULL) == OK);
    CHECK(rendition_digest(&session->pictures->rendition) == last->picture);
    for (unsigned s = 0; s < trial.steps; s++)
        CHECK_INT(trial.step[s].cost[IFT_SP].served, trial.voxels);
    unsigned repaired = 0;
    for (unsigned s = 1; s < trial.steps; s++)
        repaired += !trial.step[s].cost[BDIFT_BP].is_whole;
    CHECK(repaired >= 2); /* in other steps border and picture are recomputed */
}

/* A watcher that changes the compared data. */
static bool spoil_colours(void *context, unsigned step, unsigned round)
{
    struct session *session = context;
    for (int label = 1; step == 1 && round == 0 && label < 256; label++)
        session->now.kept.palette.rgb[label][1] ^= 0x40;
    return true;
}
static bool spoil_weights(void *context, unsigned step, unsigned round)
{
    struct session *session = context;
    struct span row = grid_row(&session->scene->grid, side / 2, side / 2);
    for (uint32_t c = row.first; step == 1 && round == 0 && c < row.end; c++)
        session->scene->cell[c].weight ^= 0x155;
    return true;
}
static bool spoil_view(void *context, unsigned step, unsigned round)
{
    struct session *session = context;
    struct view view = session->now.outlook.view;
    view.angle[0] += 90000;
    if (step == 1 && round == 0)
        CHECK(session_set_view(session, &view, NULL) == OK);
    return true;
}
static bool stop(void *context, unsigned step, unsigned round)
{
    (void)context;
    return step == 0 || round == 0;
}

STORY(a_difference_ends_the_trial_and_is_named)
{
    static const struct {
        bool (*spoil)(void *context, unsigned step, unsigned round);
        const char *words;
    } row[] = {{spoil_colours, "has colour"}, {spoil_weights, "digest"}, {spoil_view, "pixel"}};
    for (size_t i = 0; i < sizeof row / sizeof row[0]; i++) {
        OWNED(planted_release) struct planted planted = {0};
        struct session *session = begin(&planted);
        struct fault fault = {0};
        struct trial trial = {.name = "small"};
        const struct trial_watch watch = {row[i].spoil, session};
        CHECK(trial_run(&trial, session, &planted.seeds, 3, 2, &watch, &fault) == ERR_CHECK);
        CHECK_HAS(fault.text, "small, step 2, (");
        CHECK_HAS(fault.text, " differs: ");
        CHECK_HAS(fault.text, row[i].words);
    }
}

STORY(a_watcher_can_end_the_trial)
{
    OWNED(planted_release) struct planted planted = {0};
    struct trial trial = {.name = "small"};
    const struct trial_watch watch = {stop, NULL};
    CHECK(trial_run(&trial, begin(&planted), &planted.seeds, 3, 2, &watch, NULL) == ERR_CANCELLED);
    CHECK_INT(trial.compared, 2 * (2 * EXPERIMENTS - 1));
}

STORY(the_first_pixel_that_differs_is_named)
{
    const struct grid *grid;
    OWNED(rendition_release) struct rendition a = {0}, b = {0};
    struct fault fault = {0};
    OWNED(scene_drop) struct scene *scene;
    CHECK(scene_new(&scene, (uint32_t[]){3, 3, 3}, NULL, NULL, NULL) == OK);
    grid = &scene->grid;
    CHECK(rendition_init(&a, 9, 7, NULL) == OK && rendition_init(&b, 9, 7, NULL) == OK);
    rendition_clear(&a);
    rendition_clear(&b);
    memset(a.label, 0, 63), memset(b.label, 0, 63);
    memset(a.rgba, 0, 63 * 4), memset(b.rgba, 0, 63 * 4);
    CHECK(trial_same_picture(&a, &b, grid, &fault));
    a.rgba[4 * 40 + 2] = 255;
    CHECK(!trial_same_picture(&a, &b, grid, &fault));
    CHECK_TEXT(fault.text, "pixel 4,4 has colour 0000ff00, not 00000000");
    b.depth[39] = 12;
    CHECK(!trial_same_picture(&a, &b, grid, &fault));
    CHECK_TEXT(fault.text, "pixel 3,4 has depth 9223372036854775807, not 12");
    b.cell[38] = grid_cell(grid, 0, 1, 2);
    b.label[38] = 3;
    CHECK(!trial_same_picture(&a, &b, grid, &fault));
    CHECK_TEXT(fault.text, "pixel 2,4 shows nothing of label 0, not voxel 0,1,2 of label 3");
}

/* ---- figures ---- */

/* An artificial trial: segmentation 10 e + s, border 2, rendition 4 ms. */
static struct trial made_trial(const char *name)
{
    struct trial trial = {.size = {10, 10, 10}, .voxels = 1000, .steps = 3, .rounds = 1};
    snprintf(trial.name, sizeof trial.name, "%s", name);
    for (unsigned s = 0; s < trial.steps; s++)
        for (unsigned e = 0; e < EXPERIMENTS; e++)
            trial.step[s].cost[e] =
                (struct trial_cost){{10 * (e + 1) + s, e < BDIFT_BP ? 0 : 2, 4}, 100, false};
    return trial;
}

STORY(means_leave_the_first_step_out)
{
    const struct trial trial = made_trial("x");
    CHECK(trial_mean(&trial, IFT_SP, SEGMENTATION) == 11.5);
    CHECK(trial_mean(&trial, BDIFT_BP, BORDER) == 2 && trial_mean_total(&trial, BDIFT_BP) == 37.5);
    CHECK(trial_total(&trial.step[0], DIFT_II) == 46);
    CHECK(trial_ns_per_voxel(&trial.step[0], IFT_SP) == 100000);
    CHECK(report_ratio(&trial, RATIO_IFT) == 11.5 / 21.5);
    CHECK(report_ratio(&trial, RATIO_BDIFT) == 33.5 / 21.5);
    CHECK(report_ratio(&trial, RATIO_KEEP) == 33.5 / 53.5 && report_ratio(&trial, RATIO_II) == 1);
    CHECK(report_ratio(&trial, RATIO_BORDER_SHARE) == 2 / 33.5);
}

STORY(the_summary_is_readable_in_100_columns)
{
    const struct trial trial[2] = {made_trial("brain"), made_trial("geom222")};
    OWNED(mem_release) char *text = NULL;
    size_t length = 0;
    FILE *out = open_memstream(&text, &length);
    if (!CHECK(out != NULL))
        return;
    report_summary(out, trial, 2);
    fclose(out);
    CHECK_HAS(text, "geom222");
    for (const char *at = text; *at;) {
        size_t n = strcspn(at, "\n");
        CHECK(n <= 100);
        at += n + (at[n] == '\n');
    }
}

/* ---- times ---- */

STORY(medians_and_quantiles_of_times_in_any_order)
{
    double odd[] = {5, 1, 9, 3, 7}, even[] = {4, 1, 3, 10}, one[] = {6}, none[1] = {2};
    CHECK(times_median(odd, 5) == 5 && times_quantile(odd, 5, 0) == 1);
    CHECK(times_quantile(odd, 5, 0.9) == 9 && times_median(even, 4) == 3.5);
    CHECK(times_quantile(even, 4, 0.5) == 4 && times_quantile(even, 4, 1) == 10);
    CHECK(times_median(one, 1) == 6 && times_quantile(one, 1, 0.9) == 6);
    CHECK(times_median(none, 0) == 0 && times_quantile(none, 0, 1) == 0);
    CHECK(times_between(1000000, 3500000) == 2.5);
}
