/*
 * What of a script is recorded already: a run that was interrupted goes on after its last record.
 *
 * A session has one scene, so a script that opens one can add nothing to a journal that has its
 * scene already: it must be the script that the journal was recorded from. Its lines are then taken
 * one by one beside the records, in canonical form, names of labels as they were there; a line that
 * led to the next record is not carried out again. After the last record the script goes on as any
 * other. Where a line and the record differ, nothing is carried out at all: somebody has changed
 * one of them.
 *
 *     script                  journal
 *     open a.nii              open a.nii weight=morph       what a record adds (`added`)
 *     seed 1,2,3 liver        seed 1,2,3 2
 *     stats                   run for=stats                 what a question has applied
 *     zoom fit                zoom 2.5 at=9,9,9             what it came to (`comes_to`)
 *     seed 4,5,6 liver                                      goes on here
 */
#ifndef COMMAND_RECORDED_H
#define COMMAND_RECORDED_H

#include <stdio.h>

#include "command/interpreter.h"
#include "journal/record.h"

struct recorded {
    enum recorded_mode {
        RECORDED_UNDECIDED, /* until the first line that would be recorded */
        RECORDED_NOTHING,   /* the script adds to the journal, or there is none */
        RECORDED_FOLLOWS,   /* the record at hand is yet to be met */
        RECORDED_ENDS,      /* all records have been met */
    } mode;
    size_t records;       /* of the journal, before the first line */
    struct buf journal;   /* its bytes then */
    struct walk walk;     /* over them */
    struct record record; /* at hand */
    size_t other_comment; /* the first record whose comments are others than the script's, or 0 */
    struct buf comments;  /* of the script, since the last record */
    struct session *then; /* by which lines are read: labels have the names */
    const struct kept_settings *settings; /* that they had when the record was new */
};

/* Before the first line of `input`, which is read ahead and put back where that can be done. */
enum err recorded_begin(struct recorded *recorded, const struct interpreter *interp, FILE *input,
                        struct fault *fault);
void recorded_release(struct recorded *recorded);

/* Whether the line stands before where the script goes on: then *taken, and it is not to be carried
 * out; `reply` and interp->acknowledged are what its record has. ERR_INPUT where line and record
 * differ: *taken too. */
enum err recorded_take(struct recorded *recorded, struct interpreter *interp, const char *line,
                       bool *taken, struct reply *reply, struct fault *fault);

/* At the end of the script: ERR_INPUT where records are left. */
enum err recorded_end(const struct recorded *recorded, const struct interpreter *interp,
                      struct fault *fault);

/* Whether the rest of `input`, or all from where it stands, opens a scene; it is put back to where
 * it stood. False also where that cannot be done: *knows says which. */
bool recorded_opens_scene(FILE *input, bool *knows);

#endif
