/* SPDX-License-Identifier: MIT */
/*
 * One run: a robot segments an object by a method. Its curve, and what is counted of it.
 *
 * Twenty gestures follow the first two. dice[k] is what 2 + k gestures came to; with a box, which
 * counts as two, dice[0] is that of the object's ball alone. Where nothing is wrong any more, the
 * rest of the curve is 1.
 *
 * What hands do is counted beside gestures: the length that they draw, and clicks. A ball or a
 * sphere is a click, a stroke or a box two or its length, an outline as effort_hand.h says.
 */
#ifndef TESTS_BENCH_EFFORT_RUN_H
#define TESTS_BENCH_EFFORT_RUN_H

#include "tests/bench/effort_tool.h"

/* What is said of gestures that took too much (show/surprise.h), and what the truth says of them.
 * A leak makes the labels worse by more than a LEAK_SHARE-th of the object: more than half of the
 * voxels that it gives another label are wrong then, by so many more than those that are right. */
enum { LEAK_SHARE = 10 };
struct effort_warnings {
    unsigned leaks, found; /* and of those, how many were said to be */
    unsigned right,
        called; /* gestures that were right in half of their voxels or more, and of those
                               how many were called leaks */
};
void effort_judge(struct effort_warnings *w, const struct effort_object *object,
                  const uint8_t *former, const uint8_t *label, bool is_called);

enum { CURVE = 21, NOT_REACHED = CURVE + 2, EFFORT_GOALS = 2, EFFORT_LOOKS = 3, COLLAPSE = 500 };

struct effort_run {
    size_t object, method;
    enum effort_robot_kind robot;
    uint32_t radius_most;            /* of balls and strokes; 0 for the robot's own */
    uint32_t size[3], voxels;        /* of the crop; those of the truth */
    unsigned dice[CURVE];            /* in ten-thousandths */
    double path[CURVE];              /* what hands have done so far: voxels drawn, */
    unsigned clicks[CURVE];          /* and clicks where none are drawn */
    unsigned most;                   /* the Dice of a hand in every slice (effort_outline_most) */
    struct effort_warnings warnings; /* where the labels are the forest's, after the first two */
    double ms;                       /* the median of a gesture */
};

enum err effort_run(struct effort_run *run, const struct effort_method *method,
                    const struct effort_object *object, const char *folder, struct fault *fault);

/* What is counted, over some runs: sums. */
struct effort_count {
    unsigned runs;
    unsigned gestures[EFFORT_GOALS], reached[EFFORT_GOALS]; /* to a Dice of 0.8, and of 0.9 */
    unsigned after[EFFORT_LOOKS];                           /* 5, 10, 20 gestures: Dice */
    double path;                                            /* to a Dice of 0.8, or to the end */
    unsigned clicks;
    struct effort_warnings warnings;
    unsigned collapses, largest; /* drops of more than COLLAPSE from one gesture to the next */
};
void effort_count(struct effort_count *count, const struct effort_run *run);

#endif
