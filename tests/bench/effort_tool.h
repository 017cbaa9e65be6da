/* SPDX-License-Identifier: MIT */
/*
 * Tools: what turns a robot's gestures into labels, one run at a time.
 *
 *     own        a session that carries out commands, as a user types them
 *     GrowCut    growcut.h, from all seeds anew
 *     workers    programs of tests/peers (worker.h says how they are spoken to), from all seeds
 *                anew
 *
 * A gesture's time is processor time, from the command, or from markers in memory, to labels: for
 * iftty with its border and digests, and with the relaxed labels where the method has them.
 */
#ifndef TESTS_BENCH_EFFORT_TOOL_H
#define TESTS_BENCH_EFFORT_TOOL_H

#include "tests/bench/effort_outline.h"

enum effort_by { BY_IFTTY, BY_GROWCUT, BY_WORKER };

/* A way to segment, with the robot's second gesture. */
struct effort_method {
    const char *name;
    enum effort_by by;
    enum effort_shape background;
    const char *weight; /* of iftty, as its command has it; of a worker, its program */
    unsigned reach;     /* of `finish relax`; 0: it is not relaxed */
    bool charted;
    bool once;      /* is only run by the careful robot, and on no whole scene: it takes its time */
    bool limits;    /* refinements end within the gesture's distance */
    uint32_t brush; /* radius of balls and strokes, at most a tenth of the scene; 0 for the
                               robot's own */
    enum outline_next next; /* refinements are outlines, by the careful robot alone; NEXT_NONE for
                               none */
    unsigned hand;          /* which is so many tenths of a voxel off */
};

/* Where an object lies for all tools (effort_tool_prepare): scene.nii, size, image.u8, gradient.u8.
 */
struct effort_tool {
    const struct effort_method *method;
    const struct effort_object *object;
    const char *folder;
    struct grid grid;
    uint8_t *label;  /* [voxels]: after the last gesture */
    uint8_t *marker; /* [voxels]: label + 1, or 0 where there is none; iftty has its own */
    double ms;       /* of the last gesture */
    size_t gestures; /* so far; from markers, nothing is computed of the first alone */
    struct interpreter *interp;
    struct reply reply;
    int child, to, from; /* a worker, and its pipes */
};

/* Writes what tools read into the folder. */
enum err effort_tool_prepare(const struct effort_object *object, const char *folder,
                             struct fault *fault);

/* Where it fails, effort_tool_end is due all the same. ERR_IO: the program is not there, or what it
 * needs is not installed. */
enum err effort_tool_begin(struct effort_tool *tool, const struct effort_method *method,
                           const struct effort_object *object, const char *folder,
                           struct fault *fault);
enum err effort_tool_apply(struct effort_tool *tool, const struct effort_gesture *gesture,
                           struct fault *fault);
void effort_tool_end(struct effort_tool *tool);

/* The command that makes a gesture; of a ball, whether it says how far its trees grow. */
void effort_write_command(struct buf *line, const struct effort_gesture *gesture, bool limits);

#endif
