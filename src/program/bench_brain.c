/*
 * `iftty bench`: the whole way on the scene ch2 of Debian's mricron-data, or on synth:geom where
 * that is not there: run from scratch, single edits with their picture, full pictures, and memory.
 * Medians; no time is compared with a limit.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/hash.h"
#include "base/json.h"
#include "base/mem.h"
#include "command/files.h"
#include "command/interpreter.h"
#include "image/volume.h"
#include "program/bench.h"
#include "program/programs.h"
#include "render/border.h"
#include "render/normal.h"
#include "session/session_inside.h"
#include "show/draw.h"

enum { SEEDS = 660, SCRATCH_RUNS = 5, EDITS = 60, FRAMES = 24, MOST_TIMES = 128 };

struct times {
    double ms[MOST_TIMES];
    size_t count;
};

static void add_since(struct times *times, uint64_t begin)
{
    times->ms[times->count++] = times_since(begin);
}

/* What is timed. The first three: the forest from nothing. */
enum what { ALONE, TOGETHER, CORNERS, PLANT, ELIMINATE, BORDER, SCENE, TIMED };

/* A row of the table, and what JSON calls it, which has every time once and in ms. */
static const struct row {
    enum what what;
    const char *name, *text;
    bool is_by_voxel; /* in ns */
} table_rows[] = {
    {ALONE, "scratch_ms", "forest from nothing, one thread", false},
    {ALONE, NULL, "    a voxel", true},
    {TOGETHER, "scratch_all_threads_ms", "    all threads, a voxel", true},
    {CORNERS, "scratch_26_ms", "    one thread, 26 neighbours, a voxel", true},
    {PLANT, "seed_ms", "a seed: update and incremental image", false},
    {ELIMINATE, "eliminator_ms", "an eliminator: update and incremental image", false},
    {BORDER, "border_projection_ms", "border projection, 512x512", false},
    {SCENE, "scene_projection_ms", "scene projection, 512x512", false},
};
enum { ROWS = sizeof table_rows / sizeof table_rows[0] };

struct figures {
    const char *scene;
    struct times times[TIMED];
    double bytes_per_voxel;
    size_t voxels, border_voxels;
    unsigned threads;
};

/* ---- the procedure ---- */

/* A deterministic generator: the n-th number of a sequence. */
static uint64_t draw(uint64_t *state)
{
    return hash_mix(++*state * UINT64_C(0x9e3779b97f4a7c15));
}

/* What a seed at this voxel would be labelled, or -1: by the atlas (1 brain, 2 cerebellum, which
 * has its regions from 91 on), else by the intensity alone. */
static int label_at(const struct session *session, const struct volume *atlas, size_t voxel,
                    uint32_t cell)
{
    uint16_t intensity = session_scene(session)->cell[cell].intensity;
    if (!atlas->intensity)
        return intensity > 60 ? 1 + (intensity > 150) : intensity < 20 ? 0 : -1;
    uint16_t region = atlas->intensity[voxel];
    if (region)
        return region >= 91 ? 2 : 1;
    return intensity < 20 ? 0 : -1;
}

static uint32_t draw_cell(const struct grid *grid, uint64_t *state, size_t *voxel)
{
    *voxel = (size_t)(draw(state) % grid->voxels);
    size_t rows = *voxel / grid->size[0];
    return grid_cell(grid, (uint32_t)(*voxel % grid->size[0]), (uint32_t)(rows % grid->size[1]),
                     (uint32_t)(rows / grid->size[1]));
}

static enum err plant_seeds(struct session *session, const struct volume *atlas,
                            struct fault *fault)
{
    uint64_t state = 1;
    enum err err = OK;
    for (int planted = 0; !err && planted < SEEDS;) {
        size_t voxel;
        uint32_t cell = draw_cell(&session_scene(session)->grid, &state, &voxel);
        int label = label_at(session, atlas, voxel, cell);
        if (label < 0)
            continue;
        err = session_plant(session, &cell, 1, (uint8_t)label, fault);
        planted++;
    }
    return err;
}

/* A voxel in the middle half of each axis. */
static uint32_t middle_cell(const struct grid *grid, uint64_t *state)
{
    uint32_t at[3];
    for (int a = 0; a < 3; a++)
        at[a] = grid->size[a] / 4 + (uint32_t)(draw(state) % (grid->size[a] / 2 + 1));
    return grid_cell(grid, at[0], at[1], at[2]);
}

