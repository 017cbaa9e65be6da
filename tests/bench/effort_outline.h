/* SPDX-License-Identifier: MIT */
/*
 * The robot's further gestures where it draws outlines: each is of one slice, across any axis.
 *
 * Which slice comes next
 *   wrong     that with most wrong voxels, of those that no outline of the same slice has covered:
 *             for who knows the truth
 *   doubt     that with most doubt (engine/doubt.h), as `hints slice` says; slices that are drawn
 *             and their neighbours are left out
 *   chance    any that has the object and is not drawn yet
 * and what is drawn in it, by the largest piece (by edges) of what is wrong there and not covered,
 * or where nothing is, of the object
 *   piece of the object    that it belongs to, or lies within OUTLINE_RING voxels of; background
 *                          goes OUTLINE_RING voxels around it
 *   itself                 under its true label, and nothing around, where it is near none, or near
 *                          one that is drawn already
 * A piece without an inside is drawn as a line, and one of a voxel as that.
 *
 * The hand is off by so many tenths of a voxel (effort_hand.h). It does not know which slices it
 * has drawn well.
 */
#ifndef TESTS_BENCH_EFFORT_OUTLINE_H
#define TESTS_BENCH_EFFORT_OUTLINE_H

#include "engine/doubt.h"
#include "tests/bench/effort_hand.h"
#include "tests/bench/effort_robot.h"

enum outline_next { NEXT_NONE, NEXT_WRONG, NEXT_DOUBT, NEXT_CHANCE };

enum { OUTLINE_RING = 3 };

struct effort_outliner {
    const struct effort_object *object;
    enum outline_next next;
    unsigned hand; /* tenths of a voxel */
    uint64_t random;
    uint8_t *covered, *drawn; /* [voxels]: a bit an axis, of outlines and of pieces of the object */
    bool *is_drawn[3];        /* [size[axis]] */
    struct hand_slice wrong, piece;
    uint32_t *stack; /* of the largest slice */
    struct hand_outline outline;
};

enum err effort_outliner_init(struct effort_outliner *o, const struct effort_object *object,
                              enum outline_next next, unsigned hand, struct fault *fault);
void effort_outliner_release(struct effort_outliner *o);

/* The next gesture, given label[voxels], and for NEXT_DOUBT where that is; its line is borrowed
 * until the next. *found is false where nothing is left to draw. */
enum err effort_outline_next(struct effort_outliner *o, const uint8_t *label,
                             const struct doubt *doubt, struct effort_gesture *gesture, bool *found,
                             struct fault *fault);

/* The Dice coefficient, in ten-thousandths, of what such a hand comes to that outlines each piece
 * of the object in every slice across the axis that is best for it. */
enum err effort_outline_most(unsigned *dice, const struct effort_object *object, unsigned hand,
                             struct fault *fault);

#endif
