/* SPDX-License-Identifier: MIT */
/* The functions of the programs, for the table (program_table.c), which describes them. */
#ifndef PROGRAM_PROGRAMS_H
#define PROGRAM_PROGRAMS_H

#include <stdbool.h>

#include "base/buf.h"
#include "command/interpreter.h"
#include "engine/labels.h"
#include "image/volume_format.h"
#include "journal/replay.h"
#include "program/program.h"
#include "program/panes.h"
#include "tui/picture/image_view.h"
#include "tui/pilot/host.h"
#include "tui/pilot/pilot_keys.h"

program_run run_prompt, run_version, run_script, run_commands, run_serve, run_replay, run_tutorial,
    run_watch, run_verify, run_verify_bisect, run_reseal, run_diff, run_apply, run_log_procedure,
    run_compare, run_log, run_log_script, run_log_check, run_log_anonymise, run_log_times,
    run_log_repair, run_report, run_show, run_info, run_help;

/* Beginning and end of programs: an interpreter set up by the options, and the confinement of
 * journals that may be a stranger's. */

/* Set up an interpreter with scene, folder and journal of the options. Messages about a resumed
 * journal go to standard error. Always release it. */
enum err begin_by_options(struct interpreter *interp, const struct options *o, struct fault *fault);

/* Let a large scene that is opened later wait for the first command that looks at it: for programs
 * that carry out commands one by one, and look at voxels in no other way. */
void begin_to_wait(struct interpreter *interp);

/* The scene or journal of the command line, or NULL; `resumes` is set for a journal. ERR_USAGE,
 * ERR_INPUT and ERR_IO for options that contradict it. */
enum err begin_check(const struct options *o, const char **first, bool *resumes,
                     struct fault *fault);

/* ERR_USAGE for --channel unless a journal is resumed. */
enum err begin_check_channels(const struct options *o, bool resumes, struct fault *fault);

/* The volume that --volume selects for a file of the command line, by its number from 0. */
struct volume_choice begin_volume(const struct options *o, size_t which);

/* Write the command that opens a scene, or adds a channel; a file "3" is ./3, not channel 3. */
void begin_opening(struct buf *line, const char *file, bool is_channel);

/* Choose NAME-N.iftty, with the first free N: the journal of a session that begins with `first`, or
 * NULL, without --journal. */
void begin_journal_name(struct buf *journal, const char *first);

/* Sync the journal at the end of a session that ends with `err`. */
enum err end_journal(struct interpreter *interp, enum err err, struct fault *fault);

/* Confine the process by the limits of the options and by the kernel, before it carries out a
 * journal. `written` is the folder that may be written, or NULL. */
enum err begin_confined(const struct options *o, const char *journal, const char *written,
                        struct fault *fault);

/* The same in the process that verifies one journal; `context` is the options. */
enum err begin_one(void *context, const char *journal, struct fault *fault);

/* The picture of the last command, and its colours. */

/* List the colours of visible labels, and of the lightest background, for a palette. Returns their
 * count. */
unsigned shown_hues(uint32_t hue[256], const struct session *session);

/* The picture of the last command, otherwise the rendition. `smooth`: in all bits, if the terminal
 * can. The pixels belong to the interpreter, the colours are valid until the next call. */
struct image_view shown_picture(struct interpreter *interp, bool smooth);

/* The session at prompt and pilot, common to `iftty` and `iftty tutorial`. */

struct lesson;

/* Run on the scene or journal of the options; or with a lesson on its scene: without a history of
 * lines, and with no file but the journal left. */
enum err prompt_run(const struct options *o, struct lesson *lesson, struct fault *fault);