/* The seeds that are planted, as edits; NULL when out of memory. */
static struct edit *list_seeds(const struct session *session)
{
    const size_t seeds = forest_seeds(session_forest(session)),
                 cells = session_scene(session)->grid.cells;
    struct edit *seed = mem_array(seeds, sizeof *seed);
    size_t count = 0;
    for (size_t c = 0; seed && c < cells && count < seeds; c++)
        if (session_scene(session)->cell[c].flags & CELL_SEED)
            seed[count++] = (struct edit){(uint32_t)c, session_scene(session)->cell[c].label, 0};
    return seed;
}

/* Erases every seed and plants them all at once, which is timed: the forest from nothing. */
static enum err time_growing(struct session *session, struct team *team, struct times *times,
                             struct fault *fault)
{
    const size_t seeds = forest_seeds(session_forest(session));
    struct edit *seed = list_seeds(session), *none = mem_array(seeds, sizeof *none);
    enum err err = seed && none ? forest_set_team(session->forest, team, fault)
                                : fault_memory(fault, "a benchmark");
    for (size_t i = 0; !err && i < seeds; i++)
        none[i] = (struct edit){seed[i].cell, EDIT_ERASE, 0};
    for (int i = 0; !err && i < SCRATCH_RUNS; i++) {
        err = forest_edit(session->forest, none, seeds, fault);
        const uint64_t begin = clock_ns();
        err = err ? err : forest_edit(session->forest, seed, seeds, fault);
        add_since(times, begin);
    }
    free(seed);
    free(none);
    return err;
}

static enum err set_adjacency(struct session *session, unsigned neighbours, struct fault *fault)
{
    forest_set_adjacency(session->forest, neighbours);
    return forest_rebuild(session->forest, fault);
}

static enum err time_scratch(struct session *session, struct figures *figures, struct fault *fault)
{
    struct times *times = figures->times;
    enum err err = set_adjacency(session, 26, fault);
    if (!err)
        err = time_growing(session, NULL, &times[CORNERS], fault);
    if (!err)
        err = set_adjacency(session, 6, fault);
    if (!err)
        err = time_growing(session, NULL, &times[ALONE], fault);
    if (!err && figures->threads > 1)
        err = time_growing(session, session_team(session), &times[TOGETHER], fault);
    return err ? err : forest_set_team(session->forest, session_team(session), fault);
}

/* Each edit as the user feels it: forest, border, digests, picture. Planted and taken away. */
static enum err time_edits(struct session *session, struct figures *figures, struct fault *fault)
{
    uint64_t state = 1000;
    enum err err = session_render(session, RENDER_BORDER, fault);
    for (int i = 0; !err && i < EDITS; i++) {
        uint32_t cell = middle_cell(&session_scene(session)->grid, &state);
        uint64_t begin = clock_ns();
        err = session_plant(session, &cell, 1, (uint8_t)(i % 3), fault);
        err = err ? err : session_run(session, fault);
        add_since(&figures->times[PLANT], begin);
        begin = clock_ns();
        err = err ? err : session_erase_trees(session, &cell, 1, fault);
        err = err ? err : session_run(session, fault);
        add_since(&figures->times[ELIMINATE], begin);
    }
    return err;
}

static enum err time_frames(struct session *session, struct figures *figures, struct fault *fault)
{
    struct view view = session_outlook(session)->view;
    enum err err = OK;
    for (int i = 0; !err && i < FRAMES; i++) {
        view.angle[0] = i * 15000;
        view.angle[1] = i * 7000;
        err = session_set_view(session, &view, fault);
        uint64_t begin = clock_ns();
        err = err ? err : session_render(session, RENDER_BORDER, fault);
        add_since(&figures->times[BORDER], begin);
        begin = clock_ns();
        err = err ? err : session_render(session, RENDER_SCENE, fault);
        add_since(&figures->times[SCENE], begin);
    }
    return err;
}

/* ---- what is printed ---- */

