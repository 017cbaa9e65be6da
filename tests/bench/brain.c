/* SPDX-License-Identifier: MIT */
/* `bench brain`: the whole way on the scene ch2 of Debian's mricron-data, or on synth:geom where
 * that is not there: run from scratch, single edits with their picture, full pictures, and memory.
 *
 * `bench terminal`: what pictures cost on their way to a terminal, bytes and time. The
 * pictures are those at the end of examples/brain.iftty (of geom.iftty where the scene ch2 is not
 * here): its rendition of 512x512 pixels, a mosaic of 640x640, and patches of 40x40 that change in
 * the rendition, as an edit changes them: into what is seen a few pixels beside. The painter sends
 * them to a terminal with cells of 8x16 pixels, by every means that it knows.
 *
 * Medians; no time is compared with a limit. tests/bench/chafa.py has another program beside the
 * second, `make bench-keys` the time from a key to the picture. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/file.h"
#include "base/hash.h"
#include "command/execute.h"
#include "image/volume.h"
#include "program/programs.h"
#include "render/border.h"
#include "session/session.h"
#include "session/tally.h"
#include "show/draw.h"
#include "show/slicing.h"
#include "tests/bench/bench.h"
#include "tests/bench/times.h"
#include "tui/picture/painter.h"

/* ---- the whole way ---- */

enum { SEEDS = 660, SCRATCH_RUNS = 5, EDITS = 60, FRAMES = 24 };

/* Timed work. The first three: the forest from nothing. */
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

struct bench_way {
    const char *scene;
    struct times times[TIMED];
    double bytes_per_voxel;
    size_t voxels, border_voxels;
    unsigned threads;
};

/* A deterministic generator: the n-th number of a sequence. */
static uint64_t draw(uint64_t *state)
{
    return hash_mix(++*state * UINT64_C(0x9e3779b97f4a7c15));
}

/* Label of a seed at this voxel, or -1: by the atlas (1 brain, 2 cerebellum, which has regions from
 * 91 on), otherwise by the intensity alone. */
static int label_at(const struct session *session, const struct volume *atlas, size_t voxel,
                    uint32_t cell)
{
    const uint16_t intensity = session->scene->cell[cell].intensity;
    const uint16_t region = atlas->intensity ? atlas->intensity[voxel] : 0;
    if (region)
        return region >= 91 ? 2 : 1;
    if (!atlas->intensity && intensity > 60)
        return 1 + (intensity > 150);
    return intensity < 20 ? 0 : -1;
}

/* By the atlas where it is here and fits the scene. */
static void choose_seeds(struct edit seed[SEEDS], const struct interpreter *interp)
{
    const struct grid *grid = &interp->session->scene->grid;
    struct volume atlas = {0};
    OWNED(buf_release) struct buf path = {0};
    uint64_t state = 1;
    if (interpreter_find_scene(interp, 0, "aal.nii.gz", false, &path, NULL) == OK &&
        volume_read(&atlas, buf_text(&path), NULL, NULL, NULL) == OK &&
        memcmp(atlas.size, grid->size, sizeof atlas.size) != 0)
        volume_release(&atlas);
    for (int chosen = 0; chosen < SEEDS;) {
        const size_t voxel = (size_t)(draw(&state) % grid->voxels), row = voxel / grid->size[0];
        const uint32_t cell =
            grid_cell(grid, (uint32_t)(voxel % grid->size[0]), (uint32_t)(row % grid->size[1]),
                      (uint32_t)(row / grid->size[1]));
        const int label = label_at(interp->session, &atlas, voxel, cell);
        if (label >= 0)
            seed[chosen++] = (struct edit){cell, (int16_t)label, 0};
    }
    volume_release(&atlas);
}

/* The forest from nothing, by one of its own over the scene, which is left without seeds. */
static void time_growing(struct scene *scene, const struct edit seed[SEEDS], unsigned neighbours,
                         struct team *team, struct times *times)
{
    OWNED(forest_drop) struct forest *forest = NULL;
    struct edit none[SEEDS];
    for (int i = 0; i < SEEDS; i++)
        none[i] = (struct edit){seed[i].cell, EDIT_ERASE, 0};
    must(forest_new(&forest, scene, neighbours, &bench_fault));
    must(forest_set_team(forest, team, &bench_fault));
    for (int i = 0; i <= SCRATCH_RUNS; i++) {
        const uint64_t begin = clock_ns();
        must(forest_edit(forest, seed, SEEDS, &bench_fault));
        if (i > 0) /* the first run allocates memory */
            times_add(times, begin);
        must(forest_edit(forest, none, SEEDS, &bench_fault));
    }
}

