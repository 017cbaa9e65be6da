/* SPDX-License-Identifier: MIT */
/*
 * A learner's turn: before a gesture of the journal is shown, he makes his own, and both are
 * compared: how far apart they are, whether they are of one label, and what his would have changed.
 *
 * His gesture is carried out in the segmentation that the journal's found, with all that waited
 * there, and taken back, bit for bit. What a gesture changes are the voxels that it gives another
 * label than they have without it; the overlap is Dice's coefficient of the two sets, of voxels
 * that both give the same label.
 */
#ifndef STEPS_OWN_TURN_H
#define STEPS_OWN_TURN_H

#include "steps/walkthrough.h"

struct own_turn {
    uint32_t place[3];
    int label, wanted; /* his and the journal's */
    double apart_mm;   /* from his place to the nearest voxel that the journal's gesture planted */
    bool has_length;   /* the scene says how far voxels are apart; else that is in voxels */
    uint64_t own, theirs, both; /* voxels that they change, and to the same label */
};

/* Whether a learner can be asked: a label planted at a place, which leaves seeds. */
bool own_turn_can_be_asked(const struct walkthrough *w, size_t step);

/* Compares a command that plants with that of `step`. What was shown is shown still. ERR_USAGE for
 * a command that plants no label at a place; errors of carrying it out. */
enum err own_turn_take(struct own_turn *turn, struct walkthrough *w, size_t step, const char *line,
                       struct fault *fault);

static inline double own_turn_overlap(const struct own_turn *turn)
{
    const uint64_t all = turn->own + turn->theirs;
    return all ? 2.0 * (double)turn->both / (double)all : 1;
}

/* "4.2 mm away, label 1 head, not 2 hole, overlap 0.63: 3.2 ml, theirs 4.1 ml": what both change,
 * in a line that fits 80 columns but for long names. */
void own_turn_words(struct buf *out, const struct walkthrough *w, const struct own_turn *turn);

/* ---- all of them ---- */

/* {0} is of none. */
struct own_turns {
    struct own_turn *turn;
    size_t count, capacity;
    size_t passed; /* asked, and not answered */
};

enum err own_turns_add(struct own_turns *turns, const struct own_turn *turn, struct fault *fault);
void own_turns_release(struct own_turns *turns);

/* One line: "12 of 14 gestures tried: labels right 11, median distance 6.3 mm, mean overlap .58" */
void own_turns_words(struct buf *out, const struct own_turns *turns);

#endif
