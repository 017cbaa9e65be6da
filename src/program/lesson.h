/* SPDX-License-Identifier: MIT */
/*
 * The lesson of `iftty tutorial`: a first organ, the brain of the head ch2, in steps.
 *
 * A step says what to do, and has come when what it is about is there, however that was done:
 * seeds lie on the right side of the truth, mricron's own extraction of this brain, and labels
 * agree with it by Dice's coefficient. So whoever undoes one is a step back, and a journal that was
 * left midway goes on where it was.
 */
#ifndef PROGRAM_LESSON_H
#define PROGRAM_LESSON_H

#include "command/interpreter.h"
#include "engine/labels.h"

#define LESSON_SCENE "ch2.nii.gz"
#define LESSON_TRUTH "ch2bet.nii.gz"

struct lesson {
    uint8_t *truth; /* 1 in the brain, else 0: [z][y][x], */
    uint32_t size[3];
    uint64_t of;     /* what was looked at last, */
    bool is_settled; /* whose labels had settled, */
    struct overlap overlap;
    uint32_t worst;     /* and the slice with most that is wrong */
    size_t seeds[2][2]; /* of the background and of label 1, outside of the brain and in it */
    bool has_name;
};

/* ERR_IO where the scene or the truth is not here: before a terminal is taken. */
enum err lesson_find(const struct interpreter *interp, struct fault *fault);

/* The truth, on the grid of the session's scene: ERR_INPUT where that is another one. */
enum err lesson_begin(struct lesson *lesson, const struct interpreter *interp, struct fault *fault);
void lesson_release(struct lesson *lesson);

/* Looks at what there is: at labels that have settled, where they are to, which are waited for if
 * `waits`. */
void lesson_look(struct lesson *lesson, struct session *session, bool waits);

/* What a lesson is, for the prompt, to begin with. */
void lesson_add_beginning(struct buf *out);

/* Lines on the present step: for the prompt; and for the pilot, one on what is missing and two on
 * the keys. `journal` goes on with it. */
void lesson_add_page(struct buf *out, const struct lesson *lesson, const char *journal);
void lesson_add_captions(struct buf *out, const struct lesson *lesson, const char *journal);

/* The ten keys as README.md has them. */
void lesson_add_keys(struct buf *out);

#endif
