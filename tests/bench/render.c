/* SPDX-License-Identifier: MIT */
/* Time of pictures: whole frames, parts of them, edits, and VTK. */
#include "show/pictures.h"
#include "tests/bench/bench.h"

#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/file.h"
#include "tests/bench/times.h"
#include "command/execute.h"
#include "engine/label_stats.h"
#include "render/border.h"
#include "render/incremental.h"
#include "render/shade.h"
#include "render/projection.h"
#include "show/export_map.h"
#include "session/session.h"
#include "show/draw.h"
#include "show/slicing.h"
#include "session/session_inside.h"

enum {
    SIDE = 512,
    FRAMES = 60, /* a turn in steps of 6 degrees, seen a little from above */
    EDITS = 24,  /* at most; with their erasing twice as many incremental images */
    TRIES = 600,
    LEAST_LABELS = 1500, /* that an edit changes */
    MOST_LABELS = 2500,
    BALL_MOST = 9,
    ROWS_MOST = 32,
};

struct row {
    char what[128];
    struct times times;
    double only_ms; /* a median that was measured elsewhere, without times */
};

struct table {
    struct row row[ROWS_MOST];
    int rows;
    size_t pixels[2]; /* that show an object, at zoom 1 and 2 */
    double labels;    /* changed by the edits that count, altogether */
    size_t edits;     /* that count, each planted and each erased one */
};

static struct times *add_row(struct table *table, const char *what)
{
    struct row *row = &table->row[table->rows < ROWS_MOST - 1 ? table->rows++ : ROWS_MOST - 1];
    snprintf(row->what, sizeof row->what, "%s", what);
    return &row->times;
}

/* ---- frames ---- */

static void colour(struct session *session)
{
    const struct state *now = &session->now;
    struct pictures *p = session->pictures;
    must(shade(&p->rendition, &p->camera, &p->mesh, &now->kept.palette, &now->outlook.look,
               &p->shader, &bench_fault));
}

static void turn_to(struct session *session, int frame, uint32_t zoom)
{
    struct view view = session->now.outlook.view;
    view.angle[0] = frame * (VIEW_TURN / FRAMES);
    view.angle[1] = 15000;
    view.width = view.height = SIDE;
    view.zoom = zoom;
    must(session_set_view(session, &view, &bench_fault));
    if (!session_frame(session)->depth) /* so that no frame makes room for the first time */
        must(session_render(session, RENDER_BORDER, &bench_fault));
}

static size_t pixels_seen(const struct rendition *r)
{
    size_t seen = 0;
    for (size_t i = 0; i < (size_t)r->width * r->height; i++)
        seen += r->cell[i] != CELL_NONE;
    return seen;
}

/* Whole turns: a frame and its two parts; and again with nothing kept of the frames before. */
static void time_turn(struct session *session, struct table *table, uint32_t zoom)
{
    const int which = zoom != VIEW_ZOOM_ONE;
    struct times *frame_ms = add_row(table, which ? "border projection and shading, zoom 2"
                                                  : "border projection and shading, zoom 1");
    struct times *projecting = add_row(table, "    border projection");
    struct times *shading = add_row(table, "    shading");
    struct times *afresh = add_row(table, "    both, nothing kept of other frames");
    struct pictures *p = session->pictures;
    turn_to(session, FRAMES - 1, zoom);
    for (int frame = 0; frame < FRAMES; frame++) {
        turn_to(session, frame, zoom);
        const uint64_t begin = clock_ns();
        project_border(&p->rendition, &p->camera, &p->mesh);
        const uint64_t between = times_add(projecting, begin);
        colour(session);
        times_add(shading, between);
        times_add(frame_ms, begin);
        table->pixels[which] += pixels_seen(&p->rendition) / FRAMES;
    }
    for (int frame = 0; frame < FRAMES; frame += 4) {
        turn_to(session, frame, zoom);
        shader_release(&p->shader);
        const uint64_t begin = clock_ns();
        must(session_render(session, RENDER_BORDER, &bench_fault));
        times_add(afresh, begin);
    }
}

static void go_to_look(struct session *session, const struct look *look)
{
    struct state next = session->now;
    next.outlook.look = *look;
    must(session_go(session, &next, NULL, 0, &bench_fault));
}

