/* SPDX-License-Identifier: MIT */
/* Time of frames at sizes that people wait for, by one thread and by all: elapsed, and of
 * processors, which other work on the machine changes less. Then a whole turntable, and VTK. */
#include "show/pictures.h"
#include "tests/bench/bench.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "base/clock.h"
#include "base/json.h"
#include "base/mem.h"
#include "tests/bench/times.h"
#include "render/border.h"
#include "session/session.h"
#include "session/session_inside.h"
#include "show/draw.h"

enum { TIMES_MOST = 48, ROWS_MOST = 24, TEAMS = 2 };

struct times {
    double ms[TIMES_MOST], of_processors[TIMES_MOST];
    size_t count;
};

struct row {
    const char *what;
    struct times times[TEAMS]; /* one thread, all threads */
};

struct table {
    struct row row[ROWS_MOST];
    int rows;
    struct team *team; /* all threads */
    struct shader
        shader[TEAMS]; /* stored by one thread, and by all; the session has that of `which` */
    int which;
    const char *text; /* in the names of what is timed, or NULL for all */
    bool has_turntable;
    struct bench_process turntable[2]; /* the session without it, and with it */
    struct buf vtk;                    /* output of bench_vtk */
};

/* ---- times ---- */

static uint64_t processors_ns(void)
{
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (uint64_t)now.tv_sec * UINT64_C(1000000000) + (uint64_t)now.tv_nsec;
}

struct moment {
    uint64_t elapsed, processors;
};

static struct moment moment_now(void)
{
    return (struct moment){clock_ns(), processors_ns()};
}

static void add_since(struct times *times, struct moment begin)
{
    const struct moment end = moment_now();
    if (times->count == TIMES_MOST)
        return;
    times->ms[times->count] = times_between(begin.elapsed, end.elapsed);
    times->of_processors[times->count++] = times_between(begin.processors, end.processors);
}

static struct row *add_row(struct table *table, const char *what)
{
    struct row *row = &table->row[table->rows++];
    row->what = what;
    return row;
}

/* From now on one thread draws, or all of them. */
static void take_team(struct table *table, struct session *session, int which)
{
    table->shader[table->which] = session->pictures->shader;
    session->pictures->shader = table->shader[which];
    session->team = which ? table->team : NULL;
    table->which = which;
}

/* ---- frames ---- */

struct frames {
    const char *what;
    uint32_t samples, side, zoom;
    int count; /* in a turn, seen a little from above */
    enum render_mode mode;
};

static const struct frames frames[] = {
    {"512x512, zoom 1", 1, 512, 1000, 24, RENDER_BORDER},
    {"512x512, zoom 2", 1, 512, 2000, 24, RENDER_BORDER},
    {"2048x2048, zoom 8", 1, 2048, 8000, 9, RENDER_BORDER},
    {"512x512, zoom 1, 4x4 samples", 4, 512, 1000, 9, RENDER_BORDER},
    {"a picture of a turntable of 2048x2048, zoom 8, 4x4 samples", 4, 2048, 8000, 3, RENDER_ONCE},
};

static enum err look_with(struct session *session, const struct frames *f, int frame,
                          struct fault *fault)
{
    struct state next = session->now;
    next.outlook.look.samples = f->samples;
    next.outlook.view.width = next.outlook.view.height = f->side;
    next.outlook.view.zoom = f->zoom;
    next.outlook.view.angle[0] = frame * (VIEW_TURN / f->count);
    next.outlook.view.angle[1] = 15000;
    return session_go(session, &next, NULL, 0, fault);
}

/* One thread and all of them in turn, so that other work on the machine meets both. */
static enum err time_frames(struct session *session, struct table *table, const struct frames *f,
                            struct fault *fault)
{
    if (table->text && !strstr(f->what, table->text))
        return OK;
    struct row *row = add_row(table, f->what);
    enum err err = look_with(session, f, 0, fault);
    if (!err)
        err = session_draw(session, f->mode, fault); /* room is made, and fields */
    for (int i = 0; !err && i < TEAMS * f->count; i++) {
        take_team(table, session, i % TEAMS);
        err = look_with(session, f, i / TEAMS, fault);
        session->inside->follower->forget(session->pictures);
        const struct moment begin = moment_now();
        err = err ? err : session_draw(session, f->mode, fault);
        add_since(&row->times[i % TEAMS], begin);
    }
    return err;
}