static void print_table(FILE *out, struct figures *f)
{
    fprintf(out, "%s: %zu voxels, %d seeds, %zu border voxels; %u threads\n\n", f->scene, f->voxels,
            SEEDS, f->border_voxels, f->threads);
    fprintf(out, "%-44s %9s %9s %9s\n", "", "median", "9 of 10", "most");
    for (int i = 0; i < ROWS; i++) {
        struct times *t = &f->times[table_rows[i].what];
        const double scale = table_rows[i].is_by_voxel ? 1e6 / (double)f->voxels : 1;
        if (t->count > 0)
            fprintf(out, "%-44s %9.2f %9.2f %9.2f  %s\n", table_rows[i].text,
                    times_median(t->ms, t->count) * scale,
                    times_quantile(t->ms, t->count, 0.9) * scale,
                    times_quantile(t->ms, t->count, 1) * scale,
                    table_rows[i].is_by_voxel ? "ns" : "ms");
    }
    fprintf(out, "%-44s %9.2f %9s %9s  bytes a voxel\n", "memory of the scene", f->bytes_per_voxel,
            "", "");
}

static void print_json(FILE *out, struct figures *f)
{
    struct buf text = {0};
    struct json json = {.out = &text};
    json_object(&json, NULL);
    json_text(&json, "scene", f->scene);
    json_count(&json, "voxels", f->voxels);
    json_count(&json, "seeds", SEEDS);
    for (int i = 0; i < ROWS; i++) {
        struct times *t = &f->times[table_rows[i].what];
        if (!table_rows[i].name)
            continue;
        json_object(&json, table_rows[i].name);
        json_fixed(&json, "median", times_median(t->ms, t->count), 3);
        json_fixed(&json, "most", times_quantile(t->ms, t->count, 1), 3);
        json_end(&json);
    }
    json_fixed(&json, "bytes_per_voxel", f->bytes_per_voxel, 2);
    json_end(&json);
    fputs(buf_text(&text), out);
    buf_release(&text);
}

/* ---- the whole ---- */

/* Opens that scene, or if `wish` is NULL, the usual one; `name` is what the figures call it. */
static enum err open_scene(struct interpreter *interp, const char *wish, const char **name,
                           struct fault *fault)
{
    struct buf path = {0};
    *name = wish ? wish : "ch2.nii.gz";
    enum err err = interpreter_find_scene(interp, *name, false, &path, fault);
    if (err && !wish) {
        *name = "synth:geom";
        err = interpreter_find_scene(interp, *name, false, &path, fault);
    }
    if (!err)
        err = session_open(interp->session, buf_text(&path), NULL, fault);
    buf_release(&path);
    return err;
}

/* By the atlas where it is here and fits the scene. */
static enum err plant_by_atlas(struct interpreter *interp, struct fault *fault)
{
    struct session *session = interp->session;
    struct volume atlas = {0};
    struct buf path = {0};
    if (interpreter_find_scene(interp, "aal.nii.gz", false, &path, NULL) == OK &&
        volume_read(&atlas, buf_text(&path), NULL, NULL, NULL) == OK &&
        memcmp(atlas.size, session_scene(session)->grid.size, sizeof atlas.size) != 0)
        volume_release(&atlas);
    const enum err err = plant_seeds(session, &atlas, fault);
    volume_release(&atlas);
    buf_release(&path);
    return err ? err : session_run(session, fault);
}

static enum err time_session(struct session *session, struct figures *figures, struct fault *fault)
{
    figures->threads = team_size(session_team(session));
    enum err err = time_scratch(session, figures, fault);
    if (err)
        return err;
    border_recount(&session->border);
    err = time_edits(session, figures, fault);
    if (!err)
        err = time_frames(session, figures, fault);
    figures->voxels = session_scene(session)->grid.voxels;
    figures->border_voxels = border_count(session_border(session));
    figures->bytes_per_voxel =
        (double)session_memory_parts(session).scene / (double)figures->voxels;
    return err;
}

enum err run_bench_brain(const struct options *o, struct fault *fault)
{
    struct interpreter interp;
    if (o->words && strcmp(o->word[0], "brain") != 0)
        return fault_set(fault, ERR_USAGE, "bench: expected brain or terminal, not %s", o->word[0]);
    struct figures *figures = mem_new(sizeof *figures);
    enum err err = interpreter_init(&interp, fault);
    if (!err && !figures)
        err = fault_memory(fault, "a benchmark");
    if (!err)
        err = open_scene(&interp, o->scene, &figures->scene, fault);
    if (!err)
        err = plant_by_atlas(&interp, fault);
    if (!err)
        err = time_session(interp.session, figures, fault);
    if (!err)
        (o->json ? print_json : print_table)(stdout, figures);
    free(figures);
    interpreter_release(&interp);
    return err;
}
