/*
 * From a key to the picture: iftty in a terminal of the benchmark's own (far_end.h).
 *
 * First its start: to the prompt, and to the scene ch2 loaded (synth:geom where that is not here).
 * Then the pilot, on the journal examples/brain.iftty (geom.iftty), at once and through a line of
 * 2 Mbit/s and 120 ms round trip, in terminals that answer as kitty does, as Ghostty does, and with
 * sixel graphics. A key is shown when the barrier after the first frame of what it did has arrived;
 * the last byte is that of the finest frame. A key that is held comes 30 times a second: the frames
 * that came a second, and how long after the last key the last byte did. Last the same journal is
 * watched: a step is shown when its gesture is, drawn in slices that were not seen before; the last
 * byte is that of what it led to, which comes after a moment.
 */
#include "tests/bench/bench.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/file.h"
#include "base/json.h"
#include "command/files.h"
#include "command/interpreter.h"
#include "program/times.h"
#include "tests/bench/far_end.h"

enum { KEYS_MOST = 24, STARTS = 9, JOURNAL_MOST = 64 << 20 };

/* A frame that shows something ends with rows of text, and then the barrier. */
static const char *const prompt[] = {"> ", NULL}, *const frame[] = {"\033[K", "\033[c", NULL};

/* ---- rows and columns of the tables ---- */

struct words {
    const char *name, *text; /* in JSON and in the table */
};

enum { TO_PROMPT, TO_LOADED, MOMENTS };
static const struct words moment_words[MOMENTS] = {
    [TO_PROMPT] = {"start_to_prompt_ms", "start to prompt"},
    [TO_LOADED] = {"start_to_loaded_ms", "start to scene loaded"}};

enum { ENTER, MOVE, SEEN, SEED, HELD, STEP, BACK, KINDS };
static const struct words key_words[KINDS] = {[ENTER] = {"enter", "the pilot begins"},
                                              [MOVE] = {"move", "the cross-hair by a voxel"},
                                              [SEEN] = {"seen", "back to a slice seen before"},
                                              [SEED] = {"seed", "a seed and its run"},
                                              [HELD] = {"held", "a key held: frames a second"},
                                              [STEP] = {"step", "watching: a step on"},
                                              [BACK] = {"step_back", "watching: a step back"}};

static const struct line_kind {
    const char *name, *text;
    struct far_line line;
    unsigned keys; /* at most KEYS_MOST */
} lines[] = {{"local", "no line", {0, 0}, KEYS_MOST},
             {"slow", "2 Mbit/s, 120 ms round trip", {2e6, 60}, 10}};
enum { LINES = sizeof lines / sizeof lines[0], PILOTED = 3, QUICK_KEYS = 4 };
static const struct graphics *const piloted[PILOTED] = {&graphics_kitty, &graphics_tiles,
                                                        &graphics_sixel};
enum { HELD_MS = 33 };

/* Medians over the keys; in the place of shown_ms, of a key that is held, frames a second. */
struct key_figures {
    unsigned keys;
    double shown_ms, last_ms, bytes;
};

struct figures {
    struct buf journal, scene; /* paths */
    double start_ms[MOMENTS][STARTS];
    unsigned starts, lines; /* that were timed */
    struct key_figures key[LINES][PILOTED][KINDS];
};

/* ---- the start ---- */

/* The journal of this session goes with the folder. */
static enum err time_start(struct figures *f, const char *folder, struct fault *fault)
{
    static const char *const awaited[] = {"> ", "voxels of", "> ", NULL};
    static const struct far_line line = {0, 0};
    struct far_end *e = NULL;
    struct far_result result;
    struct buf journal = {0};
    buf_printf(&journal, "%s/bench.iftty", folder);
    char *const argument[] = {"iftty", "--journal", journal.data, f->scene.data, NULL};
    enum err err = journal.failed ? fault_memory(fault, "a path") : OK;
    if (!err)
        err = far_end_new(&e, argument, folder, NULL, &line, fault);
    if (!err)
        err = far_end_press(e, "", awaited, &result, fault);
    for (int m = 0; !err && m < MOMENTS; m++)
        f->start_ms[m][f->starts] = times_between(result.pressed_ns, result.came_ns[2 * m]);
    f->starts += !err;
    far_end_free(e);
    buf_release(&journal);
    return err;
}

static enum err time_starts(struct figures *f, unsigned starts, struct fault *fault)
{
    enum err err = OK;
    while (!err && f->starts < starts) {
        struct buf folder = {0};
        err = folder_fresh(&folder, NULL, fault);
        if (err)
            return err;
        err = time_start(f, buf_text(&folder), fault);
        folder_remove(buf_text(&folder));
        buf_release(&folder);
    }
    return err;
}

/* ---- the pilot ---- */

struct times {
    double shown_ms[KEYS_MOST], last_ms[KEYS_MOST], bytes[KEYS_MOST];
    unsigned keys;
};

static enum err press(struct far_end *e, const char *keys, const char *const *awaited,
                      struct fault *fault)
{
    struct far_result result;
    return far_end_press(e, keys, awaited, &result, fault);
}

