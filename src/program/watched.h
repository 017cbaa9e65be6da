/* SPDX-License-Identifier: MIT */
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
#ifndef PROGRAM_WATCHED_H
#define PROGRAM_WATCHED_H

#include "command/interpreter.h"
#include "journal/replay.h"

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