/*
 * The user's configuration of prompt and pilot, in $XDG_CONFIG_HOME/iftty/config or
 * ~/.config/iftty/config; IFTTY_CONFIG=FILE names another file, IFTTY_CONFIG= none.
 *
 *     # dark, light or none; by default as the terminal's background
 *     theme light
 *     # how pictures are shown, a word of --graphics
 *     graphics sextants
 *     # initial brush of the pilot: a label, a radius
 *     brush 3 2
 *     # whether trees grow from its seeds; without this line only if there is no segmentation
 *     brush exact
 *     # a window of greys by centre and width, selected by `w` and its number
 *     window liver 60 160
 *     # the keys of an action of the pilot (struct chord)
 *     key undo U Ctrl-u
 *     # print long answers at the prompt without pages
 *     pager off
 *     # name and time that sign new records (journal_sign)
 *     who jane times=yes
 *     # on a slow line send no slice before it is wanted
 *     ahead off
 *     # a command for each new session, once it has a scene; `start none` for nothing
 *     start overlay tint
 *
 * Without a line `start` a session begins with CONFIG_USUAL_START: labels settle on edges.
 *
 * It is read at a terminal only: no script, replay or journal depends on it. An invalid line is
 * reported with its number and ignored, as are lines after CONFIG_LINES_MOST and lines longer than
 * CONFIG_LINE_MOST bytes. It cannot move the cursor or use more memory than that.
 */

enum { CONFIG_BYTES_MOST = 64 << 10, CONFIG_LINE_MOST = 1000, CONFIG_LINES_MOST = 1000 };

/* With these, robots needed 13.8 gestures instead of 20.3. */
#define CONFIG_USUAL_START "finish relax\nfinished on\n"

struct config {
    struct pilot_setup setup;
    struct graphics_wish graphics; /* {0}: chosen by the terminal */
    bool plain_answers;            /* print answers without a pager */
    bool has_start;                /* there is a line `start` */
    struct buf path;
    struct buf start; /* commands, each on a line after its line number and a blank */
    struct buf who;   /* name that signs records, or empty */
    bool times;       /* and they have times */
    struct buf words; /* messages about ignored lines, safe to print */
    size_t line;      /* number of the current line, from 1 */
    size_t wrong;     /* lines */
};

/* Begins as {.setup = pilot_setup_default}. */
void config_release(struct config *config);

/* Find and read the file, if there is one. Errors are in `words`. Without a line `start` the
 * default one is set. */
void config_read(struct config *config);

/* Read a text, line by line; `path` is for messages. */
void config_take(struct config *config, const char *text, size_t length);

/*
 * The lesson of `iftty tutorial`: segment a first organ, the brain of the head ch2, in steps.
 *
 * A step is complete when its result is there, whatever the user did: seeds are on the right side
 * of the truth, mricron's extraction of this brain, and labels agree with it by Dice's coefficient.
 * So a resumed journal continues at its step. A step that was reached stays the present one while
 * labels settle or after `undo`, and names the condition that does not hold.
 */

#define LESSON_SCENE "ch2.nii.gz"
#define LESSON_TRUTH "ch2bet.nii.gz"

struct lesson {
    uint8_t *truth; /* 1 in the brain, otherwise 0: [z][y][x] */
    uint32_t size[3];
    uint64_t of;     /* digest of the labels that were counted last */
    bool is_settled; /* those labels had settled */
    struct overlap overlap;
    uint32_t worst;     /* slice with the most wrong voxels */
    size_t seeds[2][2]; /* [label 0 or 1][outside the brain, inside] */
    bool has_name;
    unsigned furthest; /* step that was reached, from 0 */
};

/* Read the truth. ERR_INPUT if its grid is not that of the session's scene. */
enum err lesson_begin(struct lesson *lesson, const struct interpreter *interp, struct fault *fault);

/* Count the session's labels and seeds: settled labels if labels settle; `waits`: compute them
 * first. */
void lesson_look(struct lesson *lesson, struct session *session, bool waits);

/* Add an introduction, for the prompt. */
void lesson_add_beginning(struct buf *out);

/* Add the current step: lines for the prompt; for the pilot one on the reason and one on the keys.
 * `journal` is its name, `colour` the sequence CSI .. m before keys, or "". */
void lesson_add_page(struct buf *out, const struct lesson *lesson, const char *journal,
                     const char *colour);
void lesson_add_captions(struct buf *out, const struct lesson *lesson, const char *journal,
                         const char *colour);

/* Add the ten keys as in README.md. */
void lesson_add_keys(struct buf *out);

/*
 * The pilot's host (tui/pilot/host.h): answers the pilot's questions from the interpreter's
 * session. Commands that change anything go to the interpreter as lines.
 */

struct pilot_interpreter {
    struct interpreter *interp;
    bool watches;                                  /* read-only: planting keys are not shown */
    bool smooth;                                   /* colours in all bits, if the terminal can */
    struct panes panes;                            /* the last picture */
    struct raster_box slice[PANES_SLICES], beyond; /* boxes of its slices, and of the slice next to
                                                      them */
    uint32_t hue[256];

