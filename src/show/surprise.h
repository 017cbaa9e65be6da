/* SPDX-License-Identifier: MIT */
/*
 * A surprise: an edit that took far more than was planted, as a seed does that floods an object
 * through a weak edge.
 *
 * It took a label more than SURPRISE_VOXELS voxels, and the label that they came to more than a
 * SURPRISE_TIMES-th of what that had for each seed that the edit planted or removed: who touches a
 * place means little of the label, who plants a ball means more. A label that had nothing is judged
 * by the one that lost: it took more than SURPRISE_TIMES the seeds, and at least a
 * SURPRISE_SHARE-th. Not before two labels have seeds: what the first ones take says nothing.
 *
 * It is none where a seed took less than 3/2 of what those of the label had taken each, and what
 * came is as bright as what there was: so the second ventricle of a pair does not count as one.
 *
 * `make bench-effort` counts what of robots' sessions is found, and what is called one and was
 * right (tests/bench/README.md).
 *
 * It is looked for in what each edit knows anyway, the counts of labels and the list of changes;
 * only a surprise itself costs more, for the way that it came (engine/way.h).
 */
#ifndef REPORT_SURPRISE_H
#define REPORT_SURPRISE_H

#include "session/session.h"

enum { SURPRISE_TIMES = 100, SURPRISE_VOXELS = 500, SURPRISE_SHARE = 4 };

struct surprise {
    uint8_t label;       /* that most was taken from, */
    uint64_t voxels;     /* so many more than it was given */
    bool has_passage;    /* and if so, through the edge into */
    uint32_t passage[3]; /* this voxel */
};

/* Whether the command has edited the seeds and is one. session_count_before comes before the
 * command, session_count_labels after it. */
bool session_find_surprise(struct surprise *surprise, struct session *session);

#endif
