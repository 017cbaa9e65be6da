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

#endif