    const struct pilot_onlooker *onlooker; /* while a command is carried out, or NULL */
    struct console_onlooker looks_on;
    uint32_t cross[3]; /* the true cross-hair while another one is shown */
    bool peeks;
};

/* Fill in all of a host but context, execute, sketch and drop. Its context must begin with a struct
 * pilot_interpreter. */
void pilot_host_fill(struct pilot_host *host);

/* Complete a line of prompt and pilot, for a host with such a context (tui/prompt/repl.h). */
void pilot_host_complete(void *context, const char *line, size_t cursor, struct buf *candidates,
                         size_t *word_start);

/*
 * Watching a journal: its replay leaves a history (session/history.h), whose points are the steps.
 * Each step is shown in two phases:
 *
 *     drawn the state before, with the cross-hair at the gesture, its seeds as pending ones, and
 *                its eliminators
 *     after      the state after it, and the labels before, for a comparison
 *
 * Step N leads to point N of the history. Step 0 is the state before step 1. An interpolation
 * begins a new history, so steps before it (names of labels) are not shown.
 *
 * Invariants
 *     (N1) a step that is shown again has the same digests, bit for bit;
 *     (N2) nothing is written.
 *
 * The viewer's view is kept from step to step, until the journal's own view changes.
 */

struct watched_step {
    struct outlook outlook; /* the journal's, before the record */
    size_t comments;        /* offset in watched.comments: lines, ended by NUL */
};

struct watched {
    struct interpreter *interp; /* borrowed */
    struct watched_step *step;  /* [count], from step 1 on */
    size_t count, capacity;
    uint32_t end; /* point of the last record */
    struct buf comments;
    struct replay_report report;
    enum err ended; /* OK: verified; else `why` */
    struct fault why;

    size_t at;                     /* the step shown */
    bool is_drawn;                 /* its gesture is drawn, and not carried out */
    const struct command *command; /* the command of the step, or NULL */
    bool has_place;
    uint32_t place[3]; /* place of the gesture: the middle of a box or an outline */
    int label;         /* label of the gesture; -1: none */
    uint8_t *former;   /* [cells] labels before the step */
    size_t cells;
    uint64_t changed;     /* voxels whose label the step changed */
    int64_t changes[256]; /* change of the voxel count, by label */

    struct outlook shown; /* the journal's view at the step shown before, without its place */
    uint32_t cross[3];    /* and its cross-hair */
};

/* Replay the journal under the trust and limits of the process. If a record fails or differs, the
 * steps before it can be shown, and `ended` is set. ERR_INPUT for a script or a journal without a
 * step; ERR_CANCELLED, ERR_LIMIT, ERR_MEMORY; otherwise the error of a replay without a step.
 * Always call watched_release. */
enum err watched_begin(struct watched *w, struct interpreter *interp, const char *path,
                       struct fault *fault);
void watched_release(struct watched *w);

/* Draw a step 0..count: the state before, and the gesture. ERR_CANCELLED, ERR_LIMIT, ERR_MEMORY:
 * the former step is still shown. */
enum err watched_draw(struct watched *w, size_t step, struct fault *fault);

/* Show the state after a step 0..count. Calls watched_draw first if the step is not drawn, and has
 * its errors. */
enum err watched_carry_out(struct watched *w, size_t step, struct fault *fault);

/* Labels before the step, for hatching; NULL if it changes none, or is not carried out. */
const uint8_t *watched_former(const struct watched *w);

/* ---- text, safe to print ---- */

/* Add "step 12 of 431, record 15: seed 67,119,76 1 radius=3", with "undone later" or "on another
 * branch" if the step does not lead to the last state. */
void watched_title(struct buf *out, const struct watched *w);

/* Add place and label of a drawn gesture; after it "1 brain +12.4 ml, 0 -12.4 ml; 12 345 voxels
 * changed", and the number of pending edits. */
void watched_describe(struct buf *out, const struct watched *w);

/* Add the comments before the step, lines. */
void watched_comments(struct buf *out, const struct watched *w);

/* Add "verified: 494 commands replayed, 480 results the same" or "NOT verified: ..". */
void watched_verdict(struct buf *out, const struct watched *w);

#endif
