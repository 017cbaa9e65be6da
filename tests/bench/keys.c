/* SPDX-License-Identifier: MIT */
/* From a key to the picture: iftty in a terminal of the benchmark's own (far_end.h).
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
 * While nobody presses a key, kB are what is sent ahead, and finest is when that ended. Then the
 * same journal is watched: a step is shown when its gesture is, drawn in slices that were not seen
 * before; the finest is what it led to, which comes after a moment.
 *
 * Last a new session is begun on the scene, some times: gestures that change much of it, each
 * undone and repeated. The first picture is that with the answer, of the finished forest.
 *
 * The figures of the first run are stored beside the program, in bench-keys.txt, and later ones
 * printed as shares of them; what has become worse has a line of its own. Remove the file to begin
 * anew. With --program another build is timed, so that two can take turns. */
#include "tests/bench/bench.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "tests/bench/times.h"
#include "tests/bench/far_end.h"

enum {
    KEYS_MOST = 24,
    STARTS = 9,
    SESSIONS = 3,
    MEANWHILES = 6,
    JOURNAL_MOST = 64 << 20,
    STORED_MOST = 1 << 20
};

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
    WINDOW,
    MAGNIFY,
    LOAD,
    DRAG,
    DROP,
    PLANT,
    HELD_MOVE,
    HELD_SLICE,
    HELD_TURN,
    HELD_DRAG,
    HELD_PEN,
    PEN_GAP,
    IDLE,
    STEP,
    BACK,
    BALL,
    BALL_UNDO,
    BALL_REDO,
    AROUND,
    AROUND_UNDO,
    AROUND_REDO,
    STROKE,
    STROKE_UNDO,
    STROKE_REDO,
    HINT,
    HEAT,
    MEANWHILE,
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
    [WINDOW] = {"window", "w: the window wider"},
    [MAGNIFY] = {"magnify", "]: slices larger"},
    [LOAD] = {"outline", "U: the outline of a label"},
    [DRAG] = {"outline_drag", "l: dragging it by a voxel"},
    [DROP] = {"outline_drop", "Escape: dropping it"},
    [PLANT] = {"outline_plant", "Enter: planting it"},
    [HELD_MOVE] = {"held_move", "l held: frames a second"},
    [HELD_SLICE] = {"held_slice", "K held: frames a second"},
    [HELD_TURN] = {"held_turn", "r held: frames a second"},
    [HELD_DRAG] = {"held_drag", "l held, dragging: frames a second"},
    [HELD_PEN] = {"held_pen", "h held, the pen down: frames a second"},
    [PEN_GAP] = {"held_pen_gap", "and the longest time without one"},
    [IDLE] = {"idle", "no key for ten seconds"},
    [STEP] = {"step", "watching: a step on"},
    [BACK] = {"step_back", "watching: a step back"},
    [BALL] = {"ball", "i: the first ball"},
    [BALL_UNDO] = {"ball_undo", "u: undo of it"},
    [BALL_REDO] = {"ball_redo", "Ctrl-R: redo of it"},
    [AROUND] = {"background", "s0: a ball of background"},
    [AROUND_UNDO] = {"background_undo", "u: undo of it"},
    [AROUND_REDO] = {"background_redo", "Ctrl-R: redo of it"},
    [STROKE] = {"stroke", "i: a stroke through a leak"},
    [STROKE_UNDO] = {"stroke_undo", "u: undo of it"},
    [STROKE_REDO] = {"stroke_redo", "Ctrl-R: redo of it"},
    [HINT] = {"hint", "): the first hint"},
    [HEAT] = {"heat", "gh: heat"},
    [MEANWHILE] = {"meanwhile", "+: while labels are finished"}};

/* Less is better, but of frames a second; what is below `noise` says nothing. */
enum { FIRST, FINEST, BYTES, PROCESSOR, COLUMNS };
static const struct column {
    const char *name, *text;
    double noise;
} column_words[COLUMNS] = {[FIRST] = {"first_ms", "first", 5},
                           [FINEST] = {"finest_ms", "finest", 10},
                           [BYTES] = {"kilobytes", "kB", 1},
                           [PROCESSOR] = {"processor_ms", "processor", 5}};

enum { HELD_MS = 33, STILL_MS = 250, QUICK_STILL_MS = 20 };

static const struct line_kind {
    const char *name, *text;
    struct far_line line;
    unsigned keys; /* at most KEYS_MOST */
} lines[] = {{"local", "no line", {0, 0, STILL_MS}, 16},
             {"fast", "20 Mbit/s, 30 ms round trip", {20e6, 15, STILL_MS}, 12},
             {"slow", "2 Mbit/s, 120 ms round trip", {2e6, 60, STILL_MS}, 6}};
