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
    run_watch, run_verify, run_verify_bisect, run_accept, run_reseal, run_diff, run_apply,
    run_log_procedure, run_compare, run_log, run_log_script, run_log_check, run_log_anonymise,
    run_log_repair, run_show, run_info, run_help;

/* Beginning and end of programs: an interpreter set up by the options, and the confinement of
 * journals that may be a stranger's. */

/* With the scene, folder and journal of the options. Lines about a journal that is resumed go to
 * standard error. To be released, whatever is returned. */
enum err begin_by_options(struct interpreter *interp, const struct options *o, struct fault *fault);

/* Has a large scene that is opened from now on wait for the first command that looks at it: for
 * programs that carry out commands one by one, and look at voxels in no other way. */
void begin_to_wait(struct interpreter *interp);

/* The scene or journal of the command line, or NULL; `resumes` is set for a journal. ERR_USAGE,
 * ERR_INPUT and ERR_IO for options that contradict it. */
enum err begin_check(const struct options *o, const char **first, bool *resumes,
                     struct fault *fault);

/* The volume of a file of the command line, by its number there from 0, as --volume has it. */
struct volume_choice begin_volume(const struct options *o, size_t which);

/* NAME-N.iftty for the first N that is free here: where a session records that begins with `first`,
 * or with NULL, and was given no journal. */
void begin_journal_name(struct buf *journal, const char *first);

/* Sync the journal at the end of a session that ends with `err`. */
enum err end_journal(struct interpreter *interp, enum err err, struct fault *fault);

/* Before anything is carried out that a journal says: the limits of the options, and the kernel's
 * walls. `written` is a folder that may be written, or NULL. */
enum err begin_confined(const struct options *o, const char *journal, const char *written,
                        struct fault *fault);

/* The same in the process that verifies one journal, where `context` is the options. */
enum err begin_one(void *context, const char *journal, struct fault *fault);

/* The picture of the last command, and its colours. */

/* The colours of the labels that can show, and of the background, which is a shade of one too, for
 * a palette; how many. */
unsigned shown_hues(uint32_t hue[256], const struct session *session);

/* The picture that the last command had shown, else the rendition. `smooth`: in all bits, where the
 * terminal can. Its pixels belong to the interpreter, its colours to this file, until the next. */
struct image_view shown_picture(struct interpreter *interp, bool smooth);

/* The session at prompt and pilot that `iftty` and `iftty tutorial` have in common. */

struct lesson;

/* On the scene or journal of the options; or with a lesson, whose scene it begins with. Then no
 * line is remembered from one time to the next, and nothing but the journal stays behind. */
enum err prompt_run(const struct options *o, struct lesson *lesson, struct fault *fault);

/*
 * What a user has written down about prompt and pilot, in $XDG_CONFIG_HOME/iftty/config or
 * ~/.config/iftty/config; IFTTY_CONFIG=FILE names another one, IFTTY_CONFIG= none.
 *
 *     # dark, light or none
 *     theme light
 *     # what the pilot's brush begins with: a label, a radius
 *     brush 3 2
 *     # a window of greys by centre and width: `w` and its number take it
 *     window liver 60 160
 *     # the keys of an action of the pilot (struct chord)
 *     key undo U Ctrl-u
 *     # long answers at the prompt run over the screen as they are
 *     pager off
 *     # on a slow line no slice is sent before it is wanted
 *     ahead off
 *     # a command for each new session, once it has a scene; `start none` for nothing
 *     start overlay tint
 *
 * A session that no line says a start for begins with CONFIG_USUAL_START: labels settle on edges.
 *
 * It is read where there is a terminal to sit at, and nowhere else: no script, replay or journal
 * depends on it. A line that is not understood is named with its number and left out; so is what
 * is beyond CONFIG_LINES_MOST lines or CONFIG_LINE_MOST bytes in one. Whatever it holds, it moves
 * no cursor and takes no more memory than that.
 */

enum { CONFIG_BYTES_MOST = 64 << 10, CONFIG_LINE_MOST = 1000, CONFIG_LINES_MOST = 1000 };

/* Over robots' sessions these took 13.8 gestures to what took 20.3 without. */
#define CONFIG_USUAL_START "finish relax\nfinished on\n"

struct config {
    struct pilot_setup setup;
    bool plain_answers; /* no pager */
    bool has_start;     /* a line says what a session begins with */
    struct buf path;
    struct buf start; /* commands, one a line, each after the number of its line and a blank */
    struct buf words; /* lines on what was left out, safe to print */
    size_t line;      /* that is being read, from 1 */
    size_t wrong;     /* lines */
};

/* What holds where nothing is written down. */
void config_init(struct config *config);
void config_release(struct config *config);

/* Finds the file and reads it; none is fine. What is wrong with it is among the words. Where it
 * says no `start`, the usual one is there. */
void config_read(struct config *config);

/* Takes a text in, line by line; `path` is for the words. */
void config_take(struct config *config, const char *text, size_t length);

/*
 * The lesson of `iftty tutorial`: a first organ, the brain of the head ch2, in steps.
 *
 * A step says what to do, and has come when what it is about is there, however that was done:
 * seeds lie on the right side of the truth, mricron's own extraction of this brain, and labels
 * agree with it by Dice's coefficient. So whoever undoes one is a step back, and a journal that was
 * left midway goes on where it was.
 */

#define LESSON_SCENE "ch2.nii.gz"
#define LESSON_TRUTH "ch2bet.nii.gz"

