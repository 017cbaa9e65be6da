/* SPDX-License-Identifier: MIT */
/*
 * A walk through the steps of a journal (steps/step_list.h), to and fro.
 *
 * Records are carried out once, by the rules of a replay, and no earlier than somebody wants to see
 * what they led to; each result is compared with what the journal says, so that at the end it is
 * known whether the journal is verified. What was carried out is gone back to, and on again, as a
 * state is: by the difference of two sets of seeds (session/history.h), exactly, in the time of
 * that edit.
 *
 * A step is shown in phases:
 *
 *     STEP_HIDDEN    the segmentation as it was, and nothing that says where the gesture comes
 *     STEP_BEFORE    the same, the cross-hair where the gesture was made, seen as recorded
 *     STEP_DRAWN     the same, its seeds as if they waited, its eliminators where they were put
 *     STEP_AFTER     what it led to
 *
 * Step 0 is the beginning: STEP_BEFORE of the first.
 *
 * Invariants
 *     (N1) whatever was shown, and however one has looked since, the next record finds the session
 *          as the record before it left it;
 *     (N2) a step that is shown once more gives the same digests, bit for bit;
 *     (N3) nothing is written.
 *
 * Where the journal does not look anywhere else, who watches looks as he has chosen: his view
 * stays from step to step until the journal's own changes.
 */
#ifndef STEPS_WALKTHROUGH_H
#define STEPS_WALKTHROUGH_H

#include "session/state.h"
#include "steps/step_list.h"
#include "verify/replay_file.h"

enum step_phase { STEP_HIDDEN, STEP_BEFORE, STEP_DRAWN, STEP_AFTER };
enum { STEP_NO_LABEL = -1 };

/* What is known of a step that was carried out. */
struct step_seen {
    uint32_t before, after; /* points of the history */
    struct outlook outlook; /* of the journal, when the gesture was made */
    const struct command *command;
    bool has_place, is_ball; /* where it was made; it plants a label at a place */
    uint32_t place[3];
    int label;              /* that it is about, or STEP_NO_LABEL */
    uint64_t changed;       /* voxels that got another label */
    size_t change, changes; /* of walkthrough.change */
};

/* So many voxels more, or fewer, has a label. */
struct step_change {
    unsigned label;
    int64_t voxels;
};

struct walkthrough {
    struct interpreter *interp; /* borrowed */
    struct step_list list;
    struct step_seen *seen; /* [done], of step 1 on */
    struct step_change *change;
    size_t done, capacity, changes, change_capacity;

    size_t at; /* the step that is shown, 0..list.count, */
    enum step_phase phase;
    bool is_shown;   /* anything is */
    bool comes_back; /* after an error, which nothing stops */
    uint8_t *former; /* [grid.cells] labels before step `former_of`, or NULL */
    size_t former_of, cells;

    struct buf bytes; /* of the journal */
    struct replaying replaying;
    struct replay_host host;
    struct replay_options options;
    struct replay_report report;
    struct replay replay;
    bool has_begun, has_ended; /* the replay; it has */
    enum err ended;            /* with this, */
    struct fault why;          /* and these words */

    struct outlook front; /* of the journal, after the last record that was carried out */
    uint32_t present;     /* and the point there */
    struct outlook shown; /* of the journal, as it was shown last, without a cross-hair, */
    uint32_t cross[3];    /* and that */
    uint64_t voxels[256]; /* of each label, before the record at hand */
};

/* Reads the journal, under the rules of trust and limits that hold for the process, and carries out
 * what comes before its first step. ERR_INPUT for a script, or a journal without a step. To be
 * released, whatever is returned. */
enum err walkthrough_begin(struct walkthrough *w, struct interpreter *interp, const char *path,
                           struct fault *fault);
void walkthrough_release(struct walkthrough *w);

/* Shows a step; what comes before it is carried out if it was not. Where the replay ends before, it
 * is ERR_CHECK or what ended it, as walkthrough_verdict says too; ERR_CANCELLED, ERR_LIMIT,
 * ERR_MEMORY. On errors what was shown is shown still. */
enum err walkthrough_show(struct walkthrough *w, size_t step, enum step_phase phase,
                          struct fault *fault);

/* Carries out all there is, the records after the last step too. Errors are those above. */
enum err walkthrough_finish(struct walkthrough *w, struct fault *fault);

static inline const struct step_seen *walkthrough_seen(const struct walkthrough *w, size_t step)
{
    return step && step <= w->done ? w->seen + step - 1 : NULL;
}

static inline const struct step *walkthrough_step(const struct walkthrough *w, size_t step)
{
    return step && step <= w->list.count ? w->list.step + step - 1 : NULL;
}

/* The seeds that a step planted, or the cells that its gesture waits with: as a list of edits that
 * the caller releases. ERR_MEMORY. */
enum err walkthrough_seeds(const struct walkthrough *w, size_t step, struct edits *seeds,
                           struct fault *fault);

/* Of labels before the step that is shown, for those who compare: [cells], or NULL where that is
 * not known. */
const uint8_t *walkthrough_former(const struct walkthrough *w);

#endif
