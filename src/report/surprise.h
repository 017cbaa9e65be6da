/*
 * A surprise: an edit that took far more than was planted, as a seed does that floods an object
 * through a weak edge.
 *
 * It took a label more than SURPRISE_VOXELS voxels, more than SURPRISE_TIMES the seeds that it
 * planted and removed, and at least a SURPRISE_SHARE-th of what the label had, or of what that one
 * had which it gave most to, where it had any. Not before two labels have seeds: what the first
 * ones take says nothing. Of 2940 gestures of the robots of `bench effort` this finds nine in ten
 * of those that lower the Dice coefficient by more than 0.05, all that lower it by more than 0.15,
 * and one in nine of the good ones.
 *
 * It is looked for in what each edit knows anyway, the counts of labels and the list of changes;
 * only a surprise itself costs more, for the way that it came (engine/way.h).
 */
#ifndef REPORT_SURPRISE_H
#define REPORT_SURPRISE_H

#include "session/session.h"

enum { SURPRISE_TIMES = 100, SURPRISE_VOXELS = 1000, SURPRISE_SHARE = 4 };

struct surprise {
    uint8_t label;       /* that most was taken from, */
    uint64_t voxels;     /* so many more than it was given */
    bool has_passage;    /* and if so, through the edge into */
    uint32_t passage[3]; /* this voxel */
};

/* Whether the command has edited the seeds and is one. session_count_before comes before the
 * command, session_count_labels after it. */
bool session_find_surprise(struct surprise *surprise, const struct session *session);

#endif