struct lesson {
    uint8_t *truth; /* 1 in the brain, else 0: [z][y][x], */
    uint32_t size[3];
    uint64_t of;     /* what was looked at last, */
    bool is_settled; /* whose labels had settled, */
    struct overlap overlap;
    uint32_t worst;     /* and the slice with most that is wrong */
    size_t seeds[2][2]; /* of the background and of label 1, outside of the brain and in it */
    bool has_name;
};

/* The truth, on the grid of the session's scene: ERR_INPUT where that is another one. */
enum err lesson_begin(struct lesson *lesson, const struct interpreter *interp, struct fault *fault);

/* Looks at what there is: at labels that have settled, where they are to, which are waited for if
 * `waits`. */
void lesson_look(struct lesson *lesson, struct session *session, bool waits);

/* What a lesson is, for the prompt, to begin with. */
void lesson_add_beginning(struct buf *out);

/* Lines on the present step: for the prompt; and for the pilot, one on what is missing and two on
 * the keys. `journal` goes on with it. */
void lesson_add_page(struct buf *out, const struct lesson *lesson, const char *journal);
void lesson_add_captions(struct buf *out, const struct lesson *lesson, const char *journal);

/* The ten keys as README.md has them. */
void lesson_add_keys(struct buf *out);

/*
 * The pilot's host (tui/pilot/host.h): answers what the pilot asks from the interpreter's session.
 * What changes anything goes to the interpreter as a line.
 */

struct pilot_interpreter {
    struct interpreter *interp;
    bool watches;       /* nothing is planted */
    bool smooth;        /* all bits of every colour, where the terminal can */
    struct panes panes; /* the last picture, */
    struct raster_box slice[PANES_SLICES], beyond; /* and where slices are in it, and beyond */
    uint32_t hue[256];

    const struct pilot_onlooker *onlooker; /* while a command is carried out, or NULL */
    struct console_onlooker looks_on;
    uint32_t cross[3]; /* where the cross-hair is while it is shown elsewhere: */
    bool peeks;
};

/* Fills in all of a host but its context, execute and finished. The context that these functions
 * are given begins with a struct pilot_interpreter. */
void pilot_host_fill(struct pilot_host *host);

/*
 * A journal to watch: its replay leaves a history (session/history.h), whose points are the steps,
 * and each of them is shown in two phases:
 *
 *     drawn      the state before, the cross-hair where the gesture was made, its seeds as if they
 *                waited, its eliminators where they were put
 *     after      the state that it led to, and the labels before, for a comparison
 *
 * Step N leads to point N of the history. Step 0 is the state before step 1. An interpolation
 * begins the history again, so steps before it (names of labels) are not shown.
 *
 * Invariants
 *     (N1) a step that is shown again has the same digests, bit for bit;
 *     (N2) nothing is written.
 *
 * The view is that of the viewer from step to step, until the journal's own view changes.
 */

struct watched_step {
    struct outlook outlook; /* of the journal, before the record */
    size_t comments;        /* offset in watched.comments: lines, ended by NUL */
};

struct watched {
    struct interpreter *interp; /* borrowed */
    struct watched_step *step;  /* [count], of step 1 on */
    size_t count, capacity;
    uint32_t end; /* the point that the last record led to */
    struct buf comments;
    struct replay_report report;
    enum err ended; /* OK: verified; else `why` */
    struct fault why;

    size_t at;                     /* the step that is shown */
    bool is_drawn;                 /* its gesture is, and it is not carried out yet */
    const struct command *command; /* of the step, or NULL */
    bool has_place;
    uint32_t place[3]; /* of the gesture: the middle of a box or an outline */
    int label;         /* of the gesture; -1 for none */
    uint8_t *former;   /* [cells] labels before the step */
    size_t cells;
    uint64_t changed;     /* voxels that have another label after the step than before */
    int64_t changes[256]; /* of voxels, by label */

    struct outlook shown; /* of the journal at the step that was shown before, without a place */
    uint32_t cross[3];    /* of the journal there */
};

/* Replays the journal under the rules of trust and limits of the process. Where a record fails or
 * differs, the steps before it can be shown, and `ended` is set. ERR_INPUT for a script or a
 * journal without a step; ERR_CANCELLED, ERR_LIMIT, ERR_MEMORY; else what ended a replay without a
 * step. Always call watched_release. */
enum err watched_begin(struct watched *w, struct interpreter *interp, const char *path,
                       struct fault *fault);
void watched_release(struct watched *w);

/* Draws a step 0..count: the state before, and the gesture. ERR_CANCELLED, ERR_LIMIT, ERR_MEMORY:
 * the step that was shown still is. */
enum err watched_draw(struct watched *w, size_t step, struct fault *fault);

/* Shows the state after a step 0..count. Errors are those of watched_draw, which comes first where
 * the step is not drawn: it may be all that was done. */
enum err watched_carry_out(struct watched *w, size_t step, struct fault *fault);

/* Labels before the step, for hatching; NULL where it changes none, or is not carried out. */
const uint8_t *watched_former(const struct watched *w);

/* ---- words, safe to print ---- */

/* "step 12 of 431, record 15: seed 67,119,76 1 radius=3", with "undone later" or "on another
 * branch" where the step is not on the way to the last state. */
void watched_title(struct buf *out, const struct watched *w);

/* Drawn: place and label of the gesture. After: "1 brain +12.4 ml, 0 -12.4 ml; 12 345 voxels
 * changed", and the edits that wait. */
void watched_describe(struct buf *out, const struct watched *w);

/* The comments before the step, lines. */
void watched_comments(struct buf *out, const struct watched *w);

/* "verified: 494 commands carried out again, 480 results the same" or "NOT verified: ..". */
void watched_verdict(struct buf *out, const struct watched *w);

#endif
