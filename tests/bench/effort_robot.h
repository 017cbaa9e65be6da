/* SPDX-License-Identifier: MIT */
/*
 * A robot in the place of a user: it looks at what labels are wrong, and makes the gesture that
 * corrects most. So how many gestures a method needs can be counted, and counted again.
 *
 * Depth of a voxel is its Euclidean distance to the nearest voxel that is not of the set at hand;
 * the edge of the scene is no end of a set. All of it is in integers, squared, but for the
 * direction of a stroke; of several voxels as deep, the first one is taken.
 *
 * The first two gestures
 *   object       a ball of label 1 at the deepest voxel of the truth
 *   background   a ball of label 0 at the deepest voxel of those that are more than 2 and at most
 *                10 voxels outside of it; or
 *   sphere       the surface of the smallest ball around the truth, 2 to 5 voxels larger; or
 *   box          the six faces of the box around it, each 3 to 12 voxels larger, but in the scene:
 *                which counts as two gestures
 * Each further one corrects the largest component (by faces) of what is wrong, at its deepest voxel
 * by the true label there. The radius is depth - 1, at most 3 or what radius_most
 * says, rounded down.
 *   careful      does so each time
 *   sloppy       one time in four corrects the second largest component; at a random voxel that is
 *                at least half as deep as the deepest; with a radius of at most 2
 *   stroke       goes up to 12 voxels either way along the component's main axis, as long as the
 *                ball stays in the component
 *
 * A refinement by a ball says how far it is to be heeded, three times the depth, to methods that
 * take that.
 *
 * What is random comes from one stream a run, which begins by the object's name: so all methods get
 * the same sphere and the same box.
 */
#ifndef TESTS_BENCH_EFFORT_ROBOT_H
#define TESTS_BENCH_EFFORT_ROBOT_H

#include "engine/components.h"
#include "session/paint.h"
#include "tests/bench/effort_object.h"

enum effort_robot_kind { ROBOT_CAREFUL, ROBOT_SLOPPY, ROBOT_STROKE, ROBOT_KINDS };
extern const char *const effort_robot_name[ROBOT_KINDS];

enum effort_shape { SHAPE_BALL, SHAPE_STROKE, SHAPE_SPHERE, SHAPE_BOX, SHAPE_OUTLINE };

/* A sphere around `at`; a box from `at` to `to`, as a stroke of balls. An outline is what
 * effort_outline.h draws. */
struct effort_gesture {
    enum effort_shape shape;
    uint32_t at[3], to[3], radius;
    uint8_t label;
    uint32_t within; /* how far it is to be heeded: of a refinement; 0 for no end */
    const uint32_t (*corner)[3];
    size_t corners;
    uint32_t ring;   /* voxels of the background around it */
    double path;     /* what the hand does: the length that it draws, in voxels, */
    unsigned clicks; /* or how often it clicks instead */
};

struct effort_robot {
    enum effort_robot_kind kind;
    uint64_t random;
    const struct effort_object *object;
    uint32_t radius_most; /* 3 */
    struct grid grid;
    uint8_t *wrong;    /* [grid.cells]: 1 where the labels are wrong */
    uint64_t *squared; /* [voxels]: depths, of a box that some set lies in */
};

/* The object outlives it. ERR_MEMORY, ERR_LIMIT. */
enum err effort_robot_init(struct effort_robot *robot, enum effort_robot_kind kind,
                           const struct effort_object *object, struct fault *fault);
void effort_robot_release(struct effort_robot *robot);

enum err effort_robot_object(struct effort_robot *robot, struct effort_gesture *gesture,
                             struct fault *fault);
/* By its shape: SHAPE_BALL, SHAPE_SPHERE or SHAPE_BOX. */
enum err effort_robot_background(struct effort_robot *robot, enum effort_shape shape,
                                 struct effort_gesture *gesture, struct fault *fault);

/* The next gesture, given label[voxels]; *found is false where nothing is wrong. */
enum err effort_robot_next(struct effort_robot *robot, const uint8_t *label,
                           struct effort_gesture *gesture, bool *found, struct fault *fault);

/* The voxels that a gesture covers, into an empty list. */
enum err effort_gesture_voxels(struct voxels *out, const struct effort_gesture *gesture,
                               const struct grid *grid, struct fault *fault);

#endif