/* The same with one look, at zoom 1. */
static void time_look(struct session *session, struct table *table, const char *what,
                      const struct look *look)
{
    const struct look former = session->now.outlook.look;
    struct times *times = add_row(table, what);
    go_to_look(session, look);
    turn_to(session, FRAMES - 1, VIEW_ZOOM_ONE);
    for (int frame = 0; frame < FRAMES; frame += 3) {
        turn_to(session, frame, VIEW_ZOOM_ONE);
        const uint64_t begin = clock_ns();
        must(session_render(session, RENDER_BORDER, &bench_fault));
        times_add(times, begin);
    }
    go_to_look(session, &former);
}

/* ---- edits ---- */

void bench_ball_make(struct bench_ball *ball, const struct scene *scene, uint32_t cell, int radius)
{
    const struct place p = grid_place(&scene->grid, cell);
    ball->count = 0;
    for (int z = -radius; z <= radius; z++)
        for (int y = -radius; y <= radius; y++)
            for (int x = -radius; x <= radius; x++) {
                const int64_t at[3] = {(int64_t)p.x + x, (int64_t)p.y + y, (int64_t)p.z + z};
                if (x * x + y * y + z * z > radius * radius ||
                    !grid_contains(&scene->grid, at[0], at[1], at[2]))
                    continue;
                const uint32_t c =
                    grid_cell(&scene->grid, (uint32_t)at[0], (uint32_t)at[1], (uint32_t)at[2]);
                if (scene->cell[c].flags & CELL_SEED)
                    continue; /* erasing the ball would remove a seed of the procedure */
                ball->seed[ball->count] = (struct edit){c, 0, 0};
                ball->undo[ball->count++] = (struct edit){c, EDIT_ERASE, 0};
            }
}

size_t bench_next_pixel(const struct rendition *frame, size_t pixel)
{
    do
        pixel = (pixel + 12347) % ((size_t)frame->width * frame->height);
    while (frame->cell[pixel] == CELL_NONE);
    return pixel;
}

static bool is_wanted(const struct changes *changes)
{
    return !changes->everything && changes->count >= LEAST_LABELS && changes->count <= MOST_LABELS;
}

/* One edit and its incremental image: the time, and the number of changed labels; 0 if the edit is
 * not of the wanted size. */
struct followed {
    double ms;
    size_t labels;
};

static void follow_edit(struct session *session, const struct edit *edit, size_t count,
                        struct followed *out)
{
    must(forest_edit(session->forest, edit, count, &bench_fault));
    const struct changes changes = forest_changes(session->forest);
    border_update(&session->border, &changes);
    out->labels = is_wanted(&changes) ? changes.count : 0;
    struct pictures *p = session->pictures;
    const uint64_t begin = clock_ns();
    mesh_note(&p->mesh, &session->border, &changes);
    must(incremental_image(&p->rendition, &p->camera, &p->mesh, &session->border,
                           &session->now.outlook.look, &changes, session->team, &bench_fault));
    colour(session);
    out->ms = times_since(begin);
}

/* An edit and its erasing count where both are of the wanted size: else they are not the same. */
static void count_edits(struct table *table, struct times *times, const struct followed way[2])
{
    if (way[0].labels == 0 || way[1].labels == 0)
        return;
    for (int i = 0; i < 2; i++) {
        times->ms[times->count++] = way[i].ms;
        table->labels += (double)way[i].labels;
        table->edits++;
    }
}

/* A ball of background at the next place that is seen, of the i-th radius. */
static const struct bench_ball *next_ball(struct session *session, size_t *pixel, int i)
{
    static struct bench_ball ball;
    *pixel = bench_next_pixel(&session->pictures->rendition, *pixel);
    bench_ball_make(&ball, session->scene, session->pictures->rendition.cell[*pixel],
                    4 + i % (BALL_MOST - 3));
    return &ball;
}

