/* SPDX-License-Identifier: MIT */
/*
 * Loss: labels that the finish deletes, halves or breaks.
 *
 * A label has a loss if it has no finished voxel, less than half of the forest's voxels, or more
 * pieces (engine/components.h) than in the forest. The user does not see this decision of the
 * finish, so every such label is named. Changed voxels that are more than LABEL_LOSS_FAR steps from
 * every voxel with their former label are counted.
 */
#ifndef SHOW_LABEL_LOSS_H
#define SHOW_LABEL_LOSS_H

#include "base/buf.h"
#include "engine/labels.h"
#include "session/session.h"

enum { LABEL_LOSS_FAR = 3 };

struct label_extent {
    uint64_t voxels;
    uint32_t pieces;
};

struct label_loss {
    unsigned labels; /* labels 1..255 with a loss */
    bool is_lost[256];
    uint64_t far; /* voxels */
    struct label_extent before[256], after[256];
};

/* Compare the forest's labels with finished ones. Uses two bytes a voxel for a moment. ERR_MEMORY,
 * ERR_CANCELLED. */
enum err label_loss_find(struct label_loss *loss, const struct labels *finished, struct team *team,
                         struct watch *watch, struct fault *fault);

/* Add one short line that names the labels with a loss, if there are any. */
void label_loss_write_line(struct buf *out, const struct session *session,
                           const struct label_loss *loss);

/* Add a line for each label with a loss, one for voxels far from a former border, and one with the
 * commands that undo the loss. */
void label_loss_write(struct buf *out, const struct session *session,
                      const struct label_loss *loss);

/*
 * Surprise: an edit that changed far more voxels than it planted, such as a seed that floods an
 * object through a weak edge.
 *
 * An edit is a surprise if a label lost more than SURPRISE_VOXELS voxels, and the label that gained
 * them more than 1/SURPRISE_TIMES of its former voxels for each seed that the edit planted or
 * removed. If that label had no voxels, the loss is compared: more than SURPRISE_TIMES the seeds,
 * and at least 1/SURPRISE_SHARE of the losing label. Nothing is a surprise before two labels have
 * seeds.
 *
 * An edit is no surprise if each of its seeds gained less than 3/2 of the former mean of a seed of
 * the label, and the new voxels are as bright as the old ones: so the second ventricle of a pair
 * does not count.
 *
 * `make bench-effort` counts surprises and false alarms in robots' sessions
 * (tests/bench/README.md).
 *
 * The search uses the counts of labels and the list of changes, which each edit has anyway; only a
 * surprise itself costs more, for the path to it (engine/way.h).
 */

enum { SURPRISE_TIMES = 100, SURPRISE_VOXELS = 500, SURPRISE_SHARE = 10 };

struct surprise {
    uint8_t label;       /* that lost most voxels, */
    uint64_t voxels;     /* and how many, net */
    bool has_passage;    /* the loss went through the edge into */
    uint32_t passage[3]; /* this voxel */
};

/* True if the command has edited the seeds and is a surprise. Call session_count_before before the
 * command, session_count_labels after it. */
bool session_find_surprise(struct surprise *surprise, struct session *session);

#endif