static enum err timed_press(struct far_end *e, const char *keys, struct times *t,
                            struct fault *fault)
{
    struct far_result result;
    const enum err err = far_end_press(e, keys, frame, &result, fault);
    t->shown_ms[t->keys] = times_between(result.pressed_ns, result.came_ns[1]);
    t->last_ms[t->keys] = times_between(result.pressed_ns, result.last_ns);
    t->bytes[t->keys++] = (double)result.bytes;
    return err;
}

static struct key_figures medians(struct times *t)
{
    return (struct key_figures){t->keys, times_median(t->shown_ms, t->keys),
                                times_median(t->last_ms, t->keys), times_median(t->bytes, t->keys)};
}

static enum err enter_pilot(struct far_end *e, struct times *enter, struct fault *fault)
{
    enum err err = press(e, "", prompt, fault);
    if (!err)
        err = press(e, "auto on\r", prompt, fault);
    if (!err)
        err = timed_press(e, "pilot\r", enter, fault);
    return err ? err : press(e, "5l", frame, fault);
}

static enum err hold(struct far_end *e, unsigned keys, struct key_figures *out, struct fault *fault)
{
    struct far_result result;
    const enum err err = far_end_hold(e, "j", 3 * keys, HELD_MS, &result, fault);
    *out = (struct key_figures){3 * keys, result.frames / (3 * keys * HELD_MS / 1000.0),
                                times_between(result.pressed_ns, result.last_ns),
                                (double)result.bytes};
    return err;
}

/* Each seed at another place, and taken back. */
static enum err press_all(struct far_end *e, unsigned keys, struct key_figures out[KINDS],
                          struct fault *fault)
{
    static const char *const ways[] = {"7l", "6k", "9h", "5K", "8j", "7J", "4h", "9k"};
    struct times enter = {.keys = 0}, moves = {.keys = 0}, seen = {.keys = 0}, seeds = {.keys = 0};
    enum err err = enter_pilot(e, &enter, fault);
    for (unsigned i = 0; !err && i < keys; i++)
        err = timed_press(e, i % 8 < 4 ? "l" : "k", &moves, fault);
    for (unsigned i = 0; !err && i < keys; i++)
        err = timed_press(e, i % 2 ? "J" : "K", &seen, fault);
    for (unsigned i = 0; !err && i < keys / 2; i++) {
        err = press(e, ways[i % 8], frame, fault);
        if (!err)
            err = timed_press(e, i % 2 ? "s2" : "s3", &seeds, fault);
        if (!err)
            err = press(e, "u", frame, fault);
    }
    out[ENTER] = medians(&enter);
    out[MOVE] = medians(&moves);
    out[SEEN] = medians(&seen);
    out[SEED] = medians(&seeds);
    return err ? err : hold(e, keys, &out[HELD], fault);
}

/* A copy of the journal in a folder of its own, which becomes the program's home. */
static enum err copy_journal(struct buf *folder, struct buf *path, const char *journal,
                             struct fault *fault)
{
    struct buf bytes = {0};
    enum err err = folder_fresh(folder, NULL, fault);
    if (!err)
        err = file_read(&bytes, journal, JOURNAL_MOST, fault);
    buf_printf(path, "%s/%s", buf_text(folder), file_name(journal));
    if (!err && path->failed)
        err = fault_memory(fault, "a path");
    if (!err)
        err = file_write(buf_text(path), bytes.data, bytes.length, FILE_KEEP, fault);
    buf_release(&bytes);
    return err;
}

/* Corrections, each at another place; and those back. */
static enum err time_steps(const char *path, const char *home, const struct graphics *graphics,
                           const struct far_line *line, unsigned keys,
                           struct key_figures out[KINDS], struct fault *fault)
{
    struct times on = {.keys = 0}, back = {.keys = 0};
    struct far_end *e = NULL;
    char copy[PATH_MAX];
    snprintf(copy, sizeof copy, "%s", path);
    char watch[] = "watch";
    char *const argument[] = {"iftty", watch, copy, NULL};
    enum err err = far_end_new(&e, argument, home, graphics, line, fault);
    if (!err)
        err = press(e, "", frame, fault);
    if (!err)
        err = press(e, "8G", frame, fault);
    for (unsigned i = 0; !err && i < keys; i++)
        err = timed_press(e, " ", &on, fault);
    for (unsigned i = 0; !err && i < keys; i++)
        err = timed_press(e, "\177", &back, fault);
    out[STEP] = medians(&on);
    out[BACK] = medians(&back);
    far_end_free(e);
    return err;
}