enum { LINES = sizeof lines / sizeof lines[0], PILOTED = 3, QUICK_KEYS = 3 };
static const struct graphics *const piloted[PILOTED] = {&graphics_kitty, &graphics_tiles,
                                                        &graphics_sixel};

static unsigned held_for_ms = 1500, idle_ms = 10000;

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
    struct times start[MOMENTS];
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

static void time_start(struct figures *f)
{
    static const char *const awaited[] = {"> ", "voxels of", "> ", NULL};
    struct far_end *e = NULL;
    struct far_result result;
    const char *folder = bench_folder(NULL);
    char journal[PATH_MAX];
    snprintf(journal, sizeof journal, "%s/bench.iftty", folder);
    char *const argument[] = {"iftty", "--journal", journal, f->scene.data, NULL};
    must(far_end_new(&e, f->program, argument, folder, NULL, &lines[0].line, &bench_fault));
    must(far_end_press(e, "", awaited, &result, &bench_fault));
    for (int m = 0; m < MOMENTS; m++)
        f->start[m].ms[f->start[m].count++] =
            times_between(result.pressed_ns, result.came_ns[2 * m]);
    far_end_free(e);
}

/* ---- the pilot ---- */

struct pressed {
    double of[COLUMNS][KEYS_MOST];
    unsigned keys;
};