/* ---- edits ---- */

enum { BALL = 6, EDITS = 16 };

/* The incremental image of an edit, which is left out. */
static enum err follow(struct session *session, const struct edit *edit, size_t count,
                       struct times *times, struct fault *fault)
{
    enum err err = forest_edit(session->forest, edit, count, fault);
    const struct changes changes = forest_changes(session->forest);
    border_update(&session->border, &changes);
    const struct moment begin = moment_now();
    session->inside->follower->follow(session->pictures, &changes);
    if (!err && changes.count > 500 && changes.count < 4000)
        add_since(times, begin);
    return err;
}

/* Balls of background bite into what is seen, and are erased again. */
static enum err time_edits(struct session *session, struct table *table, const char *what,
                           uint32_t samples, struct fault *fault)
{
    const struct frames f = {what, samples, 512, 1000, 12, RENDER_BORDER};
    if (table->text && !strstr(what, table->text))
        return OK;
    struct row *row = add_row(table, what);
    struct bench_ball *ball = mem_new(sizeof *ball);
    enum err err = ball ? look_with(session, &f, 1, fault) : fault_memory(fault, "a benchmark");
    if (!err)
        err = session_draw(session, RENDER_BORDER, fault);
    size_t pixel = 0;
    for (int i = 0; !err && i < EDITS * TEAMS * 8 && row->times[1].count < EDITS; i++) {
        const struct rendition *frame = session_frame(session);
        pixel = bench_next_pixel(frame, pixel);
        bench_ball_make(ball, session->scene, frame->cell[pixel], BALL);
        take_team(table, session, i % TEAMS);
        err = follow(session, ball->seed, ball->count, &row->times[i % TEAMS], fault);
        if (!err)
            err = follow(session, ball->undo, ball->count, &row->times[i % TEAMS], fault);
    }
    free(ball);
    return err;
}

/* ---- the whole of it, and VTK ---- */

static enum err time_turntable(struct table *table, struct fault *fault)
{
    if (table->text && !strstr("turntable", table->text))
        return OK;
    table->has_turntable = true;
    const enum err err = bench_turntable(&table->turntable[0], "", fault);
    return err ? err
               : bench_turntable(&table->turntable[1],
                                 "size 2048 2048\nzoom 8\nsamples 4\nspin 36 turn%02d.png\n",
                                 fault);
}

static void print_turntable(FILE *out, const struct table *t)
{
    const struct bench_process *without = &t->turntable[0], *with = &t->turntable[1];
    if (t->has_turntable)
        fprintf(out,
                "\nA turntable of 36 pictures of 2048x2048 pixels, zoom 8, 4x4 samples, as PNG:\n"
                "%.1f s, of processors %.1f s; held at most %.0f MB, of which the session without "
                "it %.0f MB.\n",
                with->seconds - without->seconds, with->of_processors - without->of_processors,
                with->megabytes, without->megabytes);
}

static void print_vtk(FILE *out, struct table *t)
{
    if (t->vtk.length)
        fprintf(out, "\nVTK in software, the same labels, 512x512, one core:\n");
    for (char *line = t->vtk.length ? strtok(t->vtk.data, "\n") : NULL; line;
         line = strtok(NULL, "\n")) {
        char what[60];
        const char *ms = strstr(line, "\"median_ms\": ");
        if (ms && sscanf(line, "{\"what\": \"%59[^\"]\"", what) == 1)
            fprintf(out, "%-60s %9.2f\n", what, strtod(ms + strlen("\"median_ms\": "), NULL));
    }
}

/* ---- tables ---- */

static void print_table(FILE *out, struct table *t)
{
    fprintf(out, "%-60s %s\n%-60s %9s %9s %9s %9s\n", "", "one thread        all threads", "", "ms",
            "of CPUs", "ms", "of CPUs");
    for (int i = 0; i < t->rows; i++) {
        fprintf(out, "%-60s", t->row[i].what);
        for (int k = 0; k < TEAMS; k++) {
            struct times *times = &t->row[i].times[k];
            fprintf(out, " %9.2f %9.2f", times_median(times->ms, times->count),
                    times_median(times->of_processors, times->count));
        }
        fputc('\n', out);
    }
    print_turntable(out, t);
    print_vtk(out, t);
}

