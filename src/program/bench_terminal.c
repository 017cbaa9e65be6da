/*
 * `iftty bench terminal`: what pictures cost on their way to a terminal, bytes and time, and how long it
 * takes from a key to the picture.
 *
 * The pictures are those at the end of examples/brain.iftty (of geom.iftty where the scene ch2 is
 * not here): its rendition of 512x512 pixels, a mosaic of 640x640, and patches of 40x40 that change
 * in the rendition, as an edit changes them: into what is seen a few pixels beside. The painter
 * sends them to a terminal with cells of 8x16 pixels, by every means that it knows.
 *
 * Beside it chafa, where that is installed: a program of its own, given the same pictures as PNG
 * and made to show them in the same size. Its time is from its start to its last byte, less what
 * the same takes for a picture of one pixel.
 *
 * Then the pilot, in a terminal of the benchmark's own (bench_pilot.h), at once and through a
 * line of 2 Mbit/s and 120 ms round trip.
 *
 * Medians; no time is compared with a limit.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/json.h"
#include "base/mem.h"
#include "program/bench_chafa.h"
#include "program/bench_painter.h"
#include "program/bench_pilot.h"
#include "program/bench_times.h"
#include "program/bench_tree.h"
#include "program/programs.h"
#include "program/shown.h"
#include "session/slicing.h"
#include "tui/picture/graphics.h"

enum { RENDITION_SIDE = 512, MOSAIC_SIDE = 640 };

enum { RENDITION, MOSAIC, PATCH, PICTURES };
enum { CHAFA_RENDITION, CHAFA_MOSAIC, CHAFA_PICTURES };

static const char *const picture_words[PICTURES] = {"rendition, 512x512", "mosaic, 640x640",
                                                    "40x40 pixels of the rendition change"};
static const char *const picture_names[PICTURES] = {"rendition", "mosaic", "patch"};
static const char *const chafa_words[CHAFA_PICTURES] = {"chafa: rendition", "chafa: mosaic"};

/* All protocols but the last, which shows nothing. Blocks are half a cell high, in 24-bit colours. */
enum { MEANS_MOST = 8 };
#define MEANS ((int)graphics_auto.count - 1)

static const struct line_kind {
    const char *name, *words;
    struct bench_line line;
    unsigned keys;
} lines[] = {{"local", "no line", {0, 0}, 24},
             {"slow", "2 Mbit/s, 120 ms round trip", {2e6, 60}, 10}};
enum { LINES = sizeof lines / sizeof lines[0], PILOTED = 2 };
static const struct graphics *const piloted[PILOTED] = {&graphics_kitty, &graphics_sixel};

struct figures {
    char journal[64];
    struct bench_cost cost[PICTURES][MEANS_MOST], chafa[CHAFA_PICTURES][MEANS_MOST];
    bool has_chafa;
    int lines; /* that were timed */
    struct bench_keys keys[LINES][PILOTED];
};

/* ---- pictures ---- */

struct pictures {
    struct canvas rendition, mosaic;
    uint32_t hue[256];
    unsigned hues;
};

static struct image_view view_of(const struct pictures *p, const struct canvas *canvas)
{
    return (struct image_view){.width = canvas->width,
                               .height = canvas->height,
                               .rgba = canvas->rgba,
                               .hue = p->hue,
                               .hues = p->hues};
}

/* Its rendition, over black, of its own size. */
static enum err copy_rendition(struct canvas *canvas, struct session *session, struct fault *fault)
{
    struct view of_side = session->now.outlook.view;
    of_side.width = of_side.height = RENDITION_SIDE;
    enum err err = session_set_view(session, &of_side, fault);
    if (!err)
        err = session_render(session, RENDER_BORDER, fault);
    const struct rendition *r = session_frame(session);
    if (!err)
        err = canvas_init(canvas, r->width, r->height, false, fault);
    if (err)
        return err;
    const struct image_view view = {.width = r->width, .height = r->height, .rgba = r->rgba};
    for (size_t i = 0; i < (size_t)r->width * r->height; i++) {
        const uint32_t colour = image_view_colour(&view, i);
        for (int k = 0; k < 3; k++)
            canvas->rgba[4 * i + (size_t)k] = (uint8_t)(colour >> (16 - 8 * k));
    }
    return OK;
}

static enum err make_pictures(struct pictures *p, struct interpreter *interp, const char *journal,
                              struct fault *fault)
{
    struct buf told = {0};
    struct session *session = &interp->session;
    interp->is_read_only = true; /* it stays as it is */
    enum err err = interpreter_resume_journal(interp, journal, &told, fault);
    buf_release(&told);
    if (!err)
        err = session_count_labels(session, fault);
    if (!err)
        err = copy_rendition(&p->rendition, session, fault);
    if (!err)
        err = slicing_panel(&p->mosaic, session, MOSAIC_SIDE, MOSAIC_SIDE, true, fault);
    if (!err)
        p->hues = shown_hues(p->hue, session);
    return err;
}

/* ---- the painter, and chafa ---- */

