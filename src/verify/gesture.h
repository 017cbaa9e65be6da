/* SPDX-License-Identifier: MIT */
/*
 * Gestures: what somebody has done in a journal, one thing after the other, and what came of it.
 *
 * A *gesture* is a command that plants, removes, or goes back and forth: of a stroke that is
 * several records, all of them are one. Its place is the middle of the box around its corners; what
 * comes out of a file has none. It is *taken back* where its command is not on the way to the state
 * that the journal ends in (session/history.h), be it undone or left on another branch.
 *
 * A *step* is a command after which voxels have other labels: edits that wait count from the run
 * that applies them. Of each step there is Dice's coefficient (engine/overlap.h) of the labels with
 * those that the expert ends with, of each label and of all: sums over the labels, where a voxel
 * agrees that has the same one in both. It follows the forest's list of changes; where that does
 * not lead to the digest that the labels have, as after a growth from nothing, voxels are counted.
 *
 * A journal records no time (journal/FORMAT.md), so neither has one.
 */
#ifndef VERIFY_GESTURE_H
#define VERIFY_GESTURE_H

#include <stddef.h>
#include <stdint.h>

#include "base/err.h"

struct side;
struct side_options;

#define GESTURE_KINDS(KIND)                                                                        \
    KIND(SEED, "seed")                                                                             \
    KIND(BALL, "ball")                                                                             \
    KIND(STROKE, "stroke")                                                                         \
    KIND(SHELL, "shell")                                                                           \
    KIND(BOX, "box")                                                                               \
    KIND(FILL, "fill")                                                                             \
    KIND(OUTLINE, "outline")                                                                       \
    KIND(OBJECT, "object")                                                                         \
    KIND(SEED_FILE, "seed-file")                                                                   \
    KIND(MAP, "labels")                                                                            \
    KIND(ELIMINATOR, "eliminator")                                                                 \
    KIND(UNDO, "undo")                                                                             \
    KIND(REDO, "redo")                                                                             \
    KIND(GOTO, "goto")

#define GESTURE_ENUM(kind, name) GESTURE_##kind,
enum gesture_kind { GESTURE_KINDS(GESTURE_ENUM) GESTURE_KIND_COUNT };
extern const char *const gesture_kind_name[GESTURE_KIND_COUNT];

enum { GESTURE_ERASES = 256, GESTURE_NO_LABEL };

struct gesture {
    uint64_t record; /* its number, the first of a stroke's */
    uint32_t point;  /* of the history, where it is done; POINT_NONE: none, or one that is gone */
    uint16_t label;  /* 0..255, GESTURE_ERASES of an eliminator, GESTURE_NO_LABEL */
    uint8_t kind;
    uint8_t has_place, is_taken_back; /* booleans */
    uint32_t doubled[3];              /* the place: twice the middle, in voxels */
};

struct step {
    uint64_t record;
    uint32_t gestures;  /* so far */
    uint16_t dice[257]; /* ten-thousandths, of each label; [256]: of all */
};
enum { DICE_OF_ALL = 256 };

/* More of either is ERR_LIMIT. */
enum { GESTURES_MOST = 20000, STEPS_MOST = 20000 };

/* Of one side, borrowed from what it has handed back. */
struct gestures {
    size_t count, steps;
    const struct gesture *gesture; /* [count] */
    const struct step *step;       /* [steps] */
};

/* Carries a journal out and gives its gestures, and its steps by the labels `expert` ends with.
 * The errors of side_carry_out; ERR_INPUT where the scene's size is another one; ERR_LIMIT. */
enum err gestures_carry_out(struct gestures *gestures, struct side *side, const char *path,
                            const struct side_options *options, const struct side *expert,
                            struct fault *fault);

#endif