static void press(struct far_end *e, const char *keys, const char *const *awaited)
{
    struct far_result result;
    must(far_end_press(e, keys, awaited, &result, &bench_fault));
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

/* The first picture is that with a row that has the word. */
static void press_until(struct far_end *e, const char *keys, const char *word, struct pressed *p)
{
    const char *const awaited[] = {word, "\033[c", NULL};
    struct far_result result;
    must(far_end_press(e, keys, awaited, &result, &bench_fault));
    double of[COLUMNS] = {[FIRST] = times_between(result.pressed_ns, result.came_ns[1])};
    take_result(of, &result);
    for (int c = 0; c < COLUMNS; c++)
        p->of[c][p->keys] = of[c];
    p->keys++;
}

static void timed_press(struct far_end *e, const char *keys, struct pressed *p)
{
    press_until(e, keys, frame[0], p);
}

static struct key_figures medians(struct pressed *p)
{
    struct key_figures figures = {.keys = p->keys};
    for (int c = 0; c < COLUMNS; c++)
        figures.of[c] = times_median(p->of[c], p->keys);
    return figures;
}

/* Presses both keys in turn, `keys` times in all. */
static struct key_figures press_in_turn(struct far_end *e, const char *on, const char *back,
                                        unsigned keys)
{
    struct pressed pressed = {.keys = 0};
    for (unsigned i = 0; i < keys; i++)
        timed_press(e, i % 2 ? back : on, &pressed);
    return medians(&pressed);
}

/* Each seed is at another place and undone, with a fixed radius, the same in every build. */
static struct key_figures plant(struct far_end *e, unsigned keys)
{
    static const char *const ways[] = {"7l", "6k", "9h", "5K", "8j", "7J", "4h", "9k"};
    struct pressed pressed = {.keys = 0};
    press(e, "99-", frame);
    press(e, "3+", frame);
    for (unsigned i = 0; i < keys; i++) {
        press(e, ways[i % 8], frame);
        timed_press(e, i % 2 ? "s2" : "s3", &pressed);
        press(e, "u", frame);
    }
    return medians(&pressed);
}

/* Loads the outline of the label, drags it by three voxels and drops it, or plants it, which is
 * undone. */
static void outline(struct far_end *e, unsigned keys, struct key_figures out[KINDS])
{
    struct pressed load = {.keys = 0}, drag = {.keys = 0}, end[2] = {{.keys = 0}};
    press(e, "1b", frame);
    press(e, "gc", frame);
    for (unsigned i = 0; i < keys; i++) {
        timed_press(e, "U", &load);
        press(e, "v", frame);
        for (unsigned k = 0; k < 3; k++)
            timed_press(e, i % 2 ? "h" : "l", &drag);
        press(e, "v", frame);
        timed_press(e, i % 2 ? "\r" : "\033", &end[i % 2]);
        if (i % 2)
            press(e, "u", frame);
    }
    out[LOAD] = medians(&load);
    out[DRAG] = medians(&drag);
    out[DROP] = medians(&end[0]);
    out[PLANT] = medians(&end[1]);
}

static struct key_figures hold(struct far_end *e, const char *key, struct key_figures *gap)
{
    struct far_result result;
    must(far_end_hold(e, key, held_for_ms / HELD_MS, HELD_MS, &result, &bench_fault));
    struct key_figures figures = {.keys = 1,
                                  .of = {[FIRST] = result.frames / (held_for_ms / 1000.0)}};
    take_result(figures.of, &result);
    if (gap)
        *gap = (struct key_figures){.keys = 1, .of = {[FIRST] = (double)result.gap_ns / 1e6}};
    return figures;
}

static struct key_figures rest(struct far_end *e)
{
    struct far_result result;
    must(far_end_wait(e, idle_ms, &result, &bench_fault));
    struct key_figures figures = {.keys = 1};
    take_result(figures.of, &result);
    return figures;
}

static void press_all(struct far_end *e, unsigned keys, struct key_figures out[KINDS])
{
    struct pressed enter = {.keys = 0};
    press(e, "", prompt);
    press(e, "auto on\r", prompt);
    timed_press(e, "pilot\r", &enter);
    out[ENTER] = medians(&enter);
    press(e, "5l", frame);
    out[MOVE] = press_in_turn(e, "l", "l", keys);
    out[SLICE] = press_in_turn(e, "K", "K", keys);
    out[SEEN] = press_in_turn(e, "J", "J", keys);
    out[TURN] = press_in_turn(e, "r", "r", keys);
    out[ZOOM] = press_in_turn(e, "z", "Z", keys);
    out[SEED] = plant(e, keys / 2);
    press(e, "w", frame);
    out[WINDOW] = press_in_turn(e, "\033[C", "\033[C", keys);
    press(e, "\r", frame);
    out[MAGNIFY] = press_in_turn(e, "]", "]", keys);
    press(e, "W", frame);
    outline(e, keys < 6 ? 2 : 4, out);
    out[HELD_MOVE] = hold(e, "l", NULL);
    out[HELD_SLICE] = hold(e, "K", NULL);
    out[HELD_TURN] = hold(e, "r", NULL);
    press(e, "gc", frame);
    press(e, "U", frame);
    press(e, "v", frame);
    out[HELD_DRAG] = hold(e, "l", NULL);
    press(e, "\033", frame);
    press(e, "\033", frame);
    press(e, "3+", frame); /* balls of radius 6 */
    press(e, "v", frame);
    out[HELD_PEN] = hold(e, "h", &out[PEN_GAP]);
    press(e, "\033", frame);
    out[IDLE] = rest(e);
}

/* Corrections, each at another place; and those back. */
static void time_steps(const struct figures *f, char *journal, const char *home,
                       const struct graphics *graphics, const struct far_line *line, unsigned keys,
                       struct key_figures out[KINDS])
{
    struct far_end *e = NULL;
    char *const argument[] = {"iftty", "watch", journal, NULL};
    must(far_end_new(&e, f->program, argument, home, graphics, line, &bench_fault));
    press(e, "", frame);
    press(e, "8G", frame);
    out[STEP] = press_in_turn(e, " ", " ", keys);
    out[BACK] = press_in_turn(e, "\177", "\177", keys);
    far_end_free(e);
}

/* Gestures in a new session; the keys of `way` lead to each. */
static void time_session(struct far_end *e, struct pressed pressed[KINDS])
{
    static const struct {
        int kind;
        const char *way, *keys;
    } gesture[] = {{BALL, "3L", "i"}, {AROUND, "4L", "s0"}, {STROKE, "14Hs080JI14L", "i"}};
    static const char *const loaded[] = {"> ", "voxels of", "> ", NULL};
    static const char changed[] = "changed before";
    struct far_result result;
    press(e, "", loaded);
    press(e, "pilot\r", frame);
    for (size_t i = 0; i < sizeof gesture / sizeof gesture[0]; i++) {
        press(e, gesture[i].way, frame);
        press_until(e, gesture[i].keys, changed, &pressed[gesture[i].kind]);
        press_until(e, "u", "undone", &pressed[gesture[i].kind + 1]);
        press_until(e, "\022", changed, &pressed[gesture[i].kind + 2]);
    }
    press_until(e, ")", "at a cost", &pressed[HINT]);
    press_until(e, "gh", "red, where", &pressed[HEAT]);
    press(e, "gh", frame);
    /* Three states in turn, so that the labels of each are finished again. */
    for (unsigned i = 0; i < MEANWHILES; i++) {
        const char *const awaited[] = {i % 3 ? changed : "undone", "\033[c", NULL};
        must(far_end_press_soon(e, i % 3 ? "\022" : "2u", awaited, &result, &bench_fault));
        must(far_end_wait(e, 90 * i, &result, &bench_fault));
        press_until(e, "+", "the brush", &pressed[MEANWHILE]);
    }
}

static void time_gestures(const struct figures *f, const struct graphics *graphics,
                          const struct far_line *line, struct key_figures out[KINDS])
{
    OWNED(mem_release) struct pressed *pressed = must_have(KINDS * sizeof *pressed);
    for (unsigned i = 0; i < SESSIONS; i++) {
        struct far_end *e = NULL;
        const char *folder = bench_folder(NULL);
        char journal[PATH_MAX];
        snprintf(journal, sizeof journal, "%s/bench.iftty", folder);
        char *const argument[] = {"iftty", "--journal", journal, f->scene.data, NULL};
        must(far_end_new(&e, f->program, argument, folder, graphics, line, &bench_fault));
        time_session(e, pressed);
        far_end_free(e);
    }
    for (int k = BALL; k <= MEANWHILE; k++)
        out[k] = medians(&pressed[k]);
}

/* On a copy of the journal in a folder of its own, which becomes the program's home. */
static void time_keys(const struct figures *f, const struct graphics *graphics,
                      const struct far_line *line, unsigned keys, struct key_figures out[KINDS])
{
    OWNED(buf_release) struct buf bytes = {0};
    struct far_end *e = NULL;
    const char *folder = bench_folder(NULL);
    char path[PATH_MAX];
    snprintf(path, sizeof path, "%s/%s", folder, file_name(buf_text(&f->journal)));
    must(file_read(&bytes, buf_text(&f->journal), JOURNAL_MOST, &bench_fault));
    must(file_write(path, bytes.data, bytes.length, FILE_KEEP, &bench_fault));
    char *const argument[] = {"iftty", path, NULL};
    must(far_end_new(&e, f->program, argument, folder, graphics, line, &bench_fault));
    press_all(e, keys, out);
    far_end_free(e);
    time_steps(f, path, folder, graphics, line, keys / 3, out);
    if (graphics != &graphics_tiles && !f->quick)
        time_gestures(f, graphics, line, out);
}

static void time_pilot(struct figures *f)
{
    for (unsigned l = 0; l < (f->quick && !f->only ? 1 : LINES); l++) {
        struct far_line line = lines[l].line;
        if (f->quick)
            line.still_ms = QUICK_STILL_MS;
        for (unsigned p = 0; p < PILOTED; p++)
            if (!f->only || strstr(name_of(l, p).text, f->only))
                time_keys(f, piloted[p], &line, f->quick ? QUICK_KEYS : lines[l].keys,
                          f->key[l][p]);
    }
}

/* ---- the first run ---- */

/* The figures of the first run, a line for each row: "kitty_slow turn 268.000 682.000 31.000". */
static struct buf stored;

static bool is_held(int kind)
{
    return kind >= HELD_MOVE && kind <= HELD_PEN;
}

/* False where the first run had no such row. */
static bool stored_find(const char *pilot, int kind, double of[COLUMNS])
{
    char row[64];
    snprintf(row, sizeof row, "%s %s ", pilot, key_words[kind].name);
    const char *at = strstr(buf_text(&stored), row);
    if (!at)
        return false;
    char *end;
    at += strlen(row);
    for (int c = 0; c < COLUMNS; c++, at = end)
        of[c] = strtod(at, &end);
    return true;
}

/* Reads what is there, and stores what was not. */
static void stored_read(const struct figures *f)
{
    OWNED(buf_release) struct buf path = {0}, more = {0};
    double of[COLUMNS];
    must(file_program_folder(&path, &bench_fault));
    buf_add_text(&path, "/../../bench-keys.txt");
    if (file_exists(buf_text(&path)))
        must(file_read(&stored, buf_text(&path), STORED_MOST, &bench_fault));
    buf_add_text(&more, buf_text(&stored));
    for (unsigned l = 0; l < LINES; l++)
        for (unsigned p = 0; p < PILOTED; p++)
            for (int k = 0; k < KINDS; k++) {
                const struct pilot_name name = name_of(l, p);
                if (f->quick || !f->key[l][p][k].keys || stored_find(name.text, k, of))
                    continue;
                buf_printf(&more, "%s %s", name.text, key_words[k].name);
                for (int c = 0; c < COLUMNS; c++)
                    buf_printf(&more, " %.3f", f->key[l][p][k].of[c]);
                buf_add_char(&more, '\n');
            }
    if (more.length > stored.length)
        must(file_write(buf_text(&path), more.data, more.length, FILE_REPLACE, &bench_fault));
}

/* Worse by a quarter, and by more than noise. */
static bool is_worse(int kind, int c, double now, double then)
{
    return is_held(kind) && c == FIRST ? now < then * 0.8 && now < then - 1
                                       : now > then * 1.25 && now > then + column_words[c].noise;
}

/* ---- what is printed ---- */

static void print_keys(const struct key_figures key[KINDS], const char *pilot)
{
    double then[COLUMNS];
    for (int k = 0; k < KINDS && key[k].keys; k++) {
        printf("        %-31s", key_words[k].text);
        for (int c = 0; c < COLUMNS; c++)
            printf(" %9.2f", key[k].of[c]);
        if (stored_find(pilot, k, then))
            for (int c = 0; c < COLUMNS; c++)
                then[c] > 0 ? printf(" %5.2f", key[k].of[c] / then[c]) : printf(" %5s", "-");
        printf("\n");
    }
}

static void print_worse(const struct figures *f)
{
    double then[COLUMNS];
    for (unsigned l = 0; l < LINES; l++)
        for (unsigned p = 0; p < PILOTED; p++)
            for (int k = 0; k < KINDS; k++)
                for (int c = 0; f->key[l][p][k].keys && c < COLUMNS &&
                                stored_find(name_of(l, p).text, k, then);
                     c++)
                    if (is_worse(k, c, f->key[l][p][k].of[c], then[c]))
                        printf("worse: %s, %s: %s, %s: %.2f, was %.2f\n", piloted[p]->title,
                               lines[l].text, key_words[k].text, column_words[c].text,
                               f->key[l][p][k].of[c], then[c]);
}

static void print_table(struct figures *f)
{
    puts(file_name(buf_text(&f->scene)));
    times_print_title();
    for (int m = 0; m < MOMENTS && f->start[m].count; m++)
        times_print(moment_words[m].text, &f->start[m], 1, "ms");
    printf("%s, the pilot, %dx%d cells of %dx%d pixels: ms and kB%s\n%-39s",
           file_name(buf_text(&f->journal)), FAR_COLUMNS, FAR_ROWS, FAR_CELL_WIDTH, FAR_CELL_HEIGHT,
           stored.length ? ", and of the first run" : "", "");
    for (int c = 0; c < COLUMNS; c++)
        printf(" %9s", column_words[c].text);
    printf("\n");
    for (unsigned l = 0; l < LINES; l++)
        for (unsigned p = 0; p < PILOTED; p++) {
            if (!f->key[l][p][ENTER].keys)
                continue;
            printf("    %s, %s\n", piloted[p]->title, lines[l].text);
            print_keys(f->key[l][p], name_of(l, p).text);
        }
    print_worse(f);
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

static void write_figures(struct figures *f)
{
    struct json *json = bench_json();
    json_object(json, NULL);
    json_text(json, "scene", file_name(buf_text(&f->scene)));
    for (int m = 0; m < MOMENTS; m++) {
        json_object(json, moment_words[m].name);
        times_write(json, &f->start[m]);
        json_end(json);
    }
    json_text(json, "journal", file_name(buf_text(&f->journal)));
    json_object(json, "pilot");
    for (unsigned l = 0; l < LINES; l++)
        for (unsigned p = 0; p < PILOTED; p++)
            if (f->key[l][p][ENTER].keys)
                add_keys(json, name_of(l, p).text, f->key[l][p]);
    json_end(json);
    json_end(json);
}

/* ---- the whole ---- */

static void find_files(struct figures *f)
{
    OWNED(interpreter_release) struct interpreter interp;
    must(interpreter_init(&interp, &bench_fault));
    if (!f->quick || !bench_find_in_tree(&f->journal, "examples/shells.iftty"))
        must(bench_find_example(&f->journal, &interp, &bench_fault));
    if (interpreter_find_scene(&interp, 0, "ch2.nii.gz", false, &f->scene, NULL))
        must(interpreter_find_scene(&interp, 0, "synth:geom", false, &f->scene, &bench_fault));
}

enum err run_keys(const struct options *o, struct fault *fault)
{
    struct figures f = {.program = bench_options(o)->program,
                        .only = o->words ? o->word[0] : NULL,
                        .quick = bench_options(o)->quick};
    (void)fault;
    if (f.quick)
        held_for_ms = idle_ms = 100;
    find_files(&f);
    for (int i = 0; !f.only && i < (f.quick ? 1 : STARTS); i++)
        time_start(&f);
    time_pilot(&f);
    stored_read(&f);
    (o->json ? write_figures : print_table)(&f);
    buf_release(&stored);
    buf_release(&f.journal);
    buf_release(&f.scene);
    return OK;
}
