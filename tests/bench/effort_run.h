/* SPDX-License-Identifier: MIT */
/* One run: the robot segments an object in a session by one method. Its curve, and the counts of
 * that curve.
 *
 * Twenty gestures follow the first two: dice[k] is the Dice coefficient after 2 + k gestures. If no
 * label is wrong any more, the rest of the curve is 1. A method that corrects loads the truth with
 * defects by `labels` instead of the first two gestures. The time of a gesture is processor time
 * from the command to the labels, with their border and digests, relaxed where the method relaxes.
 */
#ifndef TESTS_BENCH_EFFORT_RUN_H
#define TESTS_BENCH_EFFORT_RUN_H

#include "tests/bench/effort_robot.h"

/* Corrections of a loaded segmentation: balls that grow, that grow within a distance, the same over
 * the wrong label alone, and exact balls over the wrong label. */
enum effort_correction {
    CORRECTS_NONE,
    CORRECTS_GROWING,
    CORRECTS_WITHIN,
    CORRECTS_OVER,
    CORRECTS_EXACTLY
};

struct effort_method {
    const char *name, *weight;
    enum effort_shape background;
    unsigned reach; /* of `finish relax`; 0: labels are not relaxed */
    bool limits;    /* refinements end within the gesture's distance */
    uint32_t brush; /* radius of balls, at most a tenth of the scene; 0: the robot's own */
    bool outlines;  /* the third gesture is an outline */
    enum effort_correction corrects;
};

enum { CURVE = 21, NOT_REACHED = CURVE + 2, EFFORT_GOALS = 2, EFFORT_LOOKS = 3, COLLAPSE = 500 };

struct effort_run {
    size_t object, method;
    uint32_t radius_most;           /* of balls; 0: the method's or the robot's own */
    unsigned dice[CURVE];           /* in ten-thousandths */
    double ms;                      /* median of a gesture */
    size_t wrong, repaired, beyond; /* of a correction: voxels of defects; right at the end; others
                                       that are wrong at the end */
};

/* Write the scene of an object into the folder, for all runs on it. */
enum err effort_prepare(const struct effort_object *object, const char *folder,
                        struct fault *fault);
enum err effort_run(struct effort_run *run, const struct effort_method *method,
                    const struct effort_object *object, const char *folder, struct fault *fault);

/* Command of a gesture; `limits`: with the distance of a refinement. */
void effort_write_command(struct buf *line, const struct effort_gesture *gesture, bool limits);

/* Sums over runs. */
struct effort_count {
    unsigned runs;
    unsigned gestures[EFFORT_GOALS], reached[EFFORT_GOALS]; /* to a Dice of 0.8, and of 0.9 */
    unsigned after[EFFORT_LOOKS];                           /* Dice after 5, 10, 20 gestures */
    unsigned collapses, largest; /* drops of more than COLLAPSE from one gesture to the next */
};
void effort_count(struct effort_count *count, const struct effort_run *run);

#endif