static enum err time_keys(const char *journal, const struct graphics *graphics,
                          const struct far_line *line, unsigned keys, struct key_figures out[KINDS],
                          struct fault *fault)
{
    struct buf folder = {0}, path = {0};
    struct far_end *e = NULL;
    enum err err = copy_journal(&folder, &path, journal, fault);
    char *const argument[] = {"iftty", path.data, NULL};
    if (!err)
        err = far_end_new(&e, argument, buf_text(&folder), graphics, line, fault);
    if (!err)
        err = press_all(e, keys, out, fault);
    far_end_free(e);
    if (!err)
        err = time_steps(buf_text(&path), buf_text(&folder), graphics, line, keys, out, fault);
    if (folder.length)
        folder_remove(buf_text(&folder));
    buf_release(&folder);
    buf_release(&path);
    return err;
}

static enum err time_pilot(struct figures *f, bool quick, struct fault *fault)
{
    enum err err = OK;
    f->lines = quick ? 1 : LINES;
    for (unsigned l = 0; !err && l < f->lines; l++)
        for (int p = 0; !err && p < PILOTED; p++)
            err = time_keys(buf_text(&f->journal), piloted[p], &lines[l].line,
                            quick ? QUICK_KEYS : lines[l].keys, f->key[l][p], fault);
    return err;
}

/* ---- what is printed ---- */

static void print_keys(FILE *out, const struct key_figures key[KINDS])
{
    for (int k = 0; k < KINDS; k++)
        fprintf(out, "        %-32s %9.2f %9.2f %9.2f\n", key_words[k].text, key[k].shown_ms,
                key[k].last_ms, key[k].bytes / 1000);
}

static void print_table(FILE *out, struct figures *f)
{
    fprintf(out, "%s\n%-44s %9s %9s %9s\n", file_name(buf_text(&f->scene)), "", "median", "9 of 10",
            "most");
    for (int m = 0; m < MOMENTS; m++)
        fprintf(out, "%-44s %9.2f %9.2f %9.2f  ms\n", moment_words[m].text,
                times_median(f->start_ms[m], f->starts),
                times_quantile(f->start_ms[m], f->starts, 0.9),
                times_quantile(f->start_ms[m], f->starts, 1));
    fprintf(out, "%s, the pilot, %dx%d cells of %dx%d pixels: a key, until\n%-41s %9s %9s %9s\n",
            file_name(buf_text(&f->journal)), FAR_COLUMNS, FAR_ROWS, FAR_CELL_WIDTH,
            FAR_CELL_HEIGHT, "", "shown", "last byte", "kB");
    for (unsigned l = 0; l < f->lines; l++)
        for (int p = 0; p < PILOTED; p++) {
            fprintf(out, "    %s, %s\n", piloted[p]->title, lines[l].text);
            print_keys(out, f->key[l][p]);
        }
}

static void add_keys(struct json *json, const char *name, const struct key_figures key[KINDS])
{
    json_object(json, name);
    for (int k = 0; k < KINDS; k++) {
        json_object(json, key_words[k].name);
        json_count(json, "keys", key[k].keys);
        json_fixed(json, "shown_ms", key[k].shown_ms, 3);
        json_fixed(json, "last_ms", key[k].last_ms, 3);
        json_fixed(json, "bytes", key[k].bytes, 0);
        json_end(json);
    }
    json_end(json);
}

static void print_json(FILE *out, struct figures *f)
{
    struct buf text = {0};
    struct json json = {.out = &text};
    char name[32];
    json_object(&json, NULL);
    json_text(&json, "scene", file_name(buf_text(&f->scene)));
    for (int m = 0; m < MOMENTS; m++) {
        json_object(&json, moment_words[m].name);
        json_fixed(&json, "median", times_median(f->start_ms[m], f->starts), 3);
        json_fixed(&json, "most", times_quantile(f->start_ms[m], f->starts, 1), 3);
        json_end(&json);
    }
    json_text(&json, "journal", file_name(buf_text(&f->journal)));
    json_object(&json, "pilot");
    for (unsigned l = 0; l < f->lines; l++)
        for (int p = 0; p < PILOTED; p++) {
            snprintf(name, sizeof name, "%s_%s", piloted[p]->name, lines[l].name);
            add_keys(&json, name, f->key[l][p]);
        }
    json_end(&json);
    json_end(&json);
    fputs(buf_text(&text), out);
    buf_release(&text);
}

/* ---- the whole ---- */

static enum err find_files(struct figures *f, struct fault *fault)
{
    struct interpreter interp;
    enum err err = interpreter_init(&interp, fault);
    if (!err)
        err = bench_find_example(&f->journal, &interp, fault);
    if (!err && interpreter_find_scene(&interp, "ch2.nii.gz", false, &f->scene, NULL))
        err = interpreter_find_scene(&interp, "synth:geom", false, &f->scene, fault);
    interpreter_release(&interp);
    return err;
}

enum err run_keys(const struct options *o, struct fault *fault)
{
    const bool quick = bench_options(o)->quick;
    struct figures f = {.starts = 0};
    enum err err = find_files(&f, fault);
    if (!err)
        err = time_starts(&f, quick ? 1 : STARTS, fault);
    if (!err)
        err = time_pilot(&f, quick, fault);
    if (!err)
        (o->json ? print_json : print_table)(stdout, &f);
    buf_release(&f.journal);
    buf_release(&f.scene);
    return err;
}
