/* SPDX-License-Identifier: MIT */
/*
 * The steps of a journal: its gestures, in the journal's order, as its bytes have them.
 *
 * A *step* is a record whose command is about seeds, labels, weights or the region of interest, or
 * goes through the history; the records between, which look, write or ask, go with the step after
 * them. Nothing is carried out here: the results say which record follows which (journal/tree.h).
 * A step *stands* where it lies on the way to the segmentation that the journal ends with; else it
 * was undone, or lies on another alternative.
 *
 *     1 open s.nii
 *     # the head first
 *     2 seed 2,3,4 1          step 1, stands; comment "the head first"
 *     3 turn 15
 *     4 seed 9,9,9 1          step 2, undone
 *     5 undo                  step 3, is no part of the way itself
 */
#ifndef STEPS_STEP_LIST_H
#define STEPS_STEP_LIST_H

#include <stdbool.h>
#include <stddef.h>

#include "base/buf.h"
#include "base/err.h"

enum step_fate {
    STEP_STANDS,
    STEP_UNDONE,    /* taken back, or left by `goto`, on the alternative that stands */
    STEP_ELSEWHERE, /* on another alternative */
    STEP_MOVES      /* undo, redo, goto, branch: a way through the history */
};

/* Its texts are in the list's, ended by NUL: bytes of a journal, to be printed by buf_add_safe. */
struct step {
    size_t record, line; /* its number, and the line of its command */
    size_t command;      /* where its texts are: the command, */
    size_t comments;     /* and the comments since the step before, lines without their "# " */
    enum step_fate fate;
};

/* {0} is empty. */
struct step_list {
    struct step *step; /* [count] */
    size_t count, capacity;
    size_t records;
    struct buf text;
};

/* Those of `length` bytes, which are a journal's: ERR_INPUT for a script, and for at=N that names
 * no record before. What is damaged or torn at the end is left to the replay. ERR_MEMORY. To be
 * released, whatever is returned. */
enum err step_list_read(struct step_list *list, const char *bytes, size_t length,
                        struct fault *fault);
void step_list_release(struct step_list *list);

/* The step of this record, counted from 1; 0 where it is none. */
size_t step_list_find(const struct step_list *list, size_t record);

#endif
