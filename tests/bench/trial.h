/* SPDX-License-Identifier: MIT */
/* The paper's five experiments on one scene: what is timed, and that all give the same.
 *
 *     (1) IFT + SP      the forest from scratch; scene projection
 *     (2) DIFT + SP     the differential update; scene projection
 *     (3) BDIFT + BP    the update with the border kept up to date; border projection
 *     (4) DIFT + II     the update; the incremental image, which repairs the former picture
 *     (5) DIFT + scan + BP  the update; border voxels sought in the whole scene; border projection
 *
 * Three phases of each are timed. Segmentation is the forest with its digests. Border upkeep is
 * what (3) and (5) do for their borders; the incremental image of this program looks into the same
 * sets, so (4) pays for them too. Rendition ends with the shaded picture; that of (1) and (2)
 * begins with a scan of the labels of the whole scene.
 *
 * All experiments work on one forest: an update is timed, and taken back by erasing its seeds
 * before the next experiment makes it again. They take turns in every step and round, so that
 * whatever else the machine does falls on all of them; the median over the rounds is kept.
 *
 * Invariant E1: in each step and round, every experiment gives the labels, the keys, and the
 * picture (visible voxels, depths, colours) of the first one. Otherwise the trial ends with
 * ERR_CHECK, and words that name the first difference. */
#ifndef TESTS_BENCH_TRIAL_H
#define TESTS_BENCH_TRIAL_H

#include "tests/bench/procedure.h"
#include "render/rendition.h"

enum experiment { IFT_SP, DIFT_SP, BDIFT_BP, DIFT_II, DIFT_SCAN_BP, EXPERIMENTS };
extern const char *const experiment_name[EXPERIMENTS];

enum phase { SEGMENTATION, BORDER, RENDITION, PHASES };

enum { TRIAL_ROUNDS_MOST = 99, TRIAL_SIDE = 512 };

struct trial_cost {
    double ms[PHASES];
    uint64_t served; /* voxels whose key the pass settled */
    bool is_whole;   /* changes are "everything": border and picture are recomputed */
};

struct trial_step {
    unsigned seeds; /* planted so far */
    struct trial_cost cost[EXPERIMENTS];
    uint64_t keys, labels, picture; /* digests */
    size_t border_voxels;
};

struct trial {
    char name[16];
    bool in_paper;
    uint32_t size[3];
    size_t voxels;
    unsigned steps, rounds, threads;
    struct trial_step step[PROCEDURE_STEPS];
    uint64_t compared; /* results that equal another experiment's */
};

/* Called after each round of each step; false ends the trial with ERR_CANCELLED. */
struct trial_watch {
    bool (*advanced)(void *context, unsigned step, unsigned round);
    void *context;
};

/* Fill in steps, costs and counts. The session has its scene and no seed; `seeds` are the
 * procedure's, in order. ERR_CHECK and ERR_CANCELLED as above; the program ends at others. */
enum err trial_run(struct trial *trial, struct session *session, const struct seeds *seeds,
                   unsigned steps, unsigned rounds, const struct trial_watch *watch,
                   struct fault *fault);

/* Mean of a phase over the steps after the first (over the first, if it is the only one). */
double trial_mean(const struct trial *trial, enum experiment experiment, enum phase phase);
double trial_mean_total(const struct trial *trial, enum experiment experiment);
double trial_total(const struct trial_step *step, enum experiment experiment);
double trial_ns_per_voxel(const struct trial_step *step, enum experiment experiment);

/* Compare two renditions of one size. False, with a fault that names the first differing pixel. */
bool trial_same_picture(const struct rendition *a, const struct rendition *b,
                        const struct grid *grid, struct fault *fault);

#endif
