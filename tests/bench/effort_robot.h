/* SPDX-License-Identifier: MIT */
/* A robot in the place of a user: it finds the wrong labels, and makes the gesture that corrects
 * most of them, so that the gestures of a method can be counted, with the same result each time.
 *
 * Depth of a voxel is its Euclidean distance to the nearest voxel outside of the set; the edge of
 * the scene does not end a set. All of it is in integers, squared; of several voxels as deep, the
 * first one is taken.
 *
 * The first two gestures
 *   object       a ball of label 1 at the deepest voxel of the truth
 *   background   a ball of label 0 at the deepest voxel of those that are more than 2 and at most
 *                10 voxels outside of it; or
 *   sphere       the surface of the smallest ball around the truth, 2 to 5 voxels larger
 * After a sphere, a robot that does what a new session proposes draws
 *   outline      of the largest piece of the truth in the axial slice with most wrong voxels
 *
 * Each further gesture corrects the largest component (by faces) of the wrong voxels, at its
 * deepest voxel by the true label there. The radius is depth - 1, rounded down, at most 3 or
 * radius_most. Methods with limits end a refinement within three times the depth. An exact ball
 * changes one label alone: it is at the deepest voxel of the component, and as large as possible,
 * among all voxels but those that have this label rightly.
 *
 * A robot that corrects a segmentation begins with the truth with defects: balls of radius 3 to 6
 * around border voxels, in turn taken out of the object and added to it.
 *
 * Random numbers are one stream a run, seeded by the object's name, so all methods get the same
 * sphere. */
#ifndef TESTS_BENCH_EFFORT_ROBOT_H
#define TESTS_BENCH_EFFORT_ROBOT_H

#include "engine/components.h"
#include "engine/grid.h"
#include "tests/bench/effort_object.h"

enum effort_shape { SHAPE_BALL, SHAPE_SPHERE, SHAPE_OUTLINE };

struct effort_gesture {
    enum effort_shape shape;
    uint32_t at[3], radius;
    uint8_t label;
    uint32_t within;             /* limit of the distance of a refinement; 0: unlimited */
    const uint32_t (*corner)[2]; /* of an outline, after `at`, of the robot: x, y */
    size_t corners;
};

struct effort_robot {
    uint64_t random;
    const struct effort_object *object;
    uint32_t radius_most; /* 3 */
    bool is_exact;
    struct grid grid;
    uint8_t *wrong;    /* [grid.cells]: 1 where the labels are wrong */
    uint64_t *squared; /* [voxels]: depths, of a box that some set lies in */
    uint32_t (*corner)[2];
};

/* The object outlives it. ERR_MEMORY, ERR_LIMIT. */
enum err effort_robot_init(struct effort_robot *robot, const struct effort_object *object,
                           struct fault *fault);
void effort_robot_release(struct effort_robot *robot);

enum err effort_robot_object(struct effort_robot *robot, struct effort_gesture *gesture,
                             struct fault *fault);
enum err effort_robot_background(struct effort_robot *robot, enum effort_shape shape,
                                 struct effort_gesture *gesture, struct fault *fault);

/* Outline the object in a slice, given label[voxels]. */
void effort_robot_outline(struct effort_robot *robot, const uint8_t *label,
                          struct effort_gesture *gesture);

/* Add defects to label[voxels]. */
void effort_robot_damage(struct effort_robot *robot, uint8_t *label);

/* Choose the next gesture, given label[voxels]; *found is false if no label is wrong. */
enum err effort_robot_next(struct effort_robot *robot, const uint8_t *label,
                           struct effort_gesture *gesture, bool *found, struct fault *fault);

#endif
