/* SPDX-License-Identifier: MIT */
/*
 * From a key to the picture: iftty in a terminal of the benchmark's own (far_end.h).
 *
 * First its start: to the prompt, and to the scene ch2 loaded (synth:geom where that is not here).
 * Then the pilot, on the journal examples/brain.iftty (geom.iftty), at once and through lines of
 * 20 Mbit/s and 30 ms round trip and of 2 Mbit/s and 120 ms, in terminals that answer as kitty
 * does, as Ghostty does, and with sixel graphics.
 *
 *     first      the barrier after the first frame of what a key did has arrived; of a key that is
 *                held, 30 times a second, frames that came a second
 *     finest     the last byte of the finest frame; of a key that is held, after the last one
 *     kB         what the program wrote until then
 *     processor  what it had of processors until all was at rest
 *
 * While nobody presses a key, kB are what is sent ahead, and finest is when that ended. Last the
 * same journal is watched: a step is shown when its gesture is, drawn in slices that were not seen
 * before; the finest is what it led to, which comes after a moment.
 *
 * The figures of the first run are stored beside the program, in bench-keys.txt, and later ones
 * printed as shares of them; what has become worse has a line of its own. Remove the file to begin
 * anew. With --program another build is timed, so that two can take turns.
 */
#include "tests/bench/bench.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/json.h"
#include "command/interpreter.h"
#include "tests/bench/times.h"
#include "tests/bench/far_end.h"

enum { KEYS_MOST = 24, STARTS = 9, JOURNAL_MOST = 64 << 20, STORED_MOST = 1 << 20 };

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

enum {
    ENTER,
    MOVE,
    SLICE,
    SEEN,
    TURN,
    ZOOM,
    SEED,
    HELD_MOVE,
    HELD_SLICE,
    HELD_TURN,
    IDLE,
    STEP,
    BACK,
    KINDS
};
static const struct words key_words[KINDS] = {
    [ENTER] = {"enter", "the pilot begins"},
    [MOVE] = {"move", "l: the cross-hair by a voxel"},
    [SLICE] = {"slice", "K: the next slice"},
    [SEEN] = {"seen", "J: back to a slice seen before"},
    [TURN] = {"turn", "r: turning the rendition"},
    [ZOOM] = {"zoom", "z: the rendition nearer"},
    [SEED] = {"seed", "s: a seed and its run"},
    [HELD_MOVE] = {"held_move", "l held: frames a second"},
    [HELD_SLICE] = {"held_slice", "K held: frames a second"},
    [HELD_TURN] = {"held_turn", "r held: frames a second"},
    [IDLE] = {"idle", "no key for ten seconds"},
    [STEP] = {"step", "watching: a step on"},
    [BACK] = {"step_back", "watching: a step back"}};

/* Less is better, but of frames a second; what is below `noise` says nothing. */
enum { FIRST, FINEST, BYTES, PROCESSOR, COLUMNS };
static const struct column {
    const char *name, *text;
    double noise;
} column_words[COLUMNS] = {[FIRST] = {"first_ms", "first", 5},
                           [FINEST] = {"finest_ms", "finest", 10},
                           [BYTES] = {"kilobytes", "kB", 1},
                           [PROCESSOR] = {"processor_ms", "processor", 5}};

static const struct line_kind {
    const char *name, *text;
    struct far_line line;
    unsigned keys; /* at most KEYS_MOST */
} lines[] = {{"local", "no line", {0, 0}, 16},
             {"fast", "20 Mbit/s, 30 ms round trip", {20e6, 15}, 12},
             {"slow", "2 Mbit/s, 120 ms round trip", {2e6, 60}, 6}};
enum { LINES = sizeof lines / sizeof lines[0], PILOTED = 3, QUICK_KEYS = 4 };
static const struct graphics *const piloted[PILOTED] = {&graphics_kitty, &graphics_tiles,
                                                        &graphics_sixel};
