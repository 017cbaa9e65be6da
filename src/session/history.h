/* SPDX-License-Identifier: MIT */
/*
 * The history of a session: a tree of the states that its commands have led to.
 *
 * A *point* is a state of the segmentation: seeds, edits and eliminators that wait, weights, region
 * of interest, labels, what is hidden and cut away. Where one looks from is no part of it. Each
 * command that changes the segmentation leads from the present point to a new one, which remembers
 * what the command did; so the way between any two points is known, and because the forest is a
 * function of the set of seeds, going there takes one edit, whatever lies between. What was undone
 * is not lost: the next command only begins another alternative.
 *
 *      open --- seed 1 --- seed 2              main
 *                    \---- seed 3 --- seed 4    other, where we are
 *
 * Invariants
 *   H1 there is a root, the state after the scene was opened (or interpolated), as long as the
 *      session has a scene;
 *   H2 each point is reached from its parent by one command; a way up and down again leads to the
 *      very same state, bit for bit;
 *   H3 records are counted as a journal numbers them, whether there is one or not;
 *   H4 a command that is taken back has left no trace: it is noted by history_note, which may fail,
 *      and stands with history_settle, which may not.
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
    uint32_t latest; /* the child one was at last: where redo leads; POINT_NONE for none */
    uint32_t branch;
    size_t record; /* number of the command's record */
    bool plants;   /* it put up one marker */
    bool joins;    /* which goes on with that of the point before: the two are undone as one */
    char *command; /* in canonical form */

    /* What the command did to seeds, each voxel once; nothing unless it ran. */
    struct edit *after, *before;
    size_t seeds;

    /* The rest of the state here, but for the outlook. */
    struct kept_settings *settings; /* points at which they are the same hold the same */
    struct edit_lists lists;
};

struct branch {
    char name[BRANCH_NAME_BYTES];
    uint32_t point; /* its tip: where the next command on it goes on from, unless one looks back */
};

struct history {
    struct point *point; /* point[0] is the root */
    size_t points, point_capacity;
    uint32_t present;

    uint32_t *at; /* at[n - first]: the point where record n left the session */
    size_t first, ats, at_capacity;
    size_t records; /* so far, with those before the root */

    struct branch *branch; /* branch[0] is "main" */
    size_t branches, branch_capacity;
    uint32_t on; /* the branch that the present point is on */

    /* Of the command at hand: where it goes, by history_go, or POINT_NONE; and what history_note
     * has got ready. */
    uint32_t goes_to, goes_on;
    bool moves_tip; /* of the branch that it goes on */
    bool is_noted, is_root;
    struct point noted; /* a new point, where its settings are not NULL */
};

/* Where a history stands, with all that a command adds to it. */
struct history_place {
    size_t points, ats, records;
    uint32_t present, latest, tip;
};

void history_init(struct history *history);
void history_release(struct history *history);
size_t history_memory(const struct history *history);

/* ---- what is kept of the settings at each point, in little room ---- */

/* A copy that borrows. */
struct kept kept_settings_get(const struct kept_settings *settings);

/* ---- ways ---- */

/* The point *count commands (a stroke of several counts as one) before the present one, or after
 * it, the way one came: as many as there are, if these are fewer, which *count says then. ERR_INPUT
 * where there are none. */
enum err history_before(const struct history *history, size_t *count, uint32_t *point,
                        struct fault *fault);
enum err history_after(const struct history *history, size_t *count, uint32_t *point,
                       struct fault *fault);

/* The point where record `number` left the session, or where one was last on the branch `name`,
 * which is in *branch then. ERR_INPUT. */
enum err history_find(const struct history *history, const char *name, uint32_t *point,
                      uint32_t *branch, struct fault *fault);

/* The settings that this record left, where that is since the scene was opened; else those that it
 * was opened with, or NULL without a scene. */
const struct kept_settings *history_settings_after(const struct history *history, size_t record);

/* Whether the present point is the tip of its branch. */
bool history_is_at_tip(const struct history *history);

/* Has the session be what it was at `point`, which becomes the tip of the branch where `moves_tip`
 * is set: undo does so, and looking back does not. On error, session_rollback gives back what it
 * was. The history itself moves when the command stands. */
enum err history_go(struct history *history, struct session *session, uint32_t point,
                    uint32_t branch, bool moves_tip, struct fault *fault);

/* Where it stands now, in a scene; and there again, as if the commands since, none of which has
 * gone anywhere or begun a branch, had never been noted. The session has been taken back by
 * history_go. */
struct history_place history_place(const struct history *history);
void history_forget(struct history *history, const struct history_place *place);

/* Has the session be what it was at `point`, to be looked at: no command has gone there, and before
 * the next one that is noted the session has to be led back to where it was. */
enum err history_look(struct history *history, struct session *session, uint32_t point,
                      struct fault *fault);

/* From now on the present point is on a branch `name`, which is new: when the command stands.
 * ERR_USAGE for a name that is taken. */
enum err history_branch(struct history *history, const char *name, struct fault *fault);

/* ---- commands ---- */

/* A command that is to be recorded was carried out (between session_mark and session_settle): gets
 * ready what is to be kept of it. `command` is in canonical form. ERR_MEMORY. */
enum err history_note(struct history *history, const struct session *session, const char *command,
                      struct fault *fault);

/* Whether what was noted changes the segmentation, or where one is in its history. */
bool history_moves(const struct history *history);

/* It stands, or is taken back. Called after each command, noted or not. */
void history_settle(struct history *history, bool stands);

#endif