static void print_json(FILE *out, struct table *t)
{
    static const char *const name[TEAMS][2] = {{"one_ms", "one_processors_ms"},
                                               {"all_ms", "all_processors_ms"}};
    struct buf text = {0};
    struct json json = {.out = &text};
    json_object(&json, NULL);
    json_array(&json, "rows");
    for (int i = 0; i < t->rows; i++) {
        json_object(&json, NULL);
        json_text(&json, "what", t->row[i].what);
        for (int k = 0; k < TEAMS; k++) {
            struct times *times = &t->row[i].times[k];
            json_fixed(&json, name[k][0], times_median(times->ms, times->count), 3);
            json_fixed(&json, name[k][1], times_median(times->of_processors, times->count), 3);
        }
        json_end(&json);
    }
    json_end(&json);
    if (t->has_turntable) {
        const struct bench_process *without = &t->turntable[0], *with = &t->turntable[1];
        json_fixed(&json, "turntable_s", with->seconds - without->seconds, 2);
        json_fixed(&json, "turntable_processors_s", with->of_processors - without->of_processors,
                   2);
        json_fixed(&json, "turntable_mb", with->megabytes, 0);
        json_fixed(&json, "session_mb", without->megabytes, 0);
    }
    json_end(&json);
    fputs(buf_text(&text), out);
    buf_release(&text);
}

static enum err time_brain(struct session *session, struct table *table, struct fault *fault)
{
    enum err err = OK;
    for (size_t i = 0; !err && i < sizeof frames / sizeof frames[0]; i++)
        err = time_frames(session, table, &frames[i], fault);
    if (!err)
        err = time_edits(session, table, "incremental image, 512x512, zoom 1", 1, fault);
    if (!err)
        err =
            time_edits(session, table, "incremental image, 512x512, zoom 1, 4x4 samples", 4, fault);
    return err || table->text ? err : bench_vtk(session, &table->vtk, fault);
}

static enum err set_opacity(struct session *session, uint8_t head, uint8_t brain,
                            struct fault *fault)
{
    struct state next = session->now;
    next.kept.opacity[1] = head;
    next.kept.opacity[2] = brain;
    return session_go(session, &next, NULL, 0, fault);
}

/* Ventricles in a brain in a head: opaque, and as three layers. */
static enum err time_head(struct session *session, struct table *table, struct fault *fault)
{
    static const char *const what[][2] = {
        {"a head, zoom 1, opaque", "a head, zoom 1, three layers"},
        {"a head, zoom 2, opaque", "a head, zoom 2, three layers"},
        {"a head, zoom 4, opaque", "a head, zoom 4, three layers"},
        {"a head, zoom 8, opaque", "a head, zoom 8, three layers"}};
    enum err err = OK;
    for (uint32_t i = 0; !err && i < 8; i++) {
        const struct frames f = {what[i / 2][i % 2], 1, 512, 1000u << i / 2, 24, RENDER_BORDER};
        err = i % 2 ? set_opacity(session, 25, 45, fault)
                    : set_opacity(session, BORDER_OPAQUE, BORDER_OPAQUE, fault);
        if (!err)
            err = time_frames(session, table, &f, fault);
    }
    return err;
}

/* In a session of its own, of what a journal segments. */
static enum err time_session(const char *journal, struct table *table,
                             enum err (*time)(struct session *, struct table *, struct fault *),
                             struct fault *fault)
{
    struct interpreter interp;
    enum err err = interpreter_init(&interp, fault);
    if (!err)
        err = bench_segment(&interp, journal, fault);
    if (!err) {
        table->team = interp.session->team, table->which = 1;
        err = time(interp.session, table, fault);
        take_team(table, interp.session, 1);
        shader_release(&table->shader[0]);
    }
    interpreter_release(&interp);
    return err;
}

enum err run_frames(const struct options *o, struct fault *fault)
{
    struct table *table = mem_new(sizeof *table);
    console_handle_interrupts();
    if (!table)
        return fault_memory(fault, "a benchmark");
    table->text = o->words ? o->word[0] : NULL;
    enum err err =
        time_turntable(table, fault); /* a process counts what the one it forked from held */
    if (!err)
        err = time_session("examples/brain.iftty", table, time_brain, fault);
    if (!err)
        err = time_session("examples/head.iftty", table, time_head, fault);
    if (!err)
        (o->json ? print_json : print_table)(stdout, table);
    buf_release(&table->vtk);
    free(table);
    return err;
}
