/* SPDX-License-Identifier: MIT */
/*
 * Agreement: the label maps of several raters on one grid, their consensus, and how far each of
 * them is from it.
 *
 * Consensus by majority: a voxel has the label that more raters give it than any other. Where two
 * or more are given by as many raters, and by more than all others, the voxel is *tied*: it has no
 * label, label 0, whoever comes first, and is counted. So of two raters a voxel has a label where
 * both give it the same one. The order of raters changes nothing.
 *
 * Of a label, with A the voxels that a rater gives it and B those of the consensus:
 *
 *     Dice         2 |A and B| / (|A| + |B|)
 *     sensitivity  |A and B| / |B|
 *     specificity  of the voxels outside B, the part that is outside A
 *
 * unless whoever found the consensus has estimated the last two with it (register/staple.h). Of all
 * labels together there is Dice alone: sums over the labels, where a voxel agrees that has the same
 * one in both. What is not known is "-" in the table, null in JSON and an empty field in CSV.
 */
#ifndef REPORT_AGREEMENT_H
#define REPORT_AGREEMENT_H

#include "base/buf.h"
#include "base/watch.h"
#include "engine/overlap.h"
#include "image/geometry.h"

enum { RATERS_MOST = 64 };

/* What one rater is found to be: [256] each, NAN where that is not known; or NULL: by the counts.
 */
struct rater_estimate {
    const double *sensitivity, *specificity;
};

/* All but the figures is borrowed. */
struct agreement {
    unsigned raters;                   /* 2..RATERS_MOST */
    const char *name[RATERS_MOST];     /* as files are called: any bytes */
    const uint8_t *label[RATERS_MOST]; /* [voxels] */
    const uint8_t *consensus;          /* [voxels] */
    struct rater_estimate estimate[RATERS_MOST];
    size_t voxels;
    const char *by; /* "majority" */
    bool has_ties;  /* that are counted: */
    uint64_t ties;
    const char *const *label_name;   /* [256], "" for none */
    const struct geometry *geometry; /* its spacing unknown: taken for 1 mm */

    struct overlap *rater; /* [raters]: A the rater, B the consensus */
    struct overlap *pair;  /* 1 and 2, 1 and 3, ..., 2 and 3, ... */
};

/* The consensus by majority of `raters` maps, and how many voxels are tied. ERR_CANCELLED. */
enum err agreement_majority(uint8_t *consensus, uint64_t *ties, const uint8_t *const label[],
                            unsigned raters, size_t voxels, struct watch *watch,
                            struct fault *fault);

/* Counts: fills `rater` and `pair`, which agreement_release lets go of. ERR_MEMORY, ERR_CANCELLED.
 */
enum err agreement_count(struct agreement *agreement, struct watch *watch, struct fault *fault);
void agreement_release(struct agreement *agreement);

/* Tables: of each label the raters and the consensus, and Dice of each two raters. */
void agreement_write_text(struct buf *out, const struct agreement *agreement);

/* An object: raters, consensus and pairs, with all labels together and each label. */
void agreement_write_json(struct buf *out, const struct agreement *agreement);

/* A line of names; then for each rater one for each label, and one for all, called "all". */
void agreement_write_csv(struct buf *out, const struct agreement *agreement);

#endif
