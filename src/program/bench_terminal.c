/*
 * `iftty bench terminal`: what pictures cost on their way to a terminal, bytes and time, and how long
 * it takes from a key to the picture.
 *
 * The pictures are those at the end of examples/brain.iftty (of geom.iftty where the scene ch2 is
 * not here): its rendition of 512x512 pixels, a mosaic of 640x640, and patches of 40x40 that change
 * in the rendition, as an edit changes them: into what is seen a few pixels beside. The painter
 * sends them to a terminal with cells of 8x16 pixels, by every means that it knows. Then the pilot,
 * in a terminal of the benchmark's own (bench_far_end.h), at once and through a line of 2 Mbit/s
 * and 120 ms round trip.
 *
 * Medians; no time is compared with a limit. tests/bench/chafa.py has another program beside it.
 */
#include "program/bench_terminal.h"

#include <stdio.h>
#include <stdlib.h>

#include "base/file.h"
#include "base/json.h"
#include "base/mem.h"
#include "program/bench.h"
#include "program/programs.h"
#include "program/shown.h"
#include "session/slicing.h"

enum { RENDITION_SIDE = 512, MOSAIC_SIDE = 640 };

/* ---- the rows and columns of both tables ---- */

struct words {
    const char *name, *text; /* in JSON and in the table */
};

enum { RENDITION, MOSAIC, PATCH, PICTURES };
static const struct words picture_words[PICTURES] = {
    {"rendition", "rendition, 512x512"},
    {"mosaic", "mosaic, 640x640"},
    {"patch", "40x40 pixels of the rendition change"}};

static const struct words key_words[BENCH_KEYS] = {
    [BENCH_MOVE] = {"move", "the cross-hair by a voxel, ms"},
    [BENCH_SEED] = {"seed", "a seed and its run, ms"}};

/* All protocols but the last, which shows nothing. Blocks are half a cell high, in 24-bit colours. */
enum { MEANS_MOST = 8 };
#define MEANS ((int)graphics_auto.count - 1)

static const struct line_kind {
    const char *name, *text;
    struct bench_line line;
    unsigned keys;
} lines[] = {{"local", "no line", {0, 0}, 24},
             {"slow", "2 Mbit/s, 120 ms round trip", {2e6, 60}, 10}};
enum { LINES = sizeof lines / sizeof lines[0], PILOTED = 2 };
static const struct graphics *const piloted[PILOTED] = {&graphics_kitty, &graphics_sixel};

struct figures {
    const char *journal;
    struct bench_cost cost[PICTURES][MEANS_MOST];
    int lines; /* that were timed */
    struct bench_key key[LINES][PILOTED][BENCH_KEYS];
};

/* ---- pictures ---- */

static enum err resume(struct interpreter *interp, const char *journal, struct fault *fault)
{
    struct buf lines_of_it = {0};
    struct session *session = &interp->session;
    interp->is_read_only = true; /* it stays as it is */
    enum err err = interpreter_resume_journal(interp, journal, &lines_of_it, fault);
    buf_release(&lines_of_it);
    if (err)
        return err;
    struct view view = session->now.outlook.view;
    view.width = view.height = RENDITION_SIDE;
    err = session_set_view(session, &view, fault);
    if (!err)
        err = session_render(session, RENDER_BORDER, fault);
    return err ? err : session_count_labels(session, fault);
}

static bool time_picture(const struct image_view *view, bool changes, struct bench_cost *whole,
                         struct bench_cost *patch)
{
    bool good = true;
    for (int m = 0; good && m < MEANS; m++) {
        const struct graphics *by = graphics_auto.of[m];
        good = bench_painter_whole(&whole[m], by, view);
        /* an edit in blocks is a few cells: as coarse as that, there is no patch of 40x40 */
        if (good && changes && by->kind == GRAPHICS_PIXELS)
            good = bench_painter_patches(&patch[m], by, view);
    }
    return good;
}

static enum err time_painter(struct session *session, struct figures *f, struct fault *fault)
{
    uint32_t hue[256];
    struct canvas canvas = {0};
    const struct rendition *r = session_frame(session);
    struct image_view view = {.width = r->width,
                              .height = r->height,
                              .rgba = r->rgba,
                              .hue = hue,
                              .hues = shown_hues(hue, session)};
    bool good = time_picture(&view, true, f->cost[RENDITION], f->cost[PATCH]);
    enum err err = slicing_panel(&canvas, session, MOSAIC_SIDE, MOSAIC_SIDE, true, fault);
    view.width = view.height = MOSAIC_SIDE;
    view.rgba = canvas.rgba;
    good = good && !err && time_picture(&view, false, f->cost[MOSAIC], NULL);
    canvas_release(&canvas);
    return err || good ? err : fault_memory(fault, "a picture for the terminal");
}