static enum err time_painter(const struct pictures *p, struct figures *f, struct fault *fault)
{
    const struct image_view rendition = view_of(p, &p->rendition), mosaic = view_of(p, &p->mosaic);
    bool good = true;
    for (int m = 0; good && m < MEANS; m++) {
        const struct graphics *by = graphics_auto.of[m];
        good = bench_painter_whole(&f->cost[RENDITION][m], by, &rendition) &&
               bench_painter_whole(&f->cost[MOSAIC][m], by, &mosaic);
        /* an edit in blocks is a few cells: as coarse as that, there is no patch of 40x40 */
        if (good && by->kind == GRAPHICS_PIXELS)
            good = bench_painter_patches(&f->cost[PATCH][m], by, &rendition);
    }
    return good ? OK : fault_memory(fault, "a picture for the terminal");
}

static enum err time_chafa(const struct pictures *p, struct figures *f, struct fault *fault)
{
    const struct image_view shown[CHAFA_PICTURES] = {view_of(p, &p->rendition),
                                                     view_of(p, &p->mosaic)};
    enum err err = OK;
    for (int i = 0; !err && i < CHAFA_PICTURES; i++)
        for (int m = 0; !err && m < MEANS; m++) {
            err = bench_chafa(&f->chafa[i][m], graphics_auto.of[m], &shown[i], fault);
            f->has_chafa |= f->chafa[i][m].bytes > 0;
        }
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
                              &f->keys[l][m], fault);
    return err;
}

/* ---- what comes out ---- */

static void print_row(FILE *out, const char *words, const struct bench_cost cost[MEANS_MOST])
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

static void print_key(FILE *out, const char *words, const struct bench_key *key)
{
    fprintf(out, "        %-32s %9.2f %9.2f %9.2f\n", words, key->shown_ms, key->last_ms,
            key->bytes / 1000);
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
        print_row(out, picture_words[i], f->cost[i]);
    for (int i = 0; f->has_chafa && i < CHAFA_PICTURES; i++)
        print_row(out, chafa_words[i], f->chafa[i]);
    if (!f->has_chafa)
        fprintf(out, "    chafa is not installed\n");
    fprintf(out, "the pilot, %dx%d cells of %dx%d pixels: a key, until\n%-41s %9s %9s %9s\n",
            PILOT_COLUMNS, PILOT_ROWS, PILOT_CELL_WIDTH, PILOT_CELL_HEIGHT, "", "shown",
            "last byte", "kB");
    for (int l = 0; l < f->lines; l++) {
        for (int m = 0; m < PILOTED; m++) {
            fprintf(out, "    %s, %s\n", piloted[m]->title, lines[l].words);
            print_key(out, "the cross-hair by a voxel, ms", &f->keys[l][m].move);
            print_key(out, "a seed and its run, ms", &f->keys[l][m].seed);
        }
    }
}

static void add_costs(struct json *json, const char *name, const struct bench_cost cost[MEANS_MOST])
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

static void add_key(struct json *json, const char *name, const struct bench_key *key)
{
    json_object(json, name);
    json_count(json, "keys", key->keys);
    json_fixed(json, "shown_ms", key->shown_ms, 3);
    json_fixed(json, "last_ms", key->last_ms, 3);
    json_fixed(json, "bytes", key->bytes, 0);
    json_end(json);
}

static void add_line(struct json *json, const char *line, const struct bench_keys keys[PILOTED])
{
    char name[32];
    for (int m = 0; m < PILOTED; m++) {
        snprintf(name, sizeof name, "%s_%s", piloted[m]->name, line);
        json_object(json, name);
        add_key(json, "move", &keys[m].move);
        add_key(json, "seed", &keys[m].seed);
        json_end(json);
    }
}

static void print_json(FILE *out, const struct figures *f)
{
    struct buf text = {0};
    struct json json = {.out = &text};
    json_object(&json, NULL);
    json_text(&json, "journal", f->journal);
    for (int i = 0; i < PICTURES; i++)
        add_costs(&json, picture_names[i], f->cost[i]);
    json_object(&json, "chafa");
    for (int i = 0; f->has_chafa && i < CHAFA_PICTURES; i++)
        add_costs(&json, picture_names[i], f->chafa[i]);
    json_end(&json);
    json_object(&json, "pilot");
    for (int l = 0; l < f->lines; l++)
        add_line(&json, lines[l].name, f->keys[l]);
    json_end(&json);
    json_end(&json);
    fputs(buf_text(&text), out);
    buf_release(&text);
}

/* ---- the whole ---- */

static enum err time_pictures(struct figures *f, struct buf *journal, struct fault *fault)
{
    struct interpreter interp;
    struct pictures pictures = {0};
    enum err err = interpreter_init(&interp, fault);
    if (!err)
        err = bench_find_example(journal, &interp, fault);
    if (!err)
        err = make_pictures(&pictures, &interp, buf_text(journal), fault);
    if (!err)
        err = time_painter(&pictures, f, fault);
    if (!err)
        err = time_chafa(&pictures, f, fault);
    interpreter_release(&interp);
    canvas_release(&pictures.rendition);
    canvas_release(&pictures.mosaic);
    return err;
}

enum err run_bench_terminal(const struct options *o, struct fault *fault)
{
    struct buf journal = {0};
    struct figures *f = mem_new(sizeof *f);
    if (!f)
        return fault_memory(fault, "a benchmark");
    enum err err = time_pictures(f, &journal, fault);
    if (!err)
        err = time_pilot(buf_text(&journal), o->quick, f, fault);
    if (!err) {
        snprintf(f->journal, sizeof f->journal, "%s", file_name(buf_text(&journal)));
        (o->json ? print_json : print_table)(stdout, f);
    }
    buf_release(&journal);
    free(f);
    return err;
}