/* Each edit as the user feels it: forest, border, digests, picture. Planted in the middle half of
 * each axis, and taken away. */
static void time_edits(struct session *session, struct times *times)
{
    const struct grid *grid = &session->scene->grid;
    uint64_t state = 1000;
    must(session_render(session, RENDER_BORDER, &bench_fault));
    for (int i = 0; i < EDITS; i++) {
        uint32_t at[3];
        for (int a = 0; a < 3; a++)
            at[a] = grid->size[a] / 4 + (uint32_t)(draw(&state) % (grid->size[a] / 2 + 1));
        const uint32_t cell = grid_cell(grid, at[0], at[1], at[2]);
        uint64_t begin = clock_ns();
        must(session_plant(session, &cell, 1, (uint8_t)(i % 3), 0, &bench_fault));
        must(session_render(session, RENDER_AS_KEPT, &bench_fault));
        begin = times_add(&times[PLANT], begin);
        must(session_erase_trees(session, &cell, 1, &bench_fault));
        must(session_render(session, RENDER_AS_KEPT, &bench_fault));
        times_add(&times[ELIMINATE], begin);
    }
}

static void time_session(struct interpreter *interp, struct bench_way *way)
{
    struct session *session = interp->session;
    struct scene *scene = session->scene;
    struct team *team = session->team;
    struct times *times = way->times;
    struct edit seed[SEEDS];
    way->threads = team_size(team);
    choose_seeds(seed, interp);
    time_growing(scene, seed, 26, NULL, &times[CORNERS]);
    time_growing(scene, seed, 6, NULL, &times[ALONE]);
    if (way->threads > 1)
        time_growing(scene, seed, 6, team, &times[TOGETHER]);
    for (int i = 0; i < SEEDS; i++)
        must(session_plant(session, &seed[i].cell, 1, seed[i].label, 0, &bench_fault));
    must(session_run(session, &bench_fault));
    time_edits(session, times);
    struct view view = session->now.outlook.view;
    for (int i = 0; i < FRAMES; i++) {
        view.angle[0] = i * 15000;
        view.angle[1] = i * 7000;
        must(session_set_view(session, &view, &bench_fault));
        uint64_t begin = clock_ns();
        must(session_render(session, RENDER_BORDER, &bench_fault));
        begin = times_add(&times[BORDER], begin);
        must(session_render(session, RENDER_SCENE, &bench_fault));
        times_add(&times[SCENE], begin);
    }
    way->voxels = scene->grid.voxels;
    way->border_voxels = border_count(&session->border);
    way->bytes_per_voxel = (double)session_memory_parts(session).scene / (double)way->voxels;
}

static void print_way(struct bench_way *way)
{
    printf("%s: %zu voxels, %d seeds, %zu border voxels; %u threads\n\n", way->scene, way->voxels,
           SEEDS, way->border_voxels, way->threads);
    times_print_title();
    for (int i = 0; i < ROWS; i++) {
        const struct row *row = &table_rows[i];
        if (way->times[row->what].count > 0)
            times_print(row->text, &way->times[row->what],
                        row->is_by_voxel ? 1e6 / (double)way->voxels : 1,
                        row->is_by_voxel ? "ns" : "ms");
    }
    printf("%-44s %9.2f %9s %9s  bytes a voxel\n", "memory of the scene", way->bytes_per_voxel, "",
           "");
}

static void write_way(struct bench_way *way)
{
    struct json *json = bench_json();
    json_object(json, NULL);
    json_text(json, "scene", way->scene);
    json_count(json, "voxels", way->voxels);
    json_count(json, "seeds", SEEDS);
    for (int i = 0; i < ROWS; i++) {
        if (!table_rows[i].name)
            continue;
        json_object(json, table_rows[i].name);
        times_write(json, &way->times[table_rows[i].what]);
        json_end(json);
    }
    json_fixed(json, "bytes_per_voxel", way->bytes_per_voxel, 2);
    json_end(json);
}

enum err run_brain(const struct options *o, struct fault *fault)
{
    OWNED(interpreter_release) struct interpreter interp = {0};
    OWNED(buf_release) struct buf path = {0};
    OWNED(mem_release) struct bench_way *way = must_have(sizeof *way);
    (void)fault;
    must(interpreter_init(&interp, &bench_fault));
    way->scene = o->scene ? o->scene : "ch2.nii.gz";
    enum err err = interpreter_find_scene(&interp, 0, way->scene, false, &path, &bench_fault);
    if (err && !o->scene)
        err = interpreter_find_scene(&interp, 0, way->scene = "synth:geom", false, &path,
                                     &bench_fault);
    must(err);
    must(session_open(interp.session, buf_text(&path), NULL, &bench_fault));
    time_session(&interp, way);
    (o->json ? write_way : print_way)(way);
    return OK;
}

