/* SPDX-License-Identifier: MIT */
/* Time of pictures: whole frames, parts of them, edits, and VTK. */
#include "show/pictures.h"
#include "tests/bench/bench.h"

#include <errno.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/file.h"
#include "base/json.h"
#include "base/mem.h"
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
    MOST_TIMES = FRAMES,
    BALL_MOST = 9,
    ROWS_MOST = 32,
};

struct row {
    char what[128];
    double ms[MOST_TIMES];
    size_t count;
    double only_ms; /* a median that was measured elsewhere, where count is 0 */
};

struct table {
    struct row row[ROWS_MOST];
    int rows;
    size_t pixels[2]; /* that show an object, at zoom 1 and 2 */
    double labels;    /* changed by the edits that count, altogether */
    size_t edits;     /* that count, each planted and each erased one */
    char vtk[128];    /* its version, or why it is not here */
};

static struct row *add_row(struct table *table, const char *what)
{
    struct row *row = &table->row[table->rows < ROWS_MOST - 1 ? table->rows++ : ROWS_MOST - 1];
    snprintf(row->what, sizeof row->what, "%s", what);
    return row;
}

static uint64_t add_since(struct row *row, uint64_t begin)
{
    const uint64_t now = clock_ns();
    if (row->count < MOST_TIMES)
        row->ms[row->count++] = times_between(begin, now);
    return now;
}

static double median(struct row *row)
{
    return row->count ? times_median(row->ms, row->count) : row->only_ms;
}

static double quantile(struct row *row, double share)
{
    return row->count ? times_quantile(row->ms, row->count, share) : row->only_ms;
}

/* ---- frames ---- */

static enum err colour(struct session *session, struct fault *fault)
{
    const struct state *now = &session->now;
    struct pictures *p = session->pictures;
    return shade(&p->rendition, &p->camera, &p->mesh, &now->kept.palette, &now->outlook.look,
                 &p->shader, fault);
}

static enum err turn_to(struct session *session, int frame, uint32_t zoom, struct fault *fault)
{
    struct view view = session->now.outlook.view;
    view.angle[0] = frame * (VIEW_TURN / FRAMES);
    view.angle[1] = 15000;
    view.width = view.height = SIDE;
    view.zoom = zoom;
    enum err err = session_set_view(session, &view, fault);
    if (!err && !session_frame(session)->depth) /* so that no frame makes room for the first time */
        err = session_render(session, RENDER_BORDER, fault);
    return err;
}

static size_t pixels_seen(const struct rendition *r)
{
    size_t seen = 0;
    for (size_t i = 0; i < (size_t)r->width * r->height; i++)
        seen += r->cell[i] != CELL_NONE;
    return seen;
}

/* Whole turns: a frame and its two parts; and again with nothing kept of the frames before. */
static enum err time_turn(struct session *session, struct table *table, uint32_t zoom,
                          struct fault *fault)
{
    static const char *const name[2][4] = {
        {"border projection and shading, zoom 1", "    border projection", "    shading",
         "    both, nothing kept of other frames"},
        {"border projection and shading, zoom 2", "    border projection", "    shading",
         "    both, nothing kept of other frames"}};
    const int which = zoom != VIEW_ZOOM_ONE;
    struct row *row[4];
    struct pictures *p = session->pictures;
    for (int i = 0; i < 4; i++)
        row[i] = add_row(table, name[which][i]);
    enum err err = turn_to(session, FRAMES - 1, zoom, fault);
    for (int frame = 0; !err && frame < FRAMES; frame++) {
        err = turn_to(session, frame, zoom, fault);
        const uint64_t begin = clock_ns();
        project_border(&p->rendition, &p->camera, &p->mesh);
        const uint64_t between = add_since(row[1], begin);
        err = err ? err : colour(session, fault);
        add_since(row[2], between);
        add_since(row[0], begin);
        table->pixels[which] += pixels_seen(&session->pictures->rendition) / FRAMES;
    }
    for (int frame = 0; !err && frame < FRAMES; frame += 4) {
        err = turn_to(session, frame, zoom, fault);
        shader_release(&session->pictures->shader);
        const uint64_t begin = clock_ns();
        err = err ? err : session_render(session, RENDER_BORDER, fault);
        add_since(row[3], begin);
    }
    return err;
}

