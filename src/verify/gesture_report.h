/* What the gestures of an expert and of a trainee have in common: for people, and for programs. */
#ifndef VERIFY_GESTURE_REPORT_H
#define VERIFY_GESTURE_REPORT_H

#include "base/buf.h"
#include "verify/gesture_match.h"

/* All of it borrowed. */
struct gesture_report {
    const char *path[2]; /* expert, trainee */
    const struct side *side[2];
    const struct gestures *gestures[2];
    const struct gesture_match *match;
};

/* Whether the expert, or the trainee, has gestures of the label, or voxels in the end: in order, 0
 * to 255, then GESTURE_ERASES. Of 0 voxels count for nothing. */
bool gesture_report_has(const struct gesture_report *report, unsigned label);

/* What a label is called by the expert, else by the trainee. */
const char *gesture_report_name(const struct gesture_report *report, unsigned label);

/* Ten-thousandths, after so many gestures; 0 before the first step. */
unsigned gesture_report_dice(const struct gestures *gestures, uint32_t after, unsigned label);

/* Tables: kinds, labels, order, and Dice over the steps, some 16 of them. */
void gesture_report_write_text(struct buf *out, const struct gesture_report *report);

/* An object that leaves nothing out: kinds, labels, pairs, order, all steps of both. */
void gesture_report_write_json(struct buf *out, const struct gesture_report *report);

#endif
