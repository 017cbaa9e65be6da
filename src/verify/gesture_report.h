/* SPDX-License-Identifier: MIT */
/* What the gestures of an expert and of a trainee have in common: for people, and for programs. */
#ifndef VERIFY_GESTURE_REPORT_H
#define VERIFY_GESTURE_REPORT_H

#include "base/buf.h"
#include "verify/gesture_match.h"

/* How many gestures of one side there are. */
struct gesture_counts {
    size_t kind[GESTURE_KIND_COUNT], label[GESTURE_NO_LABEL], placed, taken_back;
};

/* Expert, then trainee. All but what gesture_report_count fills in is borrowed. */
struct gesture_report {
    const char *path[2];
    const struct side *side[2];
    const struct gestures *gestures[2];
    const struct gesture_match *match;
    /* Of those that can be matched: of each label, 0..255 and GESTURE_ERASES, and `placed` of all.
     */
    struct gesture_counts count[2];
    bool has[GESTURE_NO_LABEL]; /* either has such gestures, or voxels of a label above 0 */
};
void gesture_report_count(struct gesture_report *report);

/* What a label is called by the expert, else by the trainee. */
const char *gesture_report_name(const struct gesture_report *report, unsigned label);

/* Tables: kinds, labels, order, and Dice over the steps, some 16 of them. */
void gesture_report_write_text(struct buf *out, const struct gesture_report *report);

/* An object that leaves nothing out: kinds, labels, pairs, order, all steps of both. */
void gesture_report_write_json(struct buf *out, const struct gesture_report *report);

#endif