static enum err go_to_look(struct session *session, const struct look *look, struct fault *fault)
{
    struct state next = session->now;
    next.outlook.look = *look;
    return session_go(session, &next, NULL, 0, fault);
}

/* The same with one look, at zoom 1. */
static enum err time_look(struct session *session, struct table *table, const char *what,
                          const struct look *look, struct fault *fault)
{
    const struct look former = session->now.outlook.look;
    struct row *row = add_row(table, what);
    enum err err = go_to_look(session, look, fault);
    if (!err)
        err = turn_to(session, FRAMES - 1, VIEW_ZOOM_ONE, fault);
    for (int frame = 0; !err && frame < FRAMES; frame += 3) {
        err = turn_to(session, frame, VIEW_ZOOM_ONE, fault);
        const uint64_t begin = clock_ns();
        err = err ? err : session_render(session, RENDER_BORDER, fault);
        add_since(row, begin);
    }
    const enum err again = go_to_look(session, &former, err ? NULL : fault);
    return err ? err : again;
}

static enum err time_looks(struct session *session, struct table *table, struct fault *fault)
{
    struct look look = look_default();
    look.mode = SHADE_CUBES;
    enum err err = time_look(session, table, "    as cubes, zoom 1", &look, fault);
    look = look_default();
    look.samples = 2;
    if (!err)
        err = time_look(session, table, "    2x2 samples, zoom 1", &look, fault);
    return err;
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

/* One edit and its incremental image: the time, and the number of changed labels; 0 if the edit is
 * not of the wanted size. */
struct followed {
    double ms;
    size_t labels;
};

static enum err follow_edit(struct session *session, const struct edit *edit, size_t count,
                            struct followed *out, struct fault *fault)
{
    enum err err = forest_edit(session->forest, edit, count, fault);
    const struct changes changes = forest_changes(session->forest);
    border_update(&session->border, &changes);
    const bool is_wanted =
        !changes.everything && changes.count >= LEAST_LABELS && changes.count <= MOST_LABELS;
    out->labels = is_wanted ? changes.count : 0;
    struct pictures *p = session->pictures;
    const uint64_t begin = clock_ns();
    mesh_note(&p->mesh, &session->border, &changes);
    if (!err)
        err = incremental_image(&p->rendition, &p->camera, &p->mesh, &session->border,
                                &session->now.outlook.look, &changes, session->team, fault);
    err = err ? err : colour(session, fault);
    out->ms = times_since(begin);
    return err;
}

/* An edit and its erasing count where both are of the wanted size: else they are not the same. */
static void count_edits(struct table *table, struct row *row, const struct followed way[2])
{
    if (way[0].labels == 0 || way[1].labels == 0)
        return;
    for (int i = 0; i < 2; i++) {
        row->ms[row->count++] = way[i].ms;
        table->labels += (double)way[i].labels;
        table->edits++;
    }
}

/* A ball of background at a place that is seen bites into it, and is erased again. */
static enum err time_edits(struct session *session, struct table *table, uint32_t zoom,
                           struct fault *fault)
{
    struct row *row =
        add_row(table, zoom == VIEW_ZOOM_ONE ? "incremental image and shading, zoom 1"
                                             : "incremental image and shading, zoom 2");
    struct bench_ball *ball = mem_new(sizeof *ball);
    enum err err = ball ? turn_to(session, 5, zoom, fault) : fault_memory(fault, "a benchmark");
    if (!err)
        err = session_render(session, RENDER_BORDER, fault);
    size_t pixel = 0;
    for (int i = 0; !err && i < TRIES && row->count < 2 * EDITS; i++) {
        struct followed way[2];
        pixel = bench_next_pixel(&session->pictures->rendition, pixel);
        bench_ball_make(ball, session->scene, session->pictures->rendition.cell[pixel],
                        4 + i % (BALL_MOST - 3));
        err = follow_edit(session, ball->seed, ball->count, &way[0], fault);
        if (!err)
            err = follow_edit(session, ball->undo, ball->count, &way[1], fault);
        if (!err)
            count_edits(table, row, way);
    }
    free(ball);
    return err;
}

/* ---- slices ---- */

/* The rendition is up to date; the cross-hair wanders through the scene. */
static enum err time_slices(struct session *session, struct table *table, const char *what,
                            enum slice_kind kind, struct fault *fault)
{
    struct row *row = add_row(table, what);
    const uint32_t *size = session->scene->grid.size;
    enum err err = turn_to(session, 5, VIEW_ZOOM_ONE, fault);
    if (!err)
        err = session_render(session, RENDER_BORDER, fault);
    for (uint32_t i = 0; !err && i < FRAMES; i++) {
        struct canvas canvas = {0};
        for (int a = 0; a < 3; a++)
            session->now.outlook.slices.cross[a] = size[a] * (FRAMES + 2 * i) / (4 * FRAMES);
        const uint64_t begin = clock_ns();
        err = slicing_draw(&canvas, session, kind, NULL, false, fault);
        add_since(row, begin);
        canvas_release(&canvas);
    }
    return err;
}

/* ---- finished labels ---- */

/* Labels taken out of the forest, one step, and the digest, by all threads. */
static enum err time_finish(struct session *session, struct table *table, const char *what,
                            enum finish_kind kind, uint32_t argument, struct fault *fault)
{
    enum { ROUNDS = 9 };
    struct row *row = add_row(table, what);
    struct state next = session->now;
    struct labels labels;
    next.kept.finish = (struct finish_list){
        .count = 1, .step = {{.kind = kind, .label = FINISH_ALL_LABELS, .argument = argument}}};
    enum err err = session_go(session, &next, NULL, 0, fault);
    for (int i = 0; !err && i < ROUNDS; i++) {
        finished_release(&session->inside->finished);
        const uint64_t begin = clock_ns();
        err = session_labels(session, true, &labels, fault);
        add_since(row, begin);
    }
    return err;
}

/* ---- what is known of labels ---- */

/* All statistics of `stats` for each label, by all threads: recounted, and without a change. */
static enum err time_stats(struct session *session, struct table *table, struct fault *fault)
{
    enum { ROUNDS = 9 };
    static struct label_stats stats[256];
    struct row *row[2] = {add_row(table, "stats of all labels"),
                          add_row(table, "    asked for again: components and holes")};
    struct row *counts = add_row(table, "    counts of intensities and planes, anew");
    struct label_sums sums;
    const struct labels labels = labels_of_forest(session->scene);
    enum err err = OK;
    for (int i = 0; !err && i < ROUNDS; i++) {
        struct label_measures measures = {0};
        for (int again = 0; !err && again < 2; again++) {
            const uint64_t begin = clock_ns();
            err = label_stats_find(stats, &measures, &labels, session->team, fault);
            add_since(row[again], begin);
        }
        label_measures_forget(&measures);
        const uint64_t begin = clock_ns();
        err = err ? err : label_measures_sum(&measures, &labels, 1, session->team, &sums, fault);
        add_since(counts, begin);
        label_measures_release(&measures);
    }
    return err;
}

/* An edit of some 2000 labels; the time to note it, and to update the statistics. */
static enum err time_measures(struct session *session, struct label_measures *measures,
                              const struct edit *edit, size_t count, struct row *row[4],
                              struct fault *fault)
{
    const struct labels labels = labels_of_forest(session->scene);
    struct label_sums sums;
    const uint64_t begin = clock_ns();
    enum err err = forest_edit(session->forest, edit, count, fault);
    const struct changes changes = forest_changes(session->forest);
    const uint64_t edited = clock_ns();
    label_measures_follow(measures, &changes);
    const uint64_t noted = clock_ns();
    err = err ? err : label_measures_sum(measures, &labels, 1, session->team, &sums, fault);
    const uint64_t counted = clock_ns();
    err = err ? err : label_measures_refresh_pairs(measures, &labels, session->team, fault);
    const uint64_t of[] = {begin, edited, noted, counted, clock_ns()};
    border_update(&session->border, &changes);
    for (int i = 0; i < 4 && !changes.everything && changes.count >= LEAST_LABELS &&
                    changes.count <= MOST_LABELS && row[i]->count < MOST_TIMES;
         i++)
        row[i]->ms[row[i]->count++] = times_between(of[i], of[i + 1]);
    return err;
}

/* A ball of background at a place that is seen, and its erasing. */
static enum err time_following(struct session *session, struct table *table, struct fault *fault)
{
    struct row *row[4] = {add_row(table, "an edit"), add_row(table, "    noted for statistics"),
                          add_row(table, "    counts of intensities and planes follow"),
                          add_row(table, "    pairs, of which surfaces are made, follow")};
    static struct label_stats stats[256];
    const struct labels labels = labels_of_forest(session->scene);
    struct label_measures measures = {0};
    struct bench_ball *ball = mem_new(sizeof *ball);
    enum err err =
        ball ? session_render(session, RENDER_BORDER, fault) : fault_memory(fault, "a benchmark");
    if (!err)
        err = label_stats_find(stats, &measures, &labels, session->team, fault);
    size_t pixel = 0;
    for (int i = 0; !err && i < TRIES && row[0]->count < 2 * EDITS; i++) {
        pixel = bench_next_pixel(&session->pictures->rendition, pixel);
        bench_ball_make(ball, session->scene, session->pictures->rendition.cell[pixel],
                        4 + i % (BALL_MOST - 3));
        err = time_measures(session, &measures, ball->seed, ball->count, row, fault);
        if (!err)
            err = time_measures(session, &measures, ball->undo, ball->count, row, fault);
    }
    label_measures_release(&measures);
    free(ball);
    return err;
}

static enum err time_steps(struct session *session, struct table *table, struct fault *fault)
{
    enum err err =
        time_finish(session, table, "finish: majority radius 1", FINISH_MAJORITY, 1, fault);
    if (!err)
        err = time_finish(session, table, "finish: majority radius 3", FINISH_MAJORITY, 3, fault);
    if (!err)
        err = time_finish(session, table, "finish: relax, 60 sweeps", FINISH_RELAX, 60, fault);
    if (!err)
        err = time_finish(session, table, "finish: largest", FINISH_LARGEST, 0, fault);
    if (!err)
        err = time_finish(session, table, "finish: open radius 3", FINISH_OPEN, 3, fault);
    if (!err)
        err = time_stats(session, table, fault);
    return err ? err : time_following(session, table, fault);
}

/* ---- VTK ---- */

static void become_script(const char *script, const char *labels, int out)
{
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET((unsigned)sched_getcpu(), &one);
    sched_setaffinity(0, sizeof one, &one);
    dup2(out, STDOUT_FILENO);
    execl("/usr/bin/python3", "/usr/bin/python3", script, labels, "--size", "512", "512",
          "--angles", "30", "15", "0", "--zoom", "1", "--rounds", "7", (char *)NULL);
    _exit(127);
}

/* Output of the script; false if it fails. */
static bool run_script(struct buf *out, const char *script, const char *labels)
{
    int ends[2], status = -1;
    char bytes[1024];
    if (pipe(ends) != 0)
        return false;
    fflush(NULL);
    const pid_t child = fork();
    if (child == 0)
        become_script(script, labels, ends[1]);
    close(ends[1]);
    for (ssize_t n; child > 0 && (n = read(ends[0], bytes, sizeof bytes)) != 0;) {
        if (n < 0 && errno != EINTR)
            break;
        if (n > 0)
            buf_add(out, bytes, (size_t)n);
    }
    close(ends[0]);
    while (child > 0 && waitpid(child, &status, 0) < 0 && errno == EINTR)
        ;
    return child > 0 && WIFEXITED(status) && WEXITSTATUS(status) == 0 && !out->failed;
}

/* {"what": "rotation", "median_ms": 93.1, ...}; the first line has versions. */
static void read_line(struct table *table, const char *line)
{
    char what[40], version[24];
    const char *ms = strstr(line, "\"median_ms\": ");
    if (sscanf(line, "{\"what\": \"versions\", \"vtk\": \"%23[^\"]\"", version) == 1)
        snprintf(table->vtk, sizeof table->vtk, "VTK %s in software, the same labels, one core",
                 version);
    if (!ms || sscanf(line, "{\"what\": \"%39[^\"]\"", what) != 1)
        return;
    struct row *row = add_row(table, "");
    snprintf(row->what, sizeof row->what, "    %s", what);
    row->only_ms = strtod(ms + strlen("\"median_ms\": "), NULL);
}

enum err bench_vtk(const struct session *session, struct buf *lines, struct fault *fault)
{
    struct buf script = {0}, folder = {0}, labels = {0};
    const struct labels forest = labels_of_forest(session->scene);
    enum err err = OK;
    if (bench_find_in_tree(&script, "tests/peers/vtk_render.py") &&
        folder_fresh(&folder, NULL, NULL) == OK) {
        buf_printf(&labels, "%s/labels.nii", buf_text(&folder));
        err = labels.failed
                  ? fault_memory(fault, "a path")
                  : export_map(session, MAP_LABELS, &forest, buf_text(&labels), FILE_KEEP, fault);
        if (!err && !run_script(lines, buf_text(&script), buf_text(&labels)))
            buf_clear(lines);
        folder_remove(buf_text(&folder));
    }
    buf_release(&script);
    buf_release(&folder);
    buf_release(&labels);
    return err;
}

static enum err time_vtk(const struct session *session, struct table *table, struct fault *fault)
{
    struct buf told = {0};
    snprintf(table->vtk, sizeof table->vtk,
             "VTK is not here to compare with: it takes Debian's python3-vtk9 and xvfb");
    const enum err err = bench_vtk(session, &told, fault);
    for (char *line = told.length ? strtok(told.data, "\n") : NULL; line; line = strtok(NULL, "\n"))
        read_line(table, line);
    buf_release(&told);
    return err;
}

/* ---- tables ---- */

static double labels_changed(const struct table *t)
{
    return t->edits ? t->labels / (double)t->edits : 0;
}

static void print_table(FILE *out, struct table *t, const struct session *session)
{
    fprintf(out,
            "ch2, brain and cerebellum: %zu voxels, %zu of them seeds, %zu border voxels.\n"
            "%dx%d pixels, one core. "
            "A turn of %d frames: %zu pixels show an object at zoom 1, %zu at zoom 2.\n"
            "Edits bite at what is seen and are erased again; each changes %.0f labels.\n\n"
            "%-44s %9s %9s %9s\n",
            session->scene->grid.voxels, forest_seeds(session->forest),
            border_count(&session->border), SIDE, SIDE, FRAMES, t->pixels[0], t->pixels[1],
            labels_changed(t), "", "median", "9 of 10", "most");
    for (int i = 0; i < t->rows; i++) {
        struct row *row = &t->row[i];
        if (row->count)
            fprintf(out, "%-44s %9.2f %9.2f %9.2f  ms\n", row->what, median(row),
                    quantile(row, 0.9), quantile(row, 1));
        else if (row->only_ms > 0)
            fprintf(out, "%-44s %9.2f %9s %9s  ms\n", row->what, row->only_ms, "", "");
        else
            fprintf(out, "%s\n", row->what);
    }
}

static void print_json(FILE *out, struct table *t, const struct session *session)
{
    struct buf text = {0};
    struct json json = {.out = &text};
    json_object(&json, NULL);
    json_text(&json, "scene", "ch2");
    json_count(&json, "border_voxels", border_count(&session->border));
    json_fixed(&json, "labels_changed", labels_changed(t), 0);
    json_array(&json, "rows");
    for (int i = 0; i < t->rows; i++) {
        struct row *row = &t->row[i];
        if (row->count == 0 && row->only_ms <= 0)
            continue;
        json_object(&json, NULL);
        json_text(&json, "what", row->what + strspn(row->what, " "));
        json_fixed(&json, "median_ms", median(row), 3);
        json_fixed(&json, "most_ms", quantile(row, 1), 3);
        json_end(&json);
    }
    json_end(&json);
    json_end(&json);
    fputs(buf_text(&text), out);
    buf_release(&text);
}

/* ---- the labels ---- */

/* Carries the commands of a journal out, without writing anything. */
static enum err carry_out(struct interpreter *interp, const char *path, struct fault *fault)
{
    char *line = NULL;
    size_t room = 0;
    struct reply reply = {0};
    enum err err = OK;
    FILE *journal = fopen(path, "r");
    if (!journal)
        return fault_errno(fault, "read", path);
    interp->mode = MODE_REPLAY;
    while (!err && getline(&line, &room, journal) >= 0) {
        line[strcspn(line, "\n")] = '\0';
        if (*line != '=')
            err = interpreter_execute(interp, line, &reply, fault);
    }
    free(line);
    reply_release(&reply);
    fclose(journal);
    return err;
}

enum err bench_segment(struct interpreter *interp, const char *journal, struct fault *fault)
{
    struct buf path = {0};
    enum err err = OK;
    if (!bench_find_in_tree(&path, journal))
        err = fault_set(fault, ERR_IO,
                        "this works on what %s segments, and that does not lie beside the program",
                        journal);
    if (!err)
        err = carry_out(interp, buf_text(&path), fault);
    buf_release(&path);
    return err ? err : session_run(interp->session, fault);
}

enum err run_render(const struct options *o, struct fault *fault)
{
    struct interpreter interp;
    struct watch *watch = console_watch();
    struct table *table = mem_new(sizeof *table);
    console_handle_interrupts();
    enum err err = interpreter_init(&interp, fault);
    struct session *session = interp.session;
    if (!err && !table)
        err = fault_memory(fault, "a benchmark");
    if (!err)
        err = bench_segment(&interp, "examples/brain.iftty", fault);
    for (uint32_t zoom = 1; !err && zoom <= 2; zoom++)
        err = time_turn(session, table, zoom * VIEW_ZOOM_ONE, fault);
    if (!err)
        err = time_looks(session, table, fault);
    for (uint32_t zoom = 1; !err && zoom <= 2; zoom++)
        err = time_edits(session, table, zoom * VIEW_ZOOM_ONE, fault);
    if (!err)
        err = time_slices(session, table, "mosaic: three slices and the rendition",
                          SLICE_KIND_MOSAIC, fault);
    if (!err)
        err = time_slices(session, table, "axial slice", SLICE_KIND_AXIAL, fault);
    if (!err)
        err = time_steps(session, table, fault);
    if (!err && watch_poll(watch, "VTK", 1, 2))
        err = fault_set(fault, ERR_CANCELLED, "cancelled");
    if (!err) {
        struct row *head = add_row(table, "");
        err = time_vtk(session, table, fault);
        snprintf(head->what, sizeof head->what, "%s", table->vtk);
    }
    if (!err)
        (o->json ? print_json : print_table)(stdout, table, session);
    interpreter_release(&interp);
    free(table);
    return err;
}
