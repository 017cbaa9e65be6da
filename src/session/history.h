/* SPDX-License-Identifier: MIT */
/*
 * The history of a session: a tree of the states that its commands have led to.
 *
 * A *point* is a state of the segmentation: seeds, pending edits and eliminators, weights, region
 * of interest, labels, hidden and cut parts. The view is not part of it. Each command that changes
 * the segmentation leads from the present point to a new one, which stores the change. So the way
 * between any two points is known. Because the forest is a function of the set of seeds, going
 * there needs one edit, whatever the points in between. An undone point is not lost: the next
 * command starts another alternative.
 *
 *      open --- seed 1 --- seed 2              main
 *                    \---- seed 3 --- seed 4    other, present point
 *
 * Invariants
 *   H1 there is a root, the state after the scene was opened (or interpolated), as long as the
 *      session has a scene;
 *   H2 each point is reached from its parent by one command; a way up and down again leads to the
 *      same state, bit for bit;
 *   H3 records are counted as in a journal, with or without one;
 *   H4 a command that is taken back leaves no trace: history_note, which may fail, notes it, and
 *      history_settle, which cannot fail, makes it final.
 */
#ifndef SESSION_HISTORY_H
#define SESSION_HISTORY_H

#include "session/state.h"
#include "session/session.h"

#define POINT_NONE UINT32_MAX

enum { BRANCH_NAME_BYTES = 64 };

struct kept_settings;

struct point {
    uint32_t parent; /* POINT_NONE for the root */
    uint32_t latest; /* the child visited last, for redo; POINT_NONE for none */
    uint32_t branch;
    size_t record; /* number of the command's record */
    bool plants;   /* it set one marker */
    bool joins;    /* that marker continues the one of the point before: both are undone as one */
    char *command; /* in canonical form */

    /* Changes of seeds by the command, each voxel once; empty unless it ran. */
    struct edit *after, *before;
    size_t seeds;

    /* The rest of the state here, except for the outlook. */
    struct kept_settings *settings; /* shared by points with equal settings */
    struct edit_lists lists;
};

struct branch {
    char name[BRANCH_NAME_BYTES];
    uint32_t point; /* tip: the point from which the next command on this branch continues */
};

struct history {
    struct point *point; /* point[0] is the root */
    size_t points, point_capacity;
    uint32_t present;

    uint32_t *at; /* at[n - first]: the point after record n */
    size_t first, ats, at_capacity;
    size_t records; /* records so far, with those before the root */

    struct branch *branch; /* branch[0] is "main" */
    size_t branches, branch_capacity;
    uint32_t on; /* branch of the present point */

    /* For the present command: by history_go its target, or POINT_NONE, the branch of the target,
     * `branches` for a new one, and whether the target becomes the tip of that branch; by
     * history_note whether it will be a record, and whether its point replaces all others. */
    uint32_t goes_to, goes_on;
    bool moves_tip, is_noted, is_root;
    struct point noted; /* a new point, if its settings are not NULL */
};

/* Position of a history, with everything that a command adds to it. */
struct history_place {
    size_t points, ats, records;
    uint32_t present, latest, tip;
};

void history_init(struct history *history);
void history_release(struct history *history);
size_t history_memory(const struct history *history); /* bytes */

/* ---- settings of each point, stored compactly ---- */

/* Return a copy that borrows. */
struct kept kept_settings_get(const struct kept_settings *settings);

/* ---- ways between points ---- */

/* Find the point *count commands `back` from the present one, or after it on the way it came (a
 * stroke of several records counts as one). If there are fewer, *count becomes their number.
 * ERR_INPUT if it is 0. */
enum err history_step(const struct history *history, bool back, size_t *count, uint32_t *point,
                      struct fault *fault);

/* Find the point after record `number`, or the tip of the branch `name`, with its branch in
 * *branch. ERR_INPUT. */
enum err history_find(const struct history *history, const char *name, uint32_t *point,
                      uint32_t *branch, struct fault *fault);

/* The settings after this record, or those after opening if it precedes the scene; NULL without
 * a scene. */
const struct kept_settings *history_settings_after(const struct history *history, size_t record);

/* Make the session as it was at `point`, which becomes the tip of the branch if `moves_tip` is
 * set: undo does so. On error, session_rollback restores the former state. The history itself moves
 * in history_settle. */
enum err history_go(struct history *history, struct session *session, uint32_t point,
                    uint32_t branch, bool moves_tip, struct fault *fault);

/* The present position, with a scene; and the return to it, as if the later commands had never
 * been noted. None of them may have gone elsewhere or begun a branch. The session has been led back
 * by history_go. */
struct history_place history_place(const struct history *history);
void history_forget(struct history *history, const struct history_place *place);

/* Make the session as it was at `point`, for viewing only: go back before the next command is
 * noted. */
enum err history_look(struct history *history, struct session *session, uint32_t point,
                      struct fault *fault);

/* Put the present point on a new branch `name`, when the command is settled. ERR_USAGE if the
 * name exists, ERR_MEMORY. */
enum err history_branch(struct history *history, const char *name, struct fault *fault);

/* ---- commands ---- */

/* Prepare the history for a command that was carried out and will be recorded, between
 * session_mark and session_settle. `command` is in canonical form. ERR_MEMORY. */
enum err history_note(struct history *history, const struct session *session, const char *command,
                      struct fault *fault);

/* True if the noted command changes the segmentation, or the position in the history. */
bool history_moves(const struct history *history);

/* Make the command final, or take it back. Called after each command, noted or not. */
void history_settle(struct history *history, bool is_final);

#endif