/* ---- pictures on their way to a terminal ---- */

enum {
    RENDITION_SIDE = 512,
    MOSAIC_SIDE = 640,
    PATCH_SIDE = 40,
    CELL_WIDTH = 8,
    CELL_HEIGHT = 16,
    ROUNDS = 21,
    FRAMES_MOST = 24
};

enum { RENDITION, MOSAIC, PATCH, PICTURES };
static const struct words {
    const char *name, *text; /* in JSON and in the table */
} picture_words[PICTURES] = {{"rendition", "rendition, 512x512"},
                             {"mosaic", "mosaic, 640x640"},
                             {"patch", "40x40 pixels of the rendition change"}};

/* All protocols but the last, which shows nothing. Blocks are half a cell, in 24-bit colours. */
enum { MEANS_MOST = 8 };
#define MEANS ((int)graphics_auto.count - 1)

/* Medians; no bytes where nothing was measured. */
struct cost {
    double bytes, ms;
};

struct costs {
    const char *journal;
    struct cost of[PICTURES][MEANS_MOST];
};

struct frames {
    struct painter painter;
    struct buf out;
    double ms[FRAMES_MOST], bytes[FRAMES_MOST];
    size_t count;
};

static void begin_frames(struct frames *f, const struct graphics *by, uint32_t side)
{
    const struct terminal_facts facts = {.graphics = by,
                                         .colours = COLOURS_24BIT,
                                         .cell_width = CELL_WIDTH,
                                         .cell_height = CELL_HEIGHT,
                                         .image_side_most = 10000,
                                         .shape = BLOCK_HALF,
                                         .answers = true};
    *f = (struct frames){.count = 0};
    painter_place(&f->painter, &facts, 0, 0, side / CELL_WIDTH, side / CELL_HEIGHT);
}

static void time_frame(struct frames *f, const struct image_view *view)
{
    buf_clear(&f->out);
    const uint64_t begin = clock_ns();
    painter_show(&f->painter, view, &f->out);
    f->ms[f->count] = times_since(begin);
    f->bytes[f->count++] = (double)f->out.length;
    must(f->out.failed ? fault_memory(&bench_fault, "a picture for the terminal") : OK);
}

static struct cost end_frames(struct frames *f)
{
    const struct cost cost = {times_median(f->bytes, f->count), times_median(f->ms, f->count)};
    painter_release(&f->painter);
    buf_release(&f->out);
    return cost;
}

/* A whole picture, square; in blocks as large as the cells allow. */
static struct cost time_whole(const struct graphics *by, const struct image_view *view)
{
    struct frames f;
    struct image_view fitting = *view;
    OWNED(mem_release) uint8_t *small = NULL;
    begin_frames(&f, by, view->width);
    painter_size(&f.painter, &fitting.width, &fitting.height);
    if (fitting.width < view->width)
        fitting.rgba = small = image_view_shrink(view, fitting.width, fitting.height);
    must(fitting.rgba ? OK : fault_memory(&bench_fault, "a picture for the terminal"));
    for (int i = 0; i < ROUNDS; i++) {
        painter_forget(&f.painter);
        time_frame(&f, &fitting);
    }
    return end_frames(&f);
}

/* Nine tenths of the patch show an object, before and after. */
static bool is_full(const struct image_view *view, uint32_t left, uint32_t top)
{
    unsigned shown = 0;
    for (uint32_t y = 0; y < PATCH_SIDE; y++)
        for (uint32_t x = 0; x < PATCH_SIDE; x++)
            shown += image_view_colour(view, (size_t)(top + y) * view->width + left + x) != 0;
    return shown >= PATCH_SIDE * PATCH_SIDE * 9 / 10;
}

/* Patches all over the object; each is changed, to what is seen 5 pixels to the right of it and 3
 * below, and comes back. */