enum { HELD_MS = 33, HELD_FOR_MS = 1500, IDLE_MS = 10000 };

/* Medians over the keys. */
struct key_figures {
    unsigned keys; /* 0: not timed */
    double of[COLUMNS];
};

struct figures {
    const char *program; /* NULL: that of this tree */
    const char *only;    /* pilots with this in their names; NULL: all */
    bool quick;
    struct buf journal, scene; /* paths */
    double start_ms[MOMENTS][STARTS];
    unsigned starts; /* that were timed */
    struct key_figures key[LINES][PILOTED][KINDS];
};

struct pilot_name {
    char text[32];
};

static struct pilot_name name_of(unsigned line, unsigned pilot)
{
    struct pilot_name name;
    snprintf(name.text, sizeof name.text, "%s_%s", piloted[pilot]->name, lines[line].name);
    return name;
}

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
        err = far_end_new(&e, f->program, argument, folder, NULL, &line, fault);
    if (!err)
        err = far_end_press(e, "", awaited, &result, fault);
    for (int m = 0; !err && m < MOMENTS; m++)
        f->start_ms[m][f->starts] = times_between(result.pressed_ns, result.came_ns[2 * m]);
    f->starts += !err;
    far_end_free(e);
    buf_release(&journal);
    return err;
}