/* Balls of background bite into what is seen, and are erased again. */
static void time_edits(struct session *session, struct table *table, uint32_t zoom)
{
    struct times *times =
        add_row(table, zoom == VIEW_ZOOM_ONE ? "incremental image and shading, zoom 1"
                                             : "incremental image and shading, zoom 2");
    size_t pixel = 0;
    turn_to(session, 5, zoom);
    must(session_render(session, RENDER_BORDER, &bench_fault));
    for (int i = 0; i < TRIES && times->count < 2 * EDITS; i++) {
        struct followed way[2];
        const struct bench_ball *ball = next_ball(session, &pixel, i);
        follow_edit(session, ball->seed, ball->count, &way[0]);
        follow_edit(session, ball->undo, ball->count, &way[1]);
        count_edits(table, times, way);
    }
}

/* ---- slices ---- */

/* The rendition is up to date; the cross-hair wanders through the scene. */
static void time_slices(struct session *session, struct table *table, const char *what,
                        enum slice_kind kind)
{
    struct times *times = add_row(table, what);
    const uint32_t *size = session->scene->grid.size;
    turn_to(session, 5, VIEW_ZOOM_ONE);
    must(session_render(session, RENDER_BORDER, &bench_fault));
    for (uint32_t i = 0; i < FRAMES; i++) {
        OWNED(canvas_release) struct canvas canvas = {0};
        for (int a = 0; a < 3; a++)
            session->now.outlook.slices.cross[a] = size[a] * (FRAMES + 2 * i) / (4 * FRAMES);
        const uint64_t begin = clock_ns();
        must(slicing_draw(&canvas, session, kind, NULL, false, &bench_fault));
        times_add(times, begin);
    }
}

/* ---- finished labels ---- */

enum { ROUNDS = 9 };

/* Labels taken out of the forest, one step, and the digest, by all threads. */
static void time_finish(struct session *session, struct table *table, const char *what,
                        enum finish_kind kind, uint32_t argument)
{
    struct times *times = add_row(table, what);
    struct state next = session->now;
    struct labels labels;
    next.kept.finish = (struct finish_list){
        .count = 1, .step = {{.kind = kind, .label = FINISH_ALL_LABELS, .argument = argument}}};
    must(session_go(session, &next, NULL, 0, &bench_fault));
    for (int i = 0; i < ROUNDS; i++) {
        finished_release(&session->inside->finished);
        const uint64_t begin = clock_ns();
        must(session_labels(session, true, &labels, &bench_fault));
        times_add(times, begin);
    }
}

/* ---- what is known of labels ---- */

/* All statistics of `stats` for each label, by all threads: recounted, and without a change. */
static void time_stats(struct session *session, struct table *table)
{
    static struct label_stats stats[256];
    struct times *recounted = add_row(table, "stats of all labels");
    struct times *unchanged = add_row(table, "    asked for again: components and holes");
    struct times *counts = add_row(table, "    counts of intensities and planes, anew");
    struct label_sums sums;
    const struct labels labels = labels_of_forest(session->scene);
    for (int i = 0; i < ROUNDS; i++) {
        OWNED(label_measures_release) struct label_measures measures = {0};
        uint64_t begin = clock_ns();
        must(label_stats_find(stats, &measures, &labels, session->team, &bench_fault));
        begin = times_add(recounted, begin);
        must(label_stats_find(stats, &measures, &labels, session->team, &bench_fault));
        times_add(unchanged, begin);
        label_measures_forget(&measures);
        begin = clock_ns();
        must(label_measures_sum(&measures, &labels, 1, session->team, &sums, &bench_fault));
        times_add(counts, begin);
    }
}

/* An edit of some 2000 labels; the time to note it, and to update the statistics. */
static void time_measures(struct session *session, struct label_measures *measures,
                          const struct edit *edit, size_t count, struct times *times[4])
{
    const struct labels labels = labels_of_forest(session->scene);
    struct label_sums sums;
    const uint64_t begin = clock_ns();
    must(forest_edit(session->forest, edit, count, &bench_fault));
    const struct changes changes = forest_changes(session->forest);
    const uint64_t edited = clock_ns();
    label_measures_follow(measures, &changes);
    const uint64_t noted = clock_ns();
    must(label_measures_sum(measures, &labels, 1, session->team, &sums, &bench_fault));
    const uint64_t counted = clock_ns();
    must(label_measures_refresh_pairs(measures, &labels, session->team, &bench_fault));
    const uint64_t of[] = {begin, edited, noted, counted, clock_ns()};
    border_update(&session->border, &changes);
    for (int i = 0; i < 4 && is_wanted(&changes); i++)
        times[i]->ms[times[i]->count++] = times_between(of[i], of[i + 1]);
}

