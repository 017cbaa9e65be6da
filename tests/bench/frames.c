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
#include "tests/bench/times.h"
#include "render/border.h"
#include "session/session.h"
#include "session/session_inside.h"
#include "show/draw.h"

enum { ROWS_MOST = 24, TEAMS = 2 };

struct row {
    const char *what;
    struct times elapsed[TEAMS], of_processors[TEAMS]; /* one thread, all threads */
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
    struct bench_vtk vtk;
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

static void add_since(struct row *row, int which, struct moment begin)
{
    struct times *of_processors = &row->of_processors[which];
    times_add(&row->elapsed[which], begin.elapsed);
    of_processors->ms[of_processors->count++] = times_between(begin.processors, processors_ns());
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

static void look_with(struct session *session, const struct frames *f, int frame)
{
    struct state next = session->now;
    next.outlook.look.samples = f->samples;
    next.outlook.view.width = next.outlook.view.height = f->side;
    next.outlook.view.zoom = f->zoom;
    next.outlook.view.angle[0] = frame * (VIEW_TURN / f->count);
    next.outlook.view.angle[1] = 15000;
    must(session_go(session, &next, NULL, 0, &bench_fault));
}

/* One thread and all of them in turn, so that other work on the machine meets both. */
static void time_frames(struct session *session, struct table *table, const struct frames *f)
{
    if (table->text && !strstr(f->what, table->text))
        return;
    struct row *row = add_row(table, f->what);
    look_with(session, f, 0);
    must(session_draw(session, f->mode, &bench_fault)); /* room is made, and fields */
    for (int i = 0; i < TEAMS * f->count; i++) {
        take_team(table, session, i % TEAMS);
        look_with(session, f, i / TEAMS);
        session->inside->follower->forget(session->pictures);
        const struct moment begin = moment_now();
        must(session_draw(session, f->mode, &bench_fault));
        add_since(row, i % TEAMS, begin);
    }
}

/* ---- edits ---- */

enum { BALL = 6, EDITS = 16 };

/* The incremental image of an edit, which is left out. */
static void follow(struct session *session, const struct edit *edit, size_t count, struct row *row,
                   int which)
{
    must(forest_edit(session->forest, edit, count, &bench_fault));
    const struct changes changes = forest_changes(session->forest);
    border_update(&session->border, &changes);
    const struct moment begin = moment_now();
    session->inside->follower->follow(session->pictures, &changes);
    must(session_draw(session, RENDER_AS_KEPT, &bench_fault));
    if (changes.count > 500 && changes.count < 4000)
        add_since(row, which, begin);
}

/* Balls of background bite into what is seen, and are erased again. */
static void time_edits(struct session *session, struct table *table, const char *what,
                       uint32_t samples)
{
    static struct bench_ball ball;
    const struct frames f = {what, samples, 512, 1000, 12, RENDER_BORDER};
    if (table->text && !strstr(what, table->text))
        return;
    struct row *row = add_row(table, what);
    size_t pixel = 0;
    look_with(session, &f, 1);
    must(session_draw(session, RENDER_BORDER, &bench_fault));
    for (int i = 0; i < EDITS * TEAMS * 8 && row->elapsed[1].count < EDITS; i++) {
        const struct rendition *frame = session_frame(session);
        pixel = bench_next_pixel(frame, pixel);
        bench_ball_make(&ball, session->scene, frame->cell[pixel], BALL);
        take_team(table, session, i % TEAMS);
        follow(session, ball.seed, ball.count, row, i % TEAMS);
        follow(session, ball.undo, ball.count, row, i % TEAMS);
    }
}

/* ---- the whole of it, and VTK ---- */

static void time_turntable(struct table *table)
{
    table->has_turntable = !table->text || strstr("turntable", table->text);
    if (!table->has_turntable)
        return;
    table->turntable[0] = bench_turntable("");
    table->turntable[1] =
        bench_turntable("size 2048 2048\nzoom 8\nsamples 4\nspin 36 turn%02d.png\n");
}

/* ---- tables ---- */

/* Medians of a row: elapsed and of processors, by one thread and by all. */
static void medians(double out[4], struct row *row)
{
    for (int k = 0; k < TEAMS; k++) {
        out[2 * k] = times_median(row->elapsed[k].ms, row->elapsed[k].count);
        out[2 * k + 1] = times_median(row->of_processors[k].ms, row->of_processors[k].count);
    }
}

static void print_table(struct table *t)
{
    const struct bench_process *without = &t->turntable[0], *with = &t->turntable[1];
    printf("%-60s %s\n%-60s %9s %9s %9s %9s\n", "", "one thread        all threads", "", "ms",
           "of CPUs", "ms", "of CPUs");
    for (int i = 0; i < t->rows; i++) {
        double ms[4];
        medians(ms, &t->row[i]);
        printf("%-60s %9.2f %9.2f %9.2f %9.2f\n", t->row[i].what, ms[0], ms[1], ms[2], ms[3]);
    }
    if (t->has_turntable)
        printf("\nA turntable of 36 pictures of 2048x2048 pixels, zoom 8, 4x4 samples, as PNG:\n"
               "%.1f s, of processors %.1f s; held at most %.0f MB, of which the session without "
               "it %.0f MB.\n",
               with->seconds - without->seconds, with->of_processors - without->of_processors,
               with->megabytes, without->megabytes);
    if (t->vtk.rows)
        printf("\nVTK in software, the same labels, 512x512, one core:\n");
    for (int i = 0; i < t->vtk.rows; i++)
        printf("%-60s %9.2f\n", t->vtk.row[i].what, t->vtk.row[i].ms);
}

static void write_table(struct table *t)
{
    struct json *json = bench_json();
    static const char *const name[] = {"one_ms", "one_processors_ms", "all_ms",
                                       "all_processors_ms"};
    json_object(json, NULL);
    json_array(json, "rows");
    for (int i = 0; i < t->rows; i++) {
        double ms[4];
        medians(ms, &t->row[i]);
        json_object(json, NULL);
        json_text(json, "what", t->row[i].what);
        for (int k = 0; k < 4; k++)
            json_fixed(json, name[k], ms[k], 3);
        json_end(json);
    }
    json_end(json);
    if (t->has_turntable) {
        const struct bench_process *without = &t->turntable[0], *with = &t->turntable[1];
        json_fixed(json, "turntable_s", with->seconds - without->seconds, 2);
        json_fixed(json, "turntable_processors_s", with->of_processors - without->of_processors, 2);
        json_fixed(json, "turntable_mb", with->megabytes, 0);
        json_fixed(json, "session_mb", without->megabytes, 0);
    }
    json_end(json);
}

/* ---- the sessions ---- */

static void time_brain(struct session *session, struct table *table)
{
    for (size_t i = 0; i < sizeof frames / sizeof frames[0]; i++)
        time_frames(session, table, &frames[i]);
    time_edits(session, table, "incremental image, 512x512, zoom 1", 1);
    time_edits(session, table, "incremental image, 512x512, zoom 1, 4x4 samples", 4);
    if (!table->text)
        bench_vtk(&table->vtk, session);
}

/* Ventricles in a brain in a head: opaque, and as three layers. */
static void time_head(struct session *session, struct table *table)
{
    static const char *const what[][2] = {
        {"a head, zoom 1, opaque", "a head, zoom 1, three layers"},
        {"a head, zoom 2, opaque", "a head, zoom 2, three layers"},
        {"a head, zoom 4, opaque", "a head, zoom 4, three layers"},
        {"a head, zoom 8, opaque", "a head, zoom 8, three layers"}};
    for (uint32_t i = 0; i < 8; i++) {
        const struct frames f = {what[i / 2][i % 2], 1, 512, 1000u << i / 2, 24, RENDER_BORDER};
        struct state next = session->now;
        next.kept.opacity[1] = i % 2 ? 25 : BORDER_OPAQUE;
        next.kept.opacity[2] = i % 2 ? 45 : BORDER_OPAQUE;
        must(session_go(session, &next, NULL, 0, &bench_fault));
        time_frames(session, table, &f);
    }
}

/* In a session of its own, of what a journal segments. */
static void time_session(const char *journal, struct table *table,
                         void (*time)(struct session *, struct table *))
{
    OWNED(interpreter_release) struct interpreter interp;
    must(interpreter_init(&interp, &bench_fault));
    bench_segment(&interp, journal);
    table->team = interp.session->team, table->which = 1;
    time(interp.session, table);
    take_team(table, interp.session, 1);
    shader_release(&table->shader[0]);
}

enum err run_frames(const struct options *o, struct fault *fault)
{
    OWNED(mem_release) struct table *table = must_have(sizeof *table);
    (void)fault;
    console_handle_interrupts();
    table->text = o->words ? o->word[0] : NULL;
    time_turntable(table); /* a process counts what the one it forked from held */
    time_session("examples/brain.iftty", table, time_brain);
    time_session("examples/head.iftty", table, time_head);
    (o->json ? write_table : print_table)(table);
    return OK;
}