static struct cost time_patches(const struct graphics *by, const struct image_view *view)
{
    const size_t all = 4 * (size_t)view->width * view->height;
    OWNED(mem_release) uint8_t *rgba = must_have(all);
    struct image_view changed = *view;
    struct frames f;
    changed.rgba = rgba;
    begin_frames(&f, by, view->width);
    must(painter_show(&f.painter, view, &f.out)
             ? OK
             : fault_memory(&bench_fault, "a picture for the terminal"));
    for (uint32_t top = 11; top + PATCH_SIDE + 3 < view->height; top += 53)
        for (uint32_t left = 17; left + PATCH_SIDE + 5 < view->width; left += 67) {
            if (f.count + 2 > FRAMES_MOST || !is_full(view, left, top))
                continue;
            memcpy(rgba, view->rgba, all);
            for (size_t y = top; y < top + PATCH_SIDE; y++)
                memcpy(rgba + 4 * (y * view->width + left),
                       view->rgba + 4 * ((y + 3) * view->width + left + 5), 4 * PATCH_SIDE);
            time_frame(&f, &changed);
            time_frame(&f, view);
        }
    return end_frames(&f);
}

/* By all means; and patches of it where `patch` is given. */
static void time_picture(const struct image_view *view, struct cost *whole, struct cost *patch)
{
    for (int m = 0; m < MEANS; m++) {
        const struct graphics *by = graphics_auto.of[m];
        whole[m] = time_whole(by, view);
        /* an edit in blocks is a few cells: as coarse as that, there is no patch of 40x40 */
        if (patch && by->kind == GRAPHICS_PIXELS)
            patch[m] = time_patches(by, view);
    }
}

static void time_painter(struct session *session, struct costs *costs)
{
    uint32_t hue[256];
    OWNED(canvas_release) struct canvas canvas = {0};
    struct view shown = session->now.outlook.view;
    shown.width = shown.height = RENDITION_SIDE;
    must(session_set_view(session, &shown, &bench_fault));
    must(session_render(session, RENDER_BORDER, &bench_fault));
    must(session_count_labels(session, &bench_fault));
    const struct rendition *r = session_frame(session);
    struct image_view view = {.width = r->width,
                              .height = r->height,
                              .rgba = r->rgba,
                              .hue = hue,
                              .hues = shown_hues(hue, session)};
    time_picture(&view, costs->of[RENDITION], costs->of[PATCH]);
    struct slicing_panel panel = {.screen = {MOSAIC_SIDE, MOSAIC_SIDE, 8, 16, true, MOSAIC_AXIAL},
                                  .words = true};
    must(slicing_draw_panel(&canvas, session, &panel, &bench_fault));
    view.width = view.height = MOSAIC_SIDE;
    view.rgba = canvas.rgba;
    time_picture(&view, costs->of[MOSAIC], NULL);
}

static void print_costs(const struct costs *costs)
{
    printf("%s, what goes to the terminal\n    %-36s", costs->journal, "");
    for (int m = 0; m < MEANS; m++)
        printf(" %13s", graphics_auto.of[m]->title);
    printf("\n    %-36s", "");
    for (int m = 0; m < MEANS; m++)
        printf(" %7s %5s", "kB", "ms");
    putchar('\n');
    for (int i = 0; i < PICTURES; i++) {
        printf("    %-36s", picture_words[i].text);
        for (int m = 0; m < MEANS; m++) {
            const struct cost *cost = &costs->of[i][m];
            if (cost->bytes > 0)
                printf(" %7.2f %5.2f", cost->bytes / 1000, cost->ms);
            else
                printf(" %7s %5s", "", "");
        }
        putchar('\n');
    }
}

static void write_costs(const struct costs *costs)
{
    struct json *json = bench_json();
    json_object(json, NULL);
    json_text(json, "journal", costs->journal);
    for (int i = 0; i < PICTURES; i++) {
        json_object(json, picture_words[i].name);
        for (int m = 0; m < MEANS; m++) {
            const struct cost *cost = &costs->of[i][m];
            if (cost->bytes <= 0)
                continue;
            json_object(json, graphics_auto.of[m]->name);
            json_fixed(json, "bytes", cost->bytes, 0);
            json_fixed(json, "ms", cost->ms, 3);
            json_end(json);
        }
        json_end(json);
    }
    json_end(json);
}

enum err run_terminal(const struct options *o, struct fault *fault)
{
    OWNED(interpreter_release) struct interpreter interp = {0};
    OWNED(buf_release) struct buf journal = {0}, lines_of_it = {0};
    struct costs costs = {.journal = NULL};
    (void)fault;
    must(interpreter_init(&interp, &bench_fault));
    must(bench_find_example(&journal, &interp, &bench_fault));
    interp.is_read_only = true; /* the journal stays as it is */
    must(interpreter_resume_journal(&interp, buf_text(&journal), &lines_of_it, &bench_fault));
    time_painter(interp.session, &costs);
    costs.journal = file_name(buf_text(&journal));
    (o->json ? write_costs : print_costs)(&costs);
    return OK;
}