/* The same balls. */
static void time_following(struct session *session, struct table *table)
{
    struct times *times[4] = {add_row(table, "an edit"), add_row(table, "    noted for statistics"),
                              add_row(table, "    counts of intensities and planes follow"),
                              add_row(table, "    pairs, of which surfaces are made, follow")};
    static struct label_stats stats[256];
    const struct labels labels = labels_of_forest(session->scene);
    OWNED(label_measures_release) struct label_measures measures = {0};
    size_t pixel = 0;
    must(session_render(session, RENDER_BORDER, &bench_fault));
    must(label_stats_find(stats, &measures, &labels, session->team, &bench_fault));
    for (int i = 0; i < TRIES && times[0]->count < 2 * EDITS; i++) {
        const struct bench_ball *ball = next_ball(session, &pixel, i);
        time_measures(session, &measures, ball->seed, ball->count, times);
        time_measures(session, &measures, ball->undo, ball->count, times);
    }
}

/* ---- VTK ---- */

/* Read {"what": "rotation", "median_ms": 93.1, ...}; the first line has versions. */
static void read_line(struct bench_vtk *out, const char *line)
{
    const char *ms = strstr(line, "\"median_ms\": ");
    sscanf(line, "{\"what\": \"versions\", \"vtk\": \"%23[^\"]\"", out->version);
    if (out->rows < VTK_ROWS_MOST && ms &&
        sscanf(line, "{\"what\": \"%39[^\"]\"", out->row[out->rows].what) == 1)
        out->row[out->rows++].ms = strtod(ms + strlen("\"median_ms\": "), NULL);
}

void bench_vtk(struct bench_vtk *out, const struct session *session)
{
    OWNED(buf_release) struct buf script = {0}, labels = {0}, command = {0};
    const struct labels forest = labels_of_forest(session->scene);
    char line[1024];
    *out = (struct bench_vtk){.rows = 0};
    if (!bench_find_in_tree(&script, "tests/peers/vtk_render.py"))
        return;
    buf_printf(&labels, "%s/labels.nii", bench_folder(NULL));
    must(
        export_map(session, MAP_LABELS, &forest, buf_text(&labels), FILE_KEEP, NULL, &bench_fault));
    buf_printf(&command,
               "taskset -c %d /usr/bin/python3 '%s' '%s' --size %d %d --angles 30 15 0 --zoom 1 "
               "--rounds 7",
               sched_getcpu(), buf_text(&script), buf_text(&labels), SIDE, SIDE);
    fflush(NULL);
    FILE *told = popen(buf_text(&command), "r");
    while (told && fgets(line, sizeof line, told))
        read_line(out, line);
    if (told && pclose(told) != 0)
        out->rows = 0;
}

/* ---- tables ---- */

static double labels_changed(const struct table *t)
{
    return t->edits ? t->labels / (double)t->edits : 0;
}

static void print_table(struct table *t, const struct session *session)
{
    printf("ch2, brain and cerebellum: %zu voxels, %zu of them seeds, %zu border voxels.\n"
           "%dx%d pixels, one core. "
           "A turn of %d frames: %zu pixels show an object at zoom 1, %zu at zoom 2.\n"
           "Edits bite at what is seen and are erased again; each changes %.0f labels.\n\n",
           session->scene->grid.voxels, forest_seeds(session->forest),
           border_count(&session->border), SIDE, SIDE, FRAMES, t->pixels[0], t->pixels[1],
           labels_changed(t));
    times_print_title();
    for (int i = 0; i < t->rows; i++) {
        struct row *row = &t->row[i];
        if (row->times.count)
            times_print(row->what, &row->times, 1, "ms");
        else if (row->only_ms > 0)
            printf("%-44s %9.2f %9s %9s  ms\n", row->what, row->only_ms, "", "");
        else
            puts(row->what);
    }
}

