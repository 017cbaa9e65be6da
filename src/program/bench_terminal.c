/*
 * `iftty bench terminal`: what pictures cost on their way to a terminal, bytes and time.
 *
 * The pictures are those at the end of examples/brain.iftty (of geom.iftty where the scene ch2 is
 * not here): its rendition of 512x512 pixels, a mosaic of 640x640, and patches of 40x40 that change
 * in the rendition, as an edit changes them: into what is seen a few pixels beside. The painter
 * sends them to a terminal with cells of 8x16 pixels, by every means that it knows.
 *
 * Medians; no time is compared with a limit. tests/bench/chafa.py has another program beside it,
 * `make bench-keys` the time from a key to the picture.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "command/resume.h"
#include "base/clock.h"
#include "base/file.h"
#include "base/json.h"
#include "program/bench.h"
#include "program/programs.h"
#include "program/shown.h"
#include "render/border.h"
#include "session/session.h"
#include "show/draw.h"
#include "show/slicing.h"
#include "tui/picture/painter.h"

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

struct figures {
    const char *journal;
    struct cost cost[PICTURES][MEANS_MOST];
};

/* ---- the painter ---- */

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

static bool time_frame(struct frames *f, const struct image_view *view)
{
    buf_clear(&f->out);
    const uint64_t begin = clock_ns();
    painter_show(&f->painter, view, &f->out);
    f->ms[f->count] = times_since(begin);
    f->bytes[f->count++] = (double)f->out.length;
    return !f->out.failed;
}

static void end_frames(struct frames *f, bool good, struct cost *cost)
{
    if (good)
        *cost = (struct cost){times_median(f->bytes, f->count), times_median(f->ms, f->count)};
    painter_release(&f->painter);
    buf_release(&f->out);
}

/* A whole picture, square; in blocks as large as the cells allow. False without memory. */
static bool time_whole(struct cost *cost, const struct graphics *by, const struct image_view *view)
{
    struct frames f;
    struct image_view fitting = *view;
    uint8_t *small = NULL;
    begin_frames(&f, by, view->width);
    painter_size(&f.painter, &fitting.width, &fitting.height);
    if (fitting.width < view->width)
        fitting.rgba = small = image_view_shrink(view, fitting.width, fitting.height);
    bool good = fitting.rgba != NULL;
    for (int i = 0; good && i < ROUNDS; i++) {
        painter_forget(&f.painter);
        good = time_frame(&f, &fitting);
    }
    end_frames(&f, good, cost);
    free(small);
    return good;
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

/* The patch, and what is seen 5 pixels to the right of it and 3 below. */
static void change_patch(uint8_t *rgba, const struct image_view *view, uint32_t left, uint32_t top)
{
    for (uint32_t y = 0; y < PATCH_SIDE; y++)
        memcpy(rgba + 4 * ((size_t)(top + y) * view->width + left),
               view->rgba + 4 * ((size_t)(top + y + 3) * view->width + left + 5), 4 * PATCH_SIDE);
}

/* Patches all over the object; each is changed and comes back. */
static bool time_patches(struct cost *cost, const struct graphics *by,
                         const struct image_view *view)
{
    const size_t all = 4 * (size_t)view->width * view->height;
    uint8_t *rgba = malloc(all);
    struct image_view changed = *view;
    struct frames f;
    changed.rgba = rgba;
    begin_frames(&f, by, view->width);
    bool good = rgba && painter_show(&f.painter, view, &f.out);
    for (uint32_t top = 11; good && top + PATCH_SIDE + 3 < view->height; top += 53)
        for (uint32_t left = 17; good && left + PATCH_SIDE + 5 < view->width; left += 67) {
            if (f.count + 2 > FRAMES_MOST || !is_full(view, left, top))
                continue;
            memcpy(rgba, view->rgba, all);
            change_patch(rgba, view, left, top);
            good = time_frame(&f, &changed) && time_frame(&f, view);
        }
    end_frames(&f, good, cost);
    free(rgba);
    return good;
}

/* ---- pictures at the end of a journal ---- */

static enum err resume(struct interpreter *interp, const char *journal, struct fault *fault)
{
    struct buf lines_of_it = {0};
    struct session *session = interp->session;
    interp->is_read_only = true; /* it stays as it is */
    enum err err = interpreter_resume_journal(interp, journal, &lines_of_it, fault);
    buf_release(&lines_of_it);
    if (err)
        return err;
    struct view view = session_outlook(session)->view;
    view.width = view.height = RENDITION_SIDE;
    err = session_set_view(session, &view, fault);
    if (!err)
        err = session_render(session, RENDER_BORDER, fault);
    return err ? err : session_count_labels(session, fault);
}

static bool time_picture(const struct image_view *view, bool changes, struct cost *whole,
                         struct cost *patch)
{
    bool good = true;
    for (int m = 0; good && m < MEANS; m++) {
        const struct graphics *by = graphics_auto.of[m];
        good = time_whole(&whole[m], by, view);
        /* an edit in blocks is a few cells: as coarse as that, there is no patch of 40x40 */
        if (good && changes && by->kind == GRAPHICS_PIXELS)
            good = time_patches(&patch[m], by, view);
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
    struct slicing_panel panel = {.screen = {MOSAIC_SIDE, MOSAIC_SIDE, 8, 16, true, MOSAIC_AXIAL},
                                  .words = true};
    enum err err = slicing_draw_panel(&canvas, session, &panel, fault);
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
        err = time_painter(interp.session, f, fault);
    interpreter_release(&interp);
    return err;
}

/* ---- what is printed ---- */

static void print_picture(FILE *out, const char *words, const struct cost cost[MEANS_MOST])
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
}

static void add_picture(struct json *json, const char *name, const struct cost *cost)
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

static void print_json(FILE *out, const struct figures *f)
{
    struct buf text = {0};
    struct json json = {.out = &text};
    json_object(&json, NULL);
    json_text(&json, "journal", f->journal);
    for (int i = 0; i < PICTURES; i++)
        add_picture(&json, picture_words[i].name, f->cost[i]);
    json_end(&json);
    fputs(buf_text(&text), out);
    buf_release(&text);
}

enum err run_bench_terminal(const struct options *o, struct fault *fault)
{
    struct buf journal = {0};
    struct figures f = {.journal = NULL};
    enum err err = time_pictures(&f, &journal, fault);
    f.journal = file_name(buf_text(&journal));
    if (!err)
        (o->json ? print_json : print_table)(stdout, &f);
    buf_release(&journal);
    return err;
}