static enum err time_pictures(struct figures *f, struct buf *journal, struct fault *fault)
{
    struct interpreter interp;
    enum err err = interpreter_init(&interp, fault);
    if (!err)
        err = bench_find_example(journal, &interp, fault);
    if (!err)
        err = resume(&interp, buf_text(journal), fault);
    if (!err)
        err = time_painter(&interp.session, f, fault);
    interpreter_release(&interp);
    return err;
}

/* ---- the pilot ---- */

static enum err time_pilot(const char *journal, bool quick, struct figures *f, struct fault *fault)
{
    enum err err = OK;
    f->lines = quick ? 1 : LINES;
    for (int l = 0; !err && l < f->lines; l++)
        for (int m = 0; !err && m < PILOTED; m++)
            err = bench_pilot(journal, piloted[m], &lines[l].line, quick ? 4 : lines[l].keys,
                              f->key[l][m], fault);
    return err;
}

/* ---- what is printed ---- */

static void print_picture(FILE *out, const char *words, const struct bench_cost cost[MEANS_MOST])
{
    fprintf(out, "    %-36s", words);
    for (int m = 0; m < MEANS; m++) {
        if (cost[m].bytes > 0)
            fprintf(out, " %7.2f %5.2f", cost[m].bytes / 1000, cost[m].ms);
        else
            fprintf(out, " %7s %5s", "", "");
    }
    fputc('\n', out);
}

static void print_keys(FILE *out, const struct bench_key key[BENCH_KEYS])
{
    for (int k = 0; k < BENCH_KEYS; k++)
        fprintf(out, "        %-32s %9.2f %9.2f %9.2f\n", key_words[k].text, key[k].shown_ms,
                key[k].last_ms, key[k].bytes / 1000);
}

static void print_table(FILE *out, const struct figures *f)
{
    fprintf(out, "%s, what goes to the terminal\n    %-36s", f->journal, "");
    for (int m = 0; m < MEANS; m++)
        fprintf(out, " %13s", graphics_auto.of[m]->title);
    fprintf(out, "\n    %-36s", "");
    for (int m = 0; m < MEANS; m++)
        fprintf(out, " %7s %5s", "kB", "ms");
    fputc('\n', out);
    for (int i = 0; i < PICTURES; i++)
        print_picture(out, picture_words[i].text, f->cost[i]);
    fprintf(out, "the pilot, %dx%d cells of %dx%d pixels: a key, until\n%-41s %9s %9s %9s\n",
            FAR_COLUMNS, FAR_ROWS, FAR_CELL_WIDTH, FAR_CELL_HEIGHT, "", "shown", "last byte", "kB");
    for (int l = 0; l < f->lines; l++)
        for (int m = 0; m < PILOTED; m++) {
            fprintf(out, "    %s, %s\n", piloted[m]->title, lines[l].text);
            print_keys(out, f->key[l][m]);
        }
}

static void add_picture(struct json *json, const char *name, const struct bench_cost *cost)
{
    json_object(json, name);
    for (int m = 0; m < MEANS; m++) {
        if (cost[m].bytes <= 0)
            continue;
        json_object(json, graphics_auto.of[m]->name);
        json_fixed(json, "bytes", cost[m].bytes, 0);
        json_fixed(json, "ms", cost[m].ms, 3);
        json_end(json);
    }
    json_end(json);
}

static void add_keys(struct json *json, const char *name, const struct bench_key key[BENCH_KEYS])
{
    json_object(json, name);
    for (int k = 0; k < BENCH_KEYS; k++) {
        json_object(json, key_words[k].name);
        json_count(json, "keys", key[k].keys);
        json_fixed(json, "shown_ms", key[k].shown_ms, 3);
        json_fixed(json, "last_ms", key[k].last_ms, 3);
        json_fixed(json, "bytes", key[k].bytes, 0);
        json_end(json);
    }
    json_end(json);
}

static void print_json(FILE *out, const struct figures *f)
{
    struct buf text = {0};
    struct json json = {.out = &text};
    char name[32];
    json_object(&json, NULL);
    json_text(&json, "journal", f->journal);
    for (int i = 0; i < PICTURES; i++)
        add_picture(&json, picture_words[i].name, f->cost[i]);
    json_object(&json, "pilot");
    for (int l = 0; l < f->lines; l++)
        for (int m = 0; m < PILOTED; m++) {
            snprintf(name, sizeof name, "%s_%s", piloted[m]->name, lines[l].name);
            add_keys(&json, name, f->key[l][m]);
        }
    json_end(&json);
    json_end(&json);
    fputs(buf_text(&text), out);
    buf_release(&text);
}

enum err run_bench_terminal(const struct options *o, struct fault *fault)
{
    struct buf journal = {0};
    struct figures f = {.lines = 0};
    enum err err = time_pictures(&f, &journal, fault);
    if (!err)
        err = time_pilot(buf_text(&journal), o->quick, &f, fault);
    f.journal = file_name(buf_text(&journal));
    if (!err)
        (o->json ? print_json : print_table)(stdout, &f);
    buf_release(&journal);
    return err;
}