static void write_table(struct table *t, const struct session *session)
{
    struct json *json = bench_json();
    json_object(json, NULL);
    json_text(json, "scene", "ch2");
    json_count(json, "border_voxels", border_count(&session->border));
    json_fixed(json, "labels_changed", labels_changed(t), 0);
    json_array(json, "rows");
    for (int i = 0; i < t->rows; i++) {
        struct row *row = &t->row[i];
        if (row->times.count == 0 && row->only_ms <= 0)
            continue;
        json_object(json, NULL);
        json_text(json, "what", row->what + strspn(row->what, " "));
        if (row->times.count)
            times_write(json, &row->times);
        else
            json_fixed(json, "median", row->only_ms, 3);
        json_end(json);
    }
    json_end(json);
    json_end(json);
}

/* ---- the labels ---- */

void bench_segment(struct interpreter *interp, const char *journal)
{
    OWNED(buf_release) struct buf path = {0};
    OWNED(reply_release) struct reply reply = {0};
    OWNED(mem_release) char *line = NULL;
    size_t room = 0;
    FILE *in = bench_find_in_tree(&path, journal) ? fopen(buf_text(&path), "r") : NULL;
    must(in ? OK
            : fault_set(&bench_fault, ERR_IO,
                        "this works on what %s segments, and that does not lie beside the program",
                        journal));
    interp->mode = MODE_REPLAY;
    while (getline(&line, &room, in) >= 0) {
        line[strcspn(line, "\n")] = '\0';
        if (*line != '=')
            must(interpreter_execute(interp, line, &reply, &bench_fault));
    }
    fclose(in);
    must(session_run(interp->session, &bench_fault));
}

enum err run_render(const struct options *o, struct fault *fault)
{
    OWNED(interpreter_release) struct interpreter interp = {0};
    OWNED(mem_release) struct table *table = must_have(sizeof *table);
    struct look cubes = look_default(), samples = look_default();
    (void)fault;
    cubes.mode = SHADE_CUBES;
    samples.samples = 2;
    console_handle_interrupts();
    must(interpreter_init(&interp, &bench_fault));
    struct session *session = interp.session;
    bench_segment(&interp, "examples/brain.iftty");
    time_turn(session, table, VIEW_ZOOM_ONE);
    time_turn(session, table, 2 * VIEW_ZOOM_ONE);
    time_look(session, table, "    as cubes, zoom 1", &cubes);
    time_look(session, table, "    2x2 samples, zoom 1", &samples);
    time_edits(session, table, VIEW_ZOOM_ONE);
    time_edits(session, table, 2 * VIEW_ZOOM_ONE);
    time_slices(session, table, "mosaic: three slices and the rendition", SLICE_KIND_MOSAIC);
    time_slices(session, table, "axial slice", SLICE_KIND_AXIAL);
    time_finish(session, table, "finish: majority radius 1", FINISH_MAJORITY, 1);
    time_finish(session, table, "finish: majority radius 3", FINISH_MAJORITY, 3);
    time_finish(session, table, "finish: relax, 20 sweeps", FINISH_RELAX, 20);
    time_finish(session, table, "finish: largest", FINISH_LARGEST, 0);
    time_finish(session, table, "finish: open radius 3", FINISH_OPEN, 3);
    time_stats(session, table);
    time_following(session, table);
    if (watch_poll(console_watch(), "VTK", 1, 2))
        must(fault_set(&bench_fault, ERR_CANCELLED, "cancelled"));
    struct bench_vtk vtk;
    char what[128] = "VTK is not here to compare with: it takes Debian's python3-vtk9 and xvfb";
    bench_vtk(&vtk, session);
    if (vtk.rows)
        snprintf(what, sizeof what, "VTK %s in software, the same labels, one core", vtk.version);
    add_row(table, what);
    for (int i = 0; i < vtk.rows; i++) {
        snprintf(what, sizeof what, "    %s", vtk.row[i].what);
        add_row(table, what);
        table->row[table->rows - 1].only_ms = vtk.row[i].ms;
    }
    (o->json ? write_table : print_table)(table, session);
    return OK;
}
