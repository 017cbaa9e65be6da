/* SPDX-License-Identifier: MIT */
/*
 * Loss: labels that the finish deletes, halves or breaks.
 *
 * A label of the forest is lost from where it has no finished voxel, less than half of its voxels,
 * or more pieces (engine/components.h) than before. The finish decides this by itself for labels
 * without a view of them, so each of them is named. Voxels that have another label, and are more
 * than LABEL_LOSS_FAR steps from every voxel that had one, are counted.
 */
#ifndef REPORT_LABEL_LOSS_H
#define REPORT_LABEL_LOSS_H

#include "base/buf.h"
#include "engine/labels.h"
#include "session/session.h"

enum { LABEL_LOSS_FAR = 3 };

struct label_extent {
    uint64_t voxels;
    uint32_t pieces;
};

struct label_loss {
    unsigned labels; /* 1..255, that are lost from */
    bool is_lost[256];
    uint64_t far;                                /* voxels */
    struct label_extent before[256], after[256]; /* of all labels */
};

/* Compares the labels of the forest with finished ones. Takes two bytes a voxel for a moment.
 * ERR_MEMORY, ERR_CANCELLED. */
enum err label_loss_find(struct label_loss *loss, const struct labels *finished, struct team *team,
                         struct watch *watch, struct fault *fault);

/* Adds one short line that names the labels that are lost from; nothing where there are none. */
void label_loss_write_line(struct buf *out, const struct session *session,
                           const struct label_loss *loss);

/* Adds a line for each label that is lost from, one for voxels that are far from a former border,
 * and one with the commands that take it back. */
void label_loss_write(struct buf *out, const struct session *session,
                      const struct label_loss *loss);

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