static enum err time_starts(struct figures *f, struct fault *fault)
{
    enum err err = OK;
    while (!err && f->starts < (f->quick ? 1 : STARTS)) {
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
    double of[COLUMNS][KEYS_MOST];
    unsigned keys;
};

static enum err press(struct far_end *e, const char *keys, const char *const *awaited,
                      struct fault *fault)
{
    struct far_result result;
    return far_end_press(e, keys, awaited, &result, fault);
}

/* But for what came first. */
static void take_result(double of[COLUMNS], const struct far_result *result)
{
    of[FINEST] = result->last_ns > result->pressed_ns
                     ? times_between(result->pressed_ns, result->last_ns)
                     : 0;
    of[BYTES] = (double)result->bytes / 1000;
    of[PROCESSOR] = (double)result->processor_ns / 1e6;
}

static enum err timed_press(struct far_end *e, const char *keys, struct times *t,
                            struct fault *fault)
{
    struct far_result result;
    const enum err err = far_end_press(e, keys, frame, &result, fault);
    double of[COLUMNS] = {[FIRST] = times_between(result.pressed_ns, result.came_ns[1])};
    take_result(of, &result);
    for (int c = 0; c < COLUMNS; c++)
        t->of[c][t->keys] = of[c];
    t->keys++;
    return err;
}

static struct key_figures medians(struct times *t)
{
    struct key_figures figures = {.keys = t->keys};
    for (int c = 0; c < COLUMNS; c++)
        figures.of[c] = times_median(t->of[c], t->keys);
    return figures;
}

/* Presses both keys in turn, `keys` times in all. */
static enum err press_in_turn(struct far_end *e, const char *on, const char *back, unsigned keys,
                              struct key_figures *out, struct fault *fault)
{
    struct times times = {.keys = 0};
    enum err err = OK;
    for (unsigned i = 0; !err && i < keys; i++)
        err = timed_press(e, i % 2 ? back : on, &times, fault);
    *out = medians(&times);
    return err;
}

/* Each seed is at another place and undone, with a fixed radius, the same in every build. */
static enum err plant(struct far_end *e, unsigned keys, struct key_figures *out,
                      struct fault *fault)
{
    static const char *const ways[] = {"7l", "6k", "9h", "5K", "8j", "7J", "4h", "9k"};
    struct times times = {.keys = 0};
    enum err err = press(e, "99-", frame, fault);
    if (!err)
        err = press(e, "3+", frame, fault);
    for (unsigned i = 0; !err && i < keys; i++) {
        err = press(e, ways[i % 8], frame, fault);
        if (!err)
            err = timed_press(e, i % 2 ? "s2" : "s3", &times, fault);
        if (!err)
            err = press(e, "u", frame, fault);
    }
    *out = medians(&times);
    return err;
}

static enum err hold(struct far_end *e, const char *key, struct key_figures *out,
                     struct fault *fault)
{
    struct far_result result;
    const enum err err = far_end_hold(e, key, HELD_FOR_MS / HELD_MS, HELD_MS, &result, fault);
    *out =
        (struct key_figures){.keys = 1, .of = {[FIRST] = result.frames / (HELD_FOR_MS / 1000.0)}};
    take_result(out->of, &result);
    return err;
}

static enum err rest(struct far_end *e, struct key_figures *out, struct fault *fault)
{
    struct far_result result;
    const enum err err = far_end_wait(e, IDLE_MS, &result, fault);
    *out = (struct key_figures){.keys = 1};
    take_result(out->of, &result);
    return err;
}

static enum err press_all(struct far_end *e, unsigned keys, struct key_figures out[KINDS],
                          struct fault *fault)
{
    struct times enter = {.keys = 0};
    enum err err = press(e, "", prompt, fault);
    if (!err)
        err = press(e, "auto on\r", prompt, fault);
    if (!err)
        err = timed_press(e, "pilot\r", &enter, fault);
    out[ENTER] = medians(&enter);
    if (!err)
        err = press(e, "5l", frame, fault);
    if (!err)
        err = press_in_turn(e, "l", "l", keys, &out[MOVE], fault);
    if (!err)
        err = press_in_turn(e, "K", "K", keys, &out[SLICE], fault);
    if (!err)
        err = press_in_turn(e, "J", "J", keys, &out[SEEN], fault);
    if (!err)
        err = press_in_turn(e, "r", "r", keys, &out[TURN], fault);
    if (!err)
        err = press_in_turn(e, "z", "Z", keys, &out[ZOOM], fault);
    if (!err)
        err = plant(e, keys / 2, &out[SEED], fault);
    if (!err)
        err = hold(e, "l", &out[HELD_MOVE], fault);
    if (!err)
        err = hold(e, "K", &out[HELD_SLICE], fault);
    if (!err)
        err = hold(e, "r", &out[HELD_TURN], fault);
    return err ? err : rest(e, &out[IDLE], fault);
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
static enum err time_steps(const struct figures *f, const char *path, const char *home,
                           const struct graphics *graphics, const struct far_line *line,
                           unsigned keys, struct key_figures out[KINDS], struct fault *fault)
{
    struct far_end *e = NULL;
    char copy[PATH_MAX];
    snprintf(copy, sizeof copy, "%s", path);
    char watch[] = "watch";
    char *const argument[] = {"iftty", watch, copy, NULL};
    enum err err = far_end_new(&e, f->program, argument, home, graphics, line, fault);
    if (!err)
        err = press(e, "", frame, fault);
    if (!err)
        err = press(e, "8G", frame, fault);
    if (!err)
        err = press_in_turn(e, " ", " ", keys, &out[STEP], fault);
    if (!err)
        err = press_in_turn(e, "\177", "\177", keys, &out[BACK], fault);
    far_end_free(e);
    return err;
}

static enum err time_keys(const struct figures *f, const struct graphics *graphics,
                          const struct far_line *line, unsigned keys, struct key_figures out[KINDS],
                          struct fault *fault)
{
    struct buf folder = {0}, path = {0};
    struct far_end *e = NULL;
    enum err err = copy_journal(&folder, &path, buf_text(&f->journal), fault);
    char *const argument[] = {"iftty", path.data, NULL};
    if (!err)
        err = far_end_new(&e, f->program, argument, buf_text(&folder), graphics, line, fault);
    if (!err)
        err = press_all(e, keys, out, fault);
    far_end_free(e);
    if (!err)
        err =
            time_steps(f, buf_text(&path), buf_text(&folder), graphics, line, keys / 3, out, fault);
    if (folder.length)
        folder_remove(buf_text(&folder));
    buf_release(&folder);
    buf_release(&path);
    return err;
}

static enum err time_pilot(struct figures *f, struct fault *fault)
{
    enum err err = OK;
    for (unsigned l = 0; !err && l < (f->quick && !f->only ? 1 : LINES); l++)
        for (unsigned p = 0; !err && p < PILOTED; p++)
            if (!f->only || strstr(name_of(l, p).text, f->only))
                err = time_keys(f, piloted[p], &lines[l].line,
                                f->quick ? QUICK_KEYS : lines[l].keys, f->key[l][p], fault);
    return err;
}

/* ---- the first run ---- */

/* A line for each row: "kitty_slow turn 268.000 682.000 31.000 52.000". */
struct stored {
    struct buf path, text;
};

static bool is_held(int kind)
{
    return kind >= HELD_MOVE && kind <= HELD_TURN;
}

/* False where the first run had no such row. */
static bool stored_find(const struct stored *stored, const char *pilot, int kind,
                        double of[COLUMNS])
{
    char row[64];
    snprintf(row, sizeof row, "%s %s ", pilot, key_words[kind].name);
    const char *at = strstr(buf_text(&stored->text), row);
    if (!at)
        return false;
    char *end;
    at += strlen(row);
    for (int c = 0; c < COLUMNS; c++, at = end)
        of[c] = strtod(at, &end);
    return true;
}

/* Reads what is there, and stores what was not. */
static enum err stored_read(struct stored *stored, const struct figures *f, struct fault *fault)
{
    struct buf more = {0}, folder = {0};
    double of[COLUMNS];
    enum err err = file_program_folder(&folder, fault);
    buf_printf(&stored->path, "%s/../../bench-keys.txt", buf_text(&folder));
    if (!err && file_exists(buf_text(&stored->path)))
        err = file_read(&stored->text, buf_text(&stored->path), STORED_MOST, fault);
    buf_add_text(&more, buf_text(&stored->text));
    for (unsigned l = 0; l < LINES; l++)
        for (unsigned p = 0; p < PILOTED; p++)
            for (int k = 0; k < KINDS; k++) {
                const struct pilot_name name = name_of(l, p);
                if (f->quick || !f->key[l][p][k].keys || stored_find(stored, name.text, k, of))
                    continue;
                buf_printf(&more, "%s %s", name.text, key_words[k].name);
                for (int c = 0; c < COLUMNS; c++)
                    buf_printf(&more, " %.3f", f->key[l][p][k].of[c]);
                buf_add_char(&more, '\n');
            }
    if (!err && more.length > stored->text.length)
        err = file_write(buf_text(&stored->path), more.data, more.length, FILE_REPLACE, fault);
    buf_release(&more);
    buf_release(&folder);
    return err;
}

static void stored_release(struct stored *stored)
{
    buf_release(&stored->path);
    buf_release(&stored->text);
}

/* Worse by a quarter, and by more than noise. */
static bool is_worse(int kind, int c, double now, double then)
{
    return is_held(kind) && c == FIRST ? now < then * 0.8 && now < then - 1
                                       : now > then * 1.25 && now > then + column_words[c].noise;
}

/* ---- what is printed ---- */

static void print_keys(FILE *out, const struct key_figures key[KINDS], const char *pilot,
                       const struct stored *stored)
{
    double then[COLUMNS];
    for (int k = 0; k < KINDS; k++) {
        fprintf(out, "        %-31s", key_words[k].text);
        for (int c = 0; c < COLUMNS; c++)
            fprintf(out, " %9.2f", key[k].of[c]);
        if (stored_find(stored, pilot, k, then))
            for (int c = 0; c < COLUMNS; c++)
                then[c] > 0 ? fprintf(out, " %5.2f", key[k].of[c] / then[c])
                            : fprintf(out, " %5s", "-");
        fprintf(out, "\n");
    }
}

static void print_worse(FILE *out, const struct figures *f, const struct stored *stored)
{
    double then[COLUMNS];
    for (unsigned l = 0; l < LINES; l++)
        for (unsigned p = 0; p < PILOTED; p++)
            for (int k = 0; k < KINDS; k++)
                for (int c = 0; f->key[l][p][k].keys && c < COLUMNS &&
                                stored_find(stored, name_of(l, p).text, k, then);
                     c++)
                    if (is_worse(k, c, f->key[l][p][k].of[c], then[c]))
                        fprintf(out, "worse: %s, %s: %s, %s: %.2f, was %.2f\n", piloted[p]->title,
                                lines[l].text, key_words[k].text, column_words[c].text,
                                f->key[l][p][k].of[c], then[c]);
}

static void print_table(FILE *out, struct figures *f, const struct stored *stored)
{
    fprintf(out, "%s\n%-44s %9s %9s %9s\n", file_name(buf_text(&f->scene)), "", "median", "9 of 10",
            "most");
    for (int m = 0; m < MOMENTS && f->starts; m++)
        fprintf(out, "%-44s %9.2f %9.2f %9.2f  ms\n", moment_words[m].text,
                times_median(f->start_ms[m], f->starts),
                times_quantile(f->start_ms[m], f->starts, 0.9),
                times_quantile(f->start_ms[m], f->starts, 1));
    fprintf(out, "%s, the pilot, %dx%d cells of %dx%d pixels: ms and kB%s\n%-39s",
            file_name(buf_text(&f->journal)), FAR_COLUMNS, FAR_ROWS, FAR_CELL_WIDTH,
            FAR_CELL_HEIGHT, stored->text.length ? ", and of the first run" : "", "");
    for (int c = 0; c < COLUMNS; c++)
        fprintf(out, " %9s", column_words[c].text);
    fprintf(out, "\n");
    for (unsigned l = 0; l < LINES; l++)
        for (unsigned p = 0; p < PILOTED; p++) {
            if (!f->key[l][p][ENTER].keys)
                continue;
            fprintf(out, "    %s, %s\n", piloted[p]->title, lines[l].text);
            print_keys(out, f->key[l][p], name_of(l, p).text, stored);
        }
    print_worse(out, f, stored);
}

static void add_keys(struct json *json, const char *name, const struct key_figures key[KINDS])
{
    json_object(json, name);
    for (int k = 0; k < KINDS; k++) {
        json_object(json, key_words[k].name);
        json_count(json, "keys", key[k].keys);
        for (int c = 0; c < COLUMNS; c++)
            json_fixed(json, is_held(k) && c == FIRST ? "frames_a_second" : column_words[c].name,
                       key[k].of[c], 3);
        json_end(json);
    }
    json_end(json);
}

static void print_json(FILE *out, struct figures *f)
{
    struct buf text = {0};
    struct json json = {.out = &text};
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
    for (unsigned l = 0; l < LINES; l++)
        for (unsigned p = 0; p < PILOTED; p++)
            if (f->key[l][p][ENTER].keys)
                add_keys(&json, name_of(l, p).text, f->key[l][p]);
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
    struct figures f = {.program = bench_options(o)->program,
                        .only = o->words ? o->word[0] : NULL,
                        .quick = bench_options(o)->quick};
    struct stored stored = {{0}, {0}};
    enum err err = find_files(&f, fault);
    if (!err && !f.only)
        err = time_starts(&f, fault);
    if (!err)
        err = time_pilot(&f, fault);
    if (!err)
        err = stored_read(&stored, &f, fault);
    if (!err && o->json)
        print_json(stdout, &f);
    else if (!err)
        print_table(stdout, &f, &stored);
    stored_release(&stored);
    buf_release(&f.journal);
    buf_release(&f.scene);
    return err;
}
